#include "morph/liquid/fit_cache.h"

#include <fmt/format.h>
#include <xxhash.h>

#include "base/cache.h"
#include "base/file_bytes.h"
#include "field/clouds/cloud_file.h"
#include "field/files/text_cursor.h"

namespace kelpie {

namespace {

/// Raise it whenever the same mesh and options yield other blobs or figures.
constexpr int k_revision = 4;

std::string cache_key(const std::string& bytes, const FitOptions& options) {
  const XXH128_hash_t content = XXH3_128bits(bytes.data(), bytes.size());
  const std::string all = fmt::format("{:016x}{:016x} {} {} {} {} {} {} {} {} {}", content.high64, content.low64, options.blobs,
                                      options.may_use_fewer, options.weld, static_cast<int>(options.shape), options.error_share,
                                      options.error_length, options.normals, k_revision, KELPIE_VERSION);
  const XXH128_hash_t key = XXH3_128bits(all.data(), all.size());
  return fmt::format("fit-{:016x}{:016x}", key.high64, key.low64);
}

/// The figures of a fit, one line of text.
std::string figures_of(const FitResult& r) {
  return fmt::format("{} {} {} {} {} {} {}\n", r.sphere_tree_s, r.fit_s, r.rms, r.max, r.normals, r.lost, r.spurs);
}

/// The figures in the first line, and the blobs after it.
bool read_entry(const std::string& entry, FitResult& r) {
  const size_t line_end = entry.find('\n') + 1;
  const std::string line = entry.substr(0, line_end);
  TextCursor cursor(line, "");
  for (double* figure : {&r.sphere_tree_s, &r.fit_s, &r.rms, &r.max, &r.normals, &r.lost, &r.spurs}) {
    const auto value = to_number(cursor.next());
    if (!value) return false;
    *figure = *value;
  }
  r.blobs = parse_blob_cloud(entry.substr(line_end), "the cached fit");
  return true;
}

} // namespace

FitResult fit_mesh_file(const std::string& path, const FitOptions& options, bool use_cache, Diagnostics& diagnostics) {
  const std::string bytes = read_file_bytes(path);
  const Mesh mesh = parse_mesh(bytes, path, diagnostics, {options.weld}); // its warnings are due every time
  const std::string key = cache_key(bytes, options);
  FitResult result;
  if (const auto cached = use_cache ? read_cached(key) : std::nullopt; cached && read_entry(*cached, result)) {
    result.is_cached = true;
    return result;
  }
  result = fit_blobs(mesh, options, path);
  if (use_cache) write_cached(key, figures_of(result) + blob_cloud_bytes(result.blobs), "the fit is", diagnostics);
  return result;
}

} // namespace kelpie
