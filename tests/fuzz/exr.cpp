// What the bytes of a frame may lead to: a picture whose channels are all there, or an Error.
#include <cstdlib>

#include "base/error.h"
#include "renderer/output/exr.h"
#include "renderer/output/file_hash.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::vector<unsigned char> bytes(data, data + size);
  kelpie::is_sealed(bytes);
  try {
    const kelpie::DecodedFrame frame = kelpie::decode_exr(bytes, "fuzz.exr");
    for (const kelpie::FrameChannel& channel : frame.image.channels)
      if (channel.pixels.size() != frame.image.data_window.area()) std::abort();
  } catch (const kelpie::Error& e) {
    if (e.status != kelpie::ExitStatus::bad_data) std::abort();
  }
  return 0;
}
