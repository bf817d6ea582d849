/** Where the plots of a page take their curves from: one run, or several on top of each other. */
import type { PlotDefinition } from "./plot_list";
import type { PlotLine, PlotSource } from "./plots";
import type { Run, Segment } from "./run";

const orGap = (v: number): number | null => (Number.isFinite(v) ? v : null);

/** All curves of one run. */
export class OneRun implements PlotSource {
  constructor(private readonly run: Run) {}

  time(): number[] {
    return Array.from(this.run.time.subarray(0, this.run.rows));
  }

  segments(): Segment[] {
    return this.run.segments;
  }

  lines(definition: PlotDefinition): PlotLine[] {
    return definition.curves
      .filter((c) => this.run.has(c.key))
      .map((curve) => {
        const column = (key: string): Float32Array =>
          this.run.columns.get(key)?.subarray(0, this.run.rows) ?? new Float32Array(0);
        const values = Array.from(column(curve.key), orGap);
        const read = (time: number): number => this.run.at(curve.key, this.run.row(time));
        const line: PlotLine = {
          label: curve.label,
          colour: curve.colour,
          dashed: curve.dashed ?? false,
          digits: curve.digits ?? 2,
          values,
          read,
        };
        if (curve.band !== undefined && this.run.has(curve.band)) {
          const band = curve.band;
          const width = column(band);
          const middle = (i: number): number => (curve.bandFromZero ? 0 : column(curve.key)[i]);
          line.high = Array.from(width, (w, i) => orGap(middle(i) + w));
          line.low = Array.from(width, (w, i) => orGap(curve.bandFromZero ? 0 * w : middle(i) - w));
          line.readBand = (time) => this.run.at(band, this.run.row(time));
        }
        return line;
      });
  }
}

/** The first curve of every plot (the truth, where there is one), one line per run, on a common grid of time. */
export class ManyRuns implements PlotSource {
  /** @param local  Time of a run at a time of the page */
  constructor(
    private readonly runs: Run[],
    private readonly tints: string[],
    private readonly span: () => [number, number],
    private readonly local: (run: Run, time: number) => number,
  ) {}

  time(): number[] {
    const [from, to] = this.span();
    const steps = Math.max(1, Math.round((to - from) / 0.02));
    return Array.from({ length: steps + 1 }, (_, i) => from + ((to - from) * i) / steps);
  }

  segments(): Segment[] {
    return [];
  }

  lines(definition: PlotDefinition): PlotLine[] {
    const curve = definition.curves[0];
    if (curve === undefined || !this.runs.some((r) => r.has(curve.key))) return [];
    const time = this.time();
    return this.runs.map((run, i) => {
      const read = (t: number): number => {
        const inside = this.local(run, t);
        return inside < run.start || inside > run.end ? NaN : run.at(curve.key, run.row(inside));
      };
      return {
        label: run.json.name,
        colour: this.tints[i],
        dashed: false,
        digits: curve.digits ?? 2,
        values: time.map((t) => orGap(read(t))),
        read,
      };
    });
  }
}
