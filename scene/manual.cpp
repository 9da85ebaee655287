#include "scene/manual.h"

#include <algorithm>

#include "materials/presets.h"
#include "scene/other_names.h"
#include "scene/parameter_text.h"
#include "scene/value_reader.h"

namespace kelpie {

std::string_view unit_text(Unit unit) {
  switch (unit) {
  case Unit::none: return "";
  case Unit::length: return "scene units";
  case Unit::degrees: return "degrees";
  case Unit::frames: return "frames";
  case Unit::pixels: return "pixels";
  }
  return "";
}

namespace {

struct Page {
  std::string_view group, name, doc;
  std::string parameters; ///< the text below the doc
};

template <class T>
constexpr bool k_may_be_animated = IsAnimated<T>;
template <class T>
constexpr bool k_may_be_animated<std::optional<T>> = IsAnimated<T>;

/// "number > 0, scene units, may be animated, default 1": all that a table says, in one line.
template <class T>
std::string facts_of(const ParameterRules& rules, const T& default_value) {
  std::string type = type_text<T>();
  const std::string range = describe(rules.range);
  const bool is_one_number = type == "number" || type == "whole number";
  if (rules.is_number_for_all) type += IsList<T> ? " or a single one" : " or a number for all three";
  if (!rules.library.empty()) type += fmt::format(" or the name of one of the scene's `{}`", rules.library);
  if (!range.empty() && is_one_number) type += " " + range;
  std::vector<std::string> facts{type};
  if (!range.empty() && !is_one_number) facts.push_back("each " + range);
  if (rules.least_count > 1) facts.push_back(fmt::format("at least {}", rules.least_count));
  if (rules.is_nonzero) facts.push_back("not zero");
  if (rules.unit != Unit::none) facts.emplace_back(unit_text(rules.unit));
  if (k_may_be_animated<T>) facts.push_back("may be animated");
  const std::string value = json_text(default_value);
  if (rules.is_required)
    facts.push_back(rules.alternative.empty() ? "required" : fmt::format("this or `{}` is required", rules.alternative));
  else if (!rules.alternative.empty())
    facts.push_back(fmt::format("excludes `{}`", rules.alternative));
  if (!rules.is_required && !value.empty()) facts.push_back("default " + value);
  return fmt::format("{}", fmt::join(facts, ", "));
}

template <Record T>
Page page_of(std::string_view group, bool is_kind) {
  size_t width = 0;
  for_each_parameter<T>([&](const auto& row) { width = std::max(width, row.name.size()); });
  const T defaults{};
  std::string text = "Parameters:\n";
  bool is_animated = false;
  for_each_parameter<T>([&](const auto& row) {
    text += fmt::format("  {:<{}}  {}\n  {:<{}}  {}\n", row.name, width, facts_of(row, defaults.*(row.member)), "", width, row.doc);
    is_animated |= IsAnimated<MemberOf<decltype(row)>>;
  });
  text += fmt::format("\nAt least: {}\n", minimal_json<T>(is_kind));
  if (is_field_node<T>()) text += "It may have a `material` of its own (`kelpie kinds material`), and a `name`.\n";
  if (is_animated)
    text += "What may be animated is a constant, a curve (`kelpie kinds keys`) or an expression (`kelpie kinds expression`).\n";
  return {group, T::k_name, T::k_doc, text};
}

template <class List, template <class> class Kind>
constexpr bool k_has_kind = false;
template <template <class> class... Kinds, template <class> class Kind>
constexpr bool k_has_kind<KindList<Kinds...>, Kind> = (std::is_same_v<Kinds<AnimatedMode>, Kind<AnimatedMode>> || ...);

/// Kinds of field are grouped by what they are made of.
template <template <class> class Kind>
std::string_view field_group() {
  if (k_has_kind<Concat<MorphFolderKinds, TreeMakerKinds>, Kind>) return "fields: morphs";
  if (ComplexPrimitive<Kind<SampledMode>>) return "fields: complex primitives";
  using K = Kind<SampledMode>;
  if (SignedDistance<K>) return "fields: signed distances";
  if (Operator<K>) return "fields: operators";
  if (AffineWarp<K> || Warp<K>) return "fields: warps";
  return HasAssets<K> ? "fields: clouds" : "fields: skeletons";
}

/// Materials, too.
template <template <class> class Kind>
std::string_view material_group() {
  return requires(const Kind<SampledMode> k) { k.surface(); }
  ? "surfaces" : "patterns";
}

constexpr std::string_view k_keys_doc = R"(A value that changes over time.

