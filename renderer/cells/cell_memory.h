// Memory for what cells consist of.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

namespace kelpie {

/// Holds numbers and small structs of any number of cells. They stay where they are while more are added, so cells point to
/// them; copying them into a growing list would take as long as making them.
class CellMemory {
public:
  /// Room for so many numbers, which are anything at first.
  float* add_numbers(size_t count) { return reinterpret_cast<float*>(take(count * sizeof(float))); }

  /// A copy of a list.
  template <class T>
  std::span<const T> copy(std::span<const T> values) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= k_alignment);
    if (values.empty()) return {};
    T* const to = reinterpret_cast<T*>(take(values.size_bytes()));
    std::uninitialized_copy(values.begin(), values.end(), to);
    return {to, values.size()};
  }
  template <class T>
  std::span<const T> copy(const std::vector<T>& values) {
    return copy(std::span<const T>(values));
  }
  /// A copy of one value.
  template <class T>
  const T* keep(const T& value) {
    return copy(std::span<const T>(&value, 1)).data();
  }

  /// Gives back the numbers that were added last.
  void drop_numbers(size_t count) {
    const size_t bytes = rounded(count * sizeof(float));
    next_ -= bytes, left_ += bytes, used_ -= bytes;
  }
  /// Takes all that another has, which has nothing then.
  void join(CellMemory&& other) {
    chunks_.insert(chunks_.end(), std::make_move_iterator(other.chunks_.begin()), std::make_move_iterator(other.chunks_.end()));
    used_ += other.used_;
    other = {};
  }
  /// Of what was added.
  size_t bytes() const { return used_; }

private:
  static constexpr size_t k_alignment = 8;
  static constexpr size_t k_least = size_t(1) << 12, k_most = size_t(1) << 20; ///< bytes of a chunk

  static constexpr size_t rounded(size_t bytes) { return (bytes + k_alignment - 1) / k_alignment * k_alignment; }

  std::byte* take(size_t bytes) {
    bytes = rounded(bytes);
    if (bytes > left_) {
      left_ = std::max(bytes, std::clamp(used_, k_least, k_most));
      next_ = chunks_.emplace_back(new std::byte[left_]).get();
    }
    std::byte* const at = next_;
    next_ += bytes, left_ -= bytes, used_ += bytes;
    return at;
  }

  std::vector<std::unique_ptr<std::byte[]>> chunks_;
  std::byte* next_ = nullptr;
  size_t left_ = 0, used_ = 0; ///< bytes of the last chunk; of all
};

} // namespace kelpie
