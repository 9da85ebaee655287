// The general solver: interval root isolation along the ray (Mitchell 1990, "Robust ray intersection
// with interval arithmetic"), in double precision. It needs nothing of a kind but its formula, so every
// present and future kind works; cells of one common form have faster solvers.
//
// Rejected for this place: sphere tracing with a Lipschitz constant for the cell, and segment tracing
// with the directional bound (Galin et al. 2020). Both only ever step forward by a lower bound of the
// distance and creep where the ray grazes; the same interval derivative used for Newton's contraction
// finds, or rules out, a root in a few halvings and proves it.

#include "renderer/trace/solve.h"

#include <array>

#include "renderer/trace/bracketed_root.h"

namespace kelpie {

namespace {

class CodeSolver {
public:
  CodeSolver(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolverWork& work)
      : code_(shape.code(cell)), program_(at(shape.program, code_, shape.slab_time(ray.time))), origin_(ray.origin),
        direction_(ray.direction), sign_(ray.from_inside ? -1 : 1), work_(work),
        // Below this width a stretch of ray is a point: far below the offset of secondary rays.
        width_(std::max(1e-4 * cell.epsilon, 2e-7 * std::abs(double(ray.t1)))) {}

  /// The first point of [t0, t1] with g >= 0, where g = ±(field - threshold) is negative before the surface.
  bool first(double t0, double t1, double& t) const {
    std::array<Stretch, 64> stack;
    size_t depth = 0;
    stack[depth++] = {t0, t1};
    while (depth > 0) {
      const Stretch s = stack[--depth];
      const Verdict verdict = judge(s, t);
      if (verdict == Verdict::hit) return true;
      if (verdict == Verdict::none) continue;
      const double middle = 0.5 * (s.t0 + s.t1);
      stack[depth++] = {middle, s.t1}; // the nearer half is judged first, so depth grows by one a halving
      stack[depth++] = {s.t0, middle};
    }
    return false;
  }

private:
  struct Stretch {
    double t0, t1;
  };
  enum class Verdict { none, hit, split };

  double g(double t) const {
    ++work_.evaluations;
    const Vec3d p = origin_ + t * direction_;
    return sign_ * (evaluate(program_, code_, Point3<double>{p.x, p.y, p.z}) - program_.threshold);
  }

  /// g and its derivative over a stretch.
  Dual<Interval, 1> bounds(const Stretch& s) const {
    ++work_.evaluations;
    using D = Dual<Interval, 1>;
    // From the middle of the stretch, which keeps the terms, and so their rounding, small.
    const double half = 0.5 * (s.t1 - s.t0);
    const Vec3d m = origin_ + (s.t0 + half) * direction_;
    const auto coordinate = [&](double at, double along) {
      D x;
      x.value = Interval{at} + Interval{-half, half} * along;
      x.d[0] = Interval{along};
      return x;
    };
    const D f =
        evaluate(program_, code_, Point3<D>{coordinate(m.x, direction_.x), coordinate(m.y, direction_.y), coordinate(m.z, direction_.z)});
    return sign_ * (f - program_.threshold);
  }

  Verdict judge(const Stretch& s, double& t) const {
    const Dual<Interval, 1> b = bounds(s);
    if (b.value.hi < 0) return Verdict::none;
    if (b.value.lo >= 0) return hit(s.t0, t);
    if (s.t1 - s.t0 <= width_) {
      if (g(0.5 * (s.t0 + s.t1)) >= 0) return hit(s.t0, t);
      return Verdict::none;
    }
    const double half = 0.5 * (s.t1 - s.t0), at_middle = g(0.5 * (s.t0 + s.t1));
    if (at_middle + b.d[0].magnitude() * half < 0) return Verdict::none; // mean-value form
    if (b.d[0].hi <= 0) return g(s.t0) >= 0 ? hit(s.t0, t) : Verdict::none;
    if (!(b.d[0].lo >= 0)) return Verdict::split;
    const double g0 = g(s.t0);
    if (g0 >= 0) return hit(s.t0, t);
    const double g1 = g(s.t1);
    if (g1 < 0) return Verdict::none;
    return hit(bracketed_root([&](double at) { return g(at); }, s.t0, g0, s.t1, g1, 1e-9 * program_.threshold), t);
  }

  static Verdict hit(double at, double& t) {
    t = at;
    return Verdict::hit;
  }

  CodeView code_;
  const FieldProgram& program_; ///< at the ray's time
  Vec3d origin_, direction_;
  double sign_;
  SolverWork& work_;
  double width_;
};

} // namespace

bool solve_code(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolverWork& work, float& t) {
  double root = 0;
  if (!CodeSolver(shape, cell, ray, work).first(ray.t0, ray.t1, root)) return false;
  t = static_cast<float>(root);
  return true;
}

} // namespace kelpie
