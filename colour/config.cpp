#include "colour/config.h"

#include <cstdlib>
#include <mutex>
#include <sstream>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file_descriptor.h"
#include "base/parallel.h"
#include "colour/spaces.h"

namespace kelpie::colour {

namespace {

// Scene reference: ACES2065-1; display reference: CIE XYZ, D65. The first view is the default one.
constexpr const char* k_own_config = R"(ocio_profile_version: 2
name: kelpie
search_path: ""
strictparsing: true
roles:
  scene_linear: ACEScg
  aces_interchange: ACES2065-1
  cie_xyz_d65_interchange: CIE XYZ D65
  rendering: ACEScg
  color_picking: sRGB
  texture_paint: sRGB
  matte_paint: sRGB
  data: raw
  default: ACEScg
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  sRGB display:
    - !<View> {name: ACES, view_transform: ACES SDR video, display_colorspace: sRGB display}
    - !<View> {name: sRGB, view_transform: plain, display_colorspace: sRGB display}
    - !<View> {name: raw, colorspace: raw}
view_transforms:
  - !<ViewTransform>
    name: ACES SDR video
    from_scene_reference: !<BuiltinTransform> {style: ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0}
  - !<ViewTransform>
    name: plain
    from_scene_reference: !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}
display_colorspaces:
  - !<ColorSpace>
    name: CIE XYZ D65
  - !<ColorSpace>
    name: sRGB display
    encoding: sdr-video
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
colorspaces:
  - !<ColorSpace>
    name: ACES2065-1
    aliases: [aces2065_1, lin_ap0]
    encoding: scene-linear
  - !<ColorSpace>
    name: ACEScg
    aliases: [acescg, lin_ap1]
    encoding: scene-linear
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: Linear Rec.709
    aliases: [Linear Rec.709 (sRGB), lin_rec709, lin_srgb]
    encoding: scene-linear
    to_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD, direction: inverse}
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: sRGB
    aliases: [sRGB - Texture, srgb_tx, srgb]
    encoding: sdr-video
    to_scene_reference: !<GroupTransform>
      children:
        - !<ExponentWithLinearTransform> {gamma: [2.4, 2.4, 2.4, 1], offset: [0.055, 0.055, 0.055, 0], style: mirror}
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD, direction: inverse}
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: raw
    aliases: [Raw]
    isdata: true
)";

std::mutex g_mutex;
std::string g_path_given;        // by --ocio
OCIO::ConstConfigRcPtr g_config; // null until first asked for
std::string g_name;

[[noreturn]] void fail(const std::string& message) { throw Error(ExitStatus::missing_input, message); }

/// Needs g_mutex.
void load() {
  const char* variable = std::getenv("OCIO");
  const bool from_variable = g_path_given.empty() && variable && *variable;
  const std::string path = from_variable ? variable : g_path_given;
  if (path.empty()) {
    g_config = own_config(), g_name = "kelpie's own OCIO config";
    return;
  }
  const std::string what = fmt::format("the OCIO config {}{}", path, from_variable ? " (named by $OCIO)" : "");
  std::string why;
  open_to_read(path, why); // OpenColorIO would wait for a pipe
  if (!why.empty()) fail(fmt::format("{} cannot be used: {}", what, why));
  OCIO::ConstConfigRcPtr config;
  try {
    config = OCIO::Config::CreateFromFile(path.c_str());
    config->validate();
  } catch (const OCIO::Exception& e) {
    fail(fmt::format("{} cannot be used: {}", what, e.what()));
  }
  if (!config->hasRole(OCIO::ROLE_SCENE_LINEAR)) fail(what + " has no role scene_linear");
  g_config = config, g_name = what;
}

bool knows(const OCIO::ConstConfigRcPtr& config, const std::string& space) { return bool(config->getColorSpace(space.c_str())); }

} // namespace

OCIO::ConstConfigRcPtr own_config() {
  static const OCIO::ConstConfigRcPtr config = [] {
    std::istringstream text(k_own_config);
    return OCIO::Config::CreateFromStream(text);
  }();
  return config;
}

OCIO::ConstConfigRcPtr config_in_force() {
  const std::lock_guard lock(g_mutex);
  if (!g_config) load();
  return g_config;
}

std::string config_name() {
  config_in_force();
  const std::lock_guard lock(g_mutex);
  return g_name;
}

namespace {

/// Between a space (of the config in force, else of ours) and scene_linear.
OCIO::ConstCPUProcessorRcPtr processor_for(const std::string& space, bool is_to_space) {
  const OCIO::ConstConfigRcPtr config = config_in_force(), own = own_config();
  const auto ordered = [&](const OCIO::ConstConfigRcPtr& of_space) {
    const char *name = space.c_str(), *linear = OCIO::ROLE_SCENE_LINEAR;
    if (of_space == config) return is_to_space ? config->getProcessor(linear, name) : config->getProcessor(name, linear);
    return is_to_space ? OCIO::Config::GetProcessorFromConfigs(config, linear, own, name)
                       : OCIO::Config::GetProcessorFromConfigs(own, name, config, linear);
  };
  try {
    OCIO::ConstProcessorRcPtr processor;
    if (knows(config, space))
      processor = ordered(config);
    else if (knows(own, space)) {
      if (!config->hasRole("aces_interchange"))
        fail(fmt::format("{} has neither a space \"{}\" nor the role aces_interchange to reach it by", config_name(), space));
      processor = ordered(own);
    } else {
      throw Error(ExitStatus::bad_data,
                  fmt::format("unknown colour space \"{}\"; {} knows: {}", space, config_name(), fmt::join(colour_space_names(), ", ")));
    }
    return processor->getDefaultCPUProcessor();
  } catch (const OCIO::Exception& e) { // a file that the config needs is missing, say
    fail(fmt::format("{}: {}", config_name(), e.what()));
  }
}

} // namespace

OCIO::ConstCPUProcessorRcPtr scene_linear_from(const std::string& space) { return processor_for(space, false); }
OCIO::ConstCPUProcessorRcPtr scene_linear_to(const std::string& space) { return processor_for(space, true); }

void apply_in_bands(const OCIO::CPUProcessor& processor, float* pixels, size_t pixel_count, int channels) {
  constexpr size_t k_band = 16384; // pixels: some tenths of a millisecond of work even for a matrix
  parallel_for(size_t(0), (pixel_count + k_band - 1) / k_band, [&](size_t band) {
    const size_t first = band * k_band, count = std::min(k_band, pixel_count - first);
    OCIO::PackedImageDesc image(pixels + first * channels, static_cast<long>(count), 1, channels);
    processor.apply(image);
  });
}

} // namespace kelpie::colour

namespace kelpie {

void use_ocio_config(std::string path) {
  const std::lock_guard lock(colour::g_mutex);
  colour::g_path_given = std::move(path);
  colour::g_config = nullptr;
  colour::load();
}

std::vector<std::string> colour_space_names() {
  const auto config = colour::config_in_force();
  std::vector<std::string> names;
  for (int i = 0; i < config->getNumColorSpaces(); ++i) names.emplace_back(config->getColorSpaceNameByIndex(i));
  for (int i = 0; i < config->getNumRoles(); ++i) names.emplace_back(config->getRoleName(i));
  return names;
}

} // namespace kelpie
