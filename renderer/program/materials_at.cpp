#include "renderer/program/materials_at.h"

namespace kelpie {

namespace {

/// From the root down: each node's share is that of the operator above it, times what it has of that.
class MaterialFinder {
public:
  MaterialFinder(const FieldProgram& program, const CodeView& code, const Vec3d& p, const Footprint& footprint,
                 std::vector<MaterialAt>& out)
      : program_(program), code_(code), p_(p), point_{p.x, p.y, p.z}, footprint_(footprint), out_(out) {}

  void run() {
    if (code_.steps.empty()) return;
    evaluate_steps();
    shares_.assign(values_.size(), 0);
    shares_.back() = values_.back() > 0; // else there is nothing
    for (size_t i = values_.size(); i-- > 0;)
      if (shares_[i] > 0) pass_down(code_.steps[i], shares_[i]);
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
    for (size_t i = 0; i < parts_.size(); ++i) add(program_.identities->blobs[code_.blobs[step.first + i]].place, share * parts_[i]);
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
  std::vector<MaterialAt>& out_;
  SpacePoints<double> spaces_, other_spaces_;
  std::vector<double> values_, shares_;  ///< of the steps
  std::vector<double> operands_, parts_; ///< of one operator
  std::vector<double> blobs_;            ///< of one step
  std::vector<uint32_t> places_;         ///< of what is in out_
};

} // namespace

void materials_at(const FieldProgram& program, const CodeView& code, const Vec3d& p, const Footprint& footprint,
                  std::vector<MaterialAt>& out) {
  out.clear();
  MaterialFinder(program, code, p, footprint, out).run();
}

} // namespace kelpie
