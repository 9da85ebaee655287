#include "cli/match_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "cli/markup.h"

namespace kelpie {

namespace {

constexpr double k_panel = 540, k_gap = 110, k_margin = 24, k_title = 44; // pixels: of an end, between, around, above
constexpr double k_letter = 6.2, k_line = 13;                             // about what text takes
constexpr double k_width = 2 * (k_margin + k_panel) + k_gap;

constexpr std::string_view k_style =
    R"(text{font:11px system-ui,sans-serif;fill:#222}.title{font-size:14px}.note{fill:#777}
.label{text-anchor:middle;stroke:#fff;stroke-width:3px;paint-order:stroke;stroke-linejoin:round}
.paired{opacity:.4}.loose{fill:#ccc;stroke:#666;stroke-dasharray:4 3;opacity:.5}
.exchanged{fill:#f6c8c8;stroke:#d33;stroke-dasharray:4 3;opacity:.5}.link{fill:none;stroke-opacity:.65}
.way{fill:none;stroke:#444;marker-end:url(#tip)})";

struct Flat {
  double x, y;
};

/// A strong colour, dark enough to be seen as a line on white.
std::string colour_of(double hue) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue / 60, 6);
    return int(std::lround(200 - 160 * std::clamp(std::min(k, 4 - k), 0.0, 1.0)));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", channel(5), channel(3), channel(1));
}

Box3d box_around(const DrawnEnd& end) {
  Box3d box;
  for (const DrawnPart& part : end.parts) {
    for (const Box3d& piece : part.pieces) box.extend(piece);
    if (part.place) box.extend(*part.place);
  }
  return box.is_empty() ? Box3d{Vec3d(-1), Vec3d(1)} : box;
}

/// From where both ends are seen, and where they are on the page.
class View {
public:
  View(const MatchDrawing& drawing, double top) : boxes_{box_around(drawing.from), box_around(drawing.to)}, top_(top) {
    const Vec3d extent = glm::max(boxes_[0].extent(), boxes_[1].extent());
    if (extent.y < 0.5 * std::min(extent.x, extent.z))
      right_ = {1, 0, 0}, down_ = {0, 0, 1}, from_ = "above";
    else if (extent.x < extent.z)
      right_ = {0, 0, -1}, down_ = {0, -1, 0}, from_ = "+x";
    const double wide = glm::dot(glm::abs(right_), extent), high = glm::dot(glm::abs(down_), extent);
    scale_ = k_panel / std::max({wide, high, 1e-9});
    height_ = high * scale_;
  }

  double height() const { return height_; }
  const char* from() const { return from_; }

  Flat operator()(size_t end, const Vec3d& p) const {
    const Vec3d q = (p - boxes_[end].centre()) * scale_;
    return {k_margin + k_panel / 2 + double(end) * (k_panel + k_gap) + glm::dot(q, right_), top_ + height_ / 2 + glm::dot(q, down_)};
  }
  Flat size(const Vec3d& extent) const { return {scale_ * glm::dot(glm::abs(right_), extent), scale_ * glm::dot(glm::abs(down_), extent)}; }

private:
  std::array<Box3d, 2> boxes_;
  double top_, scale_ = 1, height_ = 0;
  Vec3d right_{1, 0, 0}, down_{0, -1, 0};
  const char* from_ = "+z";
};

class Painter {
public:
  Painter(const MatchDrawing& drawing, double top) : drawing_(drawing), view_(drawing, top + k_title) {
    text_ = fmt::format("<text class=\"title\" x=\"{}\" y=\"{}\">{} <tspan class=\"note\">seen from {}</tspan></text>\n", k_margin,
                        top + 26, escaped(drawing.title), view_.from());
    for (size_t end : {0, 1})
      for (const DrawnPart& part : end_at(end).parts) draw(end, part);
    for (const DrawnLink& link : drawing.links) draw(link);
    for (size_t end : {0, 1})
      for (const DrawnPart& part : end_at(end).parts) draw_way(end, part);
    for (size_t end : {0, 1})
      for (const DrawnLabel& label : end_at(end).labels) draw(end, label);
  }

  const std::string& text() const { return text_; }
  double height() const { return k_title + view_.height() + k_margin; }

private:
  const DrawnEnd& end_at(size_t end) const { return end ? drawing_.to : drawing_.from; }

  void draw(size_t end, const DrawnPart& part) {
    const bool is_paired = part.look == DrawnPart::Look::paired;
    const char* look = is_paired ? "paired" : part.look == DrawnPart::Look::loose ? "loose" : "exchanged";
    const std::string colour = colour_of(part.hue);
    const std::string paint = is_paired ? fmt::format(" fill=\"{0}\" stroke=\"{0}\"", colour) : "";
    text_ += fmt::format("<g class=\"{}\"{}><title>{}</title>\n", look, paint, escaped(part.title));
    for (const Box3d& piece : part.pieces) {
      const Flat at = view_(end, piece.centre()), size = view_.size(piece.extent());
      const double round = part.is_round ? 0.5 * size.x : 0.3 * std::min(size.x, size.y);
      text_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"{:.1f}\"/>", at.x - size.x / 2,
                           at.y - size.y / 2, size.x, size.y, round);
    }
    text_ += "</g>\n";
  }

  void draw(const DrawnLink& link) {
    const DrawnPart &a = drawing_.from.parts[link.from], &b = drawing_.to.parts[link.to];
    const Flat from = view_(0, a.centre()), to = view_(1, b.centre());
    const double bend = 0.4 * (to.x - from.x);
    const std::string colour = a.look == DrawnPart::Look::exchanged ? "#d33" : colour_of(a.hue);
    const char* dashes = a.look == DrawnPart::Look::exchanged ? " stroke-dasharray=\"4 3\"" : "";
    text_ +=
        fmt::format("<path class=\"link\" stroke=\"{}\" stroke-width=\"{:.2f}\"{} d=\"M{:.1f} {:.1f}C{:.1f} {:.1f} {:.1f} {:.1f} "
                    "{:.1f} {:.1f}\"><title>{}</title></path>\n",
                    colour, link.width, dashes, from.x, from.y, from.x + bend, from.y, to.x - bend, to.y, to.x, to.y, escaped(a.title));
  }

  /// An arrow: the left end shrinks, the right one grows.
  void draw_way(size_t end, const DrawnPart& part) {
    if (!part.place) return;
    Flat tail = view_(end, part.centre()), tip = view_(end, *part.place);
    if (end) std::swap(tail, tip);
    text_ += fmt::format("<path class=\"way\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", tail.x, tail.y, tip.x, tip.y);
  }

  void draw(size_t end, const DrawnLabel& label) {
    const Flat at = view_(end, label.at);
    const double half = 0.5 * k_letter * double(label.text.size());
    const bool has_room = std::none_of(taken_.begin(), taken_.end(), [&](const Taken& t) {
      return std::abs(t.at.x - at.x) < t.half + half && std::abs(t.at.y - at.y) < k_line;
    });
    if (!has_room) return;
    taken_.push_back({at, half});
    text_ += fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", at.x, at.y + 4, escaped(label.text));
  }

  struct Taken {
    Flat at;
    double half;
  };

  const MatchDrawing& drawing_;
  View view_;
  std::string text_;
  std::vector<Taken> taken_; ///< by labels
};

} // namespace

Vec3d DrawnPart::centre() const {
  Box3d box;
  for (const Box3d& piece : pieces) box.extend(piece);
  return box.is_empty() ? Vec3d(0) : box.centre();
}

std::string svg_of(const std::vector<MatchDrawing>& drawings) {
  std::string body;
  double height = 0;
  for (const MatchDrawing& drawing : drawings) {
    const Painter painter(drawing, height);
    body += painter.text();
    height += painter.height();
  }
  constexpr std::string_view k_note =
      "Lines: what becomes what; thick where it is forced, red where one shrinks while the other grows. Dashed "
      "grey: without a counterpart, with an arrow to or from its place.";
  body += fmt::format("<text class=\"note\" x=\"{}\" y=\"{:.0f}\">{}</text>\n", k_margin, height + 8, k_note);
  return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1:.0f}\" width=\"{0}\" height=\"{1:.0f}\">\n<style>{2}"
                     "</style>\n<defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" "
                     "orient=\"auto\"><path d=\"M0 0L8 4L0 8z\" fill=\"#444\"/></marker></defs>\n<rect width=\"100%\" height=\"100%\" "
                     "fill=\"#fff\"/>\n{3}</svg>\n",
                     k_width, height + k_margin, k_style, body);
}

} // namespace kelpie
