// A field along a ray, exactly: a piecewise polynomial of t.
//
// Every falloff is a polynomial of d^2, and d^2 to a point or a segment is quadratic in t between the
// ends of supports and of segments. Sums and affine warps keep that; maxima and minima add breaks
// where their operands cross. So nothing has to be marched, and nothing that is thin is stepped over.
#pragma once

#include <vector>

#include "tests/reference/bernstein.h"
#include "tests/reference/field.h"

namespace reference {

/// The polynomial on [from, to] of the ray.
struct Piece {
  double from, to;
  Polynomial f;
};

/// Contiguous pieces, in order.
using Profile = std::vector<Piece>;

/// The field on [t_from, t_to] of the ray. Exact as said above for points and segments under the operators
/// and warps that keep polynomials; any other field by interpolation (tests/reference/interpolate.h).
Profile along_ray(const Node&, const Ray&, double t_from, double t_to, double threshold);

double value(const Profile&, double t);

struct Span {
  double from, to;
};

/// Where the field is greater than `level`: disjoint, ascending.
std::vector<Span> above(const Profile&, double level);

/// Whether the field comes up to `level` anywhere in [from, to].
bool reaches(const Profile&, double level, double from, double to);

} // namespace reference
