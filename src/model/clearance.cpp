// The only source that sees Coal.
#include "ajar/model/clearance.hpp"

#include <coal/narrowphase/gjk.h>
#include <coal/narrowphase/narrowphase_defaults.h>
#include <coal/shape/geometric_shapes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

namespace coal_steps = coal::details;
using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxInputs>;

// A hundred times what Coal's tolerance leaves of a distance of a metre.
constexpr double kDistanceError = 1e-4;  // [m]

// A collision body with both of Coal's shapes ready, of which `kind` says the one that is meant.
struct Body {
  CollisionShape::Kind kind = CollisionShape::Kind::Capsule;
  int shape = -1;  // index in RobotModel::shapes(), -1 for an obstacle
  int joint = -1;  // arm joint that moves it, -1 = the base
  bool finger = false;
  Pose pose_in_joint = Pose::Identity();
  Vector3d half_extents = Vector3d::Zero();  // box that encloses it, own axes [m]
  double reach = 0.0;                        // radius of the sphere that encloses it [m]
  coal::Capsule capsule{0.1, 0.1};
  coal::Box box{0.1, 0.1, 0.1};
  Pose pose = Pose::Identity();  // world
  double way = 0.0;              // that no point of it has exceeded since the beginning [m]
  coal::Transform3s placed;      // the same for Coal

  [[nodiscard]] const coal::ShapeBase& core() const {
    return kind == CollisionShape::Kind::Box ? static_cast<const coal::ShapeBase&>(box) : capsule;
  }

  // A point at r from the origin moves by |dp + dR r| <= sqrt(2 |dp|² + |dR|² r²). (docs/equations.md#clearance)
  void place(const Pose& X) {
    way += std::sqrt(2.0 * (X.translation() - pose.translation()).squaredNorm() +
                     reach * reach * (X.linear() - pose.linear()).squaredNorm());
    pose = X;
    placed.setRotation(X.linear());
    placed.setTranslation(X.translation());
  }
};

Body make_body(const CollisionShape& shape, int index) {
  Body body;
  body.kind = shape.kind;
  body.shape = index;
  body.joint = shape.joint;
  body.pose_in_joint = shape.pose_in_joint;
  if (shape.kind == CollisionShape::Kind::Box) {
    body.half_extents = shape.half_extents;
    body.box = coal::Box(2.0 * shape.half_extents);
    body.reach = shape.half_extents.norm();
  } else {
    body.half_extents = Vector3d(shape.radius, shape.radius, shape.radius + shape.half_length);
    body.capsule = coal::Capsule(shape.radius, 2.0 * shape.half_length);
    body.reach = shape.radius + shape.half_length;
  }
  return body;
}

// A lower bound of the distance: the point of `other`'s enclosing box nearest to the enclosing sphere of `body`.
double least_distance(const Body& body, const Body& other) {
  const Vector3d centre = other.pose.linear().transpose() * (body.pose.translation() - other.pose.translation());
  const Vector3d outside = (centre.cwiseAbs() - other.half_extents).cwiseMax(0.0);
  return outside.norm() - body.reach;
}

// What one pair says, before rows are made of it.
struct Found {
  double reserve = 0.0;   // distance - stop [m]
  double distance = 0.0;  // [m]
  ClearanceKind kind = ClearanceKind::Self;
  const Body* body = nullptr;
  const Body* other = nullptr;
  int obstacle = -1;
  Vector3d on_body = Vector3d::Zero();  // nearest points, world [m]
  Vector3d on_other = Vector3d::Zero();
  Vector3d normal = Vector3d::UnitZ();  // from other to body, unit, world
};

// The kMaxClearanceRows pairs with the least reserve, in order.
class Shortlist {
 public:
  void add(const Found& found) {
    if (count_ == kMaxClearanceRows && found.reserve >= items_[kMaxClearanceRows - 1].reserve) {
      return;
    }
    int place = count_ < kMaxClearanceRows ? count_++ : kMaxClearanceRows - 1;
    for (; place > 0 && items_[static_cast<std::size_t>(place - 1)].reserve > found.reserve; --place) {
      items_[static_cast<std::size_t>(place)] = items_[static_cast<std::size_t>(place - 1)];
    }
    items_[static_cast<std::size_t>(place)] = found;
  }
  void clear() { count_ = 0; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] const Found& operator[](int i) const { return items_[static_cast<std::size_t>(i)]; }

 private:
  std::array<Found, kMaxClearanceRows> items_;
  int count_ = 0;
};

