// Runs that are killed, and what the next run makes of what they left.
#include <map>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/temporary_folder.h"
#include "field/clouds/cloud_file.h"
#include "renderer/output/exr.h"
#include "tests/support/program.h"

namespace kelpie {
namespace {

namespace fs = std::filesystem;

/// Blobs of which each meets about ten others.
BlobCloud heap_of_blobs(uint32_t count) {
  BlobCloud blobs;
  const float side = std::cbrt(static_cast<float>(count));
  uint32_t state = 1;
  const auto random = [&] { return static_cast<float>((state = state * 1664525 + 1013904223) >> 8) / float(1 << 24); };
  for (uint32_t i = 0; i < count; ++i) blobs.push_back({side * Vec3(random(), random(), random()), 1.2f, 1});
  return blobs;
}

class Resume : public ProgramTest {
protected:
  Resume() {
    setenv("XDG_CACHE_HOME", path("cache").c_str(), 1);
    fs::create_directory(folder_ / "out"), fs::create_directory(folder_ / "tmp");
    write("scene.json",
          R"({ "kelpie": 1, "frames": { "last": 20 }, "film": { "resolution": [32, 32], "spp": 4 }, "shapes": [ { "name": "ball",
      "field": { "kind": "point", "centre": { "keys": [[1, [0, 0, 0]], [20, [1, 0, 0]]] }, "radius": 1, "weight": 2 } } ] })");
    write("mesh.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  }

  /// Two of which building and reading take seconds.
  void write_long_scenes() const {
    write_blob_cloud(path("cloud.ply"), heap_of_blobs(60000));
    write("cells.json",
          R"({ "kelpie": 1, "camera": { "shutter": 1 }, "film": { "resolution": [16, 16], "spp": 1 }, "shapes": [ { "name": "heap",
    "field": { "kind": "translate", "by": { "keys": [[0, [0, 0, 0]], [2, [40, 0, 0]]] }, "child": { "kind": "blobs", "file": "cloud.ply" } } } ] })");
    write("lattice.json", R"({ "kelpie": 1, "shapes": [ { "name": "solid",
    "field": { "kind": "sdf_mesh", "file": "mesh.off", "radius": 0.01, "voxel": 0.0011 } } ] })");
  }

  /// The frames in out/, each with the file that it is.
  std::map<std::string, ino_t> frames() const {
    std::map<std::string, ino_t> found;
    for (const auto& entry : fs::directory_iterator(folder_ / "out")) {
      struct stat status {};
      stat(entry.path().c_str(), &status);
      if (entry.path().extension() == ".exr") found[entry.path().filename().string()] = status.st_ino;
    }
    return found;
  }
  /// How many unfinished files and folders there are.
  static size_t unfinished_in(const fs::path& folder) {
    size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder)) count += entry.path().extension() == ".part";
    return count;
  }
};

// No frame is torn, none that was whole is made again, and the pictures are those of a run that nobody killed.
TEST_F(Resume, KilledRunsAreResumed) {
  const std::string run = "$KELPIE render scene.json --skip-existing --progress none -o out/a.####.exr";
  size_t killed = 0;
  for (int i = 0; i < 50 && frames().size() < 20; ++i) {
    const std::map<std::string, ino_t> before = frames();
    killed += shell("timeout -s KILL 0." + std::to_string(100 + 23 * (i % 9)) + " " + run) != 0;
    const std::map<std::string, ino_t> after = frames();
    for (const auto& [name, file] : before) EXPECT_EQ(after.at(name), file) << name << " was made again";
    for (const auto& [name, file] : after) EXPECT_TRUE(read_exr(path("out/" + name)).is_intact()) << name;
  }
  EXPECT_GE(killed, 1u);
  ASSERT_EQ(shell(run), 0);
  EXPECT_EQ(frames().size(), 20u);
  EXPECT_EQ(unfinished_in(folder_ / "out"), 0u);
  ASSERT_EQ(shell("$KELPIE render scene.json --progress none -o b.####.exr"), 0);
  EXPECT_EQ(shell("for f in out/*.exr; do cmp $f b${f#out/a} || exit 1; done"), 0);
}

TEST_F(Resume, TemporaryCloudsOfAKilledRunAreCleared) {
  const std::string run = "TMPDIR=$PWD/tmp $KELPIE liquid mesh.off mesh.off --blobs 8 --progress none -o out/a.####.exr ";
  // Killed as soon as the clouds are there.
  ASSERT_EQ(shell(run +
                  "-f 1-20 --res 512x512 2>/dev/null & until ls -A tmp | grep -q part; do sleep 0.05; done; sleep 0.2; kill -KILL $!; "
                  "wait $! 2>/dev/null; test $? = 137"),
            0);
  EXPECT_EQ(unfinished_in(folder_ / "tmp"), 1u);
  ASSERT_EQ(shell(run + "-f 1 --res 16x16 --spp 1 2>/dev/null"), 0);
  EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));
  EXPECT_EQ(unfinished_in(folder_ / "out"), 0u);
}

