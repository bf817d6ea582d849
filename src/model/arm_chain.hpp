#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ajar/core/types.hpp"

namespace ajar {

/// Names that pick the arm out of a URDF.
struct ArmChainNames {
  std::vector<std::string> joints;  ///< From the base to the hand
  std::string base_frame;
  std::string hand_frame;
  std::string sensor_frame;
};

/// Kinematics of the arm relative to the base frame, by Pinocchio. All other joints of the URDF are locked at zero.
class ArmChain {
 public:
  /// Spatial Jacobian at the origin of the base frame, shape (6, n), linear rows first.
  using SpatialJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxJoints>;

  /// @throws ModelError
  ArmChain(const std::filesystem::path& urdf, const ArmChainNames& names);
  ArmChain(const ArmChain& other);
  ArmChain& operator=(const ArmChain&) = delete;
  ~ArmChain();

  /// Evaluates poses and Jacobian at q, shape (n). No allocation, no exception, bounded time.
  void compute(const JointVector& q) noexcept;

  [[nodiscard]] const Pose& hand() const noexcept { return X_BE_; }                ///< Base frame
  [[nodiscard]] const Pose& sensor() const noexcept { return X_BF_; }              ///< Base frame
  [[nodiscard]] const SpatialJacobian& jacobian() const noexcept { return J_B_; }  ///< Base frame
  [[nodiscard]] Pose joint(int index) const noexcept;                              ///< Joint frame in the base frame

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  Pose X_BE_ = Pose::Identity();
  Pose X_BF_ = Pose::Identity();
  SpatialJacobian J_B_;
};

}  // namespace ajar
