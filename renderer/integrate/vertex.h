// A point where a path meets a surface.
#pragma once

#include <optional>

#include "base/orthonormal_basis.h"
#include "materials/bump.h"
#include "materials/subsurface.h"
#include "renderer/integrate/path.h"

namespace kelpie {

/// Local coordinates at a hit: x lies along the brushing of what is brushed, z is the normal of a surface that heights with a slope raise.
inline OrthonormalBasis basis_at(const Ray& ray, const Hit& hit, const Vec3& facing, const SurfaceParameters& surface, const Vec3& slope) {
  Vec3 normal = facing;
  if (slope != Vec3(0)) normal = seen_normal(facing, raised_normal(facing, facing == hit.normal ? slope : -slope), -ray.direction);
  return surface.specular_roughness_anisotropy > 0 ? OrthonormalBasis(normal, surface.geometry_tangent) : OrthonormalBasis(normal);
}

/// A point of a path on a surface. Local coordinates have the normal on the side of the viewer as z.
struct PathTracer::Vertex {
  Vertex(Path& p, const Hit& h, const Vec3& facing, const OrthonormalBasis& b)
      : path(p), hit(h), true_normal(facing), basis(b), out(basis.local_from_world(-p.ray.direction)) {}

  const SurfaceBsdf& bsdf() const { return own ? *own : *shared; }

  /// A ray towards where light comes from, the same direction in local coordinates and in the world. It starts on the side of
  /// the surface that the shading normal says. Where a facet of a mesh lies on the other side of it, the ray meets that facet
  /// next, and goes through it or is shadowed as by any other.
  Ray leave(const Vec3& in, const Vec3& direction) const { return depart(path.ray, hit, direction, in.z < 0 ? Side::far : Side::near); }
  /// Of light from a direction what bumps do not hide.
  float past_bumps(const Vec3& in, const Vec3& direction) const {
    if (!is_bumped) return 1;
    return in.z < 0 ? glm::dot(true_normal, direction) < 0 : kelpie::past_bumps(true_normal, basis.z, direction);
  }

  /// Whether light from a direction was counted at the last vertex that is not clear (see Path::is_counted).
  bool is_counted(const Vec3& in) const { return in.z < 0 ? path.is_lit_through || path.is_counted : path.is_counted && hit.is_leaving; }

  Path& path;
  const Hit& hit;
  Vec3 true_normal; ///< on the side of the viewer
  OrthonormalBasis basis;
  bool is_clear = false;               ///< light passes
  bool is_bumped = false;              ///< the basis does not stand on the true normal
  float bend = 0;                      ///< by how much normals within the footprint differ
  Vec3 out;                            ///< towards the viewer, local
  const SurfaceBsdf* shared = nullptr; ///< of all hits on the shape, unless this one has its
  std::optional<SurfaceBsdf> own;
  std::optional<SubsurfaceMedium> medium; ///< below the surface, where light wanders there
  Vec3 direct{0};                         ///< light that samples of lights found
};

} // namespace kelpie
