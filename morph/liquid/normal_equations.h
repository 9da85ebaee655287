// Damped least squares over blobs of ten unknowns each, by conjugate gradients.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kelpie {

/// A blob's unknowns: its place (3, in its unit ball), what its map is changed by (6: xx yy zz xy xz yz), log W; two for padding.
inline constexpr int k_blob_unknowns = 10, k_padded_unknowns = 12;
using JacobianRow = std::array<float, k_padded_unknowns>;

/// How residuals depend on blobs: for each probe the blobs that reach it, with a row for each of the probe's residuals.
struct BlobJacobian {
  struct Entry {
    uint32_t blob, row; ///< the first of its rows
  };
  std::vector<uint32_t> first_entry;    ///< for each probe, and their count
  std::vector<uint32_t> first_residual; ///< for each probe, and their count
  std::vector<Entry> entries;
  std::vector<JacobianRow> rows;
  std::vector<float> residuals;

  uint32_t residuals_of(size_t probe) const { return first_residual[probe + 1] - first_residual[probe]; }
};

/// For each blob its padded unknowns: the step x that makes |J x + r|^2 + the sum of damping (x / usual)^2 least, about. `usual` are the
/// blobs' usual steps, one for each unknown.
class NormalEquations {
public:
  NormalEquations(const BlobJacobian&, size_t blobs);
  std::vector<float> solve(double damping, const std::array<double, k_blob_unknowns>& usual) const;

private:
  void times(const std::vector<float>& x, std::vector<float>& out) const;
  void transposed_times(const std::vector<float>& y, std::vector<float>& out) const;

  const BlobJacobian& j_;
  size_t blobs_;
  std::vector<std::array<float, k_blob_unknowns * k_blob_unknowns>> squares_; ///< the blocks of J^T J on its diagonal
  std::vector<float> gradient_;
};

} // namespace kelpie
