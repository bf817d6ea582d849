// What a user of the installed libraries writes: learn a slide, move the whole body one tick.
#include <cstdio>

#include "ajar/estimation/mechanism_estimator.hpp"
#include "ajar/wbc/whole_body_controller.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  ajar::MechanismEstimator estimator{ajar::EstimatorConfig{}};
  ajar::EstimatorInput input;
  input.velocity = ajar::Vector3d(0.1, 0.0, 0.0);
  estimator.reset(input.hand, ajar::Vector3d(0.9, 0.3, 0.0).normalized());
  for (int i = 0; i < 1500; ++i) {
    input.hand.translation() += input.dt * input.velocity;
    if (estimator.update(input) == ajar::EstimatorStatus::Invalid) return 1;
  }

  const ajar::RobotModel robot = ajar::load_robot(argv[1]);
  ajar::WholeBodyController controller(robot, ajar::WbcConfig{}, 0.002);
  ajar::Kinematics kinematics;
  const ajar::JointVector q = robot.home();
  robot.compute(ajar::BasePose{}, q, kinematics);
  ajar::WbcProblem problem;
  problem.kinematics = &kinematics;
  problem.q = &q;
  problem.tangential[0] = -0.01;
  ajar::WbcSolution solution;
  const ajar::WbcStatus status = controller.solve(problem, solution);

  const double along = estimator.estimate().direction.x();
  std::printf("direction %.4f, %s with %d joints\n", along, robot.name().c_str(), robot.joints());
  return along > 0.999 && status != ajar::WbcStatus::Invalid && solution.u.allFinite() ? 0 : 1;
}
