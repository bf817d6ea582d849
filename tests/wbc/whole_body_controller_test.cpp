// Strategy: Heron's real kinematics. Limits are checked on random problems with states outside the limits and broken
// numbers; the hand task by integrating the command exactly along a door of 0.8 m radius; choices (slow down before
// missing the hand, never push away from the world) by hand-made rows with known answers. Left out: physics.
#include "ajar/wbc/whole_body_controller.hpp"

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

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/wbc/base_law.hpp"
#include "ajar/wbc/input_limits.hpp"
#include "allocation_guard.hpp"

namespace ajar {
namespace {

constexpr double kPeriod = 0.002;
constexpr int kSpeed = 7;  // index of v with six joints
constexpr int kTurn = 6;

class HeronWbc : public ::testing::Test {
 protected:
  HeronWbc() { place({}, posture()); }

  // Hand 0.8 m above the floor ahead of the base, elbow up: regular (σ_min > 0.1).
  static JointVector posture() {
    JointVector q(6);
    q << 1.54, -1.6, 2.0, -2.0, -1.57, 0.3;
    return q;
  }

  void place(const BasePose& base, const JointVector& joints) {
    base_pose = base;
    q = joints;
    model.compute(base, q, kinematics);
  }

  WbcProblem problem() {
    WbcProblem p;
    p.kinematics = &kinematics;
    p.q = &q;
    p.measured = InputVector::Zero(8);
    return p;
  }

  // Command at the standstill of a constant problem: all acceleration limits have been left behind.
  WbcSolution settle(WholeBodyController& wbc, WbcProblem p, int ticks = 1500) {
    WbcSolution out;
    for (int tick = 0; tick < ticks; ++tick) {
      (void)wbc.solve(p, out);
      p.measured = out.u;
    }
    return out;
  }

  RobotModel model = load_robot("heron");
  WbcConfig config;
  BasePose base_pose;
  JointVector q;
  Kinematics kinematics;
};

TEST_F(HeronWbc, MeetsTheHandTaskWithTheArmAlone) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.tangential << -0.03, 0.02, 0.0, 0.0, 0.0, 0.05;
  p.correction << 0.0, 0.0, 0.01, 0.02, 0.0, 0.0;
  p.base_fixed = true;
  const WbcSolution out = settle(wbc, p);
  EXPECT_EQ(out.status, WbcStatus::Ok);
  EXPECT_GT(out.speed_factor, 0.97);
  EXPECT_LT((kinematics.J * out.u - out.speed_factor * p.tangential - p.correction).norm(), 2e-5);
  EXPECT_EQ(out.u[kSpeed], 0.0);
  EXPECT_EQ(out.u[kTurn], 0.0);
}

TEST_F(HeronWbc, MovesTheBaseAsAskedWhileTheHandStays) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.base = {0.05, 0.05};
  const WbcSolution out = settle(wbc, p);
  EXPECT_NEAR(out.u[kSpeed], 0.05, 1e-3);
  EXPECT_NEAR(out.u[kTurn], 0.05, 1e-3);
  EXPECT_LT((kinematics.J * out.u).norm(), 1e-4);
}

TEST_F(HeronWbc, TakesPartOfTheBaseAsMeasured) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.measured[kSpeed] = 0.1;  // the base still rolls although nothing is asked
  WbcSolution out;
  for (int tick = 0; tick < 500; ++tick) {
    (void)wbc.solve(p, out);
  }
  InputVector effective = out.u;
  effective.tail<2>() = 0.5 * out.u.tail<2>() + 0.5 * p.measured.tail<2>();
  EXPECT_LT((kinematics.J * effective).norm(), 2e-4);
  EXPECT_LT(out.residual, 1e-4);
}

TEST_F(HeronWbc, SlowsTheTangentialMotionBeforeTheHandTaskIsGivenUp) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.tangential << -2.0, 0.0, 0.0, 0.0, 0.0, 0.0;  // far beyond the joint rates
  p.correction << 0.0, 0.01, 0.0, 0.0, 0.0, 0.0;
  p.base_fixed = true;
  const WbcSolution out = settle(wbc, p);
  EXPECT_EQ(out.status, WbcStatus::Slowed);
  EXPECT_LT(out.speed_factor, 0.9);
  EXPECT_GT(out.speed_factor, 0.05);
  EXPECT_LT(out.residual, 1e-3);
  EXPECT_EQ(out.binding, BindingLimit::JointRate);
}

