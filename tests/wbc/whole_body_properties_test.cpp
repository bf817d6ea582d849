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
#include "ajar/wbc/state_predictor.hpp"
#include "ajar/wbc/whole_body_controller.hpp"
#include "allocation_guard.hpp"
#include "heron_wbc.hpp"
#include "random_ticks.hpp"

namespace ajar {
namespace {

using test::HeronWbc;
using test::kPeriod;
using test::kSpeed;
using test::kTurn;
using test::wall_ahead;

using test::RandomTick;
using test::RandomTicks;

TEST_F(RandomTicks, NeverBreakALimitOnRandomAndBrokenInput) { expect_limits_kept(100000, 21); }

// Door of radius 0.8 m tracked by hand twist feed-forward and pose feedback, base by the co-rotating law.
struct DoorRun {
  double path_error = 0.0;
  double least_factor = 1.0;
  double least_sigma = 1e9;
  double angle = 0.0;
};

DoorRun open_door(const RobotModel& model, BasePose base, JointVector q, double k, double speed) {
  WbcConfig config;
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
  double s = 0.0;  // path of the reference
  for (int tick = 0; tick < 20000 && std::abs(k) * s < 0.5 * std::numbers::pi; ++tick) {
    const Matrix3d turned = exp_so3(s * curvature);
    const Vector3d x = turned * x0;
    const Vector3d wanted = centre + turned * (start.translation() - centre);
    const double ramp = std::min(speed, 0.1 * tick * kPeriod);
    WbcProblem p;
    p.kinematics = &kinematics;
    p.q = &q;
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

TEST(StatePredictor, NeverAllocatesAfterConstruction) {
  StatePredictor predictor({}, 6, kPeriod, 0.1);
  Command command;
  command.dq = JointVector::Constant(6, 0.1);
  RobotState state;
  state.q = state.dq = JointVector::Zero(6);
  state.base_age = 0.02;
  const long before = test::allocations;
  predictor.sent(command);
  predictor.refresh(state);
  const PredictedState seen = predictor.predict(state);
  EXPECT_EQ(test::allocations, before);
  EXPECT_TRUE(seen.q.allFinite());
}

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
