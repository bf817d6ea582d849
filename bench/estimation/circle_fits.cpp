#include "circle_fits.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "ajar/core/so3.hpp"

namespace ajar::bench {
namespace {

constexpr double kBicNoise = 5e-3;  // default of the authors' published programs [m]
constexpr double kSlideParameters = 6.0;
constexpr double kHingeParameters = 9.0;

struct Principal {
  Vector3d mean = Vector3d::Zero();
  Matrix3d axes = Matrix3d::Identity();  // columns by falling variance
  Vector3d variances = Vector3d::Zero();
};

Principal principal(std::span<const Vector3d> points) {
  Principal p;
  for (const Vector3d& x : points) p.mean += x / static_cast<double>(points.size());
  Matrix3d C = Matrix3d::Zero();
  for (const Vector3d& x : points) C += (x - p.mean) * (x - p.mean).transpose() / static_cast<double>(points.size());
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(C);
  p.axes = solver.eigenvectors().rowwise().reverse();
  if (p.axes.determinant() < 0.0) p.axes.col(2) *= -1.0;
  p.variances = solver.eigenvalues().reverse().cwiseMax(0.0);
  return p;
}

PointFit line_of(std::span<const Vector3d> points) {
  const Principal p = principal(points);
  PointFit fit;
  fit.direction = p.axes.col(0);
  if (fit.direction.dot(points.back() - points.front()) < 0.0) fit.direction = -fit.direction;
  fit.point = p.mean + fit.direction * fit.direction.dot(points.back() - p.mean);
  fit.type = MechanismType::Slide;
  return fit;
}

// A circle by centre, unit normal and radius, seen from the last point; the sense follows the order of the points.
PointFit circle_at_last(const Vector3d& centre, const Vector3d& normal, double radius, std::span<const Vector3d> points) {
  PointFit fit;
  const auto outward = [&](const Vector3d& x) {
    const Vector3d v = x - centre;
    return Vector3d((v - normal * normal.dot(v)).normalized());
  };
  double turned = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector3d a = outward(points[i - 1]), b = outward(points[i]);
    turned += std::atan2(normal.dot(a.cross(b)), a.dot(b));
  }
  const Vector3d axis = turned < 0.0 ? Vector3d(-normal) : normal;
  const Vector3d last = outward(points.back());
  fit.direction = axis.cross(last);
  fit.curvature = axis / radius;
  fit.point = centre + radius * last;
  fit.type = MechanismType::Hinge;
  return fit;
}

struct Circle {
  Vector3d centre, normal;
  double radius;
};

Circle taubin(std::span<const Vector3d> points) {
  const Principal p = principal(points);
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::VectorXd x(n), y(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3d local = p.axes.transpose() * (points[static_cast<std::size_t>(i)] - p.mean);
    x[i] = local.x();
    y[i] = local.y();
  }
  // Smallest singular vector of the centred squares over 2√(mean square), beside the coordinates.
  const Eigen::VectorXd z = x.cwiseAbs2() + y.cwiseAbs2();
  const double mean = z.mean();
  Eigen::MatrixXd M(n, 3);
  M << (z.array() - mean) / (2.0 * std::sqrt(mean)), x, y;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(M, Eigen::ComputeThinV);
  Vector3d v = svd.matrixV().col(2);
  v[0] /= 2.0 * std::sqrt(mean);
  if (std::abs(v[0]) < 1e-12) v[0] = 1e-12;  // a line: a circle of unbounded radius
  const double D = -mean * v[0];
  const Vector2d centre = -v.tail<2>() / (2.0 * v[0]);
  const double radius = std::sqrt(std::max(v.tail<2>().squaredNorm() - 4.0 * v[0] * D, 0.0)) / (2.0 * std::abs(v[0]));
  return {p.mean + p.axes.leftCols<2>() * centre, p.axes.col(2), radius};
}

// Distances to a circle: radial and out of its plane.
Vector2d residual(const Circle& c, const Vector3d& x) {
  const Vector3d v = x - c.centre;
  const double height = c.normal.dot(v);
  return {(v - height * c.normal).norm() - c.radius, height};
}

// Unknowns: shift of the centre along the outward middle direction by log of the radius (keeps far circles regular), turn of
// the plane about two axes through the middle of the points, shift of the middle point in and across the plane.
Circle changed(const Circle& c, const Vector3d& middle, const Eigen::Matrix<double, 5, 1>& d) {
  const Vector3d out = (middle - c.centre).normalized();
  const Vector3d along = c.normal.cross(out);
  const Matrix3d R = exp_so3(d[0] * out + d[1] * along);
  const double curvature = 1.0 / c.radius + d[2];
  const double radius = 1.0 / std::copysign(std::max(std::abs(curvature), 1e-9), curvature);
  const Vector3d top = c.centre + c.radius * out + d[3] * out + d[4] * c.normal;
  return {top - radius * (R * out), R * c.normal, radius};
}

}  // namespace

