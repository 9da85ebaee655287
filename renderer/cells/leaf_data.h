// Memory for the numbers of cells.
#pragma once

#include <algorithm>
#include <iterator>
#include <memory>
#include <vector>

namespace kelpie {

/// Numbers, a stretch for each cell. They stay where they are while more are added: where there are many, copying them takes
/// as long as making them.
class LeafData {
public:
  /// Room for so many numbers, which are anything at first.
  float* add(size_t count) {
    if (count > left_) {
      left_ = std::max(count, std::clamp(used_, k_least, k_most));
      next_ = chunks_.emplace_back(new float[left_]).get();
    }
    float* const at = next_;
    next_ += count, left_ -= count, used_ += count;
    return at;
  }
  /// Gives back what was added last.
  void drop(size_t count) { next_ -= count, left_ += count, used_ -= count; }
  /// Takes all that another has, which has nothing then.
  void join(LeafData&& other) {
    chunks_.insert(chunks_.end(), std::make_move_iterator(other.chunks_.begin()), std::make_move_iterator(other.chunks_.end()));
    used_ += other.used_;
    other = {};
  }
  /// Of what was added.
  size_t bytes() const { return used_ * sizeof(float); }

private:
  static constexpr size_t k_least = 1024, k_most = size_t(1) << 18; ///< numbers in a chunk

  std::vector<std::unique_ptr<float[]>> chunks_;
  float* next_ = nullptr;
  size_t left_ = 0, used_ = 0; ///< of the last chunk; of all
};

} // namespace kelpie
