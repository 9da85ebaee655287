// Sums of blobs as their solvers read them: rows of numbers.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kelpie {

/// The numbers of a blob in a list. Its potential at a point p is q^2 (a + b q) with q = max(0, s - k |p - (x, y, z)|^2); of a pure
/// list it is q^2, and there are no rows a and b. Ellipsoids have q = max(0, s - |m (p - (x, y, z))|^2) with a symmetric matrix m instead.
enum BlobRow : uint32_t { blob_x, blob_y, blob_z, blob_s, blob_k, blob_a, blob_b };

/// The numbers of the matrix m.
enum BlobShapeRow : uint32_t { shape_xx, shape_yy, shape_zz, shape_xy, shape_xz, shape_yz };
inline constexpr uint32_t k_shape_rows = shape_yz + 1;

/// What rows a list of blobs has.
struct BlobForm {
  bool is_pure = true;  ///< quartic falloffs and positive weights only: s, and k or m^2, hold the square root of the weight. Else s is 1
  bool moves = false;   ///< numbers move linearly over the slab: of a pure list x, y and z, of another all but s
  bool is_round = true; ///< no ellipsoids

  constexpr uint32_t first_shape_row() const { return is_pure ? blob_k + 1 : blob_b + 1; }
  constexpr uint32_t standing_rows() const { return first_shape_row() + (is_round ? 0 : k_shape_rows); }
  constexpr uint32_t rows() const { return standing_rows() + (moves ? (is_pure ? 3 : 6 + (is_round ? 0 : k_shape_rows)) : 0); }
  /// The row of a number of the matrix.
  constexpr uint32_t row_of(BlobShapeRow row) const { return first_shape_row() + row; }
  /// The row that says by how much another changes over the slab.
  constexpr uint32_t change_of(BlobRow row) const { return standing_rows() + (row < blob_s ? row : row - 1); }
  constexpr uint32_t change_of(BlobShapeRow row) const { return standing_rows() + 6 + row; }
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
  const auto with_shape = [&]<bool k_is_round>() {
    if (form.is_pure)
      return form.moves ? run.template operator()<BlobForm{true, true, k_is_round}>()
                        : run.template operator()<BlobForm{true, false, k_is_round}>();
    return form.moves ? run.template operator()<BlobForm{false, true, k_is_round}>()
                      : run.template operator()<BlobForm{false, false, k_is_round}>();
  };
  return form.is_round ? with_shape.template operator()<true>() : with_shape.template operator()<false>();
}

} // namespace kelpie
