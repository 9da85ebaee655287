// Files that are there whole or not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace kelpie {

/// Writes beside the target (`.NAME.HOST.PID.part`, in the same folder so that a rename is atomic) and
/// puts the file in its place on commit(): every write checked, the file fsynced, renamed, the folder
/// fsynced. Destroyed without a commit, it leaves nothing behind. Folders that are missing are made.
/// A target that exists and is no regular file (/dev/stdout, a pipe) is written directly.
/// All failures throw Error cannot_write, "TARGET: reason".
class PartFile {
public:
  explicit PartFile(const std::filesystem::path& target);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  void write(std::span<const unsigned char> bytes);
  void commit();

  /// For a program that writes the file itself by name.
  const std::string& part_path() const { return part_; }

private:
  [[noreturn]] void fail(int error_number) const;
  void drop() noexcept;

  std::string shown_;  // the target as it was named, for messages
  std::string target_; // symbolic links followed
  std::string part_;   // equal to target_ where it is written directly
  int file_ = -1;
  int slot_ = -1; // in the registry of part files
  bool is_direct_ = false;
};

/// The bytes as a whole file.
void write_file_atomically(const std::filesystem::path& target, std::span<const unsigned char> bytes);

/// Removes the part files of this process. Async-signal-safe: for handlers of signals that end it.
void unlink_part_files() noexcept;

/// SIGINT, SIGTERM and SIGHUP remove the part files, and then the process dies by the signal. For
/// commands that need not stop at a boundary of their own.
void clean_up_on_signals();

} // namespace kelpie
