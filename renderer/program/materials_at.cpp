#include "renderer/program/materials_at.h"

#include <algorithm>

namespace kelpie {

namespace {

/// What a MaterialFinder writes to, kept from point to point.
struct FinderMemory {
  SpacePoints<double> spaces, other_spaces;
  std::vector<double> values, shares;  ///< of the steps
  std::vector<double> operands, parts; ///< of one operator
  std::vector<double> blobs;           ///< of one step
  std::vector<uint32_t> places;        ///< of what has been found, but for flows
};

/// From the root down: each node's share is that of the operator above it, times what it has of that.
class MaterialFinder {
public:
  MaterialFinder(const FieldProgram& program, const CodeView& code, const Vec3d& p, const Footprint& footprint, FinderMemory& memory,
                 std::vector<MaterialAt>& out)
      : program_(program), code_(code), p_(p), point_{p.x, p.y, p.z}, footprint_(footprint), spaces_(memory.spaces),
        other_spaces_(memory.other_spaces), values_(memory.values), shares_(memory.shares), operands_(memory.operands),
        parts_(memory.parts), blobs_(memory.blobs), places_(memory.places), out_(out) {
    values_.clear(), places_.clear();
  }

  void run() {
    if (code_.steps.empty()) return;
    evaluate_steps();
    shares_.assign(values_.size(), 0);
    shares_.back() = values_.back() > 0; // else there is nothing
    for (size_t i = values_.size(); i-- > 0;)
      if (shares_[i] > 0) pass_down(code_.steps[i], shares_[i]);
    add_flows();
  }

private:
  void evaluate_steps() {
    spaces_.begin(program_);
    for (const Instruction& step : code_.steps)
      values_.push_back(evaluate_step(program_, code_, step, point_, spaces_, values_, operands_));
  }

  void pass_down(const Instruction& step, double share) {
    switch (step.kind) {
    case Instruction::Kind::blobs: return pass_to_blobs(step, share);
    case Instruction::Kind::skeleton: return add(step.first, share);
    case Instruction::Kind::combine: return pass_to_operands(step, share);
    }
  }

  /// Of a step: the potential of each of its blobs.
  void find_blobs(const Instruction& step) {
    const Point3<double>& local = spaces_.at(program_, step.space, point_);
    blobs_.clear();
    for (const uint32_t& i : code_.blobs.subspan(step.first, step.count)) blobs_.push_back(sum_of_blobs(program_, std::span(&i, 1), local));
  }

  void pass_to_blobs(const Instruction& step, double share) {
    find_blobs(step);
    parts_.resize(blobs_.size());
    share_by(blobs_, parts_);
    for (size_t i = 0; i < parts_.size(); ++i) {
      const uint32_t blob = code_.blobs[step.first + i];
      const LeafIdentity& whose = program_.identities->blobs[blob];
      if (!program_.identities->places[whose.place].flows)
        add(whose.place, share * parts_[i]);
      else if (parts_[i] > 0)
        add_to_flow(step.space, blob, whose, share * parts_[i]);
    }
  }

  /// What flows together: how far from here its matter was at the beginning and will be at the end, the sum over its blobs.
  struct Flow {
    LeafIdentity whose; ///< of any of its blobs
    double share = 0;
    Vec3d to_start{0}, to_end{0}; ///< times the share
  };

  void add_to_flow(uint32_t space, uint32_t blob, const LeafIdentity& whose, double share) {
    auto flow = std::find_if(flows_.begin(), flows_.end(), [&](const Flow& f) { return f.whose.place == whose.place; });
    if (flow == flows_.end()) flow = flows_.insert(flow, Flow{whose});
    flow->share += share;
    std::visit(
        [&]<class Kind>(const Kind& kind) {
          if constexpr (FlowingSource<Kind>) {
            if (kind.progress <= 0 || kind.progress >= 1) return; // it is where it was, or will be
            const BlobNumbers b = program_.blob(blob);
            const uint32_t own = program_.identities->places[whose.place].space;
            Vec3d centre(b.x, b.y, b.z);
            if (own != space) centre = program_.spaces[own].local_from_parent(centre); // its scale was folded into it
            const BlobFlow way = kind.flow_of(whose.part);
            flow->to_start += share * (Vec3d(way.from) - centre), flow->to_end += share * (Vec3d(way.to) - centre);
          }
        },
        program_.field.nodes[whose.node]);
  }

