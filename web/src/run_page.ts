/** The page of one run. */
import { Clock } from "./clock";
import { el } from "./dom";
import { bindKeys, PhaseBar } from "./phasebar";
import { plotList } from "./plot_list";
import { PlotGroup } from "./plots";
import type { Run } from "./run";
import { OneRun } from "./sources";
import { TopView } from "./topview";
import { makeFigures, makeVerdict } from "./verdict";
import { Viewer } from "./viewer";

/** What the colours of the replay mean. */
export function replayLegend(): HTMLElement {
  const legend = el("div", { class: "legend" });
  const entries: [string, string][] = [
    ["--c1", "path of the hand; believed direction with its 2σ cone"],
    ["--c3", "believed axis with its 2σ cone"],
    ["--truth", "true axis"],
    ["--c2", "pull force"],
    ["--bad", "normal force (1 cm per N)"],
  ];
  for (const [name, label] of entries)
    legend.append(
      el("span", {}, el("i", { class: name === "--truth" ? "dash" : "", style: `border-top-color:var(${name})` }), label),
    );
  return legend;
}

export function keysHint(): HTMLElement {
  return el(
    "p",
    { class: "soft keys" },
    "Keys: space plays, ← → step by 0.1 s (with shift 1 s), Home and End jump. Plots: click to go there, drag to zoom, double click for all.",
  );
}

/** Where one looks first: the moment of the end of a failed run, the middle of the opening of a good one. */
function firstMoment(run: Run): number {
  const open = run.segments.filter((s) => s.phase === "open").at(-1);
  if (run.json.result?.outcome === "opened" && open !== undefined) return open.from + 0.6 * (open.to - open.from);
  const end = run.segments.filter((s) => s.phase === run.json.result?.phase).at(-1);
  return end === undefined ? run.end : end.to - 0.02;
}

export function showRun(root: HTMLElement, run: Run): void {
  const clock = new Clock(run.start, run.end);
  clock.time = firstMoment(run);
  const local = (_run: Run, time: number): number => time;
  const bar = new PhaseBar(run, clock, (time) => time);
  const viewer = new Viewer([run], clock, local);
  const top = new TopView([run], clock, local);
  const plots = new PlotGroup(plotList(run), new OneRun(run), clock);
  plots.element.prepend(top.element);
  root.append(
    makeVerdict(run, (time) => clock.set(time)),
    el(
      "main",
      {},
      el(
        "section",
        { class: "card replay", "aria-label": "Replay" },
        viewer.element,
        bar.element,
        replayLegend(),
        keysHint(),
      ),
      plots.element,
    ),
    makeFigures(run),
  );
  bindKeys(clock);
}
