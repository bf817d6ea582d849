#include "key.hpp"

namespace ajar::scenario {

namespace {

/// Names of Fault::Kind, in its order.
const std::vector<std::string> kFaultWords{"sensor_nan", "sensor_silent", "base_blocked",
                                           "grasp_lost", "door_locked",   "joint_nan"};

void bind_hinge(Section s, MechanismConfig& c) {
  s.number("radius_m", c.radius, {0.05, 3.0}, "m", "distance of the handle from the hinge axis, in the plane of the leaf");
  s.degrees("tilt_deg", c.tilt, {-90.0, 90.0},
            "turns the hinge axis about the outward normal from the vertical; 90 or -90 = horizontal");
  s.choice("side", c.side, {"left", "right"}, "hinge side as the robot sees it; for a flap right = below");
  s.degrees("travel_deg", c.travel, {1.0, 180.0}, "end stop on the open side");
}

void bind_slide(Section s, MechanismConfig& c) {
  s.vector("slide_direction", c.slide_direction, "-",
           "opening direction in the frame of the leaf: x right, y into the wall, z up; need not have length 1 but must not "
           "be zero");
  s.number("travel_m", c.travel, {0.01, 10.0}, "m", "end stop on the open side");
  s.number("front_width_m", c.front_width, {0.05, 3.0}, "m", "width of a drawer's front");
  s.number("front_height_m", c.front_height, {0.03, 3.0}, "m", "height of a drawer's front");
}

void bind_dynamics(Section s, MechanismConfig& c, bool hinge) {
  const std::string force = hinge ? "N m" : "N";
  const std::string per_unit = hinge ? "N m/rad" : "N/m";
  const std::string damping = hinge ? "N m s/rad" : "N s/m";
  s.number("mass_kg", c.mass, {0.0, 2000.0, true}, "kg", "moving mass");
  s.optional_number("inertia", c.inertia, {0.0, 5000.0, true}, {hinge ? "kg m²" : "kg"}, "slab",
                    "inertia about the axis; \"slab\" = of a leaf of that mass and size");
  s.number("coulomb", c.coulomb, kNotNegative, force, "sliding friction");
  s.number("breakaway", c.breakaway, {1.0, 20.0}, "-", "static over sliding friction");
  s.number("viscous", c.viscous, kNotNegative, damping, "viscous friction");
  s.number("stiffness", c.stiffness, kNotNegative, per_unit, "spring");
  if (hinge) {
    s.degrees("spring_reference_deg", c.spring_reference, kAny, "rest position of the spring");
  } else {
    s.number("spring_reference_m", c.spring_reference, kAny, "m", "rest position of the spring");
  }
  s.number("gravity_share", c.gravity_share, {-1.0, 1.0}, "-",
           "part of the weight that acts on the joint; 0 = counterbalanced, below 0 = lifted by its springs");
  s.integer("closer_size", c.closer_size, {0.0, 7.0},
            "door closer by its EN 1154 size; 0 = none, or as in [mechanism.closer]");
  Section closer = s.table("closer");
  closer.number("moment", c.closer.moment, kNotNegative, force, "closing moment or force when closed");
  closer.number("stiffness", c.closer.stiffness, kNotNegative, per_unit, "its increase with opening");
  closer.number("closing_damping", c.closer.closing_damping, kNotNegative, damping, "added to `viscous` while it closes");
  Section seal = s.table("seal");
  seal.number("force", c.seal.force, kNotNegative, force, "seal or catch when closed; fades linearly");
  if (hinge) {
    seal.degrees("range_deg", c.seal.range, {0.0, 360.0}, "where it has faded to nothing");
  } else {
    seal.number("range_m", c.seal.range, {0.0, 10.0}, "m", "where it has faded to nothing");
  }
}

void bind_described(Section s, MechanismConfig& c) {
  const bool hinge = c.type != "slide";
  s.required_word("type", c.type, {"hinge", "slide"}, "kind of joint");
  if (hinge) {
    bind_hinge(s, c);
  } else {
    bind_slide(s, c);
  }
  s.choice("sense", c.sense, {"pull", "push"}, "which way it opens, seen from the robot");
  s.vector("at_m", c.at, "m", "foot point of the handle on the plane of the wall, world");
  s.degrees("yaw_deg", c.yaw, {-360.0, 360.0}, "turns the wall about the vertical; 0 = its outward normal is world -y");
  s.number("handle_height_m", c.handle_height, {0.0, 2.5, true}, "m", "height of the handle");
  s.number("standoff_m", c.standoff, {0.0, 0.5, true}, "m",
           "face of the leaf to centre of the grip; 0 or less lies inside the wall");
  s.choice("handle", c.handle, {"bar", "knob", "recess", "none"}, "what one can hold; a recess cannot be gripped");
  s.choice("bar", c.bar, {"vertical", "horizontal"}, "how a bar is mounted");
  s.number("handle_thickness_m", c.handle_thickness, {0.0, 0.3}, "m", "thickness of what the fingers close on");
  s.number("handle_length_m", c.handle_length, {0.0, 3.0, true}, "m", "length of a bar");
  s.flag("walls", c.walls, "wall beside a door, cabinet body round a drawer");
  bind_dynamics(s, c, hinge);
}

void bind_plant(Section s, PlantConfig& c) {
  s.word("kind", c.kind, {"mujoco", "kinematic"},
         "rigid-body physics with contact, or exact kinematics with the same grasp and mechanism");
  s.number("time_step_s", c.time_step, {1e-5, 0.01}, "s", "step of the physics");
  Section grasp = s.table("grasp");
  grasp.number("stiffness", c.grasp.stiffness, {100.0, 1e6}, "N/m", "of fingers and handle");
  grasp.number("damping", c.grasp.damping, kNotNegative, "N s/m", "of fingers and handle");
  grasp.number("rotational_stiffness", c.grasp.rotational_stiffness, kNotNegative, "N m/rad", "of fingers and handle");
  grasp.flag("pivots", c.grasp.pivots, "the bar may turn in the fingers");
  grasp.number("slip_force_N", c.grasp.slip_force, kPositive, "N", "above it the grip creeps along the force");
  grasp.number("break_force_N", c.grasp.break_force, kPositive, "N", "above it the grip is lost");
  grasp.number("reach_tolerance_m", c.grasp.reach_tolerance, {0.0, 0.2, true}, "m",
               "closing succeeds within this distance of the grip's centre");
  Section wrist = s.table("wrist_sensor");
  wrist.number("force_bias_N", c.wrist_sensor.force_bias, kNotNegative, "N", "uniform per axis and run, ±");
  wrist.number("torque_bias_Nm", c.wrist_sensor.torque_bias, kNotNegative, "N m", "uniform per axis and run, ±");
  wrist.number("force_drift_N_s", c.wrist_sensor.force_drift, kNotNegative, "N/s",
               "standard deviation of the drift rate per axis");
  wrist.number("force_noise_N", c.wrist_sensor.force_noise, kNotNegative, "N", "white, per 2 ms sample");
  wrist.number("torque_noise_Nm", c.wrist_sensor.torque_noise, kNotNegative, "N m", "white, per 2 ms sample");
  wrist.number("tool_mass_error_kg", c.wrist_sensor.tool_mass_error, {-2.0, 10.0}, "kg",
               "true minus modelled mass of the tool");
  Section base = s.table("base");
  base.number("lag_s", c.base.lag, {0.0, 2.0}, "s", "first-order lag of the wheels");
  base.number("delay_s", c.base.delay, {0.0, 1.0}, "s", "transport delay of base commands");
  base.number("wheel_radius_error", c.base.wheel_radius_error, {0.0, 0.5}, "-",
              "relative error common to both wheels, uniform, ±");
  base.number("wheel_mismatch", c.base.wheel_mismatch, {0.0, 0.5}, "-", "relative difference of the wheels, uniform, ±");
  base.number("friction", c.base.friction, {0.0, 5.0, true}, "-", "wheel on floor");
  base.number("odometry_hz", c.base.odometry_rate, {0.0, 1e4}, "1/s",
              "readings of the wheels, in between the last one with its age; 0 = one in every control tick");
  Section arm = s.table("arm");
  arm.number("lag_s", c.arm.lag, {0.0, 1.0}, "s", "of the rate servo");
  arm.number("servo_gain", c.arm.servo_gain, {0.0, 100.0, true}, "-",
             "stiffness of the joint servos relative to the nominal one");
  arm.number("encoder_resolution", c.arm.encoder_resolution, {0.0, 0.1}, "rad", "of the joint encoders");
  Section sight = s.table("perception");
  sight.degrees("normal_error_deg", c.perception.normal_error, {-90.0, 90.0},
                "error of the seen normal of the leaf, about the vertical");
  sight.number("position_error_m", c.perception.position_error, {0.0, 0.5}, "m",
               "error of the seen handle, uniform per axis and run, ±");
  s.faults("fault", c.faults, "something that goes wrong on purpose; may stand several times");
}

}  // namespace

std::vector<Key> bind_fault(Fault& fault) {
  std::vector<Key> keys;
  Section s(keys, "plant.fault.");
  s.choice("kind", fault.kind, kFaultWords, "what goes wrong");
  keys.back().required = true;
  s.number("time_s", fault.time, kNotNegative, "s", "when it begins");
  return keys;
}

void bind_mechanism(Section s, MechanismSource& source) {
  switch (source.form) {
    case MechanismSource::Form::Described: bind_described(s, source.described); break;
    case MechanismSource::Form::Table:
      s.required_file("from", source.table, "door table (CSV), relative to the scenario file");
      s.required_word("id", source.id, {}, "its row");
      break;
    case MechanismSource::Form::Mjcf:
      s.required_file("mjcf", source.mjcf,
                      "MJCF model with the mechanism and its surroundings, relative to the scenario file");
      s.required_word("joint", source.joint, {}, "the joint to open");
      s.required_word("handle", source.handle_site, {}, "the site that marks the centre of the grip");
      break;
  }
}

const std::vector<std::string>& mechanism_names() {
  static const std::vector<std::string> names = [] {
    MechanismSource hinge;
    MechanismSource slide = with_type({}, "slide");
    MechanismSource table;
    MechanismSource mjcf;
    table.form = MechanismSource::Form::Table;
    mjcf.form = MechanismSource::Form::Mjcf;
    std::vector<Key> keys;
    for (MechanismSource* const source : {&hinge, &slide, &table, &mjcf})
      bind_mechanism(Section(keys, "mechanism."), *source);
    std::vector<std::string> out;
    out.reserve(keys.size());
    for (const Key& key : keys) out.push_back(key.name);
    return out;
  }();
  return names;
}

void bind_follow(Section s, FollowConfig& c) {
  s.vector("start_m", c.start, "m", "of the base, world");
  s.degrees("start_yaw_deg", c.start_yaw, {-360.0, 360.0}, "of the base, world");
  s.vector("parking_m", c.parking, "m", "of the base while the hand is at the handle, world");
  s.degrees("parking_yaw_deg", c.parking_yaw, {-360.0, 360.0}, "of the base while the hand is at the handle, world");
  s.number("speed", c.speed, {1e-3, 1.0}, "m/s", "of the hand along its path");
  s.number("feedback", c.feedback, {0.0, 20.0}, "1/s", "of the hand's pose; 0 = the constant twist in hand axes alone");
  s.flag("free_about_axis", c.free_about_axis,
         "the hand may turn about the mechanism's axis, as fingers do round the bar of a flap; controller qp only");
  s.numbers("posture", c.posture, {-10.0, 10.0}, {"rad"}, "seed of the arm's posture at the handle, one per joint");
}

void bind_world(Section top, Scenario& c) {
  Section belief = top.table("belief");
  belief.optional_number(
      "direction_error_deg", c.belief.direction_error, {0.0, 180.0}, {"°", kDegree}, "none",
      "error of the initial direction guess about a random axis; \"none\" = no guess at all: the robot probes");
  belief.fixed("curvature", 0.0, "1/m", "initial curvature guess; the robot is never told one");
  Section start = top.table("start");
  start.number("distance_m", c.start.distance, {0.3, 20.0}, "m", "from the handle, along its normal");
  start.number("sideways_m", c.start.sideways, {-20.0, 20.0}, "m",
               "across that, positive to the right of one who faces the handle");
  start.degrees("heading_error_deg", c.start.heading_error, {-180.0, 180.0}, "turned away from facing the handle");
  bind_plant(top.table("plant"), c.plant);
  Section control = top.table("control");
  control.rate("rate_hz", c.mission.period, {20.0, 1000.0}, "control ticks per second");
  control.milliseconds("delay_ms", c.mission.dead_time, {0.0, 500.0},
                       "transport delay of all measurements and commands together; the robot knows it");
  control.word("controller", c.mission.controller, {"qp", "thesis"},
               "bounded QP, or the corrected pseudo-inverse law of the thesis");
  Section goal = top.table("goal");
  goal.degrees("opening_deg", c.mission.goal.opening_angle, {0.0, 360.0, true}, "wanted opening of a hinge");
  goal.number("opening_m", c.mission.goal.opening_length, {0.0, 10.0, true}, "m", "wanted opening of a slide");
  goal.flag("to_the_stop", c.mission.goal.to_the_stop, "go on until an end stop is felt");
  Section limits = top.table("limits");
  limits.number("force_N", c.mission.limits.force, {0.0, 1000.0, true}, "N", "pull force at which opening is given up");
  limits.number("abort_force_N", c.mission.limits.abort_force, {0.0, 10000.0, true}, "N",
                "any force above it stops the robot at once");
  limits.number("abort_torque_Nm", c.mission.limits.abort_torque, {0.0, 1000.0, true}, "N m",
                "any torque at the hand above it stops the robot at once");
  limits.number("time_s", c.mission.limits.time, {0.0, 36000.0, true}, "s", "of the whole mission");
  limits.number("sensor_timeout_s", c.mission.limits.sensor_timeout, {0.0, 10.0, true}, "s",
                "age of a wrist reading that stops the robot");
  bind_control(control, c.mission);
  bind_follow(top.table("follow"), c.mission.follow);
}

void bind_top(Section top, Scenario& scenario) {
  top.word("robot", scenario.robot, {}, "a folder of robots/, or a path to a URDF with its .toml beside it");
  top.seed("seed", scenario.seed, "of everything random in the run");
  top.word("task", scenario.mission.task, {"open", "follow"},
           "opens the mechanism by touch, or moves the free hand along the mechanism's path as [follow] says");
}

std::vector<Key> bind_keys(Scenario& scenario) {
  std::vector<Key> keys;
  Section top(keys, "");
  bind_top(top, scenario);
  bind_mechanism(top.table("mechanism"), scenario.mechanism);
  bind_world(top, scenario);
  return keys;
}

Scenario default_scenario() {
  // What a person states in degrees starts from round degrees.
  Scenario scenario;
  scenario.mission.goal.opening_angle = 90.0 * kDegree;
  scenario.mission.planner.hinge_angle = 90.0 * kDegree;
  scenario.mission.planner.azimuths = {-20.0 * kDegree, 0.0, 20.0 * kDegree};
  scenario.mission.planner.passage_yaws = {30.0 * kDegree, 37.0 * kDegree, 45.0 * kDegree, 54.0 * kDegree, 63.0 * kDegree};
  scenario.mechanism.described.travel = 110.0 * kDegree;
  return scenario;
}

MechanismSource with_type(MechanismSource source, const std::string& type) {
  source.form = MechanismSource::Form::Described;
  source.described.type = type;
  if (type == "slide") {
    source.described.travel = 0.45;  // a common drawer
    source.described.coulomb = 5.0;  // a few newtons at the handle; 1 N m of a hinge is as light
    source.described.viscous = 5.0;
    source.described.mass = 8.0;
    source.described.handle_height = 0.75;
  }
  return source;
}

}  // namespace ajar::scenario
