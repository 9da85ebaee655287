#include "colour/view.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "colour/config.h"

namespace kelpie {

using namespace colour;

void from_scene_linear(float* pixels, size_t pixel_count, int channels, const std::string& space_or_role) {
  colour::apply_in_bands(*colour::scene_linear_to(space_or_role), pixels, pixel_count, channels);
}

std::vector<std::string> view_names() {
  const auto config = config_in_force();
  const char* display = config->getDefaultDisplay();
  std::vector<std::string> names;
  for (int i = 0; i < config->getNumViews(display); ++i) names.emplace_back(config->getView(display, i));
  const auto first = std::find(names.begin(), names.end(), std::string(config->getDefaultView(display)));
  if (first != names.end()) std::rotate(names.begin(), first, first + 1);
  return names;
}

DisplayView::DisplayView(const std::string& name) {
  const std::vector<std::string> known = view_names();
  if (known.empty()) throw Error(ExitStatus::missing_input, config_name() + " has no views");
  name_ = name.empty() ? known.front() : name;
  if (std::find(known.begin(), known.end(), name_) == known.end())
    throw Error(ExitStatus::usage, fmt::format("unknown view \"{}\"; {} has: {}", name_, config_name(), fmt::join(known, ", ")));
  const auto config = config_in_force();
  const std::string display = config->getDefaultDisplay();
  is_srgb_ = display.find("sRGB") != std::string::npos;
  try {
    processor_ = config->getProcessor(OCIO::ROLE_SCENE_LINEAR, display.c_str(), name_.c_str(), OCIO::TRANSFORM_DIR_FORWARD)
                     ->getDefaultCPUProcessor();
  } catch (const OCIO::Exception& e) {
    throw Error(ExitStatus::missing_input, fmt::format("{}: view \"{}\": {}", config_name(), name_, e.what()));
  }
}

void DisplayView::apply(float* pixels, size_t pixel_count, int channels) const {
  apply_in_bands(*static_cast<const OCIO::CPUProcessor*>(processor_.get()), pixels, pixel_count, channels);
  // A view's curve may overshoot by a rounding error, and a plain one passes what no display can show.
  for (size_t i = 0; i < pixel_count; ++i)
    for (int c = 0; c < 3; ++c) {
      float& v = pixels[i * channels + c];
      v = v > 0 ? std::min(v, 1.f) : 0.f; // NaN: 0
    }
}

} // namespace kelpie
