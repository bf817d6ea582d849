// Strategy: for a strictly convex QP the Karush-Kuhn-Tucker conditions are sufficient, so random problems are judged by
// their residuals (stationarity, primal, dual, complementarity); those with moderate weights also against eiquadprog, a dual
// method that shares no code. Sequences of problems check that the guess from the last call changes speed alone. Left out:
// problems without a feasible point, which the controllers never build (the start proves it).
#include "ajar/wbc/task_qp.hpp"

#include <gtest/gtest.h>

#include <eiquadprog/eiquadprog-rt.hpp>
#include <limits>
#include <random>

namespace ajar {
namespace {

constexpr int kSlack = kQpVariables - 1;

class Draw {
 public:
  explicit Draw(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }

 private:
  std::mt19937 generator_;
};

// Six or seven task rows, some variables fixed, a slack that makes zero motion feasible in every row.
QpProblem random_problem(Draw& draw, int rows, double task_weight) {
  QpProblem p;
  p.tasks = draw.integer(6, 7);
  for (int j = 0; j < p.tasks; ++j) {
    p.task_weight[j] = task_weight;
    p.b[j] = draw.uniform(-1.0, 1.0);
    for (int i = 0; i < kSlack; ++i) p.A(j, i) = draw.uniform(-1.0, 1.0);
  }
  p.task_weight[6] = 0.2;
  for (int i = 0; i < kSlack; ++i) {
    p.weight[i] = draw.uniform(0.01, 20.0);
    p.wanted[i] = draw.uniform(-1.0, 1.0);
    p.lower[i] = -draw.uniform(0.0, 1.0);
    p.upper[i] = draw.uniform(0.0, 1.0);
    if (draw.uniform(0.0, 1.0) < 0.15) p.lower[i] = p.upper[i] = p.start[i] = draw.uniform(-0.05, 0.05);
  }
  p.weight[kSlack] = 1e2 * task_weight;
  p.upper[kSlack] = std::numeric_limits<double>::max();
  p.rows = rows;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < kSlack; ++i) p.C(j, i) = draw.uniform(-1.0, 1.0);
    p.C(j, kSlack) = 1.0;
    p.c[j] = draw.uniform(-0.3, 0.02);
    p.start[kSlack] = std::max(p.start[kSlack], p.c[j] - p.C.row(j).head(kSlack).dot(p.start.head(kSlack)));
  }
  return p;
}

double cost(const QpProblem& p, const QpVector& x) {
  const auto tasks = (p.A * x - p.b).head(p.tasks);
  return 0.5 * p.weight.dot((x - p.wanted).cwiseAbs2()) +
         0.5 * p.task_weight.head(p.tasks).dot(Eigen::VectorXd(tasks.cwiseAbs2()));
}

void expect_minimum(const QpProblem& p, const QpSolution& s) {
  QpTaskVector pull = p.task_weight.cwiseProduct(p.A * s.x - p.b);
  pull.tail(kQpTasks - p.tasks).setZero();
  const QpVector stationarity = p.weight.cwiseProduct(s.x - p.wanted) + p.A.transpose() * pull - s.lower_multiplier +
                                s.upper_multiplier - p.C.transpose() * s.row_multiplier;
  const double scale = 1.0 + pull.norm() + s.row_multiplier.norm();  // what is added up there
  // A residual of round-off, some 1e-14 of the terms of A x, weighs w.
  EXPECT_LT(stationarity.cwiseAbs().maxCoeff(), 1e-7 * scale + 1e-13 * p.task_weight.maxCoeff());
  EXPECT_GE((s.x - p.lower).minCoeff(), 0.0);
  EXPECT_GE((p.upper - s.x).minCoeff(), 0.0);
  EXPECT_GE(std::min({s.lower_multiplier.minCoeff(), s.upper_multiplier.minCoeff(), s.row_multiplier.minCoeff()}), 0.0);
  const QpRowVector reserve = p.C * s.x - p.c;
  for (int j = 0; j < p.rows; ++j) {
    EXPECT_GE(reserve[j], -1e-7);  // the slack's weight of 1e10 leaves six digits
    EXPECT_LT(std::abs(s.row_multiplier[j] * reserve[j]), 1e-7 * scale);
  }
  for (int i = 0; i < kSlack; ++i) {
    EXPECT_LT(std::abs(s.lower_multiplier[i] * (s.x[i] - p.lower[i])), 1e-8 * scale);
    EXPECT_LT(std::abs(s.upper_multiplier[i] * (p.upper[i] - s.x[i])), 1e-8 * scale);
  }
}

TEST(TaskQp, MeetsOptimalityConditionsOnRandomProblems) {
  Draw draw(1);
  TaskQp solver;
  QpSolution solution;
  int most = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    const double weight = trial % 2 == 0 ? 1e8 : 1e2;
    const QpProblem problem = random_problem(draw, draw.integer(0, kQpRows), weight);
    ASSERT_EQ(solver.solve(problem, solution), QpStatus::Solved) << trial;
    expect_minimum(problem, solution);
    most = std::max(most, solution.iterations);
  }
  EXPECT_LE(most, 100) << "the bound of 200 must stay far";
}

