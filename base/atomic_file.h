// Files that are there whole or not at all.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/file_descriptor.h"
#include "base/leftovers.h"

namespace kelpie {

/// Writes beside the target (unfinished_name(), in the same folder so that a rename is atomic) and puts the file in its place on
/// commit(): every write checked, the file fsynced, renamed, the folder fsynced. Destroyed without a commit, it leaves nothing
/// behind. Folders that are missing are made. A target that is a character device or a pipe that was handed over (/dev/stdout) is
/// written directly; other things that are no files are refused.
/// All failures throw Error cannot_write, "TARGET: reason".
class PartFile {
public:
  explicit PartFile(const std::filesystem::path& target);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  void write(std::span<const unsigned char> bytes);
  /// What was written is on the disk. commit() does this too.
  void sync();
  void commit();
  /// After commit(): removes the file, unless it took the place of another.
  void withdraw() noexcept;

  /// Whether it is written directly, and so never in part.
  bool is_direct() const { return !folder_.is_open(); }
  /// For a program that writes the file itself by name.
  std::string part_path() const { return (target_.parent_path() / part_).string(); }
  /// How much was written so far, by whomever.
  size_t size() const;

private:
  void open_part();
  void open_directly();
  int sync_folder() const; // 0, or why not
  void drop() noexcept;
  [[noreturn]] void fail(const std::string& why) const;
  void check(int error_number) const;

  std::string shown_;            // the target as it was named, for messages
  std::filesystem::path target_; // symbolic links followed
  std::string part_;             // its name while it is written
  bool is_new_ = true;           // there was no such file before
  FileDescriptor folder_, file_;
  std::optional<Leftover> leftover_;
};

/// Says before there is work whether a file can be written: throws as PartFile does.
void require_writable(const std::filesystem::path& target);

/// The bytes as a whole file.
void write_file_atomically(const std::filesystem::path& target, std::span<const unsigned char> bytes);

struct FileToWrite {
  std::filesystem::path target;
  std::string bytes;
};

/// Files that belong together: all of them or, where one fails, none.
void write_files_atomically(const std::vector<FileToWrite>& files);

} // namespace kelpie