    { "keys": [[1, 0], [24, 1.5]], "interpolation": "smooth", "after": "cycle" }

Each key is [frame, value]; frames ascend and need not be whole. `interpolation` between two of them:
    linear     straight (the default)
    step       the value holds until the next key
    smooth     starts and stops gently, and never leaves the values of two neighbours
    spline     passes through the keys in a curve that may swing beyond them
    hermite    derivatives per frame follow the value, as in [1, 0, 0.5]; up to 4 of them. Where they differ before and after a
               key: [1, 0, { "before": [0.5], "after": [-0.5] }]
`before` the first key and `after` the last:
    hold           the value stays (the default)
    cycle          begins again, every (last - first) frames; where the last value is the first, `smooth` and `spline` close the loop without a corner
    cycle_offset   begins again from where it has come to: steps of a walk
    ping_pong      back and forth
    continue       straight on
A component of a vector or colour may have keys of its own: [0, { "keys": … }, 0]. A formula instead of keys: `kelpie kinds expression`.
Sources: Barbier, Galin, Akkouche (Hermite-Ferguson interpolation; methods.md section 2); Fritsch and Butland 1984; Catmull and Rom 1974.)";

constexpr std::string_view k_expression_doc = R"doc(A number that follows a formula of the frame.

    "radius": { "expression": "1 + 0.3*sin(2*pi*frame/48)" }
    "position": [0, { "expression": "height*abs(sin(pi*frame/12))" }, 0]

It may stand for any number that may be animated, and for any component of a vector or colour. `frame` is the frame in the time of the
node: within an instance it is shifted and scaled like keys are, and moments between frames have fractions. Other names are the
scene's `variables`, which are constants, keys or expressions themselves, and which `--set variables.height=2` changes:

    "variables": { "height": 2, "beat": { "expression": "sin(2*pi*frame/24)" } }

    + - * / ^    < > <= >= == != && ||    a ? b : c    ( )    pi
    sin cos tan asin acos atan atan2(y, x) sinh cosh tanh exp ln log10 log2 sqrt pow(a, b) abs sign
    floor ceil round fract mod(a, b) min max clamp(v, low, high) mix(a, b, t) smoothstep(from, to, v)
    noise(v)     smooth and random, about one swing a unit: mean 0, mostly within -2 to 2, the same at each run
Angles are radians; -a^2 is -(a^2). When a scene is read, a formula is tried at up to 100 moments of its frames. A fault between these, where it
has no value or one that its parameter may not have, is an error of the frame that asks for it (`kelpie check -f 505` tries one).)doc";

constexpr std::string_view k_material_doc = R"(What things are made of: a surface, or a pattern that ranges over materials.

    { "kind": "metal", "colour": [1, 0.77, 0.34] }        a surface
    { "kind": "marble", "stops": [{ "at": 0, "material": "gold" }, …] }    a pattern
    "gold"                                                one of the scene's `materials`, else one that kelpie knows, else a kind as it is by default

A shape has a `surface`. Any node of its field may have a `material`, which counts for all below it that have none of their own.
Where several meet they are mixed as their potentials f are (all at least 0):
    blend, blobs    (f_A A + f_B B) / (f_A + f_B)            hyper_blend    the same with f^n
    union           that of the largest f                    intersection   that of the smallest
    difference      that of the smallest of f_A, 2T - f_B    local_blend    f_R blend + (1 - f_R) union
