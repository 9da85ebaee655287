// The problems of a scene file, gathered so that all are reported in one go.
#pragma once

#include "base/error.h"

namespace kelpie {

class ProblemList {
public:
  /// A file with more problems than this is told so; nobody reads on.
  static constexpr size_t k_limit = 100;

  /// Throws everything so far once there are k_limit problems.
  void add(SourcePosition where, std::string message, ExitStatus status = ExitStatus::bad_data);
  /// Takes over the problems of an Error; those without a position get `where`.
  void add(const Error& error, const SourcePosition& where);

  bool is_empty() const { return problems_.empty(); }
  /// Throws one Error with all problems in the order of the text, if there are any. Its status is
  /// missing_input only where nothing else is wrong than that files are missing.
  void throw_if_any();

private:
  std::vector<Problem> problems_;
  ExitStatus status_ = ExitStatus::missing_input;
};

} // namespace kelpie
