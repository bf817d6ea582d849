/** The plots, all on one time axis: hovering reads values, a click sets the replay, a drag zooms, a double click goes back. */
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Clock } from "./clock";
import { colour, el, onSchemeChange } from "./dom";
import { figure, isNumber, quantity } from "./format";
import type { PlotDefinition } from "./plot_list";
import type { Segment } from "./run";

/** One line of a plot: where its values come from and how it is called. */
export interface PlotLine {
  label: string;
  colour: string;
  dashed: boolean;
  digits: number;
  values: (number | null)[];
  low?: (number | null)[];
  high?: (number | null)[];
  /** Value at a time of the page, from all rows and not from those drawn. */
  read: (time: number) => number;
  readBand?: (time: number) => number;
}

/** What a group of plots has in common. */
export interface PlotSource {
  time(): number[];
  lines(definition: PlotDefinition): PlotLine[];
  segments(): Segment[];
}

const SYNC = "page";

function rangeOf(definition: PlotDefinition, lines: PlotLine[], from: number, to: number, time: number[]): [number, number] {
  const values: number[] = [];
  for (const line of lines) {
    for (let i = 0; i < time.length; ++i) {
      const v = line.values[i];
      if (v !== null && v !== undefined && time[i] >= from && time[i] <= to) values.push(v);
    }
  }
  values.sort((a, b) => a - b);
  if (definition.log === true) return [Math.max(1e-3, (values[0] ?? 1) / 1.3), 1.3 * Math.max(1, values.at(-1) ?? 1)];
  const cut = definition.robust === true ? Math.floor(values.length * 0.01) : 0;
  let low = Math.min(...(definition.include ?? []), values[cut] ?? Infinity);
  let high = Math.max(...(definition.include ?? []), values[values.length - 1 - cut] ?? -Infinity);
  if (!(low <= high)) [low, high] = [0, 1];
  const pad = 0.08 * (high - low || Math.abs(high) || 1);
  return [low === 0 ? (definition.include?.includes(0) && high > 0 ? -0.02 * high : -pad) : low - pad, high + pad];
}

class Plot {
  readonly element: HTMLElement;
  private readonly values: { read: HTMLElement; line: PlotLine }[] = [];
  private readonly needle = el("div", { class: "needle" });
  private chart: uPlot | null = null;
  private lines: PlotLine[] = [];
  private readonly legend = el("div", { class: "legend" });
  private readonly holder = el("div", { class: "chart" });

  constructor(
    private readonly definition: PlotDefinition,
    private readonly source: PlotSource,
    private readonly group: PlotGroup,
  ) {
    const unit = definition.unit === "" ? "" : ` [${definition.unit}]`;
    this.element = el("section", { class: "card plot" }, el("h2", {}, definition.title + unit), this.holder, this.legend);
    this.holder.setAttribute("role", "img");
    this.holder.setAttribute("aria-label", `${definition.title}${unit} over time`);
  }

  build(): void {
    this.lines = this.source.lines(this.definition);
    this.buildLegend();
    this.chart?.destroy();
    const data: uPlot.AlignedData = [this.source.time(), ...this.columns()] as uPlot.AlignedData;
    this.chart = new uPlot(this.options(), data, this.holder);
    this.chart.over.append(this.needle);
    this.bindMouse(this.chart);
    this.moveNeedle(this.group.clock.time);
  }

  private columns(): (number | null)[][] {
    return this.lines.flatMap((l) => [l.values, ...(l.low && l.high ? [l.high, l.low] : [])]);
  }

  private options(): uPlot.Options {
    const series: uPlot.Series[] = [{}];
    const bands: uPlot.Band[] = [];
    for (const line of this.lines) {
      const stroke = colour(line.colour);
      series.push({
        stroke,
        width: line.dashed ? 1.5 : 1.8,
        dash: line.dashed ? [6, 4] : undefined,
        points: { show: false },
      });
      if (line.low === undefined || line.high === undefined) continue;
      bands.push({ series: [series.length, series.length + 1], fill: `color-mix(in srgb, ${stroke} 18%, transparent)` });
      const edge: uPlot.Series = { stroke: "transparent", width: 0, points: { show: false } };
      series.push(edge, edge);
    }
    const ink = colour("--soft");
    const grid = { stroke: colour("--line"), width: 1 };
    const font = "12px system-ui, sans-serif";
    return {
      width: Math.max(120, this.holder.clientWidth),
      height: 170,
      legend: { show: false },
      cursor: { sync: { key: SYNC, setSeries: false }, drag: { x: true, y: false, dist: 8 }, points: { size: 6 }, y: false },
      scales: {
        x: { time: false, range: (_u, min, max) => this.group.range ?? [min, max] },
        y: { distr: this.definition.log === true ? 3 : 1, range: () => this.range() },
      },
      axes: [
        { stroke: ink, grid, ticks: grid, font, size: 28, values: (_u, splits) => splits.map((v) => `${+v.toFixed(3)} s`) },
        { stroke: ink, grid, ticks: grid, font, size: 54 },
      ],
      series,
      bands,
      hooks: {
        drawClear: [(u) => this.drawPhases(u)],
        draw: [(u) => this.drawLimits(u)],
        setSelect: [(u) => this.select(u)],
        setCursor: [(u) => this.hover(u)],
      },
    };
  }

  private range(): [number, number] {
    const time = this.source.time();
    const [from, to] = this.group.range ?? [-Infinity, Infinity];
    return rangeOf(this.definition, this.lines, from, to, time);
  }

