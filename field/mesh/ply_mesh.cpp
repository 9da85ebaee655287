#include <cmath>

#include <fmt/format.h>

#include "field/files/ply.h"
#include "field/mesh/formats.h"

namespace kelpie {

namespace {

class PlyMeshReader {
public:
  PlyMeshReader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file), header_(read_ply_header(bytes, file)) {
    for (const PlyElement& e : header_.elements) {
      const int corners = std::max(e.column("vertex_indices", true), e.column("vertex_index", true));
      if (e.name == "vertex") x_ = e.column("x"), y_ = e.column("y"), z_ = e.column("z");
      if (e.name == "face" && corners >= 0) faces_ = &e, corners_of_face_ = corners;
      if (e.name == "tristrips" && corners >= 0) strips_ = &e, corners_of_strip_ = corners;
      if (&e == faces_ && e.count > k_most_faces)
        fail(fmt::format("{} faces are more than the limit of {}", e.count, k_most_faces), e.line);
    }
    if (x_ < 0 || y_ < 0 || z_ < 0) fail("the PLY file has no vertices with x, y and z");
    if (!faces_ && !strips_) fail("the PLY file has no faces with a list vertex_indices");
  }

  PolygonSoup read() {
    read_ply_rows(bytes_, file_, header_, [&](const PlyElement& e, const PlyRow& row) {
      if (e.name == "vertex")
        append_position(soup_, {row.scalars[x_], row.scalars[y_], row.scalars[z_]}, [&] { return SourcePosition{file_, row.line, 0}; });
      else if (&e == faces_)
        read_face(row.lists[corners_of_face_], row.line);
      else if (&e == strips_)
        read_strip(row.lists[corners_of_strip_], row.line);
    });
    for (const uint32_t c : soup_.corners) // faces may come before vertices
      if (c >= soup_.positions.size()) fail(fmt::format("there is no vertex {}: the file has {}", c, soup_.positions.size()));
    return std::move(soup_);
  }

private:
  [[noreturn]] void fail(const std::string& message, int line = 0) const { throw Error(ExitStatus::bad_data, message, {file_, line, 0}); }

  uint32_t vertex(double index, int line) const {
    if (!(index >= 0 && index < static_cast<double>(UINT32_MAX) && index == std::floor(index)))
      fail(fmt::format("face {}: there is no vertex {}", soup_.face_count(), index), line);
    return static_cast<uint32_t>(index);
  }

  void read_face(const std::vector<double>& indices, int line) {
    corners_.clear();
    for (const double index : indices) corners_.push_back(vertex(index, line));
    append_face(soup_, corners_, line, file_);
  }

  /// From the third on each vertex makes a triangle with the two before, every second one the other way around; -1 begins anew.
  void read_strip(const std::vector<double>& indices, int line) {
    constexpr double k_unsigned = UINT32_MAX; // -1 where indices have no sign
    size_t begin = 0;
    for (size_t i = 0; i < indices.size(); ++i) {
      if (indices[i] == -1 || indices[i] == k_unsigned) begin = i + 1;
      if (i < begin + 2) continue;
      const size_t is_odd = (i - begin) % 2;
      corners_ = {vertex(indices[i - 2 + is_odd], line), vertex(indices[i - 1 - is_odd], line), vertex(indices[i], line)};
      append_face(soup_, corners_, line, file_);
    }
  }

  std::string_view bytes_;
  std::string file_;
  PlyHeader header_;
  int x_ = -1, y_ = -1, z_ = -1, corners_of_face_ = -1, corners_of_strip_ = -1; ///< columns
  const PlyElement *faces_ = nullptr, *strips_ = nullptr;
  PolygonSoup soup_;
  std::vector<uint32_t> corners_;
};

} // namespace

bool is_ply(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  return lower_case(TextCursor(bytes, "").next().substr(0, 4)) == "ply";
}

PolygonSoup read_ply_mesh(std::string_view bytes, const std::string& file) { return PlyMeshReader(bytes, file).read(); }

} // namespace kelpie
