#include "morph/tree/skeleton_graph.h"

#include <functional>
#include <map>

#include <fmt/format.h>

#include "field/skeletons/frame.h"
#include "morph/tree/computed.h"
#include "morph/tree/mix_kinds.h"

namespace kelpie {

namespace {

using A = AnimatedMode;

std::string_view name_of(const AnimatedKind& kind) {
  return std::visit([](const auto& k) { return k.k_name; }, kind);
}

/// One kind is a special case of another: an arc of the graph.
struct Special {
  std::string_view simple, rich;
  double cost; ///< the dimensions that the rich one has more, and how much dearer its distance is
  /// The simple one as a rich one: the same solid, its lists as long as those of `like`.
  std::function<AnimatedKind(const AnimatedKind& simple, const AnimatedKind& like)> embed;
  /// A simple one that lies in a rich one.
  std::function<AnimatedKind(const AnimatedKind& rich)> project;
};

template <class To, class From>
To with_potential_of(To to, const From& from) {
  to.radius = from.radius, to.weight = from.weight, to.falloff = from.falloff;
  return to;
}

template <class Simple, class Rich, class Embed, class Project>
Special special(double cost, Embed embed, Project project) {
  return {Simple::k_name, Rich::k_name, cost,
          [=](const AnimatedKind& simple, const AnimatedKind& like) -> AnimatedKind {
            const Simple& s = std::get<Simple>(simple);
            const Rich* rich = std::get_if<Rich>(&like);
            if constexpr (std::is_invocable_v<Embed, const Simple&, const Rich*>)
              return with_potential_of(embed(s, rich), s);
            else
              return with_potential_of(embed(s), s);
          },
          [=](const AnimatedKind& rich) -> AnimatedKind {
            const Rich& r = std::get<Rich>(rich);
            return with_potential_of(project(r), r);
          }};
}

Animated<Vec3> centroid(const Animated<Vec3>& a, const Animated<Vec3>& b, const Animated<Vec3>& c) {
  return computed<Vec3>([](const Vec3& x, const Vec3& y, const Vec3& z) { return (x + y + z) / 3.f; }, a, b, c);
}

/// A corner of a box.
Animated<Vec3> corner(const Box<A>& box, int i) {
  const auto place = [i](const Vec3& centre, const Vec3& size, const Vec3& axis, const Vec3& across) {
    const AxisFrame frame{Vec3d(centre), Vec3d(axis), Vec3d(across)};
    const auto side = [&](int bit, float length) { return (i >> bit & 1 ? 0.5 : -0.5) * double(length); };
    const Point3<double> p = frame.global(Point3<double>{side(0, size.x), side(1, size.z), side(2, size.y)});
    return Vec3(p.x, p.y, p.z);
  };
  return computed<Vec3>(place, box.centre, box.size, box.axis, box.across);
}

/// The points of a solid as those of a polyhedron like another: as many, the last ones again and again.
Polyhedron<A> hull_of(std::vector<Animated<Vec3>> points, const Polyhedron<A>* like) {
  while (like && points.size() < like->points.size()) points.push_back(points[points.size() % 4]);
  Polyhedron<A> hull;
  hull.points = std::move(points);
  return hull;
}

/// Along a straight line, with radii that change evenly: as many points as another has.
GeneralizedCylinder<A> straight(const Animated<Vec3>& from, const Animated<Vec3>& to, const Animated<float>& from_radius,
                                const Animated<float>& to_radius, const GeneralizedCylinder<A>* like) {
  GeneralizedCylinder<A> g;
  if (like) g.curve = like->curve, g.detail = like->detail, g.detail_pixels = like->detail_pixels;
  const size_t count = like ? like->points.size() : 2;
  for (size_t i = 0; i < count; ++i) {
    const float t = count > 1 ? float(i) / float(count - 1) : 0;
    g.points.push_back(mixed<Vec3>(from, to, t)), g.radii.push_back(mixed<float>(from_radius, to_radius, t));
  }
  return g;
}

Animated<float> radius_at(const GeneralizedCylinder<A>& g, size_t i) {
  return g.radii.empty() ? Animated<float>(0.f) : g.radii[std::min(i, g.radii.size() - 1)];
}

std::vector<Special> make_graph() {
  std::vector<Special> graph;
  const auto add = [&](Special s) { graph.push_back(std::move(s)); };
  const auto at_point = [](auto kind, const Animated<Vec3>& centre) {
    kind.centre = centre;
    return kind;
  };
  // Every round one has a centre.
  add({Point<A>::k_name, Ellipsoid<A>::k_name, 3,
       [](const AnimatedKind& simple, const AnimatedKind&) -> AnimatedKind {
         const auto& p = std::get<Point<A>>(simple);
         Ellipsoid<A> e;
         e.centre = p.centre, e.weight = p.weight, e.falloff = p.falloff;
         e.radii = computed<Vec3>([](float radius) { return Vec3(radius); }, p.radius);
         return e;
       },
       [](const AnimatedKind& rich) -> AnimatedKind {
         const auto& e = std::get<Ellipsoid<A>>(rich);
         Point<A> p;
         p.centre = e.centre, p.weight = e.weight, p.falloff = e.falloff;
         p.radius = computed<float>([](const Vec3& radii) { return std::min({radii.x, radii.y, radii.z}); }, e.radii);
         return p;
       }});
  add(special<Point<A>, Segment<A>>(
      1,
      [](const Point<A>& p) {
        return Segment<A>{p.centre, p.centre};
      },
      [=](const Segment<A>& s) { return at_point(Point<A>{}, middle(s.from, s.to)); }));
  add(special<Point<A>, Circle<A>>(
      1,
      [=](const Point<A>& p) {
        Circle<A> c = at_point(Circle<A>{}, p.centre);
        c.circle_radius = 0.f;
        return c;
      },
      [=](const Circle<A>& c) { return at_point(Point<A>{}, c.centre); }));
  add(special<Point<A>, Disc<A>>(
      2,
      [=](const Point<A>& p) {
        Disc<A> d = at_point(Disc<A>{}, p.centre);
        d.disc_radius = 0.f;
        return d;
      },
      [=](const Disc<A>& d) { return at_point(Point<A>{}, d.centre); }));
  add(special<Point<A>, Rectangle<A>>(
      2,
      [=](const Point<A>& p) {
        Rectangle<A> r = at_point(Rectangle<A>{}, p.centre);
        r.width = r.height = Animated<float>(0.f);
        return r;
      },
      [=](const Rectangle<A>& r) { return at_point(Point<A>{}, r.centre); }));
  add(special<Point<A>, FlatTriangle<A>>(
      2,
      [](const Point<A>& p) {
        return FlatTriangle<A>{p.centre, p.centre, p.centre};
      },
      [=](const FlatTriangle<A>& t) { return at_point(Point<A>{}, centroid(t.a, t.b, t.c)); }));
  // Along a line.
  add(special<Segment<A>, ConeSphere<A>>(
      1,
      [](const Segment<A>& s) {
        return ConeSphere<A>{s.from, s.to, 0.f, 0.f};
      },
      [](const ConeSphere<A>& c) {
        return Segment<A>{c.from, c.to};
      }));
  add(special<Segment<A>, Cylinder<A>>(
      2,
      [](const Segment<A>& s) {
        return Cylinder<A>{s.from, s.to, 0.f};
      },
      [](const Cylinder<A>& c) {
        return Segment<A>{c.from, c.to};
      }));
  add(special<Segment<A>, HollowCone<A>>(
      2, [](const Segment<A>& s) { return HollowCone<A>{s.from, s.to, 0.f, 0.f, 0.f, 0.f}; },
      [](const HollowCone<A>& c) {
        return Segment<A>{c.from, c.to};
      }));
  add(special<Segment<A>, FlatTriangle<A>>(
      1,
      [](const Segment<A>& s) {
        return FlatTriangle<A>{s.from, s.to, middle(s.from, s.to)};
      },
      [](const FlatTriangle<A>& t) {
        return Segment<A>{t.a, middle(t.b, t.c)};
      }));
  add(special<Cylinder<A>, Cone<A>>(
      0.5,
      [](const Cylinder<A>& c) {
        return Cone<A>{c.from, c.to, c.cylinder_radius, c.cylinder_radius};
      },
      [](const Cone<A>& c) {
        return Cylinder<A>{c.from, c.to, middle(c.from_radius, c.to_radius)};
      }));
  add(special<ConeSphere<A>, GeneralizedCylinder<A>>(
      1,
      [](const ConeSphere<A>& c, const GeneralizedCylinder<A>* like) { return straight(c.from, c.to, c.from_radius, c.to_radius, like); },
      [](const GeneralizedCylinder<A>& g) {
        return ConeSphere<A>{g.points.front(), g.points.back(), radius_at(g, 0), radius_at(g, g.points.size() - 1)};
      }));
  // Round an axis.
  add(special<Circle<A>, Torus<A>>(
      1,
      [](const Circle<A>& c) {
        return Torus<A>{c.centre, c.normal, c.circle_radius, 0.f};
      },
      [](const Torus<A>& t) {
        return Circle<A>{t.centre, t.normal, t.major_radius};
      }));
  add(special<Circle<A>, Arc<A>>(
      0.5,
      [](const Circle<A>& c) {
        return Arc<A>{c.centre, c.normal, Vec3(1, 0, 0), c.circle_radius, 360.f};
      },
      [](const Arc<A>& a) {
        return Circle<A>{a.centre, a.normal, a.arc_radius};
      }));
  // With faces.
  add(special<Rectangle<A>, Box<A>>(
      1,
      [](const Rectangle<A>& r) {
        const auto size = computed<Vec3>([](float width, float height) { return Vec3(width, 0, height); }, r.width, r.height);
        return Box<A>{r.centre, size, r.normal, r.across};
      },
      [](const Box<A>& b) {
        return Rectangle<A>{b.centre, b.axis, b.across, computed<float>([](const Vec3& s) { return s.x; }, b.size),
                            computed<float>([](const Vec3& s) { return s.z; }, b.size)};
      }));
  add(special<FlatTriangle<A>, Prism<A>>(
      1,
      [](const FlatTriangle<A>& t) {
        return Prism<A>{t.a, t.b, t.c, 0.f};
      },
      [](const Prism<A>& p) {
        return FlatTriangle<A>{p.a, p.b, p.c};
      }));
  add(special<FlatTriangle<A>, Tetrahedron<A>>(
      1,
      [](const FlatTriangle<A>& t) {
        return Tetrahedron<A>{t.a, t.b, t.c, centroid(t.a, t.b, t.c)};
      },
      [](const Tetrahedron<A>& t) {
        return FlatTriangle<A>{t.a, t.b, middle(t.c, t.d)};
      }));
  add(special<Tetrahedron<A>, Polyhedron<A>>(
      1,
      [](const Tetrahedron<A>& t, const Polyhedron<A>* like) {
        return hull_of({t.a, t.b, t.c, t.d}, like);
      },
      [](const Polyhedron<A>& p) {
        const size_t n = p.points.size();
        return Tetrahedron<A>{p.points[0], p.points[n / 4], p.points[n / 2], p.points[n - 1 - n / 4]};
      }));
  add(special<Box<A>, Polyhedron<A>>(
      1,
      [](const Box<A>& b, const Polyhedron<A>* like) {
        std::vector<Animated<Vec3>> corners;
        for (int i = 0; i < 8; ++i) corners.push_back(corner(b, i));
        return hull_of(std::move(corners), like);
      },
      [](const Polyhedron<A>& p) {
        Box<A> b;
        b.centre = middle(p.points.front(), p.points[p.points.size() / 2]), b.size = Animated<Vec3>(Vec3(0));
        return b;
      }));
  // Signed distances.
  add(special<SdfSphere<A>, SdfCapsule<A>>(
      1,
      [](const SdfSphere<A>& s) {
        return SdfCapsule<A>{{}, s.centre, s.centre, s.sphere_radius};
      },
      [](const SdfCapsule<A>& c) {
        return SdfSphere<A>{{}, middle(c.from, c.to), c.capsule_radius};
      }));
  return graph;
}

const std::vector<Special>& graph() {
  static const std::vector<Special> all = make_graph();
  return all;
}

/// From a kind to richer ones: the steps on the way to each that can be reached, in order, and what they cost.
struct Climb {
  double cost = 0;
  std::vector<const Special*> steps{};
};
std::map<std::string_view, Climb> climbs_from(std::string_view kind) {
  std::map<std::string_view, Climb> climbs{{kind, {}}};
  for (bool has_changed = true; has_changed;) { // few steps, and no ring
    has_changed = false;
    for (const Special& l : graph()) {
      const auto from = climbs.find(l.simple);
      if (from == climbs.end()) continue;
      Climb climb = from->second;
      climb.cost += l.cost, climb.steps.push_back(&l);
      const auto known = climbs.find(l.rich);
      if (known != climbs.end() && known->second.cost <= climb.cost) continue;
      climbs[l.rich] = std::move(climb), has_changed = true;
    }
  }
  return climbs;
}

AnimatedKind climbed(AnimatedKind kind, const Climb& climb, const AnimatedKind& like) {
  for (const Special* l : climb.steps) kind = l->embed(kind, like);
  return kind;
}
AnimatedKind descended(AnimatedKind kind, const Climb& climb) {
  for (auto l = climb.steps.rbegin(); l != climb.steps.rend(); ++l) kind = (*l)->project(kind);
  return kind;
}

/// Through the cheapest kind that has both as special cases.
std::optional<SkeletonPath> path_over(const AnimatedKind& from, const AnimatedKind& to) {
  const auto a = climbs_from(name_of(from)), b = climbs_from(name_of(to));
  std::optional<SkeletonPath> best;
  for (const auto& [kind, climb] : a) {
    const auto other = b.find(kind);
    if (other == b.end() || (best && best->cost <= climb.cost + other->second.cost)) continue;
    AnimatedKind start = climbed(from, climb, to), end = climbed(to, other->second, from);
    make_comparable(start, end);
    if (!mixed_kind(start, end, 0.5f)) continue; // lists of other lengths, curves made otherwise
    best = SkeletonPath{{{std::move(start), std::move(end)}}, climb.cost + other->second.cost};
  }
  return best;
}

/// Through the cheapest special case of both: half way both are that, in the middle between what they were.
std::optional<SkeletonPath> path_under(const AnimatedKind& from, const AnimatedKind& to) {
  constexpr double k_detour = 2; // to shrink and to grow is seen more than a straight change
  std::optional<SkeletonPath> best;
  for (const Special& l : graph()) {
    const auto climbs = climbs_from(l.simple);
    const auto a = climbs.find(name_of(from)), b = climbs.find(name_of(to));
    if (a == climbs.end() || b == climbs.end()) continue;
    const double cost = k_detour * (a->second.cost + b->second.cost);
    if (best && best->cost <= cost) continue;
    const std::optional<AnimatedKind> halfway = mixed_kind(descended(from, a->second), descended(to, b->second), 0.5f);
    if (!halfway) continue;
    best = SkeletonPath{{{from, climbed(*halfway, a->second, from)}, {climbed(*halfway, b->second, to), to}}, cost};
    for (SkeletonPath::Stage& stage : best->stages) make_comparable(stage.from, stage.to);
  }
  return best;
}

} // namespace

std::optional<SkeletonPath> skeleton_path(const AnimatedKind& from, const AnimatedKind& to) {
  std::optional<SkeletonPath> over = path_over(from, to), under = path_under(from, to);
  if (!under || (over && over->cost <= under->cost)) return over;
  return under;
}

std::string skeleton_graph_dot() {
  std::string text = "digraph skeletons {\n  // from a special case to a richer kind\n";
  for (const Special& l : graph()) text += fmt::format("  {} -> {} [label=\"{}\"];\n", l.simple, l.rich, l.cost);
  return text + "}\n";
}

} // namespace kelpie