PointFit fit_circle_algebraic(std::span<const Vector3d> points) {
  const Circle c = taubin(points);
  return circle_at_last(c.centre, c.normal, c.radius, points);
}

PointFit fit_circle_geometric(std::span<const Vector3d> points, double huber) {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  Circle c = taubin(points);
  const Vector3d middle = points[points.size() / 2];
  const auto cost_of = [&](const Circle& circle) {
    double sum = 0.0;
    for (const Vector3d& x : points) {
      const double r = residual(circle, x).norm();
      sum += r < huber ? r * r : 2.0 * huber * r - huber * huber;
    }
    return sum;
  };
  double cost = cost_of(c);
  double damping = 1e-6;
  for (int iteration = 0; iteration < 100 && damping < 1e6; ++iteration) {
    Matrix5 H = Matrix5::Zero();
    Vector5 g = Vector5::Zero();
    std::array<Circle, 10> sides;
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < 2; ++j) {
        sides[static_cast<std::size_t>(2 * i + j)] = changed(c, middle, (j == 0 ? -kStep : kStep) * Vector5::Unit(i));
      }
    }
    for (const Vector3d& x : points) {
      const Vector2d r = residual(c, x);
      const double weight = r.norm() < huber ? 1.0 : huber / r.norm();
      Eigen::Matrix<double, 2, 5> J;
      for (int i = 0; i < 5; ++i) {
        J.col(i) =
            (residual(sides[static_cast<std::size_t>(2 * i + 1)], x) - residual(sides[static_cast<std::size_t>(2 * i)], x)) /
            (2.0 * kStep);
      }
      H += weight * J.transpose() * J;
      g -= weight * J.transpose() * r;
    }
    Matrix5 damped = H;
    damped.diagonal() *= 1.0 + damping;
    const Vector5 d = damped.ldlt().solve(g);
    const Circle next = changed(c, middle, d);
    const double next_cost = cost_of(next);
    if (std::isfinite(next_cost) && next_cost <= cost) {
      const bool done = cost - next_cost < 1e-12 * cost;
      c = next;
      cost = next_cost;
      damping *= 0.1;
      if (done) break;
    } else {
      damping *= 10.0;
    }
  }
  return circle_at_last(c.centre, c.normal, std::abs(c.radius), points);
}

double line_rms(std::span<const Vector3d> points) {
  const Principal p = principal(points);
  return std::sqrt(0.5 * (p.variances[1] + p.variances[2]));
}

PointFit fit_by_bic(std::span<const Vector3d> points) {
  const double n = static_cast<double>(points.size());
  const PointFit line = line_of(points);
  const PointFit circle = fit_circle_geometric(points);
  const double kappa = circle.curvature.norm();
  const Vector3d axis = circle.curvature / kappa;
  const Vector3d centre = circle.point + circle.curvature.cross(circle.direction) / (kappa * kappa);
  double squares = 0.0;
  for (const Vector3d& x : points) squares += residual({centre, axis, 1.0 / kappa}, x).squaredNorm();
  const double line_squares = 2.0 * n * line_rms(points) * line_rms(points);
  const double bic_line = line_squares / (kBicNoise * kBicNoise) + kSlideParameters * std::log(n);
  const double bic_circle = squares / (kBicNoise * kBicNoise) + kHingeParameters * std::log(n);
  return bic_circle < bic_line ? circle : line;
}

}  // namespace ajar::bench
