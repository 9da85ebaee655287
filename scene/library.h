// What a file may hold that scenes include.
#pragma once

#include "scene/scene.h"

namespace kelpie {

struct Library {
  static constexpr std::string_view k_name = "library";
  static constexpr std::string_view k_doc = R"(A file of variables, materials, parts and recipes, for scenes to `include`.

    { "kelpie": 1, "parts": { "drop": { "kind": "point", "centre": [0, 0, 0], "radius": 1 } } }

What it holds stands in the scene as if it were written there: no two parts of all files share a name, and `--set parts.drop.radius=2`
changes it. A library may include others; each counts once, however many files include it. Files that it names are
relative to it, and lie in the scene's folder tree like all others (`--allow-path` permits others).
For an editor: `"$schema": "schema.json#/$defs/library"`, with what `kelpie schema` prints.)";

  int version = 1;
  std::string schema;
  std::optional<double> units;
  std::vector<std::string> include;
  decltype(Scene::variables) variables;
  decltype(Scene::materials) materials;
  decltype(Scene::parts) parts;
  FreeObject recipes;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("kelpie", &Library::version, "version of the format").at_least(1).at_most(1).required(),
        parameter("$schema", &Library::schema, "where editors find the JSON schema; not used otherwise"),
        parameter("units", &Library::units, "metres per unit: where it is said, scenes that include the file must have the same").above(0),
        parameter("include", &Library::include, "further libraries"),
        parameter("variables", &Library::variables, "numbers by name, for expressions"),
        parameter("materials", &Library::materials, "materials by name, for shapes and fields"),
        parameter("parts", &Library::parts, "fields by name, for instances"),
        parameter("recipes", &Library::recipes, "variations of a scene by name, for `--recipe`"),
    };
  }
};

} // namespace kelpie
