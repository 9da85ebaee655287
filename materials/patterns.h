// Every kind of pattern. A kind is one header: its parameters, as scene files describe it, its phases and their profile.
#pragma once

#include "materials/patterns/checker.h"
#include "materials/patterns/granite.h"
#include "materials/patterns/marble.h"
#include "materials/patterns/wood.h"

namespace kelpie {

using PatternKinds = KindList<Marble, Wood, Granite, Checker>;

} // namespace kelpie
