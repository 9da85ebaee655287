// Every kind of surface. A kind is one header: parameters, as scene files describe it, and the surface that they say, `surface()`.
#pragma once

#include "materials/glass.h"
#include "materials/matte.h"
#include "materials/metal.h"
#include "materials/openpbr.h"

namespace kelpie {

using SurfaceKinds = KindList<Matte, Metal, Glass, OpenPbr>;

} // namespace kelpie
