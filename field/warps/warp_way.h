// Which way a warp is looked at.
#pragma once

namespace kelpie {

enum class WarpWay { to_child, to_parent };

} // namespace kelpie