void validate(const ClearanceLimits& limits, const std::string& name) {
  if (!(limits.influence > 0.0) || !std::isfinite(limits.influence)) {
    throw ConfigError("clearance." + name + ".influence: " + std::to_string(limits.influence) + "; allowed: > 0 [m]");
  }
  if (!(limits.stop >= 0.0) || !(limits.stop < limits.influence)) {
    throw ConfigError("clearance." + name + ".stop: " + std::to_string(limits.stop) + "; allowed: 0 to influence [m]");
  }
  if (!(limits.rate > 0.0) || !std::isfinite(limits.rate)) {
    throw ConfigError("clearance." + name + ".rate: " + std::to_string(limits.rate) + "; allowed: > 0 [1/s]");
  }
}

}  // namespace

struct ClearanceChecker::Impl {
  // Nearer than its influence only once the ways of both together have come to this [m].
  struct Pair {
    double clear_until = -1.0;
  };
  struct SelfPair : Pair {
    int body, other;  // indices in bodies
    SelfPair(int a, int b) : body(a), other(b) {}
  };
  struct Obstacle {
    bool active = false;
    MayTouch hand = MayTouch::Nothing;
    Body body;
    std::vector<Pair> pairs;  // with each of the bodies
  };

  ClearanceConfig config;
  bool fixed_base = false;
  int last_joint = 0;
  std::vector<Body> bodies;
  std::vector<SelfPair> self_pairs;
  std::array<Obstacle, kMaxObstacles> obstacles;
  // Coal's steps are called one by one: its solver object builds a message, and so allocates, at every call.
  coal_steps::MinkowskiDiff difference;
  coal_steps::GJK gjk{coal::GJK_DEFAULT_MAX_ITERATIONS, coal::GJK_DEFAULT_TOLERANCE};
  coal_steps::EPA epa{coal::EPA_DEFAULT_MAX_ITERATIONS, coal::EPA_DEFAULT_TOLERANCE};
  Shortlist shortlist;
  PointJacobian J_body, J_other;

  Impl(const RobotModel& model, const ClearanceConfig& c);
  void find_self_pairs(const RobotModel& model);
  void find_fingers(const RobotModel& model);
  void warm_up();
  [[nodiscard]] const ClearanceLimits& limits(ClearanceKind kind) const;
  bool place_robot(const RobotModel& model, const BasePose& base);
  double measure(Found& found);
  void look(const Body& body, const Body& other, ClearanceKind kind, int obstacle, Pair& pair, ClearanceResult& out);
  void write_row(const RobotModel& model, const BasePose& base, const Found& found, ClearanceRow& out);
};

ClearanceChecker::Impl::Impl(const RobotModel& model, const ClearanceConfig& c)
    : config(c), fixed_base(model.base_type() == BaseType::Fixed), last_joint(model.joints() - 1) {
  validate(config.self, "self");
  validate(config.arm_world, "arm_world");
  validate(config.base_world, "base_world");
  for (std::size_t i = 0; i < model.shapes().size(); ++i) {
    bodies.push_back(make_body(model.shapes()[i], static_cast<int>(i)));
  }
  for (Obstacle& obstacle : obstacles) {
    obstacle.body.kind = CollisionShape::Kind::Box;
    obstacle.pairs.resize(bodies.size());
  }
  gjk.setDistanceEarlyBreak(std::numeric_limits<double>::max());
  gjk.gjk_variant = coal::DefaultGJK;
  gjk.convergence_criterion = coal::Default;
  gjk.convergence_criterion_type = coal::Relative;
  find_self_pairs(model);
  find_fingers(model);
  warm_up();
}

// Fingers reach to the height of the tool centre point; wrist and palm end before it.
void ClearanceChecker::Impl::find_fingers(const RobotModel& model) {
  Kinematics kinematics;
  model.compute(BasePose{}, model.home(), kinematics);
  const Pose hand_in_joint = model.joint_pose(last_joint, BasePose{}).inverse(Eigen::Isometry) * kinematics.X_WE;
  for (Body& body : bodies) {
    const Pose X = hand_in_joint.inverse(Eigen::Isometry) * body.pose_in_joint;
    const double front = X.translation().z() + X.linear().row(2).cwiseAbs() * body.half_extents;
    body.finger = body.joint == last_joint && front > 0.0;
  }
}

