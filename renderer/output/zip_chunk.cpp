#include "renderer/output/zip_chunk.h"

#include <new>

#include <libdeflate.h>

namespace kelpie {

namespace {
constexpr int k_quickest = 1;
}

ChunkZipper::ChunkZipper() : compressor_(libdeflate_alloc_compressor(k_quickest)) {
  if (!compressor_) throw std::bad_alloc();
}

ChunkZipper::~ChunkZipper() { libdeflate_free_compressor(compressor_); }

/// As EXR has it: first all bytes at even places, then all at odd ones, of each its difference to the one before.
void ChunkZipper::reorder(std::span<const unsigned char> rows) {
  const size_t n = rows.size(), half = (n + 1) / 2;
  reordered_.resize(n), differences_.resize(n);
  unsigned char *const even = reordered_.data(), *const odd = even + half;
  for (size_t i = 0; i < n / 2; ++i) even[i] = rows[2 * i], odd[i] = rows[2 * i + 1];
  if (n % 2) even[half - 1] = rows[n - 1];
  differences_[0] = reordered_[0];
  for (size_t i = 1; i < n; ++i) differences_[i] = static_cast<unsigned char>(reordered_[i] - reordered_[i - 1] + 128);
}

std::span<const unsigned char> ChunkZipper::zip(std::span<const unsigned char> rows) {
  if (rows.empty()) return rows;
  reorder(rows);
  zipped_.resize(rows.size()); // what needs more is not taken
  const size_t size = libdeflate_zlib_compress(compressor_, differences_.data(), differences_.size(), zipped_.data(), zipped_.size());
  return size > 0 && size < rows.size() ? std::span<const unsigned char>(zipped_).first(size) : rows;
}

} // namespace kelpie
