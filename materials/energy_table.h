// What rough surfaces reflect and transmit of light that is the same from everywhere: tables, made at their first use. They
// repay the light that GGX loses where it meets a second microfacet (Turquin 2019): all of it, at the price of reciprocity.
#pragma once

namespace kelpie {

/// What microfacets that reflect everything send back at once to a viewer at this cosine; `alpha` in [0, 1].
float mirror_albedo(float cosine, float alpha);

struct DielectricAlbedo {
  float total;     ///< reflected and transmitted at once; the rest meets a second microfacet
  float reflected; ///< the share of `total` that is reflected
};

/// Of microfacets of a clear dielectric. `eta`: index of refraction beyond the surface over that on the viewer's side, in
/// [1/4, 4]; what is outside is taken for the end.
DielectricAlbedo dielectric_albedo(float cosine, float alpha, float eta);

} // namespace kelpie
