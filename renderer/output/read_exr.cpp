// Frames from EXR files, kelpie's own and others.
#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <stdexcept>

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <fmt/format.h>

#include "base/error.h"
#include "base/file_bytes.h"
#include "renderer/output/exr.h"
#include "renderer/output/exr_attributes.h"
#include "renderer/output/file_hash.h"
#include "renderer/output/packed_pixels.h"
#include "renderer/output/zip_chunk.h"

namespace kelpie {

namespace {

constexpr int k_max_side = 65536, k_max_channels = 1024;

class MemoryReader : public Imf::IStream {
public:
  explicit MemoryReader(std::span<const unsigned char> bytes) : IStream("memory.exr"), bytes_(bytes) {}

  bool read(char* to, int count) override {
    if (count < 0 || size_t(count) > bytes_.size() - place_) throw Iex::InputExc("Unexpected end of file.");
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(place_), count, to);
    place_ += size_t(count);
    return place_ < bytes_.size();
  }
  uint64_t tellg() override { return place_; }
  void seekg(uint64_t place) override { place_ = std::min<uint64_t>(place, bytes_.size()); }

private:
  std::span<const unsigned char> bytes_;
  size_t place_ = 0;
};

/// What OpenEXR reads, and kelpie does not.
struct Refused : std::runtime_error {
  using runtime_error::runtime_error;
};

/// EXR bytes whose first part is a picture within the limits.
class ExrFile {
public:
  /// Throws what OpenEXR throws, and Refused.
  explicit ExrFile(std::span<const unsigned char> bytes) : reader_(bytes), file_(reader_, 0) {
    const Imath::Box2i& w = window();
    const int64_t width = int64_t(w.max.x) - w.min.x + 1, height = int64_t(w.max.y) - w.min.y + 1;
    if (header().hasType() && Imf::isDeepData(header().type())) throw Refused("deep pictures are not supported");
    const Imf::ChannelList& channels = header().channels();
    for (auto c = channels.begin(); c != channels.end(); ++c) {
      ++channel_count_;
      is_half_and_float_ = is_half_and_float_ && c.channel().type != Imf::UINT;
    }
    if (width > k_max_side || height > k_max_side || channel_count_ > k_max_channels)
      throw Refused(fmt::format("{}×{} pixels with {} channels are too many", width, height, channel_count_));
    for (auto c = channels.begin(); c != channels.end(); ++c)
      if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
        throw Refused(fmt::format("Subsampled channels are not supported (channel \"{}\" has sampling {},{})", c.name(),
                                  c.channel().xSampling, c.channel().ySampling));
  }

  const Imf::Header& header() const { return file_.header(0); }
  const Imath::Box2i& window() const { return header().dataWindow(); }
  /// A frame without pixels.
  FrameImage describe() const;
  /// Calls visit(first row, rows as RowLayout says) for all rows from the top, some at a time.
  template <class Visit>
  void read_rows(const FrameImage& described, const RowLayout&, Visit&& visit);
  void scale_whole_numbers(FrameImage&) const;

private:
  MemoryReader reader_;
  Imf::MultiPartInputFile file_;
  int channel_count_ = 0;
  bool is_half_and_float_ = true; ///< EXR also knows uint; a file that has one is read as float throughout
};

/// Of the channels of a layer R, G, B and A are first.
int rank_in_layer(std::string_view name) {
  constexpr std::array<std::string_view, 4> k_first{"R", "G", "B", "A"};
  return static_cast<int>(std::find(k_first.begin(), k_first.end(), name) - k_first.begin());
}

/// The layer of a channel, and its place there.
std::pair<std::string_view, int> place_of(std::string_view name) {
  const size_t dot = name.rfind('.');
  if (dot == name.npos) return {"", rank_in_layer(name)};
  return {name.substr(0, dot), rank_in_layer(name.substr(dot + 1))};
}

FrameImage ExrFile::describe() const {
  const Imath::Box2i &w = window(), &shown = header().displayWindow();
  const int x0 = w.min.x - shown.min.x, y0 = w.min.y - shown.min.y;
  FrameImage image({shown.max.x - shown.min.x + 1, shown.max.y - shown.min.y + 1},
                   PixelBox{x0, y0, x0 + w.max.x - w.min.x + 1, y0 + w.max.y - w.min.y + 1});
  const Imf::ChannelList& channels = header().channels();
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    const bool is_half = is_half_and_float_ && c.channel().type == Imf::HALF;
    image.channels.push_back({c.name(), is_half ? ChannelDepth::half : ChannelDepth::full, {}});
  }
  std::stable_sort(image.channels.begin(), image.channels.end(),
                   [](const FrameChannel& a, const FrameChannel& b) { return place_of(a.name) < place_of(b.name); });
  return image;
}

/// Where OpenEXR puts rows of pixels: those from `top` on, `height` of them.
Imf::FrameBuffer frame_buffer_on(std::vector<unsigned char>& rows, const FrameImage& image, const RowLayout& layout, Imath::Box2i window,
                                 int top, int height) {
  window.min.y = top, window.max.y = top + height - 1;
  Imf::FrameBuffer buffer;
  for (const size_t c : layout.order) {
    const FrameChannel& channel = image.channels[c];
    buffer.insert(channel.name, Imf::Slice::Make(channel.depth == ChannelDepth::half ? Imf::HALF : Imf::FLOAT,
                                                 rows.data() + layout.offsets[c], window, size_of(channel.depth), layout.row_size));
  }
  return buffer;
}

