#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/picture_options.h"
#include "cli/progress.h"

namespace kelpie {

namespace {

constexpr float k_border = 0.055f;        // display-referred: dark, but not as dark as black in a picture
constexpr size_t k_most_pixels = 1 << 28; // 3 GB of floats

struct SheetOptions {
  std::vector<std::string> inputs;
  std::string frames, output;
  int columns = 0, width = 320;
  ProgressMode progress = ProgressMode::automatic;
  PictureOptions picture;
};

/// Columns that make the sheet about as wide as a screen, 16:10.
int columns_for(size_t count, double aspect) {
  const auto columns = static_cast<int>(std::lround(std::sqrt(double(count) * 1.6 / aspect)));
  return std::clamp(columns, 1, static_cast<int>(count));
}

/// Cells of one size with the same space between and around them.
struct Grid {
  int columns, rows, cell_width, cell_height, gap;

  int width() const { return columns * (cell_width + gap) + gap; }
  int height() const { return rows * (cell_height + gap) + gap; }
};

/// Puts a picture into the middle of the grid's cell `index`.
void place(Picture& sheet, const Grid& grid, int index, const Picture& picture) {
  const int left = grid.gap + index % grid.columns * (grid.cell_width + grid.gap) + (grid.cell_width - picture.width) / 2;
  const int top = grid.gap + index / grid.columns * (grid.cell_height + grid.gap) + std::max(0, grid.cell_height - picture.height) / 2;
  paste(sheet, picture, left, top);
}

void make_sheet(const SheetOptions& o) {
  set_activity("making the sheet");
  require_writable(o.output);
  const PictureMaker maker(o.picture);
  const std::vector<std::string> files = frame_files(o.inputs, o.frames);
  const Picture first = maker.make(files.front(), o.width);
  const int count = static_cast<int>(files.size());
  const int columns = o.columns > 0 ? std::min(o.columns, count) : columns_for(files.size(), double(first.width) / first.height);
  const Grid grid{columns, (count + columns - 1) / columns, first.width, first.height, std::max(4, o.width / 40)};
  Picture sheet{grid.width(), grid.height(), {}, false};
  if (sheet.pixel_count() > k_most_pixels)
    throw Error(ExitStatus::usage, fmt::format("a sheet of {}×{} pixels is too large; use fewer frames (-f 1-100x5) or a smaller --width",
                                               sheet.width, sheet.height));
  sheet.rgb.assign(sheet.pixel_count() * 3, k_border);

  Progress progress(o.progress, count, "frames");
  for (int i = 0; i < count; ++i) {
    place(sheet, grid, i, i == 0 ? first : maker.make(files[size_t(i)], o.width));
    progress.advance(i + 1);
  }
  write_file_atomically(o.output, encode_png(sheet, 8, maker.is_srgb()));
}

} // namespace

void add_sheet(CLI::App& app) {
  auto options = std::make_shared<SheetOptions>();
  CLI::App* command = app.add_subcommand("sheet", "put many frames on one page: a contact sheet (PNG)");
  command->footer(R"(Puts many frames on one page (PNG): a contact sheet.

Examples:
  kelpie sheet 'out/drop.####.exr' -o drop.png                 all frames there are
  kelpie sheet 'out/drop.####.exr' -f 1-96x8 -o drop.png       every eighth
  kelpie sheet a.exr b.exr c.exr -o compare.png --columns 3    any frames

Quote a pattern, so that the shell leaves its # alone.)");
  command->add_option("inputs", options->inputs, "a pattern for numbered frames, or files")->required()->option_text("FRAMES...");
  command->add_option("-f,--frames", options->frames, "frames of the pattern: 12, 1-96, 1-96x8 [all there are]")->option_text("RANGES");
  command->add_option("-o,--output", options->output, "the picture to write")->required()->check(ends_in(".png"))->option_text("SHEET.png");
  command->add_option("--columns", options->columns, "frames side by side [so that the sheet fits a screen]")
      ->check(CLI::Range(1, 10000))
      ->option_text("N");
  command->add_option("--width", options->width, "width of each frame on the sheet, pixels [320]")
      ->check(CLI::Range(16, 16384))
      ->option_text("PIXELS");
  add_picture_options(*command, options->picture);
  add_progress_option(*command, options->progress);
  command->callback([options] { make_sheet(*options); });
}

} // namespace kelpie
