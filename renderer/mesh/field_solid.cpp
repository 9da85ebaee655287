#include "renderer/mesh/solid.h"
#include "renderer/program/surface_search.h"

namespace kelpie {

namespace {

/// Of the box around the surface, along its longest side: what lies beyond it is meshed in vain.
constexpr int k_bounds_resolution = 128;
/// A box is empty or full only by this part of the threshold, where no blobs are bounded in float: cells at a face that lies in their own
/// are told apart by less than k_bound_margin.
constexpr double k_exact_margin = 1e-9;

} // namespace

FieldSolid::FieldSolid(const FieldProgram& program) : program_(program), bounds_(surface_bounds(program, k_bounds_resolution)) {}

Solid::InBox FieldSolid::in_box(const Box3d& box, const Code& parent) const {
  Interval field;
  InBox out;
  out.code = code_in(program_, parent, box, field);
  const double margin = program_.blobs.size() > 0 ? k_bound_margin : k_exact_margin;
  if (field.hi < program_.threshold * (1 - margin)) out.content = Content::empty;
  if (field.lo > program_.threshold * (1 + margin)) out.content = Content::full;
  return out;
}

double FieldSolid::value(const Code& code, const Vec3d& p) const { return excess(program_, code, p); }

Vec3d FieldSolid::gradient(const Code& code, const Vec3d& p) const { return kelpie::gradient(program_, code, p); }

/// Plantinga and Vegter, "Isotopic approximation of implicit curves and surfaces" (2004): one direction, that of the middle of all
/// gradients, has a positive product with each.
bool FieldSolid::is_one_sheet(const Code& code, const Box3d& box) const {
  using Variable = Dual<Interval, 3>;
  const auto side = [&](int axis) { return Variable::variable(Interval(box.lower[axis], box.upper[axis]), axis); };
  const Variable field = evaluate(program_, CodeView(code), Point3<Variable>{side(0), side(1), side(2)});
  Interval product(0.0);
  for (const Interval& d : field.d) product = product + d * d.middle();
  return product.lo > 0;
}

} // namespace kelpie
