// What the program does where the world ends: streams that cannot be written, pipes that nobody reads, folders that may not be entered,
// full disks, no memory. Each time: the documented status, a line that says why, and nothing under the final name.
#include <algorithm>

#include <unistd.h>

#include "tests/support/program.h"

namespace kelpie {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_scene = R"({ "kelpie": 1, "frames": { "last": 2 }, "film": { "resolution": [16, 16], "spp": 1 },
  "shapes": [ { "name": "ball", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 2 } } ] })";

constexpr const char* k_tetrahedron = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

class Faults : public ProgramTest {
protected:
  Faults() {
    setenv("XDG_CACHE_HOME", path("cache").c_str(), 1);
    write("scene.json", k_scene);
    write("mesh.off", k_tetrahedron);
    write("sdf.json", R"({ "kelpie": 1, "film": { "resolution": [16, 16], "spp": 1 }, "shapes": [ { "name": "solid",
      "field": { "kind": "sdf_mesh", "file": "mesh.off", "radius": 0.2, "voxel": 0.1 } } ] })");
  }

  /// The line's status within half a minute, and what it says on stderr (if it says so there).
  Outcome timed(const std::string& line) const {
    const int status = shell("timeout -k 1 30 bash -c '" + line + "' 2>stderr.txt");
    Outcome o{status, {}, text_of(folder_ / "stderr.txt")};
    fs::remove(folder_ / "stderr.txt");
    return o;
  }
  /// That the line ends so, says `err` somewhere, and leaves no file besides those there were.
  void expect(const std::string& line, int status, const std::string& err) const {
    const size_t files = file_count();
    const Outcome o = timed(line);
    EXPECT_EQ(o.status, status) << line << "\n" << o.err;
    EXPECT_NE(o.err.find(err), std::string::npos) << line << "\n" << o.err;
    EXPECT_EQ(file_count(), files) << line << " left something";
  }
  void make_pipe(const std::string& name) const { ASSERT_EQ(shell("mkfifo " + name), 0); }
  void make_frame() const { ASSERT_EQ(kelpie("render scene.json -f 1 -o frame.exr --progress none").status, 0); }
};

// --- standard streams ---

TEST_F(Faults, AStderrThatCannotBeWrittenStopsNothing) {
  ASSERT_EQ(timed("$KELPIE render scene.json -o good.####.exr --progress plain").status, 0);
  for (const std::string stream : {"2>/dev/full", "2>&-", "2> >(true)", "2>&- >&- <&-"})
    for (const std::string progress : {"plain", "bar", "jsonl"}) {
      const Outcome o = timed("$KELPIE render scene.json -o a.####.exr --progress " + progress + " " + stream);
      EXPECT_EQ(o.status, 0) << stream << progress;
      EXPECT_EQ(shell("cmp a.0001.exr good.0001.exr && cmp a.0002.exr good.0002.exr"), 0) << "no message is in a frame";
    }
  for (const std::string stream : {"2>/dev/full", "2>&-"}) {
    EXPECT_EQ(timed("$KELPIE check none.json " + stream).status, 66);
    EXPECT_EQ(timed("$KELPIE rendr " + stream).status, 2);
    EXPECT_EQ(timed("$KELPIE check scene.json " + stream).status, 0);
    EXPECT_EQ(timed("$KELPIE view good.0001.exr -o a.png " + stream).status, 0);
    EXPECT_EQ(timed("$KELPIE sheet good.####.exr -o s.png " + stream).status, 0);
    EXPECT_EQ(timed("$KELPIE fit mesh.off -o a.ply --no-cache --blobs 8 " + stream).status, 0);
  }
}

TEST_F(Faults, AStdoutThatCannotBeWrittenIsAFailure) {
  for (const std::string arguments : {"--help", "--version", "render --help", "kinds", "kinds point", "schema", "check scene.json"}) {
    expect("$KELPIE " + arguments + " >/dev/full", 74, "error: cannot write to stdout: No space left on device\n");
    expect("$KELPIE " + arguments + " >&-", 74, "error: cannot write to stdout: Bad file descriptor\n");
    EXPECT_EQ(timed("$KELPIE " + arguments + " >/dev/full 2>/dev/full").status, 74);
    EXPECT_EQ(timed("$KELPIE " + arguments + " >/dev/null").status, 0);
  }
}

// --- what is no file ---

