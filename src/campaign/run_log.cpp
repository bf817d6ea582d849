#include "run_log.hpp"

#include <limits>
#include <string>

namespace ajar {
namespace {

constexpr double kNotApplicable = std::numeric_limits<double>::quiet_NaN();

const char* name_of(MechanismType type) noexcept {
  switch (type) {
    case MechanismType::Hinge: return "hinge";
    case MechanismType::Slide: return "slide";
    case MechanismType::Unknown: break;
  }
  return "unknown";
}

const char* name_of(WbcStatus status) noexcept {
  switch (status) {
    case WbcStatus::Ok: return "ok";
    case WbcStatus::Slowed: return "slowed";
    case WbcStatus::Limited: return "limited";
    case WbcStatus::Damped: return "damped";
    case WbcStatus::Stopped: return "stopped";
    case WbcStatus::Invalid: break;
  }
  return "invalid";
}

const char* name_of(BindingLimit limit) noexcept {
  switch (limit) {
    case BindingLimit::None: break;
    case BindingLimit::JointPosition: return "joint_position";
    case BindingLimit::JointRate: return "joint_rate";
    case BindingLimit::JointAcceleration: return "joint_acceleration";
    case BindingLimit::BaseSpeed: return "base_speed";
    case BindingLimit::WheelSpeed: return "wheel_speed";
    case BindingLimit::BaseAcceleration: return "base_acceleration";
    case BindingLimit::Clearance: return "clearance";
  }
  return "none";
}

}  // namespace

/// All columns, in the order of the file. The first are the contract with readers, the last block is ours.
struct RunLog::Channels {
  ChannelList list;
  int joints;

  Group group(std::initializer_list<const char*> names, const char* unit) {
    Group channels;
    for (const char* name : names) channels.push_back(list.number(name, unit));
    return channels;
  }
  Group per_joint(const std::string& prefix, const char* unit) {
    Group channels;
    for (int i = 1; i <= joints; ++i) channels.push_back(list.number(prefix + std::to_string(i), unit));
    return channels;
  }

  explicit Channels(int n) : joints(n) {}

  NumberChannel time = list.number("time", "s");
  TextChannel phase = list.text("phase");
  TextChannel status = list.text("status");
  Group base = group({"base_x", "base_y"}, "m");
  NumberChannel base_yaw = list.number("base_yaw", "rad");
  NumberChannel base_v = list.number("base_v", "m/s");
  NumberChannel base_w = list.number("base_w", "rad/s");
  Group q = per_joint("q", "rad");
  Group dq = per_joint("dq", "rad/s");
  Group force = group({"force_x", "force_y", "force_z"}, "N");
  Group torque = group({"torque_x", "torque_y", "torque_z"}, "N m");
  NumberChannel gripper = list.number("gripper", "m");
  Group hand = group({"hand_x", "hand_y", "hand_z"}, "m");
  Group hand_q = group({"hand_qw", "hand_qx", "hand_qy", "hand_qz"}, "");
  NumberChannel distance = list.number("distance", "m");
  NumberChannel heading_error = list.number("heading_error", "rad");
  NumberChannel sigma_min = list.number("sigma_min", "");
  Group est_dir = group({"est_dir_x", "est_dir_y", "est_dir_z"}, "");
  Group est_curv = group({"est_curv_x", "est_curv_y", "est_curv_z"}, "1/m");
  NumberChannel est_dir_sigma = list.number("est_dir_sigma", "rad");
  NumberChannel est_curv_sigma = list.number("est_curv_sigma", "1/m");
  TextChannel est_type = list.text("est_type");
  Group ref_v = group({"ref_vx", "ref_vy", "ref_vz"}, "m/s");
  Group ref_w = group({"ref_wx", "ref_wy", "ref_wz"}, "rad/s");
  Group cmd_dq = per_joint("cmd_dq", "rad/s");
  NumberChannel cmd_v = list.number("cmd_v", "m/s");
  NumberChannel cmd_w = list.number("cmd_w", "rad/s");
  TextChannel solver_status = list.text("solver_status");
  NumberChannel tick_us = list.number("tick_us", "us");
  NumberChannel true_opening = list.number("true_opening", "rad or m");
  Group true_base = group({"true_base_x", "true_base_y"}, "m");
  NumberChannel true_base_yaw = list.number("true_base_yaw", "rad");
  Group true_hand = group({"true_hand_x", "true_hand_y", "true_hand_z"}, "m");
  Group true_handle = group({"true_handle_x", "true_handle_y", "true_handle_z"}, "m");
  Group true_dir = group({"true_dir_x", "true_dir_y", "true_dir_z"}, "");
  Group true_curv = group({"true_curv_x", "true_curv_y", "true_curv_z"}, "1/m");
  Group true_force = group({"true_force_x", "true_force_y", "true_force_z"}, "N");

