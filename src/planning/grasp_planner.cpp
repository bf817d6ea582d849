#include "ajar/planning/grasp_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/planning/passage.hpp"
#include "posture_finder.hpp"

namespace ajar {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHopeless = -1e9;
// Arm to believed wall at the grasp: the rows' stop distance.
constexpr double kArmWall = 0.03;
// A posture re-solved at the pose reached stays if it has this; else all postures are tried (law 2).
constexpr double kKeepSigma = 0.09;
constexpr double kKeepOwn = 0.045;
constexpr double kKeepWall = 0.03;
// Farther than this from its planned place the arm posture is another one: nothing can be "kept" [m], [rad].
constexpr double kKeepDistance = 0.3;
constexpr double kKeepTurn = 0.5;
// Value from which a candidate is usable at all: a quarter of a good one, less what ten seconds cost.
constexpr double kUsable = -0.01;
// Part of a way that counts as followed to its end.
constexpr double kWholeWay = 0.99;
// Candidates handed over even if they are not.
constexpr std::size_t kLastResorts = 3;
// What arrival errors may cost against a plan that was not better than this anyway.
constexpr double kArrivalLoss = 0.02;
// How far below that is of no interest any more.
constexpr double kWorthless = -0.05;
// Starts per place and orientation before the next place gets its turn: variety first.
constexpr int kStartsPerVisit = 3;
// A doorway has few places to stand: each gets more starts.
constexpr int kPassageStarts = 10;
// Base - fingertips where a flap is pressed down: the lower it ends the nearer [m].
const std::vector<double> kPressDistances{0.5, 0.6, 0.7, 0.8};
// Disturbed placements: error of the seen normal, of the base's place and of its heading.
struct Disturbance {
  double normal;
  double dx;
  double dy;
  double yaw;
};
constexpr Disturbance kDisturbances[] = {
    {0.17, 0.02, 0.02, 0.07}, {-0.17, -0.02, 0.02, -0.07}, {0.17, -0.02, -0.02, -0.07}, {-0.17, 0.02, -0.02, 0.07}};
// Before a doorway both edges are seen as well, and of a flap half open the axis is felt: only the base stands beside its
// place.
constexpr Disturbance kPlacedDisturbances[] = {
    {0.0, 0.015, 0.015, 0.035}, {0.0, -0.015, 0.015, -0.035}, {0.0, -0.015, -0.015, -0.035}, {0.0, 0.015, -0.015, 0.035}};

void require(bool ok, const char* key, double value, const char* allowed) {
  if (!ok) throw ConfigError("planner." + std::string(key) + " = " + std::to_string(value) + ": must be " + allowed);
}

void require_list(const std::vector<double>& values, const char* key, double lower, double upper) {
  if (values.empty()) throw ConfigError("planner." + std::string(key) + " is empty: needs at least one value");
  for (const double value : values) {
    require(value >= lower && value <= upper, key, value,
            ("in [" + std::to_string(lower) + ", " + std::to_string(upper) + "]").c_str());
  }
}

bool finite(const HandleBelief& belief) {
  return belief.position.allFinite() && belief.normal.allFinite() && belief.bar.allFinite() &&
         std::isfinite(belief.standoff) && Vector2d(belief.normal.x(), belief.normal.y()).norm() > 0.1;
}

bool same_base(const BasePose& a, const BasePose& b) { return a.x == b.x && a.y == b.y && a.yaw == b.yaw; }

Vector3d turned_about_z(const Vector3d& v, double angle) { return Eigen::AngleAxisd(angle, Vector3d::UnitZ()) * v; }

template <typename T>
void shuffle(std::vector<T>& values, Random& random) {
  for (std::size_t i = values.size(); i > 1; --i)
    std::swap(values[i - 1], values[static_cast<std::size_t>(random.index(static_cast<int>(i)))]);
}

}  // namespace

