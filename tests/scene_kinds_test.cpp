// One round over all kinds: what the tables say is what the reader, the manual and the schema do.
#include <cmath>
#include <filesystem>
#include <fstream>

#include "scene/document.h"
#include "scene/manual.h"
#include "scene/other_names.h"
#include "scene/parameter_text.h"
#include "scene/reserved.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

const std::string k_point = R"({"kind":"point","centre":[0,0,0],"radius":1})";

/// A minimal scene, and where in it the object under test stands.
struct Place {
  std::string scene, path;
};

Place place_of(std::string_view group, const std::string& json) {
  const std::string shape = "{\"kelpie\":1,\"shapes\":[{\"name\":\"a\",";
  if (group == "field" && json.find("sdf_plane") != json.npos) // alone it has no end
    return {shape + R"("field":{"kind":"intersection","children":[)" + json + "," + k_point + "]}}]}", "shapes.a.field.children.0"};
  if (group == "field") return {shape + "\"field\":" + json + "}],\"parts\":{\"part\":" + k_point + "}}", "shapes.a.field"};
  if (group == "axial_axis")
    return {shape + R"("field":{"kind":"axial","axes":[)" + json + R"(],"child":)" + k_point + "}}]}", "shapes.a.field.axes.0"};
  if (group == "axial_frame")
    return {shape + R"("field":{"kind":"axial","axes":[{"rest":[[0,0,0],[0,1,0]],"deformed":[[0,0,0],[1,0,0]],"radius":1,"frames":[)" +
                json + R"(]}],"child":)" + k_point + "}}]}",
            "shapes.a.field.axes.0.frames.0"};
  const std::string metamorphosis = shape + R"("field":{"kind":"metamorphosis","objects":[)";
  const std::string ball = R"("field":{"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":1})";
  if (group == "morph_object") return {metamorphosis + json + "," + json + "]}}]}", "shapes.a.field.objects.0"};
  if (group == "feature_element") {
    const std::string object = "{" + ball + R"(,"elements":[)" + json + "]}";
    return {metamorphosis + object + "," + object + "]}}]}", "shapes.a.field.objects.0.elements.0"};
  }
  if (group == "morph_feature") { // of the name that it has
    const std::string object = "{" + ball + R"(,"elements":[{"centre":[0,0,0],"size":1,"name":"my name"}]})";
    return {metamorphosis + object + "," + object + R"(],"features":[)" + json + "]}}]}", "shapes.a.field.features.0"};
  }
  if (group == "stop")
    return {shape + "\"field\":" + k_point + R"(,"surface":{"kind":"marble","stops":[)" + json + "]}}]}", "shapes.a.surface.stops.0"};
  if (group == "geometry") return {shape + "\"geometry\":" + json + "}]}", "shapes.a.geometry"};
  if (group == "material") return {shape + "\"field\":" + k_point + ",\"surface\":" + json + "}]}", "shapes.a.surface"};
  if (group == "light")
    return {"{\"kelpie\":1,\"lights\":[" + json + "],\"shapes\":[{\"name\":\"a\",\"field\":" + k_point + "}]}", "lights.0"};
  if (group == "shape") return {"{\"kelpie\":1,\"shapes\":[" + json + "]}", "shapes.0"};
  return {"{\"kelpie\":1,\"" + std::string(group) + "\":" + json + ",\"shapes\":[{\"name\":\"a\",\"field\":" + k_point + "}]}",
          std::string(group)};
}

