#include <algorithm>
#include <future>

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/ffmpeg.h"
#include "cli/number_check.h"
#include "cli/picture_options.h"
#include "cli/progress.h"
#include "renderer/output/sequence.h"

namespace kelpie {

namespace {

struct MovieOptions {
  std::vector<std::string> inputs;
  std::string frames, output;
  double fps = 0;
  int crf = 16, width = 0;
  ProgressMode progress = ProgressMode::automatic;
  PictureOptions picture;
};

/// Without -f a movie has every frame there is; a gap among them is a frame that failed, not a cut.
void refuse_gaps(const MovieOptions& o) {
  if (!o.frames.empty()) return;
  for (const std::string& input : o.inputs) {
    const FramePattern pattern(input);
    const std::vector<int> missing = missing_frames(pattern.existing_frames());
    if (!missing.empty())
      throw Error(ExitStatus::missing_input,
                  fmt::format("{}: there is no frame {}; render what is missing, or choose frames with -f", input, format_frames(missing)));
  }
}

struct MovieFrame {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;
};

MovieFrame make_frame(const PictureMaker& maker, const std::string& file, int width) {
  const Picture picture = maker.make(file, width);
  return {picture.width, picture.height, to_8_bit(picture)};
}

void make_movie(const MovieOptions& o) {
  set_activity("making the movie");
  const std::string container = movie_container(o.output);
  const PictureMaker maker(o.picture);
  refuse_gaps(o);
  const std::vector<std::string> files = frame_files(o.inputs, o.frames);
  const DecodedFrame first = read_exr(files.front());
  MovieFrame frame = make_frame(maker, files.front(), o.width);
  const MovieFormat format{frame.width, frame.height, o.fps > 0 ? o.fps : first.header.fps, o.crf, maker.is_srgb(), container};

  PartFile part(o.output);
  if (part.is_direct()) throw Error(ExitStatus::cannot_write, fmt::format("{}: a movie cannot be written to a pipe or a device", o.output));
  FfmpegPipe ffmpeg(format, part.part_path(), o.output);
  Progress progress(o.progress, double(files.size()), "frames");
  for (size_t i = 0; i < files.size(); ++i) {
    if (frame.width != format.width || frame.height != format.height)
      throw Error(ExitStatus::bad_data, fmt::format("{}: {}×{} pixels, but {} has {}×{}; --width makes them alike", files[i], frame.width,
                                                    frame.height, files.front(), format.width, format.height));
    std::future<MovieFrame> next; // developed while ffmpeg takes this one
    if (i + 1 < files.size()) next = std::async(std::launch::async, make_frame, std::cref(maker), std::cref(files[i + 1]), o.width);
    ffmpeg.write(frame.rgb);
    progress.advance(double(i + 1));
    if (next.valid()) frame = next.get();
  }
  ffmpeg.finish();
  if (part.size() == 0) throw Error(ExitStatus::cannot_write, fmt::format("{}: ffmpeg ended well, but wrote nothing", o.output));
  part.commit();
}

} // namespace

void add_movie(CLI::App& app) {
  auto options = std::make_shared<MovieOptions>();
  CLI::App* command = app.add_subcommand("movie", "make a movie of frames (H.264)");
  command->footer(R"(Makes a movie of frames: developed through OpenColorIO, encoded as H.264 by ffmpeg.

Examples:
  kelpie movie 'out/drop.####.exr' -o drop.mp4
  kelpie movie 'out/drop.####.exr' -f 1-48,47-2 -o swing.mp4 --fps 24

Quote a pattern, so that the shell leaves its # alone. A frame that is missing is an error (exit status 66).)");
  command->add_option("inputs", options->inputs, "a pattern for numbered frames, or files")->required()->option_text("FRAMES...");
  command->add_option("-f,--frames", options->frames, "frames of the pattern: 12, 1-96, 1-96x2 [all there are]")->option_text("RANGES");
  command->add_option("-o,--output", options->output, "the movie to write: .mp4, .mov or .mkv")->required()->option_text("OUT.mp4");
  command->add_option("--fps", options->fps, "frames a second [as the first frame's header says]")
      ->check(number_between(0.1, 1000))
      ->option_text("N");
  command->add_option("--crf", options->crf, "quality: 0 is lossless, 16 looks it, 23 is small [16]")
      ->check(CLI::Range(0, 51))
      ->option_text("N");
  command->add_option("--width", options->width, "resize to so many pixels [as they are]")
      ->check(CLI::Range(2, 16384))
      ->option_text("PIXELS");
  add_view_options(*command, options->picture);
  add_channel_option(*command, options->picture);
  add_progress_option(*command, options->progress);
  command->callback([options] { make_movie(*options); });
}

} // namespace kelpie