void PlannerConfig::validate() const {
  require_list(hinge_radii, "hinge_radii", 0.1, 2.0);
  require_list(distances, "distances", 0.3, 2.0);
  require_list(passage_distances, "passage_distances", 0.3, 2.0);
  require_list(passage_yaws, "passage_yaws", -kPi, kPi);
  require_list(azimuths, "azimuths", -kPi, kPi);
  require(hinge_angle > 0.0 && hinge_angle <= kPi, "hinge_angle", hinge_angle, "in (0, 3.14]");
  require(drawer_travel > 0.0 && drawer_travel <= 2.0, "drawer_travel", drawer_travel, "in (0, 2]");
  require(sliding_travel > 0.0 && sliding_travel <= 3.0, "sliding_travel", sliding_travel, "in (0, 3]");
  require(flap_radius >= 0.1 && flap_radius <= 2.0, "flap_radius", flap_radius, "in [0.1, 2]");
  require(headings >= 1 && headings <= 72, "headings", headings, "in [1, 72]");
  require(ik_starts >= 1 && ik_starts <= 1000, "ik_starts", ik_starts, "in [1, 1000]");
  require(roll_outs >= 1 && roll_outs <= 10000, "roll_outs", roll_outs, "in [1, 10000]");
  require(kept >= 1 && kept <= 100, "kept", kept, "in [1, 100]");
  require(step > 0.0 && step <= 0.1, "step", step, "in (0, 0.1]");
  require(speed >= 0.02 && speed <= 0.5, "speed", speed, "in [0.02, 0.5]");
  require(least_sigma > 0.0 && least_sigma < 1.0, "least_sigma", least_sigma, "in (0, 1)");
  require(own_clearance >= 0.0 && own_clearance < 0.12, "own_clearance", own_clearance, "in [0, 0.12)");
  require(wall_clearance >= 0.0 && wall_clearance < 0.35, "wall_clearance", wall_clearance, "in [0, 0.35)");
  require(approach_distance > 0.0 && approach_distance <= 0.5, "approach_distance", approach_distance, "in (0, 0.5]");
}

struct GraspPlanner::Impl {
  Impl(const RobotModel& robot, const PlannerConfig& settings, const WbcConfig& wbc, const BaseLawConfig& base_law,
       const ClearanceConfig& clearance)
      : model(robot), config(settings), roll_out(model, config, wbc, base_law, clearance), finder(model, config, roll_out) {}

  std::vector<BasePose> places(const HandleBelief& belief);
  std::vector<Posture> pool(const HandleBelief& belief, Random& random, std::string& why);
  double worst(const HandleBelief& belief, std::vector<MechanismHypothesis>& hypotheses, const Posture& posture,
               double enough);
  std::vector<Posture> best_of(const HandleBelief& belief, std::vector<MechanismHypothesis>& hypotheses,
                               const std::vector<Posture>& postures, bool one_per_base);
  double disturbed(const HandleBelief& belief, std::vector<MechanismHypothesis>& hypotheses, const Posture& posture,
                   double enough);
  std::vector<Posture> postures_at(const HandleBelief& belief, const BasePose& base, Random& random);
  bool complete(const HandleBelief& belief, const Posture& posture, GraspCandidate& out);

  RobotModel model;
  PlannerConfig config;
  RollOut roll_out;
  PostureFinder finder;
};

