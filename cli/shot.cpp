#include "cli/shot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/box.h"

namespace kelpie {

namespace {

constexpr double k_radians = std::numbers::pi / 180;
const double k_tangent = std::tan(CameraPath::k_fov_degrees / 2 * k_radians);

/// From where one looks: so low that the floor, which has no end, stays behind the subject and does not become a map.
constexpr double k_elevation = 6;
/// Angles about the vertical, from the front to the right: the arc of an orbit, and where the others stand.
constexpr double k_orbit_from = -10, k_orbit_to = 30, k_side = 18;
/// A dolly's distances at its ends, as factors of what would fill the picture as it should.
constexpr double k_dolly_from = 1.08, k_dolly_to = 0.95;
/// How much of the picture the subject fills, and how much it never exceeds.
constexpr double k_height_share = 2.0 / 3, k_width_share = 0.8, k_most_share = 0.92;
/// The camera's keys for each passage of the subject; between two of them its way is smooth.
constexpr int k_intervals = 8;

Vec3d direction_from_subject(double side_degrees) {
  const double a = side_degrees * k_radians, e = k_elevation * k_radians;
  return {std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e)};
}

/// A camera at `distance` from `look_at` towards the unit vector `towards`.
struct View {
  Vec3d look_at{0}, towards{0, 0, 1};
  double distance = 1;

  CameraKey key(double frame) const { return {frame, look_at + distance * towards, look_at}; }
};

/// The share of the picture that is too much: 1 where the box fills what it should.
double excess(const PictureBox& box) { return std::max(box.size().y / (2 * k_height_share), box.size().x / (2 * k_width_share)); }

/// The view that has the points in its middle, as large as they should be. Perspective makes this a fixed point: a dozen rounds are exact
/// to far below a pixel.
View fitted(const std::vector<Vec3>& points, const Vec3d& towards, double aspect) {
  Box3d box;
  for (const Vec3& p : points) box.extend(Vec3d(p));
  View view{box.centre(), towards, 4 * glm::length(box.extent()) + 1e-3};
  const Vec3d right = glm::normalize(glm::cross(Vec3d(0, 1, 0), towards)), up = glm::cross(towards, right);
  for (int round = 0; round < 12; ++round) {
    const PictureBox seen = covered(points, view.key(0), aspect);
    const Vec2d middle = 0.5 * (seen.lower + seen.upper) * (view.distance * k_tangent);
    view.look_at += middle.x * aspect * right + middle.y * up;
    view.distance *= excess(seen);
  }
  return view;
}

/// The mean of a sequence's neighbours at `i`, weighted by a bell a few moments wide: a subject that twitches does not shake the camera. In
/// a loop the first comes after the one before the last.
View smoothed(const std::vector<View>& views, size_t i, double width, bool is_loop) {
  View mean{Vec3d(0), Vec3d(0), 0};
  double sum = 0;
  const double period = double(views.size() - 1);
  for (size_t j = 0; j + size_t(is_loop) < views.size(); ++j) {
    double away = double(j) - double(i);
    if (is_loop) away = std::remainder(away, period);
    const double x = away / width, weight = std::exp(-0.5 * x * x);
    mean.look_at += weight * views[j].look_at, mean.distance += weight * views[j].distance, sum += weight;
  }
  return {mean.look_at / sum, views[i].towards, mean.distance / sum};
}

std::vector<View> views_of(const std::vector<SubjectMoment>& moments, CameraMove move, double aspect, bool is_loop) {
  std::vector<Vec3> all;
  if (move == CameraMove::still)
    for (const SubjectMoment& m : moments) all.insert(all.end(), m.points.begin(), m.points.end());
  std::vector<View> views;
  for (size_t i = 0; i < moments.size(); ++i) {
    const double way = moments.size() > 1 ? double(i) / double(moments.size() - 1) : 0.5;
    const double t = is_loop ? 0.5 - 0.5 * std::cos(2 * std::numbers::pi * way) : way; // there and back
    const double side = move == CameraMove::orbit ? std::lerp(k_orbit_from, k_orbit_to, t) : k_side;
    views.push_back(fitted(move == CameraMove::still ? all : moments[i].points, direction_from_subject(side), aspect));
    if (move == CameraMove::dolly) views.back().distance *= std::lerp(k_dolly_from, k_dolly_to, t);
    if (move == CameraMove::still) return {views.back()};
  }
  return views;
}

/// The factor of all distances with which no moment exceeds k_most_share of the picture.
double safety(const CameraPath& path, const std::vector<SubjectMoment>& moments, double aspect) {
  double most = 0;
  for (const SubjectMoment& m : moments) {
    const PictureBox box = covered(m.points, path.at(m.frame), aspect);
    for (const Vec2d& corner : {box.lower, box.upper}) most = std::max({most, std::abs(corner.x), std::abs(corner.y)});
  }
  return std::max(1.0, most / k_most_share);
}

Animated<Vec3> smooth_curve(const std::vector<CameraKey>& keys, Vec3d CameraKey::*value, bool is_loop) {
  std::vector<Key<Vec3>> list;
  for (const CameraKey& key : keys) list.push_back({key.frame, Vec3(key.*value), {}});
  const Outside outside = is_loop ? Outside::cycle : Outside::hold;
  return {std::move(list), Interpolation::spline, {outside, outside}};
}

std::string text_of(const Animated<Vec3>& curve) {
  const auto text = [](const Vec3& v) { return fmt::format("[{:.4f}, {:.4f}, {:.4f}]", v.x, v.y, v.z); };
  if (curve.is_constant()) return text(curve.at(0));
  std::vector<std::string> keys;
  for (const Key<Vec3>& k : curve.curve()->keys()) keys.push_back(fmt::format("\n      [{:g}, {}]", k.frame, text(k.value)));
  const char* outside = curve.curve()->ends().after == Outside::cycle ? R"("before": "cycle", "after": "cycle", )" : "";
  return fmt::format("{{ \"interpolation\": \"spline\", {}\"keys\": [{}\n    ] }}", outside, fmt::join(keys, ","));
}

} // namespace

