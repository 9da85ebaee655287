#include <array>
#include <optional>

#include "renderer/program/expand.h"
#include "renderer/program/sort_blobs.h"
#include "renderer/program/support.h"

namespace kelpie {

void BlobArrays::push(const Blob& blob) {
  const FalloffPolynomial f = polynomial(blob.falloff);
  const HalfAxes axes = half_axes(blob);
  if (!is_round(blob)) give_shapes();
  x.push_back(blob.centre.x), y.push_back(blob.centre.y), z.push_back(blob.centre.z);
  radius.push_back(axes.longest), k.push_back(1 / (axes.longest * axes.longest));
  a.push_back(static_cast<float>(blob.weight * f.a)), b.push_back(static_cast<float>(blob.weight * f.b));
  if (has_shapes) least.push_back(axes.shortest), shapes.push(to_unit_ball(blob));
}

void BlobArrays::give_shapes() {
  if (has_shapes) return;
  has_shapes = true;
  least = radius;
  for (const float r : radius) shapes.push({1 / r, 1 / r, 1 / r, 0, 0, 0});
}

void BlobShapes::push(const SymmetricMat3& m) {
  xx.push_back(m.xx), yy.push_back(m.yy), zz.push_back(m.zz), xy.push_back(m.xy), xz.push_back(m.xz), yz.push_back(m.yz);
}

size_t FieldProgram::element_count() const {
  size_t n = blobs.size();
  for (const Instruction& s : code.steps) n += s.kind == Instruction::Kind::skeleton;
  return n;
}

namespace {

/// The factor by which a similarity scales, or nothing for any other affine map.
std::optional<double> similarity_scale(const Mat3d& m) {
  const Mat3d g = glm::transpose(m) * m;
  const double s2 = (g[0][0] + g[1][1] + g[2][2]) / 3;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (std::abs(g[i][j] - (i == j ? s2 : 0)) > 1e-9 * s2) return {};
  return std::sqrt(s2);
}

/// Of the nodes behind the root.
std::vector<LeafIdentity> identities_of_pieces(const SampledField& field) {
  std::vector<LeafIdentity> out(field.piece_count);
  for (uint32_t node = 0; node <= field.root(); ++node)
    std::visit(
        [&]<class Kind>(const Kind& kind) {
          if constexpr (HasPieces<Kind>)
            for (uint32_t i = 0; i < kind.expansion.count; ++i) out[kind.expansion.first + i - field.root() - 1] = {node, i};
        },
        field.nodes[node]);
  return out;
}

/// Compiles all moments in step: what decides about structure is asked of every one of them.
class Compiler {
public:
  Compiler(std::vector<FieldProgram>& moments, CompileOptions options) : moments_(moments), options_(options) {
    for (FieldProgram& m : moments_) m.spaces.push_back({});
  }

  void run() {
    Sum sum;
    add_to_sum(static_cast<uint32_t>(first().field.root()), View{0, std::vector<Affine>(moments_.size()), 0}, Demand::sign, sum);
    finish(sum);
    for (size_t i = 1; i < moments_.size(); ++i) moments_[i].code = first().code;
    if (std::any_of(moments_.begin(), moments_.end(), [](const FieldProgram& m) { return !m.blobs.are_round(); }))
      for (FieldProgram& m : moments_) m.blobs.give_shapes();
    sort_blobs(moments_, identities_);
    if (options_.with_identities) {
      const auto all =
          std::make_shared<const Identities>(Identities{std::move(identities_), identities_of_pieces(first().field), std::move(places_)});
      for (FieldProgram& m : moments_) m.identities = all;
    }
    for (FieldProgram& m : moments_) find_support(m, nullptr, m.support);
  }

private:
  /// How a node sees the world: through an affine map from a space (the world, or that of a warp), one for each moment.
  struct View {
    uint32_t space = 0;
    std::vector<Affine> space_from_here;
    uint32_t place; ///< into places_: the material of what is above
  };

