// Random trees and their morphs as scene files say them, and what their fields are.
#pragma once

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "renderer/program/evaluate.h"
#include "tests/support/random_kind.h"
#include "tests/support/scene_folder.h"

namespace kelpie {

/// Trees as scene files say them, the same in every run.
class RandomTree {
public:
  explicit RandomTree(unsigned seed, bool moves) : r_(seed), moves_(moves) {}

  std::string leaf() { return leaf(r_.below(k_leaf_kinds)); }
  std::string leaf(int which) {
    const std::string body = fmt::format(R"("radius":{:.3f},"weight":{:.3f},"falloff":"{}")", r_.uniform(0.4, 0.9), r_.uniform(1.2, 2.2),
                                         std::array{"quartic", "cubic", "wyvill"}[size_t(r_.below(3))]);
    return fmt::format("{{{},{}}}", solid(which), body);
  }
  std::string tree(int depth) {
    if (depth == 0) return leaf();
    switch (r_.below(10)) {
    case 0: return fmt::format(R"({{"kind":"translate","by":{},"child":{}}})", vector(0.3), tree(depth - 1));
    case 1: return fmt::format(R"({{"kind":"rotate","axis":{},"angle":{},"child":{}}})", vector(1), number(-60, 60), tree(depth - 1));
    case 2: return fmt::format(R"({{"kind":"scale","by":{},"child":{}}})", number(0.7, 1.4), tree(depth - 1));
    case 3: return fmt::format(R"({{"kind":"twist","rate":{},"child":{}}})", number(-40, 40), tree(depth - 1));
    case 4: return fmt::format(R"({{"kind":"taper","by":{},"length":2,"child":{}}})", number(0.6, 1.3), tree(depth - 1));
    case 5: return fmt::format(R"({{"kind":"hyper_blend","n":{},"children":[{}]}})", number(1, 6), children(depth));
    case 6: return fmt::format(R"({{"kind":"local_blend","region":{},"children":[{}]}})", leaf(), children(depth));
    case 7: return fmt::format(R"({{"kind":"difference","children":[{}]}})", children(depth));
    case 8: return fmt::format(R"({{"kind":"union","children":[{}]}})", children(depth));
    default: return fmt::format(R"({{"kind":"blend","children":[{}]}})", children(depth));
    }
  }

