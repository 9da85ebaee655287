#include "base/suggest.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kelpie {

namespace {
/// Optimal string alignment distance: insertions, deletions, substitutions, swaps of neighbours.
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<size_t>> d(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (size_t i = 1; i <= a.size(); ++i)
    for (size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

/// Whether `name` has `word` among its words, which stand between underscores.
bool has_word(std::string_view name, std::string_view word) {
  return fmt::format("_{}_", name).find(fmt::format("_{}_", word)) != std::string::npos;
}
} // namespace

std::string_view nearest_name(std::string_view typed, std::span<const std::string_view> known) {
  if (typed.size() > 64) return {};
  std::string_view best;
  size_t best_distance = std::max<size_t>(1, typed.size() / 3) + 1;
  for (std::string_view name : known)
    if (const size_t d = edit_distance(typed, name); d < best_distance) best = name, best_distance = d;
  if (!best.empty() || typed.empty()) return best;
  for (std::string_view name : known)
    if (has_word(name, typed) && (best.empty() || name.size() < best.size())) best = name;
  return best;
}

std::string suggestion(std::string_view typed, std::span<const std::string_view> known) {
  if (const std::string_view near = nearest_name(typed, known); !near.empty()) return fmt::format(" (did you mean \"{}\"?)", near);
  return known.empty() ? "" : fmt::format("; known: {}", fmt::join(known, ", "));
}

} // namespace kelpie
