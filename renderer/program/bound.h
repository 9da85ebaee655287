// Bounds of a program over a box, and what of it can matter there.
#pragma once

#include "renderer/program/evaluate.h"

namespace kelpie {

/// Bounds every step of `code` over `box` into `ranges` (the last one is the field's) and returns the code
/// with only the blobs that reach the box. Sound: the natural interval extension, met with the mean-value
/// form f(centre) ± sum |f_i| h_i, whose gradient is bounded by interval arithmetic too, so that nobody
/// states a Lipschitz constant.
Code bound(const FieldProgram& program, const Code& code, const Box3d& box, std::vector<Interval>& ranges);

/// The part of `code` that decides the sign of field - threshold in a box over which its steps lie in
/// `ranges`. The surface and its normals there are exactly those of the whole; with Demand::value the field is, too.
Code prune(const FieldProgram& program, const Code& code, std::span<const Interval> ranges, Demand demand = Demand::sign);

} // namespace kelpie
