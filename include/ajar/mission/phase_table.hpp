#pragma once

#include <array>

#include "ajar/mission/mission.hpp"

namespace ajar {

/// What happens to a mission.
enum class Event {
  Chosen,     ///< Grasp and base pose are chosen
  Arrived,    ///< The base stands at its pose
  NextPose,   ///< No good posture from here: another base pose is tried
  AtHandle,   ///< The hand waits in front of the handle
  Zeroed,     ///< The wrist sensor's bias is known
  Held,       ///< The fingers hold the handle and a direction is believed
  HeldBlind,  ///< The fingers hold the handle and no direction is known
  Missed,     ///< The fingers closed on nothing
  Found,      ///< Probing found what gives
  Blocked,    ///< Nothing moves: probe
  Rechoose,   ///< It gives another way than the grasp was chosen for: let go and choose again
  Ended,      ///< Goal, stop or a reason to give up: let go
  Clear,      ///< The hand has left the handle
  Holding,    ///< What was opened would shut onto the robot: it is kept in the hand
  Away,       ///< The base has left the mechanism
  GaveUp,     ///< Ends before the handle is held
  Fault       ///< Stop now
};
inline constexpr int kEventCount = 17;

/// One row of the mission's table.
struct Transition {
  Phase from;
  Event event;
  Phase to;
};

/// What follows what. Fault leads to Stopped from everywhere; a pair that is not listed changes nothing.
inline constexpr std::array kTransitions = {
    Transition{Phase::Choose, Event::Chosen, Phase::Approach},  Transition{Phase::Choose, Event::GaveUp, Phase::Stopped},
    Transition{Phase::Choose, Event::Ended, Phase::Retreat},    Transition{Phase::Approach, Event::Arrived, Phase::Reach},
    Transition{Phase::Approach, Event::GaveUp, Phase::Stopped}, Transition{Phase::Reach, Event::NextPose, Phase::Approach},
    Transition{Phase::Reach, Event::AtHandle, Phase::Zero},     Transition{Phase::Reach, Event::GaveUp, Phase::Stopped},
    Transition{Phase::Reach, Event::Ended, Phase::Retreat},     Transition{Phase::Zero, Event::Zeroed, Phase::Grasp},
    Transition{Phase::Grasp, Event::Held, Phase::Open},         Transition{Phase::Grasp, Event::HeldBlind, Phase::Probe},
    Transition{Phase::Grasp, Event::Missed, Phase::Reach},      Transition{Phase::Grasp, Event::GaveUp, Phase::Release},
    Transition{Phase::Probe, Event::Found, Phase::Open},        Transition{Phase::Probe, Event::Ended, Phase::Release},
    Transition{Phase::Open, Event::Blocked, Phase::Probe},      Transition{Phase::Open, Event::Ended, Phase::Release},
    Transition{Phase::Open, Event::Rechoose, Phase::Regrasp},   Transition{Phase::Regrasp, Event::Clear, Phase::Choose},
    Transition{Phase::Regrasp, Event::GaveUp, Phase::Stopped},  Transition{Phase::Release, Event::Clear, Phase::Retreat},
    Transition{Phase::Release, Event::Holding, Phase::Done},    Transition{Phase::Retreat, Event::Away, Phase::Done},
};

/// The phase that follows. No exception.
[[nodiscard]] constexpr Phase next_phase(Phase phase, Event event) noexcept {
  if (event == Event::Fault) return phase == Phase::Done ? Phase::Done : Phase::Stopped;
  for (const Transition& row : kTransitions) {
    if (row.from == phase && row.event == event) return row.to;
  }
  return phase;
}

}  // namespace ajar