// Own body: the upper arm and everything beyond against the boxes of the base (the first link always sits on its mount), and
// arm bodies at least two joints apart against each other.
void ClearanceChecker::Impl::find_self_pairs(const RobotModel& model) {
  const auto unchecked = [&](int a, int b) {
    return std::any_of(model.unchecked_pairs().begin(), model.unchecked_pairs().end(), [&](const std::array<int, 2>& pair) {
      return (pair[0] == a && pair[1] == b) || (pair[0] == b && pair[1] == a);
    });
  };
  for (int a = 0; a < static_cast<int>(bodies.size()); ++a) {
    for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
      const Body& body = bodies[static_cast<std::size_t>(a)];
      const Body& other = bodies[static_cast<std::size_t>(b)];
      const bool on_base = other.joint < 0 && other.kind == CollisionShape::Kind::Box && body.joint >= 1;
      const bool on_arm = other.joint >= 0 && body.joint - other.joint >= 2;
      if ((on_base || on_arm) && !unchecked(a, b)) {
        self_pairs.emplace_back(a, b);
      }
    }
  }
}

// Coal reserves the memory of its penetration algorithm at first use; the loop must not be the first.
void ClearanceChecker::Impl::warm_up() {
  Body capsule;
  Body box;
  box.kind = CollisionShape::Kind::Box;
  Found found;
  found.other = &box;
  for (const Body* body : {&capsule, &box}) {
    found.body = body;
    measure(found);
  }
}

const ClearanceLimits& ClearanceChecker::Impl::limits(ClearanceKind kind) const {
  return kind == ClearanceKind::Self ? config.self : kind == ClearanceKind::ArmWorld ? config.arm_world : config.base_world;
}

bool ClearanceChecker::Impl::place_robot(const RobotModel& model, const BasePose& base) {
  std::array<Pose, kMaxJoints + 1> X_WJ;  // the base first
  for (int j = -1; j <= last_joint; ++j) {
    Pose& X = X_WJ[static_cast<std::size_t>(j + 1)];
    X = model.joint_pose(j, base);
    if (!std::isfinite(X.translation().sum() + X.linear().sum())) {
      return false;
    }
  }
  for (Body& body : bodies) {
    body.place(X_WJ[static_cast<std::size_t>(body.joint + 1)] * body.pose_in_joint);
  }
  return true;
}

// Signed distance and nearest points of the pair: GJK, and EPA where the cores (segments, boxes) overlap. The normal is kept
// usable where both fail.
double ClearanceChecker::Impl::measure(Found& found) {
  const Body& a = *found.body;
  const Body& b = *found.other;
  // From b to a, in the axes of a: a search that begins there is sooner at the nearest points.
  coal::Vec3s guess = a.pose.linear().transpose() * (a.pose.translation() - b.pose.translation());
  if (!(guess.squaredNorm() > 1e-12)) guess = coal::Vec3s::UnitX();
  coal::Vec3s on_a, on_b, towards_b;  // in the axes of a
  difference.set<coal_steps::NoSweptSphere>(&a.core(), &b.core(), a.placed, b.placed);
  if (gjk.evaluate(difference, guess) == coal_steps::GJK::Collision) {
    epa.reset(coal::EPA_DEFAULT_MAX_ITERATIONS, coal::EPA_DEFAULT_TOLERANCE);
    epa.evaluate(gjk, -guess);
    found.distance = std::min(0.0, -epa.depth);
    epa.getWitnessPointsAndNormal(difference, on_a, on_b, towards_b);
  } else {
    found.distance = gjk.distance;
    gjk.getWitnessPointsAndNormal(difference, on_a, on_b, towards_b);
  }
  const Vector3d middle = a.pose * (0.5 * (on_a + on_b));
  found.normal = -(a.pose.linear() * towards_b);
  if (!middle.allFinite() || !std::isfinite(found.distance) || !(found.normal.squaredNorm() > 0.25)) {
    const Vector3d apart = a.pose.translation() - b.pose.translation();
    found.normal = apart.norm() > 1e-9 ? Vector3d(apart.normalized()) : Vector3d(Vector3d::UnitZ());
    found.on_body = a.pose.translation();
    found.on_other = b.pose.translation();
    found.distance = std::isfinite(found.distance) ? found.distance : 0.0;
    return found.distance;
  }
  found.on_body = middle + 0.5 * found.distance * found.normal;
  found.on_other = middle - 0.5 * found.distance * found.normal;
  return found.distance;
}

