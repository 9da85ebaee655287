// All that a shape is asked in a test: random rays, and rays that start where these hit.
#pragma once

#include <functional>

#include "tests/support/judge_rays.h"
#include "tests/support/random_scene.h"

namespace kelpie {

/// The reference's picture at a time of the open shutter.
using PictureAt = std::function<Picture(double time)>;

struct RandomRays {
  int count;
  double most_sizes = 3;   ///< from how far away they come, in scene sizes
  bool have_times = false; ///< else all are at the beginning
};

class Examination {
public:
  Examination(const FrameScene& scene, const CellLimits& limits, const PictureAt& picture_at, const RandomRays& rays)
      : tracer_(scene, limits), box_(tracer_.bounds()) {
    if (box_.is_empty()) box_ = {Vec3(-1), Vec3(1)};
    box_ = box_.padded(0.01f * box_.diagonal());
    for (int i = 0; i < rays.count; ++i) {
      Random r(i);
      const float time = rays.have_times ? float(r.uniform(0, 1)) : 0;
      Question q;
      q.picture = picture_at(time);
      std::vector<reference::Leaf> leaves;
      collect_leaves(*q.picture.node, leaves);
      q.ray = random_ray(r, box_, leaves, i % 4 != 0, i % 3 == 1 ? rays.most_sizes : 3);
      q.ray.time = time;
      const double at_origin = value(*q.picture.node, reference_of(q.ray.origin), q.picture.threshold) / q.picture.threshold;
      if (std::abs(at_origin - 1) < 0.01) continue; // neither outside nor inside
      if (at_origin > 1) q.ray.inside.add(0);       // the only shape
      questions_.push_back(std::move(q));
    }
    EXPECT_GT(2 * int(questions_.size()), rays.count);
  }
  /// Of a field that stands.
  Examination(const SampledField& field, float threshold, int rays, const CellLimits& limits = {}, double most_sizes = 3)
      : Examination(scene_of(field, threshold), limits, standing(field, threshold), {rays, most_sizes}) {}

  Tally judge(Way way) {
    ask(tracer_, way, questions_);
    return judged(questions_);
  }
  /// Judges rays that start where the answers of the last judge() were found.
  Tally judge_departures(Way way) const {
    std::vector<Question> departures;
    for (size_t i = 0; i < questions_.size(); ++i) {
      const Question& q = questions_[i];
      Random r{unsigned(i)};
      if (!q.found) continue;
      for (const Side side : {Side::near, Side::far}) departures.push_back({random_departure(r, q.ray, q.hit, side, size()), q.picture});
    }
    ask(tracer_, way, departures);
    return judged(departures);
  }

  const Tracer& tracer() const { return tracer_; }
  std::vector<Question>& questions() { return questions_; }
  float size() const { return box_.diagonal(); }

private:
  static PictureAt standing(const SampledField& field, double threshold) {
    return [picture = Picture{reference_of(field), threshold}](double) { return picture; };
  }
  Tally judged(const std::vector<Question>& questions) const {
    Tally tally;
    for (const Question& q : questions) judge_answer(q, box_, tally);
    return tally;
  }

  Tracer tracer_;
  Box3 box_;
  std::vector<Question> questions_;
};

/// Of random rays, and of rays from where they hit.
struct Tallies {
  Tally rays, departures;

  Tallies& operator+=(const Tallies& t) {
    rays += t.rays, departures += t.departures;
    return *this;
  }
};
inline void expect_nothing_wrong(const Tallies& tallies) {
  expect_nothing_wrong(tallies.rays);
  expect_nothing_wrong(tallies.departures);
}
inline void expect_right(const Tallies& tallies, double least_share = 0.1) {
  expect_right(tallies.rays, least_share);
  expect_right(tallies.departures, least_share);
}

/// Puts all rays alone and in packets.
inline Tallies judge_both_ways(Examination&& examination) {
  Tallies tallies;
  for (const Way way : {Way::alone, Way::in_packets}) {
    SCOPED_TRACE(way == Way::alone ? "alone" : "in packets");
    tallies.rays += examination.judge(way);
    SCOPED_TRACE("from where a ray hit");
    tallies.departures += examination.judge_departures(way);
  }
  return tallies;
}

} // namespace kelpie
