#include "renderer/cells/solid_parts.h"

#include <limits>

namespace kelpie {

namespace {

/// The centre of the cell in a frame.
Vec3d centre_in(const AxisFrame& frame, const SolidPlace& place) {
  const Vec3d c = place.centre - frame.origin;
  return {glm::dot(frame.u, c), glm::dot(frame.v, c), glm::dot(frame.e, c)};
}

/// Coordinates are measured from `origin` in the frame: the point nearest to the cell, as far as turning allows. So near the
/// cell nothing is much larger than the cell or a radius, and float suffices.
SolidPart part_from(const AxisFrame& frame, const Vec3d& origin, const SolidPlace& place) {
  SolidPart part{};
  const Vec3d at = centre_in(frame, place) - origin;
  const Vec3d rows[] = {frame.u * place.linear, frame.v * place.linear, frame.e * place.linear};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) part.frame[4 * i + j] = static_cast<float>(rows[i][j]);
    part.frame[4 * i + 3] = static_cast<float>(at[i]);
  }
  return part;
}

void set_rectangle(SolidPart& part, Interval x, Interval y) {
  part.x_low = static_cast<float>(x.lo), part.x_high = static_cast<float>(x.hi);
  part.y_low = static_cast<float>(y.lo), part.y_high = static_cast<float>(y.hi);
}

/// Corners that all coincide are a rectangle.
void set_polygon(SolidPart& part, std::span<const Vec2d> corners, const Vec2d& origin, Tree& out) {
  part.first_edge = static_cast<uint32_t>(out.edges.size());
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec2d a = corners[i] - origin, e = corners[i + 1 < corners.size() ? i + 1 : 0] - corners[i];
    const double squared = glm::dot(e, e);
    if (static_cast<float>(squared) < std::numeric_limits<float>::min()) continue;
    const auto number = [](double x) { return static_cast<float>(x); };
    out.edges.push_back({number(a.x), number(a.y), number(e.x), number(e.y), number(1 / squared)});
  }
  part.edge_count = static_cast<uint32_t>(out.edges.size()) - part.first_edge;
  set_rectangle(part, corners[0].x - origin.x, corners[0].y - origin.y);
}

void add(const SolidPart& part, Tree& out, SolidLeaf& leaf) {
  if (leaf.part_count++ == 0) leaf.first_part = static_cast<uint32_t>(out.parts.size());
  out.parts.push_back(part);
}

/// A face, or a section that is extruded by `half` either way.
SolidPart extruded_polygon(const AxisFrame& frame, std::span<const Vec2d> corners, double half, const SolidPlace& place, Tree& out) {
  const Vec3d at = centre_in(frame, place);
  const Vec2d nearest = Vec2d(at) - from_nearest(corners, Vec2d(at));
  const double z = std::clamp(at.z, -half, half);
  SolidPart part = part_from(frame, {nearest, z}, place);
  set_polygon(part, corners, nearest, out);
  part.z_low = static_cast<float>(-half - z), part.z_high = static_cast<float>(half - z);
  return part;
}

} // namespace

SectionSolid section_of(const SdfSphere<SampledMode>& s) {
  return SectionSolid::turned({Vec3d(s.centre), Vec3d(0, 1, 0)}).with_rectangle(0, 0, 0).grown_by(s.sphere_radius);
}
SectionSolid section_of(const SdfBox<SampledMode>& s) {
  const double round = std::min(double(s.rounding), s.inner_radius());
  const Vec3d half = 0.5 * Vec3d(s.size) - round;
  const AxisFrame frame{Vec3d(s.centre), Vec3d(s.axis), Vec3d(s.across)};
  return SectionSolid::extruded(frame, half.y).with_rectangle(-half.x, half.x, half.z).grown_by(round);
}
SectionSolid section_of(const SdfCylinder<SampledMode>& s) {
  const Vec3d axis = Vec3d(s.to) - Vec3d(s.from);
  const double r = s.cylinder_radius;
  return SectionSolid::turned({Vec3d(s.from) + 0.5 * axis, axis}).with_rectangle(-r, r, 0.5 * glm::length(axis));
}
SectionSolid section_of(const SdfCapsule<SampledMode>& s) {
  const Vec3d axis = Vec3d(s.to) - Vec3d(s.from);
  return SectionSolid::turned({Vec3d(s.from) + 0.5 * axis, axis}).with_rectangle(0, 0, 0.5 * glm::length(axis)).grown_by(s.capsule_radius);
}
SectionSolid section_of(const SdfTorus<SampledMode>& s) {
  return SectionSolid::turned({Vec3d(s.centre), Vec3d(s.normal)})
      .with_rectangle(s.major_radius, s.major_radius, 0)
      .grown_by(s.minor_radius);
}

