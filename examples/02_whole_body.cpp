// Whole-body control in a loop of one's own: the hand draws a quarter circle of a door while the base comes along.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ajar/core/so3.hpp"
#include "ajar/wbc/base_law.hpp"
#include "ajar/wbc/whole_body_controller.hpp"

using namespace ajar;

int main() {
  const double dt = 0.002;
  const double radius = 0.8;
  const double speed = 0.08;
  const RobotModel robot = load_robot("heron");
  BasePose base;
  JointVector q = robot.home();
  Pose start = Pose::Identity();  // hand z ahead, fingers closing to the side
  start.linear() << 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0;
  start.translation() = Vector3d(0.85, 0.1, 1.0);
  if (!robot.solve_ik(base, start, q)) return 1;

  WholeBodyController controller(robot, WbcConfig{}, dt);
  BaseLaw base_law{BaseLawConfig{}};
  base_law.reset(base, start.translation());
  const Vector3d curvature(0.0, 0.0, -1.0 / radius);  // hinge on the left, opening towards the robot
  BaseLawInput wish;
  wish.curvature = curvature;
  wish.wanted_speed = wish.measured_speed = speed;
  wish.confidence = 1.0;
  Kinematics kinematics;
  WbcProblem problem;
  WbcSolution solution;
  double worst = 0.0;
  for (double arc = 0.0; arc < 0.5 * M_PI * radius; arc += speed * solution.speed_factor * dt) {
    const Matrix3d turned = exp_so3(arc * curvature);
    wish.direction = turned * -Vector3d::UnitX();
    const Vector3d arm = wish.direction.cross(curvature) * radius * radius;  // from the hinge to the hand
    const Vector3d wanted = start.translation() + arm - turned.transpose() * arm;
    robot.compute(base, q, kinematics);
    const Vector3d error = wanted - kinematics.X_WE.translation();
    worst = std::max(worst, error.norm());
    problem.kinematics = &kinematics;
    problem.q = &q;
    problem.tangential << speed * wish.direction, speed * curvature;
    problem.correction << 2.0 * error, 2.0 * log_so3(turned * start.linear() * kinematics.X_WE.linear().transpose());
    wish.base = base;
    wish.hand = kinematics.X_WE.translation();
    problem.base = base_law.step(wish).twist;
    if (controller.solve(problem, solution) == WbcStatus::Invalid) return 1;
    q += dt * solution.u.head(robot.joints());
    base = integrate_base(base, solution.u[robot.joints() + 1], solution.u[robot.joints()], dt);
  }
  std::printf("hand within %.2f mm, base at (%.2f, %.2f, %.0f°)\n", 1e3 * worst, base.x, base.y, 57.3 * base.yaw);
  return worst < 0.005 ? 0 : 1;
}