TEST_F(Faults, NamedPipesAreRefusedAndNeverWaitedFor) {
  make_frame();
  for (const std::string name : {"pipe", "pipe.exr", "pipe.png", "pipe.json", "pipe.off", "pipe.ply", "pipe.mp4"}) make_pipe(name);
  const std::string said = "it is a named pipe, not a file\n";
  expect("$KELPIE render scene.json -f 1 -o pipe.exr", 74, "error: pipe.exr: " + said);
  expect("$KELPIE render scene.json -f 1 -o a.exr --stats pipe", 74, "error: pipe: " + said);
  expect("$KELPIE view frame.exr -o pipe.png", 74, "error: pipe.png: " + said);
  expect("$KELPIE fit mesh.off -o pipe.ply --no-cache --blobs 8", 74, "error: pipe.ply: " + said);
  expect("$KELPIE movie frame.exr -o pipe.mp4", 74, "error: pipe.mp4: " + said);
  expect("$KELPIE check pipe.json", 66, "error: pipe.json: cannot read the scene: " + said);
  expect("$KELPIE fit pipe.off -o a.ply", 66, "error: pipe.off: cannot read: " + said);
  expect("$KELPIE view pipe.exr -o a.png", 66, "error: pipe.exr: cannot read: " + said);
  expect("$KELPIE check scene.json --ocio pipe", 66, said);
  expect("OCIO=pipe $KELPIE check scene.json", 66, said);
  expect("$KELPIE check /dev/zero", 66, "it is a device, not a file");
}

TEST_F(Faults, PipesThatAreHandedOverAreFiles) {
  make_frame();
  EXPECT_EQ(timed("cat scene.json | $KELPIE check /dev/stdin >/dev/null").status, 0);
  EXPECT_EQ(timed("$KELPIE fit <(sleep 0.3; cat mesh.off) -o a.ply --no-cache --blobs 8").status, 0);
  EXPECT_EQ(timed("$KELPIE view frame.exr -o a.png && $KELPIE view frame.exr -o /dev/stdout | cat >b.png && cmp a.png b.png").status, 0);
}

// --- the cache ---

TEST_F(Faults, ACacheThatCannotBeUsedIsGoneWithout) {
  const std::string fit = "$KELPIE fit mesh.off -o a.ply --blobs 8 && rm a.ply", sdf = "$KELPIE render sdf.json -f 1 -o b.exr && rm b.exr";
  write("file", "");
  for (const std::string where :
       {"XDG_CACHE_HOME=$PWD/file", "XDG_CACHE_HOME=$PWD/file/below", "XDG_CACHE_HOME=/proc/none", "XDG_CACHE_HOME= HOME=$PWD/file"}) {
    expect("export " + where + "; " + fit, 0, "warning: the fit is not cached: ");
    expect("export " + where + "; " + sdf, 0, "warning: the distances of ");
  }
  EXPECT_EQ(timed("unset XDG_CACHE_HOME HOME; " + fit).err.find("cached"), std::string::npos) << "there is no home to keep it in";
  // Entries that are pipes or folders.
  for (const std::string spoil : {"mkfifo", "mkdir"}) {
    fs::remove_all(folder_ / "cache");
    ASSERT_EQ(timed(fit + "; " + sdf).status, 0);
    ASSERT_EQ(shell("for f in cache/kelpie/*; do rm $f && " + spoil + " $f; done"), 0);
    expect(fit, 0, "warning: the fit is not cached: ");
    expect(sdf, 0, "warning: the distances of ");
  }
}

TEST_F(Faults, ASpoiltCacheEntryIsMadeAnew) {
  const std::string fit = "$KELPIE fit mesh.off --blobs 8 -o ";
  ASSERT_EQ(timed(fit + "good.ply").status, 0);
  ASSERT_NE(timed(fit + "again.ply").err.find("from the cache"), std::string::npos);
  const fs::path entry = fs::directory_iterator(folder_ / "cache/kelpie")->path();
  const std::string whole = text_of(entry);
  for (size_t at = 0; at < whole.size(); at += whole.size() / 7) {
    std::string spoilt = whole;
    spoilt[at] = static_cast<char>(spoilt[at] ^ 1);
    std::ofstream(entry, std::ios::binary) << spoilt;
    const Outcome o = timed(fit + "again.ply");
    EXPECT_EQ(o.status, 0);
    EXPECT_EQ(o.err.find("from the cache"), std::string::npos) << "byte " << at;
    EXPECT_EQ(text_of(folder_ / "again.ply"), text_of(folder_ / "good.ply")) << "byte " << at;
    EXPECT_NE(timed(fit + "again.ply").err.find("from the cache"), std::string::npos) << "it was mended";
  }
}

