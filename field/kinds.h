// The kinds of field of this folder. A new kind is its header and its line here.
#pragma once

#include <concepts>

#include "field/clouds/blobs.h"
#include "field/complex/generalized_cylinder.h"
#include "field/complex/patch.h"
#include "field/complex/revolution.h"
#include "field/complex/subdivision.h"
#include "field/distances/box.h"
#include "field/distances/capsule.h"
#include "field/distances/cylinder.h"
#include "field/distances/mesh.h"
#include "field/distances/plane.h"
#include "field/distances/sphere.h"
#include "field/distances/torus.h"
#include "field/operators/blend.h"
#include "field/operators/difference.h"
#include "field/operators/hyper_blend.h"
#include "field/operators/intersection.h"
#include "field/operators/local_blend.h"
#include "field/operators/operands.h"
#include "field/operators/union.h"
#include "field/skeletons/arc.h"
#include "field/skeletons/box.h"
#include "field/skeletons/circle.h"
#include "field/skeletons/cone.h"
#include "field/skeletons/cone_sphere.h"
#include "field/skeletons/cylinder.h"
#include "field/skeletons/disc.h"
#include "field/skeletons/ellipsoid.h"
#include "field/skeletons/hollow_cone.h"
#include "field/skeletons/point.h"
#include "field/skeletons/polyhedron.h"
#include "field/skeletons/potential.h"
#include "field/skeletons/prism.h"
#include "field/skeletons/rectangle.h"
#include "field/skeletons/segment.h"
#include "field/skeletons/tetrahedron.h"
#include "field/skeletons/torus.h"
#include "field/skeletons/triangle.h"
#include "field/warps/affine.h"
#include "field/warps/axial.h"
#include "field/warps/bend.h"
#include "field/warps/instance.h"
#include "field/warps/taper.h"
#include "field/warps/twist.h"

