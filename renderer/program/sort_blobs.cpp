#include "renderer/program/sort_blobs.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace kelpie {

namespace {

/// Fewer than these stay in a processor's nearest cache anyway.
constexpr size_t k_few = 1000;
/// Bits of a place along each axis.
constexpr uint32_t k_bits = 10;

/// The bits of a number below 2^k_bits, with two zeros after each.
uint32_t spread(uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

/// Where each blob lies along the curve of Morton (1966), which visits the cells of an octree in order.
std::vector<uint32_t> places_along_curve(const BlobArrays& blobs) {
  std::vector<uint32_t> places(blobs.size(), 0);
  uint32_t shift = 0;
  for (const std::vector<float>* at : {&blobs.x, &blobs.y, &blobs.z}) {
    const auto [low, high] = std::minmax_element(at->begin(), at->end());
    const double start = *low, extent = *high - start, scale = extent > 0 ? ((1u << k_bits) - 1) / extent : 0;
    for (size_t i = 0; i < places.size(); ++i) places[i] |= spread(static_cast<uint32_t>(((*at)[i] - start) * scale)) << shift;
    ++shift;
  }
  return places;
}

/// The numbers of the keys, below 2^(3 k_bits), in ascending order: by counting, ten bits after ten bits.
std::vector<uint32_t> sorted(const std::vector<uint32_t>& keys) {
  std::vector<uint32_t> order(keys.size()), next(keys.size());
  std::iota(order.begin(), order.end(), 0u);
  for (uint32_t shift = 0; shift < 3 * k_bits; shift += k_bits) {
    const auto digit = [&](uint32_t i) { return keys[i] >> shift & ((1u << k_bits) - 1); };
    std::array<uint32_t, (1u << k_bits) + 1> ends{};
    for (const uint32_t i : order) ++ends[digit(i) + 1];
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    for (const uint32_t i : order) next[ends[digit(i)]++] = i;
    order.swap(next);
  }
  return order;
}

template <class Value>
void reorder(const std::vector<uint32_t>& order, std::vector<Value>& values) {
  std::vector<Value> out(values.size());
  for (size_t i = 0; i < out.size(); ++i) out[i] = values[order[i]];
  values = std::move(out);
}

} // namespace

void sort_blobs(std::span<FieldProgram> moments, std::vector<LeafIdentity>& identities) {
  const FieldProgram& first = moments[0];
  if (first.blobs.size() < k_few) return;
  const std::vector<uint32_t> order = sorted(places_along_curve(first.blobs));
  std::vector<uint32_t> number(order.size());
  for (uint32_t i = 0; i < order.size(); ++i) number[order[i]] = i;
  std::vector<uint32_t> list = first.code.blobs;
  for (uint32_t& i : list) i = number[i];
  for (const Instruction& step : first.code.steps)
    if (step.kind == Instruction::Kind::blobs) std::sort(list.begin() + step.first, list.begin() + step.first + step.count);
  for (FieldProgram& program : moments) {
    program.blobs.for_each_list([&](std::vector<float>& values) { reorder(order, values); });
    program.code.blobs = list;
  }
  reorder(order, identities);
}

} // namespace kelpie
