#include "base/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <deque>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file_bytes.h"

namespace kelpie {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail_to_write(const std::string& what, const std::string& why) {
  throw Error(ExitStatus::cannot_write, fmt::format("{}: {}", what, why));
}

/// Makes the folder of `target`; says which part of the path is in the way.
void make_folder(const fs::path& target, const std::string& shown) {
  const fs::path folder = target.parent_path();
  if (folder.empty()) return;
  std::error_code why, ignored;
  fs::create_directories(folder, why);
  if (fs::is_directory(folder, ignored)) return;
  for (fs::path p = folder; p.has_relative_path(); p = p.parent_path())
    if (fs::exists(p, ignored) && !fs::is_directory(p, ignored))
      fail_to_write(shown, fmt::format("{} is a file, not a folder", p.string()));
  fail_to_write(shown, fmt::format("cannot make the folder {}: {}", folder.string(), why.message()));
}

} // namespace

PartFile::PartFile(const fs::path& target) : shown_(target.string()), target_(target) {
  if (!target.has_filename()) fail("is a folder; name a file");
  make_folder(target, shown_);
  std::error_code error;
  if (fs::is_symlink(target, error)) target_ = fs::weakly_canonical(target, error);
  if (target_.empty()) target_ = target; // a loop of links: open() will say so
  const fs::file_status status = fs::status(target_, error);
  if (fs::is_directory(status)) fail("is a folder; name a file");
  if (status.type() == fs::file_type::none) fail(error.message()); // it may not be asked for, or cannot exist
  is_new_ = !fs::exists(status);
  if (is_new_ || fs::is_regular_file(status))
    open_part();
  else
    open_directly();
}

PartFile::~PartFile() { drop(); }

void PartFile::open_part() {
  folder_ = open_folder(target_.parent_path(), shown_);
  remove_what_dead_runs_left(target_.parent_path());
  do {
    part_ = unfinished_name();
    leftover_.emplace(folder_.number(), part_, Leftover::Kind::file);
    file_ = FileDescriptor(openat(folder_.number(), part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!file_.is_open() && errno != EEXIST) check(errno);
  } while (!file_.is_open() || !lock_in_use(file_.number()));
}

void PartFile::open_directly() {
  part_ = target_.filename().string();
  std::string why;
  file_ = open_to_write_in_place(target_.string(), why);
  if (!why.empty()) fail(why);
}

void PartFile::drop() noexcept {
  if (file_.is_open() && !is_direct()) unlinkat(folder_.number(), part_.c_str(), 0);
  file_.close();
  leftover_.reset();
}

void PartFile::fail(const std::string& why) const { fail_to_write(shown_, why); }

void PartFile::check(int error_number) const {
  if (error_number != 0) fail(std::strerror(error_number));
}

void PartFile::write(std::span<const unsigned char> bytes) { check(write_fully(file_.number(), bytes)); }

size_t PartFile::size() const {
  struct stat status {};
  return fstat(file_.number(), &status) == 0 ? static_cast<size_t>(status.st_size) : 0;
}

void PartFile::sync() {
  // EINVAL: what it is written to (a pipe, a terminal) has nothing to sync.
  if (fsync(file_.number()) != 0 && !(is_direct() && errno == EINVAL)) check(errno);
}

void PartFile::commit() {
  sync();
  if (is_direct()) return check(file_.close());
  if (renameat(folder_.number(), part_.c_str(), folder_.number(), target_.filename().c_str()) != 0)
    check(errno); // the destructor removes it
  leftover_.reset();
  int why = file_.close();
  if (why == 0) why = sync_folder();
  if (why != 0) withdraw();
  check(why);
}

int PartFile::sync_folder() const {
  const FileDescriptor folder(openat(folder_.number(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.is_open()) return 0; // a folder that may be written but not read: the rename stands
  return fsync(folder.number()) == 0 || errno == EINVAL || errno == ENOTSUP ? 0 : errno;
}

void PartFile::withdraw() noexcept {
  if (is_new_ && !is_direct()) unlinkat(folder_.number(), target_.filename().c_str(), 0);
}

void require_writable(const fs::path& target) { PartFile file(target); }

void write_file_atomically(const fs::path& target, std::span<const unsigned char> bytes) {
  PartFile file(target);
  file.write(bytes);
  file.commit();
}

void write_files_atomically(const std::vector<FileToWrite>& files) {
  std::deque<PartFile> parts;
  for (const FileToWrite& f : files) parts.emplace_back(f.target);
  for (size_t i = 0; i < files.size(); ++i) parts[i].write(as_bytes(files[i].bytes)), parts[i].sync();
  size_t committed = 0;
  try {
    for (; committed < parts.size(); ++committed) parts[committed].commit();
  } catch (...) {
    for (size_t i = 0; i < committed; ++i) parts[i].withdraw();
    throw;
  }
}

} // namespace kelpie