  /// A blend in the making: blobs by the space they live in, and everything else.
  struct Sum {
    std::vector<std::pair<uint32_t, std::vector<uint32_t>>> blobs;
    std::vector<uint32_t> others; ///< positions of steps
  };

  /// Code is made once.
  FieldProgram& first() { return moments_[0]; }
  template <class Kind>
  const Kind& node(size_t moment, uint32_t index) const {
    return std::get<Kind>(moments_[moment].field.nodes[index]);
  }

  /// Adds the subtree at `node`, with its view, to a sum: blends are flattened.
  void add_to_sum(uint32_t index, const View& from_above, Demand demand, Sum& sum) {
    const View view = with_material(index, from_above);
    std::visit(
        [&](const auto& kind) {
          using K = std::decay_t<decltype(kind)>;
          if constexpr (std::is_same_v<K, Blend<SampledMode>>) {
            blend_ = index;
            const Demand below = kind.demand_of_operands(demand, kind.children.size());
            for (uint32_t child : kind.children) add_to_sum(child, view, below, sum);
          } else if constexpr (AffineWarp<K>) {
            for_each_operand_seen<K>(index, view, [&](uint32_t child, const View& below) { add_to_sum(child, below, demand, sum); });
          } else if constexpr (Warp<K>) {
            add_to_sum(kind.child, {push_space(view, index), std::vector<Affine>(moments_.size()), view.place}, demand, sum);
          } else if constexpr (BlobSource<K>) {
            add_blobs<K>(index, view, sum);
          } else if constexpr (Skeleton<K>) {
            sum.others.push_back(emit_skeleton<K>(index, space_of(view), view.place));
          } else if constexpr (ComplexPrimitive<K>) {
            View below = view;
            if constexpr (requires { kind.parent_from_pieces(); })
              for (size_t i = 0; i < moments_.size(); ++i)
                below.space_from_here[i] = view.space_from_here[i] * node<K>(i, index).parent_from_pieces();
            sum.others.push_back(emit_pieces(kind.expansion, below, demand));
          } else {
            sum.others.push_back(emit_operator<K>(index, view, demand));
          }
        },
        first().field.nodes[index]);
  }

  /// What a node's own material makes of how its parent sees the world.
  View with_material(uint32_t index, const View& view) {
    const std::vector<MaterialIndex>& materials = first().field.materials;
    if (!options_.with_identities || index >= materials.size() || !materials[index].is_set()) return view;
    View own = view;
    own.place = add_place({materials[index], space_of(view)});
    return own;
  }

  uint32_t add_place(const MaterialPlace& place) {
    places_.push_back(place);
    return static_cast<uint32_t>(places_.size() - 1);
  }

  /// The place of a cloud's blobs: that of what is above, but what flows has one of its own.
  template <class Kind>
  uint32_t place_of_blobs(uint32_t index, const View& view) {
    if constexpr (FlowingSource<Kind>) {
      const Kind& kind = node<Kind>(0, index);
      const MaterialIndex above = places_[view.place].material;
      if (options_.with_identities && (above.is_set() || kind.from_material.is_set() || kind.to_material.is_set()))
        return add_place({above, space_of(view), true});
    }
    return view.place;
  }

  template <class Kind>
  uint32_t emit_operator(uint32_t index, const View& view, Demand demand) {
    const Kind& kind = node<Kind>(0, index);
    size_t count = 0;
    for_each_operand(kind, [&](const Operand&) { ++count; });
    const Demand below = kind.demand_of_operands(demand, count);
    std::vector<uint32_t> operands;
    for_each_operand_seen<Kind>(index, view, [&](uint32_t child, const View& from) {
      Sum operand;
      add_to_sum(child, from, below, operand);
      operands.push_back(finish(operand));
    });
    return emit_combine(index, operands, demand);
  }

