#include "base/memory_limit.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

namespace kelpie {

namespace fs = std::filesystem;

namespace {

constexpr size_t k_unlimited = std::numeric_limits<size_t>::max();

/// The number that a file of the kernel begins with; unlimited where there is none (`max`, or no such file).
size_t number_in(const fs::path& file) {
  std::ifstream in(file);
  size_t number = 0;
  return in >> number ? number : k_unlimited;
}

/// The least limit from a control group up to the root of its hierarchy.
size_t least_upwards(const fs::path& root, fs::path group, const char* file) {
  size_t least = number_in(root / file);
  for (group = group.relative_path(); !group.empty(); group = group.parent_path()) least = std::min(least, number_in(root / group / file));
  return least;
}

/// Of the control groups of both versions, as /proc/self/cgroup lists them: `number:controllers:path`.
size_t limit_of_groups() {
  const fs::path root = "/sys/fs/cgroup";
  size_t least = k_unlimited;
  std::ifstream list("/proc/self/cgroup");
  for (std::string line; std::getline(list, line);) {
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), group = line.substr(second + 1);
    if (controllers.empty()) least = std::min(least, least_upwards(root, group, "memory.max"));
    if (controllers == "memory") least = std::min(least, least_upwards(root / "memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

size_t left_of_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return k_unlimited;
  const size_t pages = number_in("/proc/self/statm");
  const size_t used = pages == k_unlimited ? 0 : pages * static_cast<size_t>(sysconf(_SC_PAGESIZE));
  return limit.rlim_cur - std::min<size_t>(used, limit.rlim_cur);
}

} // namespace

size_t memory_limit() {
  const size_t of_machine = static_cast<size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<size_t>(sysconf(_SC_PAGESIZE));
  return std::min({of_machine, limit_of_groups(), left_of_address_space()});
}

} // namespace kelpie
