// PLY files: a header that describes tables of numbers, and the tables in ASCII or binary.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace kelpie {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  bool is_list = false;
  PlyType count_type = PlyType::uint8; ///< of lists
};

/// A table: `count` rows of the properties.
struct PlyElement {
  std::string name;
  size_t count = 0;
  std::vector<PlyProperty> properties;
  int line = 0; ///< of the header

  /// The column of the property, which is a list or not, or -1.
  int column(std::string_view property, bool is_list = false) const;
};

/// One row. A list's scalar is its length; its items are in `lists` at the same column.
struct PlyRow {
  std::vector<double> scalars;
  std::vector<std::vector<double>> lists;
  int line = 0; ///< of the file; 0: it is binary
};

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  size_t body = 0; ///< the offset of the first byte after the header
};

/// Keywords, types and names may be in any case; names are in lower case here. `file` is the name that messages bear. Counts are checked
/// against the bytes that remain, so a caller may reserve room for an element's rows. Throws Error, bad_data.
PlyHeader read_ply_header(std::string_view bytes, const std::string& file);

/// Calls `visit(element, row)` for every row of the file in order.
void read_ply_rows(std::string_view bytes, const std::string& file, const PlyHeader&,
                   const std::function<void(const PlyElement&, const PlyRow&)>& visit);

} // namespace kelpie