  static constexpr int k_leaf_kinds = 17;

private:
  std::string number(double low, double high) {
    const double a = r_.uniform(low, high), b = r_.uniform(low, high);
    if (!moves_ || r_.below(3)) return fmt::format("{:.3f}", a);
    return fmt::format(R"({{"keys":[[1,{:.3f}],[9,{:.3f}]],"interpolation":"smooth"}})", a, b);
  }
  std::string vector(double size) {
    const auto place = [&] { return r_.in(Box3d{Vec3d(-size), Vec3d(size)}); };
    const Vec3d a = place(), b = place();
    if (!moves_ || r_.below(3)) return fmt::format("[{:.3f},{:.3f},{:.3f}]", a.x, a.y, a.z);
    return fmt::format(R"({{"keys":[[1,[{:.3f},{:.3f},{:.3f}]],[9,[{:.3f},{:.3f},{:.3f}]]]}})", a.x, a.y, a.z, b.x, b.y, b.z);
  }
  std::string children(int depth) {
    std::string list = tree(depth - 1);
    for (int i = r_.below(3); i >= 0; --i) list += fmt::format(",{}", tree(depth - 1));
    return list;
  }
  std::string points(int count) {
    std::string list = vector(1);
    for (int i = 1; i < count; ++i) list += fmt::format(",{}", vector(1));
    return fmt::format("[{}]", list);
  }
  std::string solid(int which) {
    const auto v = [&] { return vector(0.8); };
    const auto size = [&] { return number(0.05, 0.6); };
    switch (which) {
    case 0: return fmt::format(R"("kind":"point","centre":{})", v());
    case 1: return fmt::format(R"("kind":"segment","from":{},"to":{})", v(), v());
    case 2: return fmt::format(R"("kind":"cone_sphere","from":{},"to":{},"from_radius":{},"to_radius":{})", v(), v(), size(), size());
    case 3: return fmt::format(R"("kind":"disc","centre":{},"normal":{},"disc_radius":{})", v(), v(), size());
    case 4:
      return fmt::format(R"("kind":"torus","centre":{},"normal":{},"major_radius":{},"minor_radius":{})", v(), v(), size(), number(0, 0.1));
    case 5: return fmt::format(R"("kind":"circle","centre":{},"normal":{},"circle_radius":{})", v(), v(), size());
    case 6:
      return fmt::format(R"("kind":"arc","centre":{},"normal":[0,1,0],"towards":[1,0,0.3],"arc_radius":{},"angle":{})", v(), size(),
                         number(30, 200));
    case 7: return fmt::format(R"("kind":"triangle","a":{},"b":{},"c":{})", v(), v(), v());
    case 8:
      return fmt::format(R"("kind":"rectangle","centre":{},"normal":[0,1,0.2],"across":[1,0,0],"width":{},"height":{})", v(), size(),
                         size());
    case 9:
      return fmt::format(R"("kind":"box","centre":{},"size":[{},{},{}],"axis":[0.1,1,0],"across":[1,0,0.3])", v(), size(), size(), size());
    case 10: return fmt::format(R"("kind":"cylinder","from":{},"to":{},"cylinder_radius":{})", v(), v(), size());
    case 11: return fmt::format(R"("kind":"cone","from":{},"to":{},"from_radius":{},"to_radius":{})", v(), v(), size(), size());
    case 12:
      return fmt::format(
          R"("kind":"hollow_cone","from":{},"to":{},"from_radius":{},"to_radius":{},"from_thickness":0.05,"to_thickness":0.1)", v(), v(),
          size(), size());
    case 13: return fmt::format(R"("kind":"tetrahedron","a":{},"b":{},"c":{},"d":{})", v(), v(), v(), v());
    case 14: return fmt::format(R"("kind":"prism","a":{},"b":{},"c":{},"thickness":{})", v(), v(), v(), size());
    case 15: return fmt::format(R"("kind":"polyhedron","points":{})", points(4 + r_.below(6)));
    default:
      return fmt::format(R"("kind":"generalized_cylinder","points":{},"radii":{},"detail":0.01)", points(2 + r_.below(3)),
                         number(0.05, 0.2));
    }
  }

  Random r_;
  bool moves_;
};

inline std::string scene_with(const std::string& field) {
  return fmt::format(R"({{"kelpie":1,"frames":{{"first":1,"last":9}},"shapes":[{{"name":"a","field":
{}}}]}})",
                     field);
}
inline std::string morph_of(const std::string& from, const std::string& to, std::string_view progress, std::string_view rest = "") {
  return fmt::format("{{\"kind\":\"animorphosis\",\"from\":{},\"to\":{},\"progress\":{}{}}}", from, to, progress, rest);
}

/// The field of a scene at a frame, at many places.
class Values {
public:
  explicit Values(int count) {
    Random r(99);
    for (int i = 0; i < count; ++i) places_.push_back(r.in(Box3d{Vec3d(-1.6), Vec3d(1.6)}));
  }
  std::vector<double> operator()(const Scene& scene, double frame) const {
    const SampledShape shape = sample(scene, frame).shapes[0];
    const FieldProgram program = compile(shape.field, shape.threshold);
    std::vector<double> values;
    // Deep inside fields may be cut off at twice the threshold, as differences do.
    for (const Vec3d& p : places_) values.push_back(std::clamp(evaluate(program, program.code, Point3<double>{p.x, p.y, p.z}), 0.0, 2.0));
    return values;
  }

private:
  std::vector<Vec3d> places_;
};

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

} // namespace kelpie
