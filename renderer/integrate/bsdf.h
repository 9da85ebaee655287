// The surface at a hit.
#pragma once

#include "materials/surfaces.h"
#include "renderer/trace/tracer.h"

namespace kelpie {

/// Any of the models that the kinds of a list make.
template <class Kinds>
struct BsdfModels;
template <template <class> class... Kinds>
struct BsdfModels<KindList<Kinds...>> {
  using Variant = std::variant<decltype(std::declval<Kinds<SampledMode>>().bsdf())...>;
  static_assert((BsdfModel<decltype(std::declval<Kinds<SampledMode>>().bsdf())> && ...), "a model must answer all of BsdfModel");
};

/// A BsdfModel that is any of those of SurfaceKinds: a kind without one does not compile.
class Bsdf {
public:
  explicit Bsdf(const SurfaceKinds::Variant<SampledMode>& surface)
      : model_(std::visit([](const auto& kind) { return Model(kind.bsdf()); }, surface)) {}

  Vec3 albedo() const {
    return std::visit([](const auto& m) { return Vec3(m.albedo()); }, model_);
  }
  bool is_delta() const {
    return std::visit([](const auto& m) { return m.is_delta(); }, model_);
  }
  bool is_glossy() const {
    return std::visit([](const auto& m) { return m.is_glossy(); }, model_);
  }
  Bsdf at_least_as_rough_as(float alpha) const {
    return std::visit([&](const auto& m) { return Bsdf(Model(m.at_least_as_rough_as(alpha))); }, model_);
  }
  Vec3 evaluate(const Vec3& out, const Vec3& in) const {
    return std::visit([&](const auto& m) { return Vec3(m.evaluate(out, in)); }, model_);
  }
  float pdf(const Vec3& out, const Vec3& in) const {
    return std::visit([&](const auto& m) { return m.pdf(out, in); }, model_);
  }
  BsdfSample sample(const Vec3& out, float lobe, Vec2 u) const {
    return std::visit([&](const auto& m) { return m.sample(out, lobe, u); }, model_);
  }

private:
  using Model = BsdfModels<SurfaceKinds>::Variant;
  explicit Bsdf(const Model& model) : model_(model) {}

  Model model_;
};

static_assert(BsdfModel<Bsdf>);

/// The surface of the shape that was hit, at the hit. Whatever varies over a shape is decided here: the hit knows the place and
/// the normal, the side that the ray came from, the moment, and of a field the cell with what counts in it.
inline Bsdf surface_at(const FrameScene& frame, const Hit& hit) { return Bsdf(frame.shapes[hit.shape].surface); }

} // namespace kelpie
