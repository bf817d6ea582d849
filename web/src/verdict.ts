/** The head of the page: what came of the run, in words and figures, from its result and its curves. */
import { button, el } from "./dom";
import { degrees, figure, isNumber, quantity, words as spaced } from "./format";
import { phaseWords, reasonWords } from "./reasons";
import type { ResultJson, Run } from "./run";

const value = (result: ResultJson | null, key: string): number => {
  const v = result?.[key];
  return isNumber(v) ? v : NaN;
};

/** Opening in the unit people use for it: degrees, or centimetres of a slide. */
export function openingWords(run: Run, opening: number): string {
  return run.json.slide ? quantity(100 * opening, "cm", 1) : quantity(degrees(opening), "°", 1);
}

export function outcome(run: Run): { name: string; good: boolean } {
  const result = run.json.result;
  if (result === null) return { name: "broken off", good: false };
  return { name: String(result.outcome ?? "ended"), good: result.outcome === "opened" };
}

export function headline(run: Run): string {
  const r = run.json.result;
  const opening = isNumber(r?.opening) ? r.opening : run.last("opening_q");
  const goal = run.json.scene?.mission?.goal;
  const type = typeof r?.mechanism_type_true === "string" ? r.mechanism_type_true : (run.json.scene?.mechanism?.type ?? "");
  const parts = [type || "mechanism"];
  if (isNumber(opening)) {
    const wanted = isNumber(goal)
      ? ` of ${openingWords(run, Math.min(goal, run.json.scene?.mechanism?.travel ?? goal))}`
      : "";
    parts.push(`${openingWords(run, opening)}${wanted}`);
  }
  parts.push(quantity(isNumber(r?.duration_s) ? r.duration_s : run.end - run.start, "s", 1));
  if (isNumber(r?.peak_normal_force_N)) parts.push(`peak normal force ${quantity(r.peak_normal_force_N, "N", 1)}`);
  return parts.join(" · ");
}

/** What the robot believed of the mechanism and how surely, beside the truth. */
export function belief(run: Run): string {
  const r = run.json.result;
  const k = run.last("curvature_estimated");
  if (!isNumber(k)) return "The robot never came to hold the handle, so it believed nothing of how it opens.";
  const sigma2 = run.last("curvature_2sigma");
  const truth = run.last("curvature_true");
  const type = typeof r?.mechanism_type_estimated === "string" ? r.mechanism_type_estimated : "unknown";
  let text = type === "unknown" ? "The robot did not decide what it held" : `The robot believed: a ${type}`;
  if (type !== "slide" && !(k > sigma2)) text += ", and could not tell the radius";
  else if (type !== "slide" && k > 0.05) {
    const low = 1 / (k + sigma2);
    const high = quantity(1 / (k - sigma2), "m");
    text += `, radius ${quantity(1 / k, "m")} (95 %: ${figure(low)} to ${high}; truly ${truth > 0.02 ? quantity(1 / truth, "m") : "none"})`;
  }
  const error = value(r, "direction_error_final_rad");
  const sigma = value(r, "direction_sigma_final_rad");
  if (isNumber(error)) {
    text += `. Its direction was ${quantity(degrees(error), "°", 1)} off at the end`;
    if (isNumber(sigma)) text += ` where it reckoned with up to ${quantity(degrees(2 * sigma), "°", 1)} (2σ)`;
  }
  return `${text}.`;
}

/** So long before the end of a phase everything of that phase is still to be seen [s]. */
const LAST_MOMENT = 0.02;

function why(run: Run, show: (time: number) => void): HTMLElement {
  const r = run.json.result;
  const box = el("section", { class: "why", "aria-label": "Why it ended" });
  if (r === null) {
    box.append(
      el("h2", {}, "The run was broken off"),
      el(
        "p",
        {},
        `The record ends in phase ${run.phaseName(run.rows - 1) || "?"} at ${quantity(run.end, "s")}; no result was written. This page shows it up to its last complete row.`,
      ),
    );
    return box;
  }
  const { what, look } = reasonWords(r.reason);
  const phase = String(r.phase ?? "?");
  const segment = run.segments.filter((s) => s.phase === phase).at(-1);
  box.append(
    el("h2", {}, outcome(run).good ? "How it ended" : "Why it did not open"),
    el(
      "p",
      {},
      `${what} `,
      el(
        "span",
        { class: "soft" },
        `(in phase “${phase}”: the robot ${phaseWords(phase)}${segment ? `, at ${quantity(segment.to, "s", 1)}` : ""})`,
      ),
    ),
  );
  if (r.explanation) box.append(el("p", { class: "said" }, `In numbers: ${r.explanation}.`));
  if (segment !== undefined) box.append(button("Show that moment", () => show(segment.to - LAST_MOMENT)));
  if (look !== undefined) box.append(el("span", { class: "soft" }, ` Look at ${look}.`));
  return box;
}