// Base poses round the handle in the frame of the leaf's normal that keep their distance to the wall.
std::vector<BasePose> GraspPlanner::Impl::places(const HandleBelief& belief) {
  std::vector<BasePose> out;
  if (belief.passage) {
    const BaseLine line = passage_line(*belief.passage);
    const double yaw = std::atan2(line.direction.y(), line.direction.x());
    for (const double distance : config.passage_distances) {
      const Vector3d p = line.point + (line.direction.dot(belief.position - line.point) - distance) * line.direction;
      for (const double heading : {yaw, wrap_angle(yaw + kPi)}) out.push_back({p.x(), p.y(), heading});
    }
    return out;
  }
  const Vector3d n = Vector3d(belief.normal.x(), belief.normal.y(), 0.0).normalized();
  const Vector3d hand = hand_place(belief);
  for (const double distance : belief.press ? kPressDistances : config.distances) {
    for (const double azimuth : config.azimuths) {
      const Vector3d p = hand + distance * turned_about_z(n, azimuth);
      const double bearing = std::atan2(hand.y() - p.y(), hand.x() - p.x());
      for (int i = 0; i < config.headings; ++i) {
        const BasePose base{p.x(), p.y(), wrap_angle(bearing + 2.0 * kPi * i / config.headings)};
        if (roll_out.look(belief, base, model.home()).base >= config.wall_clearance) out.push_back(base);
      }
    }
  }
  return out;
}

// Usable postures from shuffled places, a few starts at each per round, until there are enough.
std::vector<Posture> GraspPlanner::Impl::pool(const HandleBelief& belief, Random& random, std::string& why) {
  std::vector<Posture> out;
  std::vector<BasePose> around = places(belief);
  if (around.empty()) {
    why = "no base pose near the handle keeps its distance to the wall";
    return out;
  }
  shuffle(around, random);
  const PostureLimits limits{config.least_sigma, config.own_clearance, kArmWall};
  const std::vector<Matrix3d> orientations = hand_orientations(belief, config);
  PostureTally tally;
  const auto wanted = static_cast<std::size_t>(config.roll_outs);
  const int starts = config.ik_starts * (belief.passage ? kPassageStarts : 1);
  for (int round = 0; round * kStartsPerVisit < starts && out.size() < wanted; ++round) {
    for (const BasePose& base : around) {
      for (int start = 0; start < kStartsPerVisit && out.size() < wanted; ++start) {
        const Matrix3d& R = orientations[static_cast<std::size_t>(random.index(static_cast<int>(orientations.size())))];
        const Pose hand = hand_at(belief, R);
        const std::optional<JointVector> q = finder.reach(base, hand, random, tally);
        if (!q) continue;
        const bool known = std::any_of(out.begin(), out.end(), [&](const Posture& other) {
          return same_base(other.base, base) && same_posture(other.q, *q);
        });
        if (!known && finder.usable(belief, base, *q, limits, tally)) out.push_back({base, *q, hand});
      }
    }
    if (tally.reached == 0) break;  // a round over all places without one solution: out of reach
  }
  if (out.empty()) why = explain(tally, belief, limits);
  return out;
}

// Worst value over the hypotheses; the one that spoils a candidate moves to the front, as it will spoil others too.
double GraspPlanner::Impl::worst(const HandleBelief& belief, std::vector<MechanismHypothesis>& hypotheses,
                                 const Posture& posture, double enough) {
  double value = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    value = std::min(value, roll_out.run(belief, hypotheses[i], posture.base, posture.q, enough).value);
    if (value < enough) {
      std::rotate(hypotheses.begin(), hypotheses.begin() + static_cast<std::ptrdiff_t>(i),
                  hypotheses.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      break;
    }
  }
  return value;
}

// The best postures by their worst value, best first, one per base pose: the others would fail there for the same reason,
// and all postures are tried again at the pose reached. Those that cannot enter the list are given up early.
std::vector<Posture> GraspPlanner::Impl::best_of(const HandleBelief& belief, std::vector<MechanismHypothesis>& hypotheses,
                                                 const std::vector<Posture>& postures, bool one_per_base) {
  std::vector<Posture> out;
  const auto kept = static_cast<std::size_t>(config.kept);
  for (Posture posture : postures) {
    const auto rival = std::find_if(
        out.begin(), out.end(), [&](const Posture& other) { return one_per_base && same_base(other.base, posture.base); });
    const double full = out.size() < kept ? kHopeless : out.back().value;
    const double enough = rival == out.end() ? full : rival->value;
    posture.value = worst(belief, hypotheses, posture, enough);
    if (posture.value < enough) continue;
    if (rival != out.end()) out.erase(rival);
    const auto place = std::upper_bound(out.begin(), out.end(), posture,
                                        [](const Posture& a, const Posture& b) { return a.value > b.value; });
    out.insert(place, posture);
    if (out.size() > kept) out.pop_back();
  }
  return out;
}

