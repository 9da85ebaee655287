// A shot of a subject that changes its shape: a camera that follows it, and light in which every surface reads.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/animated.h"
#include "base/kind.h"
#include "base/vec.h"

namespace kelpie {

enum class CameraMove {
  orbit, ///< a slow arc around the subject; in a loop there and back
  dolly, ///< a slow approach; in a loop it retreats as well
  still, ///< one place, from which all moments fit the picture
};

template <>
struct EnumNames<CameraMove> {
  static constexpr std::array<std::pair<std::string_view, CameraMove>, 3> values{
      {{"orbit", CameraMove::orbit}, {"dolly", CameraMove::dolly}, {"still", CameraMove::still}}};
};

/// Where the subject is at a frame: points spread over it, in world space. Not empty.
struct SubjectMoment {
  double frame = 0;
  std::vector<Vec3> points;
};

struct CameraKey {
  double frame = 0;
  Vec3d position{0}, look_at{0};
};

/// A camera on its way; between keys it moves on Catmull-Rom splines, before and after them it stands, or goes in a cycle.
class CameraPath {
public:
  static constexpr double k_fov_degrees = 22; ///< vertical

  /// Not empty. In a loop the last is the first, a cycle later.
  explicit CameraPath(std::vector<CameraKey> keys, bool is_loop = false);

  CameraKey at(double frame) const;
  /// The camera of a scene file, as JSON. The shutter is open for half a frame.
  std::string text() const;
  const std::vector<CameraKey>& keys() const { return keys_; }

private:
  std::vector<CameraKey> keys_;
  Animated<Vec3> position_, look_at_;
};

/// A part of a picture: -1 is its left and lower edge, 1 its right and upper one.
struct PictureBox {
  Vec2d lower{0}, upper{0};
  Vec2d size() const { return upper - lower; }
};

/// What points cover of a picture of the given aspect (width over height).
PictureBox covered(const std::vector<Vec3>& points, const CameraKey& camera, double aspect);

/// A camera that holds the subject in the picture at all of its moments, at about two thirds of the picture's height, or less where it
/// is too wide for that. The moments ascend, at equal distances; in a loop the last one is the first again.
struct FollowOptions {
  int passages = 1; ///< that the subject has one after the other: a way has keys for each
  bool is_loop = false;
};
CameraPath follow(const std::vector<SubjectMoment>& moments, CameraMove move, double aspect, const FollowOptions& options = {});

/// The lights of a scene file, as JSON, for a subject about 3 units across that stands on the origin: the sweep of a photographer.
std::string shot_lights_text();

/// The shape that it stands on, as JSON.
std::string shot_floor_text();

} // namespace kelpie
