#include "ajar/estimation/curve.hpp"

#include <cmath>

#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

// Below this angle the closed forms of g1, g2 lose digits by cancellation; the series, cut after the third term, is then
// exact to 1e-10 relative.
constexpr double kSeriesAngle = 0.1;

// c1, c2 and their derivatives by kap over kap_j (g1, g2).
struct Coefficients {
  double cosine, c1, c2, g1, g2;
};

Coefficients coefficients(double theta2, double s) {
  const double a2 = theta2 * s * s;
  const double s2 = s * s;
  if (a2 < kSeriesAngle * kSeriesAngle) {
    return {1.0 - a2 / 2.0 * (1.0 - a2 / 12.0 * (1.0 - a2 / 30.0)),
            s * (1.0 - a2 / 6.0 * (1.0 - a2 / 20.0 * (1.0 - a2 / 42.0))),
            s2 * (0.5 - a2 / 24.0 * (1.0 - a2 / 30.0 * (1.0 - a2 / 56.0))),
            s2 * s * (-1.0 / 3.0 + a2 / 30.0 * (1.0 - a2 / 28.0)),
            s2 * s2 * (-1.0 / 12.0 + a2 / 180.0 * (1.0 - 3.0 * a2 / 112.0))};
  }
  const double theta = std::sqrt(theta2);
  const double cosine = std::cos(theta * s);
  const double c1 = std::sin(theta * s) / theta;
  const double c2 = (1.0 - cosine) / theta2;
  return {cosine, c1, c2, (s * cosine - c1) / theta2, (s * c1 - 2.0 * c2) / theta2};
}

}  // namespace

CurvePoint curve_at(const Vector2d& kap, double s) noexcept {
  const auto [cosine, c1, c2, g1, g2] = coefficients(kap.squaredNorm(), s);
  const double k1 = kap.x();
  const double k2 = kap.y();
  CurvePoint point;
  point.q << c1, c2 * k2, -c2 * k1;
  point.t << cosine, c1 * k2, -c1 * k1;
  point.D << g1 * k1, g1 * k2,            //
      g2 * k1 * k2, g2 * k2 * k2 + c2,    //
      -g2 * k1 * k1 - c2, -g2 * k1 * k2;  //
  return point;
}

Matrix9d curve_transport(const Vector2d& kap, double ds) noexcept {
  using Matrix36d = Eigen::Matrix<double, 3, 6>;
  const Vector3d kl = local_curvature(kap);
  const CurvePoint point = curve_at(kap, ds);
  const Matrix3d E = exp_so3(ds * kl);
  const Matrix3d J = ds * left_jacobian_so3(ds * kl);

  Matrix36d A = Matrix36d::Zero();  // displacement of the new anchor over (a, w, dkap)
  A(1, 0) = A(2, 1) = 1.0;
  A.middleCols<2>(2) = -hat(point.q).rightCols<2>();
  A.rightCols<2>() = point.D;
  A = E.transpose() * A.eval();

  Matrix36d W = Matrix36d::Zero();  // turn of the new frame; J_l(-w) = J_l(w)ᵀ
  W.middleCols<2>(2) = E.transpose().rightCols<2>();
  W.rightCols<2>() = J.transpose().rightCols<2>();
  W -= kl * A.row(0);

  Matrix36d Q = Matrix36d::Zero();  // turn of the grasp beside φ itself
  Q.middleCols<2>(2) = -(J * hat(kl)).rightCols<2>();
  Q.rightCols<2>() = J.rightCols<2>();
  Q = E.transpose() * Q.eval();
  Q -= kl * A.row(0);

  Matrix9d T = Matrix9d::Identity();
  T.block<2, 6>(0, 0) = A.bottomRows<2>();
  T.block<2, 6>(2, 0) = W.bottomRows<2>();
  T.block<1, 6>(4, 0) += -kap.y() * W.row(0);
  T.block<1, 6>(5, 0) += kap.x() * W.row(0);
  T.block<3, 6>(6, 0) = Q;
  return T;
}

}  // namespace ajar
