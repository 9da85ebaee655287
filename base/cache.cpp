#include "base/cache.h"

#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <xxhash.h>

#include "base/atomic_file.h"
#include "base/file_bytes.h"

namespace kelpie {

namespace fs = std::filesystem;

namespace {

/// Empty where there is no home to keep anything in.
fs::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && fs::path(cache).is_absolute()) return fs::path(cache) / "kelpie";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "kelpie";
  return {};
}

/// The first line of an entry: the hash of its name and of all that follows.
std::string first_line(const std::string& name, std::string_view bytes) {
  const XXH128_hash_t content = XXH3_128bits(bytes.data(), bytes.size()), key = XXH3_128bits(name.data(), name.size());
  return fmt::format("kelpie cache {:016x}{:016x} {:016x}{:016x}\n", key.high64, key.low64, content.high64, content.low64);
}

} // namespace

std::optional<std::string> read_cached(const std::string& name) {
  const fs::path folder = cache_folder();
  if (folder.empty()) return {};
  try {
    std::string entry = read_file_bytes((folder / name).string());
    static const size_t k_size = first_line("", "").size();
    if (entry.size() < k_size || entry.substr(0, k_size) != first_line(name, std::string_view(entry).substr(k_size))) return {};
    return entry.erase(0, k_size);
  } catch (const Error&) {
    return {};
  }
}

void write_cached(const std::string& name, std::string_view bytes, const std::string& what, Diagnostics& diagnostics) {
  const fs::path folder = cache_folder();
  if (folder.empty()) return;
  try {
    PartFile file(folder / name);
    file.write(as_bytes(first_line(name, bytes)));
    file.write(as_bytes(bytes));
    file.commit();
  } catch (const Error& e) {
    diagnostics.warning({}, fmt::format("{} not cached: {}", what, e.what()));
  }
}

} // namespace kelpie
