#include "scene/recipes.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/suggest.h"
#include "scene/overrides.h"

namespace kelpie {

namespace {

constexpr std::string_view k_key = "recipes";

/// Null where there are none.
const JsonValue::Object* recipes_of(const Document& document) {
  const JsonValue* recipes = document.root.find(k_key);
  return recipes ? std::get_if<JsonValue::Object>(&recipes->data) : nullptr;
}

} // namespace

void apply_recipe(Document& document, const std::string& name, ProblemList& problems) {
  const std::vector<std::string> names = recipe_names(document);
  const JsonValue::Object* recipes = recipes_of(document);
  const auto recipe = recipes ? std::find_if(recipes->begin(), recipes->end(), [&](const JsonMember& m) { return m.key == name; })
                              : JsonValue::Object::const_iterator{};
  if (!recipes || recipe == recipes->end()) {
    const std::vector<std::string_view> known(names.begin(), names.end());
    const TextPosition at{0, 0, static_cast<std::uint32_t>(document.sources.size())};
    document.sources.push_back({"--recipe " + name, {}, true});
    return problems.add(document.where(at), names.empty() ? std::string("the scene has no recipes")
                                                          : fmt::format("there is none of that name{}", suggestion(name, known)));
  }
  const auto* members = std::get_if<JsonValue::Object>(&recipe->value.data);
  if (!members)
    return problems.add(document.where(recipe->value.at),
                        fmt::format("a recipe is an object of paths and values, as --set has them; this is {}", describe(recipe->value)));
  const JsonValue::Object changes = *members; // what they change is the document that they stand in
  for (const JsonMember& change : changes) apply_override(document, change.key, change.value, change.key_at, problems);
}

std::vector<std::string> recipe_names(const Document& document) {
  std::vector<std::string> names;
  if (const JsonValue::Object* recipes = recipes_of(document))
    for (const JsonMember& m : *recipes) names.push_back(m.key);
  return names;
}

void remove_recipes(Document& document) {
  if (auto* members = std::get_if<JsonValue::Object>(&document.root.data))
    std::erase_if(*members, [](const JsonMember& m) { return m.key == k_key; });
}

} // namespace kelpie
