// What complex primitives sweep along a curve: a ball or a disc that changes its size.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "base/box.h"
#include "base/kind.h"
#include "base/spline.h"

namespace kelpie {

template <>
struct EnumNames<SplineKind> {
  static constexpr std::array<std::pair<std::string_view, SplineKind>, 4> values{{{"catmull_rom", SplineKind::catmull_rom},
                                                                                  {"b_spline", SplineKind::b_spline},
                                                                                  {"bezier", SplineKind::bezier},
                                                                                  {"cubic_beziers", SplineKind::cubic_beziers}}};
};

/// A place (x, y, z) and a width (w).
using WidePoint = glm::dvec4;

/// A curve in spans, each a polynomial.
class Sweep {
public:
  /// Of at least one point.
  Sweep(SplineKind, std::vector<WidePoint> points);

  int spans() const { return curve_.degree() > 0 ? curve_.pieces() : 0; }
  /// The place k of n steps along a span; spans share their ends to the last bit.
  WidePoint at(int span, uint32_t k, uint32_t n) const;
  /// A bound of the second derivative along a span, place and width together.
  double bend(int span) const;
  /// Around the places of a span.
  Box3d box(int span) const;

private:
  Spline<WidePoint> curve_;
};

/// Higher degrees drown in rounding.
inline constexpr size_t k_most_bezier_points = 24;

/// What is wrong with so many points for a curve, if anything.
std::optional<ParameterProblem> problem_of_curve(SplineKind, std::string_view parameter, size_t count);

} // namespace kelpie
