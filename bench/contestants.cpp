// The contestants in C++: KDL's weighted damped least squares, and ours as a user would call it.
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolvervel_wdls.hpp>

#include "contest.hpp"

#include "ajar/core/so3.hpp"
#include "ajar/wbc/whole_body_controller.hpp"

namespace ajar::bench {
namespace {

// Damping of the pseudo-inverse: too small to be seen in the path.
constexpr double kKdlDamping = 1e-3;

KDL::Frame to_kdl(const Pose& X) {
  const Matrix3d R = X.linear();
  const Vector3d p = X.translation();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
          KDL::Vector(p.x(), p.y(), p.z())};
}

// Turn of the base, its driving, then the arm; every arm joint of Heron turns about z of its frame.
KDL::Chain make_chain(const RobotModel& robot) {
  Kinematics zero;
  robot.compute({}, JointVector::Zero(robot.joints()), zero);
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ)));
  Pose last = robot.joint_pose(0, {});
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::TransX), to_kdl(last)));
  for (int i = 0; i < robot.joints(); ++i) {
    const Pose next = i + 1 < robot.joints() ? robot.joint_pose(i + 1, {}) : zero.X_WE;
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), to_kdl(last.inverse() * next)));
    last = next;
  }
  return chain;
}

class Kdl : public Contestant {
 public:
  explicit Kdl(const PathProblem& problem) : chain_(make_chain(problem.robot())) { velocity_.setLambda(kKdlDamping); }

  void step(const PathTick& tick, InputVector& u) override {
    q_.data << 0.0, 0.0, tick.q;
    position_.JntToCart(q_, hand_);
    const Pose target = to_pose(tick.base).inverse() * tick.target;
    velocity_.CartToJnt(q_, KDL::diff(hand_, to_kdl(target), PathProblem::kPeriod), qdot_);
    u << qdot_.data.tail<6>(), qdot_.data.head<2>();
  }

 private:
  KDL::Chain chain_;
  KDL::ChainFkSolverPos_recursive position_{chain_};
  KDL::ChainIkSolverVel_wdls velocity_{chain_};
  KDL::Frame hand_;
  KDL::JntArray q_{8};
  KDL::JntArray qdot_{8};
};

WbcConfig limits_as_config(const PathProblem& problem) {
  const InputVector limits = problem.limits();
  WbcConfig config;
  config.rate_scale = limits[0] / problem.robot().limits().velocity[0];
  config.base_yaw_rate = limits[6];
  config.base_forward = config.base_reverse = limits[7];
  // The cost that the others have: radians count as metres, all secondary wishes alike.
  config.length = 1.0;
  config.base_speed_weight = config.base_turn_weight = 1.0;
  config.speed_weight = 1e4;  // nothing but a limit slows the hand, and nothing but all limits together move it off its path
  config.hand_weight = 1e8;
  config.rate_weight = limits[0] * limits[0];
  config.base_acceleration = problem.robot().limits().base_acceleration;
  config.base_yaw_acceleration = problem.robot().limits().base_yaw_acceleration;
  return config;
}

class Ajar : public Contestant {
 public:
  explicit Ajar(const PathProblem& problem)
      : problem_(problem), robot_(problem.robot()), controller_(robot_, limits_as_config(problem), PathProblem::kPeriod) {
    task_.kinematics = &kinematics_;
  }

  // All others ignore accelerations and start at full speed: so do we, by standing at the first step until it is reached.
  void restart(const PathTick& first) override {
    controller_.reset();
    for (int i = 0; i < kSettle; ++i) step(first, settled_);
  }

  void step(const PathTick& tick, InputVector& u) override {
    robot_.compute(tick.base, tick.q, kinematics_);
    Vector6d wanted;
    wanted << tick.target.translation() - kinematics_.X_WE.translation(),
        log_so3(tick.target.linear() * kinematics_.X_WE.linear().transpose());
    task_.q = &tick.q;
    task_.tangential = problem_.path_twist(tick.step);
    task_.correction = wanted / PathProblem::kPeriod - task_.tangential;
    task_.base = {tick.wishes[7], tick.wishes[6]};
    task_.rates = tick.wishes.head<6>();
    static_cast<void>(controller_.solve(task_, solution_));
    u = solution_.u;
  }

 private:
  static constexpr int kSettle = 1000;  // two seconds at the acceleration limits

  const PathProblem& problem_;
  RobotModel robot_;
  WholeBodyController controller_;
  Kinematics kinematics_;
  WbcProblem task_;
  WbcSolution solution_;
  InputVector settled_ = InputVector::Zero(8);
};

}  // namespace

std::unique_ptr<Contestant> make_kdl(const PathProblem& problem) { return std::make_unique<Kdl>(problem); }
std::unique_ptr<Contestant> make_ajar(const PathProblem& problem) { return std::make_unique<Ajar>(problem); }

}  // namespace ajar::bench
