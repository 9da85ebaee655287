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

bool is_right_shadow(const Profile& profile, double threshold, double scene_size, bool is_dark, Tolerance tolerance) {
  if (is_dark) return reaches(profile, threshold * (1 - tolerance.field), profile.front().from, profile.back().to);
  const auto spans = above(profile, threshold * (1 + tolerance.field));
  return std::none_of(spans.begin(), spans.end(), [&](const Span& s) { return s.to - s.from > tolerance.length * scene_size; });
}

} // namespace reference
