#include "cli/liquid_end.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "base/standard_streams.h"
#include "morph/liquid/volume.h"

namespace kelpie {

namespace {

constexpr double k_size = 3, k_most_size_ratio = 1.5;

/// The angles that are tried, and how much nearer to each other the blobs must come for a turn to be worth it.
constexpr int k_turns = 24;
constexpr double k_worth_turning = 0.7;

/// About which axis, and by how many degrees, each direction of k_up_axes turns up.
struct Rotation {
  Vec3d axis;
  double degrees;
};
constexpr std::array<Rotation, std::size(k_up_axes)> k_upright{
    {{{0, 0, 1}, 90}, {{0, 0, 1}, -90}, {{1, 0, 0}, 0}, {{1, 0, 0}, 180}, {{1, 0, 0}, -90}, {{1, 0, 0}, 90}}};

const Rotation& upright(std::string_view up) {
  return k_upright[size_t(std::find(std::begin(k_up_axes), std::end(k_up_axes), up) - std::begin(k_up_axes))];
}

glm::dmat3 rotation(const Vec3d& axis, double degrees) { return glm::dmat3(glm::rotate(glm::dmat4(1), glm::radians(degrees), axis)); }

std::string rotation_text(const Vec3d& axis, double degrees, const std::string& child) {
  if (degrees == 0) return child;
  return fmt::format(R"({{ "kind": "rotate", "axis": [{}, {}, {}], "angle": {}, "child": {} }})", axis.x, axis.y, axis.z, degrees, child);
}

/// What a mesh measures, turned.
struct Extent {
  Box3d box;
  double volume = 0; ///< about: an open mesh has none
};

Extent measure(const Mesh& mesh, const Placement& placement) {
  Extent e;
  const glm::dmat3 turning = placement.turning();
  for (const Vec3d& p : mesh.positions) e.box.extend(turning * (p + mesh.origin));
  e.volume = std::abs(signed_volume(mesh));
  return e;
}

Vec3d foot_of(const Box3d& box) { return {box.centre().x, box.lower.y, box.centre().z}; }

/// How far each blob is from the nearest one of the other cloud: the mean square, by mass.
double distance_between(const BlobCloud& a, const BlobCloud& b) {
  const auto one_way = [](const BlobCloud& from, const BlobCloud& to) {
    double sum = 0, total = 0;
    for (const Blob& x : from) {
      float nearest = std::numeric_limits<float>::infinity();
      for (const Blob& y : to) nearest = std::min(nearest, glm::dot(x.centre - y.centre, x.centre - y.centre));
      const double mass = double(x.radius) * x.radius * x.radius;
      sum += mass * nearest, total += mass;
    }
    return sum / total;
  };
  return one_way(a, b) + one_way(b, a);
}

/// The turn about the vertical by which `cloud`, which stands in the origin, lies best in `other`.
double best_turn(const BlobCloud& cloud, const BlobCloud& other) {
  const auto distance_at = [&](double degrees) {
    BlobCloud turned = cloud;
    const glm::dmat3 turning = rotation({0, 1, 0}, degrees);
    for (Blob& b : turned) b.centre = Vec3(turning * Vec3d(b.centre));
    return distance_between(turned, other);
  };
  const double as_it_stands = distance_at(0);
  double best = 0, least = k_worth_turning * as_it_stands;
  for (int i = 1; i < k_turns; ++i) {
    const double degrees = 360.0 * i / k_turns, distance = distance_at(degrees);
    if (distance < least) least = distance, best = degrees;
  }
  return best;
}

/// What lies far from nearly all of a mesh decides how large it is shown.
void warn_of_specks(const LiquidEnd& end, const char* which) {
  constexpr double k_dot = 0.1;
  const Box3 bulk = extent_of(end.fit).bulk;
  const double share = double(bulk.diagonal()) / bounding_box(end.mesh).diagonal(); // a speck may have no blob
  if (share > k_dot) return;
  const Vec3d c = Vec3d(bulk.centre()) + end.mesh.origin;
  print_message(fmt::format(
      "warning: nearly all of the {} mesh, around ({:.4g}, {:.4g}, {:.4g}), is {:.2g} of its size: a speck far from it makes it "
      "a dot; remove what is small and far away\n",
      which, c.x, c.y, c.z, share));
}

} // namespace

glm::dmat3 Placement::turning() const {
  const Rotation& r = upright(up);
  return rotation({0, 1, 0}, turn) * rotation(r.axis, r.degrees);
}

BlobCloud Placement::placed(BlobCloud cloud) const {
  const Affine place = map();
  for (Blob& b : cloud)
    if (const std::optional<Blob> there = is_round(b) ? std::nullopt : mapped(b, place))
      b = *there;
    else
      b.centre = Vec3(place(Vec3d(b.centre))), b.radius *= static_cast<float>(scale);
  return cloud;
}

std::string Placement::placed_text(std::string field) const {
  const Rotation& r = upright(up);
  field = rotation_text({0, 1, 0}, turn, rotation_text(r.axis, r.degrees, field));
  field = fmt::format(R"({{ "kind": "scale", "by": {:.9g}, "child": {} }})", scale, field);
  const Vec3d by = -foot * scale;
  return fmt::format(R"({{ "kind": "translate", "by": [{:.9g}, {:.9g}, {:.9g}], "child": {} }})", by.x, by.y, by.z, field);
}

void place_together(LiquidEnd& from, LiquidEnd& to, std::optional<double> turn) {
  warn_of_specks(from, "first"), warn_of_specks(to, "second");
  const auto place = [&] {
    const Extent first = measure(from.mesh, from.placement), second = measure(to.mesh, to.placement);
    const double size_a = first.box.diagonal(), size_b = second.box.diagonal(), by_size = size_a / size_b; // a fitted mesh has an extent
    // The factor of the second mesh relative to the first. What was fitted encloses something.
    const double by_volume = std::cbrt(first.volume / second.volume);
    const double ratio = std::clamp(by_volume, by_size / k_most_size_ratio, by_size * k_most_size_ratio);
    from.placement.scale = k_size / std::max(size_a, ratio * size_b), to.placement.scale = from.placement.scale * ratio;
    from.placement.foot = foot_of(first.box), to.placement.foot = foot_of(second.box);
  };
  to.placement.turn = turn.value_or(0);
  place();
  if (turn) return;
  to.placement.turn = best_turn(to.placement.placed(to.fit), from.placement.placed(from.fit));
  place();
}

} // namespace kelpie
