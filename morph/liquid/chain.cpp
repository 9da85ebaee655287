#include "morph/liquid/chain.h"

#include <algorithm>
#include <cmath>

namespace kelpie {

namespace {

/// So near to an end, in passages, it is that end: what rounding makes of a third.
constexpr double k_at_end = 1e-6;

using Places = std::vector<Vec3d>;

Places centres_of(const BlobCloud& cloud) {
  Places places;
  for (const Blob& b : cloud) places.push_back(Vec3d(b.centre));
  return places;
}

/// Where the matter that arrives at the blobs of a passage's end was, if that of its beginning was at `places`.
Places carried_on(const LiquidMorph& passage, const Places& places) {
  Places out(passage.to().size(), Vec3d(0));
  for (size_t i = 0; i < passage.part_count(); ++i) {
    const Link& l = passage.link(i);
    out[l.to] += double(l.to_share) * places[l.from];
  }
  return out;
}

/// Where the matter will be that leaves the blobs of a passage's beginning.
Places carried_back(const LiquidMorph& passage, const Places& places) {
  Places out(passage.from().size(), Vec3d(0));
  for (size_t i = 0; i < passage.part_count(); ++i) {
    const Link& l = passage.link(i);
    out[l.from] += double(l.from_share) * places[l.to];
  }
  return out;
}

} // namespace

LiquidChain::LiquidChain(std::span<const BlobCloud* const> clouds, Correspondence how, VolumeRule rule, LiquidEnds ends) {
  const size_t count = clouds.size() - 1;
  passages_.reserve(count);
  for (size_t i = 0; i < count; ++i)
    passages_.emplace_back(*clouds[i], *clouds[i + 1], how, rule, i == 0 ? ends : LiquidEnds::exact,
                           i + 1 == count ? ends : LiquidEnds::exact);
  add_crossings();
  number_all();
}

size_t LiquidChain::part_count() const {
  size_t count = 0;
  for (const LiquidMorph& passage : passages_) count += passage.part_count();
  return count;
}

void LiquidChain::add_crossings() {
  for (size_t i = 0; i + 1 < passages_.size(); ++i) {
    const LiquidMorph &before = passages_[i], &after = passages_[i + 1];
    std::vector<std::vector<uint32_t>> leaving(after.from().size());
    for (uint32_t k = 0; k < after.part_count(); ++k) leaving[after.link(k).from].push_back(k);
    std::vector<Crossing>& all = crossings_.emplace_back();
    for (uint32_t k = 0; k < before.part_count(); ++k)
      for (const uint32_t next : leaving[before.link(k).to]) all.push_back({k, next});
  }
}

/// In the order in which blobs are appended: those of each passage, those that go through each inner end, those of inner clouds.
void LiquidChain::number_all() {
  const size_t count = passages_.size();
  std::vector<Places> were{centres_of(passages_.front().from())}, will_be{centres_of(passages_.back().to())};
  for (size_t i = 0; i + 1 < count; ++i) were.push_back(carried_on(passages_[i], were.back()));
  for (size_t i = count - 1; i > 0; --i) will_be.push_back(carried_back(passages_[i], will_be.back()));
  std::reverse(will_be.begin(), will_be.end()); // now will_be[i] is of the end of passage i, as were[i] is of its beginning
  const auto add = [&](const Vec3d& from, const Vec3d& to) { flows_.push_back({Vec3(from), Vec3(to)}); };
  const auto number = [&] { return static_cast<uint32_t>(flows_.size()); };
  for (size_t i = 0; i < count; ++i) {
    first_of_passage_.push_back(number());
    for (const uint32_t part : passages_[i].part_of_blob()) {
      const Link& l = passages_[i].link(part);
      add(were[i][l.from], will_be[i][l.to]);
    }
  }
  for (size_t i = 0; i < crossings_.size(); ++i) {
    first_of_crossings_.push_back(number());
    const LiquidMorph &before = passages_[i], &after = passages_[i + 1];
    for (const Crossing& c : crossings_[i]) {
      const size_t blobs = 1 + size_t(before.is_of_two_falloffs(c.before)) + size_t(after.is_of_two_falloffs(c.after));
      for (size_t k = 0; k < blobs; ++k) add(were[i][before.link(c.before).from], will_be[i + 1][after.link(c.after).to]);
    }
  }
  for (size_t i = 0; i < crossings_.size(); ++i) {
    first_of_cloud_.push_back(number());
    for (size_t b = 0; b < passages_[i].to().size(); ++b) add(were[i + 1][b], will_be[i][b]);
  }
}

/// In passages.
double LiquidChain::way_at(float progress) const {
  const double count = double(passages_.size()), way = std::clamp(double(progress) * count, 0.0, count);
  const double end = std::round(way);
  return std::abs(way - end) < k_at_end * count ? end : way;
}

/// An end is the beginning of a passage, if there is one.
LiquidChain::Place LiquidChain::place_at(double way) const {
  const size_t passage = std::min(size_t(way), passages_.size() - 1);
  return {passage, static_cast<float>(way - double(passage))};
}

uint32_t LiquidChain::append_blobs(float progress, BlobCloud& out) const {
  if (passages_.size() == 1) { // as exactly as it was asked for
    passages_[0].append_blobs(progress, out);
    return 0;
  }
  const double way = way_at(progress);
  const Place place = place_at(way);
  passages_[place.passage].append_blobs(place.progress, out);
  const bool is_inner_end = place.passage > 0 && place.progress == 0;
  return is_inner_end ? first_of_cloud_[place.passage - 1] : first_of_passage_[place.passage];
}

uint32_t LiquidChain::append_parts(std::span<const float> progress, std::span<BlobCloud> out) const {
  if (passages_.size() == 1) {
    for (size_t i = 0; i < progress.size(); ++i) passages_[0].append_parts(progress[i], out[i]);
    return 0;
  }
  std::vector<double> ways;
  for (const float p : progress) ways.push_back(way_at(p));
  const auto [least, most] = std::minmax_element(ways.begin(), ways.end());
  const size_t first = place_at(*least).passage, last = std::max(first, size_t(std::max(std::ceil(*most) - 1, 0.0)));
  if (last == first + 1) {
    for (size_t i = 0; i < ways.size(); ++i) append_crossings(first, place_at(ways[i]), out[i]);
    return first_of_crossings_[first];
  }
  for (size_t i = 0; i < ways.size(); ++i) {
    const size_t here = std::min(place_at(ways[i]).passage, last);
    for (size_t k = first; k <= last; ++k) {
      const size_t before = out[i].size();
      passages_[k].append_parts(static_cast<float>(std::clamp(ways[i] - double(k), 0.0, 1.0)), out[i]);
      if (k == here) continue;
      for (size_t b = before; b < out[i].size(); ++b) out[i][b].weight = 0;
    }
  }
  return first_of_passage_[first];
}

/// Two parts that meet in a blob are as one through it: each in turn, by what share of the blob the other has.
void LiquidChain::append_crossings(size_t end, const Place& place, BlobCloud& out) const {
  const LiquidMorph &before = passages_[end], &after = passages_[end + 1];
  const bool is_before = place.passage == end;
  const LiquidMorph& now = is_before ? before : after;
  const float gain = now.gain_at(place.progress);
  for (const Crossing& c : crossings_[end]) {
    LiquidMorph::PartBlobs part = now.part_at(is_before ? c.before : c.after, place.progress, gain);
    const float share = is_before ? after.link(c.after).from_share : before.link(c.before).to_share;
    part.blob.weight *= share;
    if (part.other) part.other->weight *= share;
    // Those of three falloffs at most: of where it comes from, of the end, of where it goes. What is not there has no weight.
    const auto absent = [&](Falloff falloff) { return Blob{part.blob.centre, part.blob.radius, 0, falloff}; };
    if (before.is_of_two_falloffs(c.before)) out.push_back(is_before ? part.blob : absent(before.falloff_from(c.before)));
    out.push_back(is_before && part.other ? *part.other : part.blob);
    if (after.is_of_two_falloffs(c.after)) out.push_back(is_before ? absent(after.falloff_to(c.after)) : *part.other);
  }
}

} // namespace kelpie
