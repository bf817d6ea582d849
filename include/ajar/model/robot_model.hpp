#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ajar/core/types.hpp"
#include "ajar/model/robot_drawing.hpp"

namespace ajar {

enum class BaseType { Differential, Fixed };

/// Limits of the inputs and states; sources stand beside the values in the robot's TOML file.
struct RobotLimits {
  JointVector position_lower;          ///< shape (n) [rad or m]
  JointVector position_upper;          ///< shape (n) [rad or m]
  JointVector velocity;                ///< shape (n) [rad/s or m/s]
  JointVector acceleration;            ///< shape (n) [rad/s² or m/s²]
  JointVector effort;                  ///< shape (n) [N m or N]
  double base_forward = 0.8;           ///< Largest forward speed [m/s]
  double base_reverse = 0.3;           ///< Largest backward speed, positive [m/s]
  double base_yaw_rate = 1.0;          ///< [rad/s]
  double base_acceleration = 1.5;      ///< [m/s²]
  double base_yaw_acceleration = 2.0;  ///< [rad/s²]
  double wheel_speed = 20.0;           ///< Of each driven wheel [rad/s]
};

/// One collision body: a capsule or a box, fixed to a moving part.
/// A URDF cylinder is read as the capsule of the same segment (its length = distance of the capsule's end points), a sphere
/// as a capsule of length zero.
struct CollisionShape {
  enum class Kind { Capsule, Box };
  Kind kind = Kind::Capsule;
  std::string link;                          ///< URDF link that carries it
  int joint = -1;                            ///< Index of the arm joint that moves it, -1 = the base
  Pose pose_in_joint = Pose::Identity();     ///< Centre; capsule axis along z. Frame of that joint, or of the base
  double radius = 0.0;                       ///< Capsule [m]
  double half_length = 0.0;                  ///< Capsule: half the distance of its end points [m]
  Vector3d half_extents = Vector3d::Zero();  ///< Box [m]
};

/// Everything that one evaluation of the kinematics gives.
struct Kinematics {
  Pose X_WE = Pose::Identity();          ///< Hand (tool centre point) in the world
  Matrix3d R_WF = Matrix3d::Identity();  ///< Axes of the force sensor in the world
  Vector3d p_WF = Vector3d::Zero();      ///< Origin of the force sensor in the world [m]
  HandJacobian J;                        ///< Hand Jacobian, shape (6, n + 2) (docs/equations.md#jacobian)
  double distance = 0.0;                 ///< Planar distance hand - wheel axle (docs/equations.md#distance) [m]
  InputRow distance_jacobian;            ///< d(distance)/dt = J_d u, shape (1, n + 2)
  bool valid = false;                    ///< False: an input was not finite; J and J_d are zero, the poses are kept
};

/// Kinematics, limits and collision shapes of base + arm + tool. Copies share nothing that changes: one copy per thread.
class RobotModel {
 public:
  /// Loads robots/NAME/NAME.urdf + .toml, or a URDF path with its .toml beside it.
  /// @throws ModelError, IoError  naming file, line, key, value and what is allowed
  static RobotModel load(const std::filesystem::path& urdf, const std::filesystem::path& toml);

  RobotModel(const RobotModel& other);
  RobotModel& operator=(const RobotModel& other);
  RobotModel(RobotModel&&) noexcept;
  RobotModel& operator=(RobotModel&&) noexcept;
  ~RobotModel();

