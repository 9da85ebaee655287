#include "scene/problem_list.h"

#include <algorithm>
#include <tuple>

namespace kelpie {

void ProblemList::add(SourcePosition where, std::string message, ExitStatus status) {
  if (status != ExitStatus::missing_input) status_ = status;
  problems_.push_back({std::move(where), std::move(message)});
  if (problems_.size() >= k_limit) throw_if_any();
}

void ProblemList::add(const Error& error, const SourcePosition& where) {
  for (const Problem& p : error.problems) add(p.where.file.empty() ? where : p.where, p.message, error.status);
}

void ProblemList::throw_if_any() {
  if (problems_.empty()) return;
  const auto place = [](const Problem& p) { return std::tie(p.where.file, p.where.line, p.where.column); };
  std::stable_sort(problems_.begin(), problems_.end(), [&](const Problem& a, const Problem& b) { return place(a) < place(b); });
  if (problems_.size() >= k_limit) problems_.push_back(Problem{problems_.back().where, "too many problems; further ones are not shown"});
  throw Error(status_, problems_);
}

} // namespace kelpie
