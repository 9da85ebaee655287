#include "field/potential/blob.h"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace kelpie {

namespace {

using Solver = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;

Eigen::Matrix3d to_eigen(const Mat3d& m) {
  Eigen::Matrix3d out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = m[j][i];
  return out;
}

} // namespace

SymmetricMat3 to_unit_ball(const Blob& b) {
  const SymmetricMat3& s = b.shape;
  const float by = 1 / b.radius;
  return {s.xx * by, s.yy * by, s.zz * by, s.xy * by, s.xz * by, s.yz * by};
}

HalfAxes half_axes(const Blob& b) {
  if (is_round(b)) return {b.radius, b.radius};
  const Eigen::Vector3d stretches = Solver(to_eigen(b.shape.matrix()), Eigen::EigenvaluesOnly).eigenvalues(); // ascending
  return {static_cast<float>(b.radius / stretches[0]), static_cast<float>(b.radius / stretches[2])};
}

Box3 support(const Blob& b) {
  Vec3 half(b.radius);
  if (!is_round(b)) {
    const Mat3d ball_to_here = glm::inverse(b.shape.matrix()) * double(b.radius); // symmetric: its rows are its columns
    for (int i = 0; i < 3; ++i) half[i] = static_cast<float>(glm::length(ball_to_here[i]) * (1 + 1e-6));
  }
  return {b.centre - half, b.centre + half};
}

bool set_ellipsoid(Blob& b, const Mat3d& m) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!std::isfinite(m[i][j])) return false;
  constexpr double k_room = 1.01; // for rounding
  const Solver solver(to_eigen(glm::transpose(m) * m));
  const Eigen::Vector3d squares = solver.eigenvalues(); // ascending
  if (!(squares[0] > 0) || squares[2] > k_room * k_longest_blob * k_longest_blob * squares[0]) return false;
  const double radius = std::pow(squares.prod(), -1.0 / 6);
  if (!std::isfinite(static_cast<float>(radius)) || !(static_cast<float>(radius) > 0)) return false;
  const Eigen::Matrix3d root = solver.eigenvectors() * (squares.cwiseSqrt() * radius).asDiagonal() * solver.eigenvectors().transpose();
  const auto number = [&](int i, int j) { return static_cast<float>(root(i, j)); };
  b.radius = static_cast<float>(radius);
  b.shape = {number(0, 0), number(1, 1), number(2, 2), number(0, 1), number(0, 2), number(1, 2)};
  return true;
}

SymmetricMat3 between(const SymmetricMat3& a, const SymmetricMat3& b, float part) {
  if (a == b || part <= 0) return a;
  if (part >= 1) return b;
  const auto mean = [&](float x, float y) { return x * (1 - part) + y * part; };
  const SymmetricMat3 m{mean(a.xx, b.xx), mean(a.yy, b.yy), mean(a.zz, b.zz), mean(a.xy, b.xy), mean(a.xz, b.xz), mean(a.yz, b.yz)};
  const auto by = static_cast<float>(1 / std::cbrt(glm::determinant(m.matrix()))); // at least 1: volumes are concave (Minkowski)
  return {m.xx * by, m.yy * by, m.zz * by, m.xy * by, m.xz * by, m.yz * by};
}

std::optional<Blob> mapped(Blob b, const Affine& map) {
  const Mat3d to_ball = b.shape.matrix() / double(b.radius);
  b.centre = Vec3(map(Vec3d(b.centre)));
  if (!set_ellipsoid(b, to_ball * glm::inverse(map.linear))) return {};
  return b;
}

} // namespace kelpie
