#include "renderer/output/exr.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>

#include <Imath/half.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file_bytes.h"
#include "colour/spaces.h"
#include "renderer/output/file_hash.h"
#include "renderer/output/pixel_hash.h"

namespace kelpie {

namespace {

constexpr int k_max_side = 65536, k_max_channels = 1024;
constexpr float k_largest_half = 65504;
constexpr const char* k_scene_hash = "kelpie:sceneHash";
constexpr const char* k_pixel_hash = "kelpie:pixelHash";
constexpr const char* k_meta = "kelpie:meta";

OIIO::TypeDesc type_of(ChannelDepth depth) { return depth == ChannelDepth::half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT; }
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

OIIO::ImageSpec spec_of(const FrameImage& image) {
  const PixelBox& w = image.data_window;
  OIIO::ImageSpec spec(w.width(), w.height(), static_cast<int>(image.channels.size()), OIIO::TypeDesc::HALF);
  spec.x = w.x0, spec.y = w.y0;
  spec.full_width = image.resolution.x, spec.full_height = image.resolution.y;
  spec.channelnames.clear();
  for (const FrameChannel& c : image.channels) {
    spec.channelnames.push_back(c.name);
    spec.channelformats.push_back(type_of(c.depth));
  }
  return spec;
}

void set_header(OIIO::ImageSpec& spec, const FrameHeader& header, const std::string& pixel_hash) {
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "1970:01:01 00:00:00"); // else OIIO stamps the time of day, and no two files are equal
  spec.attribute("Software", "kelpie " KELPIE_VERSION);
  const int thousandths = static_cast<int>(std::lround(header.fps * 1000));
  const bool is_whole = thousandths % 1000 == 0;
  const int rate[2] = {is_whole ? thousandths / 1000 : thousandths, is_whole ? 1 : 1000};
  spec.attribute("framesPerSecond", OIIO::TypeRational, rate);
  spec.attribute("kelpie:frame", header.frame);
  spec.attribute(k_scene_hash, header.scene_hash);
  if (!header.meta.empty()) spec.attribute(k_meta, header.meta);
  spec.attribute(k_pixel_hash, pixel_hash);
  spec.attribute(k_file_hash_attribute, unsealed_file_hash());
  if (header.camera_from_world) spec.attribute("worldToCamera", OIIO::TypeMatrix, &(*header.camera_from_world)[0][0]);
  if (header.ndc_from_world) spec.attribute("worldToNDC", OIIO::TypeMatrix, &(*header.ndc_from_world)[0][0]);
  if (const auto c = scene_linear_chromaticities()) spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), c->data());
}

/// Encoding to memory fails for lack of it, and then there may be none for a reason.
[[noreturn]] void encoder_failed(const std::string& why) {
  if (why.empty()) throw std::bad_alloc();
  throw Error(ExitStatus::internal, "the EXR encoder failed: " + why);
}

/// EXR also knows uint; a file that has one is read as float throughout.
bool is_half_and_float(const OIIO::ImageSpec& spec) {
  for (int c = 0; c < spec.nchannels; ++c)
    if (spec.channelformat(c) != OIIO::TypeDesc::HALF && spec.channelformat(c) != OIIO::TypeDesc::FLOAT) return false;
  return true;
}

/// From OIIO's spec to a frame without pixels.
FrameImage describe(const OIIO::ImageSpec& spec) {
  const int x0 = spec.x - spec.full_x, y0 = spec.y - spec.full_y;
  FrameImage image({spec.full_width, spec.full_height}, PixelBox{x0, y0, x0 + spec.width, y0 + spec.height});
  const bool may_be_half = is_half_and_float(spec);
  for (int c = 0; c < spec.nchannels; ++c) {
    const bool is_half = may_be_half && spec.channelformat(c) == OIIO::TypeDesc::HALF;
    image.channels.push_back({spec.channelnames[c], is_half ? ChannelDepth::half : ChannelDepth::full, {}});
  }
  return image;
}

FrameHeader header_of(const OIIO::ImageSpec& spec) {
  FrameHeader header;
  header.frame = spec.get_int_attribute("kelpie:frame", 1);
  header.scene_hash = spec.get_string_attribute(k_scene_hash);
  header.meta = spec.get_string_attribute(k_meta);
  for (const char* name : {"FramesPerSecond", "framesPerSecond"})
    if (const auto* p = spec.find_attribute(name, OIIO::TypeRational)) {
      const int* rate = static_cast<const int*>(p->data());
      if (rate[0] > 0 && rate[1] > 0) header.fps = double(rate[0]) / rate[1];
    }
  const auto matrix = [&](const char* name, std::optional<glm::mat4>& m) {
    if (const auto* p = spec.find_attribute(name, OIIO::TypeMatrix)) std::memcpy(&m.emplace()[0][0], p->data(), sizeof(glm::mat4));
  };
  matrix("worldtocamera", header.camera_from_world);
  matrix("worldtoNDC", header.ndc_from_world);
  return header;
}

