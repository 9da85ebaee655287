#include "tests/reference/verdict.h"

#include <algorithm>
#include <cmath>

namespace reference {

Verdict judge(const Profile& profile, double threshold, double scene_size, double t_answer, Tolerance tolerance) {
  const double distance = tolerance.length * scene_size;
  for (const Span& s : above(profile, threshold * (1 + tolerance.field)))
    if (std::min(s.to, t_answer) - s.from > distance) return Verdict::missed;
  if (std::isinf(t_answer)) return Verdict::right;
  const bool is_near = reaches(profile, threshold * (1 - tolerance.field), t_answer - distance, t_answer + distance);
  return is_near ? Verdict::right : Verdict::false_hit;
}

} // namespace reference
