// Instances mean what the same fields mean when they are spelled out: every number, at every time.
#include <functional>

#include <fmt/format.h>

#include "renderer/program/evaluate.h"
#include "tests/support/random_kind.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

std::string text(const Vec3d& v) { return fmt::format("[{:.3f},{:.3f},{:.3f}]", v.x, v.y, v.z); }

/// One more element of a list as text.
void append(std::string& list, const std::string& element) {
  if (!list.empty()) list += ',';
  list += element;
}

/// Where and when an instance stands.
struct Placement {
  std::string from, to; ///< alike: it does not move
  std::string axis, angle, scale;
  double time_offset, time_scale;

  /// When what the part does at `frame` is seen.
  double when(double frame) const { return time_offset + frame / time_scale; }
};

/// The time in which something is spelled out: when its own frames are.
using Clock = std::function<double(double frame)>;
const Clock k_here = [](double frame) { return frame; };

std::string curve(const Clock& clock, double first, double last, const std::string& from, const std::string& to) {
  return fmt::format("{{\"keys\":[[{},{}],[{},{}]]}}", clock(first), from, clock(last), to);
}
std::string position(const Placement& p, const Clock& clock) { return p.from == p.to ? p.from : curve(clock, 2, 7.5, p.from, p.to); }

Placement random_placement(Random& r) {
  const Box3d box{Vec3d(-1.5), Vec3d(1.5)};
  const std::string from = text(r.in(box)), to = r.below(2) ? from : text(r.in(box));
  const std::string scale = r.below(2) ? fmt::format("{:.3f}", r.uniform(0.5, 1.5)) : text(r.in({Vec3d(0.5), Vec3d(1.5)}));
  return {from, to, text(r.direction()), fmt::format("{:.3f}", r.uniform(-180, 180)), scale, 0.25 * r.below(8), std::exp2(r.below(4) - 2)};
}

std::string instance(const std::string& part, const Placement& p) {
  return fmt::format(R"({{"kind":"instance","of":"{}","position":{},"axis":{},"angle":{},"scale":{},"time_offset":{},"time_scale":{}}})",
                     part, position(p, k_here), p.axis, p.angle, p.scale, p.time_offset, p.time_scale);
}
/// The same with the part itself, which is already at its time.
std::string spelled_out(const std::string& part, const Placement& p, const Clock& clock) {
  const std::string scaled = fmt::format(R"({{"kind":"scale","by":{},"child":{}}})", p.scale, part);
  const std::string turned = fmt::format(R"({{"kind":"rotate","axis":{},"angle":{},"child":{}}})", p.axis, p.angle, scaled);
  return fmt::format(R"({{"kind":"translate","by":{},"child":{}}})", position(p, clock), turned);
}

/// Parts that move.
std::string seed(const Clock& clock) {
  return R"({"kind":"segment","from":[0,0,0],"to":)" + curve(clock, 1, 4, "[0.3,0,0]", "[0,0.5,0]") + R"(,"radius":0.4,"weight":1.5})";
}
std::string arm(const Clock& clock, const std::string& seeds) {
  return R"({"kind":"blend","children":[{"kind":"point","centre":)" + curve(clock, 1, 4, "[0,0,0]", "[0,1,0.5]") +
         R"(,"radius":0.8,"weight":2},{"kind":"twist","rate":60,"child":{"kind":"box","size":[0.5,1,0.3],"centre":[0,0,0],"radius":)" +
         curve(clock, 2, 5, "0.2", "0.4") + "}}," + seeds + "]}";
}

TEST(Instances, AreWhatTheyStandFor) {
  const SceneFolder folder;
  int inside = 0;
  for (unsigned trial = 0; trial < 30; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    const Placement seeds[] = {random_placement(r), random_placement(r)};
    std::string referring, whole;
    for (int i = 0; i < 4; ++i) {
      const Placement p = random_placement(r);
      append(referring, instance("arm", p));
      std::string fields;
      const Clock of_arm = [&](double frame) { return p.when(frame); };
      for (const Placement& s : seeds) append(fields, spelled_out(seed([&](double frame) { return p.when(s.when(frame)); }), s, of_arm));
      append(whole, spelled_out(arm(of_arm, fields), p, k_here));
    }
    const std::string parts = R"("parts":{"arm":)" + arm(k_here, instance("seed", seeds[0]) + "," + instance("seed", seeds[1])) +
                              R"(,"seed":)" + seed(k_here) + "},";
    const auto scene = [&](const std::string& more, const std::string& fields) {
      return folder.read("{\"kelpie\":1," + more + R"("shapes":[{"name":"a","field":{"kind":"blend","children":[)" + fields + "]}}]}");
    };
    const Scene a = scene(parts, referring), b = scene("", whole);
    EXPECT_EQ(sample(a, 1).breaks, sample(b, 1).breaks);
    for (double frame = 0; frame < 12; frame += 0.625) {
      // Two moments together, as for motion blur: of one structure, though parts are shared by their time.
      const auto compiled = [&](const Scene& s) {
        std::vector<SampledField> moments{sample(s, frame).shapes[0].field, sample(s, frame + 0.5).shapes[0].field};
        return compile(std::move(moments), std::array{1.0, 1.0});
      };
      const std::vector<FieldProgram> p = compiled(a), q = compiled(b);
      EXPECT_EQ(p[0].element_count(), q[0].element_count());
      for (size_t moment = 0; moment < 2; ++moment)
        for (int i = 0; i < 20; ++i) {
          const Vec3d at = r.in({Vec3d(-3), Vec3d(3)});
          const Point3<double> x{at.x, at.y, at.z};
          const double value = evaluate<double>(p[moment], p[moment].code, x);
          EXPECT_NEAR(value, evaluate<double>(q[moment], q[moment].code, x), 1e-4);
          inside += value > 0;
        }
    }
  }
  EXPECT_GT(inside, 1000);
}

} // namespace
} // namespace kelpie
