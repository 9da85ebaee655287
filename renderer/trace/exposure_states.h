// What changes while the shutter is open and costs nothing to keep: its states at equal steps of the exposure.
#pragma once

#include "field/motion.h"
#include "scene/scene.h"

namespace kelpie {

/// The states of something that costs nothing to keep, at this many equal steps of the exposure.
inline constexpr int k_states = 65;

/// Between states at equal steps of the exposure; of something that stands there is one.
template <class Kind>
Kind state_at(const std::vector<Kind>& states, float time) {
  if (states.size() == 1) return states[0];
  const float place = time * static_cast<float>(states.size() - 1);
  const size_t i = std::min(static_cast<size_t>(place), states.size() - 2);
  return interpolated(states[i], states[i + 1], place - static_cast<float>(i));
}

/// The states of what `part(FrameScene)` is of a scene, so many frames later.
template <class Part>
auto states_of(const FrameScene& frame, double later, Part&& part) {
  const Exposure exposure = frame.exposure();
  std::vector states{part(frame)};
  if (exposure.length == 0) return states;
  const auto first = part(frame.moment(exposure.start + later));
  bool moves = false;
  states.clear();
  for (int i = 0; i < k_states; ++i) {
    states.push_back(part(frame.moment(exposure.frame_at(double(i) / (k_states - 1)) + later)));
    moves = moves || !is_same(states.back(), first);
  }
  if (!moves) states.resize(1);
  return states;
}

} // namespace kelpie