TEST(TaskQp, AgreesWithADualMethod) {
  constexpr int kLimits = 2 * kQpVariables + kQpRows;
  using Referee = eiquadprog::solvers::RtEiquadprog<kQpVariables, 0, kLimits>;
  Draw draw(2);
  TaskQp solver;
  Referee referee;
  QpSolution solution;
  for (int trial = 0; trial < 500; ++trial) {
    QpProblem p = random_problem(draw, draw.integer(0, kQpRows), 1e2);
    for (int i = 0; i < kSlack; ++i) {  // the referee cannot fix variables
      if (p.upper[i] - p.lower[i] < 1e-3) p.upper[i] += 0.01;
    }
    p.upper[kSlack] = 10.0;
    ASSERT_EQ(solver.solve(p, solution), QpStatus::Solved);
    RtMatrixX<kQpVariables, kQpVariables>::d H = p.weight.asDiagonal();
    RtVectorX<kQpVariables>::d g = -p.weight.cwiseProduct(p.wanted);
    for (int j = 0; j < p.tasks; ++j) {
      H += p.task_weight[j] * p.A.row(j).transpose() * p.A.row(j);
      g -= p.task_weight[j] * p.b[j] * p.A.row(j).transpose();
    }
    RtMatrixX<kLimits, kQpVariables>::d G = RtMatrixX<kLimits, kQpVariables>::d::Zero();
    RtVectorX<kLimits>::d h = RtVectorX<kLimits>::d::Ones();
    G.topRows<kQpVariables>().setIdentity();
    G.middleRows<kQpVariables>(kQpVariables) = -G.topRows<kQpVariables>();
    h.head<2 * kQpVariables>() << -p.lower, p.upper;
    G.middleRows(2 * kQpVariables, p.rows) = p.C.topRows(p.rows);
    h.segment(2 * kQpVariables, p.rows) = -p.c.head(p.rows);
    RtVectorX<kQpVariables>::d x;
    ASSERT_EQ(referee.solve_quadprog(H, g, RtMatrixX<0, kQpVariables>::d(), RtVectorX<0>::d(), G, h, x),
              eiquadprog::solvers::RT_EIQUADPROG_OPTIMAL);
    EXPECT_LT((x - solution.x).cwiseAbs().maxCoeff(), 1e-6) << trial;
    EXPECT_LE(cost(p, solution.x), cost(p, x) + 1e-6 * cost(p, x));
  }
}

TEST(TaskQp, GivesTheSameAnswerWhateverItSolvedBefore) {
  Draw draw(3);
  TaskQp warm;
  TaskQp cold;
  QpSolution a;
  QpSolution b;
  long warm_steps = 0;
  long cold_steps = 0;
  for (int sequence = 0; sequence < 100; ++sequence) {
    QpProblem problem = random_problem(draw, 8, 1e8);
    for (int tick = 0; tick < 20; ++tick) {
      for (int j = 0; j < 6; ++j) problem.b[j] += draw.uniform(-0.01, 0.01);
      ASSERT_EQ(warm.solve(problem, a), QpStatus::Solved);
      cold.forget();
      ASSERT_EQ(cold.solve(problem, b), QpStatus::Solved);
      ASSERT_LT((a.x - b.x).cwiseAbs().maxCoeff(), 1e-6);
      warm_steps += a.iterations;
      cold_steps += b.iterations;
    }
  }
  EXPECT_LT(2 * warm_steps, cold_steps);
}

TEST(TaskQp, MeetsFeasibleTasksToRoundOffWhateverTheRestWants) {
  Draw draw(4);
  TaskQp solver;
  QpSolution solution;
  for (int trial = 0; trial < 1000; ++trial) {
    QpProblem p = random_problem(draw, 0, 1e8);
    p.tasks = 6;
    QpVector inside = QpVector::Zero();
    for (int i = 0; i < kSlack; ++i) inside[i] = 0.5 * (p.lower[i] + p.upper[i]);
    p.b.head<6>() = (p.A * inside).head<6>();
    ASSERT_EQ(solver.solve(p, solution), QpStatus::Solved);
    // Residual = pull of the rest over the weight; that pull is below 20 · 2 per variable over the rows' least size.
    EXPECT_LT((p.A * solution.x - p.b).head<6>().norm(), 1e-4) << trial;
  }
}

TEST(TaskQp, HoldsFixedVariablesAndDependentRows) {
  Draw draw(5);
  TaskQp solver;
  QpSolution solution;
  QpProblem p = random_problem(draw, 6, 1e8);
  p.lower[2] = p.upper[2] = p.start[2] = 0.0125;
  for (int j = 0; j < 6; ++j) {  // the same row six times, and rows that nothing can change
    p.C.row(j) = p.C.row(0);
    p.c[j] = p.c[0];
  }
  p.start[kSlack] = 10.0;
  ASSERT_EQ(solver.solve(p, solution), QpStatus::Solved);
  EXPECT_DOUBLE_EQ(solution.x[2], 0.0125);
  expect_minimum(p, solution);
}

TEST(TaskQp, RefusesWhatIsNotFiniteOrBreaksALimitAtTheStart) {
  Draw draw(6);
  TaskQp solver;
  QpSolution solution;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int what = 0; what < 8; ++what) {
      QpProblem p = random_problem(draw, 4, 1e8);
      (what == 0   ? p.weight[1]
       : what == 1 ? p.wanted[3]
       : what == 2 ? p.lower[0]
       : what == 3 ? p.C(0, 0)
       : what == 4 ? p.A(2, 3)
       : what == 5 ? p.b[1]
       : what == 6 ? p.start[4]
                   : p.c[1]) = bad;
      EXPECT_EQ(solver.solve(p, solution), QpStatus::Invalid) << what;
      EXPECT_TRUE(solution.x.allFinite());
    }
  }
  QpProblem p = random_problem(draw, 0, 1e8);
  p.start[0] = p.upper[0] + 0.1;
  EXPECT_EQ(solver.solve(p, solution), QpStatus::Invalid);
}

}  // namespace
}  // namespace ajar
