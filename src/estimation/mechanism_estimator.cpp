#include "ajar/estimation/mechanism_estimator.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/estimation/direction_law.hpp"
#include "ajar/estimation/path_filter.hpp"
#include "ajar/estimation/type_decision.hpp"

namespace ajar {
namespace {

constexpr double kGuessSigma = 0.6;       // a guess uniformly wrong up to 60° has 35° RMS [rad]
constexpr double kCurvatureSigma = 3.0;   // of each component before data: hinges of 0.3 m and more [1/m]
constexpr double kFadeDirection = 0.05;   // direction sigma at which filter and adaptive law weigh the same (3°) [rad]
constexpr double kFadeCurvature = 0.4;    // curvature sigma at which they do [1/m]
constexpr double kDirectionFloor = 0.1;   // share of γ that stays: the force still speaks when the path is sure [-]
constexpr double kCurvatureFloor = 0.02;  // share of Γ that stays [-]
constexpr double kPullRate = 20.0;        // rate at which a sure filter draws direction and curvature to itself [1/s]
constexpr double kMaxTurnRate = 1.5;      // hand-over and restarts turn the direction no faster [rad/s]
constexpr double kMaxBendRate = 8.0;      // nor bend the curvature faster [1/(m s)]
// Squared distance of the curvatures with and without orientation at which the grip pivots: the tail of 1e-5 of χ² with 2
// degrees of freedom. The covariance of the difference is C_free - C_rigid; a fifth of C_free on top keeps linearisation
// errors out (docs/equations.md#estimator, 8).
constexpr double kGripLimit = 23.0;
constexpr double kGripMargin = 0.2;
constexpr double kStiffnessDoubt = 0.5;  // K_c known to a factor of two: so much of f/K_c is error [-]
constexpr double kFrozenWay = 1e-3;      // far beyond any encoder's step [m]
constexpr double kBlindWay = 0.1;        // furniture's curvature changes by its own floor within about that [m]
constexpr double kLongestTick = 0.1;     // no control loop is slower [s]
constexpr double kTurnSure = 2.0;        // |k| over its sigma from which its direction is an axis [-]

bool positive(double value) { return std::isfinite(value) && value > 0.0; }
bool not_negative(double value) { return std::isfinite(value) && value >= 0.0; }

void require(bool good, const char* field, double value, const char* range) {
  if (!good) throw ConfigError("estimator." + std::string(field) + " = " + std::to_string(value) + ": must be " + range);
}

PathFilterConfig filter_config(const EstimatorConfig& config, bool use_rotation) {
  PathFilterConfig filter;
  filter.noise = config.noise;
  filter.use_rotation = use_rotation;
  filter.curvature_prior = kCurvatureSigma;
  return filter;
}

// Share of the filter's say at a standard deviation, half at `even`.
double filter_share(double sigma, double even) { return even * even / (even * even + sigma * sigma); }

}  // namespace

void EstimatorConfig::validate() const {
  filter_config(*this, true).validate();
  require(positive(grasp_stiffness), "grasp_stiffness", grasp_stiffness, "> 0 N/m");
  require(positive(bandwidth), "bandwidth", bandwidth, "> 0 1/s");
  require(positive(damping_ratio), "damping_ratio", damping_ratio, "> 0");
  require(not_negative(curvature_leak), "curvature_leak", curvature_leak, ">= 0 1/s");
  require(not_negative(still_speed), "still_speed", still_speed, ">= 0 m/s");
  require(not_negative(stuck_turn_rate), "stuck_turn_rate", stuck_turn_rate, ">= 0 rad/s");
  require(positive(slide_curvature), "slide_curvature", slide_curvature, "> 0 1/m");
  require(hinge_curvature > slide_curvature && std::isfinite(hinge_curvature), "hinge_curvature", hinge_curvature,
          "> slide_curvature");
  require(positive(type_threshold), "type_threshold", type_threshold, "> 0");
  require(positive(slide_threshold), "slide_threshold", slide_threshold, "> 0");
  require(not_negative(relative_curvature_floor), "relative_curvature_floor", relative_curvature_floor, ">= 0");
}

struct MechanismEstimator::Impl {
  explicit Impl(const EstimatorConfig& c)
      : config(c), rigid_path(filter_config(c, true)), free_path(filter_config(c, false)) {}

