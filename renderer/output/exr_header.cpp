#include "renderer/output/exr_header.h"

#include <cmath>
#include <cstring>

#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "colour/spaces.h"
#include "renderer/output/file_hash.h"

namespace kelpie {

namespace {

constexpr const char* k_frame = "kelpie:frame";
constexpr const char* k_scene_hash = "kelpie:sceneHash";
constexpr const char* k_pixel_hash = "kelpie:pixelHash";

Imath::M44f matrix_of(const glm::mat4& m) {
  Imath::M44f out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = m[i][j];
  return out;
}

/// The value of an attribute of this type, or null.
template <class T>
const T* value_of(const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::TypedAttribute<T>>(name);
  return attribute ? &attribute->value() : nullptr;
}

} // namespace

void write_header(Imf::Header& to, const FrameHeader& header, const std::string& pixel_hash) {
  Imf::addCapDate(to, "1970:01:01 00:00:00");
  to.insert("Software", Imf::StringAttribute("kelpie " KELPIE_VERSION));
  const int thousandths = static_cast<int>(std::lround(header.fps * 1000));
  const bool is_whole = thousandths % 1000 == 0;
  Imf::addFramesPerSecond(to, is_whole ? Imf::Rational(thousandths / 1000, 1) : Imf::Rational(thousandths, 1000));
  to.insert(k_frame, Imf::IntAttribute(header.frame));
  to.insert(k_scene_hash, Imf::StringAttribute(header.scene_hash));
  to.insert(k_pixel_hash, Imf::StringAttribute(pixel_hash));
  to.insert(k_file_hash_attribute, Imf::StringAttribute(unsealed_file_hash()));
  if (header.camera_from_world) Imf::addWorldToCamera(to, matrix_of(*header.camera_from_world));
  if (header.ndc_from_world) Imf::addWorldToNDC(to, matrix_of(*header.ndc_from_world));
  if (const auto c = scene_linear_chromaticities()) {
    const auto& xy = *c;
    Imf::addChromaticities(to, Imf::Chromaticities({xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}));
  }
}

void read_header(const Imf::Header& from, DecodedFrame& frame) {
  if (const auto* number = value_of<int>(from, k_frame)) frame.header.frame = *number;
  if (const auto* hash = value_of<std::string>(from, k_scene_hash)) frame.header.scene_hash = *hash;
  if (const auto* hash = value_of<std::string>(from, k_pixel_hash)) frame.claimed_hash = *hash;
  if (const auto* rate = value_of<Imf::Rational>(from, "framesPerSecond"); rate && rate->n > 0 && rate->d > 0)
    frame.header.fps = double(rate->n) / rate->d;
  const auto matrix = [&](const char* name, std::optional<glm::mat4>& m) {
    if (const auto* value = value_of<Imath::M44f>(from, name)) std::memcpy(&m.emplace()[0][0], value, sizeof(glm::mat4));
  };
  matrix("worldToCamera", frame.header.camera_from_world);
  matrix("worldToNDC", frame.header.ndc_from_world);
  if (const auto* c = value_of<Imf::Chromaticities>(from, "chromaticities"))
    frame.chromaticities = {c->red.x, c->red.y, c->green.x, c->green.y, c->blue.x, c->blue.y, c->white.x, c->white.y};
}

} // namespace kelpie
