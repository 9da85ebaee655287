#include "renderer/measure/morph_pops.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "renderer/measure/pops.h"

namespace kelpie {

namespace {

double share(double change, double whole) { return whole > 0 ? change / whole : 0; }

/// The changes from each frame to the next of one measure.
std::vector<double> changes_of(const std::vector<FieldMeasures>& frames, double FieldMeasures::*measure) {
  std::vector<double> changes;
  for (size_t i = 1; i < frames.size(); ++i) {
    const double before = frames[i - 1].*measure, after = frames[i].*measure;
    changes.push_back(share(std::abs(after - before), std::max(before, after)));
  }
  return changes;
}

void add_pops(Pop::Kind kind, const std::vector<double>& changes, const std::vector<FieldMeasures>& frames, std::vector<Pop>& out) {
  for (const size_t i : find_pops(changes)) out.push_back({kind, frames[i + 1].frame, changes[i], usual_change(changes, i), {}});
}

/// The changes of one part on its way.
struct Track {
  std::vector<double> changes;
  std::vector<Pop> as_pops;
};

void add_pops_of_parts(const std::vector<FieldMeasures>& frames, std::vector<Pop>& out) {
  std::map<size_t, Track> tracks;
  for (size_t i = 1; i < frames.size(); ++i)
    for (const FieldMeasures::PartChange& c : frames[i].changes) {
      Track& track = tracks[c.track];
      track.changes.push_back(share(c.change, std::max(frames[i - 1].volume, frames[i].volume)));
      track.as_pops.push_back({Pop::Kind::part, frames[i].frame, track.changes.back(), 0, c.place});
    }
  for (auto& [number, track] : tracks) {
    std::vector<size_t> pops = find_pops(track.changes);
    // What is there for one frame only has no usual change.
    if (track.changes.size() == 1 && frames.size() > 2 && track.changes[0] > k_least_pop) pops = {0};
    for (const size_t i : pops) {
      track.as_pops[i].usual = usual_change(track.changes, i);
      out.push_back(track.as_pops[i]);
    }
  }
}

} // namespace

std::vector<Pop> find_pops(const std::vector<FieldMeasures>& frames, const std::vector<double>& picture_changes) {
  std::vector<Pop> pops;
  add_pops(Pop::Kind::volume, changes_of(frames, &FieldMeasures::volume), frames, pops);
  add_pops(Pop::Kind::area, changes_of(frames, &FieldMeasures::area), frames, pops);
  add_pops_of_parts(frames, pops);
  add_pops(Pop::Kind::picture, picture_changes, frames, pops);
  std::stable_sort(pops.begin(), pops.end(), [](const Pop& a, const Pop& b) { return a.frame < b.frame; });
  return pops;
}

} // namespace kelpie