  Group true_torque = group({"true_torque_x", "true_torque_y", "true_torque_z"}, "N m");
  Group true_hand_q = group({"true_hand_qw", "true_hand_qx", "true_hand_qy", "true_hand_qz"}, "");
  NumberChannel true_opening_rate = list.number("true_opening_rate", "rad/s or m/s");
  IntegerChannel true_grasped = list.integer("true_grasped", "");
  NumberChannel wanted_speed = list.number("wanted_speed", "m/s");
  NumberChannel speed_factor = list.number("speed_factor", "");
  NumberChannel hand_residual = list.number("hand_residual", "m/s");
  TextChannel binding_limit = list.text("binding_limit");
  NumberChannel base_ref_v = list.number("base_ref_v", "m/s");
  NumberChannel base_ref_w = list.number("base_ref_w", "rad/s");
  NumberChannel base_lag = list.number("base_lag", "m");
  NumberChannel clearance_min = list.number("clearance_min", "m");
  IntegerChannel cmd_gripper = list.integer("cmd_gripper", "");
  NumberChannel est_arc = list.number("est_arc", "m");
  NumberChannel est_angle = list.number("est_angle", "rad");
  NumberChannel est_angle_sigma = list.number("est_angle_sigma", "rad");
};

struct RunLog::Ticks {
  ChannelList list;
  NumberChannel time = list.number("time", "s");
  NumberChannel tick_us = list.number("tick_us", "us");
  LogRow row{list};
  CsvLog log;
  explicit Ticks(const std::filesystem::path& file) : log(file, list) {}
};

RunLog::RunLog(const std::filesystem::path& folder, int joints)
    : channels_(std::make_unique<Channels>(joints)),
      row_(std::make_unique<LogRow>(channels_->list)),
      log_(std::make_unique<CsvLog>(folder / "log.csv", channels_->list)),
      ticks_(std::make_unique<Ticks>(folder / "ticks.csv")) {}

RunLog::~RunLog() = default;

void RunLog::close() {
  log_->close();
  ticks_->log.close();
}

void RunLog::set(const Group& group, std::initializer_list<double> values) noexcept {
  auto channel = group.begin();
  for (const double value : values) row_->set(*channel++, value);
}

void RunLog::set_joints(const Group& group, const JointVector& values) noexcept {
  for (std::size_t i = 0; i < group.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    row_->set(group[i], index < values.size() ? values[index] : kNotApplicable);
  }
}

void RunLog::fill_measured(const RobotState& state) noexcept {
  const Channels& c = *channels_;
  row_->set(c.time, state.time);
  set(c.base, {state.base.x, state.base.y});
  row_->set(c.base_yaw, state.base.yaw);
  row_->set(c.base_v, state.base_v);
  row_->set(c.base_w, state.base_w);
  set_joints(c.q, state.q);
  set_joints(c.dq, state.dq);
  row_->set(c.gripper, state.gripper_opening);
}

void RunLog::fill_believed(const MissionRecord& record) noexcept {
  const Channels& c = *channels_;
  row_->set(c.phase, to_string(record.phase));
  row_->set(c.status, to_string(record.reason));
  const HandWrench& wrench = record.wrench;
  set(c.force, {wrench.force.x(), wrench.force.y(), wrench.force.z()});
  set(c.torque, {wrench.torque.x(), wrench.torque.y(), wrench.torque.z()});
  const Vector3d p = record.kinematics.X_WE.translation();
  const Eigen::Quaterniond turn(record.kinematics.X_WE.linear());
  set(c.hand, {p.x(), p.y(), p.z()});
  set(c.hand_q, {turn.w(), turn.x(), turn.y(), turn.z()});
  row_->set(c.distance, record.kinematics.distance);
  row_->set(c.heading_error, record.base.heading_error);
  row_->set(c.base_lag, record.base.lag);
  const MechanismEstimate& e = record.estimate;
  set(c.est_dir, {e.direction.x(), e.direction.y(), e.direction.z()});
  set(c.est_curv, {e.curvature.x(), e.curvature.y(), e.curvature.z()});
  row_->set(c.est_dir_sigma, e.direction_sigma);
  row_->set(c.est_curv_sigma, e.curvature_sigma);
  row_->set(c.est_type, name_of(e.type));
  row_->set(c.est_arc, e.arc);
  row_->set(c.est_angle, e.angle);
  row_->set(c.est_angle_sigma, e.angle_sigma);
  row_->set(c.clearance_min, record.clearance_min);
}

void RunLog::fill_commanded(const TickView& tick) noexcept {
  const Channels& c = *channels_;
  const MissionRecord& record = tick.record;
  const Vector6d& v = record.reference;
  set(c.ref_v, {v[0], v[1], v[2]});
  set(c.ref_w, {v[3], v[4], v[5]});
  set_joints(c.cmd_dq, tick.command.dq);
  row_->set(c.cmd_v, tick.command.base_v);
  row_->set(c.cmd_w, tick.command.base_w);
  row_->set(c.cmd_gripper, tick.command.gripper_closed ? 1 : 0);
  const WbcSolution& solution = record.solution;
  // Phases without the whole-body controller have no singular value; a zero would look like a singular arm.
  row_->set(c.sigma_min, solution.sigma_min > 0.0 ? solution.sigma_min : kNotApplicable);
  row_->set(c.solver_status, name_of(solution.status));
  row_->set(c.binding_limit, name_of(solution.binding));
  row_->set(c.speed_factor, solution.speed_factor);
  row_->set(c.hand_residual, solution.residual);
  row_->set(c.wanted_speed, record.wanted_speed);
  row_->set(c.base_ref_v, record.base.twist.v);
  row_->set(c.base_ref_w, record.base.twist.w);
  row_->set(c.tick_us, 0.0);  // measured times stand in ticks.csv
}

void RunLog::fill_truth(const Truth& truth) noexcept {
  const Channels& c = *channels_;
  const Vector3d hand = truth.hand.translation();
  const Eigen::Quaterniond turn(truth.hand.linear());
  set(c.true_hand_q, {turn.w(), turn.x(), turn.y(), turn.z()});
  row_->set(c.true_opening, truth.opening);
  row_->set(c.true_opening_rate, truth.opening_rate);
  set(c.true_base, {truth.base.x, truth.base.y});
  row_->set(c.true_base_yaw, truth.base.yaw);
  set(c.true_hand, {hand.x(), hand.y(), hand.z()});
  set(c.true_handle, {truth.handle.x(), truth.handle.y(), truth.handle.z()});
  set(c.true_dir, {truth.direction.x(), truth.direction.y(), truth.direction.z()});
  set(c.true_curv, {truth.curvature.x(), truth.curvature.y(), truth.curvature.z()});
  set(c.true_force, {truth.force.x(), truth.force.y(), truth.force.z()});
  set(c.true_torque, {truth.torque.x(), truth.torque.y(), truth.torque.z()});
  row_->set(c.true_grasped, truth.grasped ? 1 : 0);
}

void RunLog::record(const TickView& tick) noexcept {
  fill_measured(tick.state);
  fill_believed(tick.record);
  fill_commanded(tick);
  fill_truth(tick.truth);
  log_->record(*row_);
  ticks_->row.set(ticks_->time, tick.state.time);
  ticks_->row.set(ticks_->tick_us, tick.tick_us);
  ticks_->log.record(ticks_->row);
}

}  // namespace ajar