TEST_F(HeronWbc, LeavesTheFreeAxisToTheWeakTurn) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.tangential << -0.04, 0.0, 0.0, 0.0, 0.0, 0.3;
  p.free_axis = Vector3d::UnitZ();
  p.free_axis_rate = -0.1;
  p.base_fixed = true;
  const WbcSolution out = settle(wbc, p);
  const Vector6d twist = kinematics.J * out.u;
  EXPECT_LT((twist.head<3>() - out.speed_factor * p.tangential.head<3>()).norm(), 1e-4);
  EXPECT_LT(twist.segment<2>(3).norm(), 1e-3);
  EXPECT_LT(twist[5], 0.02);   // not the 0.3 rad/s of the mechanism …
  EXPECT_GT(twist[5], -0.12);  // … but towards the weak turn
}

TEST_F(HeronWbc, BaseThatMustStandBrakesAndStays) {
  WholeBodyController wbc(model, config, kPeriod);
  InputVector last = InputVector::Zero(8);
  last[kSpeed] = 0.1;
  last[kTurn] = 0.2;
  wbc.reset(last);
  WbcProblem p = problem();
  p.base_fixed = true;
  p.base = {0.2, 0.3};
  WbcSolution out;
  for (int tick = 0; tick < 400; ++tick) {
    (void)wbc.solve(p, out);
  }
  EXPECT_EQ(out.u[kSpeed], 0.0);
  EXPECT_EQ(out.u[kTurn], 0.0);
}

// One row that the base's forward motion closes at 1 m per m.
ClearanceResult wall_ahead(double distance, ClearanceKind kind, int obstacle) {
  ClearanceResult clearance;
  clearance.count = 1;
  clearance.rows[0].row = InputRow::Zero(1, 8);
  clearance.rows[0].row[kSpeed] = -1.0;
  clearance.rows[0].distance = distance;
  clearance.rows[0].kind = kind;
  clearance.rows[0].obstacle = obstacle;
  clearance.rows[0].normal = -Vector3d::UnitX();
  return clearance;
}

TEST_F(HeronWbc, ApproachesAWallOnlyAtTheAllowedRate) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  const ClearanceResult clearance = wall_ahead(0.10, ClearanceKind::BaseWorld, 3);
  p.clearance = &clearance;
  p.base = {0.2, 0.0};
  const WbcSolution out = settle(wbc, p);
  EXPECT_NEAR(out.u[kSpeed], 1.0 * (0.10 - 0.04), 1e-3);
  EXPECT_EQ(out.binding, BindingLimit::Clearance);
}

TEST_F(HeronWbc, NeverPushesAwayFromTheWorld) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  const ClearanceResult inside = wall_ahead(-0.05, ClearanceKind::BaseWorld, 3);
  p.clearance = &inside;
  WbcSolution out = settle(wbc, p);
  EXPECT_LT(out.u.norm(), 1e-6);
  // The own body may be left, gently.
  const ClearanceResult own = wall_ahead(-0.05, ClearanceKind::Self, -1);
  p.clearance = &own;
  out = settle(wbc, p);
  EXPECT_NEAR(out.u[kSpeed], -0.05, 5e-3);
}

TEST_F(HeronWbc, LeafThatComesTowardsTheRobotLowersTheSpeedFactor) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  ClearanceResult clearance = wall_ahead(0.04, ClearanceKind::BaseWorld, 2);
  clearance.rows[0].point_on_obstacle = kinematics.X_WE.translation();
  p.clearance = &clearance;
  p.leaf_obstacle = 2;
  p.base_fixed = true;
  p.tangential.head<3>() = Vector3d(-0.04, 0.0, 0.0);
  p.leaf_velocity_at_hand = Vector3d(-0.04, 0.0, 0.0);  // along the row's normal: the leaf swings at the robot
  const WbcSolution out = settle(wbc, p);
  EXPECT_LT(out.speed_factor, 0.02);
  EXPECT_LT(out.slack, 1e-3);
  EXPECT_EQ(out.binding, BindingLimit::Clearance);
  p.leaf_obstacle = 1;  // the same box standing still forbids nothing
  EXPECT_GT(settle(wbc, p).speed_factor, 0.95);
}

