#include "cli/random_recipes.h"

#include <algorithm>
#include <map>
#include <random>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "scene/document.h"

namespace kelpie {

namespace {

/// A metamorphosis in a document.
struct Found {
  std::string path; ///< as of --set
  size_t objects = 0;
  std::vector<std::string> features; ///< each once
};

class Finder {
public:
  void visit(const JsonValue& v, const std::string& path) {
    if (const JsonValue* kind = v.find("kind"); kind && kind->string() && *kind->string() == "metamorphosis") add(v, path);
    if (const auto* members = v.object())
      for (const JsonMember& m : *members) visit(m.value, path.empty() ? m.key : path + "." + m.key);
    if (const auto* elements = v.array())
      for (size_t i = 0; i < elements->size(); ++i) visit((*elements)[i], fmt::format("{}.{}", path, i));
  }

  std::vector<Found> all;

private:
  void add(const JsonValue& v, const std::string& path) {
    const JsonValue* objects = v.find("objects");
    if (!objects || !objects->array()) return;
    Found found{path, objects->array()->size(), {}};
    for (const JsonValue& object : *objects->array())
      if (const JsonValue* elements = object.find("elements"); elements && elements->array())
        for (const JsonValue& e : *elements->array())
          if (const JsonValue* name = e.find("name"); name && name->string())
            if (std::find(found.features.begin(), found.features.end(), *name->string()) == found.features.end())
              found.features.push_back(*name->string());
    all.push_back(std::move(found));
  }
};

/// "back_left_leg" and "back_right_leg" are sides of one.
std::string without_side(std::string name) {
  for (const std::string_view side : {"left", "right"})
    if (const size_t at = name.find(side); at != std::string::npos) return name.erase(at, side.size());
  return name;
}

/// std::mt19937 is the same everywhere; the standard's distributions are not.
class Dice {
public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double part() { return double(engine_()) / 4294967296.0; }
  size_t below(size_t n) { return std::min(n - 1, size_t(part() * double(n))); }

private:
  std::mt19937 engine_;
};

/// One parent, or two mixed.
std::vector<double> draw_weights(size_t objects, Dice& dice) {
  constexpr double k_alone = 0.6;
  std::vector<double> weights(objects, 0);
  weights[dice.below(objects)] = 1;
  if (dice.part() >= k_alone) {
    const double part = std::round(10 * (0.2 + 0.6 * dice.part())) / 10;
    for (double& w : weights) w *= 1 - part;
    weights[dice.below(objects)] += part;
  }
  for (double& w : weights) w = std::round(10 * w) / 10; // as people write them
  return weights;
}

nlohmann::ordered_json draw_features(const Found& found, Dice& dice) {
  std::map<std::string, std::vector<double>> drawn;
  const std::vector<double> stance = draw_weights(found.objects, dice); // one for all: so that features meet
  nlohmann::ordered_json features = nlohmann::ordered_json::array();
  for (const std::string& name : found.features) {
    std::vector<double>& weights = drawn[without_side(name)];
    if (weights.empty()) weights = draw_weights(found.objects, dice);
    features.push_back({{"name", name}, {"weights", weights}, {"frame_weights", stance}});
  }
  return features;
}

} // namespace

std::string random_recipes(const std::string& scene, int count, unsigned seed) {
  ProblemList problems;
  const Document document = read_document(scene, problems);
  problems.throw_if_any();
  Finder finder;
  finder.visit(document.root, "");
  std::erase_if(finder.all, [](const Found& found) { return found.objects < 2 || found.features.empty(); });
  if (finder.all.empty())
    throw Error(ExitStatus::bad_data,
                fmt::format("{}: random recipes are drawn for features, and there is no metamorphosis with elements", scene));
  Dice dice(seed);
  nlohmann::ordered_json recipes;
  for (int i = 1; i <= count; ++i) {
    nlohmann::ordered_json& recipe = recipes[fmt::format("random_{:0{}}", i, std::max<size_t>(3, std::to_string(count).size()))];
    for (const Found& found : finder.all) recipe[found.path + ".features"] = draw_features(found, dice);
  }
  std::string out =
      fmt::format("// Drawn by `kelpie sheet --random {} --seed {}`.\n{{\n  \"kelpie\": 1,\n  \"recipes\": {{\n", count, seed);
  size_t left = recipes.size();
  for (const auto& [name, recipe] : recipes.items()) {
    out += fmt::format("    \"{}\": {{\n", name);
    size_t changes = recipe.size();
    for (const auto& [path, features] : recipe.items()) {
      std::vector<std::string> rows;
      for (const auto& row : features) rows.push_back(fmt::format("        {}", row.dump()));
      out += fmt::format("      \"{}\": [\n{}\n      ]{}\n", path, fmt::join(rows, ",\n"), --changes ? "," : "");
    }
    out += fmt::format("    }}{}\n", --left ? "," : "");
  }
  return out + "  }\n}\n";
}

} // namespace kelpie