/// The object of type `T` that was read.
template <class T>
const T& found(const Scene& s) {
  if constexpr (std::is_same_v<T, Shape>)
    return s.shapes[0];
  else if constexpr (std::is_same_v<T, Frames>)
    return s.frames;
  else if constexpr (std::is_same_v<T, Camera<AnimatedMode>>)
    return s.camera;
  else if constexpr (std::is_same_v<T, Film<AnimatedMode>>)
    return s.film;
  else if constexpr (requires { T::k_is_unbounded; })
    return std::get<T>(std::get<Intersection<AnimatedMode>>(s.shapes[0].field->kind).children[0]->kind);
  else if constexpr (std::is_same_v<T, AxialAxis<AnimatedMode>>)
    return std::get<Axial<AnimatedMode>>(s.shapes[0].field->kind).axes[0];
  else if constexpr (std::is_same_v<T, AxialFrame<AnimatedMode>>)
    return std::get<Axial<AnimatedMode>>(s.shapes[0].field->kind).axes[0].frames[0];
  else if constexpr (std::is_same_v<T, MorphObject<AnimatedMode>>)
    return std::get<Metamorphosis<AnimatedMode>>(s.shapes[0].field->kind).objects[0];
  else if constexpr (std::is_same_v<T, FeatureElement<AnimatedMode>>)
    return std::get<Metamorphosis<AnimatedMode>>(s.shapes[0].field->kind).objects[0].elements[0];
  else if constexpr (std::is_same_v<T, MorphFeature<AnimatedMode>>)
    return std::get<Metamorphosis<AnimatedMode>>(s.shapes[0].field->kind).features[0];
  else if constexpr (std::is_constructible_v<FieldKinds::Variant<AnimatedMode>, T>)
    return std::get<T>(s.shapes[0].field->kind);
  else if constexpr (std::is_same_v<T, Stop<AnimatedMode>>)
    return std::get<Marble<AnimatedMode>>(s.shapes[0].surface->kind).stops[0];
  else if constexpr (std::is_constructible_v<MaterialKinds::Variant<AnimatedMode>, T>)
    return std::get<T>(s.shapes[0].surface->kind);
  else if constexpr (std::is_constructible_v<GeometryKinds::Variant<AnimatedMode>, T>)
    return std::get<T>(*s.shapes[0].geometry);
  else
    return std::get<T>(s.lights[0]);
}

/// A kind or record with the name of its group (a record is its own), as a type that a visitor can take.
template <class T>
struct Case {
  using Type = T;
  std::string_view group;
  bool is_kind;
};

/// Visits all that has a page.
template <class Visitor>
void for_everything(const Visitor& visit) {
  for_each_group([&]<class Group>(const Group& group) {
    group.for_each([&]<class T>() {
      if constexpr (Group::k_is_kinds)
        visit(Case<T>{group.name, true});
      else
        visit(Case<T>{T::k_name, false});
    });
  });
}

/// What is not there any more when a scene has been read: tests/animorphosis_test.cpp.
template <class T>
constexpr bool k_is_replaced = std::is_same_v<T, Animorphosis<AnimatedMode>> || std::is_same_v<T, NodePair<AnimatedMode>>;

/// Visits all that stands somewhere in a scene.
template <class Visitor>
void for_all_within_a_scene(const Visitor& visit) {
  for_everything([&]<class T>(const Case<T>& c) {
    if constexpr (!std::is_same_v<T, Scene> && !std::is_same_v<T, Library> && !k_is_replaced<T>) visit(c);
  });
}

TEST(EveryKind, IsReadFromItsLeastTextWithTheTablesDefaults) {
  const SceneFolder folder;
  int defaults_read = 0;
  for_all_within_a_scene([&](const auto& c) {
    using T = typename std::decay_t<decltype(c)>::Type;
    const Place place = place_of(c.group, minimal_json<T>(c.is_kind));
    ASSERT_EQ(folder.errors(place.scene), "") << place.scene;
    const Scene scene = folder.read(place.scene);
    sample(scene, 1);
    const T defaults{};
    const T& read = found<T>(scene);
    for_each_parameter<T>([&](const auto& row) {
      if (row.is_required || place.scene.find(fmt::format("\"{}\": 2", row.name)) != std::string::npos) return; // it says so
      if constexpr (std::is_same_v<T, Transition<AnimatedMode>>)
        if (row.name == "way") {
          EXPECT_EQ(read.way, TransitionWay::dissolve); // chosen when it was read
          return;
        }
      EXPECT_EQ(json_text(read.*(row.member)), json_text(defaults.*(row.member))) << T::k_name << "." << row.name;
      ++defaults_read;
    });
  });
  EXPECT_GT(defaults_read, 100);
}

TEST(EveryParameter, RefusesWhatItIsNot) {
  const SceneFolder folder;
  for_all_within_a_scene([&](const auto& c) {
    using T = typename std::decay_t<decltype(c)>::Type;
    const Place place = place_of(c.group, minimal_json<T>(c.is_kind));
    for_each_parameter<T>([&](const auto& row) {
      const std::string assignment = fmt::format("{}.{}=null", place.path, row.name);
      const std::string errors = folder.errors(place.scene, {{assignment}, {}});
      EXPECT_EQ(errors.find(fmt::format("--set {}: {}: expected ", assignment, row.name)), 0u) << errors;
    });
  });
}

