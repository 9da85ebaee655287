// The commands sheet, view and movie as a user runs them.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <sys/wait.h>

#include <gtest/gtest.h>

#include "renderer/output/exr.h"

namespace kelpie {
namespace {

namespace fs = std::filesystem;

class PictureCommands : public testing::Test {
protected:
  PictureCommands() {
    std::string name = testing::TempDir() + "kelpie_movie_XXXXXX";
    folder_ = mkdtemp(name.data());
    for (int frame = 1; frame <= 5; ++frame) {
      FrameImage image({65, 33});
      for (const char* channel : {"R", "G", "B", "A"}) image.add(channel).pixels.assign(65 * 33, 0.15f * float(frame));
      FrameHeader header;
      header.frame = frame, header.fps = 24000 / 1001.0;
      write_exr((folder_ / ("a.000" + std::to_string(frame) + ".exr")).string(), image, header);
    }
  }
  ~PictureCommands() override { fs::remove_all(folder_); }

  struct Outcome {
    int status;
    std::string text; // stdout and stderr
  };

  /// By a shell, in the folder of the frames.
  Outcome run(const std::string& command) const {
    Outcome outcome{-1, {}};
    const std::string line = "cd '" + folder_.string() + "' && unset OCIO && { " + command + "; } 2>&1";
    std::FILE* pipe = popen(line.c_str(), "r");
    if (!pipe) return outcome;
    std::array<char, 4096> buffer;
    while (const size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) outcome.text.append(buffer.data(), n);
    const int status = pclose(pipe);
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
  }
  Outcome kelpie(const std::string& arguments) const { return run(std::string(KELPIE_PROGRAM) + " " + arguments); }

  size_t file_count() const { return size_t(std::distance(fs::directory_iterator(folder_), fs::directory_iterator())); }
  static bool has_ffmpeg() { return std::system("ffmpeg -version > /dev/null 2>&1 && ffprobe -version > /dev/null 2>&1") == 0; }

  fs::path folder_;
};

TEST_F(PictureCommands, ViewWritesAPicture) {
  EXPECT_EQ(kelpie("view a.0001.exr -o v.png --exposure 1").status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "v.png"));
  EXPECT_EQ(kelpie("view none.exr -o w.png").status, 66);
  EXPECT_EQ(kelpie("view a.0001.exr -o w.png --view none").status, 2);
  EXPECT_EQ(kelpie("view a.0001.exr -o w.png --ocio none.ocio").status, 66);
  EXPECT_EQ(kelpie("view a.0001.exr -o v.png/w.png").status, 74);
  EXPECT_EQ(run("OCIO=/none.ocio " KELPIE_PROGRAM " view a.0001.exr -o w.png").status, 66) << "never a silent fallback";
  EXPECT_FALSE(fs::exists(folder_ / "w.png"));
}

TEST_F(PictureCommands, SheetTakesPatternsAndFiles) {
  EXPECT_EQ(kelpie("sheet 'a.####.exr' -o s.png --width 64").status, 0);
  EXPECT_EQ(kelpie("sheet a.0001.exr a.0004.exr -o t.png").status, 0);
  const Outcome missing = kelpie("sheet 'a.####.exr' -f 4-7 -o u.png");
  EXPECT_EQ(missing.status, 66);
  EXPECT_NE(missing.text.find("a.0006.exr"), std::string::npos) << missing.text;
  EXPECT_EQ(kelpie("sheet a.0001.exr -f 1-2 -o u.png").status, 2);
  EXPECT_EQ(kelpie("sheet 'b.####.exr' -o u.png").status, 66);
}

TEST_F(PictureCommands, SwatchesShowWhatIsNamed) {
  EXPECT_EQ(kelpie("swatches gold marble -o s.png --width 32 --spp 1").status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "s.png"));
  EXPECT_EQ(run("echo '{\"kelpie\":1,\"materials\":{\"a\":\"gold\"}}' > \"it's.json\" && " KELPIE_PROGRAM
                " swatches -m \"it's.json\" -o t.png --width 32 --spp 1")
                .status,
            0);
  const size_t before = file_count();
  const Outcome unknown = kelpie("swatches marbel -o u.png");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(unknown.text, "error: no material is called \"marbel\" (did you mean \"marble\"?)\n");
  const Outcome missing = kelpie("swatches -m none.json -o u.png");
  EXPECT_EQ(missing.status, 66);
  EXPECT_EQ(missing.text, "error: none.json: does not exist\n");
  EXPECT_EQ(file_count(), before);
}

TEST_F(PictureCommands, MovieIsTaggedAndReproducible) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  EXPECT_EQ(kelpie("movie 'a.####.exr' -o a.mp4 --progress none").text, "");
  const std::string shown = run("ffprobe -v error -show_streams a.mp4").text;
  for (const char* line : {"codec_name=h264", "width=66", "height=34", "pix_fmt=yuv420p", "color_range=tv", "color_space=bt709",
                           "color_transfer=iec61966-2-1", "color_primaries=bt709", "r_frame_rate=24000/1001", "nb_frames=5"})
    EXPECT_NE(shown.find(line), std::string::npos) << line << " in\n" << shown;
  EXPECT_EQ(kelpie("movie 'a.%04d.exr' -f 1-5 -o b.mp4").status, 0);
  EXPECT_EQ(run("cmp a.mp4 b.mp4").status, 0);
  EXPECT_EQ(kelpie("movie 'a.%04d.exr' -f 1-5 -o c.MP4").status, 0);
  EXPECT_EQ(run("cmp a.mp4 c.MP4").status, 0);
}

TEST_F(PictureCommands, MovieSaysWhatIsMissing) {
  fs::remove(folder_ / "a.0003.exr");
  const Outcome gap = kelpie("movie 'a.####.exr' -o a.mp4");
  EXPECT_EQ(gap.status, 66);
  EXPECT_NE(gap.text.find("no frame 3"), std::string::npos) << gap.text;
  EXPECT_EQ(kelpie("movie 'a.####.exr' -f 2-4 -o a.mp4").status, 66);
  EXPECT_EQ(kelpie("movie 'a.####.exr' -f 1,2 -o a.gif").status, 2);
  const Outcome without = run("PATH=/none " KELPIE_PROGRAM " movie 'a.####.exr' -f 1,2 -o a.mp4");
  EXPECT_EQ(without.status, 66);
  EXPECT_NE(without.text.find("ffmpeg"), std::string::npos) << without.text;
  EXPECT_EQ(file_count(), 4u) << "nothing is left of any of these";
}

TEST_F(PictureCommands, MovieThatDoesNotFitLeavesNothing) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const Outcome small = run("ulimit -f 1; " KELPIE_PROGRAM " movie 'a.####.exr' -o a.mp4 --crf 0 --progress none");
  EXPECT_EQ(small.status, 74) << small.text;
  EXPECT_EQ(file_count(), 5u);
}

} // namespace
} // namespace kelpie
