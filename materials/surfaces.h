// Every kind of surface. A kind is one header: its parameters, as scene files describe it, and its reflectance model.
#pragma once

#include "materials/matte.h"
#include "materials/metal.h"

namespace kelpie {

using SurfaceKinds = KindList<Matte, Metal, OpenPbr>;

} // namespace kelpie
