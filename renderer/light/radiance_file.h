// Radiance pictures (.hdr): a byte for each of red, green and blue, and one for the exponent that they share.
#pragma once

#include <string>
#include <vector>

namespace kelpie {

struct RadiancePicture {
  int width = 0, height = 0;
  std::vector<float> rgb; ///< row by row from the top; linear Rec.709 unless the header says otherwise, which nobody does
};

/// As large as the header says: whether such a size is wanted is asked before the pixels are read. Source: Ward, "Real pixels" (Graphics
/// Gems II, 1991), and the format's description in Radiance's manual: run lengths of the newer kind, or none; rows from the top, from the
/// left. Throws std::runtime_error, which says what is wrong.
class RadianceReader {
public:
  explicit RadianceReader(const std::string& bytes);

  int width() const { return width_; }
  int height() const { return height_; }
  RadiancePicture read();

private:
  std::string line();
  unsigned char byte();
  void read_row(std::vector<unsigned char>& rgbe);

  const std::string& bytes_;
  size_t at_ = 0;
  int width_ = 0, height_ = 0;
};

} // namespace kelpie
