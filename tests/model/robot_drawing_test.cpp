// Strategy: what is drawn must stand where the kinematics say: the chain of drawn joints, walked with plain rotations and
// shifts, against the model's own joint and hand poses at random postures (two independent ways from the same URDF). Shapes
// and colours by a URDF of few words. How it looks is not tested.
#include "ajar/model/robot_drawing.hpp"

#include <gtest/gtest.h>

#include "model_fixtures.hpp"

namespace ajar {
namespace {

Pose joint_motion(const DrawnJoint& joint, double q) {
  Pose X = Pose::Identity();
  if (joint.slides) {
    X.translation() = q * joint.axis;
  } else {
    X.linear() = Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
  }
  return X;
}

void expect_drawn_where_the_kinematics_say(const RobotModel& model) {
  std::mt19937_64 rng(7);
  Kinematics kinematics;
  for (int i = 0; i < 50; ++i) {
    const BasePose base = test::random_base(rng);
    const JointVector q = test::random_posture(model, rng);
    model.compute(base, q, kinematics);
    Pose X = model.joint_pose(-1, base);
    ASSERT_EQ(model.drawing().joints.size(), static_cast<std::size_t>(model.joints()));
    for (int j = 0; j < model.joints(); ++j) {
      const DrawnJoint& joint = model.drawing().joints[static_cast<std::size_t>(j)];
      X = X * joint.pose_in_before * joint_motion(joint, q[j]);
      EXPECT_TRUE(X.isApprox(model.joint_pose(j, base), 1e-9)) << "joint " << j;
    }
    EXPECT_TRUE((X * model.drawing().hand_in_last).isApprox(kinematics.X_WE, 1e-9));
  }
}

TEST(RobotDrawing, StandsWhereTheKinematicsSay) {
  expect_drawn_where_the_kinematics_say(load_robot("heron"));
  const test::TemporaryFolder folder;
  const auto toml = folder.write("ur5e.toml", test::robot_toml(R"("pan", "lift", "elbow", "w1", "w2", "w3")", 6, "tool0"));
  expect_drawn_where_the_kinematics_say(RobotModel::load(folder.write("ur5e.urdf", test::ur5e_urdf()), toml));
}

TEST(RobotDrawing, SlidingJointsMoveAlongTheirAxis) {
  std::string urdf = "<robot name='lift'><link name='base_link'/><link name='carriage'/><link name='tip'/>";
  urdf += test::urdf_joint("up", "prismatic", "base_link", "carriage", "xyz='0.1 0 0.3' rpy='0.2 0 0'", "0 0 2");
  urdf += test::urdf_joint("turn", "revolute", "carriage", "tip", "xyz='0.3 0 0'", "0 1 0") + "</robot>";
  const test::TemporaryFolder folder;
  const auto toml = folder.write("lift.toml", test::robot_toml(R"("up", "turn")", 2, "tip"));
  expect_drawn_where_the_kinematics_say(RobotModel::load(folder.write("lift.urdf", urdf), toml));
}

TEST(RobotDrawing, MeshesAreDrawnByTheirCollisionShapes) {
  std::string urdf =
      "<robot name='toy'><material name='red'><color rgba='1 0 0 0.5'/></material>"
      "<link name='base_link'><visual><origin xyz='0 0 0.2'/><geometry><box size='0.4 0.3 0.2'/></geometry>"
      "<material name='red'/></visual></link>"
      "<link name='arm'><visual><geometry><mesh filename='package://toy/arm.stl'/></geometry></visual>"
      "<collision><geometry><cylinder radius='0.05' length='0.3'/></geometry></collision></link>"
      "<link name='tip'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>";
  urdf += test::urdf_joint("turn", "revolute", "base_link", "arm", "xyz='0 0 0.5'");
  urdf += test::urdf_joint("tool", "fixed", "arm", "tip", "xyz='0 0 0.3'") + "</robot>";
  const test::TemporaryFolder folder;
  const auto toml = folder.write("toy.toml", test::robot_toml("\"turn\"", 1, "tip"));
  const RobotModel model = RobotModel::load(folder.write("toy.urdf", urdf), toml);
  const auto& shapes = model.drawing().shapes;
  ASSERT_EQ(shapes.size(), 2u);  // a link without any visual, as the tip, stays unseen
  EXPECT_EQ(shapes[0].kind, DrawnShape::Kind::Box);
  EXPECT_EQ(shapes[0].joint, -1);
  EXPECT_TRUE(shapes[0].size.isApprox(Vector3d(0.4, 0.3, 0.2)));
  EXPECT_EQ(shapes[0].rgba, (std::array{1.0, 0.0, 0.0, 0.5}));
  EXPECT_EQ(shapes[1].kind, DrawnShape::Kind::Capsule);
  EXPECT_EQ(shapes[1].joint, 0);
  EXPECT_TRUE(shapes[1].size.isApprox(Vector3d(0.05, 0.05, 0.3)));
}

}  // namespace
}  // namespace ajar
