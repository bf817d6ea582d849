#pragma once

// Random and broken problems for the whole-body controller, one after the other as in a loop.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <random>

#include "ajar/wbc/input_limits.hpp"
#include "heron_wbc.hpp"

namespace ajar::test {

class RandomTick {
 public:
  explicit RandomTick(unsigned seed) : generator_(seed) {}
  double normal(double scale) { return scale * std::normal_distribution<double>()(generator_); }
  bool chance(double p) { return std::bernoulli_distribution(p)(generator_); }
  double broken() {
    return chance(0.5) ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity();
  }

  void fill(WbcProblem& p, ClearanceResult& clearance) {
    for (int i = 0; i < 6; ++i) {
      p.tangential[i] = normal(0.2);
      p.correction[i] = normal(0.05);
    }
    if (chance(0.7)) p.base_motion = BaseMotion{{normal(0.5), normal(0.5)}, chance(0.5) ? 0.0 : 0.5};
    p.base = {normal(0.3), normal(0.6)};
    p.base_fixed = chance(0.1);
    p.free_axis = chance(0.3) ? Vector3d(normal(1.0), normal(1.0), normal(1.0)).normalized() : Vector3d(Vector3d::Zero());
    p.leaf_obstacle = 1;
    p.leaf_velocity_at_hand = Vector3d(normal(0.1), normal(0.1), normal(0.1));
    p.leaf_turn = Vector3d(0.0, 0.0, normal(0.3));
    clearance.count = chance(0.5) ? std::uniform_int_distribution<int>(0, kMaxClearanceRows)(generator_) : 0;
    for (size_t i = 0; i < static_cast<size_t>(clearance.count); ++i) {
      ClearanceRow& row = clearance.rows[i];
      row.row = InputRow::NullaryExpr(1, 8, [&] { return normal(0.5); });
      row.distance = std::abs(normal(0.1)) - 0.02;
      row.kind = static_cast<ClearanceKind>(std::uniform_int_distribution<int>(0, 2)(generator_));
      row.obstacle = row.kind == ClearanceKind::Self ? -1 : std::uniform_int_distribution<int>(0, 3)(generator_);
      row.normal = Vector3d(normal(1.0), normal(1.0), normal(1.0)).normalized();
      row.point_on_obstacle = Vector3d(normal(1.0), normal(1.0), normal(1.0));
    }
    p.clearance = &clearance;
  }

  void corrupt(WbcProblem& p, ClearanceResult& clearance, JointVector& q) {
    switch (std::uniform_int_distribution<int>(0, 6)(generator_)) {
      case 0: p.tangential[2] = broken(); break;
      case 1: p.correction[4] = broken(); break;
      case 2: p.base_motion = BaseMotion{{broken(), 0.0}, 0.0}; break;
      case 3: q[3] = broken(); break;
      case 4: p.base.w = broken(); break;
      case 5: p.leaf_turn.z() = broken(); break;
      default:
        clearance.count = 1;
        clearance.rows[0].row = InputRow::Constant(1, 8, broken());
        break;
    }
  }

 private:
  std::mt19937 generator_;
};

// Judges every command by the limits of the robot and of its tick; stops at the first failure.
class RandomTicks : public HeronWbc {
 protected:
  void expect_limits_kept(int ticks, unsigned seed) {
    WholeBodyController wbc(model, config, kPeriod);
    const InputLimits limits = make_input_limits(model, config, kPeriod);
    RandomTick random(seed);
    const auto clearance = std::make_unique<ClearanceResult>();
    InputVector last = InputVector::Zero(8);
    int invalid = 0;
    int corrupted = 0;
    double violation = 0.0;
    WbcSolution out;
    for (int tick = 0; tick < ticks; ++tick) {
      if (tick % 10 == 0) {  // a new posture, now and then up to 0.3 rad outside the limits
        JointVector joints(6);
        for (int i = 0; i < 6; ++i) {
          joints[i] = random.normal(1.5);
          if (random.chance(0.2)) {
            joints[i] = (random.chance(0.5) ? model.limits().position_upper[i] : model.limits().position_lower[i]) +
                        random.normal(0.1);
          }
        }
        place({}, joints);
      }
      if (random.chance(0.01)) {
        last = InputVector::NullaryExpr(8, [&] { return random.normal(0.6); });
        wbc.reset(last);
      }
      WbcProblem p = problem();
      random.fill(p, *clearance);
      const JointVector good = q;
      const bool corrupt = random.chance(0.02);
      if (corrupt) {
        random.corrupt(p, *clearance, q);
        ++corrupted;
      }
      const InputBounds bounds = input_bounds(limits, good, last, p.base_fixed, 1.0);  // near bodies the base brakes harder
      const WbcStatus status = wbc.solve(p, out);
      invalid += status == WbcStatus::Invalid ? 1 : 0;
      ASSERT_TRUE(status != WbcStatus::Invalid || corrupt) << "the solver failed on a sound problem, tick " << tick;
      ASSERT_TRUE(out.u.size() == 8 && out.u.allFinite()) << tick;
      ASSERT_TRUE(std::isfinite(out.speed_factor) && std::isfinite(out.residual) && std::isfinite(out.slack));
      violation = std::max({violation, (out.u - limits.speed_upper).maxCoeff(), (limits.speed_lower - out.u).maxCoeff()});
      const double load = std::abs(out.u[kSpeed]) + limits.half_track * std::abs(out.u[kTurn]);
      violation = std::max(violation, load - limits.wheel_reach);
      if (status != WbcStatus::Invalid) {
        violation = std::max({violation, (out.u - bounds.upper).maxCoeff(), (bounds.lower - out.u).maxCoeff()});
      }
      last = out.u;
      q = good;
    }
    EXPECT_LE(violation, 1e-9);
    EXPECT_EQ(invalid, corrupted);
    std::printf("%d ticks, %d corrupted, %d invalid, largest violation %.1e\n", ticks, corrupted, invalid, violation);
  }
};

}  // namespace ajar::test