A shape may also lie in a `texture`, another field with materials: where that is above 0 it counts. So does, first found: the
texture, the shape's own field, `surface`. A pattern lives in the space of the node that has it: warps and motion carry it along.
Source: Barbier, Galin, Akkouche, section 4; methods.md section 2.)";

constexpr std::string_view k_colour_doc = R"(A colour, in one of three forms.

    [0.8, 0.2, 0.1]                                   scene-linear red, green, blue
    "#c8553d"                                         as colour pickers show it (the OCIO role color_picking)
    { "space": "Linear Rec.709", "rgb": [1, 0, 0] }   any space or role of the OCIO config
)";

/// What a preset stands for.
std::string page_text(const Preset& preset) {
  std::string members;
  const OpenPbr<SampledMode> defaults, surface = preset.surface();
  const auto add = [&](const auto& row) {
    if (!(defaults.*(row.member) == surface.*(row.member)))
      members += fmt::format(", \"{}\": {}", row.name, json_text(surface.*(row.member)));
  };
  for_each_parameter<OpenPbr<SampledMode>>(add);
  return fmt::format("{{ \"kind\": \"openpbr\"{} }}\n", members);
}

std::vector<Page> all_pages() {
  std::vector<Page> pages;
  for_each_group([&]<class Group>(const Group& group) {
    if constexpr (std::is_same_v<Group, KindGroup<SceneFieldKinds>>)
      SceneFieldKinds::for_each(
          [&]<template <class> class Kind>() { pages.push_back(page_of<Kind<AnimatedMode>>(field_group<Kind>(), true)); });
    else if constexpr (std::is_same_v<Group, KindGroup<MaterialKinds>>)
      MaterialKinds::for_each(
          [&]<template <class> class Kind>() { pages.push_back(page_of<Kind<AnimatedMode>>(material_group<Kind>(), true)); });
    else
      group.for_each([&]<class T>() { pages.push_back(page_of<T>(group.heading, Group::k_is_kinds)); });
  });
  for (const Preset& preset : k_presets) pages.push_back({"materials by name", preset.name, preset.doc, page_text(preset)});
  pages.push_back({"values", "keys", k_keys_doc, {}});
  pages.push_back({"values", "expression", k_expression_doc, {}});
  pages.push_back({"values", "colour", k_colour_doc, {}});
  pages.push_back({"values", "material", k_material_doc, {}});
  pages.push_back({"values", "falloff", k_falloff_doc, {}});
  return pages;
}

} // namespace

std::string manual_index() {
  const std::vector<Page> pages = all_pages();
  size_t width = 0;
  std::vector<std::string_view> groups;
  for (const Page& p : pages) {
    width = std::max(width, p.name.size());
    if (std::find(groups.begin(), groups.end(), p.group) == groups.end()) groups.push_back(p.group);
  }
  std::string text;
  for (const std::string_view group : groups) {
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", group);
    for (const Page& p : pages)
      if (p.group == group) text += fmt::format("  {:<{}}  {}\n", p.name, width, p.doc.substr(0, p.doc.find('\n')));
  }
  return text;
}

std::string manual_page(std::string_view name) {
  std::string text;
  std::vector<std::string_view> names;
  for (const Page& p : all_pages()) {
    names.push_back(p.name);
    if (p.name != name) continue;
    if (!text.empty()) text += "\n";
    text += fmt::format("{} ({})\n\n{}\n", p.name, p.group, p.doc);
    if (!p.parameters.empty()) text += "\n" + p.parameters;
  }
  if (text.empty()) {
    const std::string near = near_names(name, names);
    throw Error(ExitStatus::usage,
                fmt::format("no kind is called {}{}", in_quotes(name), near.empty() ? "; `kelpie kinds` lists them all" : near));
  }
  return text;
}

} // namespace kelpie
