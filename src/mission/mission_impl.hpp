#pragma once

#include <string>
#include <vector>

#include "ajar/mission/joint_move.hpp"
#include "ajar/mission/opener.hpp"
#include "ajar/mission/phase_table.hpp"
#include "ajar/mission/prober.hpp"
#include "ajar/model/footprint.hpp"
#include "ajar/planning/flap_room.hpp"
#include "ajar/planning/passage.hpp"

namespace ajar {

/// Mean of several sights of the handle, in the odometry frame.
class SightAverage {
 public:
  void reset() noexcept;
  void add(const HandleSight& sight, const BasePose& base) noexcept;
  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] HandleBelief belief() const noexcept;

 private:
  Vector3d position_ = Vector3d::Zero();
  Vector3d normal_ = Vector3d::Zero();
  Vector3d bar_ = Vector3d::Zero();
  Vector3d left_edge_ = Vector3d::Zero();
  Vector3d right_edge_ = Vector3d::Zero();
  bool framed_ = false;
  double standoff_ = 0.06;
  double thickness_ = 0.0;
  int count_ = 0;
};

/// Longest motion of the arm between driving posture and handle. [s]
inline constexpr double kReachTime = 30.0;

/// The inside of a mission: one member function per phase, the tools that they use, and what they remember.
struct Mission::Impl {
  Impl(const RobotModel& robot, const MissionConfig& settings, std::optional<Vector3d> guess, std::uint64_t run_seed);

  Command step(const RobotState& measured) noexcept;

  // Watch over every tick. Each returns true when it stopped the mission.
  bool unhealthy(const RobotState& state) noexcept;
  bool too_much(const RobotState& state) noexcept;
  bool base_blocked(const RobotState& state) noexcept;

  // The phases.
  [[nodiscard]] HandleBelief seen() const noexcept;
  void choose(const RobotState& state);
  void approach(const RobotState& state);
  void reach(const RobotState& state);
  void start_reach(const RobotState& state);
  // Distance of the arm to what is believed round it. [m]
  double arm_room(const BasePose& base, const JointVector& q) noexcept;
  std::vector<JointVector> reach_path(const RobotState& state);
  [[nodiscard]] BasePose localise(const BasePose& odometry) const noexcept;
  void correct_odometry(const HandleBelief& seen_again) noexcept;
  void zero(const RobotState& state) noexcept;
  void grasp(const RobotState& state) noexcept;
  void close_fingers(const RobotState& state) noexcept;
  void probe() noexcept;
  void open(const RobotState& state) noexcept;
  bool found_to_open_away(EndDetector::Verdict verdict) noexcept;
  [[nodiscard]] bool found_to_pivot(EndDetector::Verdict verdict) noexcept;
  bool better_held_otherwise(EndDetector::Verdict verdict) noexcept;
  bool press_instead(EndDetector::Verdict verdict) noexcept;
  bool good_to_the_end(const FeltMechanism& mechanism) noexcept;
  bool good_half_way(const FeltMechanism& mechanism) noexcept;
  void choose_half_way();
  bool look_at_flap() noexcept;
  bool flap_moved() noexcept;
  bool at_its_stop() noexcept;
  void look_at_result(const RobotState& state) noexcept;
  bool flap_rests(const RobotState& state) noexcept;
  void press_down(const RobotState& state) noexcept;
  bool lead_back(const RobotState& state) noexcept;
  [[nodiscard]] Opener::Tick tick(const RobotState& state) noexcept;
  bool let_go(double give_time) noexcept;
  [[nodiscard]] Vector3d way_out() noexcept;
  bool start_folding(const RobotState& state);
  bool shut() noexcept;
  void regrasp(const RobotState& state);
  void release(const RobotState& state);
  void retreat(const RobotState& state) noexcept;

