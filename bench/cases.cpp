// What is measured: the steps of one control tick alone, and the whole tick while a door opens.
#include <cmath>
#include <eiquadprog/eiquadprog-rt.hpp>
#include <optional>

#include "bench.hpp"

#include "ajar/core/error.hpp"
#include "ajar/core/random.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/mechanism/builders.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/plant/kinematic_plant.hpp"
#include "ajar/wbc/task_qp.hpp"

namespace ajar::bench {
namespace {

constexpr double kPeriod = 0.002;

/// Heron somewhere near its driving posture, anew for every step.
class Posed : public Case {
 public:
  void prepare() override {
    base_ = {random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0), random_.uniform(-3.0, 3.0)};
    for (int i = 0; i < robot_.joints(); ++i) q_[i] = robot_.home()[i] + random_.uniform(-0.3, 0.3);
  }

 protected:
  Random random_{1};
  RobotModel robot_ = load_robot("heron");
  BasePose base_;
  JointVector q_ = robot_.home();
  Kinematics kinematics_;
};

class KinematicsCase : public Posed {
 public:
  void step() override { robot_.compute(base_, q_, kinematics_); }
};

/// A leaf and a wall in front of the robot.
class ClearanceCase : public Posed {
 public:
  ClearanceCase() {
    Box wall;
    wall.half_extents = Vector3d(0.15, 2.5, 1.5);
    Box leaf;
    leaf.half_extents = Vector3d(0.02, 0.4, 1.0);
    wall_ = wall;
    leaf_ = leaf;
  }
  void prepare() override {
    Posed::prepare();
    const Pose X_WB = to_pose(base_);
    wall_.pose = X_WB * Eigen::Translation3d(1.3, 0.0, 1.5);
    leaf_.pose = X_WB * Eigen::Translation3d(1.0, 0.0, 1.0);
    checker_.set_obstacle(0, wall_, MayTouch::Hand);
    checker_.set_obstacle(1, leaf_, MayTouch::Hand);
    robot_.compute(base_, q_, kinematics_);
  }
  void step() override { checker_.compute(robot_, base_, rows_); }

 protected:
  Box wall_;
  Box leaf_;
  ClearanceChecker checker_{robot_, ClearanceConfig{}};
  ClearanceResult rows_;
};

/// The QP with the distance rows of that scene.
class WbcCase : public ClearanceCase {
 public:
  void prepare() override {
    ClearanceCase::prepare();
    checker_.compute(robot_, base_, rows_);
    problem_.kinematics = &kinematics_;
    problem_.q = &q_;
    problem_.clearance = &rows_;
    problem_.tangential << 0.1 * random_.direction(), 0.1 * random_.direction();
    problem_.base = {random_.uniform(-0.1, 0.1), random_.uniform(-0.2, 0.2)};
    controller_.reset();
  }
  void step() override { status_ = controller_.solve(problem_, solution_); }

 private:
  WholeBodyController controller_{robot_, WbcConfig{}, kPeriod};
  WbcProblem problem_;
  WbcSolution solution_;
  WbcStatus status_ = WbcStatus::Ok;
};

/// The QP alone with tight limits, posed anew for every step: nothing to guess from the last one.
class OwnQpCase : public Posed {
 public:
  OwnQpCase() {
    qp_.tasks = 6;
    qp_.task_weight.setConstant(1e4);
    qp_.lower.head<8>().setConstant(-0.3);
    qp_.upper.head<8>().setConstant(0.3);
    qp_.upper[8] = 1.0;
  }
  void prepare() override {
    Posed::prepare();
    robot_.compute(base_, q_, kinematics_);
    Vector6d twist;
    twist << 0.1 * random_.direction(), 0.1 * random_.direction();
    qp_.A.topLeftCorner<6, 8>() = kinematics_.J;
    qp_.A.col(8).head<6>() = -twist;
    qp_.wanted[8] = 1.0;
    qp_.wanted.segment<2>(6) << random_.uniform(-0.3, 0.3), random_.uniform(-0.2, 0.2);
  }
  void step() override { status_ = solver_.solve(qp_, solution_); }

 protected:
  QpProblem qp_;

 private:
  TaskQp solver_;
  QpSolution solution_;
  QpStatus status_ = QpStatus::Solved;
};

/// The same problems by eiquadprog: nine variables, eighteen bounds, the cost as a dense matrix.
class EiquadprogCase : public OwnQpCase {
 public:
  void prepare() override {
    OwnQpCase::prepare();
    const auto A = qp_.A.topLeftCorner<6, 9>();
    H_ = 1e4 * A.transpose() * A;
    H_.diagonal() += qp_.weight.head<9>();
    g_ = -qp_.weight.head<9>().cwiseProduct(qp_.wanted.head<9>());
    G_.topRows<9>().setIdentity();
    G_.bottomRows<9>() = -G_.topRows<9>();
    h_ << -qp_.lower.head<9>(), qp_.upper.head<9>();
  }
  void step() override { status_ = solver_.solve_quadprog(H_, g_, E_, e_, G_, h_, x_); }

