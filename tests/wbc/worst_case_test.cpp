// Strategy: a search looks for the input that brings the controller nearest to breaking a limit: random starts, then steps
// in random directions that grow when they help and shrink when they do not. What it climbs is the largest command over
// its bound, so that it is drawn to saturated, contradicting and singular problems, 1e3 times beyond what a robot can do.
// A second search makes the solver search longest. Then every input is broken in turn, and every cause must have its name.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "ajar/wbc/input_limits.hpp"
#include "ajar/wbc/task_qp.hpp"
#include "heron_wbc.hpp"

namespace ajar {
namespace {

using test::HeronWbc;
using test::kPeriod;
using test::kSpeed;
using test::kTurn;

/// Numbers within ±1 that a problem is made of.
template <int N>
using Genes = std::array<double, static_cast<std::size_t>(N)>;

/// Climbs from a random start in random steps that grow when they help and shrink when they do not.
template <int N, typename Height>
double climb(std::mt19937& generator, int trials, const Height& height_of) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Genes<N> best{};
  for (double& gene : best) gene = uniform(generator);
  double height = height_of(best);
  double step = 0.3;
  for (int i = 0; i < trials; ++i) {
    Genes<N> trial = best;
    for (double& gene : trial) gene = std::clamp(gene + step * normal(generator), -1.0, 1.0);
    const double value = height_of(trial);
    step = std::clamp(step * (value > height ? 1.5 : 0.97), 1e-3, 0.6);
    if (value < height) continue;
    height = value;
    best = trial;
  }
  return height;
}

// Small and huge alike: ±1 spans 1e-3 to 1e3.
double wide(double gene) { return std::copysign(std::pow(10.0, 6.0 * std::abs(gene) - 3.0), gene); }

constexpr int kNumbers = 64;

/// A problem, and the command before it, made of plain numbers.
class WorstCase : public HeronWbc {
 protected:
  void decode(const Genes<kNumbers>& genes) {
    std::size_t next = 0;
    const auto take = [&] { return genes[next++]; };
    JointVector joints(6);
    for (int i = 0; i < 6; ++i) {
      const double middle = 0.5 * (model.limits().position_upper[i] + model.limits().position_lower[i]);
      const double half = 0.5 * (model.limits().position_upper[i] - model.limits().position_lower[i]);
      joints[i] = middle + 1.05 * half * take();  // up to 0.3 rad outside
    }
    place({}, joints);
    last = InputVector::NullaryExpr(8, [&] { return 2.0 * take(); });
    p = problem();
    for (int i = 0; i < 6; ++i) p.tangential[i] = wide(take());
    for (int i = 0; i < 6; ++i) p.correction[i] = wide(take());
    p.base = {wide(take()), wide(take())};
    const double late = take();
    if (late > 0.0) p.base_motion = BaseMotion{{wide(take()), wide(take())}, late};
    p.base_fixed = take() > 0.8;
    const Vector3d axis(take(), take(), take());
    if (axis.norm() > 0.8) p.free_axis = axis.normalized();
    clearance.count = 2;
    for (std::size_t i = 0; i < 2; ++i) {
      clearance.rows[i].row = InputRow::NullaryExpr(1, 8, [&] { return take(); });
      clearance.rows[i].distance = 0.2 * take();
      clearance.rows[i].normal = Vector3d::UnitX();
      clearance.rows[i].kind = i == 0 ? ClearanceKind::Self : ClearanceKind::BaseWorld;
      clearance.rows[i].obstacle = i == 0 ? -1 : 1;
    }
    p.leaf_obstacle = 1;
    p.leaf_velocity_at_hand.x() = wide(take());
    if (take() > -0.5) p.clearance = &clearance;
  }

  /// Largest command over its bound; infinite for what is not a number or has no good status.
  double excess(const Genes<kNumbers>& genes) {
    decode(genes);
    wbc.reset(last);
    const WbcStatus status = wbc.solve(p, out);
    const bool sound = out.u.size() == 8 && out.u.allFinite() && std::isfinite(out.speed_factor + out.residual + out.slack);
    if (!sound || status == WbcStatus::Invalid || status == WbcStatus::Stopped) {
      return std::numeric_limits<double>::infinity();
    }
    const InputBounds bounds = input_bounds(limits, q, last, p.base_fixed, 1.0);
    const double load = std::abs(out.u[kSpeed]) + limits.half_track * std::abs(out.u[kTurn]) - limits.wheel_reach;
    return std::max({(out.u - bounds.upper).maxCoeff(), (bounds.lower - out.u).maxCoeff(),
                     (out.u - limits.speed_upper).maxCoeff(), (limits.speed_lower - out.u).maxCoeff(), load});
  }

