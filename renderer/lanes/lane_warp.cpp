#include "renderer/lanes/lane_warp.h"

#include "field/warps/axis_tube.h"

namespace kelpie {

namespace {

float number(double x) { return static_cast<float>(x); }

/// The way into the frame and back, and (in `at`) c there. `turn` is how far differences are still to be turned about its axis.
template <class Kind>
LaneWarp about(const Kind& kind, LaneWarp::Form form, const AxisFrame& frame, const Affine& local_from_parent, const Vec3d& centre,
               const Vec3d& image, double turn, Vec3d& at) {
  LaneWarp w{};
  w.form = form;
  w.low = -std::numeric_limits<float>::infinity(), w.high = std::numeric_limits<float>::infinity(), w.factor = 1;
  const Vec3d c = local_from_parent(centre), q = c - frame.origin;
  at = {glm::dot(frame.u, q), glm::dot(frame.v, q), glm::dot(frame.e, q)};
  w.x = number(at.x), w.y = number(at.y);
  const Vec3d rows[] = {frame.u * local_from_parent.linear, frame.v * local_from_parent.linear, frame.e * local_from_parent.linear};
  const double cosine = std::cos(turn), sine = std::sin(turn);
  const Vec3d columns[] = {frame.u * cosine + frame.v * sine, frame.v * cosine - frame.u * sine, frame.e};
  const Point3<double> there = kind.child_from_parent(Point3<double>{c.x, c.y, c.z});
  const Vec3d shift = Vec3d(there.x, there.y, there.z) - image;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) w.from[3 * i + j] = number(rows[i][j]), w.back[3 * i + j] = number(columns[j][i]);
    w.shift[i] = number(shift[i]);
  }
  return w;
}

void set_limits(LaneWarp& w, double height, double length) {
  const double clamped = std::clamp(height, 0.0, length);
  w.ahead = number(height - clamped), w.low = number(-clamped), w.high = number(length - clamped);
}

} // namespace

LaneWarp lane_warp(const Twist<SampledMode>& twist, const Affine& local_from_parent, const Vec3d& centre, const Vec3d& image) {
  const AxisFrame frame{Vec3d(twist.centre), Vec3d(twist.axis)};
  const double rate = -glm::radians(double(twist.rate)), h = glm::dot(frame.e, local_from_parent(centre) - frame.origin);
  const double acting = twist.length > 0 ? std::clamp(h, 0.0, double(twist.length)) : h;
  Vec3d at;
  LaneWarp w = about(twist, LaneWarp::Form::twist, frame, local_from_parent, centre, image, rate * acting, at);
  w.rate = number(rate);
  if (twist.length > 0) set_limits(w, at.z, twist.length);
  return w;
}

LaneWarp lane_warp(const Taper<SampledMode>& taper, const Affine& local_from_parent, const Vec3d& centre, const Vec3d& image) {
  const AxisFrame frame{Vec3d(taper.centre), Vec3d(taper.axis)};
  Vec3d at;
  LaneWarp w = about(taper, LaneWarp::Form::taper, frame, local_from_parent, centre, image, 0, at);
  const double rate = (double(taper.by) - 1) / double(taper.length);
  w.rate = number(rate), w.factor = number(1 + rate * std::clamp(at.z, 0.0, double(taper.length)));
  set_limits(w, at.z, taper.length);
  return w;
}

LaneWarp lane_warp(const Bend<SampledMode>& bend, const Affine& local_from_parent, const Vec3d& centre, const Vec3d& image) {
  const Bend<SampledMode>::Arc arc(bend);
  if (arc.is_straight()) return {};
  Vec3d at;
  LaneWarp w = about(bend, LaneWarp::Form::bend, arc.frame, local_from_parent, centre, image, 0, at);
  const double line = 1 / arc.curvature, across = line - at.x, along = at.z, distance = norm(across, along);
  const double angle = azimuth(across, along, 0.5 * arc.end - std::numbers::pi);
  w.across = number(across), w.along = number(along), w.line = number(line), w.distance = number(distance);
  w.angle = number(angle), w.end = number(arc.end), w.cosine = number(arc.c), w.sine = number(arc.s);
  const Point3<double> beyond = arc.before_end(Point3<double>{at.x, at.y, at.z});
  const Vec2d images[] = {{at.x, at.z}, {line - distance, line * angle}, {beyond.x, beyond.z}};
  const Vec2d& of_centre = images[angle <= 0 ? 0 : angle <= arc.end ? 1 : 2];
  for (int i = 0; i < 3; ++i) w.offset_x[i] = number(images[i].x - of_centre.x), w.offset_z[i] = number(images[i].y - of_centre.y);
  return w;
}

namespace {

void put(const Vec3d& v, float* out) {
  for (int i = 0; i < 3; ++i) out[i] = number(v[i]);
}

/// For places from `centre`, which is the middle of the piece's box but for rounding.
LaneAxis lane_axis(const AxisPiece& piece, const Vec3d& centre, const Vec3d& image) {
  LaneAxis out;
  out.low = number(piece.low), out.high = number(piece.high), out.joint = number(piece.joint), out.newton_steps = piece.newton_steps;
  const auto& a = piece.axis;
  put(piece.offset, out.offset), out.along = number(glm::dot(piece.offset, a[0]));
  for (size_t i = 0; i < 3; ++i) put(a[i], out.axis[i]), put(piece.shift[i + 1], out.shift[i]);
  const double squares[] = {glm::dot(a[0], a[0]), 3 * glm::dot(a[0], a[1]), 2 * glm::dot(a[1], a[1]) + 4 * glm::dot(a[0], a[2]),
                            5 * glm::dot(a[1], a[2]), 3 * glm::dot(a[2], a[2])};
  for (size_t i = 0; i < 5; ++i) {
    out.squares[i] = number(squares[i]);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) out.turn[i][3 * row + column] = number(piece.turn[i][column][row]);
  }
  put(centre + piece.shift[0] + piece.turn[0] * piece.offset - image, out.constant);
  return out;
}

} // namespace

LaneWarp lane_warp(const Axial<SampledMode>& axial, const Affine& local_from_parent, const Vec3d& centre, const Vec3d& image,
                   const Box3d& box, std::vector<LaneAxis>& pieces) {
  // The map itself is not more precise.
  constexpr double k_tolerance = 1e-5;
  const Vec3d c = local_from_parent(centre), extent = box.extent();
  Box3d around = box; // with c in its middle
  around.extend(c + glm::max(box.upper - c, c - box.lower)), around.extend(c - glm::max(box.upper - c, c - box.lower));
  std::vector<AxisPiece> found;
  if (!axial.alone(around, k_tolerance * std::max({extent.x, extent.y, extent.z}), found)) return {};
  LaneWarp w{};
  w.form = LaneWarp::Form::axial;
  w.first_piece = static_cast<uint32_t>(pieces.size()), w.piece_count = static_cast<uint32_t>(found.size());
  for (const AxisPiece& piece : found) pieces.push_back(lane_axis(piece, c, image));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) w.from[3 * i + j] = number(local_from_parent.linear[j][i]), w.back[3 * i + j] = i == j ? 1.f : 0.f;
  if (found.empty()) put(c - image, w.shift);
  return w;
}

} // namespace kelpie
