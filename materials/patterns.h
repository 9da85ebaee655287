// Every kind of pattern. A kind is one header: its parameters, as scene files describe it, its phases and their profile.
#pragma once

#include "materials/patterns/brushed.h"
#include "materials/patterns/cells.h"
#include "materials/patterns/checker.h"
#include "materials/patterns/dents.h"
#include "materials/patterns/giraffe.h"
#include "materials/patterns/gradient.h"
#include "materials/patterns/granite.h"
#include "materials/patterns/leather.h"
#include "materials/patterns/leopard.h"
#include "materials/patterns/marble.h"
#include "materials/patterns/rust.h"
#include "materials/patterns/spots.h"
#include "materials/patterns/stone.h"
#include "materials/patterns/strata.h"
#include "materials/patterns/stripes.h"
#include "materials/patterns/wood.h"

namespace kelpie {

using PatternKinds = KindList<Marble, Wood, Granite, Stone, Rust, Leather, Leopard, Giraffe, Checker, Stripes, Gradient, Strata, Brushed,
                              Cells, Spots, Dents>;

} // namespace kelpie
