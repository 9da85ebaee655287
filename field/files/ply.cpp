#include "field/files/ply.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "field/files/text_cursor.h"

namespace kelpie {

namespace {

std::optional<PlyType> type_named(const std::string& name) {
  static constexpr std::array<std::pair<std::string_view, PlyType>, 18> k_types{{{"char", PlyType::int8},
                                                                                 {"uchar", PlyType::uint8},
                                                                                 {"short", PlyType::int16},
                                                                                 {"ushort", PlyType::uint16},
                                                                                 {"int", PlyType::int32},
                                                                                 {"uint", PlyType::uint32},
                                                                                 {"float", PlyType::float32},
                                                                                 {"double", PlyType::float64},
                                                                                 {"int8", PlyType::int8},
                                                                                 {"uint8", PlyType::uint8},
                                                                                 {"int16", PlyType::int16},
                                                                                 {"uint16", PlyType::uint16},
                                                                                 {"int32", PlyType::int32},
                                                                                 {"uint32", PlyType::uint32},
                                                                                 {"int64", PlyType::int64},
                                                                                 {"uint64", PlyType::uint64},
                                                                                 {"float32", PlyType::float32},
                                                                                 {"float64", PlyType::float64}}};
  for (const auto& [known, type] : k_types)
    if (known == name) return type;
  return std::nullopt;
}

size_t size_of(PlyType t) {
  switch (t) {
  case PlyType::int8:
  case PlyType::uint8: return 1;
  case PlyType::int16:
  case PlyType::uint16: return 2;
  case PlyType::int32:
  case PlyType::uint32:
  case PlyType::float32: return 4;
  case PlyType::int64:
  case PlyType::uint64:
  case PlyType::float64: return 8;
  }
  return 8;
}

/// The fewest bytes a row can take: in ASCII a digit and a separator for each number.
size_t smallest_row(const PlyElement& e, PlyFormat format) {
  size_t bytes = 0;
  for (const PlyProperty& p : e.properties) bytes += format == PlyFormat::ascii ? 2 : size_of(p.is_list ? p.count_type : p.type);
  return bytes;
}

class HeaderReader {
public:
  HeaderReader(std::string_view bytes, const std::string& file) : text_(bytes, file), bytes_(bytes) {
    if (bytes.starts_with("\xef\xbb\xbf")) text_ = TextCursor(bytes.substr(3), file), skipped_ = 3;
  }

  PlyHeader read() {
    if (lower_case(text_.next()) != "ply") text_.fail("not a PLY file: it does not begin with \"ply\"");
    bool has_format = false;
    for (;;) {
      if (!text_.next_line()) text_.fail("the PLY header has no \"end_header\"");
      const std::string word = lower_case(text_.next_in_line());
      if (word == "end_header") break;
      if (word == "format")
        read_format(), has_format = true;
      else if (word == "element")
        read_element();
      else if (word == "property")
        read_property();
      else if (word != "comment" && word != "obj_info" && !word.empty())
        text_.fail(fmt::format("unknown word in the PLY header: \"{:.40}\"", printable(word)));
    }
    if (!has_format) text_.fail("the PLY header has no \"format\"");
    step_into_body();
    check_counts();
    return std::move(header_);
  }

private:
  /// Where lines end in \r alone, a \n behind the last belongs to the body.
  void step_into_body() {
    text_.next_line();
    header_.body = skipped_ + text_.offset();
    const std::string_view header = bytes_.substr(0, header_.body);
    if (header.ends_with("\r\n") && header.find('\n') == header.size() - 1) --header_.body;
  }

  static std::string printable(std::string_view word) {
    std::string s;
    for (const char c : word) s += c >= ' ' && c <= '~' ? c : '?';
    return s;
  }

  void read_format() {
    const std::string word = lower_case(text_.next_in_line());
    if (word == "ascii")
      header_.format = PlyFormat::ascii;
    else if (word == "binary_little_endian")
      header_.format = PlyFormat::little_endian;
    else if (word == "binary_big_endian")
      header_.format = PlyFormat::big_endian;
    else
      text_.fail("unknown PLY format; known: ascii, binary_little_endian, binary_big_endian");
  }

  void read_element() {
    PlyElement e;
    e.name = lower_case(text_.next_in_line());
    e.line = text_.where().line;
    const auto count = to_integer(text_.next_in_line());
    if (e.name.empty() || !count || *count < 0) text_.fail("expected: element NAME COUNT");
    e.count = static_cast<size_t>(*count);
    for (const PlyElement& other : header_.elements)
      if (other.name == e.name) text_.fail(fmt::format("two elements of the name \"{:.40}\"", printable(e.name)));
    header_.elements.push_back(std::move(e));
  }

  PlyType read_type() {
    const auto type = type_named(lower_case(text_.next_in_line()));
    if (!type) text_.fail("unknown PLY type; known: char, uchar, short, ushort, int, uint, int64, uint64, float, double");
    return *type;
  }

  void read_property() {
    if (header_.elements.empty()) text_.fail("a property before any element");
    PlyProperty p;
    TextCursor ahead = text_;
    if (lower_case(ahead.next_in_line()) == "list") {
      text_.next_in_line();
      p.is_list = true;
      p.count_type = read_type();
      if (p.count_type == PlyType::float32 || p.count_type == PlyType::float64) text_.fail("the length of a list must be a whole number");
    }
    p.type = read_type();
    p.name = lower_case(text_.next_in_line());
    if (p.name.empty()) text_.fail("a property without a name");
    header_.elements.back().properties.push_back(std::move(p));
  }

