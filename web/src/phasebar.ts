/** The mission as a bar of its phases; it is also the slider of the time cursor. */
import { SPEEDS, type Clock } from "./clock";
import { button, el } from "./dom";
import { quantity } from "./format";
import { phaseWords } from "./reasons";
import type { Run } from "./run";

const hue = (phase: string): string => `var(--p-${phase}, var(--band))`;

export class PhaseBar {
  readonly element: HTMLElement;
  private readonly strip = el("div", { class: "strip", "aria-hidden": "true" });
  private readonly slider: HTMLInputElement;
  private readonly needle = el("i", { class: "needle" });
  private readonly play: HTMLButtonElement;
  private readonly now = el("output", { class: "now", "aria-live": "off" });
  private readonly speed = el("select", { "aria-label": "Speed of the replay" });

  constructor(
    private readonly run: Run,
    private readonly clock: Clock,
    private readonly local: (time: number) => number,
  ) {
    this.slider = el("input", { type: "range", step: "any", "aria-label": "Time of the replay" });
    this.slider.addEventListener("input", () => clock.set(Number(this.slider.value)));
    this.play = button("Play", () => clock.toggle(), { class: "play" });
    for (const s of SPEEDS) this.speed.append(el("option", { value: String(s) }, `${s} ×`));
    this.speed.addEventListener("change", () => clock.setSpeed(Number(this.speed.value)));
    const start = button("Start", () => clock.set(clock.start), { "aria-label": "To the start" });
    this.element = el(
      "div",
      { class: "phasebar" },
      el("div", { class: "timeline" }, this.strip, this.needle, this.slider),
      el("div", { class: "bar", role: "group", "aria-label": "Replay" }, this.play, start, this.speed, this.now),
    );
    clock.onChange(() => this.update());
    this.rebuild();
    this.update();
  }

  /** Leaves the controls to another bar; the phases stay. */
  silence(): void {
    this.element.classList.add("silent");
    this.slider.remove();
  }

  /** Draws the phases anew, as while a run goes on. */
  rebuild(): void {
    const { start, end } = this.clock;
    const span = end - start || 1;
    const offset = this.clock.time - this.local(this.clock.time);
    this.strip.replaceChildren();
    for (const s of this.run.segments) {
      const width = (100 * (s.to - s.from)) / span; // [%]
      const part = el(
        "span",
        { style: `left:${(100 * (s.from + offset - start)) / span}%;width:${width}%;background:${hue(s.phase)}` },
        width > 7.5 ? s.phase : "",
      );
      part.title = `${s.phase}: the robot ${phaseWords(s.phase)}, ${quantity(s.to - s.from, "s", 1)}`;
      this.strip.append(part);
    }
    for (const contact of this.run.json.result?.unwanted_contacts ?? []) {
      this.strip.append(
        el("b", { style: `left:${(100 * (contact.time + offset - start)) / span}%`, title: `contact: ${contact.bodies}` }),
      );
    }
    this.slider.min = String(start);
    this.slider.max = String(end);
  }

  private update(): void {
    const { time, start, end, playing, speed } = this.clock;
    const phase = this.run.phaseName(this.run.row(this.local(time)));
    this.slider.value = String(time);
    this.slider.setAttribute("aria-valuetext", `${quantity(time, "s")}, ${phase}`);
    this.needle.style.left = `${(100 * (time - start)) / (end - start || 1)}%`;
    this.play.textContent = playing ? "Pause" : "Play";
    this.speed.value = String(speed);
    this.now.textContent = `${quantity(time, "s")} · ${phase}`;
  }
}

/** Space plays and pauses, arrows step, Home and End jump; keys of other controls stay theirs. */
export function bindKeys(clock: Clock): void {
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    const typing = target.matches("input:not([type=range]), select, textarea");
    if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = event.shiftKey ? 1 : 0.1;
    const actions: Record<string, () => void> = {
      " ": () => clock.toggle(),
      ArrowRight: () => clock.set(clock.time + step),
      ArrowLeft: () => clock.set(clock.time - step),
      Home: () => clock.set(clock.start),
      End: () => clock.set(clock.end),
    };
    const action = actions[event.key];
    if (action === undefined || (event.key === " " && target.matches("button, summary"))) return;
    event.preventDefault();
    action();
  });
}
