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

/// "first", "23rd"
std::string ordinal(size_t place) {
  constexpr std::array k_words{"first", "second", "third", "fourth", "fifth", "sixth"};
  if (place < k_words.size()) return k_words[place];
  const size_t n = place + 1, last = n / 10 % 10 == 1 ? 0 : n % 10;
  return fmt::format("{}{}", n, last == 1 ? "st" : last == 2 ? "nd" : last == 3 ? "rd" : "th");
}

/// What lies far from nearly all of a mesh decides how large it is shown.
void warn_of_specks(const LiquidEnd& end, size_t place) {
  constexpr double k_dot = 0.1;
  const Box3 bulk = extent_of(end.fit).bulk;
  const double share = double(bulk.diagonal()) / bounding_box(end.mesh).diagonal(); // a speck may have no blob
  if (share > k_dot) return;
  const Vec3d c = Vec3d(bulk.centre()) + end.mesh.origin;
  print_message(fmt::format(
      "warning: nearly all of the {} mesh, around ({:.4g}, {:.4g}, {:.4g}), is {:.2g} of its size: a speck far from it makes it "
      "a dot; remove what is small and far away\n",
      ordinal(place), c.x, c.y, c.z, share));
}

/// Where they stand, as they are turned.
void place(std::span<LiquidEnd> ends) {
  const Extent first = measure(ends[0].mesh, ends[0].placement);
  const double first_size = first.box.diagonal(); // a fitted mesh has an extent
  double largest = 0;
  for (LiquidEnd& end : ends) {
    const Extent own = measure(end.mesh, end.placement);
    // The factor of this mesh relative to the first. What was fitted encloses something.
    const double by_size = first_size / own.box.diagonal(), by_volume = std::cbrt(first.volume / own.volume);
    end.placement.scale = std::clamp(by_volume, by_size / k_most_size_ratio, by_size * k_most_size_ratio);
    end.placement.foot = foot_of(own.box);
    largest = std::max(largest, end.placement.scale * own.box.diagonal());
  }
  for (LiquidEnd& end : ends) end.placement.scale *= k_size / largest;
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

void place_together(std::span<LiquidEnd> ends, std::optional<double> turn) {
  for (size_t i = 0; i < ends.size(); ++i) warn_of_specks(ends[i], i);
  for (LiquidEnd& end : ends.subspan(1)) end.placement.turn = turn.value_or(0);
  place(ends);
  if (turn) return;
  for (size_t i = 1; i < ends.size(); ++i) {
    ends[i].placement.turn = best_turn(ends[i].placement.placed(ends[i].fit), ends[i - 1].placement.placed(ends[i - 1].fit));
    place(ends);
  }
}

} // namespace kelpie
