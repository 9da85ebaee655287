// Every kind of pattern. A kind is one header: its parameters, as scene files describe it, and its formula.
#pragma once

#include "materials/pattern.h"

namespace kelpie {

using PatternKinds = KindList<>;

} // namespace kelpie
