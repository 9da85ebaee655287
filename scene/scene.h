// The scene: what a file describes, ready to be sampled at any frame.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>

#include "materials/material.h"
#include "morph/field_node.h"
#include "scene/camera.h"
#include "scene/film.h"
#include "scene/geometry.h"
#include "scene/lights.h"

namespace kelpie {

// The parts of a scene file have tables as kinds have: what is said of them is said once.

/// Either an implicit shape (`field`) or ordinary geometry.
struct Shape {
  static constexpr std::string_view k_name = "shape";
  static constexpr std::string_view k_doc = R"(A thing to see: a field and the threshold at which it has its surface, or ordinary geometry.

The surface is where the potential equals the threshold; inside it is larger.)";

  std::string name;
  Animated<float> threshold{1.f};
  FieldPtr field;                                               ///< null where `geometry` is set
  std::optional<GeometryKinds::Variant<AnimatedMode>> geometry; ///< none where `field` is set
  MaterialPtr surface = make_material<Matte>();
  FieldPtr texture; ///< may be null
  int priority = 0;
  SourcePosition where;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("name", &Shape::name, "what it is called; no two shapes share a name").required(),
        parameter("threshold", &Shape::threshold, "the potential at the surface of `field`").above(0),
        parameter("field", &Shape::field, "an implicit shape").alternative_to("geometry").required(),
        parameter("geometry", &Shape::geometry, "ordinary geometry").alternative_to("field").required(),
        parameter("surface", &Shape::surface, "what it is made of where neither `texture` nor its field says otherwise")
            .or_named_in("materials"),
        parameter("texture", &Shape::texture,
                  "a field whose nodes have materials: where it is above 0 the shape is made of them (`kelpie kinds material`)"),
        parameter("priority", &Shape::priority, "where shapes overlap the one of the highest priority fills the place")
            .at_least(-1000)
            .at_most(1000),
    };
  }
};

struct Frames {
  static constexpr std::string_view k_name = "frames";
  static constexpr std::string_view k_doc = "The frames that are rendered unless the command line names others.";

  int first = 1, last = 1;
  double fps = 24;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("first", &Frames::first, "the first frame").in(Unit::frames),
        parameter("last", &Frames::last, "the last frame").in(Unit::frames),
        parameter("fps", &Frames::fps, "frames per second").above(0).at_most(1000),
    };
  }
};

/// An object of any form, as JSON; empty where there is none.
struct FreeObject {
  std::string text;
};

struct Scene {
  static constexpr std::string_view k_name = "scene";
  static constexpr std::string_view k_doc = R"(What a scene file holds, as JSON with comments.

World space is right-handed, y up. Files that a scene names are relative to it.)";

  using Light = LightKinds::Variant<AnimatedMode>;

  int version = 1;
  std::string schema;
  double units = 1;
  FreeObject meta;
  Frames frames;
  std::vector<std::string> include;
  std::map<std::string, Animated<float>> variables;
  std::map<std::string, MaterialPtr> materials;
  std::map<std::string, FieldPtr> parts;
  FreeObject recipes;
  Camera<AnimatedMode> camera;
  Film<AnimatedMode> film;
  std::vector<Light> lights;
  std::vector<Shape> shapes;
  /// The height, in pixels, of the picture that decides how fine details in pixels are; 0: that of the film.
  int detail_height = 0;
  /// Hash of everything that pictures depend on: the document and the bytes of its assets.
  std::string hash;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("kelpie", &Scene::version, "version of the format").at_least(1).at_most(1).required(),
        parameter("$schema", &Scene::schema, "where editors find the format's JSON schema (`kelpie schema`); not used otherwise"),
        parameter("units", &Scene::units,
                  "metres per scene unit, for whatever depends on true size: absorption, scattering below surfaces, printing (none of "
                  "these is built yet)")
            .above(0),
        parameter("meta", &Scene::meta, "whatever else is to be known of the pictures: each frame has it in its header, as `kelpie:meta`"),
        parameter("frames", &Scene::frames, "which frames there are"),
        parameter("include", &Scene::include, "files whose materials and parts are this scene's too: `kelpie kinds library`"),
        // What is referred to stands before what refers to it: this is the order of reading.
        parameter("variables", &Scene::variables, "numbers by name, for expressions (`kelpie kinds expression`)"),
        parameter("materials", &Scene::materials, "materials by name, for shapes, fields and other materials"),
        parameter("parts", &Scene::parts, "fields by name, for any number of instances (`kelpie kinds instance`); not seen by themselves"),
        parameter("recipes", &Scene::recipes, "variations by name, each of paths and values as `--set` has them; `--recipe` takes one"),
        parameter("camera", &Scene::camera, "where the picture is taken from"),
        parameter("film", &Scene::film, "size and quality of the picture"),
        parameter("lights", &Scene::lights, "all lights; where there is none, the studio environment lights the scene"),
        parameter("shapes", &Scene::shapes, "all there is to see").required(),
    };
  }
};

// --- at one moment ---

struct SampledShape {
  std::string name;
  float threshold = 1;
  SampledField field; ///< no nodes where `geometry` is set
  std::optional<GeometryKinds::Variant<SampledMode>> geometry;
  MaterialIndex surface; ///< none: a matte grey
  SampledField texture;  ///< no nodes where there is none
  /// Where shapes overlap, that of the highest priority fills the place (renderer/trace/media.h).
  int priority = 0;
};

/// A stretch of time, in frames.
struct Exposure {
  double start = 0, length = 0;
  /// The frame at time 0 (the start) to 1 (the end).
  double frame_at(double time) const { return start + time * length; }
};

struct FrameScene {
  double frame = 0;
  Camera<SampledMode> camera;
  Film<SampledMode> film;
  std::vector<LightKinds::Variant<SampledMode>> lights;
  std::vector<SampledShape> shapes;
  SampledMaterials materials; ///< of all shapes

  /// The scene at any other frame (without `moment`); none where nothing moves.
  std::function<FrameScene(double frame)> moment;
  /// Whether the camera is the same at all frames; false where nobody knows.
  bool camera_stands = false;
  /// Frames at which the motion of shapes need not be smooth, ascending.
  std::vector<double> breaks;

  /// While the shutter is open; of no length where nothing moves. Where it is closed but the film asks for motion, a moment
  /// from the frame on, of which rays see the beginning.
  Exposure exposure() const;
};

/// The scene at `frame` (fractions are moments between frames). Cheap: no file is touched. `scene` must outlive `moment`.
FrameScene sample(const Scene&, double frame);

} // namespace kelpie