  /// Calls visit(node, view) for the operands of a node that itself has the given view.
  template <class Kind, class Visit>
  void for_each_operand_seen(uint32_t index, const View& view, const Visit& visit) {
    if constexpr (!k_sees_through_maps<Kind>) {
      for_each_operand(node<Kind>(0, index), [&](const Operand& operand) { visit(operand.node, view); });
    } else {
      std::vector<std::vector<Operand>> operands; // of each moment
      for (size_t i = 0; i < moments_.size(); ++i) operands.push_back(operands_of(node<Kind>(i, index)));
      for (size_t j = 0; j < operands[0].size(); ++j) {
        View below = view;
        for (size_t i = 0; i < moments_.size(); ++i)
          below.space_from_here[i] = view.space_from_here[i] * operands[i][j].parent_from_operand;
        visit(operands[0][j].node, below);
      }
    }
  }

  template <class Kind>
  uint32_t emit_skeleton(uint32_t index, uint32_t space, uint32_t place) {
    if constexpr (std::is_same_v<Kind, Polyhedron<SampledMode>>)
      for (size_t i = 0; i < moments_.size(); ++i) {
        const auto& points = node<Kind>(i, index).points;
        if (points.size() <= k_most_hull_points) moments_[i].hulls.emplace(index, hull_faces(points));
      }
    return emit({Instruction::Kind::skeleton, index, space, place, 0, Demand::value});
  }

  uint32_t emit_pieces(const Expansion& expansion, const View& view, Demand demand) {
    const uint32_t space = space_of(view);
    std::vector<uint32_t> operands;
    operands.reserve(expansion.count);
    for (uint32_t i = expansion.first; i < expansion.first + expansion.count; ++i)
      std::visit(
          [&]<class Kind>(const Kind&) {
            if constexpr (Skeleton<Kind>) operands.push_back(emit_skeleton<Kind>(i, space, view.place));
          },
          first().field.nodes[i]);
    if (operands.size() == 1) return operands[0];
    return emit_combine(first().field.union_of_pieces, operands, demand);
  }

  template <class Kind>
  void add_blobs(uint32_t index, const View& view, Sum& sum) {
    std::vector<BlobCloud> clouds(moments_.size());
    std::vector<double> scales;
    const uint32_t first_part = append_blobs<Kind>(index, clouds);
    for (size_t i = 0; i < moments_.size(); ++i) {
      if (const auto scale = similarity_scale(view.space_from_here[i].linear)) scales.push_back(*scale);
    }
    const bool is_folded = scales.size() == moments_.size();
    for (size_t i = 0; is_folded && i < moments_.size(); ++i)
      for (Blob& blob : clouds[i]) fold(view.space_from_here[i], scales[i], blob);
    std::vector<uint32_t>& list = list_of(sum, is_folded ? view.space : space_of(view));
    const uint32_t place = place_of_blobs<Kind>(index, view);
    for (size_t j = 0; j < clouds[0].size(); ++j) {
      if (std::all_of(clouds.begin(), clouds.end(), [&](const BlobCloud& c) { return c[j].weight == 0; })) continue;
      list.push_back(static_cast<uint32_t>(first().blobs.size()));
      if (options_.with_identities) identities_.push_back({index, first_part + static_cast<uint32_t>(j), place});
      for (size_t i = 0; i < moments_.size(); ++i) moments_[i].blobs.push(clouds[i][j]);
    }
  }

  /// Takes a blob along by a similarity that scales by this.
  static void fold(const Affine& map, double scale, Blob& blob) {
    if (!is_round(blob)) {
      if (const std::optional<Blob> seen = mapped(blob, map)) blob = *seen;
      return;
    }
    blob.centre = Vec3(map(Vec3d(blob.centre)));
    blob.radius = static_cast<float>(blob.radius * scale);
  }

  /// Those of each moment; returns the number of the first.
  template <class Kind>
  uint32_t append_blobs(uint32_t index, std::vector<BlobCloud>& clouds) const {
    std::vector<const Kind*> kinds;
    for (size_t i = 0; i < moments_.size(); ++i) kinds.push_back(&node<Kind>(i, index));
    if constexpr (requires { Kind::append_parts(kinds, clouds); }) return Kind::append_parts(kinds, clouds);
    for (size_t i = 0; i < moments_.size(); ++i) kinds[i]->append_blobs(clouds[i]);
    return 0;
  }

