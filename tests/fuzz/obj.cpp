#include "tests/fuzz/mesh_target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return kelpie::try_mesh(data, size, "fuzz.obj", [](std::string_view bytes, const std::string& name, kelpie::Diagnostics& diagnostics) {
    return kelpie::read_obj(bytes, name, diagnostics);
  });
}
