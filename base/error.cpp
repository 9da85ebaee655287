#include "base/error.h"

#include <fmt/format.h>

namespace kelpie {

std::string to_string(const SourcePosition& p) {
  if (p.line == 0) return p.file;
  if (p.column == 0) return fmt::format("{}:{}", p.file, p.line);
  return fmt::format("{}:{}:{}", p.file, p.line, p.column);
}

std::string to_string(const Problem& p) { return p.where.file.empty() ? p.message : fmt::format("{}: {}", to_string(p.where), p.message); }

namespace {
std::string joined(const std::vector<Problem>& problems) {
  std::string text;
  for (const Problem& p : problems) {
    if (!text.empty()) text += '\n';
    text += to_string(p);
  }
  return text;
}
} // namespace

Error::Error(ExitStatus s, std::vector<Problem> list) : std::runtime_error(joined(list)), status(s), problems(std::move(list)) {}

Error::Error(ExitStatus s, std::string message, SourcePosition where)
    : Error(s, std::vector<Problem>{{std::move(where), std::move(message)}}) {}

void Diagnostics::error(SourcePosition where, std::string message, ExitStatus status) {
  if (errors_.empty()) status_ = status;
  errors_.push_back({std::move(where), std::move(message)});
}

void Diagnostics::warning(SourcePosition where, std::string message) { warnings_.push_back({std::move(where), std::move(message)}); }

void Diagnostics::throw_if_errors() const {
  if (has_errors()) throw Error(status_, errors_);
}

} // namespace kelpie