// Worst value when the normal was seen wrongly and the base stands beside its place: the belief turns, the truth does not.
double GraspPlanner::Impl::disturbed(const HandleBelief& belief, std::vector<MechanismHypothesis>& hypotheses,
                                     const Posture& posture, double enough) {
  double value = posture.value;
  for (const Disturbance& d : belief.passage || belief.press ? kPlacedDisturbances : kDisturbances) {
    HandleBelief seen = belief;
    seen.normal = turned_about_z(belief.normal, d.normal);
    seen.bar = turned_about_z(belief.bar, d.normal);
    const Vector3d offset = turned_about_z(
        Vector3d(posture.base.x, posture.base.y, 0.0) - Vector3d(belief.position.x(), belief.position.y(), 0.0), d.normal);
    Posture moved = posture;
    moved.base = {belief.position.x() + offset.x() + d.dx, belief.position.y() + offset.y() + d.dy,
                  wrap_angle(posture.base.yaw + d.normal + d.yaw)};
    moved.hand.linear() = Eigen::AngleAxisd(d.normal, Vector3d::UnitZ()).toRotationMatrix() * posture.hand.linear();
    if (!model.solve_ik(moved.base, moved.hand, moved.q)) return -1.0;
    value = std::min(value, worst(seen, hypotheses, moved, enough));
    if (value < enough) break;
  }
  return value;
}

// Every usable posture from one base pose.
std::vector<Posture> GraspPlanner::Impl::postures_at(const HandleBelief& belief, const BasePose& base, Random& random) {
  std::vector<Posture> out;
  PostureTally tally;
  const PostureLimits limits{kKeepSigma, kKeepOwn, kKeepWall};
  for (const Matrix3d& R : hand_orientations(belief, config)) {
    const Pose hand = hand_at(belief, R);
    for (int start = 0; start < 2 * config.ik_starts; ++start) {
      const std::optional<JointVector> q = finder.reach(base, hand, random, tally);
      if (!q) continue;
      const bool known =
          std::any_of(out.begin(), out.end(), [&](const Posture& other) { return same_posture(other.q, *q); });
      if (!known && finder.usable(belief, base, *q, limits, tally)) out.push_back({base, *q, hand});
    }
  }
  return out;
}

bool GraspPlanner::Impl::complete(const HandleBelief& belief, const Posture& posture, GraspCandidate& out) {
  const std::optional<JointVector> approach = finder.approach(belief, posture);
  if (!approach) return false;
  out = {posture.base, posture.q, *approach, posture.hand, posture.value, {}};
  if (posture.value >= kUsable) return true;
  for (const MechanismHypothesis& hypothesis : make_hypotheses(belief, config)) {
    if (roll_out.run(belief, hypothesis, posture.base, posture.q, kHopeless).fraction < kWholeWay)
      out.falls_short.push_back(hypothesis.name);
  }
  return true;
}

GraspPlanner::GraspPlanner(const RobotModel& model, const PlannerConfig& config, const WbcConfig& wbc,
                           const BaseLawConfig& base_law, const ClearanceConfig& clearance) {
  config.validate();
  impl_ = std::make_unique<Impl>(model, config, wbc, base_law, clearance);
}

GraspPlanner::~GraspPlanner() = default;

