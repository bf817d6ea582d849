#include "ajar/planning/joint_path.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/random.hpp"

namespace ajar {
namespace {

double span(const JointVector& a, const JointVector& b) { return (a - b).cwiseAbs().maxCoeff(); }

// Answers whether postures and straight joint segments keep the clearance.
class SegmentCheck {
 public:
  SegmentCheck(const RobotModel& model, ClearanceChecker& checker, const BasePose& base, const JointPathConfig& config)
      : model_(model), checker_(checker), base_(base), config_(config), margin_(config.clearance) {}

  double distance(const JointVector& q) {
    model_.compute(base_, q, kinematics_);
    checker_.compute(model_, base_, result_);
    return std::min(result_.smallest[0], result_.smallest[1]);
  }
  // Start and goal may stand closer than the wanted clearance; then the path may be as close as they are.
  void relax_to(double distance) { margin_ = std::min(margin_, distance - 1e-3); }
  bool free(const JointVector& q) {
    const RobotLimits& limits = model_.limits();
    if (((q - limits.position_lower).array() < 0.0).any() || ((limits.position_upper - q).array() < 0.0).any()) return false;
    return distance(q) >= margin_;
  }
  bool free(const JointVector& a, const JointVector& b) {
    const int pieces = std::max(1, static_cast<int>(std::ceil(span(a, b) / (0.5 * config_.step))));
    for (int i = 1; i <= pieces; ++i) {
      if (!free(JointVector(a + (b - a) * (static_cast<double>(i) / pieces)))) return false;
    }
    return true;
  }

 private:
  const RobotModel& model_;
  ClearanceChecker& checker_;
  BasePose base_;
  JointPathConfig config_;
  double margin_;
  Kinematics kinematics_;
  ClearanceResult result_;
};

struct Tree {
  std::vector<JointVector> nodes;
  std::vector<int> parents;

  int nearest(const JointVector& q) const {
    int best = 0;
    for (int i = 1; i < static_cast<int>(nodes.size()); ++i) {
      if (span(nodes[static_cast<std::size_t>(i)], q) < span(nodes[static_cast<std::size_t>(best)], q)) best = i;
    }
    return best;
  }
  // Grows towards q as far as is free; returns the last node.
  int grow(SegmentCheck& check, const JointVector& q, double step) {
    int at = nearest(q);
    for (int guard = 0; guard < 64; ++guard) {
      const JointVector& here = nodes[static_cast<std::size_t>(at)];
      const double length = span(here, q);
      if (length < 1e-9) break;
      const JointVector next = here + (q - here) * std::min(1.0, step / length);
      if (!check.free(here, next)) break;
      nodes.push_back(next);
      parents.push_back(at);
      at = static_cast<int>(nodes.size()) - 1;
      if (length <= step) break;
    }
    return at;
  }
  std::vector<JointVector> branch(int node) const {
    std::vector<JointVector> path;
    for (int i = node; i >= 0; i = parents[static_cast<std::size_t>(i)]) path.push_back(nodes[static_cast<std::size_t>(i)]);
    return path;
  }
};

void shorten(std::vector<JointVector>& path, SegmentCheck& check, Random& random, int attempts) {
  for (int i = 0; i < attempts && path.size() > 2; ++i) {
    const int a = random.index(static_cast<int>(path.size()) - 2);
    const int b = a + 2 + random.index(static_cast<int>(path.size()) - a - 2);
    if (check.free(path[static_cast<std::size_t>(a)], path[static_cast<std::size_t>(b)])) {
      path.erase(path.begin() + a + 1, path.begin() + b);
    }
  }
}

}  // namespace

std::vector<JointVector> plan_joint_path(const RobotModel& model, ClearanceChecker& checker, const BasePose& base,
                                         const JointVector& from, const JointVector& to, std::uint64_t seed,
                                         const JointPathConfig& config) {
  SegmentCheck check(model, checker, base, config);
  check.relax_to(check.distance(from));
  check.relax_to(check.distance(to));
  if (check.free(from, to)) return {from, to};

  Random random(seed);
  Tree start{{from}, {-1}};
  Tree goal{{to}, {-1}};
  Tree* growing = &start;
  Tree* other = &goal;
  const RobotLimits& limits = model.limits();
  while (static_cast<int>(start.nodes.size() + goal.nodes.size()) < config.max_nodes) {
    JointVector sample(from.size());
    for (Eigen::Index i = 0; i < sample.size(); ++i) {
      // Half a turn round start and goal is where useful detours are.
      const double low = std::max(limits.position_lower[i], std::min(from[i], to[i]) - 1.6);
      const double high = std::min(limits.position_upper[i], std::max(from[i], to[i]) + 1.6);
      sample[i] = random.uniform(low, high);
    }
    const int reached = growing->grow(check, sample, 4.0 * config.step);
    const JointVector meeting = growing->nodes[static_cast<std::size_t>(reached)];
    const int met = other->grow(check, meeting, 4.0 * config.step);
    if (span(other->nodes[static_cast<std::size_t>(met)], meeting) < 1e-6) {
      std::vector<JointVector> path = growing->branch(reached);
      std::reverse(path.begin(), path.end());
      const std::vector<JointVector> rest = other->branch(met);
      path.insert(path.end(), rest.begin() + 1, rest.end());
      if (growing == &goal) std::reverse(path.begin(), path.end());
      shorten(path, check, random, config.shortcuts);
      return path;
    }
    // A failed connection still costs a node, so that the loop is bounded.
    growing->nodes.push_back(growing->nodes.front());
    growing->parents.push_back(-1);
    std::swap(growing, other);
  }
  return {};
}

}  // namespace ajar
