#include "scene/assets.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <xxhash.h>

#include "scene/document.h"

namespace kelpie {

namespace fs = std::filesystem;

namespace {

/// The path as it is where the working directory is gone.
fs::path absolute_path(const fs::path& path) {
  std::error_code error;
  fs::path result = fs::absolute(path, error);
  return error ? path : result;
}

/// Symbolic links resolved; where that fails (a loop of links, a name too long) the path as it is: it
/// will be found missing.
fs::path canonical_path(const fs::path& path) {
  std::error_code error;
  fs::path result = fs::weakly_canonical(absolute_path(path), error);
  return error ? path : result;
}

bool is_under(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

class Hasher {
public:
  Hasher() : state_(XXH3_createState(), XXH3_freeState) { XXH3_128bits_reset(state_.get()); }

  void add(std::string_view bytes) { XXH3_128bits_update(state_.get(), bytes.data(), bytes.size()); }
  void add_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error(ExitStatus::missing_input, fmt::format("cannot read {}", in_quotes(path)));
    std::vector<char> block(1 << 20);
    size_t total = 0;
    while (file) {
      file.read(block.data(), static_cast<std::streamsize>(block.size()));
      const size_t n = static_cast<size_t>(file.gcount());
      add({block.data(), n});
      total += n;
    }
    if (file.bad()) throw Error(ExitStatus::missing_input, fmt::format("cannot read {}", in_quotes(path)));
    add(fmt::format(":{};", total)); // so that no byte can move from one file to the next
  }
  std::string hex() const {
    const XXH128_hash_t h = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", h.high64, h.low64);
  }

private:
  std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

} // namespace

AssetFolder::AssetFolder(const std::string& scene_path, const std::vector<std::string>& allow_paths)
    : scene_(canonical_path(scene_path)), folder_(canonical_path(absolute_path(scene_path).parent_path())) {
  for (const std::string& path : allow_paths) {
    fs::path p = canonical_path(path);
    allowed_.push_back(p.has_filename() ? p : p.parent_path()); // `folder/` is `folder`
  }
}

std::string AssetFolder::resolve(const fs::path& from, const std::string& as_written, bool is_free) const {
  if (as_written.empty() || as_written.find('\0') != std::string::npos)
    throw Error(ExitStatus::bad_data, in_quotes(as_written) + " is no path");
  const fs::path path = canonical_path(folder_ / from / as_written);
  const bool is_allowed = is_free || is_under(path, folder_) ||
                          std::any_of(allowed_.begin(), allowed_.end(), [&](const fs::path& a) { return is_under(path, a); });
  if (!is_allowed)
    throw Error(ExitStatus::bad_data, fmt::format("{} lies outside the scene's folder (--allow-path permits it)", in_quotes(as_written)));
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    throw Error(ExitStatus::missing_input, fmt::format("{} does not exist ({})", in_quotes(as_written), path.string()));
  if (!fs::is_regular_file(status)) throw Error(ExitStatus::missing_input, fmt::format("{} is no file", in_quotes(as_written)));
  return path.string();
}

std::string hash_scene(const std::string& canonical_text, const AssetFiles& files) {
  Hasher hasher;
  hasher.add(canonical_text);
  for (const auto& [as_written, path] : files) hasher.add(as_written + ":"), hasher.add_file(path);
  return hasher.hex();
}

} // namespace kelpie
