// Light below a surface: how it wanders through a medium that scatters it, until it comes out or is lost.
#pragma once

#include <array>

#include "materials/openpbr.h"

namespace kelpie {

/// A homogeneous medium that scatters light.
struct SubsurfaceMedium {
  Vec3 extinction{1};   ///< collisions a unit of length, by channel
  Vec3 albedo{0};       ///< what a collision leaves
  float anisotropy = 0; ///< mean cosine by which it turns light: Henyey and Greenstein's g

  SubsurfaceMedium() = default;
  /// By OpenPBR's parameters: of a thick body so much light comes out as `subsurface_color` says. Its inversion for a half-space is that of
  /// Kulla and Conty 2017, "Revisiting Physically Based Shading at Imageworks".
  explicit SubsurfaceMedium(const SurfaceParameters&);

  /// The same, but for ways between collisions of at least a length: what is denser cannot be told from it.
  SubsurfaceMedium no_denser_than(float length) const;
};

/// A random walk through it, one collision after another. Directions and distances are chosen either as light has them, or drawn towards
/// the surface where it went in (Křivánek and d'Eon 2014, "A Zero-variance-based Sampling Scheme for Monte Carlo Subsurface Scattering"),
/// each by one channel; the balance heuristic over all of these choices weighs what comes of it, so weights stay about 1.
class SubsurfaceWalk {
public:
  /// `normal`: out of the surface where light goes in; `direction`: in which it does. Unit vectors.
  SubsurfaceWalk(const SubsurfaceMedium&, const Vec3& normal, const Vec3& direction);

  const Vec3& direction() const { return direction_; }
  /// Of the light that went in, what is left of each channel.
  const Vec3& throughput() const { return throughput_; }

  /// Distance to the next collision; `u`: two numbers in [0, 1).
  float next_distance(Vec2 u);
  /// It is there, and light goes on in another direction; `u` in [0, 1)^2 chooses it, `choice` in [0, 1) how.
  void collide(float distance, Vec2 u, float choice);
  /// What is left counts so many times.
  void strengthen(float factor) { throughput_ *= factor; }
  /// The surface comes first, at a distance.
  void leave(float distance);

private:
  static constexpr int k_channels = 3;

  float guided_cosine_density(int channel, float cosine) const;
  float stretch(int channel) const { return 1 - cosine_ / nu_[channel]; }
  void weigh(const Vec3& light, const Vec3& of_light, const Vec3& of_guide);
  Vec3 channel_probabilities() const;

  SubsurfaceMedium medium_;
  Vec3 normal_, direction_;
  Vec3 throughput_{1};
  Vec3 nu_;            ///< diffusion lengths in mean free paths, by channel: what draws it to the surface
  float guided_share_; ///< how often it is drawn while it is light
  float cosine_ = 0;   ///< between `direction` and `normal`
  float phase_ = 1;    ///< density of `direction` as light has it
  bool is_guided_ = false;
  Vec3 of_light_, of_guide_; ///< density of having chosen `direction` and, for its distance, each channel: without and with guidance
};

} // namespace kelpie
