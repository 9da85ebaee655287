// Errors as users see them: one line a problem, with its position where the fault lies in text.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace kelpie {

/// The documented exit statuses of the program (docs/manual.md).
enum class ExitStatus {
  ok = 0,
  usage = 2,
  out_of_memory = 33,
  bad_data = 65,      ///< a scene or an asset is wrong
  missing_input = 66, ///< a file that is named does not exist or cannot be read
  internal = 70,
  cannot_write = 74,
  try_again = 75,
};

/// A place in a text file. Line and column count from 1; 0: the fault lies in no line (or no text).
struct SourcePosition {
  std::string file;
  int line = 0;
  int column = 0;
};

/// `file:line:column`, without the parts that are unknown.
std::string to_string(const SourcePosition&);

struct Problem {
  SourcePosition where;
  std::string message;
};

/// `scene.json:14:9: unknown key "raduis"`: what follows `error: ` or `warning: `.
std::string to_string(const Problem&);

/// Thrown for anything a user can mend; lists all problems that were found.
class Error : public std::runtime_error {
public:
  Error(ExitStatus status, std::vector<Problem> problems);
  Error(ExitStatus status, std::string message, SourcePosition where = {});

  ExitStatus status;
  std::vector<Problem> problems;
};

/// Collects problems so that all of a file are reported in one go.
class Diagnostics {
public:
  void error(SourcePosition where, std::string message, ExitStatus status = ExitStatus::bad_data);
  void warning(SourcePosition where, std::string message);

  bool has_errors() const { return !errors_.empty(); }
  const std::vector<Problem>& errors() const { return errors_; }
  const std::vector<Problem>& warnings() const { return warnings_; }

  /// Throws one Error with every error so far, if there is any. Its status is that of the first one.
  void throw_if_errors() const;

private:
  std::vector<Problem> errors_, warnings_;
  ExitStatus status_ = ExitStatus::bad_data;
};

} // namespace kelpie
