#pragma once

#include "ajar/estimation/curve.hpp"
#include "ajar/estimation/pose_noise.hpp"

namespace ajar {

using Vector4d = Eigen::Matrix<double, 4, 1>;
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix14d = Eigen::Matrix<double, 14, 14>;

/// Mean of the pose samples of one stretch of path.
struct PathBin {
  double count = 0.0;                        ///< Samples [-]
  Vector3d position = Vector3d::Zero();      ///< Mean [m]
  Matrix3d rotation = Matrix3d::Identity();  ///< Mean, hand to world [-]
  double base_travel = 0.0;                  ///< Of the base since the bin before [m]
  double extra_sigma = 0.0;                  ///< Correlated position error beyond the noise model, e.g. of the grasp [m]
};

/// Path at its newest point: a circle or line, the rotation of the grasp, and the slowly varying pose error.
///
/// Errors (a1, a2; w1, w2; dkap1, dkap2; φ1…φ3; b1, b2; c1…c3) in the columns of `F`: p += B a, F ← F Exp(0, w), kap +=
/// dkap, R ← Exp(F φ) R. (docs/equations.md#estimator)
struct PathState {
  Matrix3d F = Matrix3d::Identity();    ///< Columns x (tangent), b1, b2, world axes [-]
  Vector2d kap = Vector2d::Zero();      ///< Curvature along b1, b2 [1/m]
  Vector3d p = Vector3d::Zero();        ///< Point of the path, world axes [m]
  Matrix3d R = Matrix3d::Identity();    ///< Rotation of the grasp, hand to world [-]
  Vector5d error = Vector5d::Zero();    ///< Correlated pose error: b across x [m], c [rad], columns of F
  Matrix14d P = Matrix14d::Identity();  ///< Covariance of the errors, shape (14, 14)

  /// Curvature vector, world axes [1/m].
  [[nodiscard]] Vector3d curvature() const { return F.rightCols<2>() * kap; }
};

/// How one correction went.
struct PathCorrection {
  double nis = 0.0;  ///< Innovation squared over its covariance [-]
  int rows = 0;      ///< Rows used: 2 positions, or 5 with orientation [-]
};

/// Arc from the state to the point of its curve nearest to a position (three Newton steps) [m].
[[nodiscard]] double arc_to(const PathState& state, const Vector3d& position) noexcept;

/// Moves point, frame and grasp rotation along the curve; covariance and pose error stay.
void move_along(PathState& state, double ds) noexcept;

/// Moves the state by ds along the curve with its covariance (P ← T P Tᵀ + Q). (docs/equations.md#estimator)
///
/// @param[in,out] state  Path
/// @param ds           Arc [m]
/// @param bin          The bin that is moved to: its base travel and extra error shape the noise
/// @param noise        Noise model
void predict_path(PathState& state, double ds, const PathBin& bin, const PoseNoise& noise) noexcept;

/// Corrects the state, already moved to the bin's arc, with the bin: scalar updates of 2 or 5 rows.
/// (docs/equations.md#estimator)
///
/// @param[in,out] state    Path
/// @param bin            Mean pose
/// @param noise          Noise model
/// @param use_rotation   False: position rows only
[[nodiscard]] PathCorrection correct_path(PathState& state, const PathBin& bin, const PoseNoise& noise,
                                          bool use_rotation) noexcept;

/// Error of a state against a direction and curvature: the turn (w1, w2) and the curvature (dkap1, dkap2) that are missing.
///
/// @param F    Frame of the state, columns x, b1, b2
/// @param kap  Curvature of the state [1/m]
/// @param x    Compared direction, unit, world axes [-]
/// @param k    Compared curvature vector, world axes [1/m]
[[nodiscard]] Vector4d path_difference(const Matrix3d& F, const Vector2d& kap, const Vector3d& x,
                                       const Vector3d& k) noexcept;

}  // namespace ajar
