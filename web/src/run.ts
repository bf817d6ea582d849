/** A run as the page has it: what report.cpp wrote, unpacked. */
import { unpackColumns } from "./unpack";

export interface PoseJson {
  position: [number, number, number];
  turn: { w: number; x: number; y: number; z: number };
}

export interface BoxJson {
  centre: [number, number, number];
  axes: [number, number, number][];
  half_extents: [number, number, number];
}

export interface ShapeJson {
  kind: "box" | "cylinder" | "sphere" | "capsule";
  joint: number;
  pose: PoseJson;
  size: [number, number, number];
  rgba: [number, number, number, number];
}

export interface DrawingJson {
  joints: { slides: boolean; axis: [number, number, number]; pose: PoseJson }[];
  shapes: ShapeJson[];
  hand: PoseJson;
}

export interface MechanismJson {
  name: string;
  type: "hinge" | "slide";
  axis: [number, number, number];
  point: [number, number, number];
  travel: number;
  handle: [number, number, number];
  normal: [number, number, number];
  handle_kind?: string;
  handle_bar?: [number, number, number];
  handle_standoff?: number;
  handle_thickness?: number;
  handle_length?: number;
  leaf: BoxJson[];
  world: BoxJson[];
}

export interface SceneJson {
  robot?: {
    name: string;
    footprint_m: [number, number, number, number] | null;
    joint_names: string[];
    joint_rate_limit: number[];
    base_forward: number;
    base_reverse: number;
    base_yaw_rate: number;
    drawing?: DrawingJson;
  };
  mechanism?: MechanismJson;
  mission?: {
    goal: number;
    to_the_stop: boolean;
    force_limit_N: number;
    abort_force_N: number;
    time_limit_s: number;
    period_s: number;
  };
}

export interface ContactJson {
  time: number;
  bodies: string;
  force_N: number;
}

export type ResultJson = Record<string, unknown> & {
  outcome?: string;
  phase?: string;
  reason?: string;
  explanation?: string;
  notes?: string[];
  unwanted_contacts?: ContactJson[];
};

export interface RunJson {
  name: string;
  result: ResultJson | null;
  scene: SceneJson | null;
  scenario: string;
  slide: boolean;
  cut_off: boolean;
  joints: number;
  rows: number;
  log_rows: number;
  phase_names: string[];
  columns: string[];
  data: string;
}

/** A stretch of time in one phase. */
export interface Segment {
  phase: string;
  from: number;
  to: number;
}

export class Run {
  readonly columns = new Map<string, Float32Array>();
  /** Rows that hold values; columns may be longer while a run goes on. */
  rows = 0;
  private growing = false;
  segments: Segment[] = [];

  constructor(readonly json: RunJson) {}

  static async load(json: RunJson): Promise<Run> {
    const run = new Run(json);
    const columns = await unpackColumns(json.data, json.columns.length, json.rows);
    json.columns.forEach((name, i) => run.columns.set(name, columns[i]));
    run.rows = json.rows;
    run.findSegments();
    return run;
  }

  /** A run of which rows are still to come. */
  static live(json: RunJson): Run {
    const run = new Run(json);
    for (const name of json.columns) run.columns.set(name, new Float32Array(1024));
    run.growing = true;
    return run;
  }

  /** Adds a row in the order of the columns; null is a gap. */
  append(values: (number | null)[]): void {
    const names = this.json.columns;
    const time = values[names.indexOf("time")] ?? NaN;
    if (this.rows > 0 && !(time > this.end)) return;
    names.forEach((name, i) => {
      let column = this.columns.get(name) ?? new Float32Array(0);
      if (this.rows >= column.length) {
        const longer = new Float32Array(2 * column.length);
        longer.set(column);
        this.columns.set(name, longer);
        column = longer;
      }
      column[this.rows] = values[i] ?? NaN;
    });
    this.rows += 1;
    this.extendSegments(this.rows - 1);
  }

  get time(): Float32Array {
    return this.columns.get("time") ?? new Float32Array(0);
  }
  get start(): number {
    return this.rows > 0 ? this.time[0] : 0;
  }
  get end(): number {
    return this.rows > 0 ? this.time[this.rows - 1] : 0;
  }

  /** The last row at or before a time. */
  row(time: number): number {
    const t = this.time;
    let low = 0;
    let high = this.rows - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (t[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** A value at a row; NaN where there is none. */
  at(name: string, row: number): number {
    const column = this.columns.get(name);
    return column !== undefined && row >= 0 && row < this.rows ? column[row] : NaN;
  }

  /** A value between rows, for smooth motion; the value of the row where a neighbour is missing. */
  between(name: string, time: number): number {
    const row = this.row(time);
    const a = this.at(name, row);
    const b = this.at(name, row + 1);
    if (!Number.isFinite(b)) return a;
    const step = this.time[row + 1] - this.time[row];
    const share = step > 0 ? Math.min(1, Math.max(0, (time - this.time[row]) / step)) : 0;
    return a + share * (b - a);
  }

  vector(name: string, time: number): [number, number, number] {
    return [this.between(`${name}_x`, time), this.between(`${name}_y`, time), this.between(`${name}_z`, time)];
  }

  has(name: string): boolean {
    const column = this.columns.get(name);
    if (this.growing) return column !== undefined;
    return column !== undefined && column.subarray(0, this.rows).some((v) => Number.isFinite(v));
  }

  /** Adds the column of the opening in percent of what was wanted. */
  addShare(): void {
    const goal = this.json.scene?.mission?.goal ?? NaN;
    this.columns.set(
      "opening_share",
      Float32Array.from(this.columns.get("opening_q") ?? [], (q) => (100 * q) / goal),
    );
  }

  /** Last finite value of a column. */
  last(name: string): number {
    const column = this.columns.get(name);
    for (let i = this.rows - 1; column !== undefined && i >= 0; --i) if (Number.isFinite(column[i])) return column[i];
    return NaN;
  }

  phaseName(row: number): string {
    return this.json.phase_names[this.at("phase", row)] ?? "";
  }

  /** When a phase begins first, or undefined. */
  phaseStart(...phases: string[]): number | undefined {
    return this.segments.find((s) => phases.includes(s.phase))?.from;
  }

  private findSegments(): void {
    this.segments = [];
    for (let i = 0; i < this.rows; ++i) this.extendSegments(i);
  }

  private extendSegments(row: number): void {
    const current = this.segments.at(-1);
    const name = this.phaseName(row);
    const time = this.time[row];
    if (current !== undefined) current.to = time;
    if (current?.phase !== name) this.segments.push({ phase: name, from: time, to: time });
  }
}
