#include "renderer/output/deflate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>

#include <zlib.h>

namespace kelpie {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr size_t k_shortest_run = 4, k_longest_run = 258;
constexpr size_t k_most_symbols = 32768; // of a block
constexpr int k_end_of_block = 256, k_lengths = 257, k_literals = 286;
constexpr size_t k_longest_code = 15;

/// How many bits of what value (the first bit is the lowest).
struct Bits {
  uint32_t value = 0;
  uint32_t count = 0;
};

/// A growing stream of bits, in room that must suffice.
class BitWriter {
public:
  explicit BitWriter(unsigned char* out) : out_(out) {}

  /// At most 56 bits at a time, between two calls of flush().
  void put(Bits bits) {
    buffer_ |= uint64_t(bits.value) << count_;
    count_ += bits.count;
  }
  /// Writes whole bytes; up to 8 bytes behind them are overwritten.
  void flush() {
    std::memcpy(out_, &buffer_, 8);
    out_ += count_ >> 3;
    buffer_ >>= count_ & ~7u;
    count_ &= 7;
  }
  /// Zeros up to the next whole byte, which is where the result points.
  unsigned char* align() {
    count_ = (count_ + 7) & ~7u;
    flush();
    return out_;
  }
  void skip(size_t bytes) { out_ += bytes; }

private:
  unsigned char* out_;
  uint64_t buffer_ = 0;
  uint32_t count_ = 0;
};

/// The length of the code of each symbol that occurs, after Huffman, and none longer than `longest`. A single symbol gets one bit.
template <size_t k_size>
std::array<uint8_t, k_size> lengths_of_codes(const std::array<uint32_t, k_size>& counts, size_t longest) {
  struct Node {
    uint32_t count;
    uint16_t parent;
  };
  std::array<Node, 2 * k_size> nodes;
  std::array<uint16_t, k_size> symbols;
  size_t n = 0;
  for (size_t s = 0; s < k_size; ++s)
    if (counts[s] > 0) symbols[n++] = static_cast<uint16_t>(s);
  std::array<uint8_t, k_size> lengths{};
  if (n == 0) return lengths;
  if (n == 1) return lengths[symbols[0]] = 1, lengths;
  std::sort(symbols.begin(), symbols.begin() + static_cast<std::ptrdiff_t>(n),
            [&](uint16_t a, uint16_t b) { return counts[a] != counts[b] ? counts[a] < counts[b] : a < b; });
  for (size_t i = 0; i < n; ++i) nodes[i] = {counts[symbols[i]], 0};
  // Leaves come in ascending order, and so do the inner nodes that are made of the two least.
  size_t leaf = 0, inner = n;
  for (size_t made = n; made < 2 * n - 1; ++made) {
    uint32_t sum = 0;
    for (int k = 0; k < 2; ++k) {
      const size_t least = inner == made || (leaf < n && nodes[leaf].count <= nodes[inner].count) ? leaf++ : inner++;
      nodes[least].parent = static_cast<uint16_t>(made);
      sum += nodes[least].count;
    }
    nodes[made] = {sum, 0};
  }
  std::array<uint16_t, 2 * k_size> depths;
  std::array<size_t, 32> of_length{};
  depths[2 * n - 2] = 0;
  for (size_t i = 2 * n - 2; i-- > 0;) {
    depths[i] = static_cast<uint16_t>(depths[nodes[i].parent] + 1);
    if (i < n) ++of_length[std::min<size_t>(depths[i], longest)];
  }
  // Where codes were cut, shorter ones are made longer until there is room for all (Kraft's sum).
  size_t sum = 0;
  for (size_t l = 1; l <= longest; ++l) sum += of_length[l] << (longest - l);
  for (; sum > size_t(1) << longest; --sum) {
    size_t l = longest - 1;
    while (of_length[l] == 0) --l;
    --of_length[l], of_length[l + 1] += 2, --of_length[longest];
  }
  size_t i = 0;
  for (size_t l = longest; l > 0; --l)
    for (size_t k = 0; k < of_length[l]; ++k) lengths[symbols[i++]] = static_cast<uint8_t>(l);
  return lengths;
}

/// Canonical codes of these lengths, as deflate numbers them.
template <size_t k_size>
std::array<Bits, k_size> codes_of(const std::array<uint8_t, k_size>& lengths) {
  std::array<uint32_t, 16> of_length{}, next{};
  for (const uint8_t l : lengths) ++of_length[l];
  of_length[0] = 0;
  for (size_t l = 1; l < 16; ++l) next[l] = (next[l - 1] + of_length[l - 1]) << 1;
  std::array<Bits, k_size> codes;
  for (size_t s = 0; s < k_size; ++s) {
    uint32_t code = lengths[s] ? next[lengths[s]]++ : 0, reversed = 0;
    for (size_t b = 0; b < lengths[s]; ++b, code >>= 1) reversed = reversed << 1 | (code & 1);
    codes[s] = {reversed, lengths[s]};
  }
  return codes;
}

/// What deflate writes for a run: a symbol, and bits behind it.
struct RunLength {
  uint16_t symbol = 0;
  Bits extra;
};

constexpr std::array<RunLength, k_longest_run + 1> make_run_lengths() {
  std::array<RunLength, k_longest_run + 1> lengths{};
  size_t length = 3;
  for (uint16_t symbol = k_lengths; symbol < 285; ++symbol) {
    const uint32_t extra = symbol < 265 ? 0 : (symbol - 261u) / 4;
    for (uint32_t i = 0; i < 1u << extra && length < k_longest_run; ++i) lengths[length++] = {symbol, {i, extra}};
  }
  lengths[k_longest_run] = {285, {0, 0}};
  return lengths;
}

constexpr std::array<RunLength, k_longest_run + 1> k_run_lengths = make_run_lengths();

/// Up to k_most_symbols of a block: literals, and 256 + the length of a run.
class Block {
public:
  /// Takes bytes from `at` on; returns where the next block begins.
  size_t fill(std::span<const unsigned char> bytes, size_t at) {
    counts_ = {}, others_ = {};
    count_ = bits_of_runs_ = 0, begin_ = at;
    while (at < bytes.size() && count_ < k_most_symbols) {
      if (const size_t run = run_at(bytes, at)) {
        symbols_[count_++] = static_cast<uint16_t>(256 + run);
        ++counts_[k_run_lengths[run].symbol];
        bits_of_runs_ += k_run_lengths[run].extra.count + 1;
        at += run;
      } else {
        ++(count_ % 2 ? counts_ : others_)[bytes[at]]; // two tables: equal bytes do not wait for one another
        symbols_[count_++] = bytes[at++];
      }
    }
    for (size_t s = 0; s < k_literals; ++s) counts_[s] += others_[s];
    counts_[k_end_of_block] = 1;
    return end_ = at;
  }