template <class Visit>
void ExrFile::read_rows(const FrameImage& described, const RowLayout& layout, Visit&& visit) {
  const int y0 = window().min.y, y1 = window().max.y + 1;
  std::vector<unsigned char> rows;
  if (header().hasType() && Imf::isTiled(header().type())) {
    rows.resize(layout.row_size * layout.height);
    Imf::TiledInputPart part(file_, 0);
    part.setFrameBuffer(frame_buffer_on(rows, described, layout, window(), y0, y1 - y0));
    part.readTiles(0, part.numXTiles() - 1, 0, part.numYTiles() - 1);
    visit(size_t(0), rows);
    return;
  }
  Imf::InputPart part(file_, 0);
  for (int y = y0; y < y1;) {
    const int count = std::min(static_cast<int>(k_rows_of_chunk), y1 - y);
    rows.assign(layout.row_size * size_t(count), 0);
    part.setFrameBuffer(frame_buffer_on(rows, described, layout, window(), y, count));
    part.readPixels(y, y + count - 1);
    visit(size_t(y - y0), rows);
    y += count;
  }
}

/// The largest whole number is 1.
void ExrFile::scale_whole_numbers(FrameImage& image) const {
  if (is_half_and_float_) return;
  for (FrameChannel& channel : image.channels)
    if (header().channels()[channel.name].type == Imf::UINT)
      for (float& v : channel.pixels) v *= 1.f / 4294967295.f;
}

template <class T>
const T* value_of(const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::TypedAttribute<T>>(name);
  return attribute ? &attribute->value() : nullptr;
}

std::string text_of(const Imf::Header& header, const char* name) {
  const std::string* text = value_of<std::string>(header, name);
  return text ? *text : std::string();
}

std::optional<glm::mat4> matrix_of(const Imf::Header& header, const char* name) {
  const Imath::M44f* from = value_of<Imath::M44f>(header, name);
  if (!from) return {};
  glm::mat4 matrix;
  std::copy_n(from->getValue(), 16, &matrix[0][0]);
  return matrix;
}

FrameHeader header_of(const Imf::Header& from) {
  FrameHeader header;
  if (const int* frame = value_of<int>(from, k_frame_attribute)) header.frame = *frame;
  header.scene_hash = text_of(from, k_scene_hash_attribute);
  header.meta = text_of(from, k_meta_attribute);
  if (const auto* rate = value_of<Imf::Rational>(from, "framesPerSecond"); rate && rate->n > 0 && rate->d > 0)
    header.fps = double(rate->n) / rate->d;
  header.camera_from_world = matrix_of(from, k_camera_attribute);
  header.ndc_from_world = matrix_of(from, k_ndc_attribute);
  return header;
}

/// Without pixels only the hash and the header are of use.
DecodedFrame decode(std::span<const unsigned char> bytes, const std::string& name, bool with_pixels) {
  const auto fail = [&](const std::string& why) {
    throw Error(ExitStatus::bad_data, fmt::format("{}: not a picture that can be read: {}", name, why));
  };
  constexpr std::array<unsigned char, 4> k_magic{0x76, 0x2f, 0x31, 0x01};
  if (bytes.size() < k_magic.size() || !std::equal(k_magic.begin(), k_magic.end(), bytes.begin())) fail("it is not an OpenEXR file");
  DecodedFrame frame;
  const char* stage = "OpenEXR exception";
  try {
    ExrFile file(bytes);
    frame.image = file.describe();
    frame.header = header_of(file.header());
    frame.claimed_hash = text_of(file.header(), k_pixel_hash_attribute);
    if (const auto* c = value_of<Imf::Chromaticities>(file.header(), "chromaticities"))
      frame.chromaticities = {c->red.x, c->red.y, c->green.x, c->green.y, c->blue.x, c->blue.y, c->white.x, c->white.y};
    // A small file may claim a picture of any size; ZIP makes at most a thousandth of it.
    if (frame.image.data_window.area() * frame.image.channels.size() / 4096 > bytes.size()) throw Refused("truncated");
    stage = "Failed OpenEXR read";
    const RowLayout layout(frame.image);
    PixelHash hash = begin_hash(frame.image, layout);
    if (with_pixels)
      for (FrameChannel& c : frame.image.channels) c.pixels.resize(frame.image.data_window.area());
    file.read_rows(frame.image, layout, [&](size_t first, std::span<const unsigned char> rows) {
      hash.add(rows);
      if (with_pixels) unpack_rows(rows, layout, first, frame.image);
    });
    frame.pixel_hash = hash.hex();
    file.scale_whole_numbers(frame.image);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Refused& e) {
    fail(e.what());
  } catch (const std::exception& e) {
    fail(fmt::format("{}: {}", stage, e.what()));
  }
  return frame;
}

} // namespace

DecodedFrame decode_exr(std::span<const unsigned char> bytes, const std::string& name) { return decode(bytes, name, true); }

DecodedFrame read_exr(const std::string& path) { return decode_exr(as_bytes(read_file_bytes(path)), path); }

std::string pixel_hash_of_exr(std::span<const unsigned char> bytes, const std::string& name) {
  return decode(bytes, name, false).pixel_hash;
}

bool frame_is_complete(const std::string& path, const std::string& scene_hash) try {
  const std::string bytes = read_file_bytes(path);
  return is_sealed(as_bytes(bytes)) && // else no decoder sees it
         text_of(ExrFile(as_bytes(bytes)).header(), k_scene_hash_attribute) == scene_hash;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception&) {
  return false;
}

} // namespace kelpie
