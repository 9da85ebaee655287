#include "cli/ffmpeg.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <new>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "base/error.h"
#include "base/leftovers.h"

extern char** environ;

namespace kelpie {

namespace {

std::vector<std::string> arguments(const MovieFormat& f, const std::string& path) {
  // Frames of odd size get a black line: yuv420p has one colour for 2x2 pixels.
  const char* filter = "pad=ceil(iw/2)*2:ceil(ih/2)*2,"
                       "scale=out_color_matrix=bt709:out_range=tv:flags=bicubic+accurate_rnd+full_chroma_int,format=yuv420p";
  // Players convert by these tags; without them they guess by the size of the picture. sRGB frames are tagged with
  // sRGB's curve: players that take a Rec.709 tag literally show them washed out.
  const char* curve = f.is_srgb ? "iec61966-2-1" : "bt709";
  return {"ffmpeg",
          "-hide_banner",
          "-loglevel",
          "error",
          "-nostdin",
          "-y",
          "-f",
          "rawvideo",
          "-pixel_format",
          "rgb24",
          "-video_size",
          fmt::format("{}x{}", f.width, f.height),
          "-framerate",
          frame_rate_text(f.fps),
          "-i",
          "pipe:0",
          "-an",
          "-vf",
          filter,
          "-c:v",
          "libx264",
          "-preset",
          "slow",
          "-crf",
          fmt::format("{}", f.crf),
          "-color_primaries",
          "bt709",
          "-color_trc",
          curve,
          "-colorspace",
          "bt709",
          "-color_range",
          "tv",
          "-fflags",
          "+bitexact",
          "-flags:v",
          "+bitexact", // no date, no version: equal frames make equal files
          "-movflags",
          "+faststart",
          "-f",
          f.container,
          "file:" + path};
}

/// The child gets default signals: we ignore SIGPIPE, and it would inherit that.
class SpawnAttributes {
public:
  SpawnAttributes() {
    posix_spawnattr_init(&attributes_);
    sigset_t defaults;
    sigemptyset(&defaults);
    for (const int s : {SIGPIPE, SIGXFSZ, SIGINT, SIGTERM}) sigaddset(&defaults, s);
    posix_spawnattr_setsigdefault(&attributes_, &defaults);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGDEF);
  }
  ~SpawnAttributes() { posix_spawnattr_destroy(&attributes_); }
  SpawnAttributes(const SpawnAttributes&) = delete;
  SpawnAttributes& operator=(const SpawnAttributes&) = delete;
  const posix_spawnattr_t* get() const { return &attributes_; }

private:
  posix_spawnattr_t attributes_;
};

} // namespace

std::string movie_container(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".mp4") return "mp4";
  if (ending == ".mov") return "mov";
  if (ending == ".mkv") return "matroska";
  throw Error(ExitStatus::usage, fmt::format("{}: a movie's name ends in .mp4, .mov or .mkv", path));
}

std::string frame_rate_text(double fps) {
  if (std::abs(fps - std::round(fps)) < 1e-6) return fmt::format("{:.0f}", fps);
  const double whole = std::round(fps * 1.001);
  if (std::abs(fps * 1.001 - whole) < 1e-3) return fmt::format("{:.0f}/1001", whole * 1000);
  return fmt::format("{:.0f}/1000", fps * 1000);
}

FfmpegPipe::FfmpegPipe(const MovieFormat& format, const std::string& path, std::string shown) : path_(path), shown_(std::move(shown)) {
  int ends[2];
  errors_ = memfd_create("ffmpeg", MFD_CLOEXEC);
  if (errors_ < 0 || pipe2(ends, O_CLOEXEC) != 0)
    throw Error(ExitStatus::try_again, fmt::format("no pipe to ffmpeg: {}", std::strerror(errno)));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  for (const int output : {STDOUT_FILENO, STDERR_FILENO}) posix_spawn_file_actions_adddup2(&actions, errors_, output);
  std::vector<std::string> words = arguments(format, path);
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  const int error = posix_spawnp(&child_, "ffmpeg", &actions, SpawnAttributes().get(), argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  input_ = ends[1];
  if (error == 0) {
    set_helper(child_);
    return;
  }
  close(input_);
  close(errors_);
  if (error == ENOMEM) throw std::bad_alloc();
  if (error == EAGAIN) throw Error(ExitStatus::try_again, fmt::format("ffmpeg cannot be started: {}", std::strerror(error)));
  if (error == ENOENT) throw Error(ExitStatus::missing_input, "movies are made by ffmpeg, which is not installed (or not on the PATH)");
  throw Error(ExitStatus::missing_input, fmt::format("ffmpeg cannot be started: {}", std::strerror(error)));
}

FfmpegPipe::~FfmpegPipe() {
  if (input_ >= 0) close(input_);
  if (child_ >= 0) {
    kill(child_, SIGKILL);
    wait();
  }
  close(errors_);
}

bool FfmpegPipe::wait() {
  int status = 0;
  while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  set_helper(0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void FfmpegPipe::fail() {
  char text[1000];
  const ssize_t n = pread(errors_, text, sizeof text, 0);
  std::string why(text, n > 0 ? static_cast<size_t>(n) : 0);
  if (const size_t line = why.find('\n'); line != std::string::npos) why.resize(line); // what follows the first error follows from it
  if (const size_t at = why.find("file:" + path_); at != std::string::npos) why.replace(at, path_.size() + 5, "the file");
  throw Error(ExitStatus::cannot_write, fmt::format("{}: ffmpeg could not write it: {}", shown_, why.empty() ? "it gave no reason" : why));
}

void FfmpegPipe::write(std::span<const uint8_t> frame) {
  while (!frame.empty()) {
    const ssize_t n = ::write(input_, frame.data(), frame.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      close(input_);
      input_ = -1;
      wait(); // it is ending, and may still be saying why
      fail();
    }
    frame = frame.subspan(static_cast<size_t>(n));
  }
}

void FfmpegPipe::finish() {
  close(input_);
  input_ = -1;
  const bool ended_well = wait();
  if (!ended_well || lseek(errors_, 0, SEEK_END) > 0) fail();
}

} // namespace kelpie