function tiles(run: Run): HTMLElement {
  const r = run.json.result;
  const list = el("dl", { class: "tiles" });
  const tile = (label: string, text: string): void => {
    list.append(el("div", { class: "tile" }, el("dt", {}, label), el("dd", {}, text)));
  };
  tile("opened, of what was wanted", quantity(100 * value(r, "opening_fraction"), "%", 0));
  tile("time of opening", quantity(value(r, "open_duration_s"), "s", 1));
  tile("peak normal force", quantity(value(r, "peak_normal_force_N"), "N", 1));
  tile("peak pull force", quantity(value(r, "peak_pull_force_N"), "N", 1));
  tile("normal force after 15 cm", quantity(value(r, "late_normal_force_N"), "N", 1));
  tile("direction error at 20 cm", quantity(degrees(value(r, "direction_error_20cm_rad")), "°", 1));
  tile("curvature error at 40 cm", quantity(value(r, "curvature_error_40cm_per_m"), "1/m"));
  tile("smallest believed distance", quantity(100 * value(r, "min_clearance_m"), "cm", 1));
  tile("unwanted contacts", figure(value(r, "unwanted_contact_count"), 0));
  tile("simulation over real time", quantity(value(r, "real_time_factor"), "×", 1));
  return list;
}

/** Lines that a reader must not miss: notes, limits, contacts, a log that breaks off. */
function remarks(run: Run, show: (time: number) => void): HTMLElement {
  const r = run.json.result;
  const list = el("ul", { class: "remarks" });
  if (run.json.cut_off)
    list.append(
      el("li", {}, `The log breaks off in the middle of a row; shown are its ${run.json.log_rows} complete rows.`),
    );
  for (const note of r?.notes ?? []) list.append(el("li", {}, `Note: ${note}.`));
  if (typeof r?.limit_violation_first === "string")
    list.append(el("li", {}, `A limit was left: ${r.limit_violation_first}.`));
  for (const contact of r?.unwanted_contacts ?? []) {
    list.append(
      el(
        "li",
        {},
        `Unwanted contact of ${spaced(contact.bodies)} with ${quantity(contact.force_N, "N", 1)} at `,
        button(quantity(contact.time, "s"), () => show(contact.time), { class: "link" }),
      ),
    );
  }
  return list;
}

export function makeVerdict(run: Run, show: (time: number) => void): HTMLElement {
  const { name, good } = outcome(run);
  const scene = run.json.scene;
  const origin = [
    scene?.robot?.name && `robot ${scene.robot.name}`,
    typeof run.json.result?.version === "string" && `version ${run.json.result.version}`,
    isNumber(run.json.result?.seed) && `seed ${run.json.result.seed}`,
  ];
  const words = el(
    "div",
    {},
    el("p", { class: "origin" }, [`Run ${run.json.name}`, ...origin.filter(Boolean)].join(" · ")),
    el("h1", {}, el("span", { class: `badge ${good ? "good" : "bad"}` }, name), ` ${headline(run)}`),
    el("p", { class: "belief" }, belief(run)),
    why(run, show),
  );
  const notes = remarks(run, show);
  if (notes.childElementCount > 0) words.append(notes);
  return el("header", { class: "verdict" }, words, tiles(run));
}

/** All scalars of the result and the complete scenario, folded away. */
export function makeFigures(run: Run): HTMLElement {
  const table = el("table", { class: "figures" });
  for (const [key, v] of Object.entries(run.json.result ?? {})) {
    if (typeof v === "object" && v !== null) continue;
    const text =
      v === null
        ? "not applicable"
        : isNumber(v)
          ? String(Number(v.toPrecision(6)))
          : JSON.stringify(v).replace(/^"|"$/g, "");
    table.append(el("tr", {}, el("th", { scope: "row" }, key), el("td", {}, text)));
  }
  return el(
    "div",
    { class: "folded" },
    el("details", {}, el("summary", {}, "All figures"), table),
    el(
      "details",
      {},
      el("summary", {}, "The scenario, complete"),
      el("pre", { tabindex: "0" }, run.json.scenario || "not kept"),
    ),
  );
}
