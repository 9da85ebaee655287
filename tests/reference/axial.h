// Axial deformation, straight from the formulas (methods.md, section 4): curves by de Boor's recursion, frames by integrating their
// equation, the nearest place by looking at all of them.
#pragma once

#include <vector>

#include "tests/reference/vec.h"

namespace reference {

struct Axis {
  struct Frame {
    double at, angle; ///< a part of the rest axis' length; in degrees
  };
  std::vector<Vec> rest, deformed;
  int degree = 3;
  Vec normal;
  std::vector<Frame> frames;
  bool is_cosine = true;
  double radius = 1; ///< of a tube that neither axis has to cut
  double border = 0.25;

  // Made by prepare():
  struct Node {
    Vec at, velocity, x, y, z; ///< of a curve at a fine step of t
  };
  std::vector<Node> rest_nodes, deformed_nodes; ///< frames not turned by the user's
  std::vector<double> lengths;                  ///< along the rest axis, to each node
  std::vector<Frame> turned;                    ///< the user's frames in order, with those at the ends
  Vec lower, upper;                             ///< of all nodes
  double lipschitz = 1;                         ///< a bound of how much lengths grow from the deformed to the rest space, within the tube
  void prepare();
};

struct Axial {
  std::vector<Axis> axes;
  double nowhere = 1; ///< how far away is what is nowhere
  void prepare();
};

/// Where p is for the child.
Vec undeformed(const Axial&, Vec p);

/// A ball of the child's space, and by how much lengths grow on the way there, about.
struct Image {
  Vec centre;
  double radius, lipschitz;
};
/// What of the child may be seen within `reach` of p.
std::vector<Image> images(const Axial&, Vec p, double reach);

} // namespace reference
