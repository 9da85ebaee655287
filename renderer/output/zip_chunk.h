// EXR's ZIP compression, made cheap for what renderers write.
//
// Of a frame much is noise (the low bytes of floats, light of few samples), in which strings that occurred before are hardly found however
// long they are sought: so libdeflate's quickest level does.
#pragma once

#include <span>
#include <vector>

struct libdeflate_compressor;

namespace kelpie {

/// How many rows make a chunk.
inline constexpr size_t k_rows_of_chunk = 16;

class ChunkZipper {
public:
  ChunkZipper();
  ~ChunkZipper();
  ChunkZipper(const ChunkZipper&) = delete;

  /// The rows of a chunk as they stand in the file, good until the next call; where nothing is gained, the rows themselves.
  std::span<const unsigned char> zip(std::span<const unsigned char> rows);

private:
  void reorder(std::span<const unsigned char> rows);

  libdeflate_compressor* compressor_;
  std::vector<unsigned char> reordered_, differences_, zipped_;
};

} // namespace kelpie
