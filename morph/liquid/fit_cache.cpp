#include "morph/liquid/fit_cache.h"

#include <fmt/format.h>
#include <xxhash.h>

#include "base/atomic_file.h"
#include "base/cache_folder.h"
#include "base/file_bytes.h"
#include "field/clouds/cloud_file.h"
#include "field/files/text_cursor.h"

namespace kelpie {

namespace {

namespace fs = std::filesystem;

/// Raise it whenever the same mesh and options yield other blobs or figures.
constexpr int k_revision = 3;

std::string cache_key(const std::string& bytes, const FitOptions& options) {
  const XXH128_hash_t content = XXH3_128bits(bytes.data(), bytes.size());
  const std::string all = fmt::format("{:016x}{:016x} {} {} {} {} {}", content.high64, content.low64, options.blobs, options.may_use_fewer,
                                      options.weld, k_revision, KELPIE_VERSION);
  const XXH128_hash_t key = XXH3_128bits(all.data(), all.size());
  return fmt::format("fit-{:016x}{:016x}", key.high64, key.low64);
}

/// The figures of a fit as text, one a line.
std::string figures_of(const FitResult& r) {
  return fmt::format("{} {} {} {} {} {}\n", r.sphere_tree_s, r.fit_s, r.rms, r.max, r.lost, r.spurs);
}

bool read_figures(const std::string& text, FitResult& r) {
  TextCursor cursor(text, "");
  for (double* figure : {&r.sphere_tree_s, &r.fit_s, &r.rms, &r.max, &r.lost, &r.spurs}) {
    const auto value = to_number(cursor.next());
    if (!value) return false;
    *figure = *value;
  }
  return true;
}

bool read_cached(const fs::path& stem, FitResult& result) {
  try {
    result.blobs = read_blob_cloud(stem.string() + ".ply");
    return read_figures(read_file_bytes(stem.string() + ".txt"), result);
  } catch (const Error&) {
    return false; // not there, or spoilt: fitted anew and written over
  }
}

void write_cached(const fs::path& stem, const FitResult& result, Diagnostics& diagnostics) {
  try {
    std::error_code failed;
    fs::create_directories(stem.parent_path(), failed);
    write_blob_cloud(stem.string() + ".ply", result.blobs);
    write_file_atomically(stem.string() + ".txt", as_bytes(figures_of(result)));
  } catch (const Error& e) {
    diagnostics.warning({}, fmt::format("the fit is not cached: {}", e.what()));
  }
}

} // namespace

FitResult fit_mesh_file(const std::string& path, const FitOptions& options, bool use_cache, Diagnostics& diagnostics) {
  const std::string bytes = read_file_bytes(path);
  const Mesh mesh = parse_mesh(bytes, path, diagnostics, {options.weld}); // its warnings are due every time
  const fs::path folder = use_cache ? cache_folder() : fs::path();
  const fs::path stem = folder.empty() ? folder : folder / cache_key(bytes, options);
  FitResult result;
  if (!stem.empty() && read_cached(stem, result)) {
    result.is_cached = true;
    return result;
  }
  result = fit_blobs(mesh, options, path);
  if (!stem.empty()) write_cached(stem, result, diagnostics);
  return result;
}

} // namespace kelpie
