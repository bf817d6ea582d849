// Strategy: limits are checked on random problems with states outside the limits and broken numbers; the hand task by
// integrating the command exactly along a door of 0.8 m radius, base by the co-rotating law; then heap use and time.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "ajar/core/so3.hpp"
#include "ajar/wbc/base_law.hpp"
#include "ajar/wbc/input_limits.hpp"
#include "ajar/wbc/whole_body_controller.hpp"
#include "allocation_guard.hpp"
#include "heron_wbc.hpp"

namespace ajar {
namespace {

using test::HeronWbc;
using test::kPeriod;
using test::kSpeed;
using test::kTurn;
using test::wall_ahead;

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
    for (int i = 0; i < 8; ++i) {
      p.measured[i] = normal(0.5);
    }
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
      case 2: p.measured[7] = broken(); break;
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

TEST_F(HeronWbc, NeverBreaksALimitOnRandomAndBrokenInput) {
  WholeBodyController wbc(model, config, kPeriod);
  const InputLimits limits = make_input_limits(model, config, kPeriod);
  RandomTick random(21);
  const auto clearance = std::make_unique<ClearanceResult>();
  InputVector last = InputVector::Zero(8);
  int invalid = 0;
  int corrupted = 0;
  double violation = 0.0;
  WbcSolution out;
  constexpr int kTicks = 100000;
  for (int tick = 0; tick < kTicks; ++tick) {
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
    const InputBounds bounds = input_bounds(limits, good, last, p.base_fixed);
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
  std::printf("%d ticks, %d corrupted, %d invalid, largest violation %.1e\n", kTicks, corrupted, invalid, violation);
}

// Door of radius 0.8 m tracked by hand twist feed-forward and pose feedback, base by the co-rotating law.
struct DoorRun {
  double path_error = 0.0;
  double least_factor = 1.0;
  double least_sigma = 1e9;
  double angle = 0.0;
};

DoorRun open_door(const RobotModel& model, BasePose base, JointVector q, double k, double speed) {
  WbcConfig config;
  config.base_share = 1.0;  // the kinematic base follows at once
  WholeBodyController wbc(model, config, kPeriod);
  BaseLaw base_law({});
  Kinematics kinematics;
  model.compute(base, q, kinematics);
  const Pose start = kinematics.X_WE;
  const Vector3d x0 = -Vector3d::UnitX();
  const Vector3d curvature(0.0, 0.0, k);
  base_law.reset(base, start.translation());
  const Vector3d centre = start.translation() + curvature.cross(x0) / (k * k);
  DoorRun run;
  WbcSolution out;
  InputVector measured = InputVector::Zero(8);
  double s = 0.0;  // path of the reference
  for (int tick = 0; tick < 20000 && std::abs(k) * s < 0.5 * std::numbers::pi; ++tick) {
    const Matrix3d turned = exp_so3(s * curvature);
    const Vector3d x = turned * x0;
    const Vector3d wanted = centre + turned * (start.translation() - centre);
    const double ramp = std::min(speed, 0.1 * tick * kPeriod);
    WbcProblem p;
    p.kinematics = &kinematics;
    p.q = &q;
    p.measured = measured;
    p.tangential << ramp * x, ramp * curvature;
    p.correction << 2.0 * (wanted - kinematics.X_WE.translation()),
        2.0 * log_so3(turned * start.linear() * kinematics.X_WE.linear().transpose());
    BaseLawInput in;
    in.dt = kPeriod;
    in.base = base;
    in.hand = kinematics.X_WE.translation();
    in.direction = x;
    in.curvature = curvature;
    in.wanted_speed = ramp;
    in.measured_speed = out.speed_factor * ramp;
    in.confidence = 1.0;
    p.base = base_law.step(in).twist;
    (void)wbc.solve(p, out);
    q += kPeriod * out.u.head(6);
    base = integrate_base(base, out.u[kSpeed], out.u[kTurn], kPeriod);
    s += kPeriod * out.speed_factor * ramp;
    measured = out.u;
    model.compute(base, q, kinematics);
    const Matrix3d now = exp_so3(s * curvature);
    const Vector3d on_path = centre + now * (start.translation() - centre);
    run.path_error = std::max(run.path_error, (kinematics.X_WE.translation() - on_path).norm());
    run.least_factor = std::min(run.least_factor, out.speed_factor);
    run.least_sigma = std::min(run.least_sigma, out.sigma_min);
  }
  run.angle = std::abs(k) * s;
  return run;
}

TEST_F(HeronWbc, TracksADoorWithinAMillimetre) {
  for (const double k : {-1.25, 1.25}) {
    for (const double heading_error : {-0.25, 0.0, 0.25}) {
      const Vector3d hand = kinematics.X_WE.translation();
      // Turn the base to the heading of its reference, backward, or a little off it.
      const Vector3d to_base(-hand.x(), -hand.y(), 0.0);
      const Vector3d path = -Vector3d::UnitX() + k * Vector3d::UnitZ().cross(to_base);
      const BasePose base{0.0, 0.0, std::atan2(path.y(), path.x()) + std::numbers::pi + heading_error};
      const JointVector shoulder_back = q - base.yaw * JointVector::Unit(6, 0);  // hand nearly where it was
      const DoorRun run = open_door(model, base, shoulder_back, k, 0.1);
      std::printf("door k %.2f, heading off %.2f: path error %.4f mm, s >= %.3f, sigma >= %.3f\n", k, heading_error,
                  1e3 * run.path_error, run.least_factor, run.least_sigma);
      EXPECT_GE(run.angle, 0.5 * std::numbers::pi - 1e-9);
      EXPECT_LT(run.path_error, 1e-3);
    }
  }
}

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(AllocationGuard, SeesTheHeap) {
  const long before = test::allocations;
  const std::unique_ptr<Eigen::VectorXd> probe = std::make_unique<Eigen::VectorXd>(Eigen::VectorXd::Ones(100));
  EXPECT_GE(test::allocations, before + 2) << probe->sum();
}
#endif

TEST_F(HeronWbc, NeverAllocatesAndIsFast) {
  WholeBodyController wbc(model, config, kPeriod);
  RandomTick random(23);
  constexpr int kProblems = 200;
  std::vector<ClearanceResult> rows(kProblems);
  std::vector<WbcProblem> problems(kProblems, problem());
  for (size_t i = 0; i < kProblems; ++i) {
    random.fill(problems[i], rows[i]);
    rows[i].count = 10;
    for (size_t j = 0; j < 10; ++j) {
      if (rows[i].rows[j].row.size() != 8) {
        rows[i].rows[j] = wall_ahead(0.1, ClearanceKind::BaseWorld, 0).rows[0];
      }
    }
  }
  WbcSolution out;
  (void)wbc.solve(problems[0], out);
  const long before = test::allocations;
  double sum = 0.0;
  double best = 1e9;  // of one batch: what the solver needs when the machine does nothing else
  constexpr int kRepeats = 50;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    for (const WbcProblem& p : problems) {
      (void)wbc.solve(p, out);
    }
    const double us =
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count() / kProblems;
    sum += us;
    best = std::min(best, us);
  }
  EXPECT_EQ(test::allocations, before);
  std::printf("solve with 10 clearance rows, random problems: mean %.2f us, best batch %.2f us\n", sum / kRepeats, best);
  EXPECT_LT(best, 100.0);  // a twentieth of a 2 ms tick even on a slow, busy machine
}

}  // namespace
}  // namespace ajar
