// The field of a liquid morph: one cloud of blobs flows into another.
#pragma once

#include <memory>

#include "base/kind.h"
#include "field/potential/blob.h"
#include "morph/liquid/interpolate.h"

namespace kelpie {

template <class Mode>
struct Liquid {
  static constexpr std::string_view k_name = "liquid";
  static constexpr std::string_view k_doc = R"(One cloud of blobs flows into another as liquid.

Each blob of `from` is linked to its partners in `to` (the correspondence), split into as many parts as it
has partners, and each part's centre, radius and weight are interpolated. `flow` moves the potentials' mass by the shortest
ways through the bodies, so that limbs are drawn in and out, and keeps the liquid even where parts meet; `transport` moves it straight
through space, from centre of mass to centre of mass; `cellular` is the paper's matching, which may scatter a blob's parts. At progress
0 and 1 the field is exactly that of the two clouds. With `flow` both clouds should stand where they belong, one in the other, as
`kelpie liquid` puts them. Source: Jin, Liu, Wang, Feng, Sun 2005, "Blob-based liquid morphing";
methods.md section 1.

What it is made of flows with it: a point of the liquid has the material of where its matter, the mean of the blobs there, was at the
beginning, and more and more that of where it will be at the end.)";

  typename Mode::File from, to;
  Correspondence correspondence = Correspondence::flow;
  VolumeRule volume = VolumeRule::linear;
  LiquidEnds ends = LiquidEnds::exact;
  Value<Mode, float> progress{0.f};
  Value<Mode, float> weight{1.f};
  typename Mode::Material from_material{}, to_material{};
  /// The matched clouds; filled when the scene is built.
  std::shared_ptr<const LiquidMorph> morph;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &Liquid::from, "the cloud at progress 0: a PLY file as for `blobs`").required().such_as("cloud.ply"),
        parameter("to", &Liquid::to, "the cloud at progress 1").required().such_as("cloud.ply"),
        parameter("correspondence", &Liquid::correspondence,
                  "`flow`: along the bodies; `transport`: straight, as little as possible; `cellular`: nearest spheres, as in the paper"),
        parameter("volume", &Liquid::volume, "`linear`: the potential is scaled so that the volume changes linearly; `free`: as it comes"),
        parameter("ends", &Liquid::ends,
                  "`exact`: the two clouds; `molten`, with `flow`: as smooth as between, for what melts into it and sets from it"),
        parameter("progress", &Liquid::progress, "0 is `from`, 1 is `to`").at_least(0).at_most(1).required(),
        parameter("weight", &Liquid::weight,
                  "multiplies the field: where it rises from 0 to 1 as an `sdf_mesh` beside it in a `blend` falls, the mesh melts")
            .at_least(0),
        parameter("from_material", &Liquid::from_material, "what it is made of at progress 0, instead of its `material`")
            .or_named_in("materials"),
        parameter("to_material", &Liquid::to_material, "what it is made of at progress 1, instead of its `material`")
            .or_named_in("materials"),
    };
  }
  static constexpr auto assets() { return std::tuple{&Liquid::morph}; }

  // Sampled:
  void append_blobs(BlobCloud& out) const {
    weighed(out, [&] { morph->append_blobs(progress, out); });
  }
  void append_parts(BlobCloud& out) const {
    weighed(out, [&] { morph->append_parts(progress, out); });
  }
  BlobFlow flow_of(uint32_t blob) const { return morph->flow_of(blob); }

private:
  template <class Append>
  void weighed(BlobCloud& out, Append&& append) const {
    const size_t before = out.size();
    append();
    for (size_t i = before; i < out.size(); ++i) out[i].weight *= weight;
  }
};

} // namespace kelpie