// --- folders and names ---

TEST_F(Faults, AFolderThatMayNotBeEnteredIsNotWrittenTo) {
  make_frame();
  fs::permissions(folder_, fs::perms(0777));
  ASSERT_EQ(shell("mkdir shut out && chmod 700 shut && chmod 777 out"), 0);
  const bool is_root = geteuid() == 0; // who may enter everything
  if (is_root && shell("setpriv --reuid=65534 --clear-groups test -x '" KELPIE_PROGRAM "'") != 0) GTEST_SKIP() << "nobody cannot run it";
  if (!is_root) fs::permissions(folder_ / "shut", fs::perms::none);
  const std::string as_nobody = std::string("export HOME=$PWD/shut/home XDG_CACHE_HOME= && cd out && ") +
                                (is_root ? "setpriv --reuid=65534 --clear-groups " : "") + "$KELPIE ";
  expect(as_nobody + "render ../scene.json -o ../shut/a.####.exr", 74, "error: ../shut/a.0001.exr: Permission denied\n");
  expect(as_nobody + "render ../scene.json -o ../shut/below/a.####.exr", 74, "Permission denied\n");
  expect(as_nobody + "view ../frame.exr -o ../shut/a.png", 74, "error: ../shut/a.png: Permission denied\n");
  expect(as_nobody + "render ../shut/scene.json -o a.####.exr", 66, "Permission denied\n");
  expect(as_nobody + "fit ../mesh.off -o a.ply --blobs 8 && rm a.ply", 0, "warning: the fit is not cached: ");
  if (!is_root) fs::permissions(folder_ / "shut", fs::perms::owner_all);
}

TEST_F(Faults, AWorkingDirectoryThatIsGoneIsNoInternalError) {
  const Outcome o = timed("mkdir gone && cd gone && rmdir ../gone && $KELPIE check scene.json");
  EXPECT_EQ(o.status, 66) << o.err;
}

TEST_F(Faults, LongNamesWork) {
  const std::string stem(251, 'n');
  EXPECT_EQ(kelpie("render scene.json -f 1 -o " + stem + ".exr").status, 0);
  EXPECT_EQ(kelpie("view " + stem + ".exr -o " + stem + ".png").status, 0);
  expect("$KELPIE render scene.json -f 1 -o n" + stem + ".exr", 74, "File name too long\n");
}

// --- files that belong together ---

TEST_F(Faults, APartThatFailsLeavesNoneOfItsSiblings) {
  ASSERT_EQ(shell("mkdir taken.json taken"), 0);
  expect("$KELPIE liquid mesh.off mesh.off --blobs 8 --no-cache --save-scene taken.json", 74,
         "error: taken.json: is a folder; name a file\n");
  expect("$KELPIE fit mesh.off --blobs 8 --no-cache -o a.ply --stats taken", 74, "error: taken: is a folder; name a file\n");
}

// --- disks ---

TEST_F(Faults, AFileThatMayNotGrowIsNotLeft) {
  make_frame();
  const std::string tiny = "ulimit -f 1; $KELPIE "; // blocks of 1024 bytes
  ASSERT_EQ(timed("head -c 2000 /dev/zero | tr \"\\0\" \" \" >>mesh.off").status, 0);
  expect(tiny + "render scene.json -f 1 --res 64x64 -o a.exr", 74, "error: a.exr: File too large\n");
  expect(tiny + "view frame.exr --width 300 -o a.png --exposure 9", 74, "error: a.png: File too large\n");
  expect(tiny + "fit mesh.off --blobs 200 --no-cache -o a.ply", 74, "error: a.ply: File too large\n");
  expect(tiny + "liquid mesh.off mesh.off --blobs 200 --no-cache --save-scene s.json", 74, "File too large\n");
}

TEST_F(Faults, EachCallThatFailsLeavesNothing) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the leak sanitizer does not run below strace";
#endif
  if (shell("strace -f -o trace.txt true 2>/dev/null && rm trace.txt") != 0) GTEST_SKIP() << "strace does not work here";
  for (const std::string call : {"fsync:error=EIO:when=1", "fsync:error=EIO:when=2", "renameat:error=EIO"})
    expect("strace -f -o /dev/null -e inject=" + call + " $KELPIE render scene.json -f 1 --progress none -o a.exr", 74,
           "error: a.exr: Input/output error\n");
}

// --- ffmpeg ---

