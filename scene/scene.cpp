#include "scene/scene.h"

#include "base/one_of.h"

namespace kelpie {

template struct OneOf<GeometryKinds, AnimatedMode>;
template struct OneOf<GeometryKinds, SampledMode>;
template struct OneOf<LightKinds, AnimatedMode>;
template struct OneOf<LightKinds, SampledMode>;

} // namespace kelpie
