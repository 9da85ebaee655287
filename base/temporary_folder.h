#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>

#include "base/leftovers.h"

namespace kelpie {

/// A folder of our own below $TMPDIR (or /tmp) that goes when this does, when a signal ends the program, or else with the next run
/// that makes one. Throws Error cannot_write where it cannot be made.
class TemporaryFolder {
public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  /// The path of a file in it. Only files that were named here are removed by a signal.
  std::string file(const std::string& name);

private:
  std::filesystem::path path_;
  FileDescriptor parent_, folder_;
  std::optional<Leftover> leftover_;
  std::deque<Leftover> files_;
};

} // namespace kelpie