// A pair that is far need not be measured again before both bodies together have come the rest of the way.
// (docs/equations.md#clearance)
void ClearanceChecker::Impl::look(const Body& body, const Body& other, ClearanceKind kind, int obstacle, Pair& pair,
                                  ClearanceResult& out) {
  const double way = body.way + other.way;
  if (way < pair.clear_until) {
    return;
  }
  const double influence = limits(kind).influence;
  const double least = least_distance(body, other);
  pair.clear_until = way + least - influence - kDistanceError;
  if (least > influence) {
    return;
  }
  Found found;
  found.kind = kind;
  found.body = &body;
  found.other = &other;
  found.obstacle = obstacle;
  if (measure(found) > influence) {
    pair.clear_until = way + found.distance - influence - kDistanceError;
    return;
  }
  found.reserve = found.distance - limits(kind).stop;
  double& smallest = out.smallest[static_cast<std::size_t>(kind)];
  smallest = std::min(smallest, found.distance);
  if (!(fixed_base && kind == ClearanceKind::BaseWorld)) {  // nothing can be done about it: no row
    shortlist.add(found);
  }
}

void ClearanceChecker::Impl::write_row(const RobotModel& model, const BasePose& base, const Found& found,
                                       ClearanceRow& out) {
  model.point_jacobian(found.body->joint, found.on_body, base, J_body);
  out.row.noalias() = found.normal.transpose() * J_body;  // (1, n + 2)
  if (found.kind == ClearanceKind::Self) {
    if (found.other->joint >= 0) {
      model.point_jacobian(found.other->joint, found.on_other, base, J_other);
      out.row.noalias() -= found.normal.transpose() * J_other;
    }
    out.row.tail<2>().setZero();  // both bodies ride on the base
  }
  out.distance = found.distance;
  out.kind = found.kind;
  out.obstacle = found.obstacle;
  out.shape = found.body->shape;
  out.other_shape = found.other->shape;
  out.normal = found.normal;
  out.point_on_obstacle = found.on_other;
}

ClearanceChecker::ClearanceChecker(const RobotModel& model, const ClearanceConfig& config)
    : impl_(std::make_unique<Impl>(model, config)) {}
ClearanceChecker::ClearanceChecker(const ClearanceChecker& other) : impl_(std::make_unique<Impl>(*other.impl_)) {
  impl_->warm_up();
}
ClearanceChecker::~ClearanceChecker() = default;

void ClearanceChecker::set_obstacle(int index, const Box& box, MayTouch hand) noexcept {
  if (index < 0 || index >= kMaxObstacles) {
    return;
  }
  Impl::Obstacle& obstacle = impl_->obstacles[static_cast<std::size_t>(index)];
  obstacle.active = box.pose.matrix().allFinite() && box.half_extents.allFinite() && box.half_extents.minCoeff() > 0.0;
  obstacle.hand = hand;
  if (!obstacle.active) {
    return;
  }
  obstacle.body.way += (box.half_extents - obstacle.body.half_extents).norm();
  obstacle.body.half_extents = box.half_extents;
  obstacle.body.reach = box.half_extents.norm();
  obstacle.body.box.halfSide = box.half_extents;
  obstacle.body.place(box.pose);
}

void ClearanceChecker::clear_obstacle(int index) noexcept {
  if (index >= 0 && index < kMaxObstacles) {
    impl_->obstacles[static_cast<std::size_t>(index)].active = false;
  }
}

void ClearanceChecker::compute(const RobotModel& model, const BasePose& base, ClearanceResult& out) noexcept {
  Impl& m = *impl_;
  out.count = 0;
  out.smallest.fill(std::numeric_limits<double>::infinity());
  if (!model.evaluated() || !m.place_robot(model, base)) {
    out.smallest.fill(0.0);
    return;
  }
  m.shortlist.clear();
  for (Impl::SelfPair& pair : m.self_pairs) {
    m.look(m.bodies[static_cast<std::size_t>(pair.body)], m.bodies[static_cast<std::size_t>(pair.other)],
           ClearanceKind::Self, -1, pair, out);
  }
  for (int i = 0; i < kMaxObstacles; ++i) {
    Impl::Obstacle& obstacle = m.obstacles[static_cast<std::size_t>(i)];
    for (std::size_t b = 0; obstacle.active && b < m.bodies.size(); ++b) {
      const Body& body = m.bodies[b];
      const bool exempt = body.joint == m.last_joint &&
                          (obstacle.hand == MayTouch::Hand || (obstacle.hand == MayTouch::Fingers && body.finger));
      if (!exempt) {
        m.look(body, obstacle.body, body.joint < 0 ? ClearanceKind::BaseWorld : ClearanceKind::ArmWorld, i,
               obstacle.pairs[b], out);
      }
    }
  }
  for (; out.count < m.shortlist.count(); ++out.count) {
    m.write_row(model, base, m.shortlist[out.count], out.rows[static_cast<std::size_t>(out.count)]);
  }
}

}  // namespace ajar
