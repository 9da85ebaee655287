// The reference's picture of a sampled field, from its parameters alone: nothing that the program
// computes from them is used.
#pragma once

#include <map>

#include <gtest/gtest.h>

#include "morph/field_node.h"
#include "tests/reference/field.h"

namespace kelpie {

inline reference::Vec reference_of(const Vec3& v) { return {v.x, v.y, v.z}; }
inline reference::Falloff reference_of(Falloff f) {
  return f == Falloff::quartic ? reference::Falloff::quartic : f == Falloff::cubic ? reference::Falloff::cubic : reference::Falloff::wyvill;
}
inline reference::Leaf reference_of(const Blob& b) {
  return {
      .a = reference_of(b.centre), .b = reference_of(b.centre), .radius = b.radius, .weight = b.weight, .falloff = reference_of(b.falloff)};
}

/// u = m (p - centre).
inline reference::Affine reference_map(const SymmetricMat3& m, const Vec3d& centre) {
  const auto row = [](double x, double y, double z) { return reference::Vec{x, y, z}; };
  reference::Affine map;
  map.rows = {row(m.xx, m.xy, m.xz), row(m.xy, m.yy, m.yz), row(m.xz, m.yz, m.zz)};
  map.offset = map.direction(reference_of(-centre));
  return map;
}

/// The sum of a cloud: what is no ball is one where its matrix takes it.
inline reference::Node reference_of(const BlobCloud& cloud) {
  reference::Node sum, balls;
  for (const Blob& b : cloud) {
    if (is_round(b)) {
      balls.leaves.push_back(reference_of(b));
      continue;
    }
    auto ball = std::make_shared<reference::Node>(), warp = std::make_shared<reference::Node>();
    ball->leaves = {{.a = {}, .b = {}, .radius = 1, .weight = b.weight, .falloff = reference_of(b.falloff)}};
    warp->kind = reference::Node::Kind::warp, warp->children = {ball};
    warp->child_from_parent = reference_map(to_unit_ball(b), Vec3d(b.centre));
    sum.children.push_back(warp);
  }
  if (sum.children.empty()) return balls;
  sum.kind = reference::Node::Kind::blend;
  if (!balls.leaves.empty()) sum.children.push_back(std::make_shared<reference::Node>(balls));
  return sum;
}
inline reference::Leaf reference_of(const Segment<SampledMode>& k) {
  return {.a = reference_of(k.from), .b = reference_of(k.to), .radius = k.radius, .weight = k.weight, .falloff = reference_of(k.falloff)};
}
inline reference::Leaf reference_of(const ConeSphere<SampledMode>& k) {
  return {.a = reference_of(k.from),
          .b = reference_of(k.to),
          .radius = k.radius,
          .weight = k.weight,
          .falloff = reference_of(k.falloff),
          .shape = reference::Leaf::Shape::cone_sphere,
          .r = k.from_radius,
          .s = k.to_radius};
}
inline reference::Leaf reference_of(const Disc<SampledMode>& k) {
  return {.a = reference_of(k.centre),
          .b = reference_of(k.centre),
          .radius = k.radius,
          .weight = k.weight,
          .falloff = reference_of(k.falloff),
          .shape = reference::Leaf::Shape::disc,
          .r = k.disc_radius,
          .normal = reference_of(k.normal)};
}
inline reference::Leaf reference_of(const Torus<SampledMode>& k) {
  return {.a = reference_of(k.centre),
          .b = reference_of(k.centre),
          .radius = k.radius,
          .weight = k.weight,
          .falloff = reference_of(k.falloff),
          .shape = reference::Leaf::Shape::torus,
          .r = k.major_radius,
          .s = k.minor_radius,
          .normal = reference_of(k.normal)};
}

/// What all leaves have.
template <class Kind>
reference::Leaf reference_leaf(const Kind& k, reference::Leaf::Shape shape, const Vec3& a, const Vec3& b) {
  return {.a = reference_of(a),
          .b = reference_of(b),
          .radius = k.radius,
          .weight = k.weight,
          .falloff = reference_of(k.falloff),
          .shape = shape};
}
inline reference::Leaf reference_of(const Circle<SampledMode>& k) {
  reference::Leaf leaf = reference_leaf(k, reference::Leaf::Shape::torus, k.centre, k.centre);
  leaf.r = k.circle_radius, leaf.normal = reference_of(k.normal);
  return leaf;
}
inline reference::Leaf reference_of(const Arc<SampledMode>& k) {
  reference::Leaf leaf = reference_leaf(k, reference::Leaf::Shape::arc, k.centre, k.centre);
  leaf.r = k.arc_radius, leaf.angle = k.angle, leaf.normal = reference_of(k.normal), leaf.towards = reference_of(k.towards);
  return leaf;
}
inline reference::Leaf reference_of(const Cylinder<SampledMode>& k) {
  reference::Leaf leaf = reference_leaf(k, reference::Leaf::Shape::cone, k.from, k.to);
  leaf.r = leaf.s = k.cylinder_radius;
  return leaf;
}
inline reference::Leaf reference_of(const Cone<SampledMode>& k) {
  reference::Leaf leaf = reference_leaf(k, reference::Leaf::Shape::cone, k.from, k.to);
  leaf.r = k.from_radius, leaf.s = k.to_radius;
  return leaf;
}
inline reference::Leaf reference_of(const HollowCone<SampledMode>& k) {
  reference::Leaf leaf = reference_leaf(k, reference::Leaf::Shape::wall, k.from, k.to);
  leaf.r = k.from_radius, leaf.s = k.to_radius, leaf.r_thickness = k.from_thickness, leaf.s_thickness = k.to_thickness;
  return leaf;
}
inline reference::Leaf reference_of(const Rectangle<SampledMode>& k) {
  reference::Leaf leaf = reference_leaf(k, reference::Leaf::Shape::box, k.centre, k.centre);
  leaf.normal = reference_of(k.normal), leaf.towards = reference_of(k.across), leaf.size = {k.width, 0, k.height};
  return leaf;
}
inline reference::Leaf reference_of(const Box<SampledMode>& k) {
  reference::Leaf leaf = reference_leaf(k, reference::Leaf::Shape::box, k.centre, k.centre);
  leaf.normal = reference_of(k.axis), leaf.towards = reference_of(k.across), leaf.size = reference_of(k.size);
  return leaf;
}
template <class Kind>
reference::Leaf reference_hull(const Kind& k, const std::vector<Vec3>& points) {
  reference::Leaf leaf = reference_leaf(k, reference::Leaf::Shape::hull, points[0], points[0]);
  for (const Vec3& p : points) leaf.points.push_back(reference_of(p));
  return leaf;
}
inline reference::Leaf reference_of(const FlatTriangle<SampledMode>& k) { return reference_hull(k, {k.a, k.b, k.c}); }
inline reference::Leaf reference_of(const Tetrahedron<SampledMode>& k) { return reference_hull(k, {k.a, k.b, k.c, k.d}); }
inline reference::Leaf reference_of(const Polyhedron<SampledMode>& k) { return reference_hull(k, k.points); }
/// The normal of a triangle that is a line: y, made perpendicular to it.
inline reference::Vec reference_normal(const Prism<SampledMode>& k) {
  const Vec3d a(k.a), b(k.b), c(k.c);
  if (const Vec3d n = glm::cross(b - a, c - a); n != Vec3d(0)) return {n.x, n.y, n.z};
  const Vec3d line = a != b ? b - a : c - a;
  if (line == Vec3d(0)) return {0, 1, 0};
  const Vec3d n = glm::cross(glm::cross(line, Vec3d(0, 1, 0)), line);
  return n == Vec3d(0) ? reference::Vec{1, 0, 0} : reference::Vec{n.x, n.y, n.z};
}
inline reference::Leaf reference_of(const Prism<SampledMode>& k) {
  reference::Leaf leaf = reference_hull(k, {k.a, k.b, k.c});
  const reference::Vec n = reference_normal(k), half = n * (0.5 * k.thickness / length(n));
  for (int i = 0; i < 3; ++i) leaf.points.push_back(leaf.points[i] - half), leaf.points[i] = leaf.points[i] + half;
  return leaf;
}

template <class Kind>
reference::Leaf reference_distance(const Kind& k, reference::Leaf::Shape shape, const Vec3& a, const Vec3& b, double thickness) {
  reference::Leaf leaf{.a = reference_of(a),
                       .b = reference_of(b),
                       .radius = k.radius > 0 ? double(k.radius) : thickness,
                       .weight = k.weight,
                       .shape = shape};
  leaf.falloff = k.falloff == DistanceFalloff::distance  ? reference::Falloff::distance
                 : k.falloff == DistanceFalloff::quartic ? reference::Falloff::quartic
                 : k.falloff == DistanceFalloff::cubic   ? reference::Falloff::cubic
                                                         : reference::Falloff::wyvill;
  return leaf;
}
inline reference::Leaf reference_of(const SdfSphere<SampledMode>& k) {
  reference::Leaf leaf = reference_distance(k, reference::Leaf::Shape::capsule, k.centre, k.centre, k.sphere_radius);
  leaf.r = k.sphere_radius;
  return leaf;
}
inline reference::Leaf reference_of(const SdfCapsule<SampledMode>& k) {
  reference::Leaf leaf = reference_distance(k, reference::Leaf::Shape::capsule, k.from, k.to, k.capsule_radius);
  leaf.r = k.capsule_radius;
  return leaf;
}
inline reference::Leaf reference_of(const SdfTorus<SampledMode>& k) {
  reference::Leaf leaf = reference_distance(k, reference::Leaf::Shape::ring, k.centre, k.centre, k.minor_radius);
  leaf.r = k.major_radius, leaf.s = k.minor_radius, leaf.normal = reference_of(k.normal);
  return leaf;
}
inline reference::Leaf reference_of(const SdfBox<SampledMode>& k) {
  const double half = 0.5 * std::min({k.size.x, k.size.y, k.size.z});
  reference::Leaf leaf = reference_distance(k, reference::Leaf::Shape::block, k.centre, k.centre, half);
  leaf.normal = reference_of(k.axis), leaf.towards = reference_of(k.across), leaf.size = reference_of(k.size);
  leaf.r = std::min(double(k.rounding), half);
  return leaf;
}
inline reference::Leaf reference_of(const SdfCylinder<SampledMode>& k) {
  const double half = 0.5 * glm::distance(Vec3d(k.from), Vec3d(k.to));
  reference::Leaf leaf = reference_distance(k, reference::Leaf::Shape::rod, k.from, k.to, std::min(half, double(k.cylinder_radius)));
  leaf.r = k.cylinder_radius;
  return leaf;
}
inline reference::Leaf reference_of(const SdfPlane<SampledMode>& k) {
  reference::Leaf leaf = reference_distance(k, reference::Leaf::Shape::below, k.point, k.point, 1);
  leaf.normal = reference_of(k.normal);
  return leaf;
}

/// The samples are the grid's; what is between them is the reference's.
inline reference::Leaf reference_of(const SdfMesh<SampledMode>& k) {
  static std::map<std::shared_ptr<const DistanceGrid>, std::shared_ptr<const reference::Table>> tables;
  std::shared_ptr<const reference::Table>& table = tables[k.grid];
  const Box3d& box = k.grid->box();
  if (!table) {
    auto made = std::make_shared<reference::Table>();
    made->step = k.grid->voxel();
    made->count = k.grid->sample_count();
    for (int z = 0; z < made->count[2]; ++z)
      for (int y = 0; y < made->count[1]; ++y)
        for (int x = 0; x < made->count[0]; ++x) made->values.push_back(k.grid->sample({x, y, z}));
    table = made;
  }
  const float reach = k.radius > 0 ? std::min(k.radius, float(k.grid->band())) : float(k.grid->band());
  reference::Leaf leaf = reference_distance(k, reference::Leaf::Shape::table, Vec3(0), Vec3(0), reach);
  leaf.a = {box.lower.x, box.lower.y, box.lower.z}, leaf.b = leaf.a, leaf.radius = std::min(leaf.radius, k.grid->band()),
  leaf.table = table;
  return leaf;
}

/// Rodrigues' formula for the opposite angle, row by row.
inline reference::Affine reference_inverse(const Rotate<SampledMode>& k) {
  const reference::Vec e = reference_of(k.axis) * (1 / length(reference_of(k.axis)));
  const double angle = -double(k.angle) * std::acos(-1.0) / 180, c = std::cos(angle), s = std::sin(angle);
  reference::Affine w;
  w.rows = {reference::Vec{c + e.x * e.x * (1 - c), e.x * e.y * (1 - c) - e.z * s, e.x * e.z * (1 - c) + e.y * s},
            reference::Vec{e.y * e.x * (1 - c) + e.z * s, c + e.y * e.y * (1 - c), e.y * e.z * (1 - c) - e.x * s},
            reference::Vec{e.z * e.x * (1 - c) - e.y * s, e.z * e.y * (1 - c) + e.x * s, c + e.z * e.z * (1 - c)}};
  w.offset = reference_of(k.centre) - w.direction(reference_of(k.centre));
  return w;
}
inline reference::Affine reference_inverse(const Translate<SampledMode>& k) {
  reference::Affine w;
  w.offset = reference_of(k.by) * -1;
  return w;
}
inline reference::Affine reference_inverse(const Scale<SampledMode>& k) {
  reference::Affine w;
  w.rows = {reference::Vec{1.0 / k.by.x, 0, 0}, reference::Vec{0, 1.0 / k.by.y, 0}, reference::Vec{0, 0, 1.0 / k.by.z}};
  w.offset = reference_of(k.centre) - w.direction(reference_of(k.centre));
  return w;
}

inline reference::Affine reference_inverse(const Instance<SampledMode>& k) {
  reference::Affine w = reference_inverse(Rotate<SampledMode>{k.axis, k.angle});
  for (int i = 0; i < 3; ++i) w.rows[i] = w.rows[i] * (1.0 / k.scale[i]);
  w.offset = w.direction(reference_of(k.position)) * -1;
  return w;
}

/// Below a blend of several fields the automatic formula is the smooth one.
inline bool reference_is_smooth(BooleanFormula formula, bool is_below_blend) {
  return formula == BooleanFormula::smooth || (formula == BooleanFormula::automatic && is_below_blend);
}
template <class Kind>
reference::Node::Kind reference_kind_of(const Kind& k, bool is_below_blend) {
  using To = reference::Node::Kind;
  if constexpr (std::is_same_v<Kind, Blend<SampledMode>>) return To::blend;
  if constexpr (std::is_same_v<Kind, HyperBlend<SampledMode>>) return To::hyper_blend;
  if constexpr (std::is_same_v<Kind, LocalBlend<SampledMode>>) return To::local_blend;
  if constexpr (requires { k.formula; }) {
    const bool is_smooth = reference_is_smooth(k.formula, is_below_blend);
    if constexpr (std::is_same_v<Kind, Union<SampledMode>>) return is_smooth ? To::r_unite : To::unite;
    if constexpr (std::is_same_v<Kind, Intersection<SampledMode>>) return is_smooth ? To::r_intersect : To::intersect;
    if constexpr (std::is_same_v<Kind, Difference<SampledMode>>) return is_smooth ? To::r_subtract : To::subtract;
  }
}
inline reference::Axis reference_of(const AxialAxis<SampledMode>& k) {
  reference::Axis axis;
  for (const Vec3& p : k.rest) axis.rest.push_back(reference_of(p));
  for (const Vec3& p : k.deformed) axis.deformed.push_back(reference_of(p));
  for (const auto& f : k.frames) axis.frames.push_back({f.at, f.angle});
  axis.degree = k.degree, axis.normal = reference_of(k.normal), axis.is_cosine = k.interpolation == FrameInterpolation::cosine;
  axis.radius = k.radius, axis.border = k.border;
  return axis;
}

/// The pieces of a complex primitive, as finely divided as it asks for.
template <ComplexPrimitive Kind>
std::vector<reference::NodePtr> reference_pieces(const Kind& kind) {
  std::vector<reference::NodePtr> pieces;
  kind.for_each_piece(kind.divisions(), [&](const auto& piece) {
    const auto node = std::make_shared<reference::Node>();
    node->leaves = {reference_of(piece)};
    pieces.push_back(node);
  });
  return pieces;
}

inline std::shared_ptr<reference::Node> reference_below(const Affine& child_from_parent, const reference::NodePtr& child) {
  auto out = std::make_shared<reference::Node>();
  out->kind = reference::Node::Kind::warp, out->children = {child};
  const Mat3d rows = glm::transpose(child_from_parent.linear);
  for (int i = 0; i < 3; ++i) out->child_from_parent.rows[i] = {rows[i].x, rows[i].y, rows[i].z};
  out->child_from_parent.offset = {child_from_parent.offset.x, child_from_parent.offset.y, child_from_parent.offset.z};
  return out;
}

inline std::shared_ptr<const reference::Mix> reference_of(const Metamorphosis<SampledMode>& k) {
  auto mix = std::make_shared<reference::Mix>();
  for (const auto& object : k.objects) {
    std::vector<reference::Element>& own = mix->objects.emplace_back();
    for (const auto& e : object.elements)
      own.push_back({e.name, reference_of(e.centre), reference_of(e.size), reference_of(e.axis), reference_of(e.across), e.rounding});
  }
  const auto widened = [](const std::vector<float>& v) { return std::vector<double>(v.begin(), v.end()); };
  for (const auto& f : k.features) {
    std::vector<reference::Flow> flows;
    for (const space_time::Blend& b : f.blends) flows.push_back({b.unit, b.displacement});
    mix->features.push_back(
        {f.name, widened(f.weights), widened(f.frame_weights), f.offset, f.fade_length(), f.name == k_background, flows});
  }
  mix->is_space_time = k.function == MorphFunction::space_time, mix->passage = k.passage, mix->time_influence = k.time_influence;
  for (const auto& object : k.objects) mix->influences.push_back(object.influence);
  mix->sharpness = k.sharpness, mix->margin = k.margin, mix->reach = k.reach;
  return mix;
}

inline reference::NodePtr reference_element(const reference::Mix& mix, const reference::MixFeature& feature) {
  const reference::Element e = mean_element(mix, feature);
  auto out = std::make_shared<reference::Node>();
  reference::Leaf leaf{.a = e.centre, .b = e.centre, .radius = mix.reach, .weight = 1, .shape = reference::Leaf::Shape::block};
  leaf.falloff = reference::Falloff::distance, leaf.normal = e.axis, leaf.towards = e.across, leaf.size = e.size;
  leaf.r = std::min(e.rounding, 0.5 * std::min({e.size.x, e.size.y, e.size.z}));
  out->leaves = {leaf};
  return out;
}

/// The subtree at `node`.
inline reference::NodePtr reference_of(const SampledField& field, unsigned node, bool is_below_blend = false) {
  using Kind = reference::Node::Kind;
  auto out = std::make_shared<reference::Node>();
  std::visit(
      [&]<template <class> class K>(const K<SampledMode>& k) {
        using S = K<SampledMode>;
        if constexpr (BlobSource<S>) {
          BlobCloud cloud;
          k.append_blobs(cloud);
          *out = reference_of(cloud);
        } else if constexpr (Skeleton<S>) {
          out->leaves = {reference_of(k)};
        } else if constexpr (ComplexPrimitive<S>) {
          out->kind = Kind::unite, out->children = reference_pieces(k);
          if constexpr (requires { k.parent_from_pieces(); }) out = reference_below(inverse(k.parent_from_pieces()), out);
        } else if constexpr (AffineWarp<S>) {
          out->kind = Kind::warp, out->child_from_parent = reference_inverse(k),
          out->children = {reference_of(field, k.child, is_below_blend)};
        } else if constexpr (std::is_same_v<S, Twist<SampledMode>>) {
          out->kind = Kind::twist, out->centre = reference_of(k.centre), out->axis = reference_of(k.axis);
          out->rate = k.rate, out->length = k.length, out->children = {reference_of(field, k.child, is_below_blend)};
        } else if constexpr (std::is_same_v<S, Taper<SampledMode>>) {
          out->kind = Kind::taper, out->centre = reference_of(k.centre), out->axis = reference_of(k.axis);
          out->by = k.by, out->length = k.length, out->children = {reference_of(field, k.child, is_below_blend)};
        } else if constexpr (std::is_same_v<S, Bend<SampledMode>>) {
          out->kind = Kind::bend, out->centre = reference_of(k.centre), out->axis = reference_of(k.axis);
          out->towards = reference_of(k.towards), out->angle = k.angle, out->length = k.length;
          out->children = {reference_of(field, k.child, is_below_blend)};
        } else if constexpr (std::is_same_v<S, Axial<SampledMode>>) {
          auto axial = std::make_shared<reference::Axial>();
          for (const auto& axis : k.axes) axial->axes.push_back(reference_of(axis));
          axial->prepare();
          out->kind = Kind::axial, out->axial = axial, out->children = {reference_of(field, k.child, is_below_blend)};
        } else if constexpr (std::is_same_v<S, Metamorphosis<SampledMode>>) {
          const auto mix = reference_of(k);
          out->kind = Kind::mix, out->mix = mix;
          for (const auto& feature : mix->features)
            if (!feature.is_background) out->children.push_back(reference_element(*mix, feature));
          for (const auto& feature : mix->features)
            for (size_t j = 0; j < k.objects.size(); ++j) {
              auto seen = std::make_shared<reference::Node>();
              seen->kind = Kind::warp, seen->child_from_parent = object_from_child(*mix, feature, j);
              seen->children = {reference_of(field, k.objects[j].field, true)};
              out->children.push_back(seen);
            }
        } else if constexpr (Operator<S>) {
          out->kind = reference_kind_of(k, is_below_blend);
          if constexpr (std::is_same_v<S, HyperBlend<SampledMode>>) out->n = k.n;
          std::vector<unsigned> children = k.children;
          if constexpr (requires { k.region; }) children.push_back(k.region);
          const bool is_below = is_below_blend || (!requires { k.formula; } && children.size() > 1);
          for (const unsigned child : children) out->children.push_back(reference_of(field, child, is_below));
        } else {
          static_assert(BlobSource<S>, "teach the reference this kind");
        }
      },
      field.nodes[node]);
  if (node < field.materials.size() && field.materials[node].is_set()) out->material = int(field.materials[node].index);
  return out;
}
inline reference::NodePtr reference_of(const SampledField& field) {
  return reference_of(field, static_cast<unsigned>(field.nodes.size() - 1));
}

} // namespace kelpie
