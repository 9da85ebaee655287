// The one place through which files are opened and bytes are written: nothing here waits for another program.
#pragma once

#include <span>
#include <string>
#include <utility>

namespace kelpie {

/// An open file, closed with its owner.
class FileDescriptor {
public:
  FileDescriptor() = default;
  explicit FileDescriptor(int number) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~FileDescriptor();

  bool is_open() const { return number_ >= 0; }
  int number() const { return number_; }
  /// Closes it; 0, or the errno of a failure.
  int close() noexcept;

private:
  int number_ = -1;
};

/// Opens a file to read. Besides files only a pipe that was handed over (/dev/stdin, /dev/fd/N) is read: a named pipe may
/// never begin, and a device never end. `why` is set where it cannot be read.
FileDescriptor open_to_read(const std::string& path, std::string& why);

/// Opens what is no file and cannot be replaced as one: a character device, or a pipe that was handed over (/dev/stdout).
/// `why` is set where it is neither, or cannot be opened.
FileDescriptor open_to_write_in_place(const std::string& path, std::string& why);

/// Writes all of it; 0, or the errno of what failed.
int write_fully(int file, std::span<const unsigned char> bytes) noexcept;

/// Some bytes, at most `size`; 0 at the end, -1 with errno. Waits for a pipe that has none yet.
long read_some(int file, char* bytes, size_t size) noexcept;

} // namespace kelpie