  void add_flows() {
    for (const Flow& flow : flows_)
      std::visit(
          [&]<class Kind>(const Kind& kind) {
            if constexpr (FlowingSource<Kind>) {
              const MaterialPlace& place = program_.identities->places[flow.whose.place];
              const Vec3 q = in_space(place.space, p_);
              const Footprint footprint = footprint_in(place.space, q);
              const auto add_end = [&](MaterialIndex own, double part, const Vec3d& way) {
                const MaterialIndex material = own.is_set() ? own : place.material;
                if (material.is_set() && part > 0)
                  out_.push_back({material, float(flow.share * part), q + Vec3(way / flow.share), footprint});
              };
              add_end(kind.from_material, 1 - double(kind.progress), flow.to_start);
              add_end(kind.to_material, kind.progress, flow.to_end);
            }
          },
          program_.field.nodes[flow.whose.node]);
  }

  /// What a step counts for in a blend: a sum of blobs as if each stood there by itself, so that blends in one another are one.
  double value_in_blend(uint32_t position) {
    const Instruction& step = code_.steps[position];
    if (step.kind != Instruction::Kind::blobs) return values_[position];
    find_blobs(step);
    double sum = 0;
    for (const double f : blobs_) sum += std::max(0.0, f);
    return sum;
  }

  void pass_to_operands(const Instruction& step, double share) {
    const std::span<const uint32_t> positions = code_.operands.subspan(step.first, step.count);
    const bool is_blend = std::holds_alternative<Blend<SampledMode>>(program_.field.nodes[step.node]);
    std::visit(
        [&]<class Kind>(const Kind& kind) {
          if constexpr (Operator<Kind>) {
            operands_.clear();
            for (const uint32_t i : positions) operands_.push_back(is_blend ? value_in_blend(i) : values_[i]);
            parts_.resize(operands_.size());
            kind.shares(std::span<const double>(operands_), program_.threshold, std::span<double>(parts_));
          }
        },
        program_.field.nodes[step.node]);
    for (size_t i = 0; i < positions.size(); ++i)
      if (is_blend || values_[positions[i]] > 0) shares_[positions[i]] += share * parts_[i];
  }

  void add(uint32_t place, double share) {
    const MaterialPlace& at = program_.identities->places[place];
    if (!at.material.is_set() || !(share > 0)) return;
    for (size_t i = 0; i < places_.size(); ++i)
      if (places_[i] == place) {
        out_[i].share += static_cast<float>(share);
        return;
      }
    places_.push_back(place);
    const Vec3 q = in_space(at.space, p_);
    out_.push_back({at.material, static_cast<float>(share), q, footprint_in(at.space, q)});
  }

  Vec3 in_space(uint32_t space, const Vec3d& p) {
    SpacePoints<double>& spaces = other_spaces_;
    spaces.begin(program_);
    const Point3<double> q = spaces.at(program_, space, {p.x, p.y, p.z});
    return {float(q.x), float(q.y), float(q.z)};
  }

  /// By differences: where its two ends go.
  Footprint footprint_in(uint32_t space, const Vec3& q) {
    if (space == 0 || footprint_.is_point()) return footprint_;
    return {in_space(space, p_ + Vec3d(footprint_.u)) - q, in_space(space, p_ + Vec3d(footprint_.v)) - q};
  }

  const FieldProgram& program_;
  const CodeView& code_;
  Vec3d p_;
  Point3<double> point_; ///< the same
  Footprint footprint_;
  SpacePoints<double>&spaces_, &other_spaces_;
  std::vector<double>&values_, &shares_, &operands_, &parts_, &blobs_;
  std::vector<uint32_t>& places_;
  std::vector<Flow> flows_;
  std::vector<MaterialAt>& out_;
};

} // namespace

void materials_at(const FieldProgram& program, const CodeView& code, const Vec3d& p, const Footprint& footprint,
                  std::vector<MaterialAt>& out) {
  out.clear();
  thread_local FinderMemory memory;
  MaterialFinder(program, code, p, footprint, memory, out).run();
}

} // namespace kelpie
