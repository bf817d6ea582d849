#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ajar/mechanism/mechanism.hpp"
#include "ajar/model/robot_model.hpp"
#include "ajar/plant/plant.hpp"

namespace ajar {

/// A mechanism inside a model that somebody else wrote.
struct MjcfWorld {
  std::filesystem::path path;      ///< MJCF file
  std::string joint;               ///< Hinge or slide joint that opens
  std::string handle_site;         ///< Site at the centre of the grip
  std::optional<Vector3d> normal;  ///< Outward normal of the leaf at the handle, world; found by rays when absent [-]
  std::optional<Vector3d> bar;     ///< Direction of the bar, world; long axis of the geom at the site when absent [-]
};

/// Reads the truth about a mechanism out of an MJCF model at its initial pose, which counts as closed.
/// @throws IoError     when the file cannot be read
/// @throws ModelError  when joint or site do not exist (names those that do) or no way out of the leaf is found
[[nodiscard]] Mechanism load_mjcf_mechanism(const MjcfWorld& world);

/// Reads and compiles a model, whatever it holds.
/// @throws IoError     when the file cannot be read
/// @throws ModelError  when MuJoCo refuses it
void check_mjcf(const std::filesystem::path& path);

/// Robot, mechanism and surroundings as rigid bodies in contact. (docs/equations.md#plant)
///
/// The arm follows integrated rates through stiff joint servos, the base drives on two wheels that can slip, the grasp is
/// a spring between hand and handle that creeps and breaks. Time of the truth: the end of the last physics step.
class MujocoPlant final : public Plant, public Witness {
 public:
  /// @param start    Base at the start (of a fixed base: for good)  @param q_start  Arm at the start, shape (n)
  /// @throws ConfigError, ModelError, PlantError
  MujocoPlant(const RobotModel& model, const Mechanism& mechanism, const PlantConfig& config, const BasePose& start,
              const JointVector& q_start);
  /// Puts the robot into a world that already holds the mechanism.
  /// @throws ConfigError, IoError, ModelError, PlantError
  MujocoPlant(const RobotModel& model, const MjcfWorld& world, const PlantConfig& config, const BasePose& start,
              const JointVector& q_start);
  MujocoPlant(const MujocoPlant&) = delete;
  MujocoPlant& operator=(const MujocoPlant&) = delete;
  ~MujocoPlant() override;

  void reset(std::uint64_t seed) override;
  void apply(const Command& command) noexcept override;
  void advance(double dt) noexcept override;
  [[nodiscard]] RobotState measure() noexcept override;
  [[nodiscard]] const Truth& truth() const noexcept override;
  [[nodiscard]] const std::vector<Contact>& contacts() const noexcept override;

  /// The mechanism as it truly is.
  [[nodiscard]] const Mechanism& mechanism() const noexcept;
  /// A force on the handle that does not come from the robot, world axes, held until changed [N].
  void push_handle(const Vector3d& force) noexcept;
  /// Inertia that the mechanism's coordinate has in the physics, armature included [kg m² or kg].
  [[nodiscard]] double mechanism_inertia() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ajar
