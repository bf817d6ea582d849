// Gains of the controller. Keys without a unit in their name are in SI units; each bound is that of the law that uses the
// value.
#include "key.hpp"

namespace ajar::scenario {

namespace {

void bind(Section s, ForceLawConfig& c) {
  s.number("stability_number", c.stability_number, {0.0, 1.5, true}, "-",
           "force-loop gain times stiffness times delay; the limit of stability is π/2");
  s.number("total_stiffness", c.total_stiffness, kPositive, "N/m",
           "of arm, servo and grasp in series, as the robot believes");
  s.number("gain_max", c.gain_max, kPositive, "m/(N s)", "upper bound of the force-loop gain");
  s.number("integral_ratio", c.integral_ratio, kNotNegative, "1/s", "integral over proportional gain");
  s.number("correction_max", c.correction_max, kPositive, "m/s", "largest correction velocity");
  s.number("deadband", c.deadband, kNotNegative, "N", "subtracted from the normal force");
  s.number("torque_gain", c.torque_gain, kNotNegative, "rad/(N m s)", "upper bound of the gain of the torque nulling");
  s.number("rotational_stiffness", c.rotational_stiffness, kPositive, "N m/rad", "of the grasp, as the robot believes");
  s.number("turn_max", c.turn_max, kPositive, "rad/s", "largest correction turn");
  s.number("start_force", c.start_force, kPositive, "N", "force that the pull may reach while the direction is unsure");
  s.number("speed_start", c.speed_start, kPositive, "m/s", "along the mechanism until the estimate is sure");
  s.number("speed", c.speed, kPositive, "m/s", "cruise along the mechanism");
  s.number("acceleration", c.acceleration, kPositive, "m/s²", "of the tangential speed");
  s.number("deceleration", c.deceleration, kPositive, "m/s²", "of the tangential speed");
  s.number("give_gain", c.give_gain, kNotNegative, "m/(N s)", "tangential give");
  s.number("give_margin", c.give_margin, kNotNegative, "N", "above the running force the hand gives way");
  s.number("give_reserve", c.give_reserve, kNotNegative, "N", "below the force limit the hand gives way");
  s.number("give_speed", c.give_speed, kNotNegative, "m/s", "largest backward speed of the give");
}

void bind(Section s, EstimatorConfig& c) {
  s.number("grasp_stiffness", c.grasp_stiffness, kPositive, "N/m", "of the elastic correction, as the robot believes");
  s.number("bandwidth", c.bandwidth, kPositive, "1/s", "of the adaptive law");
  s.number("damping_ratio", c.damping_ratio, kPositive, "-", "of the adaptive law");
  s.number("curvature_leak", c.curvature_leak, kNotNegative, "1/s", "decay of the curvature along the path");
  s.number("still_speed", c.still_speed, kPositive, "m/s", "below it the hand counts as still");
  s.number("stuck_turn_rate", c.stuck_turn_rate, kNotNegative, "rad/s",
           "largest rate at which a reaction force turns the guess of a stuck handle");
  s.number("slide_curvature", c.slide_curvature, kPositive, "1/m", "largest curvature that still counts as a slide");
  s.number("hinge_curvature", c.hinge_curvature, kPositive, "1/m", "smallest curvature that counts as a hinge");
  s.number("type_threshold", c.type_threshold, kPositive, "-", "evidence that the decision for a hinge needs");
  s.number("slide_threshold", c.slide_threshold, kPositive, "-", "evidence that the decision for a slide needs");
  s.number("relative_curvature_floor", c.relative_curvature_floor, kNotNegative, "-",
           "furniture is no circle: least relative sigma of the curvature");
  s.flag("use_rotation", c.use_rotation, "false: the grip is known to pivot, positions only");
  Section noise = s.table("noise");
  noise.number("position_white", c.noise.position_white, kPositive, "m", "per sample");
  noise.number("position_correlated", c.noise.position_correlated, kNotNegative, "m", "correlated along the path");
  noise.number("rotation_white", c.noise.rotation_white, kPositive, "rad", "per sample");
  noise.number("rotation_correlated", c.noise.rotation_correlated, kNotNegative, "rad", "correlated along the path");
  noise.number("correlation_length", c.noise.correlation_length, kPositive, "m", "of arc");
  noise.number("position_walk", c.noise.position_walk, kNotNegative, "m²/m", "variance per metre of base travel");
  noise.number("rotation_walk", c.noise.rotation_walk, kNotNegative, "rad²/m", "variance per metre of base travel");
}

void bind(Section s, WbcConfig& c) {
  s.number("hand_weight", c.hand_weight, kPositive, "-", "weight of the hand twist");
  s.number("speed_weight", c.speed_weight, kPositive, "-", "weight of the tangential speed factor");
  s.number("base_speed_weight", c.base_speed_weight, kNotNegative, "s²/m²", "weight of the wanted base speed");
  s.number("base_turn_weight", c.base_turn_weight, kNotNegative, "s²/rad²", "weight of the wanted base turning");
  s.number("rate_weight", c.rate_weight, kPositive, "-", "weight of the joint rates, each over its limit");
  s.number("slack_weight", c.slack_weight, kPositive, "-", "weight of the slack of the clearance rows");
  s.number("length", c.length, kPositive, "m", "scale of the rotation rows");
  s.number("singular_onset", c.singular_onset, kPositive, "-", "smallest singular value below which joint rates are damped");
  s.number("singular_damping", c.singular_damping, kNotNegative, "-", "damping at a singular arm");
  s.number("free_axis_weight", c.free_axis_weight, kNotNegative, "-", "weight of the turn about a free grip axis");
  s.number("rate_scale", c.rate_scale, {0.0, 1.0, true}, "-", "joint rates used, share of the limit");
  s.number("joint_acceleration", c.joint_acceleration, kPositive, "rad/s²", "upper bound on the model's own limit");
  s.number("base_forward", c.base_forward, kPositive, "m/s", "largest forward speed while the hand works");
  s.number("base_reverse", c.base_reverse, kPositive, "m/s", "largest backward speed while the hand works");
  s.number("base_yaw_rate", c.base_yaw_rate, kPositive, "rad/s", "largest turning rate while the hand works");
  s.number("base_acceleration", c.base_acceleration, kPositive, "m/s²", "of the base while the hand works");
  s.number("base_yaw_acceleration", c.base_yaw_acceleration, kPositive, "rad/s²", "of the base while the hand works");
  s.number("base_braking", c.base_braking, Range{1.0, 100.0, false}, "", "how many times faster the base may brake");
  s.number("position_margin", c.position_margin, kNotNegative, "rad", "kept from each joint limit");
}

void bind(Section s, ThesisConfig& c) {
  s.number("w_base", c.w_base, kPositive, "-", "weight of the base inputs, joints have 1");
  s.number("lambda_max", c.lambda_max, {0.0, 10.0}, "m/s", "damping at a singularity");
  s.number("epsilon", c.epsilon, {0.0, 10.0, true}, "m/s", "smallest weighted singular value below which damping starts");
  s.number("alpha1", c.alpha1, {0.0, 1000.0}, "1/s", "gain of the distance task");
  s.number("alpha2", c.alpha2, {0.0, 1000.0}, "1/s", "gain of the heading task");
  s.number("alpha3", c.alpha3, {0.0, 1000.0}, "1/s²", "integral gain of the heading task, without feed-forward");
  s.number("distance", c.distance, {0.1, 5.0}, "m", "wanted between hand and base");
  s.flag("feed_forward", c.feed_forward, "turning rate of the motion instead of the integral");
  s.number("integral_max", c.integral_max, {0.0, 100.0}, "rad s", "bound of the integral of the heading error");
  s.word("heading", c.heading, {"signed", "folded"}, "heading error modulo a half turn: with hysteresis, or the nearer one");
  s.word("limits", c.limits, {"common", "each"},
         "one common factor keeps the path, or every input is clipped by itself as the thesis did");
  s.number("constant_damping", c.constant_damping, {0.0, 10.0}, "-",
           "damping of the inverse everywhere, as in the thesis's code; 0 = only near a singularity");
  s.flag("unit_weights", c.unit_weights, "inputs unweighted, as in the thesis's code");
  s.flag("printed", c.printed, "equations with the errors of the print, to show what they do");
}

void bind(Section s, DriveConfig& c) {
  s.number("arm_lag_s", c.arm_lag, {0.0, 1.0}, "s", "of the joint servos, as the robot believes");
  s.number("base_lag_s", c.base_lag, {0.0, 2.0}, "s", "of the wheels, as the robot believes");
  s.number("base_delay_s", c.base_delay, {0.0, 1.0}, "s",
           "transport delay of base commands beyond delay_ms, as the robot believes");
}

void bind(Section s, BaseLawConfig& c) {
  s.word("kind", c.kind, {"corotating", "distance", "line"}, "a pose that turns with the mechanism, or the thesis's laws");
  s.number("gain_along", c.gain_along, kPositive, "1/s", "along the wanted pose");
  s.number("gain_across", c.gain_across, kNotNegative, "1/m²", "across the wanted pose");
  s.number("gain_heading", c.gain_heading, kPositive, "1/s", "towards the wanted heading");
  s.number("full_curvature", c.full_curvature, kPositive, "1/m", "curvature up to which the base follows the whole turning");
  s.number("least_share", c.least_share, kShare, "-", "smallest share of the turning");
  s.number("distance", c.distance, kPositive, "m", "wanted distance hand - base of \"distance\" and \"line\"");
  s.number("gain_distance", c.gain_distance, kNotNegative, "1/s", "of \"distance\" and \"line\"");
  s.number("gain_heading_distance", c.gain_heading_distance, kNotNegative, "1/s", "of \"distance\" and \"line\"");
}

void bind(Section s, NavigationConfig& c) {
  s.word("law", c.law, {"graceful", "polar", "thesis"},
         "how the base drives to its place; thesis = the polar law with any gains");
  s.flag("printed", c.printed, "polar law with the bearing as printed, to show that it drives away");
  s.number("k_rho", c.k_rho, kPositive, "1/s", "polar law");
  s.number("k_gamma", c.k_gamma, kPositive, "1/s", "polar law; above 2 k_rho");
  s.number("k_delta", c.k_delta, kPositive, "-", "polar law; above k_gamma / k_rho - 1");
  s.number("k_phi", c.k_phi, kPositive, "-", "graceful law");
  s.number("k_turn", c.k_turn, kPositive, "-", "graceful law");
  s.number("beta", c.beta, kNotNegative, "-", "graceful law: slowing in curves");
  s.number("lambda", c.lambda, kPositive, "-", "graceful law: its exponent");
  s.number("slow_radius", c.slow_radius, kPositive, "m", "graceful law: slows down inside");
  s.number("v_max", c.v_max, kPositive, "m/s", "largest speed");
  s.number("v_reverse", c.v_reverse, kPositive, "m/s", "largest backward speed");
  s.number("w_max", c.w_max, kPositive, "rad/s", "largest turning rate");
  s.number("acceleration", c.acceleration, kPositive, "m/s²", "of the base");
  s.number("yaw_acceleration", c.yaw_acceleration, kPositive, "rad/s²", "of the base");
  s.number("k_final", c.k_final, kPositive, "1/s", "heading gain of the terminal turn");
  s.number("max_curvature", c.max_curvature, kPositive, "1/m", "sharpest curve of the driven path");
  s.number("position_tolerance", c.position_tolerance, kPositive, "m", "arrived within");
  s.number("heading_tolerance", c.heading_tolerance, kPositive, "rad", "arrived within");
}

void bind(Section s, PlannerConfig& c) {
  s.numbers("hinge_radii_m", c.hinge_radii, {0.05, 3.0}, {"m"}, "radii tried for both hinge sides");
  s.degrees("hinge_angle_deg", c.hinge_angle, {1.0, 360.0}, "opening that each hinge roll-out must reach");
  s.number("drawer_travel_m", c.drawer_travel, kPositive, "m", "travel that a drawer roll-out must reach");
  s.number("sliding_travel_m", c.sliding_travel, kPositive, "m", "the same sideways");
  s.number("flap_radius_m", c.flap_radius, kPositive, "m", "radius tried for a hinge below or above");
  s.numbers("distances_m", c.distances, {0.1, 3.0}, {"m"}, "base - handle, tried");
  s.numbers("passage_distances_m", c.passage_distances, {0.1, 3.0}, {"m"}, "the same along a doorway to push through");
  s.numbers("passage_yaws_deg", c.passage_yaws, {-180.0, 180.0}, {"°", kDegree},
            "hand turned towards the hinge before a push, tried");
  s.numbers("azimuths_deg", c.azimuths, {-90.0, 90.0}, {"°", kDegree},
            "of the base round the handle from its normal, tried");
  s.integer("headings", c.headings, {1.0, 360.0}, "base headings tried per place");
  s.integer("ik_starts", c.ik_starts, {1.0, 1000.0}, "random arm postures tried per place and hand roll");
  s.integer("roll_outs", c.roll_outs, {1.0, 10000.0}, "candidates rolled out");
  s.integer("kept", c.kept, {1.0, 1000.0}, "candidates handed over, and checked with disturbed placements");
  s.number("step_s", c.step, {0.001, 0.1}, "s", "time step of a roll-out");
  s.number("speed", c.speed, kPositive, "m/s", "cruise of a roll-out along the mechanism");
  s.number("least_sigma", c.least_sigma, kNotNegative, "-", "smallest singular value of a candidate at the grasp");
  s.number("own_clearance_m", c.own_clearance, kNotNegative, "m", "distance of a candidate to itself at the grasp");
  s.number("wall_clearance_m", c.wall_clearance, kNotNegative, "m", "of the base where it stands, to the believed wall");
  s.number("approach_distance_m", c.approach_distance, {0.0, 1.0, true}, "m",
           "the hand waits this far in front of the handle");
}

void bind(Section s, ClearanceLimits& c, const std::string& what) {
  s.number("influence", c.influence, kPositive, "m", what + ": farther pairs are ignored");
  s.number("stop", c.stop, kNotNegative, "m", what + ": distance to keep");
  s.number("rate", c.rate, kPositive, "1/s", what + ": approach speed per metre of reserve");
}

}  // namespace

void bind_control(Section s, MissionConfig& mission) {
  bind(s.table("drives"), mission.drives);
  bind(s.table("force"), mission.force);
  bind(s.table("estimator"), mission.estimator);
  bind(s.table("wbc"), mission.wbc);
  bind(s.table("thesis"), mission.thesis);
  bind(s.table("base_law"), mission.base_law);
  bind(s.table("navigation"), mission.navigation);
  bind(s.table("planner"), mission.planner);
  bind(s.table("clearance").table("self"), mission.clearance.self, "robot to itself");
  bind(s.table("clearance").table("arm_world"), mission.clearance.arm_world, "arm to the world");
  bind(s.table("clearance").table("base_world"), mission.clearance.base_world, "base to the world");
}

}  // namespace ajar::scenario
