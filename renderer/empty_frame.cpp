#include "renderer/empty_frame.h"

#include <fmt/format.h>

#include "base/float_step.h"

namespace kelpie {

namespace {

/// The corners of a box.
std::vector<Vec3d> corners_of(const Box3& box) {
  std::vector<Vec3d> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y, i & 4 ? box.upper.z : box.lower.z);
  return corners;
}

/// Where a picture sees points; in double precision, as it is asked of cameras that are absurdly far away.
class PictureOf {
public:
  explicit PictureOf(const FrameScene& frame) : eye_(frame.camera.position), size_(frame.film.resolution) {
    forward_ = glm::normalize(Vec3d(frame.camera.look_at) - eye_);
    right_ = glm::normalize(glm::cross(forward_, Vec3d(frame.camera.up)));
    const double pixel = 2 * std::tan(glm::radians(double(frame.camera.fov)) / 2) / size_.y;
    right_ /= pixel, up_ = glm::cross(right_, forward_);
  }

  /// Why nothing that lies within these boxes is seen.
  std::string why_unseen(const std::vector<Vec3d>& corners) const {
    glm::dvec2 lower(std::numeric_limits<double>::infinity()), upper = -lower;
    size_t behind = 0;
    for (const Vec3d& corner : corners) {
      const Vec3d d = corner - eye_;
      const double depth = glm::dot(d, forward_);
      if (depth <= 0) {
        ++behind;
        continue;
      }
      const glm::dvec2 at = 0.5 * size_ + glm::dvec2(glm::dot(d, right_), -glm::dot(d, up_)) / depth;
      lower = glm::min(lower, at), upper = glm::max(upper, at);
    }
    if (behind == corners.size()) return "lie behind the camera";
    const bool is_outside = upper.x < 0 || upper.y < 0 || lower.x > size_.x || lower.y > size_.y;
    if (behind == 0 && is_outside) return "lie outside the picture";
    if (behind == 0 && std::max(upper.x - lower.x, upper.y - lower.y) < 1) return "together are smaller than a pixel";
    return "are missed by every ray: they have no surface, are too thin, or lie beside the picture";
  }

private:
  Vec3d eye_, forward_, right_, up_; ///< right_ and up_ are as long as there are pixels in a unit, a unit away
  glm::dvec2 size_;
};

/// Around what has an end.
std::vector<Vec3d> corners_of(const FrameScene& frame, const Tracer& tracer) {
  std::vector<Vec3d> corners;
  if (!tracer.bounds().is_empty()) corners = corners_of(tracer.bounds());
  for (const SampledShape& shape : frame.shapes)
    if (const auto* mesh = shape.geometry ? std::get_if<TriangleMesh<SampledMode>>(&*shape.geometry) : nullptr) {
      Box3d box;
      for (const Vec3d& p : mesh->mesh->positions) box.extend(p + mesh->mesh->origin);
      for (const Vec3d& p : corners_of(Box3{Vec3(box.lower), Vec3(box.upper)})) corners.push_back(mesh->world_from_file()(p));
    }
  return corners;
}

bool has_planes(const FrameScene& frame) {
  return std::any_of(frame.shapes.begin(), frame.shapes.end(), [](const SampledShape& shape) {
    return shape.geometry && std::holds_alternative<Plane<SampledMode>>(*shape.geometry);
  });
}

std::string why_nothing(const FrameScene& frame, const Tracer& tracer) {
  const std::vector<Vec3d> corners = corners_of(frame, tracer);
  if (corners.empty()) return has_planes(frame) ? "its planes lie outside the picture" : "no shape has a surface";
  return fmt::format("all shapes{} {}", has_planes(frame) ? " but planes" : "", PictureOf(frame).why_unseen(corners));
}

/// Whether light comes from it; looks in a few directions, from a point and from far around it, as some shine to one side only.
bool is_lit(const Light& light, const Vec3& point) {
  constexpr int k_side = 16;
  constexpr float k_far = 1000;
  for (int around = 0; around < 7; ++around) {
    Vec3 from = point;
    if (around > 0) from[(around - 1) / 2] += around % 2 ? k_far : -k_far;
    for (int i = 0; i < k_side * k_side; ++i)
      if (light.sample(from, (Vec2(i % k_side, i / k_side) + 0.5f) / float(k_side)).radiance != Vec3(0)) return true;
  }
  return false;
}

std::string why_black(const FrameScene& frame, const std::vector<Light>& lights, const FrameImage& image) {
  if (std::none_of(lights.begin(), lights.end(), [&](const Light& l) { return is_lit(l, frame.camera.look_at); }))
    return "all lights are off (their \"strength\" is 0, or they are black)";
  bool is_white = false; // somewhere
  for (const char* name : {"albedo.R", "albedo.G", "albedo.B"})
    if (const FrameChannel* c = image.find(name))
      is_white = is_white || std::any_of(c->pixels.begin(), c->pixels.end(), [](float v) { return v > 0; });
  if (image.find("albedo.R") && !is_white) return "all surfaces in view are black";
  const bool is_direct = frame.film.bounces == 0;
  return fmt::format("no light reaches what is in view{}", is_direct ? " (with 0 bounces there is direct light only)" : "");
}

} // namespace

std::string why_empty(const FrameScene& frame, const Tracer& tracer, const std::vector<Light>& lights, const FrameImage& image) {
  const FrameChannel &r = *image.find("R"), &g = *image.find("G"), &b = *image.find("B"), &a = *image.find("A");
  const bool shows_background = frame.film.background.kind != Background::Kind::transparent;
  bool is_covered = false, is_black = false;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    if (!(a.pixels[i] > 0)) continue;
    is_covered = true;
    if (a.pixels[i] < 1 && shows_background) continue; // it is lit by what is behind
    if (r.pixels[i] != 0 || g.pixels[i] != 0 || b.pixels[i] != 0) return {};
    is_black = true;
  }
  if (!is_covered) return "shows nothing: " + why_nothing(frame, tracer);
  return is_black ? "is black: " + why_black(frame, lights, image) : "";
}

std::string why_coarse(const FrameScene& frame, const Tracer& tracer) {
  Box3d box;
  for (const Vec3d& corner : corners_of(frame, tracer)) box.extend(corner);
  const double step = float_step_in(box);
  if (step <= k_coarse_step) return {};
  const Vec3d c = box.centre();
  return fmt::format(
      "is coarse: its shapes lie so far from the origin, around ({:.4g}, {:.4g}, {:.4g}), that places there are rounded to {:.2g} of "
      "their size; move shapes and camera towards the origin",
      c.x, c.y, c.z, step);
}

} // namespace kelpie
