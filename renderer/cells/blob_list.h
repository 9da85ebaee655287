// Sums of blobs as their solvers read them: rows of numbers.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kelpie {

/// The numbers of a blob in a list. Its potential at a point p is q^2 (a + b q) with q = max(0, s - k |p - (x, y, z)|^2); of a pure
/// list it is q^2, and there are no rows a and b.
enum BlobRow : uint32_t { blob_x, blob_y, blob_z, blob_s, blob_k, blob_a, blob_b };

/// What rows a list of blobs has.
struct BlobForm {
  bool is_pure = true; ///< quartic falloffs and positive weights only: s and k hold the square root of the weight. Else s is 1
  bool moves = false;  ///< numbers move linearly over the slab: of a pure list x, y and z, of another all but s

  constexpr uint32_t standing_rows() const { return is_pure ? blob_k + 1 : blob_b + 1; }
  constexpr uint32_t rows() const { return standing_rows() + (moves ? (is_pure ? 3 : 6) : 0); }
  /// The row that says by how much another changes over the slab.
  constexpr uint32_t change_of(BlobRow row) const { return standing_rows() + (row < blob_s ? row : row - 1); }
};

/// The blobs of a cell: row r of blob i is row(r)[i]. What pads the list has s < 0 and is 0 everywhere.
struct BlobList {
  const float* numbers = nullptr;
  uint32_t count = 0; ///< with padding, a multiple of k_leaf_group
  BlobForm form;

  const float* row(uint32_t r) const { return numbers + size_t(r) * count; }
  bool is_padding(size_t i) const { return row(blob_s)[i] < 0; }
};

/// run.operator()<form>() for the form of a list.
template <class Run>
auto for_form(BlobForm form, Run&& run) {
  if (form.is_pure) return form.moves ? run.template operator()<BlobForm{true, true}>() : run.template operator()<BlobForm{true, false}>();
  return form.moves ? run.template operator()<BlobForm{false, true}>() : run.template operator()<BlobForm{false, false}>();
}

} // namespace kelpie
