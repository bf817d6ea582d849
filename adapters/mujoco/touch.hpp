#pragma once

#include <string>
#include <vector>

#include "scene.hpp"

#include "ajar/plant/sensor_models.hpp"

namespace ajar::scene {

/// The grasp: fingers that close on the handle and the spring between hand and handle while they hold it.
class Grasp {
 public:
  /// @throws PlantError  when the scene lacks its parts
  Grasp(mjModel& model, const RobotModel& robot, const Handle& handle, const GraspConfig& config);

  /// Open, nothing held. Needs the positions of the bodies.
  void reset(mjData& data) noexcept;
  /// After a physics step: moves the fingers, takes, holds, creeps or lets go. No allocation.
  /// @param may_hold  False forces the hand to lose what it holds
  void step(mjData& data, bool closed, bool may_hold) noexcept;

  [[nodiscard]] bool grasped() const noexcept { return grasped_; }
  [[nodiscard]] const std::vector<int>& tool_geoms() const noexcept { return tool_geoms_; }
  [[nodiscard]] double opening() const noexcept { return gripper_.opening(); }  ///< Of the fingers [m]
  [[nodiscard]] const Vector3d& force() const noexcept { return force_; }       ///< Robot on handle, world axes [N]
  [[nodiscard]] const Vector3d& torque() const noexcept { return torque_; }  ///< Robot on handle about the hand, world [N m]

 private:
  [[nodiscard]] double grip_distance(const mjData& data) const noexcept;
  void take(mjData& data) noexcept;
  void release(mjData& data) noexcept;
  void read_force(const mjData& data) noexcept;
  void creep(const mjData& data) noexcept;
  void allow_tool_on_leaf(bool allowed) noexcept;

  mjModel& model_;
  GraspConfig config_;
  Gripper gripper_;
  double thickness_;   // of the handle [m]
  double drop_reach_;  // how far the grip may creep from the handle's centre [m]
  int equality_;
  int hand_site_;
  int grip_site_;
  int hand_body_;
  int held_body_;
  std::vector<int> tool_geoms_;
  bool grasped_ = false;
  bool tool_on_leaf_ = true;
  Vector3d force_ = Vector3d::Zero();
  Vector3d torque_ = Vector3d::Zero();
};

/// Keeps the first instant and the largest force of every touch that was not wanted.
class ContactLog {
 public:
  /// @param hand  Geoms of the tool and the last link
  ContactLog(const mjModel& model, const std::vector<int>& hand);
  void reset() noexcept;
  /// Takes in the contacts of a solved physics step. Allocates when a pair touches for the first time, never otherwise.
  /// @param leans  The hand is meant to touch the leaf
  void record(const mjModel& model, const mjData& data, double time, bool leans) noexcept;
  [[nodiscard]] const std::vector<Contact>& contacts() const noexcept { return contacts_; }

 private:
  std::vector<int> part_of_geom_;  // index in parts_
  std::vector<bool> hand_geom_;
  std::vector<bool> leaf_geom_;
  std::vector<bool> robot_of_geom_;  // the robot's body, wheels and casters excepted
  std::vector<std::string> parts_;
  std::vector<int> keys_;  // of the pair, beside contacts_
  std::vector<Contact> contacts_;
};

}  // namespace ajar::scene
