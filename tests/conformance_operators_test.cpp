// Every operator keeps the contracts of field/kinds.h, standing and in motion.
#include <numeric>

#include "tests/support/conformance.h"

namespace kelpie {
namespace {

struct Operands {
  double threshold;
  std::vector<Interval> ranges;

  Operands(Random& r, size_t count) : threshold(r.uniform(0.2, 2)), ranges(count) {
    for (Interval& i : ranges) {
      const double a = r.uniform(-1, 3), width = r.below(4) ? r.log_uniform(1e-3, 2) : 0;
      i = r.below(5) ? Interval{a, a + width} : Interval{0, 0}; // often one does not reach the cell
    }
  }
  std::vector<double> sample(Random& r) const {
    std::vector<double> f;
    for (const Interval& i : ranges) f.push_back(r.uniform(i.lo, std::nextafter(i.hi, INFINITY)));
    return f;
  }
};

/// Of most kinds any number is fine; a kind at random has no children.
template <class K>
size_t operand_count(const K& kind, Random& r) {
  return operands_of(kind).size() + (HasOwnOperands<K> ? 0 : 1 + size_t(r.below(5)));
}

/// Calls test_kind(for_its_trials) for every operator; for_its_trials(test) calls test(operator, operands, demand, random).
template <class TestKind>
void for_each_operator_kind(TestKind&& test_kind) {
  for_each_field_kind([&]<template <class> class Kind>() {
    if (testing::Test::HasFailure()) return;
    if constexpr (Operator<Kind<SampledMode>>)
      test_kind([](auto&& test) {
        for (unsigned trial = 0; trial < 10 * k_trials && !testing::Test::HasFailure(); ++trial) {
          SCOPED_TRACE(trial);
          Random r(trial);
          const Kind<SampledMode> kind = random_kind<Kind>(r);
          test(kind, Operands(r, operand_count(kind, r)), trial % 2 ? Demand::value : Demand::sign, r);
        }
      });
  });
}

/// Calls test(operator, operands, demand, random) for random states of every operator.
template <class Test>
void for_each_operator(Test&& test) {
  for_each_operator_kind([&](auto&& for_its_trials) { for_its_trials(test); });
}

TEST(Conformance, OperatorsBoundTheirValues) {
  for_each_operator([](const auto& kind, const Operands& operands, Demand mine, Random& r) {
    const Interval range = kind.combine(std::span<const Interval>(operands.ranges), operands.threshold, mine);
    for (int i = 0; i < 20; ++i) {
      const std::vector<double> f = operands.sample(r);
      EXPECT_TRUE(holds(range, kind.combine(std::span<const double>(f), operands.threshold, mine)));
    }
  });
}

TEST(Conformance, OperatorsDifferentiate) {
  for_each_operator_kind([](auto&& for_its_trials) {
    GradientCheck check;
    for_its_trials([&](const auto& kind, const Operands& operands, Demand mine, Random& r) {
      const std::vector<double> f = operands.sample(r);
      const auto along = [&](const Vec3d& p) { // operands that move linearly with three variables
        std::vector<double> moved = f;
        for (size_t i = 0; i < f.size(); ++i) moved[i] += p[i % 3] * double(1 + i);
        return kind.combine(std::span<const double>(moved), operands.threshold, mine);
      };
      std::vector<ValueAndSlopes> duals;
      for (size_t i = 0; i < f.size(); ++i) duals.push_back(ValueAndSlopes(f[i]) + ValueAndSlopes::variable(0, int(i % 3)) * double(1 + i));
      check.compare(along, kind.combine(std::span<const ValueAndSlopes>(duals), operands.threshold, mine), Vec3d(0));
    });
    check.expect_enough();
  });
}

// What is pruned cannot matter: the value is the same, or where only the side is asked for, the side.
TEST(Conformance, OperatorsKeepWhatMatters) {
  int asked = 0, dropping = 0;
  for_each_operator([&]<class K>(const K& kind, const Operands& operands, Demand mine, Random& r) {
    for (const Demand demand : {Demand::value, Demand::sign}) { // of the cell
      if (mine < demand) continue;                              // it asks for no more than the whole tree does
      std::vector<char> kept(operands.ranges.size(), true);
      kind.keep(operands.ranges, operands.threshold, demand, kept);
      ++asked, dropping += std::count(kept.begin(), kept.end(), 0) > 0;
      for (int i = 0; i < 20; ++i) {
        const std::vector<double> f = operands.sample(r);
        std::vector<double> rest;
        for (size_t k = 0; k < f.size(); ++k)
          if (kept[k] || is_positional<K>()) rest.push_back(kept[k] ? f[k] : 0);
        const double whole = kind.combine(std::span<const double>(f), operands.threshold, mine);
        const auto lone = std::find(kept.begin(), kept.end(), char(true));
        const bool is_lone = lone_of<K>() == Lone::itself && std::count(lone, kept.end(), char(true)) == 1;
        const double pruned = rest.empty() ? 0
                              : is_lone    ? f[size_t(lone - kept.begin())]
                                           : kind.combine(std::span<const double>(rest), operands.threshold, mine);
        if (demand == Demand::value && !rest.empty()) {
          EXPECT_NEAR(whole, pruned, 1e-12);
        } else if (demand == Demand::value) {
          EXPECT_LE(whole, 1e-12); // nothing reaches the cell
        } else {
          EXPECT_EQ(whole > operands.threshold, pruned > operands.threshold);
        }
      }
    }
  });
  EXPECT_GT(asked, 60 * k_trials);
  EXPECT_GT(dropping, asked / 5);
}

// What an operator makes is above 0 only where it says (ExtentOf).
TEST(Conformance, OperatorsEndWhereTheySay) {
  int asked = 0;
  for_each_operator([&]<class K>(const K& kind, const Operands& operands, Demand mine, Random& r) {
    std::vector<double> f = operands.sample(r);
    std::vector<size_t> children(f.size());
    std::iota(children.begin(), children.end(), size_t(0));
    const std::vector<Operand> others = operands_of(kind);
    std::erase_if(children, [&](size_t i) {
      const size_t known = f.size() - others.size(); // in front of these only children were added
      return i >= known && others[i - known].role != Role::child;
    });
    const auto end = [&](size_t i) { f[i] = std::min(f[i], 0.0); };
    switch (extent_of<K>()) {
    case ExtentOf::any_child:
      for (const size_t i : children) end(i);
      break;
    case ExtentOf::all_children: end(children[size_t(r.below(int(children.size())))]); break;
    case ExtentOf::first_child: end(0); break;
    }
    EXPECT_LE(kind.combine(std::span<const double>(f), operands.threshold, mine), 1e-12); // R-functions are 0 to rounding
    ++asked;
  });
  EXPECT_GT(asked, 50 * k_trials);
}

// A lone operand of an operator that does not tell its operands apart by their places is what it is or its part above 0, as is said.
TEST(Conformance, OperatorsLeaveLoneOperandsAlone) {
  int compared = 0;
  for_each_operator([&]<class K>(const K& kind, const Operands& operands, Demand mine, Random& r) {
    if (is_positional<K>() || lone_of<K>() == Lone::combined) return;
    const std::vector<double> f = operands.sample(r);
    const double lone = kind.combine(std::span<const double>(f).first(1), operands.threshold, mine);
    const double expected = lone_of<K>() == Lone::above_0 && lone == 0 ? std::max(f[0], 0.0) : f[0];
    EXPECT_NEAR(lone, expected, 1e-12);
    ++compared;
  });
  EXPECT_GT(compared, 40 * k_trials);
}

TEST(Conformance, MovingOperatorsKeepTheirBounds) {
  for_each_operator([&]<template <class> class Kind>(const Kind<SampledMode>& kind, const Operands& operands, Demand mine, Random& r) {
    const auto other = random_other<Kind>(kind, r);
    const Interval threshold{operands.threshold, operands.threshold * (r.below(2) ? r.uniform(1, 2) : 1)};
    const Interval range = moving_combine(kind, other, operands.ranges, threshold, mine);
    for (int i = 0; i < 20; ++i) {
      const std::vector<double> f = operands.sample(r);
      const auto between = interpolated(kind, other, r.uniform(0, 1));
      EXPECT_TRUE(holds(range, between.combine(std::span<const double>(f), r.uniform(threshold.lo, threshold.hi + 1e-12), mine), 1e-5));
    }
  });
}

} // namespace
} // namespace kelpie
