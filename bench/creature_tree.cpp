#include "bench/creature_tree.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/vec.h"

namespace kelpie {

namespace {

constexpr double k_pi = 3.14159265358979;
/// Of every cone-sphere; its surface is then where the falloff is 1/2, this many radii of influence from the solid.
constexpr double k_weight = 2, k_surface_at = 0.5411961;
/// The radius of influence of a limb as a share of its visible radius: how far it flows into its neighbours.
constexpr double k_softness = 0.8;

/// Fields as text: a field is what a scene file says of it.
using Field = std::string;
using Fields = std::vector<Field>;

Field join(const char* kind, const Fields& children) {
  return fmt::format("{{\"kind\":\"{}\",\"children\":[\n{}]}}", kind, fmt::join(children, ",\n"));
}
Field blend(const Fields& children) { return join("blend", children); }
Field unite(const Fields& children) { return join("union\",\"formula\":\"sharp", children); }
Field r_unite(const Fields& children) { return join("union", children); }
Field twist(const Vec3d& centre, double rate, const Field& child) {
  return fmt::format("{{\"kind\":\"twist\",\"axis\":[0,1,0],\"centre\":[{:.4f},{:.4f},{:.4f}],\"rate\":{:.4f},\"child\":{}}}", centre.x,
                     centre.y, centre.z, rate, child);
}

Field bend(const Vec3d& centre, double length, double angle, const Field& child) {
  return fmt::format("{{\"kind\":\"bend\",\"axis\":[0,1,0],\"towards\":[1,0,0],\"centre\":[{:.4f},{:.4f},{:.4f}],\"length\":{:.4f},"
                     "\"angle\":{:.4f},\"child\":{}}}",
                     centre.x, centre.y, centre.z, length, angle, child);
}

/// A cone-sphere whose surface, when it is alone, has the radii a and b at its ends.
Field cone(const Vec3d& from, const Vec3d& to, double a, double b, double weight = k_weight) {
  const double influence = k_softness * std::min(a, b), skin = k_surface_at * influence;
  return fmt::format("{{\"kind\":\"cone_sphere\",\"from\":[{:.5f},{:.5f},{:.5f}],\"to\":[{:.5f},{:.5f},{:.5f}],\"from_radius\":{:.5f},"
                     "\"to_radius\":{:.5f},\"radius\":{:.5f},\"weight\":{:.4f},\"falloff\":\"quartic\"}}",
                     from.x, from.y, from.z, to.x, to.y, to.z, a - skin, b - skin, influence, weight);
}

/// A curve with a radius at each place, u in [0, 1].
struct Limb {
  std::function<Vec3d(double)> at;
  std::function<double(double)> radius;
};

/// A generalized cylinder: cone-spheres end to end.
Fields chain(const Limb& limb, int count, double weight = k_weight) {
  Fields out;
  for (int i = 0; i < count; ++i) {
    const double u = double(i) / count, v = double(i + 1) / count;
    out.push_back(cone(limb.at(u), limb.at(v), limb.radius(u), limb.radius(v), weight));
  }
  return out;
}

/// The same as a sum: each cone-sphere reaches over its neighbours, and the weight is such that together they are
/// as thick as the limb.
Field summed_chain(const Limb& limb, int count) {
  const double step = glm::distance(limb.at(0.5), limb.at(0.5 + 1.0 / count)), radius = limb.radius(0.5);
  const double influence = k_softness * radius, core = radius - k_surface_at * influence;
  double sum = 0;
  for (int i = -count; i <= count; ++i) {
    const double along = std::max(0.0, (std::abs(i) - 0.5) * step), d = (std::hypot(along, radius) - core) / influence;
    sum += d < 1 ? (1 - d * d) * (1 - d * d) : 0;
  }
  return blend(chain(limb, count, 1 / sum));
}

double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

/// Catmull and Rom's spline through points with radii.
struct Spine {
  std::vector<glm::dvec4> points; ///< x y z radius
  glm::dvec4 at(double u) const {
    const auto last = static_cast<int>(points.size()) - 1;
    const double x = std::clamp(u, 0.0, 1.0) * last;
    const int i = std::min(static_cast<int>(x), last - 1);
    const auto p = [&](int k) { return points[static_cast<size_t>(std::clamp(k, 0, last))]; };
    const double t = x - i;
    const glm::dvec4 a = p(i - 1), b = p(i), c = p(i + 1), d = p(i + 2);
    return 0.5 * (2.0 * b + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * (t * t) + (3.0 * b - a - 3.0 * c + d) * (t * t * t));
  }
  Vec3d place(double u) const { return Vec3d(at(u)); }
  double radius(double u) const { return at(u).w; }
  Vec3d tangent(double u) const { return glm::normalize(place(u + 1e-3) - place(u - 1e-3)); }
  Vec3d side(double u) const { return glm::normalize(glm::cross(tangent(u), Vec3d(1e-3, 0, 1))); }
  /// A unit vector across the spine; 0 degrees: the back.
  Vec3d across(double u, double degrees) const {
    const Vec3d back = glm::normalize(side(u) - tangent(u) * glm::dot(side(u), tangent(u))), left = glm::cross(tangent(u), back);
    return back * std::cos(degrees * k_pi / 180) + left * std::sin(degrees * k_pi / 180);
  }
};

/// From the neck down the belly into a coiled tail.
const Spine k_spine{{{0.12, 2.55, 0, 0.21},
                     {-0.22, 2.34, 0, 0.20},
                     {-0.30, 1.98, 0, 0.23},
                     {-0.06, 1.55, 0, 0.35},
                     {0.06, 1.10, 0, 0.41},
                     {-0.08, 0.62, 0, 0.34},
                     {-0.42, 0.22, 0, 0.25},
                     {-0.66, -0.24, 0, 0.20},
                     {-0.52, -0.74, 0, 0.165},
                     {-0.04, -0.98, 0.02, 0.14},
                     {0.42, -0.78, 0.05, 0.12},
                     {0.52, -0.36, 0.08, 0.10},
                     {0.24, -0.16, 0.10, 0.08},
                     {0.02, -0.34, 0.12, 0.062},
                     {0.12, -0.54, 0.14, 0.045},
                     {0.27, -0.46, 0.16, 0.03}}};

Field body() {
  return unite(chain({[](double u) { return k_spine.place(u); }, [](double u) { return k_spine.radius(u); }}, 240));
}

/// Rings of knobs, as sea-horses have them.
Fields plates() {
  Fields out;
  for (int ring = 0; ring < 44; ++ring) {
    const double u = 0.05 + 0.85 * ring / 44, r = k_spine.radius(u);
    for (int i = 0; i < 9; ++i) {
      const double degrees = 40.0 * i + 20;
      const Vec3d d = k_spine.across(u, degrees), p = k_spine.place(u);
      out.push_back(cone(p + d * (0.9 * r), p + d * (1.06 * r), 0.16 * r, 0.08 * r));
    }
  }
  return out;
}

Field head() {
  Fields parts;
  const Limb skull{[](double u) { return Vec3d(0.12 + 0.36 * u, 2.55 + 0.16 * std::sin(2.2 * u), 0); },
                   [](double u) { return 0.21 + 0.06 * std::sin(k_pi * u) - 0.07 * u; }};
  const Limb snout{[](double u) { return Vec3d(0.48 + 0.52 * u, 2.64 - 0.26 * u, 0); },
                   [](double u) { return 0.13 - 0.05 * std::sin(k_pi * u * 0.8) + 0.01 * u; }};
  parts.push_back(r_unite({unite(chain(skull, 12)), unite(chain(snout, 14))}));
  for (const double z : {-1.0, 1.0}) {
    parts.push_back(cone(Vec3d(0.30, 2.79, 0.13 * z), Vec3d(0.46, 2.77, 0.12 * z), 0.07, 0.05));  // brow
    parts.push_back(cone(Vec3d(0.98, 2.42, 0.06 * z), Vec3d(1.02, 2.40, 0.07 * z), 0.05, 0.035)); // nostril
    parts.push_back(cone(Vec3d(0.25, 2.50, 0.15 * z), Vec3d(0.42, 2.46, 0.10 * z), 0.09, 0.06));  // cheek
  }
  return blend(parts);
}

Field eyes() {
  Fields out;
  for (const double z : {-1.0, 1.0}) out.push_back(cone(Vec3d(0.41, 2.70, 0.155 * z), Vec3d(0.42, 2.70, 0.165 * z), 0.06, 0.06));
  return unite(out);
}

/// An arm that ends in claws.
Field arm(double z) {
  const Vec3d shoulder(0.18, 1.46, 0.26 * z), elbow(0.52, 1.06, 0.62 * z), wrist(0.94, 1.30, 0.50 * z);
  const auto straight = [](Vec3d a, Vec3d b, Vec3d bulge, double ra, double rb) {
    return Limb{[=](double u) { return glm::mix(a, b, u) + bulge * std::sin(k_pi * u); },
                [=](double u) { return glm::mix(ra, rb, u) + 0.25 * ra * std::sin(k_pi * u); }};
  };
  Fields parts{unite(chain(straight(shoulder, elbow, Vec3d(0, 0.03, 0.04 * z), 0.115, 0.085), 14)),
               unite(chain(straight(elbow, wrist, Vec3d(0.02, -0.04, 0), 0.085, 0.06), 14))};
  for (int claw = 0; claw < 4; ++claw) {
    const double a = (claw - 1.5) * 0.55;
    const Limb limb{[=](double u) {
                      return wrist +
                             Vec3d(0.30 * u, 0.16 * std::sin(2.6 * u) + 0.10 * std::sin(a) * u - 0.22 * u * u, 0.26 * std::sin(a) * u);
                    },
                    [](double u) { return 0.048 * (1 - u) + 0.007 + 0.012 * std::sin(5 * k_pi * u) * (1 - u); }};
    parts.push_back(unite(chain(limb, 9)));
  }
  return r_unite(parts);
}

/// Tentacles from the back of the head and the neck; each is a sum.
Field mane(std::mt19937_64& random) {
  Fields out;
  for (int i = 0; i < 30; ++i) {
    const double u = 0.005 + 0.19 * uniform(random), degrees = -65 + 130 * uniform(random), length = 0.55 + 0.5 * uniform(random);
    const double phase = 2 * k_pi * uniform(random), wave = 0.05 + 0.04 * uniform(random);
    const Vec3d root = k_spine.place(u) + k_spine.across(u, degrees) * (0.8 * k_spine.radius(u)), d = k_spine.across(u, degrees);
    const Limb limb{[=](double v) {
                      const double s = wave * v * 2;
                      return root + d * (length * v * (1 - 0.35 * v)) +
                             Vec3d(-0.25 * v * v + s * std::sin(7 * v + phase), -0.45 * length * v * v, s * std::cos(7 * v + phase));
                    },
                    [](double v) { return 0.052 * (1 - v) + 0.012; }};
    out.push_back(summed_chain(limb, 20));
  }
  return r_unite(out);
}

/// Spikes along the back.
Field fin() {
  Fields out;
  for (int i = 0; i < 32; ++i) {
    const double u = 0.20 + 0.42 * i / 32, r = k_spine.radius(u), length = 0.26 * std::sin(k_pi * (i + 2) / 35) + 0.06;
    const Vec3d root = k_spine.place(u) + k_spine.across(u, 0) * (0.85 * r), d = k_spine.across(u, 0), t = k_spine.tangent(u);
    const Limb limb{[=](double v) { return root + d * ((length + 0.15 * r) * v) + t * (0.35 * length * v * v); },
                    [](double v) { return 0.034 * (1 - v) + 0.006; }};
    out.push_back(unite(chain(limb, 6)));
  }
  return unite(out);
}

/// Stems with leaves, as leafy sea-dragons have them.
Field weeds(std::mt19937_64& random) {
  Fields out;
  for (int i = 0; i < 22; ++i) {
    const double u = 0.30 + 0.42 * i / 22, degrees = (i % 2 ? 1 : -1) * (62 + 60 * uniform(random)), length = 0.26 + 0.2 * uniform(random);
    const double phase = 2 * k_pi * uniform(random);
    const Vec3d d = k_spine.across(u, degrees), root = k_spine.place(u) + d * (0.85 * k_spine.radius(u));
    const auto place = [=](double v) {
      return root + d * (length * v) + Vec3d(0.04 * std::sin(6 * v + phase), -0.10 * v * v, 0.04 * std::cos(6 * v + phase) * v);
    };
    Fields parts{unite(chain({place, [](double v) { return 0.030 * (1 - v) + 0.012; }}, 8))};
    for (int leaf = 0; leaf < 4; ++leaf) {
      const double v = 0.45 + 0.18 * leaf, turn = leaf % 2 ? 1 : -1;
      const Vec3d p = place(v), way = glm::normalize(d + k_spine.tangent(u) * (1.3 * turn) + Vec3d(0, 0.2, 0));
      const Limb limb{[=](double w) { return p + way * (0.16 * w) + Vec3d(0, -0.05 * w * w, 0); },
                      [](double w) { return 0.012 + 0.026 * std::sin(k_pi * std::min(1.0, w * 1.05)); }};
      parts.push_back(blend(chain(limb, 3)));
    }
    out.push_back(r_unite(parts));
  }
  return r_unite(out);
}

} // namespace

std::string_view creature_name(CreatureWarps warps) {
  switch (warps) {
  case CreatureWarps::none: return "creature";
  case CreatureWarps::twist: return "creature_twisted";
  case CreatureWarps::bend: return "creature_bent";
  }
  return {};
}

std::string make_creature_scene(CreatureWarps warps) {
  std::mt19937_64 random(1);
  Fields skin{body(), head(), arm(-1), arm(1)};
  for (const Field& plate : plates()) skin.push_back(plate);
  Field hair = mane(random);
  if (warps != CreatureWarps::none) hair = twist(Vec3d(-0.2, 2.3, 0), 40, hair);
  Field creature = unite({r_unite({blend(skin), hair, weeds(random)}), fin(), eyes()});
  if (warps == CreatureWarps::twist) creature = twist(Vec3d(-0.1, 0.9, 0), 20, creature);
  if (warps == CreatureWarps::bend) creature = bend(Vec3d(0, -0.6, 0), 3, 35, creature);
  return fmt::format(R"({{
"kelpie": 1,
"camera": {{ "position": [1.9, 1.5, 6.2], "look_at": [0.05, 0.84, 0], "fov": 38 }},
"film": {{ "resolution": [1280, 720], "spp": 1, "bounces": 0, "aovs": [], "filter": "centre", "background": "transparent" }},
"lights": [{{ "kind": "sun", "direction": [1, 2, 1], "angle": 0 }}],
"shapes": [{{ "name": "creature", "surface": {{ "kind": "matte" }}, "field": {} }}]
}}
)",
                     creature);
}

} // namespace kelpie
