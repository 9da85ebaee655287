#include "base/atomic_file.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "base/error.h"

namespace kelpie {

namespace fs = std::filesystem;

namespace {

// The registry: fixed storage, because a signal handler may neither lock nor allocate. A path is
// complete before `is_live` is set, and is not touched again until it is cleared.
struct Slot {
  std::atomic<bool> is_taken{false}, is_live{false};
  char path[4096];
};
std::array<Slot, 64> g_slots;
static_assert(std::atomic<bool>::is_always_lock_free);

int register_part(const std::string& path) {
  if (path.size() >= sizeof(Slot::path)) return -1; // open() will say ENAMETOOLONG
  for (size_t i = 0; i < g_slots.size(); ++i) {
    bool expected = false;
    if (!g_slots[i].is_taken.compare_exchange_strong(expected, true)) continue;
    std::memcpy(g_slots[i].path, path.c_str(), path.size() + 1);
    g_slots[i].is_live = true;
    return static_cast<int>(i);
  }
  return -1; // 64 files at once: the rest is still removed by its destructor
}

void forget_part(int slot) noexcept {
  if (slot < 0) return;
  g_slots[slot].is_live = false;
  g_slots[slot].is_taken = false;
}

void die(int signal_number) {
  unlink_part_files();
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

std::string host_name() {
  char name[256] = {};
  if (gethostname(name, sizeof name - 1) != 0) return "localhost";
  for (char* c = name; *c; ++c)
    if (*c == '/') *c = '_';
  return name;
}

[[noreturn]] void fail_to_write(const std::string& what, const std::string& why) {
  throw Error(ExitStatus::cannot_write, fmt::format("{}: {}", what, why));
}

/// Makes the folder of `target`; says which part of the path is in the way.
void make_folder(const fs::path& target, const std::string& shown) {
  const fs::path folder = target.parent_path();
  if (folder.empty()) return;
  std::error_code error;
  fs::create_directories(folder, error);
  if (fs::is_directory(folder)) return;
  for (fs::path p = folder; p.has_relative_path(); p = p.parent_path()) {
    std::error_code ignored;
    if (fs::exists(p, ignored) && !fs::is_directory(p, ignored))
      fail_to_write(shown, fmt::format("{} is a file, not a folder", p.string()));
  }
  fail_to_write(shown, fmt::format("cannot make the folder {}: {}", folder.string(), error.message()));
}

} // namespace

void unlink_part_files() noexcept {
  for (Slot& slot : g_slots)
    if (slot.is_live) unlink(slot.path);
}

void clean_up_on_signals() {
  struct sigaction action {};
  action.sa_handler = die;
  sigemptyset(&action.sa_mask);
  for (const int s : {SIGINT, SIGTERM, SIGHUP}) sigaction(s, &action, nullptr);
}

PartFile::PartFile(const fs::path& target) : shown_(target.string()) {
  if (!target.has_filename()) fail_to_write(shown_, "is a folder; name a file");
  make_folder(target, shown_);
  std::error_code error;
  const fs::path followed = fs::is_symlink(target, error) ? fs::weakly_canonical(target, error) : target;
  target_ = followed.empty() ? shown_ : followed.string();
  const fs::file_status status = fs::status(target_, error);
  if (fs::is_directory(status)) fail_to_write(shown_, "is a folder; name a file");
  is_direct_ = fs::exists(status) && !fs::is_regular_file(status);
  const fs::path name = fmt::format(".{}.{}.{}.part", followed.filename().string(), host_name(), getpid());
  part_ = is_direct_ ? target_ : (followed.parent_path() / name).string();
  if (!is_direct_) {
    slot_ = register_part(part_);
    unlink(part_.c_str()); // of a dead process that had our number
  }
  file_ = open(part_.c_str(), is_direct_ ? O_WRONLY | O_CLOEXEC : O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file_ < 0) {
    const int why = errno;
    forget_part(slot_);
    fail(why);
  }
}

PartFile::~PartFile() { drop(); }

void PartFile::drop() noexcept {
  if (file_ < 0) return;
  close(file_);
  file_ = -1;
  if (!is_direct_) unlink(part_.c_str());
  forget_part(slot_);
}

void PartFile::fail(int error_number) const { fail_to_write(shown_, std::strerror(error_number)); }

void PartFile::write(std::span<const unsigned char> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file_, bytes.data(), std::min<size_t>(bytes.size(), size_t(1) << 30));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(errno);
    if (n == 0) fail(ENOSPC);
    bytes = bytes.subspan(static_cast<size_t>(n));
  }
}

void PartFile::commit() {
  // EINVAL: what it is written to (a pipe, a terminal) has nothing to sync.
  if (fsync(file_) != 0 && !(is_direct_ && errno == EINVAL)) fail(errno);
  const int closing = file_;
  if (is_direct_) {
    file_ = -1;
    if (close(closing) != 0) fail(errno);
    return;
  }
  if (rename(part_.c_str(), target_.c_str()) != 0) fail(errno); // the destructor removes the part
  file_ = -1;
  forget_part(slot_);
  if (close(closing) != 0) fail(errno);
  const fs::path parent = fs::path(target_).parent_path();
  const int folder = open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return; // a folder that may be written but not read: the rename stands
  const int synced = fsync(folder) == 0 || errno == EINVAL || errno == ENOTSUP ? 0 : errno;
  close(folder);
  if (synced != 0) fail(synced);
}

void write_file_atomically(const fs::path& target, std::span<const unsigned char> bytes) {
  PartFile file(target);
  file.write(bytes);
  file.commit();
}

} // namespace kelpie
