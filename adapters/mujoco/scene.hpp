#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>

#include "ajar/mechanism/mechanism.hpp"
#include "ajar/mujoco/mujoco_plant.hpp"
#include "ajar/plant/plant.hpp"

/// How the scene is put together, part by part; seen by this adapter only.
namespace ajar::scene {

struct SpecDeleter {
  void operator()(mjSpec* spec) const noexcept { mj_deleteSpec(spec); }
};
struct ModelDeleter {
  void operator()(mjModel* model) const noexcept { mj_deleteModel(model); }
};
struct DataDeleter {
  void operator()(mjData* data) const noexcept { mj_deleteData(data); }
};
using SpecPtr = std::unique_ptr<mjSpec, SpecDeleter>;
using ModelPtr = std::unique_ptr<mjModel, ModelDeleter>;
using DataPtr = std::unique_ptr<mjData, DataDeleter>;

// Who touches whom: robot geoms carry the type bits, the others the affinity bits. High bits, so that a model which we did
// not write keeps its own contacts.
inline constexpr int kFloorBit = 1 << 20;  ///< Wheels and casters on the floor
inline constexpr int kWorldBit = 1 << 21;  ///< Robot on walls and furniture
inline constexpr int kLeafBit = 1 << 22;   ///< Robot on the leaf; taken from the tool near the handle
inline constexpr int kSelfBit = 1 << 23;   ///< Robot on itself

// Names in the compiled model.
inline constexpr const char* kRobotPrefix = "robot/";
inline constexpr const char* kMechanismJoint = "ajar/mechanism";
inline constexpr const char* kGripSite = "ajar/grip";
inline constexpr const char* kSleeveBody = "ajar/sleeve";
inline constexpr const char* kGrasp = "ajar/grasp";
inline constexpr const char* kMechanismLock = "ajar/mechanism_lock";
inline constexpr const char* kSensorSite = "ajar/wrist_sensor";
inline constexpr const char* kHandSite = "ajar/hand";
inline constexpr const char* kBaseJoint = "ajar/base";
inline constexpr const char* kWheel[2] = {"ajar/wheel_left", "ajar/wheel_right"};
inline constexpr const char* kWheelLock[2] = {"ajar/wheel_left_lock", "ajar/wheel_right_lock"};

/// Where handle and leaf live in the spec.
struct LeafSlot {
  mjsBody* body = nullptr;       ///< Body that carries the handle
  Pose X_WL = Pose::Identity();  ///< Its pose in the world, mechanism closed
  std::string joint;             ///< Name of the mechanism's joint
};

/// Stiffness and damping of one joint's servo, and its motor's inertia.
struct ServoGains {
  double kp;        ///< [N m/rad or N/m]
  double kv;        ///< [N m s/rad or N s/m]
  double armature;  ///< [kg m² or kg]
};
/// Gains of all joints before scaling; those of a UR5e when the effort limits are a UR5e's.
[[nodiscard]] std::vector<ServoGains> servo_gains(const RobotModel& model);

/// An empty world with these options. @throws PlantError
[[nodiscard]] SpecPtr empty_world(const PlantConfig& config);
/// Time step, integrator, solver.
void set_options(mjSpec& spec, const PlantConfig& config);
/// Adds the plane that the wheels roll on.
void add_floor(mjSpec& spec, const PlantConfig& config);

/// Adds leaf, joint and surrounding boxes of a described mechanism.
[[nodiscard]] LeafSlot add_mechanism(mjSpec& spec, const Mechanism& mechanism);
/// Adds the robot at its start. Its free joint moves the URDF's root link.
/// @return X_RB, the base frame in the root link  @throws ModelError
[[nodiscard]] Pose add_robot(mjSpec& spec, const RobotModel& model, const PlantConfig& config, const BasePose& start);
/// Adds grip site, sleeve, grasp and lock of the mechanism. Last step before compiling.
void add_grasp(mjSpec& spec, const RobotModel& model, const Mechanism& mechanism, const GraspConfig& grasp,
               const LeafSlot& slot);

/// Reads an MJCF file. @throws IoError, ModelError
[[nodiscard]] SpecPtr read_mjcf(const std::filesystem::path& path);
/// Makes a foreign world ready for the robot: options, collision bits, floor.
/// @throws ModelError
[[nodiscard]] LeafSlot adopt_world(mjSpec& spec, const MjcfWorld& world, const PlantConfig& config);

/// @throws ModelError  with MuJoCo's message
[[nodiscard]] ModelPtr compile(mjSpec& spec, const std::string& what);

/// Sets the spring of the grasp to the configured stiffness. (docs/equations.md#weld)
void set_grasp_spring(mjModel& model, int equality, int hand_body, int handle_body, const GraspConfig& grasp);

inline void copy_to(double* out, const Vector3d& v) { std::copy_n(v.data(), 3, out); }
inline Vector3d vector3(const double* v) { return Eigen::Map<const Vector3d>(v); }
inline Matrix3d matrix3(const double* m) { return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m); }
/// MuJoCo's order w, x, y, z.
inline void copy_quaternion(double* out, const Matrix3d& R) {
  const Eigen::Quaterniond r(R);
  out[0] = r.w();
  out[1] = r.x();
  out[2] = r.y();
  out[3] = r.z();
}

}  // namespace ajar::scene
