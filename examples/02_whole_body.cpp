// Whole-body control in a loop of one's own: the hand draws a quarter circle of a door while the base comes along.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ajar/core/so3.hpp"
#include "ajar/wbc/base_law.hpp"
#include "ajar/wbc/whole_body_controller.hpp"

int main() {
  const double dt = 0.002;
  const double radius = 0.8;
  const double speed = 0.08;
  const ajar::RobotModel robot = ajar::load_robot("heron");
  ajar::BasePose base;
  ajar::JointVector q = robot.home();
  ajar::Pose start = ajar::Pose::Identity();  // hand z ahead, fingers closing to the side
  start.linear() << 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0;
  start.translation() = ajar::Vector3d(0.85, 0.1, 1.0);
  if (!robot.solve_ik(base, start, q)) return 1;

  ajar::WholeBodyController controller(robot, ajar::WbcConfig{}, dt);
  ajar::BaseLaw base_law{ajar::BaseLawConfig{}};
  base_law.reset(base, start.translation());
  const ajar::Vector3d curvature(0.0, 0.0, -1.0 / radius);  // hinge on the left, opening towards the robot
  ajar::Kinematics kinematics;
  ajar::WbcProblem problem;
  ajar::WbcSolution solution;
  problem.measured = ajar::InputVector::Zero(robot.inputs());
  double worst = 0.0;
  double arc = 0.0;
  while (arc < 0.5 * M_PI * radius) {
    const ajar::Matrix3d turned = ajar::exp_so3(arc * curvature);
    const ajar::Vector3d direction = turned * -ajar::Vector3d::UnitX();
    const ajar::Vector3d arm = direction.cross(curvature) * radius * radius;  // from the hinge to the hand
    const ajar::Vector3d wanted = start.translation() + arm - turned.transpose() * arm;
    robot.compute(base, q, kinematics);
    const ajar::Vector3d error = wanted - kinematics.X_WE.translation();
    const ajar::Vector3d turn = ajar::log_so3(turned * start.linear() * kinematics.X_WE.linear().transpose());
    worst = std::max(worst, error.norm());

    problem.kinematics = &kinematics;
    problem.q = &q;
    problem.tangential << speed * direction, speed * curvature;
    problem.correction << 2.0 * error, 2.0 * turn;
    problem.base = base_law.step({.dt = dt, .base = base, .hand = kinematics.X_WE.translation(), .direction = direction,
                                  .curvature = curvature, .wanted_speed = speed, .measured_speed = speed, .confidence = 1.0}).twist;
    if (controller.solve(problem, solution) == ajar::WbcStatus::Invalid) return 1;
    q += dt * solution.u.head(robot.joints());
    base = ajar::integrate_base(base, solution.u[robot.joints() + 1], solution.u[robot.joints()], dt);
    problem.measured = solution.u;
    arc += speed * solution.speed_factor * dt;
  }
  std::printf("a quarter turn: hand within %.2f mm, base drove to (%.2f, %.2f), turned %.0f°\n", 1e3 * worst, base.x, base.y, 57.3 * base.yaw);
  return worst < 0.005 ? 0 : 1;
}
