#include "morph/tree/neutral.h"

namespace kelpie {

namespace {

using A = AnimatedMode;

struct Neutral {
  void operator()(Translate<A>& w) const { w.by = Vec3(0); }
  void operator()(Rotate<A>& w) const { w.angle = 0.f; }
  void operator()(Scale<A>& w) const { w.by = Vec3(1); }
  void operator()(Twist<A>& w) const { w.rate = 0.f; }
  void operator()(Bend<A>& w) const { w.angle = 0.f; }
  void operator()(Taper<A>& w) const { w.by = 1.f; }
  void operator()(Axial<A>& w) const {
    for (AxialAxis<A>& axis : w.axes) {
      axis.deformed = axis.rest; // of as many points as before, or the two cannot be mixed
      for (AxialFrame<A>& frame : axis.frames) frame.angle = 0.f;
    }
  }
};

} // namespace

std::optional<AnimatedKind> neutral_warp(const AnimatedKind& warp) {
  std::optional<AnimatedKind> neutral;
  std::visit(
      [&]<class Kind>(Kind kind) {
        if constexpr (std::is_invocable_v<Neutral, Kind&>) Neutral()(kind), neutral = std::move(kind);
      },
      warp);
  return neutral;
}

} // namespace kelpie
