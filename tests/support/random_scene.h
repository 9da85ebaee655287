// Fields that are hard on a ray tracer, the same in every run.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "renderer/cells/cells.h"
#include "scene/scene.h"
#include "tests/support/random_kind.h"

namespace kelpie {

/// Trees of a few elements would hardly be subdivided by the default limits.
inline constexpr CellLimits k_small_cells{1, 0.2f, 9};

inline FrameScene scene_of(SampledField field, float threshold = 1) {
  FrameScene scene;
  SampledShape shape;
  shape.name = "shape", shape.threshold = threshold, shape.field = std::move(field);
  scene.shapes.push_back(std::move(shape));
  return scene;
}

inline unsigned add(SampledField& field, FieldKinds::Variant<SampledMode> node) {
  field.nodes.push_back(std::move(node));
  return static_cast<unsigned>(field.nodes.size() - 1);
}

/// The clouds of several falloffs, blended.
inline SampledField field_of(const BlobCloud& cloud) {
  SampledField field;
  Blend<SampledMode> blend;
  for (const auto& [name, falloff] : EnumNames<Falloff>::values) {
    auto part = std::make_shared<BlobCloud>();
    for (const Blob& b : cloud)
      if (b.falloff == falloff) part->push_back(b);
    if (part->empty()) continue;
    Blobs<SampledMode> blobs;
    blobs.falloff = falloff, blobs.cloud = part;
    blend.children.push_back(add(field, blobs));
  }
  add(field, blend);
  return field;
}

inline Vec3 random_point(Random& r, double size = 1) { return Vec3(r.in(Box3d{Vec3d(-size), Vec3d(size)})); }

/// Centres that coincide, exactly or by a rounding, with the same radii or others.
inline BlobCloud coincident_cloud(Falloff falloff) {
  Random r(1);
  BlobCloud cloud;
  for (int i = 0; i < 60; ++i) {
    const Blob b{random_point(r), float(r.uniform(0.2, 0.5)), float(r.uniform(0.3, 0.8)), falloff};
    for (int copy = 0; copy < 6; ++copy) {
      Blob c = b;
      if (copy % 3 == 1) c.centre.x = std::nextafter(c.centre.x, 2.f);
      if (copy % 3 == 2) c.radius *= 0.7f;
      cloud.push_back(c);
    }
  }
  return cloud;
}

/// Sheets, threads and drops that hardly rise above the threshold: the roots along a ray come in close pairs.
inline BlobCloud thin_cloud(Falloff falloff) {
  Random r(2);
  BlobCloud cloud;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) cloud.push_back({Vec3(0.1 * i - 1, 0.2 * std::sin(0.6 * i), 0.1 * j - 1), 0.16f, 0.42f, falloff});
  for (int i = 0; i < 300; ++i)
    cloud.push_back({random_point(r), float(r.log_uniform(0.003, 0.3)), float(1 + r.log_uniform(1e-4, 0.3)), falloff});
  for (int i = 0; i < 200; ++i) cloud.push_back({Vec3(0.01 * i - 1, 0.8, 0.3 * std::cos(0.05 * i)), 0.02f, 0.5f, falloff});
  return cloud;
}

/// Weights of either sign: some carve right through, some only graze.
inline BlobCloud negative_cloud(Falloff falloff) {
  Random r(3);
  BlobCloud cloud;
  for (int i = 0; i < 500; ++i) {
    const double weight = i % 3 ? r.uniform(0.5, 2) : -r.uniform(0.2, 3);
    cloud.push_back({random_point(r), float(r.uniform(0.1, 0.45)), float(weight), falloff});
  }
  return cloud;
}

/// Plates, rods and whatever is between, of either sign, turned anyhow: some meet at a grazing angle, some only hardly rise above the
/// threshold.
inline BlobCloud ellipsoid_cloud(Falloff falloff) {
  Random r(4);
  BlobCloud cloud;
  for (int i = 0; i < 160; ++i) {
    Blob b{random_point(r), float(r.uniform(0.1, 0.3)), float(i % 5 ? r.uniform(0.5, 2) : 1 + r.log_uniform(1e-4, 0.1)), falloff};
    if (i % 7 == 3) b.weight *= -1;
    const Mat3d turn = glm::mat3_cast(glm::angleAxis(r.uniform(0, 6), r.direction()));
    const Vec3d axes(r.log_uniform(0.1, 2), r.log_uniform(0.1, 2), r.log_uniform(0.02, 1));
    const Mat3d to_axes = glm::transpose(turn);
    Mat3d m;
    for (int column = 0; column < 3; ++column) m[column] = to_axes[column] / (axes * double(b.radius));
    const bool is_ellipsoid = i % 9 != 0; // some are round
    if (is_ellipsoid && !set_ellipsoid(b, m)) ADD_FAILURE();
    cloud.push_back(b);
  }
  return cloud;
}

inline std::vector<BlobCloud> hard_clouds(Falloff f) { return {coincident_cloud(f), thin_cloud(f), negative_cloud(f), ellipsoid_cloud(f)}; }

/// Without what carves.
inline BlobCloud positive(BlobCloud cloud) {
  std::erase_if(cloud, [](const Blob& b) { return b.weight < 0; });
  return cloud;
}

/// With this formula wherever it stands.
template <template <class> class Kind>
Kind<SampledMode> sharp() {
  Kind<SampledMode> kind;
  kind.formula = BooleanFormula::sharp;
  return kind;
}

/// A tree of everything of which the reference knows the exact roots.
inline unsigned random_tree(Random& r, int depth, SampledField& field) {
  if (depth == 0) {
    if (r.below(2)) {
      Segment<SampledMode> s;
      s.from = random_point(r), s.to = r.below(6) ? random_point(r) : s.from;
      s.radius = float(r.uniform(0.2, 0.8)), s.weight = float(r.below(4) ? r.uniform(1, 2.5) : -r.uniform(0.2, 2)),
      s.falloff = Falloff(r.below(3));
      return add(field, s);
    }
    Point<SampledMode> p;
    p.centre = random_point(r), p.radius = float(r.uniform(0.3, 1)), p.weight = float(r.uniform(1, 3)), p.falloff = Falloff(r.below(3));
    return add(field, p);
  }
  const auto with_child = [&](auto warp) {
    warp.child = random_tree(r, depth - 1, field);
    return add(field, warp);
  };
  const auto with_children = [&](auto op) {
    for (int n = 2 + r.below(3); n > 0; --n) op.children.push_back(random_tree(r, depth - 1, field));
    return add(field, op);
  };
  switch (r.below(8)) {
  case 0: return with_child(random_kind<Translate>(r));
  case 1: return with_child(random_kind<Rotate>(r));
  case 2: return with_child(random_kind<Scale>(r));
  case 3: return with_children(sharp<Union>());
  case 4: return with_children(sharp<Intersection>());
  case 5: return with_children(sharp<Difference>());
  default: return with_children(Blend<SampledMode>{});
  }
}

} // namespace kelpie
