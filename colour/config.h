// The OCIO config in force. Internal to colour/: nothing else sees OCIO's types.
#pragma once

#include <functional>
#include <string>

#include <OpenColorIO/OpenColorIO.h>

namespace kelpie::colour {

namespace OCIO = OCIO_NAMESPACE;

/// The config in force: `--ocio`, $OCIO, ours. Throws Error missing_input.
OCIO::ConstConfigRcPtr config_in_force();

/// Our own config: ACES with built-in transforms, no files.
OCIO::ConstConfigRcPtr own_config();

/// From a space or role of the config in force, or failing that of ours, to scene_linear.
OCIO::ConstCPUProcessorRcPtr scene_linear_from(const std::string& space_or_role);
/// The other way round.
OCIO::ConstCPUProcessorRcPtr scene_linear_to(const std::string& space_or_role);

/// How a user recognises the config in force: its path, or "kelpie's own OCIO config".
std::string config_name();

/// Applies a processor to interleaved float pixels, in bands on all threads. Every pixel is computed
/// on its own, so the bands do not show.
void apply_in_bands(const OCIO::CPUProcessor&, float* pixels, size_t pixel_count, int channels);

} // namespace kelpie::colour
