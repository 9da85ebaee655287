// Pictures piped into ffmpeg, which makes them a movie.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <sys/types.h>

namespace kelpie {

struct MovieFormat {
  int width = 0, height = 0;
  double fps = 24;
  int crf = 16;          ///< quality of H.264: 0 is lossless, 51 the worst
  bool is_srgb = true;   ///< the frames' encoding: sRGB's, else Rec.709's
  std::string container; ///< ffmpeg's name of the file format
};

/// A running ffmpeg that writes H.264 (yuv420p, Rec.709, limited range) to a file. Started directly, without a
/// shell, so a file name is only ever a file name. Whatever it says is an error and goes into ours: on a
/// full disk it says so, and ends with status 0 all the same.
class FfmpegPipe {
public:
  /// Writes to `path`; `shown` is what messages call it. Throws Error missing_input when there is no ffmpeg.
  FfmpegPipe(const MovieFormat&, const std::string& path, std::string shown);
  /// Kills an ffmpeg that was not finished.
  ~FfmpegPipe();
  FfmpegPipe(const FfmpegPipe&) = delete;
  FfmpegPipe& operator=(const FfmpegPipe&) = delete;

  /// A frame: 8 bits of red, green and blue a pixel. Throws Error cannot_write when ffmpeg has given up.
  void write(std::span<const uint8_t> frame);
  /// Ends the movie and waits for it to be written.
  void finish();

private:
  [[noreturn]] void fail();
  /// Waits for ffmpeg to end; whether it ended well.
  bool wait();

  std::string path_, shown_;
  pid_t child_ = -1;
  int input_ = -1;  // ffmpeg's stdin
  int errors_ = -1; // its stderr: a file in memory
};

/// ffmpeg's name of the format for a file name's ending (.mp4, .mov, .mkv). Throws Error usage for others.
std::string movie_container(const std::string& path);

/// `24`, `23.976` as the exact 24000/1001: how ffmpeg wants a rate.
std::string frame_rate_text(double fps);

} // namespace kelpie
