#include "base/cache_folder.h"

#include <cstdlib>

namespace kelpie {

namespace fs = std::filesystem;

fs::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && fs::path(cache).is_absolute()) return fs::path(cache) / "kelpie";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "kelpie";
  return {};
}

} // namespace kelpie
