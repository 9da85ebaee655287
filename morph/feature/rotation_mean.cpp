#include "morph/feature/rotation_mean.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <glm/gtc/quaternion.hpp>

namespace kelpie {

namespace {

/// The angle and axis of a unit quaternion as one vector, by the shorter way around.
Vec3d logarithm(glm::dquat q) {
  if (q.w < 0) q = -q;
  const Vec3d v(q.x, q.y, q.z);
  const double sine = glm::length(v);
  return sine > 0 ? v * (2 * std::atan2(sine, q.w) / sine) : Vec3d(0);
}

glm::dquat exponential(const Vec3d& turn) {
  const double angle = glm::length(turn);
  return angle > 0 ? glm::angleAxis(angle, turn / angle) : glm::dquat(1, 0, 0, 0);
}

/// Where sum w_i (q . q_i)^2 is largest: near the mean, whatever the signs of the quaternions.
glm::dquat first_guess(std::span<const glm::dquat> rotations, std::span<const double> weights) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (size_t i = 0; i < rotations.size(); ++i) {
    const Eigen::Vector4d q(rotations[i].w, rotations[i].x, rotations[i].y, rotations[i].z);
    sum += weights[i] * q * q.transpose();
  }
  const Eigen::Vector4d top = Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(sum).eigenvectors().col(3);
  return glm::normalize(glm::dquat(top[0], top[1], top[2], top[3]));
}

} // namespace

RotationMean mean_rotation(std::span<const Mat3d> rotations, std::span<const double> weights) {
  std::vector<glm::dquat> all;
  for (const Mat3d& m : rotations) all.push_back(glm::normalize(glm::quat_cast(m)));
  glm::dquat mean = first_guess(all, weights);
  constexpr int k_most_steps = 100; // a step divides the error by more than two within a right angle
  for (int step = 0; step < k_most_steps; ++step) {
    Vec3d turn(0);
    for (size_t i = 0; i < all.size(); ++i) turn += weights[i] * logarithm(glm::conjugate(mean) * all[i]);
    mean = glm::normalize(mean * exponential(turn));
    if (glm::length(turn) < 1e-14) break;
  }
  RotationMean out{glm::mat3_cast(mean)};
  for (size_t i = 0; i < all.size(); ++i)
    if (weights[i] > 0) out.farthest = std::max(out.farthest, glm::length(logarithm(glm::conjugate(mean) * all[i])));
  return out;
}

} // namespace kelpie
