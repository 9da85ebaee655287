#include "renderer/output/exr.h"

#include <cmath>
#include <new>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "colour/spaces.h"
#include "renderer/output/exr_attributes.h"
#include "renderer/output/file_hash.h"
#include "renderer/output/packed_pixels.h"

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

private:
  std::vector<unsigned char>& bytes_;
  size_t place_ = 0;
};

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
  EncodedFrame encoded;
  ReplacedValues replaced;
  PackedPixels packed = pack(image, replaced);
  encoded.clamped = replaced.clamped, encoded.nonfinite = replaced.nonfinite;
  encoded.pixel_hash = hash_of(packed, image);
  MemoryWriter writer(encoded.bytes);
  {
    Imf::OutputFile file(writer, header_for(image, header, encoded.pixel_hash), 0);
    file.setFrameBuffer(frame_buffer_on(packed, image, file.header().dataWindow()));
    file.writePixels(image.data_window.height());
  }
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
