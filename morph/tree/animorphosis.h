// One field tree becomes another.
#pragma once

#include "base/kind.h"

namespace kelpie {

/// How a material becomes another that is not of its kind: as a transition does by itself, or all of it fades.
enum class MaterialChange { grow, dissolve };

template <>
struct EnumNames<MaterialChange> {
  static constexpr std::array<std::pair<std::string_view, MaterialChange>, 2> values{
      {{"grow", MaterialChange::grow}, {"dissolve", MaterialChange::dissolve}}};
};

/// Two nodes that correspond, by their names.
template <class Mode>
struct NodePair {
  static constexpr std::string_view k_name = "node_pair";
  static constexpr std::string_view k_doc = R"(Two nodes of an `animorphosis` that correspond, by the `name` that each has in its tree.

They become one another, and what they stand in is matched so that they can; where that is impossible it is an error. A name may stand in
several pairs: then the node is divided, and each part goes its own way.)";

  std::string from, to;
  std::optional<Value<Mode, float>> progress{};
  SourcePosition where{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &NodePair::from, "a node of `from`").required(),
        parameter("to", &NodePair::to, "a node of `to`").required(),
        parameter("progress", &NodePair::progress, "of the pair and all below it, instead of that of the whole").at_least(-1).at_most(2),
    };
  }
};

/// A kind only in scene files: when a scene is read it is replaced by the tree that generic_tree() makes of it.
template <class Mode>
struct Animorphosis {
  static constexpr std::string_view k_name = "animorphosis";
  static constexpr std::string_view k_doc = R"(One animated field becomes another, part by part.

    { "kind": "animorphosis", "from": { … }, "to": { … }, "progress": { "keys": [[1, 0], [96, 1]], "interpolation": "smooth" },
      "pairs": [{ "from": "left foot", "to": "left claw" }] }

At `progress` 0 it is `from`, at 1 it is `to`, both as they move; between, a tree that has both in it. Level by level, each part of the
one gets its counterpart in the other, so that all together differ least in place, size, kind, name and colour; `pairs` forces some. Numbers and
places go straight, directions turn. A skeleton becomes one of another kind within a kind that has both as special cases (a cylinder and
a cone), or else through a special case of both (a cylinder, a segment, a box). A part without a counterpart grows out of its
neighbour, or back into it. A blend becomes a union as a hyper-blend whose n grows; warps start from where they do nothing. What
cannot be matched shrinks away while the other grows. Materials of the same kind mix their numbers, so veins stay veins. Of different
kinds they make a `transition`: veins become rings, or one spreads through the other; if both are plain, they fade. Both trees have
the threshold of the shape that they stand in. Where `progress` leaves [0, 1] (a curve that swings in) places and directions go beyond
the ends, and all else stays as it is there. Source: Barbier, Galin, Akkouche, animorphosis; methods.md section 2.)";

  typename Mode::Child from{}, to{};
  Value<Mode, float> progress{0.f};
  std::vector<NodePair<Mode>> pairs;
  MaterialChange materials = MaterialChange::grow;

  static constexpr auto parameters() {
    using A = Animorphosis;
    return std::tuple{
        parameter("from", &A::from, "the field at the beginning").required(),
        parameter("to", &A::to, "the field at the end").required(),
        parameter("progress", &A::progress, "how far it has come: from 0 to 1, or a little beyond").at_least(-1).at_most(2).required(),
        parameter("pairs", &A::pairs, "nodes that correspond, whatever their places"),
        parameter("materials", &A::materials,
                  "how a material becomes one of another kind. grow: by a `transition`; dissolve: all of it fades"),
    };
  }
};

} // namespace kelpie
