#pragma once

#include "field/potential/blob.h"

namespace kelpie {

template <class Mode>
struct Blobs {
  static constexpr std::string_view k_name = "blobs";
  static constexpr std::string_view k_doc = R"(A cloud of blobs from a PLY file: the sum of its potentials.

The file's vertices have the properties `x y z radius weight` (radius of influence; weights of either
sign) in ASCII or binary; `kelpie fit` writes such files. With `ax ay az bx by bz cx cy cz` as well, the rows of a matrix that takes
p - (x, y, z) into the unit ball, a blob is an ellipsoid, and its radius counts for nothing.)";

  typename Mode::File file;
  Falloff falloff = Falloff::quartic;
  /// What `file` holds; filled when the scene is built.
  std::shared_ptr<const BlobCloud> cloud;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("file", &Blobs::file, "a PLY file with the vertex properties x y z radius weight, of ellipsoids ax … cz as well").required().such_as("cloud.ply"),
        parameter("falloff", &Blobs::falloff, "how the potentials decrease"),
    };
  }
  static constexpr auto assets() { return std::tuple{&Blobs::cloud}; }

  // Sampled:
  void append_blobs(BlobCloud& out) const {
    for (Blob b : *cloud) b.falloff = falloff, out.push_back(b);
  }
};

} // namespace kelpie