namespace kelpie {

using FieldFolderKinds = KindList< //
    Point,                         //
    Ellipsoid,                     //
    Segment,                       //
    ConeSphere,                    //
    Disc,                          //
    Torus,                         //
    Circle,                        //
    Arc,                           //
    FlatTriangle,                  //
    Rectangle,                     //
    Box,                           //
    Cylinder,                      //
    Cone,                          //
    HollowCone,                    //
    Tetrahedron,                   //
    Prism,                         //
    Polyhedron,                    //
    GeneralizedCylinder,           //
    Patch,                         //
    Subdivision,                   //
    Revolution,                    //
    SdfSphere,                     //
    SdfBox,                        //
    SdfCylinder,                   //
    SdfCapsule,                    //
    SdfTorus,                      //
    SdfPlane,                      //
    SdfMesh,                       //
    Blobs,                         //
    Blend,                         //
    Union,                         //
    Intersection,                  //
    Difference,                    //
    HyperBlend,                    //
    LocalBlend,                    //
    Translate,                     //
    Rotate,                        //
    Scale,                         //
    Instance,                      //
    Twist,                         //
    Bend,                          //
    Taper,                         //
    Axial>;

// What a sampled kind can be asked, and so how the engine treats it:

/// Yields blobs: `void append_blobs(BlobCloud&) const`. If their number or order depends on its parameters it has
/// `static uint32_t append_parts(moments, clouds)` too: the same fields, of as many blobs in the same order at all moments that are
/// compiled together, or at one; and the number of the first blob, by which it knows them (LeafIdentity::part).
template <class K>
concept BlobSource = requires(const K k, BlobCloud out) {
  k.append_blobs(out);
};
/// A leaf with a solid: `Box3 support()`, and `solid()`, to which squared_distance(solid, Point3<Real>) is exact for double, Interval
/// and Dual. The potential is weight * falloff(d^2 / radius^2) (field/skeletons/potential.h).
template <class K>
concept SolidSkeleton = requires(const K k, Point3<double> p, Point3<Interval> b) {
  k.support();
  squared_distance(k.solid(), p);
  squared_distance(k.solid(), b);
  k.radius, k.weight, k.falloff;
};
/// A leaf that is a signed distance (field/distances/distance_field.h), and may count in thresholds of the shape.
template <class K>
concept SignedDistance = requires(const K k, Point3<double> p, Point3<Interval> b) {
  k.support();
  k.signed_distance(p);
  k.signed_distance(b);
  k.is_in_thresholds();
};
/// Any leaf that is no cloud: potential(kind, Point3<Real>) for double, Interval and Dual is 0 outside `Box3 support()`.
template <class K>
concept Skeleton = SolidSkeleton<K> || SignedDistance<K>;
/// A skeleton that can be followed while it changes: `double displacement_from(other)` is how far its solid moves between
/// two states, and any two states whose numbers are interpolated linearly between theirs (the Hausdorff distance; a bound
/// will do; of a signed distance that of the surfaces). One without an end says so of a box: `displacement_from(other, box)`.
/// All are: tests/motion_test.cpp.
template <class K>
concept MovingSkeleton = Skeleton<K> &&(
    requires(const K k) { k.displacement_from(k); } || requires(const K k) { k.displacement_from(k, Box3d{}); });
/// Adds skeletons behind the root of its field when a frame is compiled: `for_each_piece(divisions, emit)` calls emit(skeleton) for as many,
/// of the same kinds and in the same order, as any other state of it does. An operator has them as operands.
template <class K>
concept HasPieces = requires(const K k) {
  k.expansion;
};
/// Becomes a union of skeletons when a frame is compiled: `Divisions divisions() const` says how finely, for its detail, and
/// `for_each_piece(divisions, emit)` calls emit(skeleton) for as many skeletons, of the same kinds and in the same order, as any
/// other state of it does for these divisions. They live in a space of their own if it has `Affine parent_from_pieces()`.
template <class K>
concept ComplexPrimitive = HasPieces<K> && requires(const K k) {
  { k.divisions() } -> std::same_as<Divisions>;
};
/// Joins the values of its operands (field/operators/operator.h).
template <class K>
concept Operator = requires(const K k, std::span<const double> f, std::span<const Interval> i, std::span<double> shares) {
  k.combine(f, 1.0, Demand::value);
  k.combine(i, 1.0, Demand::value);
  k.shares(f, 1.0, shares);
};
/// Moves the space of its child in any other way: both directions, for every number type, and a box around the image of a
/// box.
template <class K>
concept Warp = requires(const K k, Point3<double> p, Point3<Interval> b) {
  k.child_from_parent(p);
  k.child_from_parent(b);
  k.parent_from_child(p);
  k.image_of(Box3d{});
};
/// One that tears space: where a box meets a tear, `bool torn_images(Box3d, std::vector<Box3d>&)` yields boxes that hold all its
/// images but those that are nowhere, where no field is; so that nobody has to bound a field all the way from one to another.
template <class K>
concept TearingWarp = Warp<K> && requires(const K k, std::vector<Box3d> images) {
  { k.torn_images(Box3d{}, images) } -> std::same_as<bool>;
};
/// One that can be followed while it changes: `Vec3d displacement_from(other, box, way)` is how far apart, along each coordinate, two
/// states, and any two interpolated between them, take a point of the box. Others stand in a slab of time.
template <class K>
concept MovingWarp = Warp<K> && requires(const K k) {
  { k.displacement_from(k, Box3d{}, WarpWay::to_child) } -> std::same_as<Vec3d>;
};

/// How far from its solid a skeleton reaches.
template <Skeleton K>
double reach_of(const K& kind) {
  if constexpr (SignedDistance<K>)
    return kind.reach();
  else
    return kind.radius;
}
/// How far its solid moves between two states, and any two states interpolated between them, as far as a box sees it.
template <MovingSkeleton K>
double displacement(const K& a, const K& b, const Box3d& box) {
  if constexpr (requires { a.displacement_from(b, box); })
    return a.displacement_from(b, box);
  else
    return a.displacement_from(b);
}
/// Of the potential of a skeleton, what 1 is.
template <Skeleton K, class T>
T potential_unit(const K& kind, const T& threshold) {
  if constexpr (SignedDistance<K>)
    if (kind.is_in_thresholds()) return threshold;
  return T(1.0);
}

} // namespace kelpie
