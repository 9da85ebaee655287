#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/picture_options.h"
#include "cli/progress.h"
#include "cli/scene_sheet.h"
#include "renderer/output/label.h"
#include "renderer/output/sequence.h"

namespace kelpie {

namespace {

constexpr float k_border = 0.055f; // display-referred: dark, but not as dark as black in a picture
constexpr float k_ink = 0.75f;
constexpr size_t k_most_pixels = 1 << 28; // 3 GB of floats

struct SheetOptions {
  std::vector<std::string> inputs;
  std::string frames, output;
  int columns = 0, width = 320;
  ProgressMode progress = ProgressMode::automatic;
  PictureOptions picture;
  VariationOptions vary;
  RenderOptions render;
};

/// A scene, and not pictures.
bool is_scene(const SheetOptions& o) { return o.inputs.size() == 1 && o.inputs[0].ends_with(".json"); }

/// Columns that make the sheet about as wide as a screen, 16:10.
int columns_for(size_t count, double aspect) {
  const auto columns = static_cast<int>(std::lround(std::sqrt(double(count) * 1.6 / aspect)));
  return std::clamp(columns, 1, static_cast<int>(count));
}

/// Cells of one size with the same space between and around them.
struct Grid {
  int columns, rows, cell_width, cell_height, gap, label; ///< the last: the height of the line below each picture; 0: none

  int width() const { return columns * (cell_width + gap) + gap; }
  int height() const { return rows * (cell_height + label + gap) + gap; }
  int top(int index) const { return gap + index / columns * (cell_height + label + gap); }
  int left(int index) const { return gap + index % columns * (cell_width + gap); }
};

/// Puts a picture into the middle of the grid's cell `index`.
void place(Picture& sheet, const Grid& grid, int index, const Picture& picture) {
  const int left = grid.left(index) + (grid.cell_width - picture.width) / 2;
  const int top = grid.top(index) + std::max(0, grid.cell_height - picture.height) / 2;
  paste(sheet, picture, left, top);
}

/// Writes a line below the grid's cell `index`, as large as fits.
void put_label(Picture& sheet, const Grid& grid, int index, const std::string& text) {
  const int size = std::min(grid.label * 2 / 3, int(1.6 * grid.cell_width / std::max<size_t>(1, text.size())));
  write_label(sheet, text, grid.left(index) + grid.cell_width / 2, grid.top(index) + grid.cell_height + grid.label * 3 / 4, size, k_ink);
}

/// The tiles of a scene's variations, in a folder beside the sheet.
TileSheet render(const SheetOptions& o) {
  if (!has_variations(o.vary))
    throw Error(ExitStatus::usage, "of a scene a sheet shows variations: --recipe NAME, --all-recipes, --random N, --across or --down");
  if (!o.frames.empty() && parse_frames(o.frames).size() > 1)
    throw Error(ExitStatus::usage, "of a scene --frames is one frame; --across 'frame=1|24|48' shows several");
  RenderOptions options = o.render;
  options.ocio = o.picture.ocio;
  options.progress = o.progress;
  if (!o.frames.empty()) options.frames = o.frames;
  const std::string folder = std::filesystem::path(o.output).replace_extension("").string() + "_tiles";
  return render_tiles(o.inputs[0], o.vary, o.width, folder, options);
}

void make_sheet(const SheetOptions& o) {
  set_activity("making the sheet");
  require_writable(o.output);
  const PictureMaker maker(o.picture);
  if (!is_scene(o) && (has_variations(o.vary) || is_changed(o.render)))
    throw Error(ExitStatus::usage, "pictures cannot be varied: what is said of a scene needs one (SCENE.json), and nothing beside it");
  const TileSheet tiles = is_scene(o) ? render(o) : TileSheet{{}, frame_files(o.inputs, o.frames), 0};
  const std::vector<std::string>& files = tiles.files;
  const Picture first = maker.make(files.front(), o.width);
  const int count = static_cast<int>(files.size());
  const int columns = o.columns > 0       ? std::min(o.columns, count)
                      : tiles.columns > 0 ? tiles.columns
                                          : columns_for(files.size(), double(first.width) / first.height);
  const int label = tiles.tiles.empty() || !has_font() ? 0 : std::max(12, o.width / 12);
  const Grid grid{columns, (count + columns - 1) / columns, first.width, first.height, std::max(4, o.width / 40), label};
  Picture sheet{grid.width(), grid.height(), {}, false};
  if (sheet.pixel_count() > k_most_pixels)
    throw Error(ExitStatus::usage, fmt::format("a sheet of {}×{} pixels is too large; use fewer frames (-f 1-100x5) or a smaller --width",
                                               sheet.width, sheet.height));
  sheet.rgb.assign(sheet.pixel_count() * 3, k_border);

  Progress progress(o.progress, count, "frames");
  for (int i = 0; i < count; ++i) {
    place(sheet, grid, i, i == 0 ? first : maker.make(files[size_t(i)], o.width));
    if (label > 0) put_label(sheet, grid, i, tiles.tiles[size_t(i)].label);
    progress.advance(i + 1);
  }
  write_file_atomically(o.output, encode_png(sheet, 8, maker.is_srgb()));
}

} // namespace

void add_sheet(CLI::App& app) {
  auto options = std::make_shared<SheetOptions>();
  CLI::App* command = app.add_subcommand("sheet", "put many frames, or a scene's variations, on one page: a contact sheet (PNG)");
  command->footer(
      R"(Puts many frames on one page (PNG): a contact sheet. Of a scene it renders its variations first: recipes, or tables of one or two
values. Their EXRs are kept in SHEET_tiles, and what is there and of this very scene is not rendered again.

Examples:
  kelpie sheet 'out/drop.####.exr' -o drop.png                 all frames there are
  kelpie sheet 'out/drop.####.exr' -f 1-96x8 -o drop.png       every eighth
  kelpie sheet a.exr b.exr c.exr -o compare.png --columns 3    any frames
  kelpie sheet chairs/breed.json --all-recipes -o family.png   a scene's recipes
  kelpie sheet chairs/breed.json --random 200 --seed 7 -o random.png         children that nobody has thought of
  kelpie sheet shot.json --across 'frame=1|24|48' --down 'shapes.drop.threshold=0.5|1' -o table.png

Quote a pattern, so that the shell leaves its # alone.)");
  command->add_option("inputs", options->inputs, "a pattern for numbered frames, files, or a scene (JSON)")
      ->required()
      ->option_text("FRAMES|SCENE...");
  command->add_option("-f,--frames", options->frames, "frames of the pattern: 12, 1-96, 1-96x8 [all there are]")->option_text("RANGES");
  command->add_option("-o,--output", options->output, "the picture to write")->required()->check(ends_in(".png"))->option_text("SHEET.png");
  command->add_option("--columns", options->columns, "frames side by side [so that the sheet fits a screen]")
      ->check(CLI::Range(1, 10000))
      ->option_text("N");
  command->add_option("--width", options->width, "width of each frame on the sheet, pixels [320]")
      ->check(CLI::Range(16, 16384))
      ->option_text("PIXELS");
  add_variation_options(*command, options->vary, options->render);
  add_view_options(*command, options->picture);
  add_channel_option(*command, options->picture);
  add_progress_option(*command, options->progress);
  command->callback([options] { make_sheet(*options); });
}

} // namespace kelpie
