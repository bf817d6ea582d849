/** Several runs on top of each other: ghosts in one replay, one line per run in every plot. */
import { Clock } from "./clock";
import { colour, el } from "./dom";
import { figure, quantity } from "./format";
import { bindKeys, PhaseBar } from "./phasebar";
import { plotList, type PlotDefinition } from "./plot_list";
import { PlotGroup } from "./plots";
import { reasonWords } from "./reasons";
import type { Run } from "./run";
import { keysHint } from "./run_page";
import { ManyRuns } from "./sources";
import { TopView } from "./topview";
import { openingWords, outcome } from "./verdict";
import { Viewer } from "./viewer";

/** Colours of the runs, distinct in both schemes. */
const TINTS = ["--c1", "--c2", "--c3", "--c4", "--c6", "--c7", "--c5", "--c8"];

interface Row {
  label: string;
  text: (run: Run) => string;
}

const number = (run: Run, key: string): number => {
  const v = run.json.result?.[key];
  return typeof v === "number" ? v : NaN;
};

const ROWS: Row[] = [
  { label: "outcome", text: (r) => outcome(r).name },
  {
    label: "why it ended",
    text: (r) => (r.json.result === null ? "the record breaks off" : reasonWords(r.json.result.reason).what),
  },
  {
    label: "opening",
    text: (r) => openingWords(r, Number.isFinite(number(r, "opening")) ? number(r, "opening") : r.last("opening_q")),
  },
  { label: "time of opening", text: (r) => quantity(number(r, "open_duration_s"), "s", 1) },
  { label: "whole duration", text: (r) => quantity(number(r, "duration_s"), "s", 1) },
  { label: "peak normal force", text: (r) => quantity(number(r, "peak_normal_force_N"), "N", 1) },
  { label: "normal force after 15 cm", text: (r) => quantity(number(r, "late_normal_force_N"), "N", 1) },
  { label: "peak pull force", text: (r) => quantity(number(r, "peak_pull_force_N"), "N", 1) },
  {
    label: "direction error at 20 cm",
    text: (r) => quantity((number(r, "direction_error_20cm_rad") * 180) / Math.PI, "°", 1),
  },
  { label: "unwanted contacts", text: (r) => figure(number(r, "unwanted_contact_count"), 0) },
];

function table(runs: Run[], tints: string[]): HTMLElement {
  const head = el(
    "tr",
    {},
    el("th", { scope: "col" }, "run"),
    ...runs.map((r, i) =>
      el("th", { scope: "col" }, el("i", { class: "swatch", style: `background:var(${tints[i]})` }), r.json.name),
    ),
  );
  const rows = ROWS.map((row) =>
    el("tr", {}, el("th", { scope: "row" }, row.label), ...runs.map((r) => el("td", {}, row.text(r)))),
  );
  return el("div", { class: "wide" }, el("table", { class: "compared" }, el("thead", {}, head), el("tbody", {}, ...rows)));
}

type Alignment = "opening" | "start";

/** The runs on a common time: zero is the start of each, or the moment at which each begins to open. */
class Alignments {
  by: Alignment;

  constructor(private readonly runs: Run[]) {
    this.by = runs.every((r) => r.phaseStart("open", "probe") !== undefined) ? "opening" : "start";
  }

  zero(run: Run): number {
    return this.by === "opening" ? (run.phaseStart("open", "probe") ?? run.start) : run.start;
  }

  span(): [number, number] {
    const from = this.runs.map((r) => r.start - this.zero(r));
    const to = this.runs.map((r) => r.end - this.zero(r));
    return [Math.min(...from), Math.max(...to)];
  }
}

function alignmentChoice(alignments: Alignments, changed: () => void): HTMLElement {
  const choice = el(
    "select",
    { "aria-label": "Lay the runs on top of each other by" },
    el("option", { value: "opening" }, "start of opening"),
    el("option", { value: "start" }, "start of the run"),
  );
  choice.value = alignments.by;
  choice.addEventListener("change", () => {
    alignments.by = choice.value as Alignment;
    changed();
  });
  return el("label", { class: "soft" }, "Time zero: ", choice);
}

/** One phase bar per run; the first has the buttons. */
function phaseBars(runs: Run[], tints: string[], clock: Clock, local: (run: Run, time: number) => number): PhaseBar[] {
  return runs.map((run, i) => {
    const bar = new PhaseBar(run, clock, (time) => local(run, time));
    const swatch = el("i", { class: "swatch", style: `background:var(${tints[i]})` });
    bar.element.prepend(el("p", { class: "whose" }, swatch, run.json.name));
    if (i > 0) bar.silence();
    return bar;
  });
}

/** One curve per run and plot; doors and drawers share no unit of opening but the share of what was wanted. */
function comparedPlots(runs: Run[]): PlotDefinition[] {
  const mixed = runs.some((r) => r.json.slide !== runs[0].json.slide);
  const [opening, ...others] = plotList(runs[0]);
  const share: PlotDefinition = {
    title: "Opening, share of what was wanted",
    unit: "%",
    include: [0, 100],
    curves: [{ key: "opening_share", label: "true", colour: "--truth", digits: 0 }],
  };
  if (mixed) for (const run of runs) run.addShare();
  return [mixed ? share : opening, ...others].map((d) => ({
    ...d,
    title: d.curves.length > 1 ? `${d.title}: ${d.curves[0].label}` : d.title,
  }));
}

export function showComparison(root: HTMLElement, runs: Run[]): void {
  const tints = runs.map((_, i) => TINTS[i % TINTS.length]);
  const alignments = new Alignments(runs);
  const local = (run: Run, time: number): number => time + alignments.zero(run);
  const clock = new Clock(...alignments.span());
  clock.time = alignments.by === "opening" ? 0 : clock.start;
  const viewer = new Viewer(runs, clock, local, tints.map(colour));
  const bars = phaseBars(runs, tints, clock, local);
  const plots = new PlotGroup(comparedPlots(runs), new ManyRuns(runs, tints, () => alignments.span(), local), clock);
  plots.element.prepend(new TopView(runs, clock, local, tints).element);
  const choice = alignmentChoice(alignments, () => {
    plots.range = null;
    clock.setRange(...alignments.span());
    for (const bar of bars) bar.rebuild();
    plots.build();
  });
  const replay = el("section", { class: "card replay", "aria-label": "Replay" }, viewer.element);
  replay.append(...bars.map((b) => b.element), keysHint());
  const origin = el("p", { class: "origin" }, "Comparison");
  root.append(
    el("header", {}, origin, el("h1", {}, `${runs.length} runs`), table(runs, tints), choice),
    el("main", {}, replay, plots.element),
  );
  bindKeys(clock);
}
