#include "cli/make_recipes.h"

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
  std::string path;                  ///< as of --set
  std::vector<std::string> objects;  ///< their names, or numbers from 1
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
    Found found{path, {}, {}};
    for (const JsonValue& object : *objects->array()) {
      const JsonValue* own = object.find("name");
      found.objects.push_back(own && own->string() ? *own->string() : std::to_string(found.objects.size() + 1));
      if (const JsonValue* elements = object.find("elements"); elements && elements->array())
        for (const JsonValue& e : *elements->array())
          if (const JsonValue* name = e.find("name"); name && name->string())
            if (std::find(found.features.begin(), found.features.end(), *name->string()) == found.features.end())
              found.features.push_back(*name->string());
    }
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
  const std::vector<double> stance = draw_weights(found.objects.size(), dice); // one for all: so that features meet
  nlohmann::ordered_json features = nlohmann::ordered_json::array();
  for (const std::string& name : found.features) {
    std::vector<double>& weights = drawn[without_side(name)];
    if (weights.empty()) weights = draw_weights(found.objects.size(), dice);
    features.push_back({{"name", name}, {"weights", weights}, {"frame_weights", stance}});
  }
  return features;
}

std::vector<Found> find_metamorphoses(const std::string& scene) {
  ProblemList problems;
  const Document document = read_document(scene, problems);
  problems.throw_if_any();
  Finder finder;
  finder.visit(document.root, "");
  std::erase_if(finder.all, [](const Found& found) { return found.objects.size() < 2; });
  return finder.all;
}

/// A library of recipes, a line for each row of a list.
std::string library_of(const nlohmann::ordered_json& recipes, const std::string& made_by) {
  std::string out = fmt::format("// Made by `kelpie sheet {}`.\n{{\n  \"kelpie\": 1,\n  \"recipes\": {{\n", made_by);
  size_t left = recipes.size();
  for (const auto& [name, recipe] : recipes.items()) {
    out += fmt::format("    \"{}\": {{\n", name);
    size_t changes = recipe.size();
    for (const auto& [path, value] : recipe.items()) {
      std::string text = value.dump();
      if (value.is_array()) {
        std::vector<std::string> rows;
        for (const auto& row : value) rows.push_back(fmt::format("        {}", row.dump()));
        text = fmt::format("[\n{}\n      ]", fmt::join(rows, ",\n"));
      }
      out += fmt::format("      \"{}\": {}{}\n", path, text, --changes ? "," : "");
    }
    out += fmt::format("    }}{}\n", --left ? "," : "");
  }
  return out + "  }\n}\n";
}

/// All features as the objects' own weights say.
nlohmann::ordered_json plain_features(const Found& found) {
  nlohmann::ordered_json features = nlohmann::ordered_json::array();
  for (const std::string& name : found.features) features.push_back({{"name", name}});
  return features;
}

} // namespace

std::string random_recipes(const std::string& scene, int count, unsigned seed) {
  std::vector<Found> all = find_metamorphoses(scene);
  std::erase_if(all, [](const Found& found) { return found.features.empty(); });
  if (all.empty())
    throw Error(ExitStatus::bad_data,
                fmt::format("{}: random recipes are drawn for features, and there is no metamorphosis with elements", scene));
  Dice dice(seed);
  nlohmann::ordered_json recipes;
  for (int i = 1; i <= count; ++i) {
    nlohmann::ordered_json& recipe = recipes[fmt::format("random_{:0{}}", i, std::max<size_t>(3, std::to_string(count).size()))];
    for (const Found& found : all) recipe[found.path + ".features"] = draw_features(found, dice);
  }
  return library_of(recipes, fmt::format("--random {} --seed {}", count, seed));
}

PairRecipes pair_recipes(const std::string& scene) {
  const std::vector<Found> all = find_metamorphoses(scene);
  if (all.size() != 1)
    throw Error(ExitStatus::bad_data, fmt::format("{}: pairs are those of the objects of one metamorphosis, and there {}", scene,
                                                  all.empty() ? "is none" : fmt::format("are {}", all.size())));
  const Found& found = all.front();
  nlohmann::ordered_json recipes;
  for (size_t i = 0; i < found.objects.size(); ++i)
    for (size_t j = 0; j < found.objects.size(); ++j) {
      nlohmann::ordered_json& recipe = recipes[fmt::format("pair_{}_{}", i + 1, j + 1)];
      recipe[found.path + ".features"] = plain_features(found);
      for (size_t k = 0; k < found.objects.size(); ++k)
        recipe[fmt::format("{}.objects.{}.weight", found.path, k)] = (k == i ? 2 : 0) + (k == j ? 1 : 0);
    }
  return {library_of(recipes, "--pairs"), found.objects};
}

} // namespace kelpie