  /// One step for a finished sum; returns its position.
  uint32_t finish(const Sum& sum) {
    std::vector<uint32_t> terms;
    for (const auto& group : sum.blobs) {
      std::vector<uint32_t>& all = first().code.blobs;
      const auto start = static_cast<uint32_t>(all.size());
      all.insert(all.end(), group.second.begin(), group.second.end());
      terms.push_back(emit({Instruction::Kind::blobs, 0, group.first, start, static_cast<uint32_t>(group.second.size()), Demand::value}));
    }
    terms.insert(terms.end(), sum.others.begin(), sum.others.end());
    if (terms.empty()) return emit({}); // only blobs of weight 0
    if (terms.size() == 1) return terms[0];
    return emit_combine(*blend_, terms, Demand::value); // several terms come from a blend only
  }

  uint32_t emit_combine(uint32_t index, const std::vector<uint32_t>& operands, Demand demand) {
    std::vector<uint32_t>& all = first().code.operands;
    const auto start = static_cast<uint32_t>(all.size());
    all.insert(all.end(), operands.begin(), operands.end());
    return emit({Instruction::Kind::combine, index, 0, start, static_cast<uint32_t>(operands.size()), demand});
  }

  uint32_t emit(Instruction step) {
    first().code.steps.push_back(step);
    return static_cast<uint32_t>(first().code.steps.size() - 1);
  }

  std::vector<uint32_t>& list_of(Sum& sum, uint32_t space) {
    for (auto& group : sum.blobs)
      if (group.first == space) return group.second;
    return sum.blobs.emplace_back(space, std::vector<uint32_t>{}).second;
  }

  uint32_t space_of(const View& view) {
    const auto is_identity = [](const Affine& f) { return f.linear == Mat3d(1.0) && f.offset == Vec3d(0.0); };
    if (std::all_of(view.space_from_here.begin(), view.space_from_here.end(), is_identity)) return view.space;
    return push_space(view, Space::k_no_warp);
  }

  /// Siblings mostly come one after the other: the last space is the one to share.
  uint32_t push_space(const View& view, uint32_t warp) {
    std::vector<Space> spaces;
    bool is_last = first().spaces.size() > 1;
    for (size_t i = 0; i < moments_.size(); ++i) {
      const Space& space = spaces.emplace_back(Space{view.space, inverse(view.space_from_here[i]), warp});
      const Space& last = moments_[i].spaces.back();
      is_last = is_last && last.parent == space.parent && last.warp == space.warp &&
                last.local_from_parent.linear == space.local_from_parent.linear &&
                last.local_from_parent.offset == space.local_from_parent.offset;
    }
    if (!is_last)
      for (size_t i = 0; i < moments_.size(); ++i) moments_[i].spaces.push_back(spaces[i]);
    return static_cast<uint32_t>(first().spaces.size() - 1);
  }

  std::vector<FieldProgram>& moments_;
  CompileOptions options_;
  std::vector<LeafIdentity> identities_; ///< of blobs, if they are asked for
  std::vector<MaterialPlace> places_{MaterialPlace{}};
  std::optional<uint32_t> blend_; ///< any blend of the tree: they have no parameters, so one stands for all
};

} // namespace

std::vector<FieldProgram> compile(std::vector<SampledField> moments, std::span<const double> thresholds, CompileOptions options) {
  std::vector<FieldProgram> programs(moments.size());
  expand(moments);
  for (size_t i = 0; i < moments.size(); ++i) programs[i].threshold = thresholds[i], programs[i].field = std::move(moments[i]);
  Compiler(programs, options).run();
  return programs;
}

FieldProgram compile(SampledField field, double threshold, CompileOptions options) {
  std::vector<SampledField> one;
  one.push_back(std::move(field));
  return std::move(compile(std::move(one), std::array{threshold}, options)[0]);
}

} // namespace kelpie
