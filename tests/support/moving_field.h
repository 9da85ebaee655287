// Fields that move, and rays through them at random times, judged by the reference at the rays' times.
#pragma once

#include "tests/support/every_kind.h"
#include "tests/support/examination.h"

namespace kelpie {

/// A tree at the beginning and at the end of the open shutter.
struct MovingField {
  SampledField start, end;
};

/// What may move of a cloud's blobs.
enum class CloudMotion { centres, everything, some };

inline MovingField moving_cloud(BlobCloud start, double reach, CloudMotion moves) {
  Random r(5);
  BlobCloud end = start;
  for (size_t i = 0; i < end.size(); ++i) {
    if (moves == CloudMotion::some && i % 3) continue;
    Blob& b = end[i];
    b.centre += Vec3(r.direction() * r.uniform(0, reach * b.radius));
    if (moves == CloudMotion::everything) {
      b.radius *= float(r.uniform(0.8, 1.2)), b.weight *= float(r.uniform(0.8, 1.2));
      if (!is_round(b)) {
        const Mat3d turn = glm::mat3_cast(glm::angleAxis(r.uniform(0, 0.3 * reach), r.direction()));
        EXPECT_TRUE(set_ellipsoid(b, to_unit_ball(b).matrix() * turn));
      }
    }
  }
  return {field_of(start), field_of(end)};
}

/// Of a cloud with ellipsoids the matrices move linearly.
inline Blob between(const Blob& a, const Blob& b, bool by_matrix, double u) {
  Blob out = a;
  out.centre = interpolate(a.centre, b.centre, u), out.radius = interpolate(a.radius, b.radius, u);
  out.weight = interpolate(a.weight, b.weight, u);
  const Mat3d from = to_unit_ball(a).matrix(), to = to_unit_ball(b).matrix();
  if (by_matrix && !set_ellipsoid(out, from + (to - from) * u)) ADD_FAILURE();
  return out;
}

/// Numbers move linearly from one to the other.
inline SampledField moving_field_at(const MovingField& field, double u) {
  SampledField out = field.start;
  for (size_t i = 0; i < out.nodes.size(); ++i)
    std::visit(
        [&](auto& kind) {
          const auto& end = std::get<std::decay_t<decltype(kind)>>(field.end.nodes[i]);
          interpolate(kind, end, u, kind);
          if constexpr (requires { kind.cloud; }) {
            auto cloud = std::make_shared<BlobCloud>(*kind.cloud);
            const bool by_matrix = !std::all_of(cloud->begin(), cloud->end(), is_round);
            for (size_t j = 0; j < cloud->size(); ++j) {
              Blob& b = (*cloud)[j];
              const Blob& e = (*end.cloud)[j];
              b = between(b, e, by_matrix, u);
            }
            kind.cloud = cloud;
          }
        },
        out.nodes[i]);
  return out;
}

/// From frame 0, where the shutter opens, to frame 1.
inline FrameScene moving_scene(const MovingField& field, std::array<float, 2> thresholds) {
  const auto moment = [field, thresholds](double t) {
    FrameScene scene = scene_of(moving_field_at(field, t), interpolate(thresholds[0], thresholds[1], t));
    scene.frame = t;
    return scene;
  };
  FrameScene scene = moment(0.5);
  scene.moment = moment, scene.camera.shutter = 1;
  return scene;
}

/// A point of radius 1 that moves along a curve, about a frame.
inline FrameScene point_scene(const Animated<Vec3>& centre, float shutter, double frame = 10) {
  const auto moment = [centre](double at) {
    Point<SampledMode> point;
    point.centre = centre.at(at), point.radius = 1, point.weight = 2;
    SampledField field;
    add(field, point);
    FrameScene scene = scene_of(field);
    scene.frame = at;
    return scene;
  };
  FrameScene scene = moment(frame);
  scene.moment = moment, scene.camera.shutter = shutter;
  scene.breaks = centre.breaks(frame - 0.5 * double(shutter), frame + 0.5 * double(shutter));
  return scene;
}

/// The same field with one warp above each leaf: the engine interpolates the whole map from the world to where a leaf lives.
inline reference::NodePtr with_warps_at_leaves(const reference::Node& node, const reference::Affine& here_from_world = {}) {
  using Kind = reference::Node::Kind;
  auto out = std::make_shared<reference::Node>(node);
  if (node.kind == Kind::warp) {
    const reference::Affine& w = node.child_from_parent;
    reference::Affine all;
    const auto column = [&](reference::Vec axis) { return w.direction(here_from_world.direction(axis)); };
    const reference::Vec x = column({1, 0, 0}), y = column({0, 1, 0}), z = column({0, 0, 1});
    all.rows = {reference::Vec{x.x, y.x, z.x}, reference::Vec{x.y, y.y, z.y}, reference::Vec{x.z, y.z, z.z}};
    all.offset = w.point(here_from_world.offset);
    return with_warps_at_leaves(*node.children[0], all);
  }
  if (node.kind == Kind::leaves) {
    auto warp = std::make_shared<reference::Node>();
    warp->kind = Kind::warp, warp->child_from_parent = here_from_world, warp->children = {out};
    return warp;
  }
  for (reference::NodePtr& child : out->children) child = with_warps_at_leaves(*child, here_from_world);
  return out;
}

/// What the engine traces within a slab of time: between the reference's pictures of both ends, whatever it has by numbers
/// is interpolated, as the program's motion says (renderer/program/motion.h).
inline reference::NodePtr reference_between(const reference::Node& a, const reference::Node& b, double u) {
  auto out = std::make_shared<reference::Node>(a);
  const auto mix = [u](double x, double y) { return x + (y - x) * u; };
  const auto mix_vec = [u](reference::Vec x, reference::Vec y) { return x + (y - x) * u; };
  for (size_t i = 0; i < a.leaves.size(); ++i) {
    reference::Leaf& leaf = out->leaves[i];
    const reference::Leaf& other = b.leaves[i];
    const bool is_blob = a.leaves.size() > 1; // their 1/R^2 is what is interpolated
    leaf.a = mix_vec(leaf.a, other.a), leaf.b = mix_vec(leaf.b, other.b), leaf.weight = mix(leaf.weight, other.weight);
    leaf.radius =
        is_blob ? 1 / std::sqrt(mix(1 / (leaf.radius * leaf.radius), 1 / (other.radius * other.radius))) : mix(leaf.radius, other.radius);
  }
  for (int i = 0; i < 3; ++i) out->child_from_parent.rows[i] = mix_vec(a.child_from_parent.rows[i], b.child_from_parent.rows[i]);
  out->child_from_parent.offset = mix_vec(a.child_from_parent.offset, b.child_from_parent.offset);
  for (size_t i = 0; i < a.children.size(); ++i) out->children[i] = reference_between(*a.children[i], *b.children[i], u);
  return out;
}

/// Random rays at random times, and rays from where they hit, alone and in packets.
inline Tallies judge_moving_rays(const MovingField& field, std::array<float, 2> thresholds, int rays, CellLimits limits,
                                 const std::function<reference::NodePtr(double time)>& node_at) {
  limits.slabs = 1; // within one slab the engine's motion is exactly what is said above
  const PictureAt picture_at = [&](double time) { return Picture{node_at(time), interpolate(thresholds[0], thresholds[1], time)}; };
  return judge_both_ways({moving_scene(field, thresholds), limits, picture_at, {.count = rays, .have_times = true}});
}

inline Tallies judge_moving_rays(const MovingField& field, std::array<float, 2> thresholds, int rays, const CellLimits& limits = {}) {
  const reference::NodePtr start = with_warps_at_leaves(*reference_of(field.start)), end = with_warps_at_leaves(*reference_of(field.end));
  return judge_moving_rays(field, thresholds, rays, limits, [&](double time) { return reference_between(*start, *end, time); });
}

/// Whether a kind moves within a slab by its own numbers, and by nothing else: not what is folded into others, or becomes others.
template <class K>
concept MovesByItself = MovingSkeleton<K> || MovingWarp<K> ||(Operator<K> && !HasOwnOperands<K>);

/// A random tree of which every kind that does so moves by itself, about as far as things do in a slab: less than the thinnest of them
/// reaches. Any picture of it is the tree of the numbers between.
inline MovingField random_moving_field(const EveryKind& every, unsigned trial) {
  Random r(trial);
  MovingField field;
  field.start = every.random_field(trial, r), field.end = field.start;
  double most = 0.15;
  for (const auto& node : field.start.nodes)
    std::visit(
        [&](const auto& kind) {
          if constexpr (Skeleton<std::decay_t<decltype(kind)>>) most = std::min(most, 0.3 * reach_of(kind));
        },
        node);
  for (auto& node : field.end.nodes)
    std::visit(
        [&]<template <class> class Kind>(Kind<SampledMode>& kind) {
          using K = Kind<SampledMode>;
          if constexpr (MovesByItself<K>) interpolate(K(kind), random_kind<Kind>(r), most * r.uniform(0, Warp<K> ? 0.1 : 1), kind);
        },
        node);
  return field;
}

/// Points are folded through warps before they are interpolated, which the reference above does not do.
enum class MovingTree { of_segments, with_points };

/// A random tree, and the same with other numbers, as far away as things go in a slab.
inline MovingField random_moving_tree(unsigned trial, int depth, MovingTree of = MovingTree::of_segments) {
  MovingField field;
  Random r(trial);
  random_tree(r, depth, field.start);
  if (of == MovingTree::of_segments)
    for (auto& node : field.start.nodes)
      if (const auto* p = std::get_if<Point<SampledMode>>(&node)) {
        Segment<SampledMode> s;
        s.from = s.to = p->centre, s.to.x += 0.3f, s.radius = p->radius, s.weight = p->weight, s.falloff = p->falloff;
        node = s;
      }
  field.end = field.start;
  for (auto& node : field.end.nodes)
    if (r.below(4)) // some stand
      std::visit(
          [&]<template <class> class Kind>(Kind<SampledMode>& kind) {
            using K = Kind<SampledMode>;
            const K other = random_kind<Kind>(r);
            interpolate(K(kind), other, std::is_same_v<K, Rotate<SampledMode>> ? 0.03 * r.uniform(0, 1) : 0.3 * r.uniform(0, 1), kind);
            if constexpr (requires { kind.angle; }) kind.angle += float(r.uniform(-20, 20));
          },
          node);
  return field;
}

} // namespace kelpie
