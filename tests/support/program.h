// Runs the program as a user does.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

namespace kelpie {

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A new folder, the working directory of each run, removed at the end.
class ProgramTest : public testing::Test {
protected:
  struct Outcome {
    int status = -1; ///< the exit status; 128 + signal
    std::string out, err;
  };

  ProgramTest() {
    std::string name = testing::TempDir() + "kelpie_program_XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~ProgramTest() override { std::filesystem::remove_all(folder_); }

  /// `arguments` as a shell reads them.
  Outcome kelpie(const std::string& arguments) const {
    const std::string command =
        "cd '" + folder_.string() + "' && '" KELPIE_PROGRAM "' " + arguments + " >stdout.txt 2>stderr.txt </dev/null";
    const int status = std::system(command.c_str());
    Outcome o{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text_of(folder_ / "stdout.txt"),
              text_of(folder_ / "stderr.txt")};
    std::filesystem::remove(folder_ / "stdout.txt"), std::filesystem::remove(folder_ / "stderr.txt");
    return o;
  }

  /// A line for the shell, in the folder, with the program as `$KELPIE`; its exit status, 128 + signal.
  int shell(const std::string& line) const {
    setenv("KELPIE", KELPIE_PROGRAM, 1);
    const std::string command = "cd '" + folder_.string() + "' || exit 1\n" + line;
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  size_t file_count() const { return std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator()); }

  std::filesystem::path folder_;
};

} // namespace kelpie
