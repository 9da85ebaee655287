// The kinds of field that are made by morphing.
#pragma once

#include "morph/liquid/liquid.h"

namespace kelpie {

using MorphFolderKinds = KindList<Liquid>;

} // namespace kelpie
