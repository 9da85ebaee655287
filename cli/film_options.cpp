#include "cli/film_options.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "base/error.h"
#include "cli/read_options.h"
#include "colour/spaces.h"

namespace kelpie {

namespace {

[[noreturn]] void usage(const std::string& message) { throw Error(ExitStatus::usage, message); }

/// The whole text as an integer, or false.
bool parse_int(std::string_view text, int& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// `1280x720`, or `50%` of what the scene says.
Vec2i parse_resolution(const std::string& text, Vec2i of_scene) {
  int percent, width, height;
  if (!text.empty() && text.back() == '%' && parse_int(std::string_view(text).substr(0, text.size() - 1), percent) && percent >= 1 &&
      percent <= 1000)
    return glm::max(Vec2i(1), Vec2i(glm::round(glm::dvec2(of_scene) * (percent / 100.0))));
  const size_t x = text.find('x');
  const bool is_pair = x != std::string::npos && parse_int(std::string_view(text).substr(0, x), width) &&
                       parse_int(std::string_view(text).substr(x + 1), height);
  if (!is_pair || width < 1 || height < 1 || width > 65536 || height > 65536)
    usage(fmt::format("--res {}: expected WIDTHxHEIGHT (up to 65536) or a percentage, as in 1280x720 or 50%", text));
  return {width, height};
}

/// `x0,x1,y0,y1`, half-open, cut to the picture.
PixelBox parse_crop(const std::string& text, Vec2i resolution) {
  PixelBox box{0, 0, resolution.x, resolution.y};
  if (text.empty()) return box;
  int v[4];
  size_t from = 0;
  for (int i = 0; i < 4; ++i) {
    const size_t comma = i < 3 ? text.find(',', from) : text.size();
    if (comma == std::string::npos || !parse_int(std::string_view(text).substr(from, comma - from), v[i]))
      usage(fmt::format("--crop {}: expected x0,x1,y0,y1 in pixels from the top left", text));
    from = comma + 1;
  }
  box = {std::max(v[0], 0), std::max(v[2], 0), std::min(v[1], resolution.x), std::min(v[3], resolution.y)};
  if (box.is_empty()) usage(fmt::format("--crop {}: no pixel of the {}x{} picture is in it", text, resolution.x, resolution.y));
  return box;
}

bool has_cost(const Film<AnimatedMode>& film) { return std::find(film.aovs.begin(), film.aovs.end(), Aov::cost) != film.aovs.end(); }

} // namespace

void add_film_options(CLI::App& command, RenderOptions& o) {
  command.add_option("--res", o.resolution, "size of the picture: 1280x720, or 50% of the scene's");
  command.add_option("--spp", o.spp, "samples per pixel")->check(CLI::Range(1, 1 << 20));
  command.add_option("--crop", o.crop, "only these pixels: x0,x1,y0,y1 from the top left, half-open");
  command.add_flag("--heatmap", o.heatmap,
                   "add the channel cost: evaluations of fields for each sample of a pixel (`kelpie view --channel cost`; slower)");
  command.add_option("--quality", o.quality, "draft: half the size, an eighth of the samples; final: as the scene says")
      ->check(CLI::IsMember({"draft", "final"}));
  add_read_options(command, o.read);
  add_recipe_option(command, o.read);
  command
      .add_option("--max-memory", o.max_memory,
                  "what is built of a frame may take so much, 500M or 8G: beyond it cells become coarser and rays slower [no cap]")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::PositiveNumber)
      ->option_text("SIZE");
  command.add_option("--ocio", o.ocio, "an OpenColorIO config [$OCIO, else kelpie's own]");
}

PixelBox apply_film_options(const RenderOptions& options, Film<AnimatedMode>& film) {
  if (options.quality == "draft") {
    film.resolution = glm::max(Vec2i(1), film.resolution / 2);
    film.spp = std::max(1, film.spp / 8);
  }
  if (!options.resolution.empty()) film.resolution = parse_resolution(options.resolution, film.resolution);
  if (options.spp > 0) film.spp = options.spp;
  if (options.heatmap && !has_cost(film)) film.aovs.push_back(Aov::cost);
  return parse_crop(options.crop, film.resolution);
}

std::string picture_hash(const Scene& scene, const PixelBox& window) {
  return fmt::format("{}:kelpie {}:ocio {}:{}x{}:{}spp:{},{},{},{}{}", scene.hash, KELPIE_VERSION, ocio_config_id(),
                     scene.film.resolution.x, scene.film.resolution.y, scene.film.spp, window.x0, window.x1, window.y0, window.y1,
                     has_cost(scene.film) ? ":cost" : "");
}

} // namespace kelpie
