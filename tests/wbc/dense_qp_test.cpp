// Strategy: for a strictly convex QP the Karush-Kuhn-Tucker conditions are sufficient, so random problems are judged by
// their residuals (stationarity, primal, dual, complementarity) alone; box problems also against projected gradient,
// which shares no code. Left out: infeasible problems, which the controllers never build.
#include "ajar/wbc/dense_qp.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace ajar {
namespace {

class Draw {
 public:
  explicit Draw(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }

 private:
  std::mt19937 generator_;
};

// Task-like Hessian (rank 6, heavy) plus a light diagonal, some variables fixed, rows that the origin satisfies.
QpProblem random_problem(Draw& draw, int rows) {
  QpProblem problem;
  Eigen::Matrix<double, 6, kQpVariables> A;
  for (double& a : A.reshaped()) {
    a = draw.uniform(-1.0, 1.0);
  }
  problem.H = 1e4 * A.transpose() * A;
  for (int i = 0; i < kQpVariables; ++i) {
    problem.H(i, i) += draw.uniform(0.01, 20.0);
    problem.g[i] = draw.uniform(-1e3, 1e3);
    problem.lower[i] = -draw.uniform(0.0, 1.0);
    problem.upper[i] = draw.uniform(0.0, 1.0);
    if (draw.uniform(0.0, 1.0) < 0.15) {
      problem.lower[i] = problem.upper[i] = draw.uniform(-0.05, 0.05);
    }
  }
  problem.upper[kQpVariables - 1] = std::numeric_limits<double>::max();
  problem.lower[kQpVariables - 1] = 0.0;
  problem.rows = rows;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < kQpVariables; ++j) {
      problem.C(i, j) = draw.uniform(-1.0, 1.0);
    }
    problem.C(i, kQpVariables - 1) = 1e-3;  // the slack
    problem.c[i] = draw.uniform(-0.3, 0.02);
  }
  return problem;
}

TEST(DenseQp, MeetsOptimalityConditionsOnRandomProblems) {
  Draw draw(1);
  DenseQp solver;
  QpSolution solution;
  for (int trial = 0; trial < 4000; ++trial) {
    const QpProblem problem = random_problem(draw, draw.integer(0, kQpRows));
    ASSERT_EQ(solver.solve(problem, solution), QpStatus::Solved) << trial;
    const QpRowVector reserve = problem.C * solution.x - problem.c;
    const QpVector stationarity = problem.H * solution.x + problem.g - solution.lower_multiplier +
                                  solution.upper_multiplier - problem.C.transpose() * solution.row_multiplier;
    // Terms of the sum are of order 1e3 … 1e4, their round-off 1e-9 … 1e-8 after some twenty steps.
    const double scale = 1.0 + problem.g.norm() + solution.row_multiplier.norm();
    EXPECT_LT(stationarity.cwiseAbs().maxCoeff(), 1e-8 * scale);
    EXPECT_GE((solution.x - problem.lower).minCoeff(), -1e-6);
    EXPECT_GE((problem.upper - solution.x).minCoeff(), -1e-6);
    EXPECT_GE(solution.lower_multiplier.minCoeff(), 0.0);
    EXPECT_GE(solution.upper_multiplier.minCoeff(), 0.0);
    EXPECT_GE(solution.row_multiplier.minCoeff(), 0.0);
    for (int i = 0; i < problem.rows; ++i) {
      EXPECT_GE(reserve[i], -1e-6);
      EXPECT_LT(std::abs(solution.row_multiplier[i] * reserve[i]), 1e-6 * scale);
    }
    for (int i = 0; i + 1 < kQpVariables; ++i) {
      EXPECT_LT(std::abs(solution.lower_multiplier[i] * (solution.x[i] - problem.lower[i])), 1e-6 * scale);
      EXPECT_LT(std::abs(solution.upper_multiplier[i] * (problem.upper[i] - solution.x[i])), 1e-6 * scale);
    }
  }
}

TEST(DenseQp, AgreesWithProjectedGradientInABox) {
  Draw draw(2);
  DenseQp solver;
  QpSolution solution;
  for (int trial = 0; trial < 50; ++trial) {
    QpProblem problem;
    Eigen::Matrix<double, kQpVariables, kQpVariables> A;
    for (double& a : A.reshaped()) {
      a = draw.uniform(-1.0, 1.0);
    }
    problem.H = A.transpose() * A + Eigen::Matrix<double, kQpVariables, kQpVariables>::Identity();
    for (int i = 0; i < kQpVariables; ++i) {
      problem.g[i] = draw.uniform(-5.0, 5.0);
    }
    problem.lower.setConstant(-0.5);
    problem.upper.setConstant(0.5);
    ASSERT_EQ(solver.solve(problem, solution), QpStatus::Solved);
    const double step = 1.0 / problem.H.trace();  // below 1 / largest eigenvalue
    QpVector x = QpVector::Zero();
    for (int i = 0; i < 3000; ++i) {
      x = (x - step * (problem.H * x + problem.g)).cwiseMax(problem.lower).cwiseMin(problem.upper).eval();
    }
    EXPECT_LT((x - solution.x).norm(), 1e-6);
  }
}

TEST(DenseQp, HoldsFixedVariablesExactly) {
  Draw draw(3);
  DenseQp solver;
  QpSolution solution;
  QpProblem problem = random_problem(draw, 4);
  problem.lower[2] = problem.upper[2] = 0.0125;
  ASSERT_EQ(solver.solve(problem, solution), QpStatus::Solved);
  EXPECT_DOUBLE_EQ(solution.x[2], 0.0125);
}

TEST(DenseQp, RefusesWhatIsNotFinite) {
  Draw draw(4);
  DenseQp solver;
  QpSolution solution;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int what = 0; what < 5; ++what) {
    QpProblem problem = random_problem(draw, 4);
    (what == 0   ? problem.H(1, 1)
     : what == 1 ? problem.g[3]
     : what == 2 ? problem.lower[0]
     : what == 3 ? problem.C(0, 0)
                 : problem.c[1]) = nan;
    EXPECT_EQ(solver.solve(problem, solution), QpStatus::Failed) << what;
    EXPECT_TRUE(solution.x.allFinite());
  }
}

}  // namespace
}  // namespace ajar
