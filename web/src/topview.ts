/** The way of the base from above, with hand, handle, leaf and walls; drawn again for the time cursor. */
import type { Clock } from "./clock";
import { colour, el, onSchemeChange } from "./dom";
import type { BoxJson, MechanismJson, Run } from "./run";

type Point = [number, number];

function corners(box: BoxJson): [number, number, number][] {
  const out: [number, number, number][] = [];
  for (const i of [-1, 1])
    for (const j of [-1, 1])
      for (const k of [-1, 1]) {
        out.push(
          [0, 1, 2].map(
            (n) =>
              box.centre[n] +
              i * box.half_extents[0] * box.axes[0][n] +
              j * box.half_extents[1] * box.axes[1][n] +
              k * box.half_extents[2] * box.axes[2][n],
          ) as [number, number, number],
        );
      }
  return out;
}

/** Where a point of the closed leaf is when it is open by q. */
function moved(m: MechanismJson, p: [number, number, number], q: number): [number, number, number] {
  const k = m.axis;
  if (m.type === "slide") return [p[0] + k[0] * q, p[1] + k[1] * q, p[2] + k[2] * q];
  const v = [p[0] - m.point[0], p[1] - m.point[1], p[2] - m.point[2]];
  const c = Math.cos(q);
  const s = Math.sin(q);
  const along = k[0] * v[0] + k[1] * v[1] + k[2] * v[2];
  const cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
  return [0, 1, 2].map((i) => m.point[i] + v[i] * c + cross[i] * s + k[i] * along * (1 - c)) as [number, number, number];
}

/** Outline of points seen from above. */
function hull(points: number[][]): Point[] {
  const sorted = points.map((p) => [p[0], p[1]] as Point).sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (list: Point[]): Point[] => {
    const h: Point[] = [];
    for (const c of list) {
      while (h.length > 1) {
        const [a, b] = [h[h.length - 2], h[h.length - 1]];
        if ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0) break;
        h.pop();
      }
      h.push(c);
    }
    h.pop();
    return h;
  };
  return half(sorted).concat(half(sorted.reverse()));
}

function trace(g: CanvasRenderingContext2D, points: Point[], close: boolean): void {
  g.beginPath();
  points.forEach((p, i) => (i === 0 ? g.moveTo(...p) : g.lineTo(...p)));
  if (close) g.closePath();
}

/** What one run adds to the picture. */
class Layer {
  readonly walls: Point[][];
  private readonly leaf: [number, number, number][][];
  private readonly mechanism: MechanismJson | undefined;

  constructor(
    readonly run: Run,
    readonly tint: string,
    private readonly local: (time: number) => number,
  ) {
    this.mechanism = run.json.scene?.mechanism;
    const seen = (box: BoxJson): boolean => corners(box).some((c) => c[2] > 0.05) && corners(box).some((c) => c[2] < 1.8);
    this.walls = (this.mechanism?.world ?? []).filter(seen).map((b) => hull(corners(b)));
    this.leaf = (this.mechanism?.leaf ?? []).map(corners);
  }

  foot(time: number): Point[] | null {
    const [x, y, yaw] = ["base_x", "base_y", "base_yaw"].map((n) => this.run.between(n, time));
    if (!Number.isFinite(x + y + yaw)) return null;
    const f = this.run.json.scene?.robot?.footprint_m ?? [-0.3, 0.3, -0.25, 0.25];
    const c = Math.cos(yaw);
    const s = Math.sin(yaw);
    return (
      [
        [f[0], f[2]],
        [f[1], f[2]],
        [f[1], f[3]],
        [f[0], f[3]],
      ] as Point[]
    ).map((p) => [x + c * p[0] - s * p[1], y + s * p[0] + c * p[1]]);
  }

  leafAt(time: number): Point[][] {
    const q = this.run.between("opening_q", time);
    const m = this.mechanism;
    return m === undefined || !Number.isFinite(q) ? [] : this.leaf.map((l) => hull(l.map((p) => moved(m, p, q))));
  }

  path(name: string): Point[] {
    const out: Point[] = [];
    const step = Math.max(1, Math.floor(this.run.rows / 1500));
    for (let i = 0; i < this.run.rows; i += step) out.push([this.run.at(`${name}_x`, i), this.run.at(`${name}_y`, i)]);
    return out.filter((p) => Number.isFinite(p[0] + p[1]));
  }

  /** Everything that must be inside of the picture. */
  extent(): Point[] {
    const times = Array.from({ length: 30 }, (_, i) => this.run.start + ((this.run.end - this.run.start) * i) / 29);
    return times.flatMap((t) => [...(this.foot(t) ?? []), ...this.leafAt(t).flat()]).concat(this.path("hand"));
  }

  at(time: number): number {
    return this.local(time);
  }
}

export class TopView {
  readonly element: HTMLElement;
  private readonly canvas = el("canvas", { role: "img", "aria-label": "Base, hand and leaf seen from above" });
  private readonly layers: Layer[];
  private readonly still = el("canvas");
  private extent: Point[] = [];
  private view: { k: number; w: number; h: number; to: (p: Point) => Point } | null = null;

