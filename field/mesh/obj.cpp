#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include "field/mesh/formats.h"

namespace kelpie {

namespace {

/// Statements that say nothing about faces and positions: those that name something, and all.
constexpr std::array<std::string_view, 12> k_names{"o",     "g",          "usemtl",    "mtllib", "usemap", "maplib",
                                                   "group", "shadow_obj", "trace_obj", "call",   "csh",    "s"};
constexpr std::array<std::string_view, 38> k_ignored{
    "vt",       "vn",       "vp",   "l",          "p",         "o",    "g",    "s",      "usemtl", "mtllib", "mg",    "cstype", "deg",
    "bmat",     "step",     "curv", "curv2",      "surf",      "parm", "trim", "hole",   "scrv",   "sp",     "end",   "con",    "bevel",
    "c_interp", "d_interp", "lod",  "shadow_obj", "trace_obj", "call", "csh",  "maplib", "usemap", "ctech",  "stech", "group"};

class ObjReader {
public:
  ObjReader(std::string_view bytes, const std::string& file, Diagnostics& diagnostics)
      : text_(without_padding(bytes, file), file), diagnostics_(diagnostics) {
    text_.set_comment('#');
    text_.set_continuation('\\');
  }

  PolygonSoup read() {
    do {
      const std::string word = lower_case(text_.next_in_line());
      if (word == "v")
        read_position(text_, &TextCursor::next_in_line, "expected three numbers after \"v\"", soup_);
      else if (word == "f" || word == "fo")
        read_face();
      else if (!word.empty())
        ignore(word);
    } while (text_.next_line());
    check_indices();
    return std::move(soup_);
  }

private:
  void read_face() {
    const int line = text_.where().line;
    corners_.clear();
    for (;;) {
      const std::string_view word = text_.next_in_line();
      if (word.empty()) break;
      const auto index = to_integer(word.substr(0, word.find('/')));
      if (!index) text_.fail("expected the index of a vertex");
      if (*index == 0) text_.fail("vertex index 0: the first vertex of an OBJ file is 1");
      // A negative index counts back from the latest vertex.
      const long long resolved = *index > 0 ? *index - 1 : static_cast<long long>(soup_.positions.size()) + *index;
      if (resolved < 0 || resolved >= std::numeric_limits<uint32_t>::max()) text_.fail(fmt::format("there is no vertex {}", *index));
      corners_.push_back(static_cast<uint32_t>(resolved));
    }
    append_face(soup_, corners_, line, text_.file());
  }

  /// Names may end in a backslash, which joins no line.
  void ignore(const std::string& word) {
    if (std::find(k_names.begin(), k_names.end(), word) != k_names.end()) text_.rest_of_line();
    if (std::find(k_ignored.begin(), k_ignored.end(), word) != k_ignored.end()) return;
    const bool is_text = std::all_of(word.begin(), word.end(), [](char c) { return c > ' ' && c <= '~'; });
    if (!is_text || word.size() > 32) text_.fail("not an OBJ file");
    if (!has_warned_)
      diagnostics_.warning(text_.where(), fmt::format("unknown OBJ statement \"{}\" (it and others like it are ignored)", word));
    has_warned_ = true;
  }

  /// A face may name vertices that come later.
  void check_indices() const {
    for (size_t f = 0; f < soup_.face_count(); ++f)
      for (size_t c = soup_.face_begin(f); c < soup_.face_ends[f]; ++c)
        if (soup_.corners[c] >= soup_.positions.size())
          throw Error(ExitStatus::bad_data,
                      fmt::format("there is no vertex {}: the file has {}", soup_.corners[c] + 1, soup_.positions.size()),
                      {text_.file(), soup_.lines[f], 0});
  }

  TextCursor text_;
  Diagnostics& diagnostics_;
  PolygonSoup soup_;
  std::vector<uint32_t> corners_;
  bool has_warned_ = false;
};

} // namespace

PolygonSoup read_obj(std::string_view bytes, const std::string& file, Diagnostics& diagnostics) {
  return ObjReader(bytes, file, diagnostics).read();
}

} // namespace kelpie
