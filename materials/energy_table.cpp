#include "materials/energy_table.h"

#include <array>
#include <cstdint>

#include "materials/fresnel.h"
#include "materials/ggx.h"

namespace kelpie {

namespace {

// Nodes lie at even steps of the square roots of cosine and alpha, and of the roots below of |eta - 1| / (eta + 1): densest where
// the tables bend. So they are within 1 % of the integrals from cosine 0.15 upwards; 1.5 % where eta is between 0.9 and 1.
constexpr int k_cosines = 20, k_alphas = 16, k_etas = 20;
constexpr float k_last_step = 0.6f; // of eta = 4
constexpr float k_root_outside = 2, k_root_inside = 3;
constexpr int k_normals = 256;

/// Where a number in [0, 1] lies among nodes 0 … count - 1.
struct TablePlace {
  int node;
  float fraction;

  TablePlace(float x, int count) {
    const float at = std::min(std::max(x, 0.f), 1.f) * float(count - 1);
    node = std::min(int(at), count - 2), fraction = at - float(node);
  }
};
TablePlace place_of_cosine(float cosine) { return {std::sqrt(cosine), k_cosines}; }
TablePlace place_of_alpha(float alpha) { return {std::sqrt(alpha), k_alphas}; }

float node_cosine(int i) { return std::max(1e-4f, float(i * i) / float((k_cosines - 1) * (k_cosines - 1))); }
float node_alpha(int i) { return float(i * i) / float((k_alphas - 1) * (k_alphas - 1)); }
size_t entry(int alpha, int cosine) { return size_t(alpha * k_cosines + cosine); }

/// Hammersley's point i of k_normals.
Vec2 point(int i) {
  uint32_t bits = uint32_t(i);
  float inverse = 0;
  for (float digit = 0.5f; bits; bits >>= 1, digit /= 2) inverse += float(bits & 1) * digit;
  return {(float(i) + 0.5f) / k_normals, inverse + 0.5f / k_normals};
}

/// One viewer of microfacets, and of each normal that is seen what all materials share.
class View {
public:
  View(int alpha, int cosine) : alpha2_(node_alpha(alpha) * node_alpha(alpha)), z_(node_cosine(cosine)), lambda_(lambda(z_)) {
    const Ggx facets(node_alpha(alpha));
    const Vec3 out(std::sqrt(1 - z_ * z_), 0, z_);
    for (int i = 0; i < k_normals; ++i) {
      const Vec3 m = facets.sample_visible(out, 1, point(i));
      const float c = std::min(1.f, glm::dot(out, m)), mirrored_z = 2 * c * m.z - z_;
      cosine_[size_t(i)] = c, normal_z_[size_t(i)] = m.z, mirrored_[size_t(i)] = mirrored_z > 0 ? unmasked(mirrored_z) : 0;
    }
  }

  float mirror_albedo() const {
    float sum = 0;
    for (const float mirrored : mirrored_) sum += mirrored;
    return sum / k_normals;
  }
  /// In lanes, which a compiler can make one instruction of.
  DielectricAlbedo dielectric_albedo(float eta) const {
    constexpr size_t k_lanes = 8;
    std::array<float, k_lanes> reflected{}, transmitted{};
    for (size_t i = 0; i < k_normals; i += k_lanes)
      for (size_t lane = 0; lane < k_lanes; ++lane) {
        const float c = cosine_[i + lane], fresnel = fresnel_dielectric(c, eta);
        const float z = (refracted_cosine(c, eta) - c / eta) * normal_z_[i + lane] + z_ / eta; // below the surface
        reflected[lane] += fresnel * mirrored_[i + lane];
        transmitted[lane] += z > 0 ? (1 - fresnel) * unmasked(z) : 0;
      }
    float up = 0, down = 0;
    for (size_t lane = 0; lane < k_lanes; ++lane) up += reflected[lane], down += transmitted[lane];
    return {(up + down) / k_normals, up / (up + down)};
  }

private:
  /// Ggx::lambda by the cosine alone.
  float lambda(float z) const { return 0.5f * (std::sqrt(1 + alpha2_ * (1 - z * z) / (z * z)) - 1); }
  /// Of light that leaves a microfacet, how much meets no other: G2 / G1.
  float unmasked(float z) const { return (1 + lambda_) / (1 + lambda_ + lambda(z)); }