PictureBox covered(const std::vector<Vec3>& points, const CameraKey& camera, double aspect) {
  const Vec3d towards = glm::normalize(camera.position - camera.look_at);
  const Vec3d right = glm::normalize(glm::cross(Vec3d(0, 1, 0), towards)), up = glm::cross(towards, right);
  constexpr double k_far = std::numeric_limits<double>::infinity();
  PictureBox box{Vec2d(k_far), Vec2d(-k_far)};
  for (const Vec3& point : points) {
    const Vec3d p = Vec3d(point) - camera.position;
    const double depth = std::max(-glm::dot(p, towards), 1e-6);
    const Vec2d at = Vec2d(glm::dot(p, right) / aspect, glm::dot(p, up)) / (depth * k_tangent);
    box.lower = glm::min(box.lower, at), box.upper = glm::max(box.upper, at);
  }
  return box;
}

CameraPath::CameraPath(std::vector<CameraKey> keys, bool is_loop)
    : keys_(std::move(keys)), position_(smooth_curve(keys_, &CameraKey::position, is_loop)),
      look_at_(smooth_curve(keys_, &CameraKey::look_at, is_loop)) {}

CameraKey CameraPath::at(double frame) const { return {frame, Vec3d(position_.at(frame)), Vec3d(look_at_.at(frame))}; }

std::string CameraPath::text() const {
  return fmt::format("{{\n    \"position\": {},\n    \"look_at\": {},\n    \"fov\": {}, \"shutter\": 0.5\n  }}", text_of(position_),
                     text_of(look_at_), k_fov_degrees);
}

CameraPath follow(const std::vector<SubjectMoment>& moments, CameraMove move, double aspect, const FollowOptions& o) {
  const std::vector<View> views = views_of(moments, move, aspect, o.is_loop);
  const int intervals = views.size() > 1 ? k_intervals * o.passages : 0;
  const double step = double(views.size() - 1) / (k_intervals * o.passages); // moments between two keys
  const auto path = [&](double factor) {
    std::vector<CameraKey> keys;
    for (int k = 0; k <= intervals; ++k) {
      const size_t i = size_t(std::lround(k * step));
      View view = views.size() > 1 ? smoothed(views, i, step / 2, o.is_loop) : views.front();
      view.distance *= factor;
      keys.push_back(view.key(moments[i].frame));
    }
    if (o.is_loop && keys.size() > 1) keys.back() = {keys.back().frame, keys.front().position, keys.front().look_at}; // but for rounding
    return CameraPath(std::move(keys), o.is_loop);
  };
  return path(safety(path(1), moments, aspect));
}

std::string shot_lights_text() {
  return R"([
    { "kind": "environment", "preset": "cyclorama" },
    { "kind": "rectangle", "position": [0.2, 5.2, 0.6], "target": [0, 1, 0], "up": [0, 0, -1], "width": 7.6, "height": 5.6,
      "colour": [1, 0.98, 0.95], "strength": 105, "visible": false }
  ])";
}

std::string shot_floor_text() {
  return R"({
      "name": "floor",
      "geometry": { "kind": "plane", "position": [0, 0, 0] },
      "surface": { "kind": "matte", "colour": [0.15, 0.165, 0.19] }
    })";
}

} // namespace kelpie
