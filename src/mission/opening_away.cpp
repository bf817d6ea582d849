#include <cmath>

#include "mission_impl.hpp"

namespace ajar {
namespace {

constexpr double kAwayArc = 0.04;     // a direction this far travelled is felt, not guessed [m]
constexpr double kAwayCosine = -0.5;  // more into the wall than along it
constexpr double kFeelArc = 0.14;     // travel after which the hinge's side is felt, whatever it looked like [m]
constexpr double kSideSigmas = 3.0;   // curvature over its deviation that tells the side

constexpr double kPivotArc = 0.08;    // travel from which a radius is believed against the seen frame [m]
constexpr double kPivotSigmas = 2.0;  // by which it must contradict it: the stated deviation has a floor of a tenth

}  // namespace

// The sights so far, less what touch has shown the camera to misread.
HandleBelief Mission::Impl::seen() const noexcept { return turned_about_handle(sights.belief(), misreading); }

// A leaf that gives away from the robot: where a doorway is seen it is pushed, once the side of its hinge is felt.
bool Mission::Impl::found_to_open_away(EndDetector::Verdict verdict) noexcept {
  const MechanismEstimate& e = record.estimate;
  // What the leaf has moved altogether counts as well: probing and starting anew begin the estimate anew.
  const Vector3d moved = record.kinematics.X_WE.translation() - taken_at.translation();
  const bool known = e.fitted && e.arc > kAwayArc;
  const bool away = known ? e.direction.dot(handle.normal) < kAwayCosine : moved.dot(handle.normal) < -kAwayArc;
  if (!away || handle.passage || handle.press) return false;
  if (!handle.doorway) {
    process(Event::Ended, EndReason::OpensAway);
    return true;
  }
  const HingeSide turns = e.curvature.z() < 0.0 ? HingeSide::Right : HingeSide::Left;
  const HingeSide side = known ? turns : likely_side(handle);
  const bool sure = known && std::abs(e.curvature.z()) > kSideSigmas * e.curvature_sigma && side == likely_side(handle);
  if (!sure && e.arc < kFeelArc && verdict == EndDetector::Verdict::Going) return false;
  felt_side = side;
  if (const std::optional<Passage> passage = make_passage(handle, side)) {
    // A chord points as the path does at its middle.
    misreading = known ? felt_misreading(handle, *passage, e.direction, e.arc)
                       : felt_misreading(handle, *passage, moved, 0.5 * moved.norm());
  }
  probes = 0;
  process(Event::Rechoose);
  return true;
}

// A leaf that turns about an axis within its width is pushed anew, beside what swings back: while nothing of the base is
// between leaf and frame there is room to go back.
bool Mission::Impl::found_to_pivot(EndDetector::Verdict verdict) noexcept {
  const MechanismEstimate& e = record.estimate;
  if (!handle.passage || handle.passage->overhang > 0.0 || verdict != EndDetector::Verdict::Going) return false;
  if (!e.fitted || e.type != MechanismType::Hinge || e.arc < kPivotArc || e.arc > kFeelArc) return false;
  const double felt_more = std::abs(e.curvature.z()) - passage_curvature(handle, *handle.passage).norm();
  if (felt_more < kPivotSigmas * e.curvature_sigma) return false;
  const double radius = 1.0 / std::abs(e.curvature.z());
  const std::optional<Passage> pivot = pivot_passage(handle, *handle.passage, radius);
  if (!pivot) return false;
  felt_radius = radius;
  misreading += felt_misreading(handle, *pivot, e.direction, e.arc);
  process(Event::Rechoose);
  return true;
}

}  // namespace ajar
