// What view, sheet and movie share: which frames, and how they are developed.
#pragma once

#include <string>
#include <vector>

#include "renderer/output/picture.h"

namespace CLI {
class App;
}

namespace kelpie {

struct PictureOptions {
  std::string view, channel, ocio;
  float exposure = 0;
};

/// Adds --view, --exposure and --ocio.
void add_view_options(CLI::App&, PictureOptions&);

/// Adds --channel, for commands that show files.
void add_channel_option(CLI::App&, PictureOptions&);

/// Develops frames alike. Constructing it settles the OCIO config and the view, so that a wrong one is
/// reported before any work is done.
class PictureMaker {
public:
  explicit PictureMaker(const PictureOptions&);

  /// The frame in this file, display-referred; resized to `width` unless that is 0.
  Picture make(const std::string& path, int width = 0) const;
  /// A frame that was just rendered, display-referred.
  Picture make(const FrameImage&) const;
  bool is_srgb() const { return view_.is_srgb(); }

private:
  Picture develop(Picture, int width) const;

  PictureOptions options_;
  DisplayView view_;
};

/// The files that `inputs` name: a pattern with the frames of `ranges` (all there are when empty), or files
/// as they are. Throws Error: usage for a range without a pattern; missing_input, saying which, for
/// files that do not exist.
std::vector<std::string> frame_files(const std::vector<std::string>& inputs, const std::string& ranges);

/// The frames that seem to be missing from a pattern's files: gaps between evenly spaced numbers.
std::vector<int> missing_frames(const std::vector<int>& existing);

} // namespace kelpie
