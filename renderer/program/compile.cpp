#include <optional>

#include "renderer/program/program.h"

namespace kelpie {

void BlobArrays::push(const Blob& blob) {
  const FalloffPolynomial f = polynomial(blob.falloff);
  x.push_back(blob.centre.x), y.push_back(blob.centre.y), z.push_back(blob.centre.z);
  radius.push_back(blob.radius), k.push_back(1 / (blob.radius * blob.radius));
  a.push_back(static_cast<float>(blob.weight * f.a)), b.push_back(static_cast<float>(blob.weight * f.b));
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

/// The box around the image of a box.
Box3d map(const Affine& f, const Box3d& box) {
  const Vec3d c = f(box.centre()), h = box.extent() * 0.5;
  Vec3d e(0);
  for (int i = 0; i < 3; ++i) e += glm::abs(f.linear[i]) * h[i];
  return {c - e, c + e};
}

class Compiler {
public:
  explicit Compiler(FieldProgram& out) : out_(out) { out_.spaces.push_back({}); }

  void run() {
    Sum sum;
    add_to_sum(static_cast<uint32_t>(out_.field.nodes.size() - 1), View{}, Demand::sign, sum);
    finish(sum);
  }

private:
  /// How a node sees the world: through an affine map from a space (the world, or that of a warp).
  struct View {
    uint32_t space = 0;
    Affine space_from_here{};
  };

  /// A blend in the making: blobs by the space they live in, and everything else.
  struct Sum {
    std::vector<std::pair<uint32_t, std::vector<uint32_t>>> blobs;
    std::vector<uint32_t> others; ///< positions of steps
  };

  /// Adds the subtree at `node`, with its view, to a sum: blends are flattened.
  void add_to_sum(uint32_t node, const View& view, Demand demand, Sum& sum) {
    std::visit(
        [&](const auto& kind) {
          using K = std::decay_t<decltype(kind)>;
          if constexpr (std::is_same_v<K, Blend<SampledMode>>) {
            blend_ = node;
            const Demand below = kind.demand_of_operands(demand, kind.children.size());
            for (uint32_t child : kind.children) add_to_sum(child, view, below, sum);
          } else if constexpr (AffineWarp<K>) {
            add_to_sum(kind.child, {view.space, view.space_from_here * kind.parent_from_child()}, demand, sum);
          } else if constexpr (Warp<K>) {
            add_to_sum(kind.child, {push_space({view.space, inverse(view.space_from_here), node}), {}}, demand, sum);
          } else if constexpr (BlobSource<K>) {
            BlobCloud cloud;
            kind.append_blobs(cloud);
            add_blobs(cloud, view, sum);
          } else if constexpr (Skeleton<K>) {
            add_skeleton(node, kind.support(), view, sum);
          } else {
            const std::vector<uint32_t> children = operands_of(kind);
            const Demand below = kind.demand_of_operands(demand, children.size());
            std::vector<uint32_t> operands;
            for (uint32_t child : children) {
              Sum operand;
              add_to_sum(child, view, below, operand);
              operands.push_back(finish(operand));
            }
            sum.others.push_back(emit_combine(node, operands, demand));
          }
        },
        out_.field.nodes[node]);
  }

  void add_blobs(const BlobCloud& cloud, const View& view, Sum& sum) {
    const std::optional<double> scale = similarity_scale(view.space_from_here.linear);
    const uint32_t space = scale ? view.space : space_of(view);
    std::vector<uint32_t>& list = list_of(sum, space);
    for (Blob blob : cloud) {
      if (blob.weight == 0) continue;
      extend_support(view, support(blob));
      if (scale) {
        blob.centre = Vec3(view.space_from_here(Vec3d(blob.centre)));
        blob.radius = static_cast<float>(blob.radius * *scale);
      }
      list.push_back(static_cast<uint32_t>(out_.blobs.size()));
      out_.blobs.push(blob);
    }
  }

  void add_skeleton(uint32_t node, const Box3& box, const View& view, Sum& sum) {
    extend_support(view, box);
    Instruction step{Instruction::Kind::skeleton, node, space_of(view), 0, 0, Demand::value};
    sum.others.push_back(emit(step));
  }

  /// One step for a finished sum; returns its position.
  uint32_t finish(const Sum& sum) {
    std::vector<uint32_t> terms;
    for (const auto& group : sum.blobs) {
      const auto first = static_cast<uint32_t>(out_.code.blobs.size());
      out_.code.blobs.insert(out_.code.blobs.end(), group.second.begin(), group.second.end());
      terms.push_back(emit({Instruction::Kind::blobs, 0, group.first, first, static_cast<uint32_t>(group.second.size()), Demand::value}));
    }
    terms.insert(terms.end(), sum.others.begin(), sum.others.end());
    if (terms.empty()) return emit({}); // only blobs of weight 0
    if (terms.size() == 1) return terms[0];
    return emit_combine(*blend_, terms, Demand::value); // several terms come from a blend only
  }

  uint32_t emit_combine(uint32_t node, const std::vector<uint32_t>& operands, Demand demand) {
    const auto first = static_cast<uint32_t>(out_.code.operands.size());
    out_.code.operands.insert(out_.code.operands.end(), operands.begin(), operands.end());
    return emit({Instruction::Kind::combine, node, 0, first, static_cast<uint32_t>(operands.size()), demand});
  }

  uint32_t emit(Instruction step) {
    out_.code.steps.push_back(step);
    return static_cast<uint32_t>(out_.code.steps.size() - 1);
  }

  std::vector<uint32_t>& list_of(Sum& sum, uint32_t space) {
    for (auto& group : sum.blobs)
      if (group.first == space) return group.second;
    return sum.blobs.emplace_back(space, std::vector<uint32_t>{}).second;
  }

  uint32_t space_of(const View& view) {
    if (view.space_from_here.linear == Mat3d(1.0) && view.space_from_here.offset == Vec3d(0.0)) return view.space;
    return push_space({view.space, inverse(view.space_from_here), Space::k_no_warp});
  }

  /// Siblings mostly come one after the other: the last space is the one to share.
  uint32_t push_space(const Space& space) {
    const Space& last = out_.spaces.back();
    const bool is_last = out_.spaces.size() > 1 && last.parent == space.parent && last.warp == space.warp &&
                         last.local_from_parent.linear == space.local_from_parent.linear &&
                         last.local_from_parent.offset == space.local_from_parent.offset;
    if (!is_last) out_.spaces.push_back(space);
    return static_cast<uint32_t>(out_.spaces.size() - 1);
  }

  void extend_support(const View& view, const Box3& box) {
    Box3d image = map(view.space_from_here, {Vec3d(box.lower), Vec3d(box.upper)});
    for (uint32_t i = view.space; i != 0; i = out_.spaces[i].parent) {
      const Space& space = out_.spaces[i];
      if (space.warp != Space::k_no_warp)
        std::visit(
            [&](const auto& kind) {
              if constexpr (Warp<std::decay_t<decltype(kind)>>) image = kind.image_of(image);
            },
            out_.field.nodes[space.warp]);
      image = map(inverse(space.local_from_parent), image);
    }
    out_.support.extend(image);
  }

  FieldProgram& out_;
  std::optional<uint32_t> blend_; ///< any blend of the tree: they have no parameters, so one stands for all
};

} // namespace

FieldProgram compile(SampledField field, double threshold) {
  FieldProgram program;
  program.threshold = threshold;
  program.field = std::move(field);
  Compiler(program).run();
  return program;
}

} // namespace kelpie
