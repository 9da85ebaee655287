// Any field along a ray, by piecewise interpolation of degree 6.
//
// Not exact, so it is built to be trusted where a verdict is made: a stretch is halved until it is short
// against the smallest leaf that may live there (found by distances, not by sampling, so that nothing
// thin is stepped over) and until its polynomial agrees with the field at twice as many places, by a
// tolerance that shrinks with the field's distance from the threshold.
#pragma once

#include "tests/reference/along_ray.h"

namespace reference {

Profile interpolated_along_ray(const Node&, const Ray&, double t_from, double t_to, double threshold);

} // namespace reference