  WholeBodyController wbc{model, config, kPeriod};
  InputLimits limits = make_input_limits(model, config, kPeriod);
  InputVector last;
  WbcProblem p;
  ClearanceResult clearance;
  WbcSolution out;
};

TEST_F(WorstCase, BreaksNoLimit) {
  std::mt19937 generator(3);
  double worst = -1e9;
  for (int start = 0; start < 100; ++start) {
    const double height = climb<kNumbers>(generator, 400, [&](const auto& genes) { return excess(genes); });
    ASSERT_LE(height, 1e-9) << "start " << start;
    worst = std::max(worst, height);
  }
  std::printf("100 searches of 400 problems: nearest to a limit %.1e\n", worst);
}

constexpr int kRowsSought = 12;
constexpr int kQpNumbers = 5 * kQpVariables + kQpTasks * (kQpVariables + 1) + kRowsSought * kQpVariables;

/// A problem as the controller builds them, with its weights: a slack with which the start meets every row.
QpProblem qp_of(const Genes<kQpNumbers>& genes, double hand_weight, double slack_weight) {
  std::size_t next = 0;
  const auto take = [&] { return genes[next++]; };
  QpProblem p;
  p.tasks = kQpTasks;
  p.rows = kRowsSought;
  constexpr int kSlackAt = kQpVariables - 1;
  for (int i = 0; i < kQpVariables; ++i) {
    p.weight[i] = std::pow(10.0, 2.0 * take());
    p.wanted[i] = 2.0 * take();
    p.lower[i] = std::min(0.0, take());
    p.upper[i] = std::max(0.0, take());
    p.start[i] = 0.5 * (p.lower[i] + p.upper[i]) * std::abs(take());
  }
  p.task_weight.setConstant(hand_weight);
  for (int j = 0; j < kQpTasks; ++j) {
    for (int i = 0; i < kQpVariables; ++i) p.A(j, i) = take();
    p.b[j] = 10.0 * take();
  }
  p.A.col(kSlackAt).setZero();
  p.weight[kSlackAt] = slack_weight;
  p.lower[kSlackAt] = p.start[kSlackAt] = p.wanted[kSlackAt] = 0.0;
  p.upper[kSlackAt] = std::numeric_limits<double>::max();
  for (int j = 0; j < p.rows; ++j) {
    for (int i = 0; i < kSlackAt; ++i) p.C(j, i) = take();
    p.c[j] = 0.3 * take();
    p.C(j, kSlackAt) = 1.0;
    p.start[kSlackAt] = std::max(p.start[kSlackAt], p.c[j] - p.C.row(j).head(kSlackAt).dot(p.start.head(kSlackAt)));
  }
  return p;
}

/// What the longest searches of the solver came to, beginning without a guess.
struct Sought {
  double iterations = 0.0;  // most
  double excess = 0.0;      // over a bound
  double missed = 0.0;      // of a row
  bool solved = true;       // every one
  bool usable = true;       // none refused
};

Sought seek_longest(double hand_weight, double slack_weight) {
  std::mt19937 generator(6);  // finds rows that depend on a bound to round-off
  TaskQp solver;
  QpSolution solution;
  Sought seen;
  for (int start = 0; start < 20; ++start) {
    (void)climb<kQpNumbers>(generator, 1000, [&](const auto& genes) {
      const QpProblem p = qp_of(genes, hand_weight, slack_weight);
      solver.forget();
      const QpStatus status = solver.solve(p, solution);
      seen.solved = seen.solved && status == QpStatus::Solved;
      seen.usable = seen.usable && status != QpStatus::Invalid;
      seen.excess = std::max({seen.excess, (solution.x - p.upper).maxCoeff(), (p.lower - solution.x).maxCoeff()});
      seen.missed = std::max(seen.missed, (p.c - p.C * solution.x).head(p.rows).maxCoeff());
      seen.iterations = std::max(seen.iterations, static_cast<double>(solution.iterations));
      return static_cast<double>(solution.iterations);
    });
  }
  return seen;
}

TEST(TaskQpWorstCase, ReachesTheMinimumBeforeItsBoundOfIterations) {
  const Sought seen = seek_longest(WbcConfig{}.hand_weight, WbcConfig{}.slack_weight);
  EXPECT_TRUE(seen.solved);
  EXPECT_LE(seen.excess, 0.0);
  EXPECT_LE(seen.missed, 1e-9);
  std::printf("20 searches of 1000 problems: at most %.0f iterations\n", seen.iterations);
}

// A slack of weight 1e10 beside free variables of weight 1e-2: rows depend on one another to round-off, and the search may
// be cut short. The command must be usable all the same.
TEST(TaskQpWorstCase, KeepsEveryBoundWhenItIsCutShort) {
  const Sought seen = seek_longest(1e8, 1e10);
  EXPECT_TRUE(seen.usable);
  EXPECT_LE(seen.excess, 0.0);
  EXPECT_LE(seen.missed, 1e-3);  // a thousandth of the rates; these rows are soft
  std::printf("the same with the heaviest weights: at most %.0f iterations, a row missed by %.1e\n", seen.iterations,
              seen.missed);
}

TEST_F(WorstCase, EveryBrokenNumberIsNamedInvalid) {
  Genes<kNumbers> genes{};
  genes.fill(0.1);
  const std::vector<std::function<void(double)>> breakers{
      [&](double bad) { q[3] = bad; },
      [&](double bad) { kinematics.J(2, 4) = bad; },
      [&](double bad) { kinematics.X_WE.translation().x() = bad; },
      [&](double bad) { p.tangential[5] = bad; },
      [&](double bad) { p.correction[0] = bad; },
      [&](double bad) { p.free_axis.y() = bad; },
      [&](double bad) { p.free_axis_rate = bad; },
      [&](double bad) { p.base.v = bad; },
      [&](double bad) { p.base.w = bad; },
      [&](double bad) { p.base_motion = BaseMotion{{bad, 0.0}, 0.0}; },
      [&](double bad) { p.base_motion = BaseMotion{{0.0, 0.0}, bad}; },
      [&](double bad) { p.rates = JointVector::Constant(6, bad); },
      [&](double bad) { p.leaf_velocity_at_hand.z() = bad; },
      [&](double bad) { p.leaf_turn.x() = bad; },
      [&](double bad) { clearance.rows[1].distance = bad; },
      [&](double bad) { clearance.rows[0].row[7] = bad; },
      [&](double bad) { clearance.rows[0].normal.x() = bad; },
      [&](double bad) { clearance.rows[1].point_on_obstacle.y() = bad; }};
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (std::size_t i = 0; i < breakers.size(); ++i) {
      decode(genes);
      wbc.reset(last);
      breakers[i](bad);
      EXPECT_EQ(wbc.solve(p, out), WbcStatus::Invalid) << i << " " << bad;
      ASSERT_TRUE(out.u.size() == 8 && out.u.allFinite()) << i << " " << bad;
      EXPECT_TRUE((out.u.cwiseAbs().array() <= last.cwiseAbs().array() + 1e-12).all()) << i << " " << bad;
    }
  }
}

TEST_F(WorstCase, WhatCannotBeDoneIsNamedWithTheLimitThatBinds) {
  p = problem();
  p.base_fixed = true;
  p.tangential << 5.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  const WbcSolution slowed = settle(wbc, p);
  EXPECT_EQ(slowed.status, WbcStatus::Slowed);
  EXPECT_EQ(slowed.binding, BindingLimit::JointRate);

  p.correction << 5.0, 0.0, 0.0, 0.0, 0.0, 0.0;  // this cannot be slowed
  const WbcSolution limited = settle(wbc, p);
  EXPECT_EQ(limited.status, WbcStatus::Limited);
  EXPECT_EQ(limited.binding, BindingLimit::JointRate);

  JointVector stretched = q;
  stretched[2] = 0.02;  // the elbow
  place({}, stretched);
  WbcProblem rest = problem();
  WbcSolution singular;
  wbc.reset();
  EXPECT_EQ(wbc.solve(rest, singular), WbcStatus::Damped);
  EXPECT_LT(singular.sigma_min, config.singular_onset);
}

}  // namespace
}  // namespace ajar
