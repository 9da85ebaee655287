#include "renderer/output/exr.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file_bytes.h"
#include "renderer/output/exr_header.h"
#include "renderer/output/exr_memory.h"
#include "renderer/output/file_hash.h"
#include "renderer/output/pixel_hash.h"

namespace kelpie {

namespace {

constexpr int k_max_channels = 1024;
constexpr float k_largest_half = 65504;

Imf::PixelType type_of(ChannelDepth depth) { return depth == ChannelDepth::half ? Imf::HALF : Imf::FLOAT; }
size_t size_of(ChannelDepth depth) { return depth == ChannelDepth::half ? 2 : 4; }

/// Pixels as they are in the file: interleaved, each channel at its own depth.
struct PackedPixels {
  std::vector<unsigned char> bytes;
  std::vector<size_t> offsets; // of each channel in a pixel
  size_t stride = 0;           // of a pixel
};

PackedPixels layout(const std::vector<FrameChannel>& channels, size_t pixel_count) {
  PackedPixels packed;
  for (const FrameChannel& c : channels) {
    packed.offsets.push_back(packed.stride);
    packed.stride += size_of(c.depth);
  }
  packed.bytes.resize(packed.stride * pixel_count);
  return packed;
}

/// What the file holds instead of `v`: always finite.
float storable(float v, ChannelDepth depth, EncodedFrame& counts) {
  if (std::isnan(v)) return ++counts.nonfinite, 0.f;
  const float largest = depth == ChannelDepth::half ? k_largest_half : std::numeric_limits<float>::max();
  if (std::abs(v) <= largest) return v;
  ++(std::isinf(v) ? counts.nonfinite : counts.clamped);
  return std::copysign(largest, v);
}

// Pixels are packed, unpacked and hashed row by row: a row of all channels stays in the cache.

PackedPixels pack(const FrameImage& image, EncodedFrame& counts) {
  const size_t n = image.data_window.area(), width = n ? size_t(image.data_window.width()) : 1;
  for (const FrameChannel& c : image.channels)
    if (c.pixels.size() != n) throw Error(ExitStatus::internal, fmt::format("channel {} has {} pixels of {}", c.name, c.pixels.size(), n));
  PackedPixels packed = layout(image.channels, n);
  for (size_t row = 0; row < n; row += width)
    for (size_t c = 0; c < image.channels.size(); ++c) {
      const FrameChannel& channel = image.channels[c];
      unsigned char* out = packed.bytes.data() + row * packed.stride + packed.offsets[c];
      for (size_t i = row; i < row + width; ++i, out += packed.stride) {
        const float v = storable(channel.pixels[i], channel.depth, counts);
        if (channel.depth == ChannelDepth::full) {
          std::memcpy(out, &v, 4);
        } else {
          const Imath::half h(v);
          std::memcpy(out, &h, 2);
        }
      }
    }
  return packed;
}

void unpack(const PackedPixels& packed, FrameImage& image) {
  const size_t n = image.data_window.area(), width = n ? size_t(image.data_window.width()) : 1;
  for (FrameChannel& c : image.channels) c.pixels.resize(n);
  for (size_t row = 0; row < n; row += width)
    for (size_t c = 0; c < image.channels.size(); ++c) {
      FrameChannel& channel = image.channels[c];
      const unsigned char* in = packed.bytes.data() + row * packed.stride + packed.offsets[c];
      for (size_t i = row; i < row + width; ++i, in += packed.stride) {
        if (channel.depth == ChannelDepth::full) {
          std::memcpy(&channel.pixels[i], in, 4);
        } else {
          Imath::half h;
          std::memcpy(&h, in, 2);
          channel.pixels[i] = h;
        }
      }
    }
}

std::string hash_of(const PackedPixels& packed, const FrameImage& image) {
  const size_t n = image.data_window.area(), width = n ? size_t(image.data_window.width()) : 1;
  std::vector<size_t> order(image.channels.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return image.channels[a].name < image.channels[b].name; });
  PixelHash hash;
  hash.add(image.resolution, image.data_window);
  for (const size_t c : order) hash.add(image.channels[c].name, size_of(image.channels[c].depth));
  for (size_t row = 0; row < n; row += width)
    for (const size_t c : order)
      hash.add(size_of(image.channels[c].depth), packed.bytes.data() + row * packed.stride + packed.offsets[c], packed.stride, width);
  return hash.hex();
}

/// Where OpenEXR finds and puts the packed pixels of a data window whose first pixel is `first` in the file's coordinates.
Imf::FrameBuffer frame_buffer(PackedPixels& packed, const FrameImage& image, Imath::V2i first) {
  Imf::FrameBuffer buffer;
  const int width = image.data_window.width(), height = image.data_window.height();
  for (size_t c = 0; c < image.channels.size(); ++c)
    buffer.insert(image.channels[c].name, Imf::Slice::Make(type_of(image.channels[c].depth), packed.bytes.data() + packed.offsets[c], first,
                                                           width, height, packed.stride, packed.stride * size_t(width)));
  return buffer;
}

/// An EXR file in memory, open for reading its first part.
struct OpenFrame {
  MemoryInput stream;
  Imf::MultiPartInputFile file;

