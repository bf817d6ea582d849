/** Why a mission ended, in words for somebody who does not know the program. */

interface Reason {
  what: string;
  /** What one looks at to see it. */
  look?: string;
}

export const REASONS: Record<string, Reason> = {
  running: { what: "It had not ended when the record stops." },
  goal_reached: { what: "It opened as far as was wanted." },
  stop_felt: { what: "It was opened until an end stop was felt." },
  handle_unseen: { what: "The robot never saw a handle, so there was nothing it could take." },
  nothing_to_grip: { what: "The handle offers nothing that the fingers can close on." },
  unreachable: { what: "From no place on the floor does the arm reach the handle without touching something." },
  approach_blocked: { what: "The base never came to where it should stand.", look: "the path of the base from above" },
  grasp_missed: { what: "The fingers closed on nothing, three times in a row." },
  grasp_lost: {
    what: "The handle slipped out of the hand while it was pulled.",
    look: "the force on the handle just before, and the distance between hand and handle in the replay",
  },
  locked: {
    what: "The robot pushed and pulled in every direction up to its force limit, and nothing gave: it is locked or stuck.",
    look: "the force in phase probe",
  },
  opens_away: {
    what: "It gives when pushed, so it opens away from the robot, and the robot sees no doorway through which it could push it.",
    look: "the opening in phase probe",
  },
  needs_more_force: {
    what: "It moved, and then needed more force than the robot may use.",
    look: "the pull force against its limit",
  },
  stalled: {
    what: "It stands still although hardly any force acts: the robot could not find a motion that goes on.",
    look: "the speed along the mechanism and the speed factor",
  },
  clearance_stop: {
    what: "Going on would have brought the robot too close to itself, to the leaf or to the wall.",
    look: "the smallest distance and the 3-D view at that moment",
  },
  sensor_invalid: { what: "A sensor delivered something that is no number, so the robot stopped at once." },
  sensor_silent: { what: "The force sensor at the wrist fell silent, so the robot stopped at once." },
  base_blocked: {
    what: "The base was told to move and did not: its wheels are blocked or slip.",
    look: "commanded and measured speed of the base",
  },
  force_limit: {
    what: "A force or torque at the hand passed the limit at which the robot stops at once.",
    look: "the force on the handle at that moment",
  },
  time_limit: { what: "It took longer than the scenario allows.", look: "the phase bar: where the time went" },
  interrupted: { what: "Somebody stopped it." },
  claimed_but_not_open: {
    what: "The robot said that it had opened it, but truly it is not open far enough.",
    look: "the robot's belief of the opening beside the true one",
  },
  bad_input: { what: "The run could not begin: its input is unusable." },
  fault: { what: "The run ended by a fault of the program." },
};

export function reasonWords(reason: string | undefined): Reason {
  return REASONS[reason ?? ""] ?? { what: `It ended: ${reason ?? "unknown"}.` };
}

export const PHASES: Record<string, string> = {
  choose: "chooses where to stand and how to take the handle",
  approach: "drives up",
  reach: "brings the hand in front of the handle",
  zero: "zeroes the force sensor",
  grasp: "closes the fingers",
  probe: "feels which way it gives",
  open: "opens",
  regrasp: "lets go to take it in another way",
  release: "lets go",
  retreat: "drives back",
  done: "has finished",
  stopped: "stands",
};

export const phaseWords = (phase: string): string => PHASES[phase] ?? phase;