// A signal is heard at once, wherever it comes: nothing is left, and the process ends by it.
TEST_F(Resume, SignalsAreHeardAtOnce) {
  const std::string kept = " & sleep 0.6; start=$(date +%s%N); kill -TERM $!; wait $! 2>/dev/null; test $? = 143 && "
                           "test $(( $(date +%s%N) - start )) -lt 2000000000";
  EXPECT_EQ(shell("$KELPIE render scene.json --spp 100000 --res 64x64 -f 1 --progress none -o out/a.exr" + kept), 0) << "inside a tile";
  EXPECT_EQ(shell("TMPDIR=$PWD/tmp $KELPIE liquid mesh.off mesh.off --blobs 8 -f 1 --spp 100000 -o out/a.exr 2>/dev/null" + kept), 0);
  EXPECT_EQ(shell("sleep 5 | { $KELPIE check /dev/stdin <&3" + kept + "; } 3<&0"), 0) << "a pipe that says nothing";
  EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));
  EXPECT_TRUE(fs::is_empty(folder_ / "out"));
}

// The same in each phase: what takes long is begun, and killed sooner and later.
TEST_F(Resume, SignalsAreHeardInEveryPhase) {
  write_long_scenes();
  write("map.json", R"({ "kelpie": 1, "lights": [ { "kind": "environment", "file": "map.hdr" } ], "shapes": [ { "name": "ball",
    "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 2 } } ] })");
  ASSERT_EQ(shell("(printf '#?RADIANCE\\nFORMAT=32-bit_rle_rgbe\\n\\n-Y 4096 +X 8192\\n'; head -c 134217728 /dev/zero | tr '\\0' '\\200') "
                  ">map.hdr"),
            0);
  ASSERT_EQ(shell("$KELPIE render scene.json -f 1 --progress none -o frame.exr"), 0);
  const std::string quiet = " --progress none -o out/a.exr";
  for (const std::string& line :
       {"render cells.json -f 1 -j 1" + quiet, "render lattice.json" + quiet, std::string("check lattice.json"), "render map.json" + quiet,
        std::string("fit mesh.off --blobs 20000 --progress none -o out/a.ply"), std::string("view frame.exr --width 20000 -o out/a.png")})
    for (const char* after : {"0.4", "1.2"}) {
      EXPECT_EQ(shell("$KELPIE " + line + " 2>/dev/null & sleep " + after +
                      "; start=$(date +%s%N); kill -TERM $!; wait $! 2>/dev/null; test $? = 143 && "
                      "test $(( $(date +%s%N) - start )) -lt 2000000000"),
                0)
          << line << " after " << after << " s";
      EXPECT_TRUE(fs::is_empty(folder_ / "out")) << line;
    }
}

TEST_F(Resume, WhatTakesLongIsSaid) {
  write_long_scenes();
  const auto said = [&](const std::string& line) {
    shell("timeout -s TERM 4 $KELPIE " + line + " -j 1 --progress bar -o out/a.exr 2>said.txt");
    return text_of(folder_ / "said.txt");
  };
  EXPECT_NE(said("render cells.json -f 1").find("\rbuilding frame 1, for 0:01"), std::string::npos) << text_of(folder_ / "said.txt");
  EXPECT_NE(said("render lattice.json").find("\rreading lattice.json, for 0:01"), std::string::npos) << text_of(folder_ / "said.txt");
}

// --- the same in this process ---

/// What another run would have left: as it is called, but locked by nobody.
void leave(const fs::path& folder, const std::string& name) { std::ofstream(folder / name) << "half"; }

TEST_F(Resume, OnlyWhatNobodyWritesIsCleared) {
  const fs::path out = folder_ / "out";
  const std::string dead = unfinished_name();
  leave(out, dead);
  leave(out, ".kelpie-00000000-000000000000.part"); // of another host, an hour ago at most
  leave(out, ".kelpie-notes.part");
  leave(out, "a.part");
  const FileDescriptor other_run(open((out / unfinished_name()).c_str(), O_WRONLY | O_CREAT, 0666));
  ASSERT_TRUE(lock_in_use(other_run.number()));
  write_file_atomically(out / "b", {});
  EXPECT_FALSE(fs::exists(out / dead));
  EXPECT_EQ(unfinished_in(out), 4u);
}

TEST_F(Resume, FilesThatBelongTogetherAreThereTogetherOrNotAtAll) {
  const fs::path out = folder_ / "out";
  write_file_atomically(out / "old", {});
  EXPECT_THROW(write_files_atomically({{out / "a", "1"}, {out / "old/b", "2"}}), Error);
  EXPECT_FALSE(fs::exists(out / "a"));
  // The second cannot be put in its place when the first already is.
  std::vector<FileToWrite> files{{out / "a", "1"}, {out / "b", "2"}};
  write_files_atomically(files);
  EXPECT_EQ(text_of(out / "a") + text_of(out / "b"), "12");
  PartFile first(out / "c"), second(out / "d");
  fs::create_directory(out / "d");
  first.commit();
  EXPECT_THROW(second.commit(), Error);
  first.withdraw();
  EXPECT_FALSE(fs::exists(out / "c"));
}

TEST_F(Resume, ATemporaryFolderIsGoneWithItsOwner) {
  setenv("TMPDIR", path("tmp").c_str(), 1);
  {
    TemporaryFolder folder;
    write_file_atomically(folder.file("a"), {});
    TemporaryFolder another; // does not take the first for a dead run's
    EXPECT_TRUE(fs::exists(folder.file("a")));
  }
  unsetenv("TMPDIR");
  EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));
}

} // namespace
} // namespace kelpie
