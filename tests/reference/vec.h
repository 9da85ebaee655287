// Three doubles: all the vector algebra that the reference needs.
#pragma once

#include <array>
#include <cmath>

namespace reference {

struct Vec {
  double x = 0, y = 0, z = 0;

  friend Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec operator*(Vec a, double s) { return {a.x * s, a.y * s, a.z * s}; }
};

inline double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double length(Vec a) { return std::sqrt(dot(a, a)); }

/// p -> rows p + offset.
struct Affine {
  std::array<Vec, 3> rows{Vec{1, 0, 0}, Vec{0, 1, 0}, Vec{0, 0, 1}};
  Vec offset;

  Vec direction(Vec d) const { return {dot(rows[0], d), dot(rows[1], d), dot(rows[2], d)}; }
  Vec point(Vec p) const { return direction(p) + offset; }
};

/// The points origin + t direction. The direction need not be a unit vector: t is the caller's.
struct Ray {
  Vec origin, direction;
  Vec at(double t) const { return origin + direction * t; }
};

} // namespace reference
