#include "morph/open_distances.h"

#include <cmath>

namespace kelpie {

namespace {

/// Calls visit(leaf or operator, parent_from_here) for all below a node, instances and warps followed.
template <class Field, class Visit>
void visit_below(Field& field, size_t node, const Affine& above_from_here, const Visit& visit) {
  std::visit(
      [&](auto& kind) {
        visit(kind, above_from_here);
        using Kind = std::decay_t<decltype(kind)>;
        if constexpr (Warp<Kind>)
          visit_below(field, kind.child, above_from_here, visit);
        else
          for_each_operand(kind, [&](const Operand& operand) {
            visit_below(field, operand.node, above_from_here * operand.parent_from_operand, visit);
          });
      },
      field.nodes[node]);
}

/// By how much a map scales lengths, on the average over directions.
double mean_scale(const Affine& map) { return std::cbrt(std::abs(glm::determinant(map.linear))); }

void set_reach(SampledField& field, const MorphObject<SampledMode>& object, double reach) {
  visit_below(field, object.field, {}, [&]<class Kind>(Kind& kind, const Affine& object_from_here) {
    if constexpr (SignedDistance<Kind>) kind.radius = static_cast<float>(reach / mean_scale(object_from_here));
    if constexpr (requires { kind.far; }) kind.far = kind.grid->far();
    if constexpr (requires { kind.formula = BooleanFormula::sharp; })
      if (kind.formula == BooleanFormula::automatic) kind.formula = BooleanFormula::sharp;
  });
}

} // namespace

Box3d object_box(const SampledField& field, const MorphObject<SampledMode>& object) {
  Box3d box;
  for (const auto& element : object.elements) box.extend(image_of(frame_of(element), {Vec3d(-1), Vec3d(1)}));
  visit_below(field, object.field, {}, [&]<class Kind>(const Kind& kind, const Affine& object_from_here) {
    if constexpr (SignedDistance<Kind> && !requires { Kind::k_is_unbounded; }) box.extend(image_of(object_from_here, kind.solid_box()));
  });
  return box;
}

void open_distances(SampledField& field, size_t node) {
  const Metamorphosis<SampledMode> kind = std::get<Metamorphosis<SampledMode>>(field.nodes[node]);
  Box3d box;
  for (const auto& object : kind.objects) box.extend(object_box(field, object));
  // A power of 2, so that it seldom differs between moments.
  const double reach = std::exp2(std::ceil(std::log2(std::max(1e-6, 2 * box.diagonal()))));
  std::get<Metamorphosis<SampledMode>>(field.nodes[node]).reach = reach;
  for (const auto& object : kind.objects) set_reach(field, object, reach);
}

} // namespace kelpie
