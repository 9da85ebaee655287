#include "base/temporary_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "base/error.h"

namespace kelpie {

namespace fs = std::filesystem;

namespace {

fs::path parent_of_all() {
  const char* named = std::getenv("TMPDIR");
  return named && *named ? named : "/tmp";
}

} // namespace

TemporaryFolder::TemporaryFolder() {
  const fs::path parent = parent_of_all();
  const std::string shown = fmt::format("a temporary folder in {}", parent.string());
  parent_ = open_folder(parent, shown);
  remove_what_dead_runs_left(parent);
  do {
    const std::string name = unfinished_name();
    path_ = parent / name;
    leftover_.emplace(parent_.number(), name, Leftover::Kind::folder);
    if (mkdir(path_.c_str(), 0700) != 0) throw Error(ExitStatus::cannot_write, fmt::format("{}: {}", shown, std::strerror(errno)));
    folder_ = FileDescriptor(open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!folder_.is_open()) throw Error(ExitStatus::cannot_write, fmt::format("{}: {}", shown, std::strerror(errno)));
  } while (!lock_in_use(folder_.number()));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string TemporaryFolder::file(const std::string& name) {
  files_.emplace_back(folder_.number(), name, Leftover::Kind::file);
  return (path_ / name).string();
}

} // namespace kelpie
