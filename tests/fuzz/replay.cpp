// Stands in for libFuzzer's main: runs a target with each file of the folders that are named. Options are libFuzzer's, and mean nothing
// here.
#include <cstdint>
#include <cstdio>
#include <filesystem>

#include "base/file_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

int main(int count, char** arguments) {
  size_t inputs = 0;
  for (int i = 1; i < count; ++i) {
    if (arguments[i][0] == '-') continue;
    for (const auto& entry : std::filesystem::directory_iterator(arguments[i])) {
      std::puts(entry.path().c_str()); // the last one that is named is to blame
      std::fflush(stdout);
      const std::string bytes = kelpie::read_file_bytes(entry.path().string());
      LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
      ++inputs;
    }
  }
  return inputs > 0 ? 0 : 1;
}