TEST_F(HeronWbc, OneSlackKeepsContradictingRowsSolvable) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  ClearanceResult clearance = wall_ahead(0.0, ClearanceKind::Self, -1);
  clearance.count = kMaxClearanceRows;
  for (size_t i = 1; i < kMaxClearanceRows; ++i) {
    clearance.rows[i] = clearance.rows[0];
    clearance.rows[i].row *= i % 2 == 0 ? 1.0 : -1.0;
  }
  p.clearance = &clearance;
  const WbcSolution out = settle(wbc, p, 50);
  EXPECT_NE(out.status, WbcStatus::Invalid);
  EXPECT_NEAR(out.slack, 0.05, 1e-3);
}

class RandomTick {
 public:
  explicit RandomTick(unsigned seed) : generator_(seed) {}
  double normal(double scale) { return scale * std::normal_distribution<double>()(generator_); }
  bool chance(double p) { return std::bernoulli_distribution(p)(generator_); }
  double broken() { return chance(0.5) ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity(); }

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
      default: clearance.count = 1; clearance.rows[0].row = InputRow::Constant(1, 8, broken()); break;
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
  EXPECT_GT(invalid, 0);
  std::printf("%d ticks, %d corrupted, %d invalid, largest violation %.1e\n", kTicks, corrupted, invalid,
              violation);
}

TEST_F(HeronWbc, BrakesOnBrokenInputWithinItsAccelerations) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.tangential << -0.05, 0.05, 0.0, 0.0, 0.0, 0.1;
  p.base = {0.1, 0.1};
  InputVector last = settle(wbc, p).u;
  p.correction[0] = std::nan("");
  WbcSolution out;
  for (int tick = 0; tick < 1000; ++tick) {
    EXPECT_EQ(wbc.solve(p, out), WbcStatus::Invalid);
    EXPECT_TRUE((out.u.cwiseAbs().array() <= last.cwiseAbs().array()).all());
    EXPECT_LE(std::abs(out.u[kSpeed] - last[kSpeed]), config.base_acceleration * kPeriod + 1e-12);
    last = out.u;
  }
  EXPECT_EQ(last.norm(), 0.0);
  p.kinematics = nullptr;
  EXPECT_EQ(wbc.solve(p, out), WbcStatus::Invalid);
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
    const Vector3d hand = kinematics.X_WE.translation();
    // Turn the whole robot so that its base starts with the heading of its reference, backward.
    const Vector3d to_base(-hand.x(), -hand.y(), 0.0);
    const Vector3d path = -Vector3d::UnitX() + k * Vector3d::UnitZ().cross(to_base);
    const BasePose base{0.0, 0.0, std::atan2(path.y(), path.x()) + std::numbers::pi};
    const JointVector shoulder_back = q - base.yaw * JointVector::Unit(6, 0);  // hand nearly where it was
    const DoorRun run = open_door(model, base, shoulder_back, k, 0.1);
    std::printf("door k %.2f: path error %.3f mm, s >= %.3f, sigma >= %.3f\n", k, 1e3 * run.path_error,
                run.least_factor, run.least_sigma);
    EXPECT_GE(run.angle, 0.5 * std::numbers::pi - 1e-9);
    EXPECT_LT(run.path_error, 1e-3);
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
  const auto start = std::chrono::steady_clock::now();
  constexpr int kRepeats = 50;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    for (const WbcProblem& p : problems) {
      (void)wbc.solve(p, out);
    }
  }
  const double us = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count() /
                    (kRepeats * kProblems);
  EXPECT_EQ(test::allocations, before);
  std::printf("solve with 10 clearance rows, random problems: %.2f us\n", us);
}

TEST_F(HeronWbc, RefusesWrongSettings) {
  config.base_share = 1.5;
  EXPECT_THROW(WholeBodyController(model, config, kPeriod), ConfigError);
  EXPECT_THROW(WholeBodyController(model, {}, 0.0), ConfigError);
}

}  // namespace
}  // namespace ajar