void add_parts(const SectionSolid& solid, const SolidPlace& place, Tree& out, SolidLeaf& leaf) {
  leaf.form = solid.is_turned ? SolidLeaf::Form::turned : SolidLeaf::Form::extruded;
  leaf.is_convex = solid.is_convex, leaf.growth = static_cast<float>(solid.growth);
  const Vec3d at = centre_in(solid.frame, place);
  const Interval x{solid.x_low, solid.x_high}, y{-solid.y_reach, solid.y_reach};
  const auto nearest = [](double v, Interval range) { return std::clamp(v, range.lo, range.hi); };
  if (solid.is_turned) {
    const Vec2d in_section{norm(at.x, at.y), at.z};
    const bool is_polygon = solid.polygon.count > 0;
    const double height = is_polygon ? at.z - from_nearest(solid.polygon.all(), in_section).y : nearest(at.z, y);
    SolidPart part = part_from(solid.frame, {0, 0, height}, place);
    if (is_polygon)
      set_polygon(part, solid.polygon.all(), {0, height}, out);
    else
      set_rectangle(part, x, y - height);
    return add(part, out, leaf);
  }
  if (solid.polygon.count > 0) return add(extruded_polygon(solid.frame, solid.polygon.all(), solid.half_height, place, out), out, leaf);
  const Interval z{-solid.half_height, solid.half_height};
  const Vec3d origin{nearest(at.x, x), nearest(at.y, y), nearest(at.z, z)};
  SolidPart part = part_from(solid.frame, origin, place);
  set_rectangle(part, x - origin.x, y - origin.y);
  part.z_low = static_cast<float>(z.lo - origin.z), part.z_high = static_cast<float>(z.hi - origin.z);
  add(part, out, leaf);
}

void add_half_space(const AxisFrame& frame, const SolidPlace& place, Tree& out, SolidLeaf& leaf) {
  leaf.form = SolidLeaf::Form::half_space, leaf.is_convex = true;
  const Vec3d at = centre_in(frame, place);
  add(part_from(frame, {at.x, at.y, 0}, place), out, leaf);
}

void add_parts(const ArcSolid& solid, const SolidPlace& place, Tree& out, SolidLeaf& leaf) {
  leaf.form = SolidLeaf::Form::arc, leaf.is_convex = false;
  SolidPart part = part_from(solid.frame, Vec3d(0), place);
  set_rectangle(part, solid.arc_radius, 0);
  add(part, out, leaf);
  const double c = std::cos(solid.half_angle), s = std::sin(solid.half_angle);
  leaf.end_x = static_cast<float>(solid.arc_radius * c), leaf.end_y = static_cast<float>(solid.arc_radius * s);
  if (solid.half_angle > 0)
    leaf.past_end_x = static_cast<float>(-s), leaf.past_end_y = static_cast<float>(c);
  else
    leaf.past_end_0 = 1; // its ends are all there is
}

void add_parts(std::span<const HullFace> faces, const SolidPlace& place, Tree& out, SolidLeaf& leaf) {
  leaf.form = SolidLeaf::Form::hull, leaf.is_convex = true;
  std::vector<double> distances;
  double least = std::numeric_limits<double>::infinity();
  for (const HullFace& face : faces) {
    const Vec3d at = centre_in(face.frame, place);
    const Vec2d r = from_nearest(face.corners, Vec2d(at));
    distances.push_back(norm(norm(r.x, r.y), at.z));
    least = std::min(least, distances.back());
  }
  // A face that is nearest to some point of the cell is about as near to its centre as the nearest one. Those kept tell inside
  // from outside, too: a point outside is outside one of the faces nearest to it.
  for (size_t i = 0; i < faces.size(); ++i)
    if (distances[i] <= least + 2.1 * place.reach) add(extruded_polygon(faces[i].frame, faces[i].corners, 0, place, out), out, leaf);
}

} // namespace kelpie
