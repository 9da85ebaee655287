// The scene: what a file describes, ready to be sampled at any frame.
#pragma once

#include <filesystem>
#include <optional>

#include "materials/surfaces.h"
#include "scene/camera.h"
#include "scene/field_node.h"
#include "scene/film.h"
#include "scene/geometry.h"
#include "scene/lights.h"

namespace kelpie {

/// Either an implicit shape (`field`) or ordinary geometry.
struct Shape {
  std::string name;
  Animated<float> threshold{1.f};
  FieldPtr field;                                              ///< null where `geometry` is set
  std::optional<GeometryKinds::Variant<AnimatedMode>> geometry; ///< none where `field` is set
  SurfaceKinds::Variant<AnimatedMode> surface{Matte<AnimatedMode>{}};
  SourcePosition where;
};

struct Frames {
  int first = 1, last = 1;
  double fps = 24;
};

struct Scene {
  Frames frames;
  Camera<AnimatedMode> camera;
  Film<AnimatedMode> film;
  std::vector<LightKinds::Variant<AnimatedMode>> lights;
  std::vector<Shape> shapes;
  /// Hash of everything that pictures depend on: the document and the bytes of its assets.
  std::string hash;
};

// --- at one moment ---

struct SampledShape {
  std::string name;
  float threshold = 1;
  SampledField field;                                         ///< no nodes where `geometry` is set
  std::optional<GeometryKinds::Variant<SampledMode>> geometry;
  SurfaceKinds::Variant<SampledMode> surface{Matte<SampledMode>{}};
};

struct FrameScene {
  double frame = 0;
  Camera<SampledMode> camera;
  Film<SampledMode> film;
  std::vector<LightKinds::Variant<SampledMode>> lights;
  std::vector<SampledShape> shapes;
};

/// The scene at `frame` (fractions are moments between frames). Cheap: no file is touched.
FrameScene sample(const Scene&, double frame);

} // namespace kelpie