 private:
  eiquadprog::solvers::RtEiquadprog<9, 0, 18> solver_;
  RtMatrixX<9, 9>::d H_;
  RtVectorX<9>::d g_;
  RtVectorX<9>::d x_;
  RtMatrixX<0, 9>::d E_;
  RtVectorX<0>::d e_;
  RtMatrixX<18, 9>::d G_;
  RtVectorX<18>::d h_;
  eiquadprog::solvers::RtEiquadprog_status status_ = eiquadprog::solvers::RT_EIQUADPROG_OPTIMAL;
};

/// A hinge of 0.8 m at 0.1 m/s, noisy poses; starts again after every quarter turn.
class EstimatorCase : public Case {
 public:
  void prepare() override {
    const double angle = 0.1 * time_ / 0.8;
    if (time_ == 0.0 || angle > 1.57) {
      time_ = 0.0;
      look(0.0);
      estimator_.reset(input_.hand, Vector3d(0.3, 0.95, 0.0).normalized());
    }
    time_ += input_.dt;
    look(0.1 * time_ / 0.8);
  }
  void step() override { status_ = estimator_.update(input_); }

 private:
  void look(double angle) {
    input_.hand.linear() = exp_so3({0.0, 0.0, angle}) * exp_so3(random_.normal3(0.002));
    input_.hand.translation() = Vector3d(0.8 * std::cos(angle), 0.8 * std::sin(angle), 1.0) + random_.normal3(0.0005);
    input_.velocity = 0.1 * Vector3d(-std::sin(angle), std::cos(angle), 0.0);
  }
  Random random_{1};
  MechanismEstimator estimator_{EstimatorConfig{}};
  EstimatorInput input_;
  EstimatorStatus status_ = EstimatorStatus::Ok;
  double time_ = 0.0;
};

/// A mission on the kinematic plant, with its ticks of phase `open` measured.
class MissionCase : public Case {
 public:
  MissionCase() {
    config_.kind = "kinematic";
    door_.radius = 0.8;
  }
  void prepare() override {
    if (mission_) advance();
    while (!mission_ || mission_->phase() != Phase::Open) {
      if (!mission_ || mission_->finished()) begin();
      command_ = mission_->step(state_);
      advance();
    }
  }
  void step() override { command_ = mission_->step(state_); }

 private:
  void begin() {
    if (mission_ && !mission_->reached_goal()) throw Error("mission: " + mission_->explain());
    plant_.emplace(robot_, make_mechanism(door_), config_, BasePose{0.2, -1.6, 1.4}, robot_.home());
    plant_->reset(1);
    mission_.emplace(robot_, MissionConfig{}, Vector3d(0.5, -0.87, 0.0).normalized(), 1);
    state_ = plant_->measure();
  }
  void advance() {
    plant_->apply(command_);
    plant_->advance(kPeriod);
    state_ = plant_->measure();
  }
  RobotModel robot_ = load_robot("heron");
  PlantConfig config_;
  MechanismConfig door_;
  std::optional<KinematicPlant> plant_;
  std::optional<Mission> mission_;
  RobotState state_;
  Command command_;
};

class ChoiceCase : public Case {
 public:
  ChoiceCase() { belief_.position = Vector3d(0.0, -0.06, 1.0); }
  void step() override { candidates_ = planner_.choose(belief_, seed_++); }

 private:
  RobotModel robot_ = load_robot("heron");
  GraspPlanner planner_{robot_, PlannerConfig{}, WbcConfig{}, BaseLawConfig{}, ClearanceConfig{}};
  HandleBelief belief_;
  std::vector<GraspCandidate> candidates_;
  std::uint64_t seed_ = 1;
};

template <typename T>
std::unique_ptr<Case> make() {
  return std::make_unique<T>();
}

}  // namespace

std::vector<CaseInfo> all_cases() {
  return {{"kinematics", "Heron: hand pose, 6x8 Jacobian, distance", 20000, make<KinematicsCase>},
          {"clearance", "Heron with wall and leaf", 10000, make<ClearanceCase>},
          {"qp_with_rows", "QP, 8 inputs, distance rows of that scene", 20000, make<WbcCase>},
          {"qp_cold", "QP alone, 9 variables, random, tight", 20000, make<OwnQpCase>},
          {"qp_eiquadprog", "the same QPs by eiquadprog", 20000, make<EiquadprogCase>},
          {"estimator", "hinge r 0.8 m, one pose", 20000, make<EstimatorCase>},
          {"mission_tick", "kinematic plant, phase open", 10000, make<MissionCase>},
          {"choice", "grasp and base pose, once per mission", 10, make<ChoiceCase>}};
}

}  // namespace ajar::bench
