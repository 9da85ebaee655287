// Frame ranges and the names of numbered files.
#pragma once

#include <string>
#include <vector>

namespace kelpie {

/// `12`, `1-100`, `1..100`, every second one by `1-100x2` or `1-100:2`, counting down by `100-1`, and lists
/// of these: `1-96x2,100`. In the order written, each frame once. Throws Error usage, saying what is wrong.
std::vector<int> parse_frames(const std::string& ranges);

/// `1-3,7,10-20x5`: the shortest form that parse_frames() reads back as the same ascending frames.
std::string format_frames(const std::vector<int>& ascending);

/// A file name with a place for the frame number: `a.####.exr` (as many digits as #), `a.$F4.exr`, or `a.%04d.exr`, which is printf's:
/// a minus sign is one of its four characters, and %-4d is filled with blanks behind the number. In the name of the file only, folders
/// are as they are. Numbers of more digits get them all.
class FramePattern {
public:
  /// Throws Error usage for two places, or a % that is no number.
  explicit FramePattern(const std::string& text);

  bool is_numbered() const { return is_numbered_; }
  /// The file of `frame`; the same for all when not numbered.
  std::string path(int frame) const;
  /// The frames for which a file exists, ascending; none when not numbered.
  std::vector<int> existing_frames() const;
  const std::string& text() const { return text_; }

private:
  std::string text_, before_, after_; // before_ and after_ include no part of the number
  int digits_ = 0;
  bool is_numbered_ = false, sign_counts_ = false, is_filled_behind_ = false;
};

/// Throws Error usage when several frames would be written to one name.
void require_numbered(const FramePattern&, const std::vector<int>& frames);

} // namespace kelpie
