#include "cli/picture_options.h"

#include <algorithm>
#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "base/error.h"
#include "cli/number_check.h"
#include "colour/spaces.h"
#include "renderer/output/sequence.h"

namespace kelpie {

void add_view_options(CLI::App& app, PictureOptions& options) {
  app.add_option(
         "--view", options.view,
         "how light becomes a picture: ACES (soft highlights), sRGB (plain, clips at 1), raw, or a view of your OCIO config [its default]")
      ->option_text("NAME");
  app.add_option("--exposure", options.exposure, "brighter or darker by so many stops: 1 doubles the light, -1 halves it [0]")
      ->check(number_between(-100, 100))
      ->option_text("STOPS");
  app.add_option("--ocio", options.ocio, "OCIO config file [$OCIO, else a built-in ACES config]")->option_text("FILE");
}

void add_channel_option(CLI::App& app, PictureOptions& options) {
  app.add_option("--channel", options.channel,
                 "show this instead of the colours: Z (depth), N (normals), P (positions), albedo, A, cost (evaluations a sample: blue 10, "
                 "green 100, yellow 1000, red "
                 "10,000, white 100,000), or any channel")
      ->option_text("NAME");
}

PictureMaker::PictureMaker(const PictureOptions& options)
    : options_(options), view_((use_ocio_config(options.ocio), DisplayView(options.view))) {}

Picture PictureMaker::make(const std::string& path, int width) const {
  return develop(picture_of(read_exr(path), options_.channel), width);
}

Picture PictureMaker::make(const FrameImage& image) const { return develop(picture_of(image), 0); }

Picture PictureMaker::develop(Picture picture, int width) const {
  if (width > 0 && width != picture.width) picture = resize(picture, width);
  kelpie::develop(picture, view_, options_.exposure);
  return picture;
}

std::vector<int> missing_frames(const std::vector<int>& existing) {
  int step = 0;
  for (size_t i = 1; i < existing.size(); ++i) step = step ? std::min(step, existing[i] - existing[i - 1]) : existing[i] - existing[i - 1];
  std::vector<int> missing;
  for (size_t i = 1; i < existing.size(); ++i)
    for (int f = existing[i - 1] + step; f < existing[i]; f += step) missing.push_back(f);
  return missing;
}

namespace {

[[noreturn]] void fail_missing(const std::vector<std::string>& messages) {
  constexpr size_t k_shown = 10; // the first few say it; a thousand lines hide it
  std::vector<Problem> problems;
  for (const std::string& m : messages)
    if (problems.size() < k_shown) problems.emplace_back().message = m;
  if (messages.size() > k_shown) problems.emplace_back().message = fmt::format("{} more frames are missing", messages.size() - k_shown);
  throw Error(ExitStatus::missing_input, std::move(problems));
}

} // namespace

std::vector<std::string> frame_files(const std::vector<std::string>& inputs, const std::string& ranges) {
  std::vector<std::string> files, missing;
  for (const std::string& input : inputs) {
    const FramePattern pattern(input);
    std::error_code error;
    // A file whose name only looks like a pattern is that file.
    const bool is_file = !pattern.is_numbered() || std::filesystem::exists(input, error);
    if (is_file && !ranges.empty())
      throw Error(ExitStatus::usage, fmt::format("-f chooses frames of a pattern such as name.####.exr; {} is a single file", input));
    if (is_file) {
      files.push_back(input);
      continue;
    }
    const std::vector<int> frames = ranges.empty() ? pattern.existing_frames() : parse_frames(ranges);
    if (frames.empty()) missing.push_back(fmt::format("{}: there are no such files", input));
    for (const int frame : frames) files.push_back(pattern.path(frame));
  }
  for (const std::string& file : files) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) missing.push_back(fmt::format("{}: the frame is missing", file));
  }
  if (!missing.empty()) fail_missing(missing);
  return files;
}

} // namespace kelpie
