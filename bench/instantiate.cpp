// What a frame costs before anything is built or traced: instantiating a tree whose parameters move (sampling it, and
// expanding its complex primitives). One thread; CPU seconds, medians of many frames.
//
//   instantiate [runs [scene]]      the trees of all shapes of a scene instead
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "renderer/program/expand.h"
#include "scene/reader.h"
#include "scene/scene.h"

namespace kelpie {
namespace {

double thread_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class T>
Animated<T> moving(const T& from, const T& to) {
  return {{{1, from, {}}, {24, to, {}}, {48, from, {}}}, Interpolation::linear};
}
Vec3 place(int i, float phase) { return {0.1f * float(i % 97), std::sin(0.1f * float(i) + phase), 0.1f * float(i / 97)}; }

FieldPtr node(FieldKinds::Variant<AnimatedMode> kind) { return std::make_shared<FieldNode>(FieldNode{std::move(kind), {}, {}}); }

/// A cone-sphere of which every length moves.
FieldPtr bone(int i) {
  ConeSphere<AnimatedMode> k;
  k.from = moving(place(i, 0), place(i, 0.5f)), k.to = moving(place(i + 1, 0), place(i + 1, 0.5f));
  k.from_radius = moving(0.1f, 0.15f), k.to_radius = moving(0.1f, 0.2f);
  k.radius = 0.1f, k.weight = 2.f;
  return node(k);
}

/// A limb of which all points and radii move; straight enough to become about `pieces` pieces.
FieldPtr limb(int i, int pieces) {
  GeneralizedCylinder<AnimatedMode> k;
  for (int j = 0; j < 6; ++j) {
    k.points.push_back(moving(place(7 * i + 3 * j, 0), place(7 * i + 3 * j, 0.5f)));
    k.radii.push_back(moving(0.1f, 0.1f + 0.01f * float(j)));
  }
  k.curve = SplineKind::b_spline, k.radius = 0.1f, k.weight = 2.f;
  k.detail = 0.012f / float(pieces * pieces);
  return node(k);
}

/// Blends of unions of a few leaves each.
template <class MakeLeaf>
Scene tree_of(int leaves, const MakeLeaf& make) {
  Blend<AnimatedMode> blend;
  for (int i = 0; i < leaves;) {
    Union<AnimatedMode> part;
    for (int j = 0; j < 10 && i < leaves; ++j) part.children.push_back(make(i++));
    blend.children.push_back(node(part));
  }
  Scene scene;
  scene.shapes.emplace_back();
  scene.shapes[0].name = "tree", scene.shapes[0].field = node(blend);
  return scene;
}

void measure(const char* name, const Scene& scene, int runs) {
  std::vector<double> sampling, all;
  size_t elements = 0;
  for (int run = 0; run < runs; ++run) {
    const double start = thread_cpu_s();
    FrameScene frame = sample(scene, 1 + 0.7 * run);
    const double sampled = thread_cpu_s();
    elements = 0;
    for (SampledShape& shape : frame.shapes) {
      if (shape.field.nodes.empty()) continue;
      std::vector<SampledField> moments;
      moments.push_back(std::move(shape.field));
      expand(moments);
      for (const auto& n : moments[0].nodes) elements += std::visit([]<class Kind>(const Kind&) { return Skeleton<Kind>; }, n);
    }
    all.push_back(thread_cpu_s() - start), sampling.push_back(sampled - start);
  }
  const auto median = [](std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
    return 1e3 * v[v.size() / 2];
  };
  std::printf("%-24s %7zu elements   %8.3f ms, of it sampling %.3f ms\n", name, elements, median(all), median(sampling));
}

} // namespace
} // namespace kelpie

int main(int argc, char** argv) {
  using namespace kelpie;
  const int runs = argc > 1 ? std::atoi(argv[1]) : 51;
  if (argc > 2) {
    Diagnostics diagnostics;
    measure(argv[2], read_scene(argv[2], {}, diagnostics), runs);
    return 0;
  }
  std::printf("a sampled node has %zu bytes\n", sizeof(FieldKinds::Variant<SampledMode>));
  for (const int count : {2'000, 100'000}) {
    measure("cone-spheres", tree_of(count, bone), runs);
    measure("generalized cylinders", tree_of(count / 42, [](int i) { return limb(i, 14); }), runs);
  }
}