TEST_F(Faults, AnFfmpegThatWritesNothingIsAFailure) {
  make_frame();
  ASSERT_EQ(shell("mkdir bin && printf '#!/bin/sh\\ncat >/dev/null\\n' >bin/ffmpeg && chmod +x bin/ffmpeg"), 0);
  expect("PATH=$PWD/bin:$PATH $KELPIE movie frame.exr -o a.mp4", 74, "error: a.mp4: ffmpeg ended well, but wrote nothing\n");
}

TEST_F(Faults, ASignalEndsFfmpegToo) {
  make_frame();
  ASSERT_EQ(shell("mkdir bin && printf '#!/bin/sh\\necho $$ >pid\\nexec sleep 60\\n' >bin/ffmpeg && chmod +x bin/ffmpeg"), 0);
  const Outcome o =
      timed("PATH=$PWD/bin:$PATH; $KELPIE movie frame.exr -o a.mp4 & until test -s pid; do sleep 0.1; done; kill -TERM $!; wait $!");
  EXPECT_EQ(o.status, 128 + SIGTERM);
  EXPECT_NE(shell("kill -0 $(cat pid) 2>/dev/null"), 0) << "ffmpeg is still there";
  EXPECT_FALSE(fs::exists(folder_ / "a.mp4"));
  EXPECT_EQ(shell("ls -A | grep part"), 1) << "a part is left";
}

// --- memory ---

TEST_F(Faults, OutOfMemoryIsSaidWhereverItStrikes) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need an address space without limits";
#endif
  make_frame();
  int ran_out = 0;
  for (const std::string arguments :
       {"render scene.json -f 1 -o a.exr", "view frame.exr -o a.png --width 3000", "fit mesh.off -o a.ply --blobs 100 --no-cache"})
    for (int megabytes = 120; megabytes <= 820; megabytes += 70) {
      const Outcome o = timed("ulimit -v " + std::to_string(1000 * megabytes) + "; $KELPIE " + arguments);
      if (o.status == 0 || o.status == 127) continue; // it suffices; or not even for the dynamic linker
      ++ran_out;
      EXPECT_EQ(o.status, 33) << megabytes << " MB: " << arguments << "\n" << o.err;
      EXPECT_NE(o.err.find("error: out of memory"), std::string::npos) << o.err;
    }
  EXPECT_GT(ran_out, 2);
}

// --- the module ---

// It is found beside the program and where it is installed; without it all works that needs no pictures.
TEST_F(Faults, AModuleThatIsMissingOrBrokenIsSaid) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "under sanitizers there is no module";
#endif
  make_frame();
  ASSERT_EQ(shell("mkdir -p bin lib/kelpie && cp $KELPIE bin"), 0);
  EXPECT_EQ(timed("bin/kelpie render scene.json -f 1 -o b.exr --progress none && cmp b.exr frame.exr").status, 0);
  expect("bin/kelpie view frame.exr -o a.png", 70, "error: kelpie_images.so is missing, which");
  const std::string module = "$(dirname $KELPIE)/lib/kelpie/kelpie_images.so";
  for (const std::string folder : {"lib/kelpie", "bin"}) {
    ASSERT_EQ(shell("echo no module >" + folder + "/kelpie_images.so"), 0);
    expect("bin/kelpie view frame.exr -o a.png", 70, "error: cannot load ");
    ASSERT_EQ(shell("cp " + module + " " + folder), 0);
    EXPECT_EQ(timed("bin/kelpie view frame.exr -o a.png && rm a.png").status, 0) << folder;
  }
}

// --- frames that are written while the next is rendered ---

TEST_F(Faults, AFrameThatCannotBeWrittenEndsTheSequence) {
  ASSERT_EQ(shell("mkdir -p a.0002.exr"), 0);
  const Outcome o = timed("$KELPIE render scene.json -f 1-9 --spp 64 -o a.####.exr --progress plain");
  EXPECT_EQ(o.status, 74) << o.err;
  EXPECT_NE(o.err.find("wrote a.0001.exr\n"), std::string::npos) << o.err;
  EXPECT_NE(o.err.find("error: a.0002.exr: is a folder; name a file\n"), std::string::npos) << o.err;
  EXPECT_EQ(o.err.find("wrote a.0003.exr"), std::string::npos) << o.err;
  EXPECT_EQ(shell("ls -A | grep -q 'part\\|a.0003'"), 1) << "neither a part nor the frame that was rendered meanwhile";
}

} // namespace
} // namespace kelpie
