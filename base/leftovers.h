// What must not stay behind when the program ends before it is done: files that are not whole, temporary folders, helpers.
//
// A signal removes them at once, from its handler: nothing that is unfinished is of use, so there is nothing to wait for. After a
// death that no handler sees (SIGKILL, a power cut) the next run removes them: what is in use is locked, and the kernel takes
// the locks of the dead.
#pragma once

#include <filesystem>
#include <string>

#include <sys/types.h>

#include "base/file_descriptor.h"

namespace kelpie {

/// As long as it lives, a signal that ends the program removes a file, or a folder that is empty by then.
class Leftover {
public:
  enum class Kind { file, folder };

  /// `name` in the open folder `folder`, which must outlive this. Names of more than 63 bytes are not registered, nor is more
  /// than 64 at a time.
  Leftover(int folder, const std::string& name, Kind kind);
  ~Leftover();
  Leftover(const Leftover&) = delete;
  Leftover& operator=(const Leftover&) = delete;

private:
  int slot_ = -1;
};

/// Removes what is registered, and ends the helper. Async-signal-safe.
void remove_leftovers() noexcept;

/// A process that is killed with this one; 0: none.
void set_helper(pid_t) noexcept;

/// SIGINT, SIGTERM, SIGHUP and SIGXCPU remove what is registered, and then the process dies by the signal.
void clean_up_on_signals();

/// A new name for an unfinished file or folder, `.kelpie-HOST-RANDOM.part`: hexadecimal digits.
std::string unfinished_name();

/// Marks an open file or folder as in use until it is closed. False where it has been removed meanwhile. Where a file system has no
/// locks, nothing is marked (and nothing removed).
bool lock_in_use(int file) noexcept;

/// A folder, open so that files in it can be named. Throws Error cannot_write for `shown`.
FileDescriptor open_folder(const std::filesystem::path& folder, const std::string& shown);

/// Removes what dead runs left in a folder: what is called unfinished_name() and nobody has locked; of other hosts,
/// whose locks may not be seen here, what nobody has touched for a day. Looks once a run.
void remove_what_dead_runs_left(const std::filesystem::path& folder) noexcept;

} // namespace kelpie
