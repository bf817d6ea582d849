/** A run while it goes on: the page of a run, fed by server-sent events, with a button that stops the robot. */
import { Clock } from "./clock";
import { button, el } from "./dom";
import { quantity } from "./format";
import { bindKeys, PhaseBar } from "./phasebar";
import { plotList, type PlotDefinition } from "./plot_list";
import { PlotGroup } from "./plots";
import { phaseWords } from "./reasons";
import type { Run } from "./run";
import { replayLegend } from "./run_page";
import { OneRun } from "./sources";
import { TopView } from "./topview";
import { openingWords } from "./verdict";
import { Viewer } from "./viewer";

/** The plots are drawn anew so often [ms]; the 3-D picture with every frame that has news. */
const REDRAW = 250;

/** The rows of a run that goes on are instants, not means. */
function instantPlots(run: Run): PlotDefinition[] {
  return plotList(run).map((d) => ({ ...d, title: d.title.replace(", mean of 20 ms", "") }));
}

class LivePage {
  private readonly clock: Clock;
  private readonly bar: PhaseBar;
  private readonly plots: PlotGroup;
  private readonly top: TopView;
  private readonly badge = el("span", { class: "badge wait" }, "live");
  private readonly line = el("span", {}, " waiting for the robot");
  private readonly note = el("p", { class: "soft", role: "status" });
  private readonly stop: HTMLButtonElement;
  private following = true;
  private redrawn = 0;

  constructor(
    root: HTMLElement,
    private readonly run: Run,
  ) {
    const local = (_run: Run, time: number): number => time;
    this.clock = new Clock(0, 0.1);
    this.bar = new PhaseBar(run, this.clock, (time) => time);
    const viewer = new Viewer([run], this.clock, local);
    this.top = new TopView([run], this.clock, local);
    this.plots = new PlotGroup(instantPlots(run), new OneRun(run), this.clock);
    this.plots.element.prepend(this.top.element);
    this.stop = button("Stop the robot", () => void this.askToStop(), { class: "stop" });
    const follow = button("Follow", () => this.follow());
    root.append(
      el(
        "header",
        {},
        el("p", { class: "origin" }, `Live · run ${run.json.name}`),
        el("h1", {}, this.badge, this.line),
        el("div", { class: "bar" }, this.stop, follow, this.note),
      ),
      el(
        "main",
        {},
        el(
          "section",
          { class: "card replay", "aria-label": "The robot now" },
          viewer.element,
          this.bar.element,
          replayLegend(),
        ),
        this.plots.element,
      ),
    );
    bindKeys(this.clock);
    // Whoever looks back in time is left there until he asks to follow again.
    this.clock.onChange(() => {
      if (this.clock.time < this.clock.end - 0.2) this.following = false;
    });
  }

  private follow(): void {
    this.following = true;
    this.clock.playing = false;
    this.clock.set(this.clock.end);
  }

  private async askToStop(): Promise<void> {
    this.stop.disabled = true;
    this.note.textContent = "Asking the robot to stop …";
    try {
      const answer = await fetch("stop", { method: "POST" });
      this.note.textContent = answer.ok ? "The robot stops safely." : `It was not stopped: ${answer.statusText}.`;
      this.stop.disabled = answer.ok;
    } catch {
      this.note.textContent = "It was not stopped: the program does not answer.";
      this.stop.disabled = false;
    }
  }

  listen(): void {
    const events = new EventSource("events");
    events.onmessage = (event: MessageEvent<string>) => this.take(JSON.parse(event.data) as (number | null)[][]);
    events.onerror = () => (this.note.textContent = "The connection is interrupted; trying again.");
    events.onopen = () => (this.note.textContent = "");
    events.addEventListener("end", (event: MessageEvent<string>) => {
      events.close();
      this.badge.textContent = "ended";
      this.stop.disabled = true;
      location.replace(event.data);
    });
  }

  private take(rows: (number | null)[][]): void {
    for (const row of rows) this.run.append(row);
    const { start, end } = this.run;
    this.clock.start = start;
    this.clock.end = Math.max(end, start + 0.1);
    if (this.following && !this.clock.playing) this.clock.set(this.clock.end);
    this.tell();
    const now = performance.now();
    if (now - this.redrawn < REDRAW) return;
    this.redrawn = now;
    this.bar.rebuild();
    this.plots.refresh();
    this.top.refresh();
  }

  private tell(): void {
    const row = this.run.rows - 1;
    const phase = this.run.phaseName(row);
    const opening = openingWords(this.run, this.run.at("opening_q", row));
    this.badge.className = "badge good";
    this.line.textContent = ` ${quantity(this.run.end, "s", 1)} · the robot ${phaseWords(phase)} · opening ${opening} · normal force ${quantity(this.run.at("normal_true", row), "N", 1)}`;
  }
}

export function showLive(root: HTMLElement, run: Run): void {
  new LivePage(root, run).listen();
}
