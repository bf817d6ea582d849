#include "ajar/core/so3.hpp"

#include <cmath>
#include <numbers>

namespace ajar {
namespace {

// Below this angle the closed forms lose digits and the series to fourth order is exact to round-off.
constexpr double kSmallAngle = 1e-4;

// sin(t)/t, (1 - cos(t))/t^2, (t - sin(t))/t^3.
struct RotationCoefficients {
  double a, b, c;
};

RotationCoefficients coefficients(double t2) {
  if (t2 < kSmallAngle * kSmallAngle) {
    return {1.0 - t2 / 6.0, 0.5 - t2 / 24.0, 1.0 / 6.0 - t2 / 120.0};
  }
  const double t = std::sqrt(t2);
  return {std::sin(t) / t, (1.0 - std::cos(t)) / t2, (t - std::sin(t)) / (t2 * t)};
}

}  // namespace

Matrix3d hat(const Vector3d& w) {
  Matrix3d H;
  H << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return H;
}

// hat(w)² = w wᵀ - |w|² I.
Matrix3d exp_so3(const Vector3d& w) {
  const double t2 = w.squaredNorm();
  const auto [a, b, c] = coefficients(t2);
  Matrix3d R = b * w * w.transpose() + a * hat(w);
  R.diagonal().array() += 1.0 - b * t2;
  return R;
}

Vector3d log_so3(const Matrix3d& R) {
  const Vector3d v = 0.5 * Vector3d(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  const double sine = v.norm();
  const double cosine = 0.5 * (R.trace() - 1.0);
  const double angle = std::atan2(sine, cosine);
  if (sine < kSmallAngle && cosine < 0.0) {  // near a half turn the axis comes from the symmetric part
    const Eigen::AngleAxisd aa(R);
    return aa.angle() * aa.axis();
  }
  return sine < 1e-9 ? v : Vector3d(v * (angle / sine));
}

Matrix3d left_jacobian_so3(const Vector3d& w) {
  const auto [a, b, c] = coefficients(w.squaredNorm());
  const Matrix3d H = hat(w);
  return Matrix3d::Identity() + b * H + c * H * H;
}

double wrap_angle(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * std::numbers::pi);
  return wrapped == -std::numbers::pi ? std::numbers::pi : wrapped;
}

double wrap_half_turn(double angle) {
  const double wrapped = std::remainder(angle, std::numbers::pi);
  return wrapped == -std::numbers::pi / 2.0 ? std::numbers::pi / 2.0 : wrapped;
}

Vector3d any_perpendicular(const Vector3d& v) {
  Eigen::Index smallest = 0;
  v.cwiseAbs().minCoeff(&smallest);
  return v.cross(Vector3d::Unit(smallest)).normalized();
}

}  // namespace ajar