  OpenFrame(std::span<const unsigned char> bytes, const std::string& name) : stream(bytes, name), file(stream, use_exr_threads()) {
    const Imf::Header& header = file.header(0);
    const Imath::Box2i& w = header.dataWindow();
    if (header.hasType() && Imf::isDeepData(header.type())) throw Iex::InputExc("deep pictures are not supported");
    int channels = 0;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c, ++channels)
      if (c.channel().xSampling != 1 || c.channel().ySampling != 1) throw Iex::InputExc("subsampled channels are not supported");
    if (channels > k_max_channels) throw Iex::InputExc(fmt::format("{} channels are too many", channels));
    if (w.isEmpty()) throw Iex::InputExc("it has no pixels");
  }
};

/// A frame without pixels. EXR also knows uint; a file that has one is read as float throughout.
FrameImage describe(const Imf::Header& header) {
  const Imath::Box2i &data = header.dataWindow(), &display = header.displayWindow();
  const Imath::V2i first = data.min - display.min, end = data.max - display.min + Imath::V2i(1);
  FrameImage image({display.max.x - display.min.x + 1, display.max.y - display.min.y + 1}, PixelBox{first.x, first.y, end.x, end.y});
  bool may_be_half = true;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) may_be_half &= c.channel().type != Imf::UINT;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    image.channels.push_back({c.name(), may_be_half && c.channel().type == Imf::HALF ? ChannelDepth::half : ChannelDepth::full, {}});
  // The file has them in the order of the alphabet.
  const auto place = [](const FrameChannel& c) {
    return c.name.size() == 1 ? std::string_view("RGBA").find(c.name) : std::string_view::npos;
  };
  std::stable_sort(image.channels.begin(), image.channels.end(),
                   [&](const FrameChannel& a, const FrameChannel& b) { return place(a) < place(b); });
  return image;
}

/// Without pixels only the hash and the header are of use.
DecodedFrame decode(std::span<const unsigned char> bytes, const std::string& name, bool with_pixels) {
  const auto fail = [&](const std::string& why) {
    throw Error(ExitStatus::bad_data, fmt::format("{}: not a picture that can be read: {}", name, why));
  };
  constexpr std::array<unsigned char, 4> k_magic{0x76, 0x2f, 0x31, 0x01};
  if (bytes.size() < k_magic.size() || !std::equal(k_magic.begin(), k_magic.end(), bytes.begin())) fail("it is not an OpenEXR file");
  DecodedFrame frame;
  try {
    OpenFrame open(bytes, name);
    const Imf::Header& header = open.file.header(0);
    frame.image = describe(header);
    read_header(header, frame);
    const size_t n = frame.image.data_window.area();
    // A small file may claim a picture of any size; ZIP makes at most a thousandth of it.
    if (n * frame.image.channels.size() / 4096 > bytes.size()) fail("truncated");
    PackedPixels packed = layout(frame.image.channels, n);
    Imf::InputPart part(open.file, 0);
    part.setFrameBuffer(frame_buffer(packed, frame.image, header.dataWindow().min));
    part.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
    if (with_pixels) unpack(packed, frame.image);
    frame.pixel_hash = hash_of(packed, frame.image);
  } catch (const Iex::BaseExc& e) {
    fail(e.what());
  }
  return frame;
}

[[noreturn]] void encoder_failed(const std::string& why) { throw Error(ExitStatus::internal, "the EXR encoder failed: " + why); }

} // namespace

EncodedFrame encode_exr(const FrameImage& image, const FrameHeader& about) {
  EncodedFrame encoded;
  PackedPixels packed = pack(image, encoded);
  encoded.pixel_hash = hash_of(packed, image);
  const PixelBox& w = image.data_window;
  Imf::Header header(Imath::Box2i({0, 0}, {image.resolution.x - 1, image.resolution.y - 1}),
                     Imath::Box2i({w.x0, w.y0}, {w.x1 - 1, w.y1 - 1}));
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const FrameChannel& c : image.channels) header.channels().insert(c.name, Imf::Channel(type_of(c.depth)));
  write_header(header, about, encoded.pixel_hash);
  try {
    MemoryOutput stream(encoded.bytes);
    Imf::OutputFile file(stream, header, use_exr_threads());
    file.setFrameBuffer(frame_buffer(packed, image, {w.x0, w.y0}));
    file.writePixels(w.height());
  } catch (const Iex::BaseExc& e) {
    encoder_failed(e.what());
  }
  seal(encoded.bytes);
  return encoded;
}

DecodedFrame decode_exr(std::span<const unsigned char> bytes, const std::string& name) { return decode(bytes, name, true); }

DecodedFrame read_exr(const std::string& path) { return decode_exr(as_bytes(read_file_bytes(path)), path); }

EncodedFrame write_exr(const std::string& path, const FrameImage& image, const FrameHeader& header) {
  EncodedFrame encoded = encode_exr(image, header);
  if (decode(encoded.bytes, path, false).pixel_hash != encoded.pixel_hash) encoder_failed("what it wrote reads back differently");
  write_file_atomically(path, encoded.bytes);
  return encoded;
}

bool frame_is_complete(const std::string& path, const std::string& scene_hash) {
  try {
    const std::string bytes = read_file_bytes(path);
    if (!is_sealed(as_bytes(bytes))) return false; // and no decoder sees it
    DecodedFrame frame;
    read_header(OpenFrame(as_bytes(bytes), path).file.header(0), frame);
    return frame.header.scene_hash == scene_hash;
  } catch (const Iex::BaseExc&) {
    return false;
  } catch (const Error&) {
    return false;
  }
}

} // namespace kelpie