  private drawPhases(u: uPlot): void {
    const g = u.ctx;
    g.save();
    g.fillStyle = colour("--band");
    this.source.segments().forEach((s, i) => {
      if (i % 2 === 1) return;
      const a = Math.max(u.bbox.left, u.valToPos(s.from, "x", true));
      const b = Math.min(u.bbox.left + u.bbox.width, u.valToPos(s.to, "x", true));
      if (b > a) g.fillRect(a, u.bbox.top, b - a, u.bbox.height);
    });
    g.restore();
  }

  private drawLimits(u: uPlot): void {
    const g = u.ctx;
    g.save();
    g.beginPath();
    g.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    g.clip();
    g.strokeStyle = colour("--bad");
    g.setLineDash([5 * devicePixelRatio, 4 * devicePixelRatio]);
    g.lineWidth = devicePixelRatio;
    for (const limit of this.definition.limits ?? []) {
      const y = u.valToPos(limit, "y", true);
      g.beginPath();
      g.moveTo(u.bbox.left, y);
      g.lineTo(u.bbox.left + u.bbox.width, y);
      g.stroke();
    }
    g.restore();
  }

  private select(u: uPlot): void {
    if (u.select.width < 8) return;
    this.group.zoom([u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")]);
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  private bindMouse(u: uPlot): void {
    let down = 0;
    u.over.addEventListener("pointerdown", (e) => (down = e.clientX));
    u.over.addEventListener("pointerup", (e) => {
      if (Math.abs(e.clientX - down) > 4) return;
      this.group.clock.set(u.posToVal(e.clientX - u.over.getBoundingClientRect().left, "x"));
    });
    u.over.addEventListener("dblclick", () => this.group.zoom(null));
  }

  private hover(u: uPlot): void {
    const left = u.cursor.left ?? -1;
    this.showValues(left >= 0 ? u.posToVal(left, "x") : this.group.clock.time);
  }

  private buildLegend(): void {
    this.legend.replaceChildren();
    this.values.length = 0;
    for (const line of this.lines) {
      const read = el("b");
      const mark = el("i", { class: line.dashed ? "dash" : "", style: `border-top-color:var(${line.colour})` });
      this.legend.append(el("span", {}, mark, `${line.label} `, read));
      this.values.push({ read, line });
      if (line.low !== undefined)
        this.legend.append(el("span", {}, el("i", { class: "box", style: `background:var(${line.colour})` }), "2σ"));
    }
    const limits = this.definition.limits ?? [];
    if (limits.length > 0)
      this.legend.append(
        el("span", {}, el("i", { class: "dash", style: "border-top-color:var(--bad)" }), limitWords(this.definition)),
      );
  }

  showValues(time: number): void {
    for (const { read, line } of this.values) {
      const band = line.readBand?.(time);
      read.textContent =
        quantity(line.read(time), this.definition.unit, line.digits) +
        (isNumber(band) ? ` (2σ ${figure(band, line.digits)})` : "");
    }
  }

  moveNeedle(time: number): void {
    if (this.chart === null) return;
    const x = this.chart.valToPos(time, "x");
    this.needle.style.transform = `translateX(${x}px)`;
    this.needle.hidden = !(x >= 0 && x <= this.chart.over.clientWidth);
    if ((this.chart.cursor.left ?? -1) < 0 && this.group.reading) this.showValues(time);
  }

  resize(): void {
    this.chart?.setSize({ width: Math.max(120, this.holder.clientWidth), height: 170 });
    this.moveNeedle(this.group.clock.time);
  }

  /** Takes the curves anew, as they grow. */
  refresh(): void {
    if (this.chart === null) return;
    this.lines = this.source.lines(this.definition);
    this.values.forEach((v, i) => (v.line = this.lines[i] ?? v.line));
    this.chart.setData([this.source.time(), ...this.columns()] as uPlot.AlignedData);
    this.moveNeedle(this.group.clock.time);
  }

  redraw(): void {
    this.chart?.setData(this.chart.data);
    this.moveNeedle(this.group.clock.time);
  }
}

function limitWords({ limits = [], unit, title }: PlotDefinition): string {
  const high = Math.max(...limits);
  const low = Math.min(...limits);
  const range =
    limits.length < 2 ? figure(high, 1) : high === -low ? `± ${figure(high)}` : `${figure(low)} to ${figure(high)}`;
  return `${title === "Opening" ? "wanted" : "limit"} ${range} ${unit}`;
}

export class PlotGroup {
  readonly element = el("div", { class: "plots" });
  range: [number, number] | null = null;
  private readonly plots: Plot[];

  constructor(
    definitions: PlotDefinition[],
    source: PlotSource,
    readonly clock: Clock,
  ) {
    this.plots = definitions.filter((d) => source.lines(d).length > 0).map((d) => new Plot(d, source, this));
    this.element.append(...this.plots.map((p) => p.element));
    clock.onChange(() => this.follow());
    onSchemeChange(() => this.build());
    let width = 0;
    new ResizeObserver(([entry]) => {
      if (entry.contentRect.width === width) return;
      const first = width === 0;
      width = entry.contentRect.width;
      if (first) this.build();
      else this.plots.forEach((p) => p.resize());
    }).observe(this.element);
  }

  /** False in pictures of a replay in which the figures stay as they are: nobody reads thirty a second. */
  reading = true;
  private read = 0;

  private follow(): void {
    const now = performance.now();
    this.reading = !this.clock.playing || now - this.read > 120;
    if (this.reading) this.read = now;
    for (const plot of this.plots) plot.moveNeedle(this.clock.time);
  }

  build(): void {
    for (const plot of this.plots) plot.build();
  }

  refresh(): void {
    for (const plot of this.plots) plot.refresh();
  }

  zoom(range: [number, number] | null): void {
    this.range = range;
    for (const plot of this.plots) plot.redraw();
  }
}
