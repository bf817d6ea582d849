/** Which curves the page shows, in which unit, with which limits. */
import type { Run, RunJson } from "./run";

export interface Curve {
  key: string;
  label: string;
  colour: string;
  dashed?: boolean;
  digits?: number;
  /** Column with the half width of a band around the curve, or its height above zero. */
  band?: string;
  bandFromZero?: boolean;
}

export interface PlotDefinition {
  title: string;
  unit: string;
  curves: Curve[];
  /** Values that the axis always shows. */
  include?: number[];
  /** Limits, dashed; the axis reaches them only when the curve comes near. */
  limits?: number[];
  /** Leaves the outermost percent of the values out of the axis range. */
  robust?: boolean;
  /** Logarithmic axis. */
  log?: boolean;
}

function joints(run: Run): Curve[] {
  const names = run.json.scene?.robot?.joint_names ?? [];
  return Array.from({ length: run.json.joints }, (_, i) => ({
    key: `dq${i + 1}`,
    label: (names[i] ?? `q${i + 1}`).replace(/_joint$/, "").replace(/_/g, " "),
    colour: `--c${(i % 8) + 1}`,
  }));
}

const both = (values: number[]): number[] => [...new Set(values.filter(Number.isFinite).flatMap((v) => [v, -v]))];

/** What one wants to see of the mechanism: opening, force, belief. */
function mechanismPlots({ slide, scene }: RunJson): PlotDefinition[] {
  const digits = slide ? 3 : 1;
  const mission = scene?.mission;
  const goal = mission === undefined ? [] : [slide ? mission.goal : (mission.goal * 180) / Math.PI];
  return [
    {
      title: "Opening",
      unit: slide ? "m" : "°",
      include: [0],
      limits: goal,
      curves: [
        { key: "opening", label: "true", colour: "--truth", digits },
        { key: "opening_estimated", label: "believed", colour: "--c1", dashed: true, digits, band: "opening_2sigma" },
      ],
    },
    {
      title: "Force on the handle, mean of 20 ms",
      unit: "N",
      include: [0],
      limits: mission === undefined ? [] : [mission.force_limit_N],
      curves: [
        { key: "normal_true", label: "normal, true", colour: "--bad", digits: 1 },
        { key: "pull_true", label: "pull, true", colour: "--c2", digits: 1 },
        { key: "normal_measured", label: "normal, measured", colour: "--c6", dashed: true, digits: 1 },
        { key: "pull_measured", label: "pull, measured", colour: "--c5", dashed: true, digits: 1 },
      ],
    },
    {
      title: "Error of the believed direction",
      unit: "°",
      include: [0],
      robust: true,
      curves: [
        {
          key: "direction_error",
          label: "true error",
          colour: "--c1",
          digits: 1,
          band: "direction_2sigma",
          bandFromZero: true,
        },
      ],
    },
    {
      title: "Curvature of the path",
      unit: "1/m",
      include: [0],
      robust: true,
      curves: [
        { key: "curvature_true", label: "true", colour: "--truth", digits: 3 },
        { key: "curvature_estimated", label: "believed", colour: "--c3", dashed: true, digits: 3, band: "curvature_2sigma" },
      ],
    },
  ];
}

/** What one wants to see of base and arm. */
function robotPlots(run: Run): PlotDefinition[] {
  const robot = run.json.scene?.robot;
  return [
    {
      title: "Distance from base to hand",
      unit: "m",
      curves: [{ key: "distance", label: "distance", colour: "--c3", digits: 3 }],
    },
    {
      title: "Heading error of the base",
      unit: "°",
      include: [0],
      robust: true,
      curves: [{ key: "heading_error", label: "heading error", colour: "--c4", digits: 1 }],
    },
    {
      title: "Joint rates, commanded",
      unit: "rad/s",
      include: [0],
      limits: both(robot?.joint_rate_limit ?? []),
      curves: joints(run),
    },
    {
      title: "Base, forward",
      unit: "m/s",
      include: [0],
      limits: robot === undefined ? [] : [robot.base_forward, -robot.base_reverse],
      curves: [
        { key: "cmd_v", label: "commanded", colour: "--c1", digits: 3 },
        { key: "base_v", label: "measured", colour: "--c2", dashed: true, digits: 3 },
      ],
    },
    {
      title: "Base, turning",
      unit: "rad/s",
      include: [0],
      limits: robot === undefined ? [] : [robot.base_yaw_rate, -robot.base_yaw_rate],
      curves: [
        { key: "cmd_w", label: "commanded", colour: "--c1", digits: 3 },
        { key: "base_w", label: "measured", colour: "--c2", dashed: true, digits: 3 },
      ],
    },
  ];
}

/** What one wants to see of the controller. */
function controlPlots({ scene }: RunJson): PlotDefinition[] {
  const mission = scene?.mission;
  return [
    {
      title: "Speed along the mechanism",
      unit: "m/s",
      include: [0],
      curves: [
        { key: "true_speed", label: "true", colour: "--truth", digits: 3 },
        { key: "wanted_speed", label: "wanted", colour: "--c1", dashed: true, digits: 3 },
      ],
    },
    {
      title: "Smallest singular value of the arm, speed factor",
      unit: "",
      include: [0],
      curves: [
        { key: "sigma_min", label: "σ min", colour: "--c6", digits: 3 },
        { key: "speed_factor", label: "speed factor", colour: "--c5", dashed: true },
      ],
    },
    {
      title: "Smallest distance that the robot believes in",
      unit: "m",
      include: [0],
      robust: true,
      curves: [{ key: "clearance_min", label: "distance", colour: "--c7", digits: 3 }],
    },
    {
      title: "Time of a control tick",
      unit: "µs",
      log: true,
      limits: mission === undefined ? [] : [mission.period_s * 1e6],
      curves: [{ key: "tick_us", label: "tick", colour: "--c8", digits: 0 }],
    },
  ];
}

export function plotList(run: Run): PlotDefinition[] {
  return [...mechanismPlots(run.json), ...robotPlots(run), ...controlPlots(run.json)];
}
