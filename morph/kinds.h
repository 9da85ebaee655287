// The kinds of field that are made by morphing.
#pragma once

#include "morph/feature/metamorphosis.h"
#include "morph/liquid/liquid.h"

namespace kelpie {

using MorphFolderKinds = KindList<Liquid, Metamorphosis>;

} // namespace kelpie
