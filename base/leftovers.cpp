#include "base/leftovers.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <mutex>
#include <random>
#include <regex>
#include <set>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "base/error.h"
#include "base/standard_streams.h"

namespace kelpie {

namespace fs = std::filesystem;

namespace {

// Fixed storage, because a signal handler may neither lock nor allocate. A slot is complete before `is_live` is set, and is not
// touched again until that is cleared.
struct Slot {
  std::atomic<bool> is_taken{false}, is_live{false};
  int folder = -1;
  bool is_folder = false;
  std::array<char, 64> name{};
};
std::array<Slot, 64> g_slots;
std::atomic<pid_t> g_helper{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<pid_t>::is_always_lock_free);

constexpr std::string_view k_prefix = ".kelpie-";
constexpr time_t k_day_s = 24 * 60 * 60;

void die(int signal_number) {
  remove_leftovers();
  end_message_line();
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

/// The hash of the host's name, eight digits.
std::string host_digits() {
  char name[256] = "localhost";
  gethostname(name, sizeof name - 1);
  return fmt::format("{:08x}", static_cast<uint32_t>(std::hash<std::string_view>{}(name)));
}

bool is_unfinished_name(const std::string& name) {
  static const std::regex pattern("\\.kelpie-[0-9a-f]{8}-[0-9a-f]{12}\\.part");
  return std::regex_match(name, pattern);
}

/// Whether nobody can still be writing it.
bool is_of_the_dead(int file, const std::string& name, const struct stat& status) {
  const bool is_of_this_host = name.find(host_digits()) == k_prefix.size();
  if (!is_of_this_host && status.st_mtime > std::time(nullptr) - k_day_s) return false;
  return flock(file, LOCK_EX | LOCK_NB) == 0;
}

/// Removes a file or a folder, if its owner is dead.
void remove_if_of_the_dead(const fs::path& path) {
  const FileDescriptor file(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC));
  struct stat status {};
  if (!file.is_open() || fstat(file.number(), &status) != 0 || !(S_ISREG(status.st_mode) || S_ISDIR(status.st_mode))) return;
  std::error_code ignored;
  if (is_of_the_dead(file.number(), path.filename().string(), status)) fs::remove_all(path, ignored);
}

/// True at the first call for a folder.
bool is_first_look(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<fs::path> seen;
  const std::lock_guard lock(mutex);
  return seen.insert(folder).second;
}

} // namespace

Leftover::Leftover(int folder, const std::string& name, Kind kind) {
  if (name.size() >= sizeof Slot::name) return;
  for (size_t i = 0; i < g_slots.size(); ++i) {
    Slot& slot = g_slots[i];
    if (slot.is_taken.exchange(true)) continue;
    slot.folder = folder, slot.is_folder = kind == Kind::folder;
    std::memcpy(slot.name.data(), name.c_str(), name.size() + 1);
    slot.is_live = true;
    slot_ = static_cast<int>(i);
    return;
  }
}

Leftover::~Leftover() {
  if (slot_ < 0) return;
  g_slots[size_t(slot_)].is_live = false;
  g_slots[size_t(slot_)].is_taken = false;
}

void remove_leftovers() noexcept {
  if (const pid_t helper = g_helper; helper > 0 && kill(helper, SIGKILL) == 0)
    waitpid(helper, nullptr, 0);             // first: it writes one of the files
  for (const bool is_folder : {false, true}) // files first: folders must be empty
    for (const Slot& slot : g_slots)
      if (slot.is_live && slot.is_folder == is_folder) unlinkat(slot.folder, slot.name.data(), is_folder ? AT_REMOVEDIR : 0);
}

void set_helper(pid_t process) noexcept { g_helper = process; }

void clean_up_on_signals() {
  struct sigaction action {
  }, before{};
  action.sa_handler = die;
  sigfillset(&action.sa_mask);
  for (const int s : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) {
    sigaction(s, nullptr, &before);
    if (s != SIGHUP || before.sa_handler != SIG_IGN) sigaction(s, &action, nullptr); // else nohup started us
  }
}

std::string unfinished_name() {
  static std::atomic<uint32_t> count{0};
  static const uint32_t first = std::random_device{}();
  return fmt::format("{}{}-{:08x}{:04x}.part", k_prefix, host_digits(), first, count++ & 0xffff);
}

bool lock_in_use(int file) noexcept {
  if (flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false; // by a run that takes it for a dead one's
  struct stat status {};
  return fstat(file, &status) == 0 && status.st_nlink > 0;
}

FileDescriptor open_folder(const fs::path& folder, const std::string& shown) {
  FileDescriptor opened(open(folder.empty() ? "." : folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!opened.is_open()) throw Error(ExitStatus::cannot_write, fmt::format("{}: {}", shown, std::strerror(errno)));
  return opened;
}

void remove_what_dead_runs_left(const fs::path& folder) noexcept try {
  if (!is_first_look(folder)) return;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder.empty() ? "." : folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error))
    if (is_unfinished_name(entry->path().filename().string())) remove_if_of_the_dead(entry->path());
} catch (const std::exception&) { // no memory for it: the next run's
}

} // namespace kelpie
