// Strategy: the local curve must satisfy its own differential equation, and every derivative must equal central differences
// of the finite (nonlinear) operation that it stands for, on straight, nearly straight and strongly curved paths.
#include "ajar/estimation/curve.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "ajar/core/random.hpp"
#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;

const Vector2d kCurvatures[] = {{0.0, 0.0}, {1e-8, -2e-8}, {0.3, -0.2}, {1.2, 0.9}, {-4.0, 3.0}};
const double kArcs[] = {-0.7, -0.05, 1e-4, 0.002, 0.0199, 0.0201, 0.3, 0.8};

TEST(Curve, TangentTurnsByTheCurvature) {
  for (const Vector2d& kap : kCurvatures) {
    for (const double s : kArcs) {
      const CurvePoint point = curve_at(kap, s);
      const Vector3d turned = exp_so3(s * local_curvature(kap)) * Vector3d::UnitX();
      EXPECT_LT((point.t - turned).norm(), 1e-12);
      const double h = 1e-5;
      const Vector3d velocity = (curve_at(kap, s + h).q - curve_at(kap, s - h).q) / (2.0 * h);
      EXPECT_LT((velocity - point.t).norm(), 1e-9);
    }
  }
}

TEST(Curve, SeriesJoinsTheClosedForm) {
  // θ s just below and just above the switch at 0.1 must agree but for the change of s itself.
  const Vector2d kap(0.6, 0.8);
  const CurvePoint below = curve_at(kap, 0.1 * (1.0 - 1e-12));
  const CurvePoint above = curve_at(kap, 0.1 * (1.0 + 1e-12));
  EXPECT_LT((below.q - above.q).norm(), 1e-12);
  EXPECT_LT((below.D - above.D).norm(), 1e-11);
}

TEST(Curve, DerivativeByCurvatureEqualsDifferences) {
  for (const Vector2d& kap : kCurvatures) {
    for (const double s : kArcs) {
      const Matrix32d D = curve_at(kap, s).D;
      for (int j = 0; j < 2; ++j) {
        const Vector2d h = 1e-4 * Vector2d::Unit(j);
        const Vector3d difference = (curve_at(kap + h, s).q - curve_at(kap - h, s).q) / 2e-4;
        EXPECT_LT((difference - D.col(j)).norm(), 1e-8) << "kap " << kap.transpose() << " s " << s;
      }
    }
  }
}

// The nonlinear operation behind curve_transport: disturb the path at its anchor, walk it to the plane across the new
// nominal tangent, and read the nine errors there.
Vector9d walked_errors(const Vector2d& kap0, double ds, const Vector9d& d) {
  const Matrix3d F1 = exp_so3(ds * local_curvature(kap0));
  const Vector3d p1 = curve_at(kap0, ds).q;
  const Matrix3d R1 = F1;  // grasp rotation starts at the identity
  const Vector2d kap = kap0 + d.segment<2>(4);
  const Matrix3d F = exp_so3(Vector3d(0.0, d[2], d[3]));
  const Vector3d k = F * local_curvature(kap);
  double s = ds;
  Vector3d p;
  for (int i = 0; i < 6; ++i) {
    const CurvePoint point = curve_at(kap, s);
    p = Vector3d(0.0, d[0], d[1]) + F * point.q;
    s -= F1.col(0).dot(p - p1) / F1.col(0).dot(F * point.t);
  }
  p = Vector3d(0.0, d[0], d[1]) + F * curve_at(kap, s).q;
  const Matrix3d Fs = F * exp_so3(s * local_curvature(kap));
  const Matrix3d Rs = exp_so3(s * k) * exp_so3(d.tail<3>());
  const Vector3d w = log_so3(F1.transpose() * Fs);
  const Matrix3d unrolled = Fs * exp_so3(Vector3d(-w.x(), 0.0, 0.0));
  Vector9d out;
  out.head<2>() = (F1.transpose() * (p - p1)).tail<2>();
  out.segment<2>(2) = log_so3(F1.transpose() * unrolled).tail<2>();
  out.segment<2>(4) = (unrolled.transpose() * k).tail<2>() - kap0;
  out.tail<3>() = F1.transpose() * log_so3(Rs * R1.transpose());
  return out;
}

TEST(CurveTransport, EqualsDifferencesOfTheWalkedPath) {
  for (const Vector2d& kap : kCurvatures) {
    for (const double ds : {-0.2, -0.002, 0.002, 0.05, 0.4}) {
      const Matrix9d T = curve_transport(kap, ds);
      for (int j = 0; j < 9; ++j) {
        const double h = 1e-5;
        const Vector9d difference =
            (walked_errors(kap, ds, h * Vector9d::Unit(j)) - walked_errors(kap, ds, -h * Vector9d::Unit(j))) / (2.0 * h);
        EXPECT_LT((difference - T.col(j)).norm(), 1e-8 * std::max(1.0, T.col(j).norm()))
            << "kap " << kap.transpose() << " ds " << ds << " column " << j;
      }
    }
  }
}

TEST(CurveTransport, TwoWalksMakeOne) {
  const Vector2d kap(1.2, -0.7);
  const Matrix9d once = curve_transport(kap, 0.3);
  const Matrix9d twice = curve_transport(kap, 0.2) * curve_transport(kap, 0.1);
  EXPECT_LT((once - twice).norm(), 1e-12);
}

}  // namespace
}  // namespace ajar
