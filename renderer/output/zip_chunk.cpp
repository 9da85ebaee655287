#include "renderer/output/zip_chunk.h"

#include "renderer/output/deflate.h"

namespace kelpie {

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
  deflate_runs(differences_, zipped_);
  return zipped_.size() < rows.size() ? std::span<const unsigned char>(zipped_) : rows;
}

} // namespace kelpie