/// A number just outside the range at one end, if there is one.
std::vector<double> outside(const Range& range) {
  std::vector<double> numbers;
  if (!std::isinf(range.lower)) numbers.push_back(range.lower_open ? range.lower : range.lower - 1);
  if (!std::isinf(range.upper)) numbers.push_back(range.upper_open ? range.upper : range.upper + 1);
  if (range.without_zero) numbers.push_back(0);
  return numbers;
}

TEST(EveryParameter, KeepsToItsRange) {
  const SceneFolder folder;
  int checked = 0;
  for_all_within_a_scene([&](const auto& c) {
    using T = typename std::decay_t<decltype(c)>::Type;
    const Place place = place_of(c.group, minimal_json<T>(c.is_kind));
    for_each_parameter<T>([&](const auto& row) {
      const T defaults{};
      // As many components as the default has.
      const std::string text = json_text(defaults.*(row.member));
      const bool is_vector = !text.empty() && text[0] == '[';
      for (const double number : outside(row.range)) {
        const auto commas = std::count(text.begin(), text.end(), ',');
        const bool is_list = IsList<MemberOf<decltype(row)>> && !row.is_number_for_all;
        const std::string value = is_list       ? fmt::format("[{}]", number)
                                  : !is_vector  ? fmt::format("{}", number)
                                  : commas == 1 ? fmt::format("[1,{}]", number)
                                                : fmt::format("[1,1,{}]", number);
        const std::string errors = folder.errors(place.scene, {{fmt::format("{}.{}={}", place.path, row.name, value)}, {}});
        EXPECT_NE(errors.find(fmt::format(": {} must be ", row.name)), std::string::npos) << T::k_name << " " << value << " " << errors;
        ++checked;
      }
    });
  });
  EXPECT_GT(checked, 20);
}

TEST(EveryParameter, ThatMayBeAnimatedTakesACurve) {
  const SceneFolder folder;
  int curves = 0;
  for_all_within_a_scene([&](const auto& c) {
    using T = typename std::decay_t<decltype(c)>::Type;
    const Place place = place_of(c.group, minimal_json<T>(c.is_kind));
    for_each_parameter<T>([&](const auto& row) {
      if constexpr (IsAnimated<MemberOf<decltype(row)>>) {
        const std::string value = json_text(T{}.*(row.member));
        for (const std::string_view how : enum_names<Interpolation>()) {
          const std::string curve = fmt::format(R"({{"keys":[[1,{}],[2.5,{}]],"interpolation":"{}"}})", value, value, how);
          const ReadOptions options{{fmt::format("{}.{}={}", place.path, row.name, curve)}, {}};
          ASSERT_EQ(folder.errors(place.scene, options), "");
          const Scene scene = folder.read(place.scene, options);
          const auto& read = found<T>(scene).*(row.member);
          ASSERT_TRUE(read.curve());
          EXPECT_EQ(read.curve()->keys().size(), 2u);
          EXPECT_EQ(json_text(read.curve()->interpolation()), fmt::format("\"{}\"", how));
          EXPECT_EQ(json_text(read), value);
          ++curves;
        }
      }
    });
  });
  EXPECT_GT(curves, 300);
}

TEST(Lists, OfPlacesMayMoveOneByOne) {
  const SceneFolder folder;
  const std::string hull = R"({"kind":"polyhedron","radius":1,"points":[[0,1,0],{"keys":[[1,[1,0,0]],[3,[3,0,0]]]},[0,0,2]]})";
  const Place place = place_of("field", hull);
  ASSERT_EQ(folder.errors(place.scene), "");
  const FrameScene at = sample(folder.read(place.scene), 2);
  const auto& points = std::get<Polyhedron<SampledMode>>(at.shapes[0].field.nodes[0]).points;
  EXPECT_EQ(points, (std::vector<Vec3>{Vec3(0, 1, 0), Vec3(2, 0, 0), Vec3(0, 0, 2)}));
  EXPECT_EQ(folder.errors(place.scene, {{place.path + ".points=[]"}, {}}), "--set " + place.path + ".points=[]: points may not be empty");
}