  EstimatorConfig config;
  PathFilter rigid_path;  // with orientation
  PathFilter free_path;   // positions only
  MechanismEstimate estimate;
  DirectionState law;
  Pose start = Pose::Identity();
  Vector3d last_point = Vector3d::Zero();
  double unseen_travel = 0.0;  // base travel of the ticks that were not learnt from [m]
  double travel = 0.0;         // base travel since reset [m]
  double sign = 1.0;           // of the motion for opening against the filter's order of travel
  double still_way = 0.0;      // way that the speed says since the pose last changed [m]
  double blind_way = 0.0;      // way since the last measurement that was not refused [m]
  double last_speed = 0.0;     // of the hand [m/s]
  Pose last_hand = Pose::Identity();
  MechanismEstimate seen;  // the estimate before it went blind

  [[nodiscard]] const PathFilter& path() const { return estimate.rigid_grasp ? rigid_path : free_path; }

  PathEvent learn_path(const PathSample& sample);
  void test_grip();
  void decide();
  [[nodiscard]] double with_floor(double variance, double curvature) const;
  [[nodiscard]] MechanismType type_of(const PathFilter& filter) const;
  void choose_sign();
  void follow(const EstimatorInput& input, const Vector3d& point, bool moving);
  void follow_law(const EstimatorInput& input, double direction_share, double curvature_share);
  void publish(const PathOutput& out);
  [[nodiscard]] bool frozen(const EstimatorInput& input);
  void go_blind(double dt);
  void publish_angle(const Matrix3d& rotation);
};

PathEvent MechanismEstimator::Impl::learn_path(const PathSample& sample) {
  const PathEvent free_event = free_path.add(sample);
  if (!estimate.rigid_grasp) return free_event;
  return rigid_path.add(sample);
}

// Hausman's test: if the hand turns with the mechanism, both filters agree within what orientation adds. What it adds is on
// the curvature: the directions then differ by C_xk C_kk⁻¹ of what the curvatures do, and say nothing of their own. (8)
void MechanismEstimator::Impl::test_grip() {
  if (!estimate.rigid_grasp || !rigid_path.started() || !free_path.started()) return;
  const PathOutput with = rigid_path.output();
  const PathOutput without = free_path.output();
  const double side = with.F.col(0).dot(without.F.col(0)) < 0.0 ? -1.0 : 1.0;
  const Vector2d d = path_difference(with.F, with.kap, side * without.F.col(0), side * without.curvature()).tail<2>();
  const double scale = free_path.noise_scale() / rigid_path.noise_scale();
  const Eigen::Matrix2d C_rigid = scale * with.covariance.block<2, 2>(4, 4);
  const Eigen::Matrix2d roll = with.F.rightCols<2>().transpose() * without.F.rightCols<2>();  // from frame to frame
  const Eigen::Matrix2d C_free = roll * without.covariance.block<2, 2>(4, 4) * roll.transpose();
  Eigen::LLT<Eigen::Matrix2d> factor((1.0 + kGripMargin) * C_free - C_rigid);
  if (factor.info() != Eigen::Success) factor.compute(C_free + C_rigid);  // after an alarm of one of them
  if (factor.info() != Eigen::Success || !(d.dot(factor.solve(d)) > kGripLimit)) return;
  estimate.rigid_grasp = false;
  estimate.type = MechanismType::Unknown;
}

double MechanismEstimator::Impl::with_floor(double variance, double curvature) const {
  const double floor = config.relative_curvature_floor * curvature;
  return variance + floor * floor;
}

MechanismType MechanismEstimator::Impl::type_of(const PathFilter& filter) const {
  if (!filter.started()) return MechanismType::Unknown;
  const PathOutput out = filter.output();
  Eigen::Matrix2d C = out.covariance.block<2, 2>(4, 4);
  C.diagonal().array() += with_floor(0.0, out.kap.norm());
  return decide_type(out.kap, C,
                     {.slide_curvature = config.slide_curvature,
                      .hinge_curvature = config.hinge_curvature,
                      .threshold = config.type_threshold,
                      .slide_threshold = config.slide_threshold});
}

// A decision stands until the opposite is decided; orientation alone may not decide for a slide, for a pivoting grip looks
// so.
void MechanismEstimator::Impl::decide() {
  MechanismType type = type_of(path());
  if (type == MechanismType::Slide && estimate.rigid_grasp && type_of(free_path) != MechanismType::Slide) {
    type = MechanismType::Unknown;
  }
  if (type != MechanismType::Unknown) estimate.type = type;
}

void MechanismEstimator::Impl::choose_sign() { sign = path().output().F.col(0).dot(law.x) < 0.0 ? -1.0 : 1.0; }

void MechanismEstimator::Impl::follow_law(const EstimatorInput& input, double direction_share, double curvature_share) {
  const double speed = law.x.dot(input.velocity);
  AdaptiveGains gains = adaptive_gains(config.bandwidth, config.damping_ratio, speed);
  gains.gamma *= direction_share;
  gains.Gamma *= curvature_share;
  gains.curvature_leak = config.curvature_leak;
  law = step_adaptive_law(law, speed * law.x - input.normal_correction, speed, gains, input.dt);
}

// Direction and curvature of this tick: the adaptive law until the path filter runs, then the filter, the law faded.
void MechanismEstimator::Impl::follow(const EstimatorInput& input, const Vector3d& point, bool moving) {
  if (!estimate.fitted) {
    if (moving) {
      follow_law(input, 1.0, 0.0);
    } else {
      law.x = turn_from_reaction(law.x, input.force, config.stuck_turn_rate, input.dt);
    }
    estimate.direction = law.x;
    estimate.curvature = law.k - law.x * law.x.dot(law.k);
    estimate.point = point;
    estimate.frame.col(0) = law.x;
    estimate.frame.col(1) = any_perpendicular(law.x);
    estimate.frame.col(2) = law.x.cross(estimate.frame.col(1));
    return;
  }
  const PathOutput out = path().peek(point);
  const double sx = std::sqrt(out.covariance.diagonal().segment<2>(2).sum());
  const double sk = std::sqrt(out.covariance.diagonal().segment<2>(4).sum());
  const double direction_share = filter_share(sx, kFadeDirection);
  const double curvature_share = filter_share(sk, kFadeCurvature);
  if (moving) {
    follow_law(input, std::max(kDirectionFloor, 1.0 - direction_share), std::max(kCurvatureFloor, 1.0 - curvature_share));
  }
  const Vector3d target = sign * out.F.col(0);
  const double angle = std::atan2(law.x.cross(target).norm(), law.x.dot(target));
  const double near = -std::expm1(-kPullRate * direction_share * input.dt);
  law.x = turn_towards(law.x, target, std::min(near * angle, kMaxTurnRate * input.dt));
  const Vector3d bend = -std::expm1(-kPullRate * curvature_share * input.dt) * (sign * out.curvature() - law.k);
  law.k += bend * std::min(1.0, kMaxBendRate * input.dt / std::max(bend.norm(), 1e-12));
  law.k -= law.x * law.x.dot(law.k);
  publish(out);
}

void MechanismEstimator::Impl::publish(const PathOutput& out) {
  estimate.direction = law.x;
  estimate.curvature = law.k;
  estimate.point = out.point;
  Matrix3d F = out.F;
  estimate.covariance = out.covariance.block<4, 4>(2, 2);
  if (sign < 0.0) {  // x and b2 turned about: so do w2 in them and, k changing its sign, kap1
    F.col(0) = -F.col(0);
    F.col(2) = -F.col(2);
    const Eigen::Vector4d flip(1.0, -1.0, -1.0, 1.0);
    estimate.covariance = (flip.asDiagonal() * estimate.covariance * flip.asDiagonal()).eval();
  }
  const Vector3d axis = F.col(0).cross(law.x);
  const double lag = std::atan2(axis.norm(), F.col(0).dot(law.x));
  estimate.frame = (axis.norm() > 1e-12 ? exp_so3(axis * (lag / axis.norm())) : Matrix3d::Identity()) * F;
  const auto variance = estimate.covariance.diagonal();
  estimate.direction_sigma = std::sqrt(variance[0] + variance[1] + lag * lag);
  estimate.curvature_sigma = std::sqrt(with_floor(variance[2] + variance[3], law.k.norm()));
}

// Turning so far: of the hand about k when the grasp is rigid and k has a direction, else |k| times arc.
void MechanismEstimator::Impl::publish_angle(const Matrix3d& rotation) {
  const double kappa = estimate.curvature.norm();
  const bool axis_known = estimate.fitted && kappa > kTurnSure * estimate.curvature_sigma;
  if (estimate.rigid_grasp && axis_known) {
    const PoseNoise& n = config.noise;
    estimate.angle = log_so3(rotation * start.linear().transpose()).dot(estimate.curvature) / kappa;
    estimate.angle_sigma = std::sqrt(n.rotation_white * n.rotation_white +
                                     2.0 * n.rotation_correlated * n.rotation_correlated + n.rotation_walk * travel);
    return;
  }
  const double along = kappa * config.noise.position_correlated;
  estimate.angle = kappa * estimate.arc;
  estimate.angle_sigma = std::hypot(estimate.arc * estimate.curvature_sigma, along);
}

// A pose that stays the same to the last bit while the hand is said to move is none.
bool MechanismEstimator::Impl::frozen(const EstimatorInput& input) {
  const bool same = input.hand.matrix() == last_hand.matrix();
  last_hand = input.hand;
  still_way = same ? still_way + input.velocity.norm() * input.dt : 0.0;
  return still_way > kFrozenWay;
}

// Without measurements the estimate keeps its value while the handle goes on at the last known speed: over a way s its
// direction turns by (|k| + σ_k) s unseen, and σ_k doubles within kBlindWay. (docs/equations.md#estimator, 10)
void MechanismEstimator::Impl::go_blind(double dt) {
  if (blind_way == 0.0) seen = estimate;
  blind_way += std::max(last_speed, config.still_speed) * dt;
  const double turn = (seen.curvature.norm() + seen.curvature_sigma) * blind_way;
  const double doubled = blind_way / kBlindWay;
  estimate.covariance = seen.covariance;
  estimate.covariance.diagonal().head<2>().array() += 0.5 * turn * turn;
  estimate.covariance.bottomRightCorner<2, 2>() *= 1.0 + doubled * doubled;
  estimate.direction_sigma = std::hypot(seen.direction_sigma, turn);
  estimate.curvature_sigma = std::hypot(seen.curvature_sigma, seen.curvature_sigma * doubled);
  estimate.angle_sigma = std::hypot(seen.angle_sigma, turn);
}

MechanismEstimator::MechanismEstimator(const EstimatorConfig& config) {
  config.validate();
  impl_ = std::make_unique<Impl>(config);
  reset(Pose::Identity(), Vector3d::UnitX());
}

MechanismEstimator::MechanismEstimator(const MechanismEstimator& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}

MechanismEstimator& MechanismEstimator::operator=(const MechanismEstimator& other) {
  if (this != &other) impl_ = std::make_unique<Impl>(*other.impl_);
  return *this;
}

MechanismEstimator::~MechanismEstimator() = default;

void MechanismEstimator::reset(const Pose& hand, const Vector3d& direction_guess, const Vector3d& curvature_guess,
                               bool bar_turns) noexcept {
  Impl& m = *impl_;
  const double norm = direction_guess.norm();
  m.law.x = std::isfinite(norm) && norm > 1e-9 ? Vector3d(direction_guess / norm) : Vector3d::UnitX();
  m.law.k =
      curvature_guess.allFinite() ? Vector3d(curvature_guess - m.law.x * m.law.x.dot(curvature_guess)) : Vector3d::Zero();
  m.start = hand.matrix().allFinite() ? hand : Pose::Identity();
  m.rigid_path.reset();
  m.free_path.reset();
  m.last_point = m.start.translation();
  m.unseen_travel = m.travel = 0.0;
  m.sign = 1.0;
  m.still_way = m.blind_way = m.last_speed = 0.0;
  m.last_hand = m.start;
  MechanismEstimate fresh;
  fresh.rigid_grasp = m.config.use_rotation && !bar_turns;
  fresh.direction = m.law.x;
  fresh.curvature = m.law.k;
  fresh.point = m.last_point;
  fresh.frame.col(0) = m.law.x;
  fresh.frame.col(1) = any_perpendicular(m.law.x);
  fresh.frame.col(2) = m.law.x.cross(fresh.frame.col(1));
  fresh.direction_sigma = kGuessSigma;
  fresh.curvature_sigma = std::sqrt(2.0) * kCurvatureSigma;
  const double direction = 0.5 * kGuessSigma * kGuessSigma;
  const double curvature = kCurvatureSigma * kCurvatureSigma;
  fresh.covariance = Eigen::Vector4d(direction, direction, curvature, curvature).asDiagonal();
  m.estimate = fresh;
}

EstimatorStatus MechanismEstimator::update(const EstimatorInput& input) noexcept {
  Impl& m = *impl_;
  if (!std::isfinite(input.dt) || input.dt <= 0.0 || !input.hand.matrix().allFinite() || !input.velocity.allFinite() ||
      !input.force.allFinite() || !input.normal_correction.allFinite() || !std::isfinite(input.base_travel) ||
      m.frozen(input)) {
    m.go_blind(std::isfinite(input.dt) ? std::clamp(input.dt, 0.0, kLongestTick) : 0.0);
    return EstimatorStatus::Invalid;
  }
  if (m.blind_way > 0.0) {
    m.estimate = m.seen;
    m.blind_way = 0.0;
  }
  m.last_speed = input.velocity.norm();
  m.travel += std::abs(input.base_travel);
  m.unseen_travel += std::abs(input.base_travel);
  if (!input.learn) return EstimatorStatus::Held;

  const Vector3d normal_force = input.force - m.law.x * m.law.x.dot(input.force);
  PathSample sample;
  sample.position = input.hand.translation() - input.force / m.config.grasp_stiffness;  // of the handle, not of the hand
  sample.rotation = input.hand.linear();
  sample.base_travel = m.unseen_travel;
  sample.extra_sigma = kStiffnessDoubt * normal_force.norm() / m.config.grasp_stiffness;
  m.unseen_travel = 0.0;
  m.estimate.arc += m.law.x.dot(sample.position - m.last_point);
  m.last_point = sample.position;

  const bool was_rigid = m.estimate.rigid_grasp;
  const PathEvent event = m.learn_path(sample);
  if (event == PathEvent::Alarm) {
    ++m.estimate.alarms;
    m.estimate.type = MechanismType::Unknown;
  }
  if (event != PathEvent::None && event != PathEvent::Rejected) {
    m.test_grip();
    m.estimate.fitted = m.path().started();
    if (event == PathEvent::Started || event == PathEvent::Restarted || was_rigid != m.estimate.rigid_grasp) m.choose_sign();
    if (event != PathEvent::Alarm) m.decide();
  }
  const bool moving = std::abs(m.law.x.dot(input.velocity)) > m.config.still_speed;
  m.follow(input, sample.position, moving);
  m.publish_angle(input.hand.linear());
  if (event == PathEvent::Alarm) return EstimatorStatus::ModelAlarm;
  return moving ? EstimatorStatus::Ok : EstimatorStatus::Held;
}

const MechanismEstimate& MechanismEstimator::estimate() const noexcept { return impl_->estimate; }

}  // namespace ajar