  constructor(
    runs: Run[],
    private readonly clock: Clock,
    local: (run: Run, time: number) => number,
    tints?: string[],
  ) {
    this.layers = runs.map((run, i) => new Layer(run, tints?.[i] ?? "--c1", (t) => local(run, t)));
    const legend = el("div", { class: "legend" });
    const entries =
      tints === undefined
        ? [
            ["--c1", "base"],
            ["--c2", "hand"],
            ["--leaf", "leaf"],
            ["--wall", "walls, furniture"],
          ]
        : runs.map((r, i) => [tints[i], r.json.name]);
    for (const [name, label] of entries)
      legend.append(el("span", {}, el("i", { style: `border-top-color:var(${name})` }), label));
    this.element = el("section", { class: "card plot top" }, el("h2", {}, "From above, 0.5 m grid"), this.canvas, legend);
    clock.onChange(() => this.draw());
    onSchemeChange(() => this.drawStill());
    new ResizeObserver(() => this.drawStill()).observe(this.canvas);
    this.refresh();
  }

  /** Looks at the runs anew, as while one goes on. */
  refresh(): void {
    this.extent = this.layers.flatMap((l) => l.extent());
    if (this.extent.length === 0)
      this.extent = [
        [-1, -1],
        [1, 1],
      ];
    this.drawStill();
  }

  /** Room of the picture and the way from metres to it. */
  private frame(): { k: number; w: number; h: number; to: (p: Point) => Point } {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    const xs = this.extent.map((p) => p[0]);
    const ys = this.extent.map((p) => p[1]);
    const [x0, x1] = [Math.min(...xs) - 0.1, Math.max(...xs) + 0.1];
    const [y0, y1] = [Math.min(...ys) - 0.1, Math.max(...ys) + 0.1];
    const k = Math.min(w / (x1 - x0), h / (y1 - y0));
    return { k, w, h, to: ([x, y]) => [w / 2 + k * (x - (x0 + x1) / 2), h / 2 - k * (y - (y0 + y1) / 2)] };
  }

  /** Draws what stands: grid, walls, paths. */
  private drawStill(): void {
    if (this.canvas.clientWidth === 0) return;
    this.view = this.frame();
    const { k, w, h, to } = this.view;
    const ratio = window.devicePixelRatio || 1;
    for (const canvas of [this.canvas, this.still]) {
      canvas.width = Math.round(w * ratio);
      canvas.height = Math.round(h * ratio);
      canvas.getContext("2d")?.setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    const g = this.still.getContext("2d");
    if (g === null) return;
    this.drawGrid(g, k, w, h, to);
    for (const layer of this.layers) this.drawPaths(g, layer, to);
    this.draw();
  }

  private draw(): void {
    const g = this.canvas.getContext("2d");
    if (g === null || this.view === null) return;
    const { w, h, to } = this.view;
    g.clearRect(0, 0, w, h);
    g.drawImage(this.still, 0, 0, w, h);
    for (const layer of this.layers) this.drawMoving(g, layer, to);
  }

  private drawGrid(g: CanvasRenderingContext2D, k: number, w: number, h: number, to: (p: Point) => Point): void {
    const [ox, oy] = to([0, 0]);
    g.strokeStyle = colour("--line");
    g.lineWidth = 0.6;
    g.beginPath();
    const step = 0.5 * k;
    for (let x = ox % step; x < w; x += step) {
      g.moveTo(x, 0);
      g.lineTo(x, h);
    }
    for (let y = oy % step; y < h; y += step) {
      g.moveTo(0, y);
      g.lineTo(w, y);
    }
    g.stroke();
  }

  private drawPaths(g: CanvasRenderingContext2D, layer: Layer, to: (p: Point) => Point): void {
    if (layer === this.layers[0]) {
      g.fillStyle = colour("--wall");
      for (const wall of layer.walls) {
        trace(g, wall.map(to), true);
        g.fill();
      }
    }
    g.lineWidth = 1.6;
    g.strokeStyle = colour(layer.tint);
    trace(g, layer.path("base").map(to), false);
    g.stroke();
    if (this.layers.length > 1) return;
    g.strokeStyle = colour("--c2");
    trace(g, layer.path("hand").map(to), false);
    g.stroke();
  }

  private drawMoving(g: CanvasRenderingContext2D, layer: Layer, to: (p: Point) => Point): void {
    const time = layer.at(this.clock.time);
    g.fillStyle = colour(this.layers.length > 1 ? layer.tint : "--leaf");
    for (const leaf of layer.leafAt(time)) {
      trace(g, leaf.map(to), true);
      g.fill();
    }
    this.drawRobot(g, layer, time, to);
  }

  private drawRobot(g: CanvasRenderingContext2D, layer: Layer, time: number, to: (p: Point) => Point): void {
    g.lineWidth = 1.6;
    const ends = this.layers.length > 1 ? [time] : [layer.run.start, layer.run.end, time];
    for (const t of ends) {
      const foot = layer.foot(t);
      if (foot === null) continue;
      const now = t === time;
      trace(g, foot.map(to), true);
      g.strokeStyle = g.fillStyle = colour(layer.tint);
      g.globalAlpha = now ? 0.22 : 0.06;
      g.fill();
      g.globalAlpha = now ? 1 : 0.4;
      g.stroke();
      const middle: Point = [(foot[1][0] + foot[2][0]) / 2, (foot[1][1] + foot[2][1]) / 2];
      const axle: Point = [layer.run.between("base_x", t), layer.run.between("base_y", t)];
      trace(g, [axle, middle].map(to), false);
      g.stroke();
      const hand: Point = [layer.run.between("hand_x", t), layer.run.between("hand_y", t)];
      if (now && Number.isFinite(hand[0] + hand[1])) {
        g.strokeStyle = g.fillStyle = colour("--c2");
        trace(g, [axle, hand].map(to), false);
        g.stroke();
        g.beginPath();
        g.arc(...to(hand), 4, 0, 7);
        g.fill();
      }
    }
    g.globalAlpha = 1;
  }
}