  void write(std::span<const unsigned char> bytes, BitWriter& out) const;

private:
  /// How many bytes from `at` on equal the one before; 0 where a run is not worth it.
  static size_t run_at(std::span<const unsigned char> bytes, size_t at) {
    uint32_t next;
    if (at == 0 || at + sizeof next > bytes.size()) return 0;
    std::memcpy(&next, &bytes[at], sizeof next);
    if (next != bytes[at - 1] * 0x01010101u) return 0;
    const size_t most = std::min(k_longest_run, bytes.size() - at);
    size_t run = k_shortest_run;
    while (run < most && bytes[at + run] == bytes[at - 1]) ++run;
    return run;
  }

  std::array<uint16_t, k_most_symbols> symbols_;
  std::array<uint32_t, k_literals> counts_, others_;
  size_t count_, bits_of_runs_, begin_, end_;
};

/// The lengths of all codes as deflate has them at the head of a block.
void write_lengths(const std::array<uint8_t, k_literals>& lengths, BitWriter& out) {
  constexpr std::array<uint8_t, 19> k_order{16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  size_t count = k_literals;
  while (lengths[count - 1] == 0) --count;
  // Lengths, and runs of zeros (17 and 18); the one of the only distance, 1, is last.
  struct Part {
    uint8_t symbol;
    Bits extra;
  };
  std::array<Part, k_literals + 1> parts;
  std::array<uint32_t, 19> counts{};
  size_t n = 0;
  for (size_t i = 0; i < count;) {
    size_t zeros = 0;
    while (i + zeros < count && zeros < 138 && lengths[i + zeros] == 0) ++zeros;
    if (zeros < 3)
      parts[n] = {lengths[i], {}}, ++i;
    else
      parts[n] = zeros < 11 ? Part{17, {uint32_t(zeros - 3), 3}} : Part{18, {uint32_t(zeros - 11), 7}}, i += zeros;
    ++counts[parts[n++].symbol];
  }
  parts[n++] = {1, {}}, ++counts[1];
  const auto code_lengths = lengths_of_codes(counts, 7);
  const auto codes = codes_of(code_lengths);
  size_t written = k_order.size();
  while (code_lengths[k_order[written - 1]] == 0) --written;
  out.put({uint32_t(count - 257), 5}), out.put({0, 5}), out.put({uint32_t(written - 4), 4}), out.flush();
  for (size_t i = 0; i < written; ++i) out.put({code_lengths[k_order[i]], 3}), out.flush();
  for (size_t i = 0; i < n; ++i) out.put(codes[parts[i].symbol]), out.put(parts[i].extra), out.flush();
}

void Block::write(std::span<const unsigned char> bytes, BitWriter& out) const {
  const auto lengths = lengths_of_codes(counts_, k_longest_code);
  size_t bits = bits_of_runs_;
  for (size_t s = 0; s < k_literals; ++s) bits += counts_[s] * lengths[s];
  const bool is_last = end_ == bytes.size();
  if (bits / 8 >= end_ - begin_ && end_ - begin_ < 65536) {
    out.put({is_last, 3});
    unsigned char* const to = out.align();
    const auto size = static_cast<uint16_t>(end_ - begin_), inverse = static_cast<uint16_t>(~size);
    std::memcpy(to, &size, 2), std::memcpy(to + 2, &inverse, 2), std::memcpy(to + 4, &bytes[begin_], size);
    return out.skip(4 + size_t(size));
  }
  const auto codes = codes_of(lengths);
  out.put({is_last | 2u << 1, 3}); // a block with codes of its own
  write_lengths(lengths, out);
  // A run's distance is 1, of which the code is one bit, 0.
  std::array<Bits, 256 + k_longest_run + 1> of_symbol{};
  std::copy_n(codes.begin(), 256, of_symbol.begin());
  for (size_t run = k_shortest_run; run <= k_longest_run; ++run) {
    const auto& [symbol, extra] = k_run_lengths[run];
    of_symbol[256 + run] = {codes[symbol].value | extra.value << codes[symbol].count, codes[symbol].count + extra.count + 1};
  }
  for (size_t i = 0; i + 1 < count_; i += 2) out.put(of_symbol[symbols_[i]]), out.put(of_symbol[symbols_[i + 1]]), out.flush();
  if (count_ % 2) out.put(of_symbol[symbols_[count_ - 1]]);
  out.put(codes[k_end_of_block]), out.flush();
}

} // namespace

void deflate_runs(std::span<const unsigned char> bytes, std::vector<unsigned char>& zipped) {
  // No block takes more than it does when it is stored, but for its head and what is behind the last flush.
  zipped.resize(bytes.size() + bytes.size() / k_most_symbols * 512 + 1024);
  zipped[0] = 0x78, zipped[1] = 0x01;
  BitWriter out(zipped.data() + 2);
  const auto block = std::make_unique_for_overwrite<Block>();
  size_t at = 0;
  do {
    at = block->fill(bytes, at);
    block->write(bytes, out);
  } while (at < bytes.size());
  unsigned char* end = out.align();
  const auto sum = static_cast<uint32_t>(adler32(adler32(0, nullptr, 0), bytes.data(), static_cast<uInt>(bytes.size())));
  for (const int shift : {24, 16, 8, 0}) *end++ = static_cast<unsigned char>(sum >> shift);
  zipped.resize(static_cast<size_t>(end - zipped.data()));
}

} // namespace kelpie