  void process(Event event, EndReason why = EndReason::Running) noexcept;
  void enter(Phase next) noexcept;
  // Moves the hand towards a pose; returns the position error [m].
  double move_hand(const Pose& target, double speed, bool base_fixed = true) noexcept;
  void solve_hand_twist(const Vector6d& twist, bool base_fixed = true) noexcept;
  void start_run_up() noexcept;
  [[nodiscard]] bool runs_up() const noexcept;
  bool off_flap(const KeepOut& beside, const RobotState& state) noexcept;
  [[nodiscard]] KeepOut kept_out() const noexcept;
  [[nodiscard]] KeepOut for_this_base(KeepOut keep_out) const noexcept;
  [[nodiscard]] HandleBelief half_open() const noexcept;
  void command_zero() noexcept;
  void command_solution() noexcept;
  void command_joints(const JointVector& rates) noexcept;
  void command_base(const BaseTwist& twist) noexcept;
  void next_candidate(const RobotState& state);

  RobotModel model;
  MissionConfig config;
  std::optional<Vector3d> guess;
  std::uint64_t seed;

  Footprint footprint;
  Navigator navigator;
  GraspPlanner planner;
  WholeBodyController controller;
  ClearanceChecker clearance;
  StatePredictor predictor;
  Foreseen ahead;
  SigmaTrack sigma_track;
  WrenchEstimator wrench;
  Opener opener;
  Prober prober;
  JointMove joint_move;

  Phase phase = Phase::Choose;
  Phase ended_in = Phase::Choose;
  EndReason why = EndReason::Running;
  std::string detail;
  bool interrupted = false;
  double time_in_phase = 0.0;
  bool planned = false;
  bool located = false;

  SightAverage sights;
  HandleBelief handle;
  BasePose odometry_origin;  // of the odometry frame in the frame of the first sight: removes the drift of the drive
  std::vector<GraspCandidate> candidates;
  std::size_t candidate = 0;
  int tried = 0;            // base poses since the choice
  bool drawn_anew = false;  // the list was used up and drawn once more
  GraspCandidate chosen;
  Vector3d direction = Vector3d::UnitX();

  bool closing = false;
  double still_fingers = 0.0;
  double last_opening = 0.0;
  int misses = 0;
  int probes = 0;
  double moving_force = 0.0;           // that probing needed to move it, with a reserve; 0 = it was not probed [N]
  std::optional<HingeSide> felt_side;  // of a leaf that opens away
  std::optional<double> felt_radius;   // of one that turns about an axis within its width [m]
  double misreading = 0.0;             // of the camera about the vertical, as felt [rad]
  std::optional<FeltMechanism> felt;   // that the handle is taken anew for
  bool half_way = false;               // the handle is held for half the way only
  double leaf_pull = 0.0;              // along the way, mean [N]
  double fenced = 0.0;                 // held back by distances for this long [s]
  std::optional<FlapPress> flap;       // that was let go half open
  double let_go_at = 0.0;              // its opening then [rad]
  bool fell = false;                   // it came down from there to its stop by itself
  bool went_back = false;              // what was opened does not stay open once it is let go
  HandleBelief closed_handle;          // of that flap
  HandleBelief landmark;               // handle as it was seen when the choice was made
  int judgements = 0;                  // of the grasp, by what was felt
  bool led_back = false;
  bool cleared = false;      // the hand is off what it held
  double flap_looked = 0.0;  // time in the phase of the last look at it [s]
  ClearanceRow fence;        // the nearest pair when a clearance stopped it
  double blocked_time = 0.0;
  double given_until = 0.0;  // time in the phase at which the fingers began to open; 0 = the hand still gives way
  Vector3d still_force = Vector3d::Zero();  // mean over what the hand felt standing, before the fingers open [N]
  int still_ticks = 0;
  bool presses = false;  // the leaf against the hand, by itself
  bool holding = false;
  Pose clear_pose = Pose::Identity();
  Pose taken_at = Pose::Identity();  // hand when the fingers had closed
  bool is_shut = false;              // what was opened a little before letting go stands again as it was
  double run_up = 0.0;               // speed of the base away from a flap that is let go [m/s]
  BasePose retreat_start;
  double retreat_sense = 0.0;
  double last_gap = 0.0;

  ClearanceResult clearances;
  Command command;
  MissionRecord record;
};

}  // namespace ajar
