// The module kelpie_images.so. It links none of kelpie's other folders: what it knows of the program is the interface.
#include "renderer/images/image_library.h"

#include <memory>
#include <string_view>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

namespace kelpie {

namespace {

OIIO::ImageBuf buffer_on(const PixelRows& pixels) {
  return OIIO::ImageBuf(OIIO::ImageSpec(pixels.width, pixels.height, 3, OIIO::TypeDesc::FLOAT), pixels.rgb);
}

class OpenImageIo : public ImageLibrary {
public:
  Failure resize(const PixelRows& from, const PixelRows& to) const override {
    const OIIO::ImageBuf source = buffer_on(from);
    OIIO::ImageBuf target = buffer_on(to);
    if (OIIO::ImageBufAlgo::resize(target, source, "blackman-harris")) return {};
    return target.geterror();
  }

  Failure encode_png(int width, int height, int bits, const void* values, bool is_srgb, std::vector<unsigned char>& file) const override {
    const OIIO::TypeDesc type = bits == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
    OIIO::ImageSpec spec(width, height, 3, type);
    if (is_srgb) spec.attribute("oiio:ColorSpace", "sRGB");
    OIIO::Filesystem::IOVecOutput stream(file);
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png");
    if (!output) return OIIO::geterror();
    if (output->set_ioproxy(&stream) && output->open("memory.png", spec) && output->write_image(type, values) && output->close()) return {};
    return output->geterror();
  }

  void write_text(const PixelRows& pixels, const std::string& text, const std::string& font, int x, int y, int size,
                  float grey) const override {
    OIIO::ImageBuf target = buffer_on(pixels);
    OIIO::ImageBufAlgo::render_text(target, x, y, text, size, font, {grey, grey, grey}, OIIO::ImageBufAlgo::TextAlignX::Center);
  }

  Failure read_radiance(std::span<const unsigned char> file, const MakeRoom& make_room) const override {
    // The decoder is chosen here: OIIO by itself would try all of its formats on a file.
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create("hdr");
    if (!input) return OIIO::geterror();
    OIIO::Filesystem::IOMemReader reader(file.data(), file.size());
    OIIO::ImageSpec spec, config;
    if (!input->set_ioproxy(&reader) || !input->open("memory.hdr", spec, config)) return input->geterror();
    if (input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, make_room(spec.width, spec.height, spec.nchannels))) return {};
    return input->geterror();
  }
};

} // namespace

} // namespace kelpie

const kelpie::ImageLibrary* kelpie_image_library(const char* version) {
  static const kelpie::OpenImageIo library;
  return std::string_view(version) == KELPIE_VERSION ? &library : nullptr;
}