  [[nodiscard]] const std::string& name() const noexcept;
  [[nodiscard]] int joints() const noexcept;  ///< n
  [[nodiscard]] int inputs() const noexcept { return joints() + 2; }
  [[nodiscard]] const std::vector<std::string>& joint_names() const noexcept;
  [[nodiscard]] BaseType base_type() const noexcept;
  [[nodiscard]] double wheel_radius() const noexcept;  ///< [m]
  [[nodiscard]] double wheel_track() const noexcept;   ///< Distance of the driven wheels [m]
  [[nodiscard]] const RobotLimits& limits() const noexcept;
  [[nodiscard]] const std::vector<CollisionShape>& shapes() const noexcept;
  [[nodiscard]] const RobotDrawing& drawing() const noexcept;  ///< What is seen of it
  [[nodiscard]] double tool_mass() const noexcept;             ///< Beyond the force sensor [kg]
  [[nodiscard]] const Vector3d& tool_com() const noexcept;     ///< Of that mass, sensor axes and origin [m]
  [[nodiscard]] const JointVector& home() const noexcept;      ///< Driving posture, shape (n)
  [[nodiscard]] double gripper_stroke() const noexcept;        ///< Largest opening of the fingers [m]
  [[nodiscard]] const std::filesystem::path& urdf_path() const noexcept;
  [[nodiscard]] const std::string& hand_frame() const noexcept;
  [[nodiscard]] const std::string& sensor_frame() const noexcept;
  /// Pairs of indices in shapes() whose distance is never looked at: the robot's own list in its TOML file.
  [[nodiscard]] const std::vector<std::array<int, 2>>& unchecked_pairs() const noexcept;

  /// Evaluates hand, sensor, Jacobian and distance. Non-finite inputs: `out.valid` is false and the Jacobians are zero. No
  /// allocation, no exception, bounded time; not thread-safe on one object.
  void compute(const BasePose& base, const JointVector& q, Kinematics& out) const noexcept;

  /// False until the last compute() had finite inputs; joint_pose() and point_jacobian() then speak of an older posture.
  [[nodiscard]] bool evaluated() const noexcept;

  /// Poses of the joint frames in the world, from the same evaluation as the last compute(); index -1 is the base.
  [[nodiscard]] Pose joint_pose(int joint, const BasePose& base) const noexcept;

  /// Velocity Jacobian of a world point fixed to a joint's body, shape (3, n + 2), after compute().
  /// (docs/equations.md#jacobian)
  void point_jacobian(int joint, const Vector3d& p_W, const BasePose& base,
                      Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxInputs>& out) const noexcept;

  /// Finds joint positions that bring the hand to a pose (damped Newton). Set-up and planning only.
  /// Joints that can turn freely are wrapped to (-π, π] where their limits allow it; on failure q is left as it was.
  /// @return true when position [m] and rotation [rad] error fall below 1e-5 with all joints inside their limits
  [[nodiscard]] bool solve_ik(const BasePose& base, const Pose& X_WE, JointVector& q, int iterations = 60) const;

 private:
  struct Impl;
  explicit RobotModel(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Smallest singular value of the arm part of the hand Jacobian with rotation rows scaled by L.
/// (docs/equations.md#sigma) @param length  L [m]
[[nodiscard]] double arm_sigma_min(const Kinematics& kinematics, double length = 0.3) noexcept;

/// Where the last value was found, for arm_sigma_min in a loop.
struct SigmaTrack {
  Vector6d direction = Vector6d::Zero();  ///< Left singular vector (right one with fewer than six joints); 0 = nothing known
  double square = 0.0;                    ///< σ_min²
};

/// The same from the value of the last tick, six times faster where the posture changes little: never too small, too
/// large by at most 6 % + 0.002, on a walk of the joints by 0.001. (docs/equations.md#sigma)
/// @param length         L [m]
/// @param[in,out] track  Of the last call
/// No allocation, no exception, bounded time.
[[nodiscard]] double arm_sigma_min(const Kinematics& kinematics, double length, SigmaTrack& track) noexcept;

/// Wheel speeds (left, right) of a base twist, and back. (docs/equations.md#wheels) [rad/s]
[[nodiscard]] Vector2d wheel_speeds(const RobotModel& model, double v, double w) noexcept;

/// The pose after driving with constant (v, ω) for dt: exact on the arc, series near ω = 0. (docs/equations.md#unicycle)
[[nodiscard]] BasePose integrate_base(const BasePose& base, double v, double w, double dt) noexcept;

/// Finds a robot: a folder name under robots/ of the source or installed tree, or a path to a URDF.
/// @throws IoError  listing the names that exist
[[nodiscard]] RobotModel load_robot(const std::string& name_or_path);

}  // namespace ajar
