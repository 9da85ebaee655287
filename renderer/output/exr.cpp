#include "renderer/output/exr.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <span>
#include <string_view>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "colour/spaces.h"
#include "renderer/output/exr_attributes.h"
#include "renderer/output/file_hash.h"
#include "renderer/output/packed_pixels.h"
#include "renderer/output/zip_chunk.h"

namespace kelpie {

namespace {

/// Encoding to memory fails for lack of it, and then there may be none for a reason.
[[noreturn]] void encoder_failed(const std::string& why) {
  if (why.empty()) throw std::bad_alloc();
  throw Error(ExitStatus::internal, "the EXR encoder failed: " + why);
}

/// What OpenEXR writes, in memory.
class MemoryWriter : public Imf::OStream {
public:
  explicit MemoryWriter(std::vector<unsigned char>& bytes) : OStream("memory.exr"), bytes_(bytes) {}

  void write(const char* from, int count) override {
    const size_t end = place_ + size_t(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::copy_n(from, count, bytes_.begin() + static_cast<std::ptrdiff_t>(place_));
    place_ = end;
  }
  uint64_t tellp() override { return place_; }
  void seekp(uint64_t place) override { place_ = place; }
  void reserve(size_t more) { bytes_.reserve(bytes_.size() + more); }

private:
  std::vector<unsigned char>& bytes_;
  size_t place_ = 0;
};

// EXR is little endian.
void write_number(Imf::OStream& out, uint64_t number, int size) {
  std::array<char, 8> bytes;
  for (int i = 0; i < size; ++i) bytes[size_t(i)] = static_cast<char>(number >> (8 * i));
  out.write(bytes.data(), size);
}

void write_bytes(Imf::OStream& out, std::span<const unsigned char> bytes) {
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<int>(bytes.size()));
}

// OpenEXR writes the header. It offers no way to write what was compressed elsewhere, so the rest of the file is written here: a table
// of where the chunks are, and of each chunk its first row, its size and its bytes.

constexpr uint32_t k_magic_number = 20000630, k_version = 2, k_long_names_flag = 0x400;

bool has_long_names(const Imf::Header& header) {
  constexpr size_t k_short = 31;
  bool is_long = false;
  for (auto a = header.begin(); a != header.end(); ++a) is_long = is_long || std::string_view(a.name()).size() > k_short;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    is_long = is_long || std::string_view(c.name()).size() > k_short;
  return is_long;
}

void write_head(MemoryWriter& out, const Imf::Header& header) {
  out.seekp(0);
  write_number(out, k_magic_number, 4);
  write_number(out, k_version | (has_long_names(header) ? k_long_names_flag : 0), 4);
  header.writeTo(out);
}

/// Returns the hash of the pixels.
std::string write_chunks(MemoryWriter& out, const FrameImage& image, ReplacedValues& replaced) {
  const RowLayout layout(image);
  const size_t count = (layout.height + k_rows_of_chunk - 1) / k_rows_of_chunk;
  const uint64_t table = out.tellp();
  out.reserve(layout.row_size * layout.height / 2); // about what it becomes
  for (size_t i = 0; i < count; ++i) write_number(out, 0, 8);
  ChunkZipper zipper;
  PixelHash hash = begin_hash(image, layout);
  std::vector<unsigned char> rows;
  for (size_t i = 0; i < count; ++i) {
    const size_t first = i * k_rows_of_chunk;
    rows.resize(layout.row_size * std::min(k_rows_of_chunk, layout.height - first));
    pack_rows(image, layout, first, rows, replaced);
    hash.add(rows);
    const auto zipped = zipper.zip(rows);
    const uint64_t place = out.tellp();
    out.seekp(table + 8 * i);
    write_number(out, place, 8);
    out.seekp(place);
    write_number(out, static_cast<uint32_t>(image.data_window.y0 + static_cast<int>(first)), 4);
    write_number(out, zipped.size(), 4);
    write_bytes(out, zipped);
  }
  return hash.hex();
}

Imf::Rational rate_of(double fps) {
  const int thousandths = static_cast<int>(std::lround(fps * 1000));
  const bool is_whole = thousandths % 1000 == 0;
  return is_whole ? Imf::Rational(thousandths / 1000, 1) : Imf::Rational(thousandths, 1000);
}

Imath::M44f matrix_of(const glm::mat4& m) {
  Imath::M44f matrix;
  std::copy_n(&m[0][0], 16, matrix.getValue());
  return matrix;
}

Imf::Header header_for(const FrameImage& image, const FrameHeader& frame, const std::string& pixel_hash) {
  const PixelBox& w = image.data_window;
  Imf::Header header({{0, 0}, {image.resolution.x - 1, image.resolution.y - 1}}, {{w.x0, w.y0}, {w.x1 - 1, w.y1 - 1}}, 1, {0, 0}, 1,
                     Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
  for (const FrameChannel& c : image.channels)
    header.channels().insert(c.name, Imf::Channel(c.depth == ChannelDepth::half ? Imf::HALF : Imf::FLOAT));
  header.insert("capDate", Imf::StringAttribute("1970:01:01 00:00:00")); // a fixed one, else no two files were equal
  header.insert("Software", Imf::StringAttribute("kelpie " KELPIE_VERSION));
  header.insert("framesPerSecond", Imf::RationalAttribute(rate_of(frame.fps)));
  header.insert(k_frame_attribute, Imf::IntAttribute(frame.frame));
  header.insert(k_scene_hash_attribute, Imf::StringAttribute(frame.scene_hash));
  if (!frame.meta.empty()) header.insert(k_meta_attribute, Imf::StringAttribute(frame.meta));
  header.insert(k_pixel_hash_attribute, Imf::StringAttribute(pixel_hash));
  header.insert(k_file_hash_attribute, Imf::StringAttribute(unsealed_file_hash()));
  if (frame.camera_from_world) header.insert(k_camera_attribute, Imf::M44fAttribute(matrix_of(*frame.camera_from_world)));
  if (frame.ndc_from_world) header.insert(k_ndc_attribute, Imf::M44fAttribute(matrix_of(*frame.ndc_from_world)));
  if (const auto c = scene_linear_chromaticities()) {
    const auto& [rx, ry, gx, gy, bx, by, wx, wy] = *c;
    header.insert("chromaticities", Imf::ChromaticitiesAttribute(Imf::Chromaticities({rx, ry}, {gx, gy}, {bx, by}, {wx, wy})));
  }
  return header;
}

} // namespace

EncodedFrame encode_exr(const FrameImage& image, const FrameHeader& header) try {
  for (const FrameChannel& c : image.channels)
    if (const size_t n = image.data_window.area(); c.pixels.size() != n)
      throw Error(ExitStatus::internal, fmt::format("channel {} has {} pixels of {}", c.name, c.pixels.size(), n));
  EncodedFrame encoded;
  encoded.pixel_hash = std::string(k_pixel_hash_digits, '0'); // until it is known
  MemoryWriter writer(encoded.bytes);
  const Imf::Header first_header = header_for(image, header, encoded.pixel_hash);
  first_header.sanityCheck();
  write_head(writer, first_header);
  ReplacedValues replaced;
  encoded.pixel_hash = write_chunks(writer, image, replaced);
  write_head(writer, header_for(image, header, encoded.pixel_hash));
  encoded.clamped = replaced.clamped, encoded.nonfinite = replaced.nonfinite;
  seal(encoded.bytes);
  return encoded;
} catch (const std::bad_alloc&) {
  throw;
} catch (const Error&) {
  throw;
} catch (const std::exception& e) {
  encoder_failed(e.what());
}

EncodedFrame write_exr(const std::string& path, const FrameImage& image, const FrameHeader& header) {
  EncodedFrame encoded = encode_exr(image, header);
  if (pixel_hash_of_exr(encoded.bytes, path) != encoded.pixel_hash) encoder_failed("what it wrote reads back differently");
  write_file_atomically(path, encoded.bytes);
  return encoded;
}

} // namespace kelpie
