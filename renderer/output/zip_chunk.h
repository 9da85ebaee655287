// EXR's ZIP compression, made cheap for what renderers write.
//
// Any reader of EXR reads it, but it is not what zlib's levels would make: of a frame, much is noise (the low bytes of floats, light of few
// samples), in which strings that occurred before are hardly found however long they are sought. So only runs are: in a quarter of the
// time, for files that are larger by 6 to 10 %.
#pragma once

#include <span>
#include <vector>

namespace kelpie {

/// How many rows make a chunk.
inline constexpr size_t k_rows_of_chunk = 16;

class ChunkZipper {
public:
  /// The rows of a chunk as they stand in the file, good until the next call; where nothing is gained, the rows themselves.
  std::span<const unsigned char> zip(std::span<const unsigned char> rows);

private:
  void reorder(std::span<const unsigned char> rows);

  std::vector<unsigned char> reordered_, differences_, zipped_;
};

} // namespace kelpie
