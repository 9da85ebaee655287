#include <fmt/format.h>

#include "base/atomic_file.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/picture_options.h"

namespace kelpie {

namespace {

struct ViewOptions {
  std::string input, output;
  int bits = 8, width = 0;
  PictureOptions picture;
};

void view(const ViewOptions& o) {
  set_activity(fmt::format("developing {}", o.input));
  require_writable(o.output);
  const PictureMaker maker(o.picture);
  write_file_atomically(o.output, encode_png(maker.make(o.input, o.width), o.bits, maker.is_srgb()));
}

} // namespace

void add_view(CLI::App& app) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App* command = app.add_subcommand("view", "show a frame as a picture (PNG)");
  command->footer(R"(Turns a frame (EXR) into a picture to look at (PNG), through OpenColorIO.

Examples:
  kelpie view out/drop.0001.exr -o drop.png
  kelpie view out/drop.0001.exr -o depth.png --channel Z

Colours are shown as they are over black; parts of the frame outside its data window (--crop) are black.)");
  command->add_option("input", options->input, "the frame")->required()->option_text("IN.exr");
  command->add_option("-o,--output", options->output, "the picture to write")->required()->check(ends_in(".png"))->option_text("OUT.png");
  command->add_option("--width", options->width, "resize to so many pixels [as it is]")->check(CLI::Range(1, 65536))->option_text("PIXELS");
  command->add_option("--bits", options->bits, "bits a channel: 8 or 16 [8]")->check(CLI::IsMember({8, 16}))->option_text("N");
  add_view_options(*command, options->picture);
  add_channel_option(*command, options->picture);
  command->callback([options] { view(*options); });
}

} // namespace kelpie
