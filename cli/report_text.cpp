#include "cli/report_text.h"

#include <algorithm>

#include <fmt/format.h>

#include "cli/json_values.h"

namespace kelpie {

namespace {

std::string place_text(const Vec3d& p) { return fmt::format("({:.3g}, {:.3g}, {:.3g})", p.x, p.y, p.z); }

const char* name_of(PartEvent::Kind kind) {
  switch (kind) {
  case PartEvent::Kind::appears: return "appears";
  case PartEvent::Kind::parts: return "parts";
  case PartEvent::Kind::vanishes: return "vanishes";
  case PartEvent::Kind::merges: break;
  }
  return "merges";
}

const char* name_of(Pop::Kind kind) {
  switch (kind) {
  case Pop::Kind::volume: return "volume";
  case Pop::Kind::area: return "area";
  case Pop::Kind::part: return "part";
  case Pop::Kind::picture: break;
  }
  return "picture";
}

Json json_of(const std::optional<SurfaceDistance>& d) { return d ? Json{{"rms", d->rms}, {"largest", d->largest}} : Json(nullptr); }

Json json_of(const FieldMeasures& f) {
  Json parts = Json::array(), events = Json::array();
  for (const Part& p : f.parts)
    parts.push_back(
        {{"volume", p.volume}, {"area", p.area}, {"centre", json_point(p.centre)}, {"genus", p.genus}, {"cavities", p.cavities}});
  for (const PartEvent& e : f.events) events.push_back({{"what", name_of(e.kind)}, {"place", json_point(e.place)}, {"volume", e.volume}});
  return {{"frame", f.frame},
          {"volume", f.volume},
          {"area", f.area},
          {"components", f.parts.size()},
          {"genus", f.genus},
          {"cavities", f.cavities},
          {"speed", f.speed},
          {"to_first", json_of(f.to_first)},
          {"to_last", json_of(f.to_last)},
          {"parts", parts},
          {"events", events}};
}

/// `1.2 to 1.5`, or one number.
std::string range_text(const std::vector<FieldMeasures>& frames, double FieldMeasures::*measure) {
  const auto [least, most] =
      std::minmax_element(frames.begin(), frames.end(), [&](const auto& a, const auto& b) { return a.*measure < b.*measure; });
  return fmt::format("{:.4g} to {:.4g}", (*least).*measure, (*most).*measure);
}

} // namespace

std::string text_of(const PartEvent& e) {
  const char* how = "";
  switch (e.kind) {
  case PartEvent::Kind::appears: how = "appears"; break;
  case PartEvent::Kind::parts: how = "appears: it parts from another,"; break;
  case PartEvent::Kind::vanishes: how = "vanishes"; break;
  case PartEvent::Kind::merges: how = "vanishes: it merges with a larger one,"; break;
  }
  return fmt::format("a part of volume {:.3g} {} at {}", e.volume, how, place_text(e.place));
}

std::string text_of(const Pop& pop) {
  const std::string what = pop.kind == Pop::Kind::part ? fmt::format("the volume of the part at {}", place_text(*pop.place))
                                                       : fmt::format("the {}", name_of(pop.kind));
  return fmt::format("{} changes by {:.2g} %; {:.2g} % is usual", what, 100 * pop.change, 100 * pop.usual);
}

std::string report_json(const MorphReport& r) {
  Json frames = Json::array(), pops = Json::array();
  for (size_t i = 0; i < r.frames.size(); ++i) {
    Json frame = json_of(r.frames[i]);
    frame["bumps"] = r.bumps[i] ? Json{{"median", r.bumps[i]->median}, {"p90", r.bumps[i]->p90}} : Json(nullptr);
    frame["picture_change"] = i > 0 ? Json(r.picture_changes[i - 1]) : Json(nullptr);
    frames.push_back(std::move(frame));
  }
  for (const Pop& p : r.pops)
    pops.push_back({{"frame", p.frame},
                    {"what", name_of(p.kind)},
                    {"change", p.change},
                    {"usual", p.usual},
                    {"place", p.place ? json_point(*p.place) : Json(nullptr)}});
  const Json all{{"version", KELPIE_VERSION},  {"scene", r.scene}, {"subject", r.subject},
                 {"resolution", r.resolution}, {"frames", frames}, {"pops", pops}};
  return all.dump(1) + "\n";
}

std::string report_summary(const MorphReport& r) {
  size_t most_parts = 0;
  for (const FieldMeasures& f : r.frames) most_parts = std::max(most_parts, f.parts.size());
  std::string text = fmt::format("frames    {} to {}: {}\n", r.frames.front().frame, r.frames.back().frame, r.subject);
  text += fmt::format(
      "volume    {}\narea      {}\nparts     at most {}\nspeed     at most {:.3g} a frame\n", range_text(r.frames, &FieldMeasures::volume),
      range_text(r.frames, &FieldMeasures::area), most_parts,
      std::max_element(r.frames.begin(), r.frames.end(), [](const auto& a, const auto& b) { return a.speed < b.speed; })->speed);
  for (const FieldMeasures& f : r.frames)
    for (const PartEvent& e : f.events) text += fmt::format("frame {}: {}\n", f.frame, text_of(e));
  for (const Pop& p : r.pops) text += fmt::format("frame {}: pop: {}\n", p.frame, text_of(p));
  return text + fmt::format("pops      {}\n", r.pops.size());
}

} // namespace kelpie