/// Opens EXR bytes; `reader` must outlive the result. Null with `why` when they are none, or exceed the limits.
std::unique_ptr<OIIO::ImageInput> open_exr(OIIO::Filesystem::IOMemReader& reader, std::string& why) {
  std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create("exr");
  OIIO::ImageSpec spec, config;
  if (!input->set_ioproxy(&reader) || !input->open("memory.exr", spec, config)) {
    why = input->geterror();
    return nullptr;
  }
  if (spec.width > k_max_side || spec.height > k_max_side || spec.nchannels > k_max_channels || spec.deep) {
    why = spec.deep ? "deep pictures are not supported"
                    : fmt::format("{}×{} pixels with {} channels are too many", spec.width, spec.height, spec.nchannels);
    return nullptr;
  }
  return input;
}

bool read_packed(OIIO::ImageInput& input, const FrameImage& image, PackedPixels& packed) {
  packed = layout(image.channels, image.data_window.area());
  const OIIO::TypeDesc as = is_half_and_float(input.spec()) ? OIIO::TypeDesc::UNKNOWN : OIIO::TypeDesc::FLOAT; // UNKNOWN: as they are
  return input.read_image(0, 0, 0, input.spec().nchannels, as, packed.bytes.data());
}

/// Without pixels only the hash and the header are of use.
DecodedFrame decode(std::span<const unsigned char> bytes, const std::string& name, bool with_pixels) {
  const auto fail = [&](const std::string& why) {
    throw Error(ExitStatus::bad_data, fmt::format("{}: not a picture that can be read: {}", name, why));
  };
  OIIO::Filesystem::IOMemReader reader(bytes.data(), bytes.size());
  std::string why;
  constexpr std::array<unsigned char, 4> k_magic{0x76, 0x2f, 0x31, 0x01}; // without it OIIO names a file that nobody knows
  if (bytes.size() < k_magic.size() || !std::equal(k_magic.begin(), k_magic.end(), bytes.begin())) fail("it is not an OpenEXR file");
  const std::unique_ptr<OIIO::ImageInput> input = open_exr(reader, why);
  if (!input) fail(why);
  DecodedFrame frame;
  frame.image = describe(input->spec());
  frame.header = header_of(input->spec());
  frame.claimed_hash = input->spec().get_string_attribute(k_pixel_hash);
  if (const auto* p = input->spec().find_attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8)))
    std::memcpy(frame.chromaticities.emplace().data(), p->data(), 8 * sizeof(float));
  // A small file may claim a picture of any size; ZIP makes at most a thousandth of it.
  PackedPixels packed;
  if (frame.image.data_window.area() * frame.image.channels.size() / 4096 > bytes.size()) fail("truncated");
  if (!read_packed(*input, frame.image, packed)) fail(input->geterror());
  if (with_pixels) unpack(packed, frame.image);
  frame.pixel_hash = hash_of(packed, frame.image);
  return frame;
}

} // namespace

EncodedFrame encode_exr(const FrameImage& image, const FrameHeader& header) {
  EncodedFrame encoded;
  const PackedPixels packed = pack(image, encoded);
  encoded.pixel_hash = hash_of(packed, image);
  OIIO::ImageSpec spec = spec_of(image);
  set_header(spec, header, encoded.pixel_hash);
  OIIO::Filesystem::IOVecOutput stream(encoded.bytes);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("exr");
  if (!output || !output->set_ioproxy(&stream) || !output->open("memory.exr", spec))
    encoder_failed(output ? output->geterror() : OIIO::geterror());
  if (!output->write_image(OIIO::TypeDesc::UNKNOWN, packed.bytes.data()) || !output->close()) encoder_failed(output->geterror());
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
    OIIO::Filesystem::IOMemReader reader(bytes.data(), bytes.size());
    std::string why;
    const std::unique_ptr<OIIO::ImageInput> input = open_exr(reader, why);
    return input && input->spec().get_string_attribute(k_scene_hash) == scene_hash;
  } catch (const Error&) {
    return false;
  }
}

} // namespace kelpie
