// What `kelpie report` has measured, as a page, as data, and in a few lines.
#pragma once

#include <string>
#include <vector>

#include "renderer/measure/bumps.h"
#include "renderer/measure/morph_pops.h"

namespace kelpie {

struct MorphReport {
  std::string scene, subject;
  int resolution = 0;
  std::vector<FieldMeasures> frames;
  std::vector<std::optional<Bumps>> bumps; ///< of each frame
  std::vector<double> picture_changes;     ///< from each frame to the next
  std::vector<Pop> pops;
  std::vector<std::vector<unsigned char>> pictures; ///< of each frame, PNG
};

/// `part of the volume 0.0123 merges with a larger one at (0.1, 0.2, 0.3)`.
std::string text_of(const PartEvent&);
/// `the volume changes by 1.2 % (0.1 % is usual)`.
std::string text_of(const Pop&);

/// One self-contained HTML page: plots as SVG, thumbnails, events and pops.
std::string report_page(const MorphReport&);
/// The same numbers as JSON.
std::string report_json(const MorphReport&);
/// The same in a few lines.
std::string report_summary(const MorphReport&);

} // namespace kelpie