  void check_counts() const {
    size_t remaining = text_.remaining() + 1; // the last separator may be missing
    for (const PlyElement& e : header_.elements) {
      const size_t row = smallest_row(e, header_.format);
      if (row == 0 ? e.count > 0 : e.count > remaining / row)
        throw Error(ExitStatus::bad_data,
                    fmt::format("{} \"{}\" elements are promised, but only {} bytes follow", e.count, e.name, text_.remaining()),
                    {text_.file(), e.line, 0});
      remaining -= e.count * row;
    }
  }

  TextCursor text_;
  std::string_view bytes_;
  size_t skipped_ = 0; ///< of the bytes, before the text
  PlyHeader header_;
};

/// Numbers of a binary body.
class BinarySource {
public:
  BinarySource(std::string_view bytes, size_t offset, std::string file, bool is_big)
      : bytes_(bytes), offset_(offset), file_(std::move(file)), swap_(is_big != (std::endian::native == std::endian::big)) {}

  double number(PlyType t) {
    switch (t) {
    case PlyType::int8: return load<int8_t>();
    case PlyType::uint8: return load<uint8_t>();
    case PlyType::int16: return load<int16_t>();
    case PlyType::uint16: return load<uint16_t>();
    case PlyType::int32: return load<int32_t>();
    case PlyType::uint32: return load<uint32_t>();
    case PlyType::int64: return static_cast<double>(load<int64_t>());
    case PlyType::uint64: return static_cast<double>(load<uint64_t>());
    case PlyType::float32: return load<float>();
    case PlyType::float64: return load<double>();
    }
    return 0;
  }
  int line() const { return 0; }
  bool has_room(size_t count, PlyType t) const { return count <= (bytes_.size() - offset_) / size_of(t); }
  [[noreturn]] void fail(const std::string& message) const { throw Error(ExitStatus::bad_data, message, {file_, 0, 0}); }

private:
  template <class T>
  T load() {
    if (bytes_.size() - offset_ < sizeof(T)) fail("the PLY file is cut off");
    std::array<char, sizeof(T)> raw;
    for (size_t i = 0; i < sizeof(T); ++i) raw[swap_ ? sizeof(T) - 1 - i : i] = bytes_[offset_ + i];
    offset_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }

  std::string_view bytes_;
  size_t offset_;
  std::string file_;
  bool swap_;
};

/// Numbers of an ASCII body.
class TextSource {
public:
  TextSource(std::string_view bytes, size_t offset, const std::string& file) : text_(without_padding(bytes, file), file) {
    const size_t skipped = bytes.starts_with("\xef\xbb\xbf") ? 3 : 0;
    while (skipped + text_.offset() < offset && text_.next_line()) {
    }
  }

  double number(PlyType) {
    const std::string_view word = text_.next();
    if (word.empty()) text_.fail("the PLY file is cut off");
    const auto value = to_number(word);
    if (!value) text_.fail("expected a number");
    return *value;
  }
  int line() const { return text_.where().line; }
  bool has_room(size_t count, PlyType) const { return count <= (text_.remaining() + 1) / 2; }
  [[noreturn]] void fail(const std::string& message) const { text_.fail(message); }

private:
  TextCursor text_;
};

template <class Source>
void read_rows(Source source, const PlyHeader& header, const std::function<void(const PlyElement&, const PlyRow&)>& visit) {
  PlyRow row;
  for (const PlyElement& e : header.elements) {
    row.scalars.assign(e.properties.size(), 0);
    row.lists.assign(e.properties.size(), {});
    for (size_t i = 0; i < e.count; ++i) {
      for (size_t k = 0; k < e.properties.size(); ++k) {
        const PlyProperty& p = e.properties[k];
        row.scalars[k] = source.number(p.is_list ? p.count_type : p.type);
        if (k == 0) row.line = source.line();
        if (!p.is_list) continue;
        const double count = row.scalars[k];
        if (!(count >= 0 && count <= 4294967295.0 && count == std::floor(count)) || !source.has_room(static_cast<size_t>(count), p.type))
          source.fail(fmt::format("a list of {} items in a \"{}\" is longer than the file", count, e.name));
        row.lists[k].resize(static_cast<size_t>(count));
        for (double& item : row.lists[k]) item = source.number(p.type);
      }
      visit(e, row);
    }
  }
}

} // namespace

int PlyElement::column(std::string_view property, bool is_list) const {
  for (size_t k = 0; k < properties.size(); ++k)
    if (properties[k].name == property && properties[k].is_list == is_list) return static_cast<int>(k);
  return -1;
}

PlyHeader read_ply_header(std::string_view bytes, const std::string& file) { return HeaderReader(bytes, file).read(); }

void read_ply_rows(std::string_view bytes, const std::string& file, const PlyHeader& header,
                   const std::function<void(const PlyElement&, const PlyRow&)>& visit) {
  if (header.format == PlyFormat::ascii)
    read_rows(TextSource(bytes, header.body, file), header, visit);
  else
    read_rows(BinarySource(bytes, header.body, file, header.format == PlyFormat::big_endian), header, visit);
}

} // namespace kelpie
