// A value that changes over time, however it is described.
#pragma once

#include <vector>

namespace kelpie {

template <class T>
class TimeFunction {
public:
  virtual ~TimeFunction() = default;

  /// The value at a frame (fractions are moments between frames). From any thread. Throws an Error where there is none that may be used.
  virtual T at(double frame) const = 0;
  /// The frames at which a check of several values together should look, ascending: those of keys, or of a formula those for which it
  /// was checked itself. At least one.
  virtual std::vector<double> frames() const = 0;
  /// Where between two frames it need not be smooth, or turns back: no straight line is near it there.
  virtual std::vector<double> breaks(double from, double to) const = 0;
};

} // namespace kelpie
