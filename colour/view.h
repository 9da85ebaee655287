// From scene-linear to what a display shows.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace kelpie {

/// A view of the config in force, on its default display. Our own config has "ACES" (the SDR output
/// transform: a film-like shoulder), "sRGB" (plain: clipped at 1) and "raw".
///
/// ACES costs 0.33 s for 1920×1080 on one thread; the work is spread over all threads.
class DisplayView {
public:
  /// An empty name: the config's default view. Throws Error usage for an unknown one, listing the known.
  explicit DisplayView(const std::string& name = {});

  /// Scene-linear pixels in place to display-referred [0, 1]: interleaved, 3 or 4 channels (a fourth is left as it is).
  void apply(float* pixels, size_t pixel_count, int channels) const;

  const std::string& name() const { return name_; }
  /// Whether the display's encoding is sRGB's: what files that are shown as they are should be tagged with.
  bool is_srgb() const { return is_srgb_; }

private:
  std::string name_;
  bool is_srgb_ = true;
  std::shared_ptr<const void> processor_; // OCIO::CPUProcessor
};

/// Scene-linear pixels in place to a space or role (spaces.h): interleaved, 3 or 4 channels.
void from_scene_linear(float* pixels, size_t pixel_count, int channels, const std::string& space_or_role);

/// The views of the default display under the config in force, the default one first.
std::vector<std::string> view_names();

} // namespace kelpie
