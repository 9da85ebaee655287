#include "renderer/program/leaves_at.h"

namespace kelpie {

namespace {

/// Derivatives by so many operands are found at once.
constexpr int k_together = 8;

/// The derivatives of an operator's value by those of its operands.
template <Operator Kind>
void derivatives_of(const Kind& kind, const std::vector<double>& operands, double threshold, Demand demand, std::vector<double>& out) {
  using Operand = Dual<double, k_together>;
  std::vector<Operand> variables(operands.begin(), operands.end());
  out.resize(operands.size());
  for (size_t first = 0; first < operands.size(); first += k_together) {
    const size_t count = std::min<size_t>(k_together, operands.size() - first);
    for (size_t i = 0; i < count; ++i) variables[first + i] = Operand::variable(operands[first + i], int(i));
    const Operand value = kind.combine(std::span<const Operand>(variables), threshold, demand);
    for (size_t i = 0; i < count; ++i) out[first + i] = value.d[i], variables[first + i] = Operand(operands[first + i]);
  }
}

/// From the root down: by the chain rule.
class LeafFinder {
public:
  LeafFinder(const FieldProgram& program, const CodeView& code, const Vec3d& p, std::vector<LeafAt>& out)
      : program_(program), code_(code), p_{p.x, p.y, p.z}, out_(out) {
    spaces_.begin(program);
    std::vector<double> operands;
    for (const Instruction& step : code.steps) values_.push_back(evaluate_step(program, code, step, p_, spaces_, values_, operands));
  }

  void run() {
    influences_.assign(values_.size(), 0);
    influences_.back() = 1;
    for (size_t i = values_.size(); i-- > 0;)
      if (influences_[i] != 0) pass_down(code_.steps[i], values_[i], influences_[i]);
  }

private:
  void pass_down(const Instruction& step, double value, double influence) {
    switch (step.kind) {
    case Instruction::Kind::blobs:
      for (const uint32_t& i : code_.blobs.subspan(step.first, step.count)) {
        const double potential = sum_of_blobs(program_, std::span(&i, 1), spaces_.at(program_, step.space, p_));
        if (potential != 0) out_.push_back({program_.identities->blobs[i], potential, influence});
      }
      return;
    case Instruction::Kind::skeleton:
      if (value != 0) out_.push_back({program_.identity_of(step.node), value, influence});
      return;
    case Instruction::Kind::combine: pass_to_operands(step, influence); return;
    }
  }

  void pass_to_operands(const Instruction& step, double influence) {
    const std::span<const uint32_t> positions = code_.operands.subspan(step.first, step.count);
    operands_.clear();
    for (const uint32_t i : positions) operands_.push_back(values_[i]);
    std::visit(
        [&]<class Kind>(const Kind& kind) {
          if constexpr (Operator<Kind>) derivatives_of(kind, operands_, program_.threshold, step.demand, derivatives_);
        },
        program_.field.nodes[step.node]);
    for (size_t i = 0; i < positions.size(); ++i) influences_[positions[i]] = influence * derivatives_[i];
  }

  const FieldProgram& program_;
  const CodeView& code_;
  Point3<double> p_;
  SpacePoints<double> spaces_;
  std::vector<double> values_, influences_;    ///< of the steps
  std::vector<double> operands_, derivatives_; ///< of one operator
  std::vector<LeafAt>& out_;
};

} // namespace

void leaves_at(const FieldProgram& program, const CodeView& code, const Vec3d& p, std::vector<LeafAt>& out) {
  out.clear();
  LeafFinder(program, code, p, out).run();
}

} // namespace kelpie
