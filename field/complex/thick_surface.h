// Surfaces with thickness, as what complex primitives become: faces with a normal at each corner, and borders that are round.
#pragma once

#include <algorithm>
#include <span>

#include "base/vec.h"
#include "field/skeletons/cone_sphere.h"
#include "field/skeletons/polyhedron.h"
#include "field/skeletons/triangle.h"

namespace kelpie {

/// A place of the middle surface, the unit normal there, and half the thickness.
struct SurfacePoint {
  Vec3d at, normal;
  double half = 0;

  Vec3 above() const { return Vec3(at + normal * half); }
  Vec3 below() const { return Vec3(at - normal * half); }
};

/// Emits the pieces of a surface, all with one potential. Of a thick surface each face is a polyhedron between the corners moved by half
/// the thickness to either side: neighbours have the two corners' edges in common, so there is no crack. Of a thin one it is triangles.
template <class Emit>
struct SurfaceEmitter {
  float radius, weight;
  Falloff falloff;
  bool is_thick;
  Emit& emit;

  /// Of 3 or 4 corners in order.
  void face(std::span<const SurfacePoint> corners) {
    if (is_thick) {
      Polyhedron<SampledMode> p;
      p.points.reserve(2 * corners.size());
      for (const SurfacePoint& c : corners) p.points.push_back(c.above()), p.points.push_back(c.below());
      return put(std::move(p));
    }
    for (size_t i = 2; i < corners.size(); ++i) {
      FlatTriangle<SampledMode> t;
      t.a = Vec3(corners[0].at), t.b = Vec3(corners[i - 1].at), t.c = Vec3(corners[i].at);
      put(std::move(t));
    }
  }
  /// An edge of the border: round, as thick as the surface. (A thin one ends there anyway.)
  void border(const SurfacePoint& a, const SurfacePoint& b) {
    if (!is_thick) return;
    ConeSphere<SampledMode> c;
    c.from = Vec3(a.at), c.to = Vec3(b.at);
    c.from_radius = static_cast<float>(a.half), c.to_radius = static_cast<float>(b.half);
    put(std::move(c));
  }

private:
  template <class Piece>
  void put(Piece piece) {
    piece.radius = radius, piece.weight = weight, piece.falloff = falloff;
    emit(std::move(piece));
  }
};

} // namespace kelpie