TEST(EveryKind, HasAPageThatTellsAll) {
  const std::string index = manual_index();
  for_everything([&](const auto& c) {
    using T = typename std::decay_t<decltype(c)>::Type;
    EXPECT_NE(index.find(fmt::format("\n  {} ", T::k_name)), std::string::npos) << T::k_name;
    const std::string page = manual_page(T::k_name);
    EXPECT_NE(page.find(T::k_doc), std::string::npos);
    for_each_parameter<T>([&](const auto& row) { EXPECT_NE(page.find(row.doc), std::string::npos) << row.name; });
  });
  EXPECT_NE(manual_page("point").find("radius          number > 0, scene units, may be animated, this or `surface_radius` is required"),
            std::string::npos);
  EXPECT_NE(index.find("fields: warps\n  translate"), std::string::npos);
  EXPECT_NE(manual_page("falloff").find("cubic     q^3"), std::string::npos);
  const auto refusal = [](std::string_view name) -> std::string {
    try {
      return manual_page(name);
    } catch (const Error& e) {
      EXPECT_EQ(e.status, ExitStatus::usage);
      return e.what();
    }
  };
  EXPECT_EQ(refusal("pont"), "no kind is called \"pont\" (did you mean \"point\"?)");
  EXPECT_EQ(refusal("metaball"), "no kind is called \"metaball\" (did you mean \"point\"?)");
  EXPECT_EQ(refusal("capsule"), "no kind is called \"capsule\" (did you mean \"cone_sphere\" or \"sdf_capsule\"?)");
  EXPECT_EQ(refusal("zzz"), "no kind is called \"zzz\"; `kelpie kinds` lists them all");
}

/// What other words lead to is there.
TEST(OtherNames, LeadToPagesOfTheManual) {
  for (const OtherName& other : other_names()) {
    EXPECT_NE(manual_page(other.name), "") << other.word;
    if (!other.other_name.empty()) {
      EXPECT_NE(manual_page(other.other_name), "") << other.word;
    }
  }
}

TEST(EveryKind, HasADefinitionInTheSchema) {
  const std::string schema = json_schema();
  ProblemList problems;
  const JsonValue root = parse_document(schema, "schema", problems).root;
  problems.throw_if_any();
  for_everything([&](const auto& c) {
    using T = typename std::decay_t<decltype(c)>::Type;
    const std::string name = c.is_kind ? fmt::format("{}.{}", c.group, T::k_name) : std::string(T::k_name);
    const JsonValue* definition = std::is_same_v<T, Scene> ? &root : root.find("$defs")->find(name);
    ASSERT_TRUE(definition) << name;
    EXPECT_EQ(definition->find("properties")->object()->size(),
              std::tuple_size_v<decltype(T::parameters())> + c.is_kind + 2 * is_field_node<T>());
    EXPECT_FALSE(*definition->find("additionalProperties")->boolean());
  });
}

/// A line of the table goes when its feature comes: what is built is not reserved, and the alternatives
/// of a table name each other.
TEST(Tables, AreConsistent) {
  for_everything([&](const auto& c) {
    using T = typename std::decay_t<decltype(c)>::Type;
    EXPECT_FALSE(is_reserved(ReservedAs::kind, c.group, T::k_name)) << T::k_name;
    for_each_parameter<T>([&](const auto& row) {
      EXPECT_FALSE(is_reserved(ReservedAs::key, T::k_name, row.name)) << row.name;
      bool is_named_back = row.alternative.empty();
      for_each_parameter<T>([&](const auto& other) { is_named_back |= other.name == row.alternative && other.alternative == row.name; });
      EXPECT_TRUE(is_named_back) << T::k_name << "." << row.name;
      if constexpr (NamedEnum<MemberOf<decltype(row)>>) {
        for (const std::string_view value : enum_names<MemberOf<decltype(row)>>())
          EXPECT_FALSE(is_reserved(ReservedAs::value, row.name, value)) << value;
      }
    });
  });
}

/// docs/kinds shows every kind of field: scripts/draw_kinds makes it.
TEST(EveryKind, HasAPicture) {
  const std::filesystem::path folder = std::filesystem::path(KELPIE_EXAMPLES).parent_path() / "docs/kinds";
  std::ifstream file(folder / "README.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  SceneFieldKinds::for_each([&]<template <class> class Kind>() {
    const std::string name(Kind<AnimatedMode>::k_name), doc(Kind<AnimatedMode>::k_doc);
    std::error_code error;
    const auto bytes = std::filesystem::file_size(folder / (name + ".png"), error);
    EXPECT_FALSE(error) << name;
    EXPECT_LE(bytes, 400'000u) << name;
    const std::string row = fmt::format("| ![{0}]({0}.png) | **`{0}`** {1} |", name, doc.substr(0, doc.find('\n')));
    EXPECT_NE(page.find(row), page.npos) << "no row \"" << row << "\" in docs/kinds/README.md";
  });
}

} // namespace
} // namespace kelpie
