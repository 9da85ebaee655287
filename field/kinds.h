// The kinds of field of this folder. A new kind is its header and its line here.
#pragma once

#include <concepts>

#include "field/clouds/blobs.h"
#include "field/complex/generalized_cylinder.h"
#include "field/complex/patch.h"
#include "field/complex/revolution.h"
#include "field/complex/subdivision.h"
#include "field/operators/blend.h"
#include "field/operators/difference.h"
#include "field/operators/hyper_blend.h"
#include "field/operators/intersection.h"
#include "field/operators/local_blend.h"
#include "field/operators/union.h"
#include "field/skeletons/arc.h"
#include "field/skeletons/box.h"
#include "field/skeletons/circle.h"
#include "field/skeletons/cone.h"
#include "field/skeletons/cone_sphere.h"
#include "field/skeletons/cylinder.h"
#include "field/skeletons/disc.h"
#include "field/skeletons/hollow_cone.h"
#include "field/skeletons/point.h"
#include "field/skeletons/polyhedron.h"
#include "field/skeletons/prism.h"
#include "field/skeletons/rectangle.h"
#include "field/skeletons/segment.h"
#include "field/skeletons/tetrahedron.h"
#include "field/skeletons/torus.h"
#include "field/skeletons/triangle.h"
#include "field/warps/affine.h"
#include "field/warps/bend.h"
#include "field/warps/instance.h"
#include "field/warps/taper.h"
#include "field/warps/twist.h"

namespace kelpie {

using FieldFolderKinds = KindList< //
    Point,                         //
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
    Taper>;

// What a sampled kind can be asked, and so how the engine treats it:

/// Yields blobs: `void append_blobs(BlobCloud&) const`. If their number or order depends on its parameters it has
/// `append_parts` too: the same field of as many blobs, in the same order, whatever these are.
template <class K>
concept BlobSource = requires(const K k, BlobCloud out) {
  k.append_blobs(out);
};
/// A leaf: `Box3 support()`, and `Real potential(Point3<Real>)` for double, Interval and Dual.
template <class K>
concept Skeleton = requires(const K k, Point3<double> p, Point3<Interval> b) {
  k.support();
  k.potential(p);
  k.potential(b);
};
/// A skeleton that can be followed while it changes: `double displacement_from(other)` is how far its solid moves between
/// two states, and any two states whose numbers are interpolated linearly between theirs (the Hausdorff distance; a bound
/// will do). The potential is weight * falloff(d^2 / radius^2), d the distance to the solid. Others stand in a slab of time.
template <class K>
concept MovingSkeleton = Skeleton<K> && requires(const K k) {
  k.displacement_from(k);
  k.radius, k.weight, k.falloff;
};
/// A skeleton whose potential is weight * falloff(d^2/radius^2) of the distance to a cone-sphere:
/// `ConeSphereSolid solid()`.
template <class K>
concept ConeSphereSkeleton = Skeleton<K> && requires(const K k) {
  { k.solid() } -> std::same_as<ConeSphereSolid>;
  k.radius, k.weight, k.falloff;
};
/// Becomes a union of skeletons when a frame is compiled: `Divisions divisions() const` says how finely, for its detail, and
/// `for_each_piece(divisions, emit)` calls emit(skeleton) for as many skeletons, of the same kinds and in the same order, as any
/// other state of it does for these divisions. They live in a space of their own if it has `Affine parent_from_pieces()`.
template <class K>
concept ComplexPrimitive = requires(const K k) {
  { k.divisions() } -> std::same_as<Divisions>;
  k.expansion;
};
/// Joins the values of its children.
template <class K>
concept Operator = requires(const K k, std::span<const double> f, std::span<const Interval> i) {
  k.combine(f, 1.0, Demand::value);
  k.combine(i, 1.0, Demand::value);
};
/// Moves the space of its child affinely.
template <class K>
concept AffineWarp = requires(const K k) {
  k.parent_from_child();
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
/// One that can be followed while it changes: `double displacement_from(other, box)` is how far apart two states, and any two
/// interpolated between them, take a point of the box, in either direction. Others stand in a slab of time.
template <class K>
concept MovingWarp = Warp<K> && requires(const K k) {
  k.displacement_from(k, Box3d{});
};

} // namespace kelpie