std::vector<GraspCandidate> GraspPlanner::choose(const HandleBelief& belief, std::uint64_t seed, std::string* why) const {
  std::string reason;
  std::vector<GraspCandidate> out;
  if (finite(belief)) {
    Impl& impl = *impl_;
    Random random(seed);
    std::vector<Posture> postures = impl.pool(belief, random, reason);
    std::erase_if(postures, [&](const Posture& posture) { return !impl.finder.approach(belief, posture); });
    if (postures.empty() && reason.empty()) reason = "no posture can come straight to the handle";
    std::vector<MechanismHypothesis> hypotheses = make_hypotheses(belief, impl.config);
    std::vector<Posture> best = impl.best_of(belief, hypotheses, postures, true);
    for (Posture& posture : best) posture.value = impl.disturbed(belief, hypotheses, posture, kWorthless);
    std::stable_sort(best.begin(), best.end(), [](const Posture& a, const Posture& b) { return a.value > b.value; });
    for (const Posture& posture : best) {
      GraspCandidate candidate;
      // Poor ones only fill the list up: trying them at the pose reached beats giving up.
      if (posture.value < kUsable && out.size() >= kLastResorts) break;
      if (impl.complete(belief, posture, candidate)) out.push_back(candidate);
    }
  } else {
    reason = "the handle's pose is not finite";
  }
  if (why != nullptr) *why = reason;
  return out;
}

double GraspPlanner::value_for_felt(const HandleBelief& belief, const GraspCandidate& candidate) const noexcept {
  if (!belief.felt) return candidate.value;
  const MechanismHypothesis hypothesis = felt_hypothesis(belief, *belief.felt, impl_->config);
  return impl_->roll_out.run(belief, hypothesis, candidate.base, candidate.grasp, kHopeless).value;
}

bool GraspPlanner::choose_posture(const HandleBelief& belief, const BasePose& base, std::uint64_t seed,
                                  GraspCandidate& candidate) const {
  const bool placed = std::isfinite(base.x) && std::isfinite(base.y) && std::isfinite(base.yaw);
  if (!finite(belief) || !placed || candidate.grasp.size() != impl_->model.joints()) return false;
  Impl& impl = *impl_;
  // The orientation of the plan, carried over to the handle as it is seen now.
  const std::vector<Matrix3d> orientations = hand_orientations(belief, impl.config);
  const Matrix3d& R = *std::min_element(orientations.begin(), orientations.end(), [&](const Matrix3d& a, const Matrix3d& b) {
    return log_so3(a * candidate.hand.linear().transpose()).norm() < log_so3(b * candidate.hand.linear().transpose()).norm();
  });
  Posture planned{base, candidate.grasp, hand_at(belief, R), candidate.value};
  PostureTally tally;
  const bool near = std::hypot(base.x - candidate.base.x, base.y - candidate.base.y) < kKeepDistance &&
                    std::abs(wrap_angle(base.yaw - candidate.base.yaw)) < kKeepTurn;
  std::vector<MechanismHypothesis> hypotheses = make_hypotheses(belief, impl.config);
  if (near && candidate.value >= kUsable && impl.model.solve_ik(base, planned.hand, planned.q) &&
      impl.finder.usable(belief, base, planned.q, {kKeepSigma, kKeepOwn, kKeepWall}, tally) &&
      (!(belief.passage || belief.press) || impl.worst(belief, hypotheses, planned, kUsable) >= kUsable) &&
      impl.complete(belief, planned, candidate)) {
    return true;
  }
  Random random(seed);
  std::vector<Posture> postures = impl.postures_at(belief, base, random);
  std::erase_if(postures, [&](const Posture& posture) { return !impl.finder.approach(belief, posture); });
  const std::vector<Posture> best = impl.best_of(belief, hypotheses, postures, false);
  const double least = std::min(kUsable, candidate.value - kArrivalLoss);
  for (const Posture& posture : best) {
    if (posture.value >= least && impl.complete(belief, posture, candidate)) return true;
  }
  return false;
}

}  // namespace ajar