  float alpha2_, z_, lambda_;
  std::array<float, k_normals> cosine_, normal_z_, mirrored_;
};

using MirrorTable = std::array<float, k_alphas * k_cosines>;

MirrorTable make_mirror_table() {
  MirrorTable table;
  for (int cosine = 0; cosine < k_cosines; ++cosine) {
    table[entry(0, cosine)] = 1;
    for (int alpha = 1; alpha < k_alphas; ++alpha) table[entry(alpha, cosine)] = View(alpha, cosine).mirror_albedo();
  }
  return table;
}

/// Of all dielectrics on one side: eta >= 1, outside, or eta <= 1.
class DielectricTable {
public:
  explicit DielectricTable(bool inside) : is_inside_(inside) {
    for (int cosine = 0; cosine < k_cosines; ++cosine) {
      for (int i = 0; i < k_etas; ++i) entries_[size_t(i)][entry(0, cosine)] = {1, fresnel_dielectric(node_cosine(cosine), node_eta(i))};
      for (int alpha = 1; alpha < k_alphas; ++alpha) {
        const View view(alpha, cosine);
        for (int i = 0; i < k_etas; ++i) entries_[size_t(i)][entry(alpha, cosine)] = view.dielectric_albedo(node_eta(i));
      }
    }
  }

  DielectricAlbedo at(float cosine, float alpha, float eta) const {
    const TablePlace e = place_of_eta(eta), a = place_of_alpha(alpha), c = place_of_cosine(cosine);
    DielectricAlbedo sum{0, 0};
    for (const int i : {0, 1})
      for (const int j : {0, 1})
        for (const int k : {0, 1}) {
          const DielectricAlbedo& node = entries_[size_t(e.node + i)][entry(a.node + j, c.node + k)];
          const float weight = (i ? e.fraction : 1 - e.fraction) * (j ? a.fraction : 1 - a.fraction) * (k ? c.fraction : 1 - c.fraction);
          sum.total += weight * node.total, sum.reflected += weight * node.reflected;
        }
    return sum;
  }

private:
  float node_eta(int i) const {
    const float step = k_last_step * std::pow(float(i) / float(k_etas - 1), is_inside_ ? k_root_inside : k_root_outside);
    return is_inside_ ? (1 - step) / (1 + step) : (1 + step) / (1 - step);
  }
  TablePlace place_of_eta(float eta) const {
    const float step = std::abs(eta - 1) / (eta + 1) / k_last_step;
    return {is_inside_ ? std::cbrt(step) : std::sqrt(step), k_etas};
  }
  bool is_inside_;
  std::array<std::array<DielectricAlbedo, k_alphas * k_cosines>, k_etas> entries_;
};

} // namespace

float mirror_albedo(float cosine, float alpha) {
  static const MirrorTable k_table = make_mirror_table();
  const TablePlace a = place_of_alpha(alpha), c = place_of_cosine(cosine);
  const float *rough = &k_table[entry(a.node + 1, c.node)], *smooth = &k_table[entry(a.node, c.node)];
  const float of_smooth = smooth[0] + (smooth[1] - smooth[0]) * c.fraction, of_rough = rough[0] + (rough[1] - rough[0]) * c.fraction;
  return of_smooth + (of_rough - of_smooth) * a.fraction;
}

DielectricAlbedo dielectric_albedo(float cosine, float alpha, float eta) {
  if (eta < 1) {
    static const DielectricTable k_inside(true);
    return k_inside.at(cosine, alpha, eta);
  }
  static const DielectricTable k_outside(false);
  return k_outside.at(cosine, alpha, eta);
}

} // namespace kelpie
