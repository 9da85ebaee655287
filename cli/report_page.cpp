// The page of `kelpie report`.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "cli/markup.h"
#include "cli/report_text.h"
#include "renderer/output/picture.h"

namespace kelpie {

namespace {

constexpr int k_width = 720, k_height = 130, k_left = 70; // of a plot, pixels; where its curve begins
constexpr size_t k_shown = 24;                            // pictures, besides those of pops

constexpr std::string_view k_style = R"(body{font:14px/1.45 system-ui,sans-serif;margin:2em auto;max-width:760px;color:#222;background:#fff}
h1{font-size:1.4em}h2{font-size:1em;margin:1.4em 0 .2em}figure{display:inline-block;margin:3px;text-align:center;font-size:11px;color:#555}
figure img{display:block;width:174px}svg{display:block}.axis{stroke:#bbb}.pop{stroke:#d33}text{font-size:11px;fill:#555}
.c0{stroke:#1763ad}.c1{stroke:#d8862a}polyline{fill:none;stroke-width:1.5}.k0{color:#1763ad}.k1{color:#d8862a}.bad{color:#b11})";

/// A curve over the frames; NaN where there is nothing.
struct Curve {
  std::string name;
  std::vector<double> values;
};

class Plot {
public:
  Plot(const MorphReport& report, std::vector<Curve> curves) : report_(report), curves_(std::move(curves)) {
    for (const Curve& c : curves_)
      for (const double v : c.values)
        if (std::isfinite(v)) least_ = std::min(least_, v), most_ = std::max(most_, v);
    if (!(most_ > least_)) most_ = least_ + std::max(1e-9, std::abs(least_));
  }

  std::string text() const {
    std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" width=\"{}\">\n", k_width, k_height, k_width);
    svg += fmt::format("<path class=\"axis\" d=\"M{0} 5V{1}H{2}\" fill=\"none\"/>\n", k_left, k_height - 20, k_width - 5);
    svg += fmt::format(
        "<text x=\"{0}\" y=\"14\" text-anchor=\"end\">{1:.4g}</text><text x=\"{0}\" y=\"{2}\" text-anchor=\"end\">{3:.4g}</text>\n",
        k_left - 6, most_, k_height - 20, least_);
    const auto& frames = report_.frames;
    for (const int frame : {frames.front().frame, frames.back().frame})
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", x(frame), k_height - 5, frame);
    for (const Pop& pop : report_.pops)
      svg += fmt::format("<path class=\"pop\" d=\"M{:.1f} 5V{}\"><title>frame {}: {}</title></path>\n", x(pop.frame), k_height - 20,
                         pop.frame, escaped(text_of(pop)));
    for (size_t i = 0; i < curves_.size(); ++i) svg += curve(i);
    return svg + "</svg>\n";
  }

private:
  double x(int frame) const {
    const int first = report_.frames.front().frame, last = report_.frames.back().frame;
    return first == last ? k_left : k_left + double(frame - first) / (last - first) * (k_width - 10 - k_left);
  }
  double y(double value) const { return 8 + (most_ - value) / (most_ - least_) * (k_height - 32); }

  /// Broken where there is nothing.
  std::string curve(size_t i) const {
    std::string svg, points;
    const auto end = [&] {
      if (!points.empty()) svg += fmt::format("<polyline class=\"c{}\" points=\"{}\"/>\n", i, points);
      points.clear();
    };
    for (size_t k = 0; k < report_.frames.size(); ++k) {
      const double v = curves_[i].values[k];
      if (std::isfinite(v))
        points += fmt::format("{:.1f},{:.1f} ", x(report_.frames[k].frame), y(v));
      else
        end();
    }
    end();
    return svg;
  }

  const MorphReport& report_;
  std::vector<Curve> curves_;
  double least_ = std::numeric_limits<double>::infinity(), most_ = -std::numeric_limits<double>::infinity();
};

template <class Value>
Curve curve_of(const MorphReport& r, std::string name, Value&& value) {
  Curve c{std::move(name), {}};
  for (size_t i = 0; i < r.frames.size(); ++i) c.values.push_back(value(i));
  return c;
}

std::string plot(const MorphReport& r, std::string_view title, std::vector<Curve> curves) {
  std::string legend;
  for (size_t i = 0; i < curves.size() && curves.size() > 1; ++i)
    legend += fmt::format(" <span class=\"k{}\">{}</span>", i, curves[i].name);
  return fmt::format("<h2>{}{}</h2>\n{}", title, legend, Plot(r, std::move(curves)).text());
}

std::string plots(const MorphReport& r) {
  constexpr double k_nothing = std::numeric_limits<double>::quiet_NaN();
  const auto& f = r.frames;
  const auto rms = [](const std::optional<SurfaceDistance>& d) { return d ? d->rms : k_nothing; };
  std::string text;
  text += plot(r, "Volume", {curve_of(r, "", [&](size_t i) { return f[i].volume; })});
  text += plot(r, "Area", {curve_of(r, "", [&](size_t i) { return f[i].area; })});
  text += plot(r, "Components and genus",
               {curve_of(r, "components", [&](size_t i) { return double(f[i].parts.size()); }),
                curve_of(r, "genus", [&](size_t i) { return double(f[i].genus); })});
  text += plot(r, "Largest speed of the surface, scene units a frame", {curve_of(r, "", [&](size_t i) { return f[i].speed; })});
  text += plot(r, "Distance (rms) to the surface of",
               {curve_of(r, "the first frame", [&](size_t i) { return rms(f[i].to_first); }),
                curve_of(r, "the last frame", [&](size_t i) { return rms(f[i].to_last); })});
  text += plot(r, "Bumps, degrees:",
               {curve_of(r, "median", [&](size_t i) { return r.bumps[i] ? r.bumps[i]->median : k_nothing; }),
                curve_of(r, "p90", [&](size_t i) { return r.bumps[i] ? r.bumps[i]->p90 : k_nothing; })});
  text += plot(r, "Change of the picture, % of white",
               {curve_of(r, "", [&](size_t i) { return i > 0 ? 100 * r.picture_changes[i - 1] : k_nothing; })});
  return text;
}

std::string list_of_events(const MorphReport& r) {
  std::string items;
  for (const Pop& p : r.pops) items += fmt::format("<li class=\"bad\">frame {}: pop: {}</li>\n", p.frame, escaped(text_of(p)));
  for (const FieldMeasures& f : r.frames)
    for (const PartEvent& e : f.events) items += fmt::format("<li>frame {}: {}</li>\n", f.frame, escaped(text_of(e)));
  return items.empty() ? "<p>Nothing pops, and no part comes or goes.</p>\n" : "<ul>\n" + items + "</ul>\n";
}

/// Evenly spread, and the frames before and after each pop.
std::string pictures(const MorphReport& r) {
  const size_t count = r.frames.size(), shown = std::min(count, k_shown);
  std::vector<bool> is_shown(count);
  for (size_t i = 0; i < shown; ++i) is_shown[shown > 1 ? i * (count - 1) / (shown - 1) : 0] = true;
  for (size_t i = 1; i < count; ++i)
    for (const Pop& p : r.pops)
      if (p.frame == r.frames[i].frame) is_shown[i - 1] = is_shown[i] = true;
  std::string text;
  for (size_t i = 0; i < count; ++i)
    if (is_shown[i])
      text += fmt::format("<figure><img alt=\"frame {0}\" src=\"data:image/png;base64,{1}\">{0}</figure>\n", r.frames[i].frame,
                          base64(r.pictures[i]));
  return text;
}

} // namespace

std::string report_page(const MorphReport& r) {
  const std::string title = fmt::format("{} of {}", escaped(r.subject), escaped(r.scene));
  return fmt::format("<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>{1}</style>\n<h1>{0}</h1>\n"
                     "<p>Frames {2} to {3}, {4} of them; the field is sampled on {5} cells along its longest side. Lengths are in scene "
                     "units.</p>\n",
                     title, k_style, r.frames.front().frame, r.frames.back().frame, r.frames.size(), r.resolution) +
         list_of_events(r) + pictures(r) + plots(r) + "</html>\n";
}

} // namespace kelpie
