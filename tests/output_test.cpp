#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <random>

#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <zlib.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/file_bytes.h"
#include "renderer/output/camera_matrices.h"
#include "renderer/output/exr.h"
#include "renderer/output/file_hash.h"
#include "renderer/output/sequence.h"
#include "renderer/output/zip_chunk.h"

namespace kelpie {
namespace {

namespace fs = std::filesystem;

/// A new folder that is removed at the end.
class OutputTest : public testing::Test {
protected:
  OutputTest() {
    std::string name = testing::TempDir() + "kelpie_output_XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~OutputTest() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  size_t file_count() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }

  fs::path folder_;
};

template <class Act>
std::string message_of(ExitStatus status, Act&& act) {
  try {
    act();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, status) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

std::span<const unsigned char> bytes_of(const std::string& s) { return {reinterpret_cast<const unsigned char*>(s.data()), s.size()}; }

FrameImage test_frame(PixelBox window = {3, 2, 40, 27}) {
  FrameImage image({48, 32}, window);
  for (const char* name : {"R", "G", "B", "A", "Z", "P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B"}) {
    FrameChannel& c = image.add(name);
    for (size_t i = 0; i < c.pixels.size(); ++i) c.pixels[i] = std::sin(float(i) * 0.37f + float(image.channels.size())) * 3;
  }
  image.find("Z")->pixels[5] = 1e10f;
  return image;
}

FrameHeader test_header() {
  FrameHeader header;
  header.frame = 17, header.fps = 23.976, header.scene_hash = "0123456789abcdef";
  header.meta = R"({"shot":"a\"7"})";
  Camera<SampledMode> camera;
  const CameraMatrices m = camera_matrices(camera, {48, 32});
  header.camera_from_world = m.camera_from_world, header.ndc_from_world = m.ndc_from_world;
  return header;
}

// --- EXR ---

TEST_F(OutputTest, ExrComesBackAsItWasWritten) {
  const FrameImage image = test_frame();
  const std::string file = path("new/folder/a.exr");
  const EncodedFrame written = write_exr(file, image, test_header());
  const DecodedFrame read = read_exr(file);
  EXPECT_EQ(written.clamped + written.nonfinite, 0u);
  EXPECT_TRUE(read.is_intact());
  EXPECT_EQ(read.claimed_hash, written.pixel_hash);
  EXPECT_EQ(read.image.resolution, image.resolution);
  EXPECT_EQ(read.image.data_window, image.data_window);
  ASSERT_EQ(read.image.channels.size(), image.channels.size());
  for (const FrameChannel& c : image.channels) {
    const FrameChannel* back = read.image.find(c.name);
    ASSERT_TRUE(back) << c.name;
    EXPECT_EQ(back->depth, c.depth) << c.name;
    const float tolerance = c.depth == ChannelDepth::half ? 0.002f : 0; // 11 bits of values up to 3
    for (size_t i = 0; i < c.pixels.size(); ++i) ASSERT_NEAR(back->pixels[i], c.pixels[i], tolerance) << c.name;
  }
}

TEST_F(OutputTest, ExrHeaderComesBack) {
  const FrameHeader header = test_header();
  const DecodedFrame read = decode_exr(encode_exr(test_frame(), header).bytes, "memory");
  EXPECT_EQ(read.header.frame, 17);
  EXPECT_NEAR(read.header.fps, 23.976, 1e-9);
  EXPECT_EQ(read.header.scene_hash, header.scene_hash);
  EXPECT_EQ(read.header.meta, header.meta);
  ASSERT_TRUE(read.header.camera_from_world && read.header.ndc_from_world);
  EXPECT_EQ(*read.header.camera_from_world, *header.camera_from_world);
  EXPECT_EQ(*read.header.ndc_from_world, *header.ndc_from_world);
}

TEST_F(OutputTest, ExrNamesAreThoseOfTheStandard) {
  const std::vector<unsigned char> bytes = encode_exr(test_frame(), test_header()).bytes;
  const std::string header(bytes.begin(), bytes.begin() + 4096);
  for (const char* name : {"chromaticities", "Software", "framesPerSecond", "worldToCamera", "worldToNDC", "capDate", "kelpie:sceneHash",
                           "kelpie:pixelHash", "kelpie:frame"})
    EXPECT_NE(header.find(std::string(name) + '\0'), std::string::npos) << name;
  EXPECT_EQ(header.find("oiio:"), std::string::npos);
}

TEST_F(OutputTest, EqualFramesAreEqualBytes) {
  EXPECT_EQ(encode_exr(test_frame(), test_header()).bytes, encode_exr(test_frame(), test_header()).bytes);
}

TEST_F(OutputTest, TheHashIsOfThePixels) {
  FrameImage image = test_frame();
  const std::string before = encode_exr(image, test_header()).pixel_hash;
  std::reverse(image.channels.begin(), image.channels.end());
  EXPECT_EQ(encode_exr(image, {}).pixel_hash, before) << "neither the order of channels nor the header counts";
  image.find("B")->pixels[7] += 0.5f;
  EXPECT_NE(encode_exr(image, {}).pixel_hash, before);
}

TEST_F(OutputTest, EverythingWrittenIsFinite) {
  FrameImage image = test_frame();
  std::vector<float>& r = image.find("R")->pixels;
  r[0] = 70000, r[1] = -1e9f, r[2] = std::numeric_limits<float>::infinity(), r[3] = std::numeric_limits<float>::quiet_NaN();
  image.find("Z")->pixels[0] = std::numeric_limits<float>::infinity();
  const EncodedFrame encoded = encode_exr(image, test_header());
  EXPECT_EQ(encoded.clamped, 2u);
  EXPECT_EQ(encoded.nonfinite, 3u);
  const DecodedFrame read = decode_exr(encoded.bytes, "memory");
  const std::vector<float>& back = read.image.find("R")->pixels;
  EXPECT_EQ(back[0], 65504);
  EXPECT_EQ(back[1], -65504);
  EXPECT_EQ(back[2], 65504);
  EXPECT_EQ(back[3], 0);
  EXPECT_TRUE(std::isfinite(read.image.find("Z")->pixels[0]));
}

TEST_F(OutputTest, OnlyAWholeFrameOfTheSameSceneIsComplete) {
  const std::string file = path("a.exr"), hash = test_header().scene_hash;
  EXPECT_FALSE(frame_is_complete(file, hash)) << "there is none";
  write_exr(file, test_frame(), test_header());
  EXPECT_TRUE(frame_is_complete(file, hash));
  EXPECT_FALSE(frame_is_complete(file, "another scene"));
  const std::string whole = read_file_bytes(file);
  for (size_t cut : {size_t(0), size_t(4), size_t(300), whole.size() / 2, whole.size() - 1}) {
    write_file_atomically(file, as_bytes(whole).first(cut));
    EXPECT_FALSE(frame_is_complete(file, hash)) << "cut at " << cut;
  }
}

// Chromaticities, matrices, names of channels, the table of offsets, pixels: whatever a reader gets is what was written.
TEST_F(OutputTest, AnyByteThatIsAlteredIsNoticed) {
  const EncodedFrame frame = encode_exr(test_frame(), test_header());
  std::vector<unsigned char> bytes = frame.bytes;
  ASSERT_TRUE(is_sealed(bytes));
  for (size_t at = 0; at < bytes.size(); ++at) {
    bytes[at] ^= static_cast<unsigned char>(1 << at % 8);
    ASSERT_FALSE(is_sealed(bytes)) << "byte " << at;
    bytes[at] = frame.bytes[at];
  }
  bytes.push_back(0);
  EXPECT_FALSE(is_sealed(bytes)) << "one more";
  const std::string file = path("a.exr");
  for (size_t at = 0; at < frame.bytes.size(); at += 997) {
    bytes = frame.bytes;
    bytes[at] ^= 4;
    write_file_atomically(file, bytes);
    EXPECT_FALSE(frame_is_complete(file, test_header().scene_hash)) << "byte " << at;
  }
}

TEST_F(OutputTest, BadPicturesAreErrors) {
  message_of(ExitStatus::missing_input, [&] { read_exr(path("none.exr")); });
  message_of(ExitStatus::missing_input, [&] { read_exr(folder_.string()); });
  write_file_atomically(path("b.exr"), bytes_of("no picture"));
  EXPECT_NE(message_of(ExitStatus::bad_data, [&] { read_exr(path("b.exr")); }).find("b.exr"), std::string::npos);
}

// Other readers read it, whatever is in it.
TEST(ZipChunks, AreWhatZlibReads) {
  std::mt19937 random(7);
  ChunkZipper zipper;
  for (const size_t size : {1u, 2u, 3u, 517u, 2048u, 2049u, 4099u, 70'000u, 300'001u})
    for (int kind = 0; kind < 4; ++kind) {
      std::string rows(size, 'x');
      for (size_t i = 0; i < size; ++i) {
        const bool is_noisy = kind == 3 ? i / 9000 % 2 : kind == 1;
        rows[i] = static_cast<char>(is_noisy ? random() : kind == 2 ? i / 100 : 0);
      }
      const auto zipped = zipper.zip(bytes_of(rows));
      EXPECT_LE(zipped.size(), size);
      if (zipped.size() == size) continue; // as they are
      
      std::vector<unsigned char> differences(size);
      uLongf count = size;
      ASSERT_EQ(uncompress(differences.data(), &count, zipped.data(), zipped.size()), Z_OK) << size << " " << kind;
      ASSERT_EQ(count, size);
      for (size_t i = 1; i < size; ++i) differences[i] = static_cast<unsigned char>(differences[i] + differences[i - 1] - 128);
      for (size_t i = 0; i < size; ++i)
        ASSERT_EQ(differences[i % 2 ? (size + 1) / 2 + i / 2 : i / 2], static_cast<unsigned char>(rows[i])) << size << " " << kind;
    }
}

// The number of rows in the last chunk, one channel or many, a window off the picture: OpenEXR reads all of them.
TEST_F(OutputTest, ExrOfAnySizeComesBack) {
  for (const PixelBox window : {PixelBox{0, 0, 1, 1}, {0, 0, 5, 16}, {-7, -20, 48, 13}, {3, 30, 300, 95}, {0, 0, 1000, 33}}) {
    const FrameImage image = test_frame(window);
    const EncodedFrame encoded = encode_exr(image, test_header());
    const DecodedFrame read = decode_exr(encoded.bytes, "memory");
    EXPECT_TRUE(read.is_intact());
    EXPECT_EQ(read.image.data_window, window);
    EXPECT_EQ(read.image.find("P.Y")->pixels, image.find("P.Y")->pixels);
    EXPECT_EQ(pixel_hash_of_exr(encoded.bytes, "memory"), encoded.pixel_hash);
  }
}

TEST_F(OutputTest, NamesOfChannelsMayBeLong) {
  FrameImage image = test_frame();
  image.add("a_layer_with_a_long_name_of_its_own.R").pixels[3] = 2;
  const DecodedFrame read = decode_exr(encode_exr(image, test_header()).bytes, "memory");
  EXPECT_TRUE(read.is_intact());
  ASSERT_TRUE(read.image.find("a_layer_with_a_long_name_of_its_own.R"));
  EXPECT_EQ(read.image.find("a_layer_with_a_long_name_of_its_own.R")->pixels[3], 2);
}

// --- the camera in the header ---

TEST(CameraMatrices, ShowPointsWhereThePictureDoes) {
  Camera<SampledMode> camera; // at (0, 1, 6), looks at the origin
  const CameraMatrices m = camera_matrices(camera, {200, 100});
  const float distance = std::sqrt(37.f);
  const glm::vec4 centre = m.camera_from_world * glm::vec4(0, 0, 0, 1);
  EXPECT_NEAR(centre.x, 0, 1e-5f);
  EXPECT_NEAR(centre.y, 0, 1e-5f);
  EXPECT_NEAR(centre.z, distance, 1e-5f) << "left-handed: z into the picture";
  EXPECT_GT((m.camera_from_world * glm::vec4(1, 0, 0, 1)).x, 0);
  // A point at the right edge of the picture, in the plane through the origin.
  const float right = distance * std::tan(glm::radians(camera.fov) / 2) * 2;
  const glm::vec4 edge = m.ndc_from_world * glm::vec4(right, 0, 0, 1);
  EXPECT_NEAR(edge.x / edge.w, 1, 1e-5f);
}

// --- atomic files ---

TEST_F(OutputTest, AFileIsThereWholeOrNotAtAll) {
  write_file_atomically(path("a"), bytes_of("old"));
  {
    PartFile part(path("a"));
    part.write(bytes_of("half of someth"));
    EXPECT_TRUE(fs::exists(part.part_path()));
    EXPECT_EQ(fs::path(part.part_path()).filename().string().front(), '.');
  }
  EXPECT_EQ(file_count(), 1u) << "the part is gone";
  EXPECT_EQ(read_file_bytes(path("a")).size(), 3u) << "and the old file is as it was";
  write_file_atomically(path("a"), bytes_of("newer"));
  EXPECT_EQ(read_file_bytes(path("a")).size(), 5u);
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(OutputTest, ReasonsAreForHumans) {
  write_file_atomically(path("file"), bytes_of("x"));
  EXPECT_NE(message_of(ExitStatus::cannot_write, [&] { write_file_atomically(path("file/a.exr"), {}); }).find("is a file, not a folder"),
            std::string::npos);
  EXPECT_NE(message_of(ExitStatus::cannot_write, [&] { write_file_atomically(folder_, {}); }).find("is a folder"), std::string::npos);
  EXPECT_NE(message_of(ExitStatus::cannot_write, [&] { write_file_atomically(path(std::string(300, 'n')), {}); }).find("name too long"),
            std::string::npos);
  EXPECT_EQ(message_of(ExitStatus::cannot_write, [&] { write_file_atomically("/dev/full", bytes_of("x")); }),
            "/dev/full: No space left on device");
  EXPECT_TRUE(fs::is_character_file("/dev/full")) << "a device is written to, never replaced";
}

TEST_F(OutputTest, SymbolicLinksAreFollowed) {
  write_file_atomically(path("real"), bytes_of("x"));
  fs::create_symlink("real", path("link"));
  write_file_atomically(path("link"), bytes_of("longer"));
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(read_file_bytes(path("real")).size(), 6u);
}

TEST_F(OutputTest, AFileThatMayNotGrowLeavesNothing) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{}, small{};
  getrlimit(RLIMIT_FSIZE, &old);
  small = old, small.rlim_cur = 1000;
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string big(5000, 'x');
  const std::string message = message_of(ExitStatus::cannot_write, [&] { write_file_atomically(path("a"), bytes_of(big)); });
  setrlimit(RLIMIT_FSIZE, &old);
  EXPECT_EQ(message, path("a") + ": File too large");
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(OutputTest, AFullDiskLeavesNothing) {
  if (mount("none", folder_.c_str(), "tmpfs", 0, "size=64k") != 0) GTEST_SKIP() << "only root may mount a small disk";
  const std::string big(200'000, 'x');
  const std::string message = message_of(ExitStatus::cannot_write, [&] { write_file_atomically(path("a"), bytes_of(big)); });
  const size_t left = file_count();
  umount(folder_.c_str());
  EXPECT_EQ(message, path("a") + ": No space left on device");
  EXPECT_EQ(left, 0u);
}

TEST_F(OutputTest, ASignalLeavesNothing) {
  for (const int number : {SIGINT, SIGTERM}) {
    const pid_t child = fork();
    if (child == 0) {
      clean_up_on_signals();
      PartFile part(path("a"));
      part.write(bytes_of("something"));
      if (!fs::exists(part.part_path())) _exit(1);
      std::raise(number);
      _exit(2);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << WEXITSTATUS(status);
    EXPECT_EQ(WTERMSIG(status), number);
    EXPECT_EQ(file_count(), 0u);
  }
}

// --- frames and names ---

TEST(Frames, Ranges) {
  const std::pair<const char*, std::vector<int>> cases[] = {
      {"7", {7}},
      {"1-4", {1, 2, 3, 4}},
      {"1..4", {1, 2, 3, 4}},
      {"1-10x3", {1, 4, 7, 10}},
      {"1-9:3", {1, 4, 7}},
      {"3,1,2-4", {3, 1, 2, 4}},
      {"4-1", {4, 3, 2, 1}},
      {"10-1x4", {10, 6, 2}},
      {"-2-1", {-2, -1, 0, 1}},
      {"-5--4", {-5, -4}},
      {" 1 , 2 ", {1, 2}},
      {"5-5", {5}},
      {"1-3,1-3", {1, 2, 3}},
  };
  for (const auto& [text, frames] : cases) EXPECT_EQ(parse_frames(text), frames) << text;
}

TEST(Frames, MalformedRangesAreUsageErrors) {
  for (const char* text :
       {"",       " ",   ",",   "1,",    ",1",    "1-",  "a",           "1-b",       "1-4x",         "1-4x0",
        "1-4x-1", "1--", "1.5", "1...4", "1-4-6", "1x2", "99999999999", "1-2000000", "0-2147483647", "-2147483648-2147483647",
        "1 2x"})
    message_of(ExitStatus::usage, [&] { parse_frames(text); });
}

TEST(Frames, AreShownAsTheyAreWritten) {
  for (const char* text : {"1", "1-3", "1-9x2", "1-3,7", "1,5", "1-3,7,10-20x5", "-2-1"})
    EXPECT_EQ(format_frames(parse_frames(text)), text);
}

TEST(FramePatterns, Tokens) {
  const std::tuple<const char*, int, const char*> cases[] = {
      {"a.####.exr", 7, "a.0007.exr"},         {"a.#.exr", 12, "a.12.exr"},
      {"a.%04d.exr", 7, "a.0007.exr"},         {"a.%d.exr", 7, "a.7.exr"},
      {"a.$F4.exr", 7, "a.0007.exr"},          {"a.$F.exr", 7, "a.7.exr"},
      {"a.####.exr", 12345, "a.12345.exr"},    {"a.####.exr", -3, "a.-0003.exr"},
      {"out/#1/a##.exr", 3, "out/#1/a03.exr"}, {"100%%.##.exr", 3, "100%.03.exr"},
      {"plain.exr", 3, "plain.exr"},           {"####", 1, "0001"},
      {"a.%04d.exr", -3, "a.-003.exr"},        {"a.%4d.exr", 7, "a.0007.exr"},
      {"a.%-4d.exr", 7, "a.7   .exr"},         {"a.%-4d.exr", -12345, "a.-12345.exr"},
      {"a.%-d.exr", -3, "a.-3.exr"},           {"a.$F4.exr", -3, "a.-0003.exr"},
  };
  for (const auto& [pattern, frame, file] : cases) EXPECT_EQ(FramePattern(pattern).path(frame), file) << pattern;
}

TEST(FramePatterns, WrongOnesAreUsageErrors) {
  for (const char* text : {"a.####.##.exr", "a.%04x.exr", "a.%", "a%s", "a.%04d.$F4.exr"})
    message_of(ExitStatus::usage, [&] { FramePattern pattern(text); });
  EXPECT_NO_THROW(require_numbered(FramePattern("a.exr"), {5}));
  EXPECT_NE(message_of(ExitStatus::usage, [] { require_numbered(FramePattern("a.exr"), {5, 6}); }).find("####"), std::string::npos);
}

TEST_F(OutputTest, FramesThatExistAreFound) {
  for (const char* name : {"a.0001.exr", "a.0010.exr", "a.0003.exr", "a.12345.exr", "a.7.exr", "a.0002.png", ".a.0004.exr.host.1.part",
                           "b.0005.exr", "d.-003.exr", "d.0004.exr", "d.5   .exr"})
    write_file_atomically(path(name), {});
  EXPECT_EQ(FramePattern(path("a.####.exr")).existing_frames(), (std::vector<int>{1, 3, 10, 12345}));
  EXPECT_EQ(FramePattern(path("d.%04d.exr")).existing_frames(), (std::vector<int>{-3, 4}));
  EXPECT_EQ(FramePattern(path("d.%-4d.exr")).existing_frames(), std::vector<int>{5});
  EXPECT_EQ(FramePattern(path("c.####.exr")).existing_frames(), std::vector<int>{});
}

} // namespace
} // namespace kelpie
