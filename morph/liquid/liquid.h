// The field of a liquid morph: one cloud of blobs flows into another.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/kind.h"
#include "field/potential/blob.h"
#include "morph/liquid/chain.h"

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
`kelpie liquid` puts them.

With `through` it flows on from cloud to cloud: with n clouds in all, `progress` is at the first one at 0, at the second one at 1/(n - 1), and so on, and
the field is exactly that of each as it passes. Keys of `progress` at these values, of `"interpolation": "hermite"` and with derivatives of 0, let it rest at
each; a liquid whose `to` is its `from` goes in a circle. Source: Jin, Liu, Wang, Feng, Sun 2005, "Blob-based liquid morphing";
methods.md section 1.

What it is made of flows with it: a point of the liquid has the material of where its matter, the mean of the blobs there, was at the
beginning, and more and more that of where it will be at the end.)";

  typename Mode::File from, to;
  std::vector<typename Mode::File> through;
  Correspondence correspondence = Correspondence::flow;
  VolumeRule volume = VolumeRule::linear;
  LiquidEnds ends = LiquidEnds::exact;
  Value<Mode, float> progress{0.f};
  Value<Mode, float> weight{1.f};
  typename Mode::Material from_material{}, to_material{};
  /// The matched clouds; filled when the scene is built.
  std::shared_ptr<const LiquidChain> morph;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &Liquid::from, "the cloud at progress 0: a PLY file as for `blobs`").required().such_as("cloud.ply"),
        parameter("to", &Liquid::to, "the cloud at progress 1").required().such_as("cloud.ply"),
        parameter("through", &Liquid::through, "clouds that it becomes on the way, in this order, at equal parts of the progress"),
        parameter("correspondence", &Liquid::correspondence,
                  "`flow`: along the bodies; `transport`: straight, as little as possible; `cellular`: nearest spheres, as in the paper"),
        parameter("volume", &Liquid::volume, "`linear`: the potential is scaled so that the volume changes linearly; `free`: as it comes"),
        parameter("ends", &Liquid::ends,
                  "of `from` and `to`: `exact`: the clouds; `molten`, with `flow`: as smooth as between, for what melts into it and sets "
                  "from it"),
        parameter("progress", &Liquid::progress, "0 is `from`, 1 is `to`; clouds that it goes `through` are at equal parts")
            .at_least(0)
            .at_most(1)
            .required(),
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
    const size_t before = out.size();
    morph->append_blobs(progress, out);
    for (size_t i = before; i < out.size(); ++i) out[i].weight *= weight;
  }
  /// `out` are empty.
  static uint32_t append_parts(std::span<const Liquid* const> moments, std::span<BlobCloud> out) {
    const LiquidChain& chain = *moments[0]->morph;
    std::vector<float> progress;
    for (const Liquid* moment : moments) progress.push_back(moment->progress);
    const bool is_one = moments.size() == 1;
    const uint32_t first = is_one ? chain.append_blobs(progress[0], out[0]) : chain.append_parts(progress, out);
    for (size_t i = 0; i < moments.size(); ++i)
      for (Blob& b : out[i]) b.weight *= moments[i]->weight;
    return first;
  }
  BlobFlow flow_of(uint32_t blob) const { return morph->flow_of(blob); }
};

} // namespace kelpie
