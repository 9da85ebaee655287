#include "tests/fuzz/mesh_target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return kelpie::try_mesh(data, size, "fuzz.stl", [](std::string_view bytes, const std::string& name, kelpie::Diagnostics&) {
    return kelpie::read_stl(bytes, name);
  });
}
