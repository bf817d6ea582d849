/** The page of a campaign: what came of all runs, by what it depends, and every single one to look at. */
import { quantile, sortedValues, wilson, type Campaign } from "./campaign";
import { histogramCard, readable, successCard } from "./charts";
import { button, el } from "./dom";
import { figure, quantity } from "./format";
import { filterRows } from "./filter";
import { phaseWords, reasonWords } from "./reasons";
import { Table, type Column } from "./table";

const FIGURES = [
  "peak_normal_force_N", "late_normal_force_N", "peak_pull_force_N", "stop_force_N", "open_duration_s", "duration_s",
  "direction_error_20cm_rad", "curvature_error_40cm_per_m", "path_error_max_m", "real_time_factor",
]; // prettier-ignore

const COLUMNS: Column[] = [
  { name: "run", label: "run", width: 70, digits: 0 },
  { name: "outcome", label: "outcome", width: 95 },
  { name: "phase", label: "phase", width: 90 },
  { name: "reason", label: "reason", width: 180 },
  { name: "mechanism_type_true", label: "type", width: 70 },
  { name: "opening_fraction", label: "opened %", width: 95, digits: 0, share: true },
  { name: "open_duration_s", label: "opening s", width: 100, digits: 1 },
  { name: "peak_normal_force_N", label: "peak force N", width: 120, digits: 1 },
  { name: "peak_pull_force_N", label: "pull N", width: 80, digits: 1 },
  { name: "direction_error_20cm_rad", label: "dir. error °", width: 110, digits: 1, angle: true },
  { name: "unwanted_contact_count", label: "contacts", width: 95, digits: 0 },
];

function tableColumns(campaign: Campaign): Column[] {
  const known = campaign.columns();
  const drawn = campaign.json.parameters.map((name) => {
    const label = name.replace(/^mechanism\./, "");
    return { name, label, width: Math.max(90, 9 * label.length + 34) };
  });
  return [...COLUMNS, ...drawn, { name: "explanation", label: "explanation", width: 460 }].filter((c) =>
    known.includes(c.name),
  );
}

function summary(campaign: Campaign, rows: number[]): HTMLElement {
  const list = el("dl", { class: "tiles" });
  const tile = (label: string, text: string): void => {
    list.append(el("div", { class: "tile" }, el("dt", {}, label), el("dd", {}, text)));
  };
  const opened = rows.filter((r) => campaign.opened(r));
  const clean = opened.filter((r) => campaign.number("unwanted_contact_count", r) === 0).length;
  const [low, high] = wilson(opened.length, rows.length);
  tile("runs", String(rows.length));
  tile("opened", rows.length > 0 ? quantity((100 * opened.length) / rows.length, "%", 1) : "–");
  tile("opened truly lies (95 %)", rows.length > 0 ? `${figure(100 * low, 1)} to ${figure(100 * high, 1)} %` : "–");
  tile("opened without contact", rows.length > 0 ? quantity((100 * clean) / rows.length, "%", 1) : "–");
  for (const column of ["peak_normal_force_free_N", "open_duration_s", "direction_error_20cm_rad"]) {
    const { label, scale, unit } = readable(column);
    const sorted = sortedValues(campaign, column, rows).map(scale);
    tile(`${label}, p90`, quantity(quantile(sorted, 0.9), unit, 1));
  }
  return list;
}

/** Reasons of the runs that did not open, the most frequent first; each is a button that filters. */
function reasons(campaign: Campaign, rows: number[], pick: (filter: string) => void): HTMLElement {
  const counts = new Map<string, number>();
  for (const row of rows)
    if (!campaign.opened(row)) counts.set(campaign.text("reason", row), (counts.get(campaign.text("reason", row)) ?? 0) + 1);
  const list = el("ul", { class: "reasons" });
  for (const [reason, count] of [...counts].sort((a, b) => b[1] - a[1])) {
    const item = button(`${count} × ${reason.replace(/_/g, " ")}`, () => pick(`outcome:stopped reason:${reason}`));
    list.append(el("li", {}, item, ` ${reasonWords(reason).what}`));
  }
  if (counts.size === 0) list.append(el("li", {}, "Every run opened."));
  return list;
}

function replayOf(campaign: Campaign, row: number): HTMLElement {
  const run = campaign.number("run", row);
  const folder = `runs/${String(run).padStart(5, "0")}`;
  const served = location.protocol.startsWith("http");
  if (campaign.stored.has(run) || served) {
    const link = el(
      "a",
      { href: served ? `replay/${run}` : `${folder}/report.html`, target: "_blank", rel: "noopener" },
      "Open its replay",
    );
    return el("p", {}, link, campaign.stored.has(run) ? "" : " (it is made again from its seed, which takes some seconds)");
  }
  const command = `ajar campaign ${campaign.json.origin} --seed ${campaign.json.seed} --replay ${run} --out ${campaign.json.folder}`;
  const box = el("p", {}, "Its replay was not kept. This makes it again from its seed: ", el("code", {}, command), " ");
  box.append(button("Copy", () => void navigator.clipboard.writeText(command)));
  box.append(el("span", { class: "soft" }, ` or look at this folder with ajar view, where a click makes it.`));
  return box;
}

function details(campaign: Campaign, row: number): HTMLElement[] {
  const reason = campaign.text("reason", row);
  const phase = campaign.text("phase", row);
  const drawn = campaign.json.parameters.map((name) => {
    const { label, scale, unit } = readable(name);
    const text = campaign.isNumber(name) ? quantity(scale(campaign.number(name, row)), unit) : campaign.text(name, row);
    return `${label} ${text || "–"}`;
  });
  const explanation = campaign.text("explanation", row);
  return [
    el("h2", {}, `Run ${campaign.number("run", row)}: ${campaign.text("outcome", row)}`),
    el(
      "p",
      {},
      `${reasonWords(reason).what} `,
      el("span", { class: "soft" }, phase && `(in phase “${phase}”: the robot ${phaseWords(phase)})`),
    ),
    ...(explanation === "" ? [] : [el("p", { class: "said" }, `In numbers: ${explanation}.`)]),
    replayOf(campaign, row),
    el("p", { class: "soft" }, `Seed ${campaign.text("seed", row)}. Drawn: ${drawn.join(", ")}.`),
  ];
}

/** Everything that changes with the filter. */
class Board {
  readonly tiles = el("div");
  readonly reasons = el("div");
  readonly success = el("div", { class: "minis" });
  readonly figures = el("div", { class: "minis" });
  readonly details = el(
    "section",
    { class: "why", "aria-live": "polite", "aria-label": "The chosen run" },
    el("p", { class: "soft" }, "Choose a row to read why that run ended and to see its replay."),
  );
  readonly message = el("span", { class: "soft", role: "status" });
  readonly search = el("input", {
    type: "search",
    "aria-label": "Filter the runs",
    placeholder: "e.g. stopped  reason:grasp_lost  peak_normal_force_N>10",
    spellcheck: "false",
  });
  private readonly table: Table;

  constructor(private readonly campaign: Campaign) {
    this.table = new Table(campaign, tableColumns(campaign), (row) =>
      this.details.replaceChildren(...details(campaign, row)),
    );
    this.search.addEventListener("input", () => this.update());
    this.update();
  }

  get tableElement(): HTMLElement {
    return this.table.element;
  }

  pick(filter: string): void {
    this.search.value = filter;
    this.update();
    this.search.focus();
  }

  update(): void {
    let rows: number[];
    try {
      rows = filterRows(this.campaign, this.search.value);
    } catch (error) {
      this.message.textContent = (error as Error).message;
      return;
    }
    this.message.textContent = `${rows.length} of ${this.campaign.rows} runs`;
    const pick = (filter: string): void => this.pick(filter);
    const cards = (made: (HTMLElement | null)[]): HTMLElement[] => made.filter((c) => c !== null);
    this.tiles.replaceChildren(summary(this.campaign, rows));
    this.reasons.replaceChildren(reasons(this.campaign, rows, pick));
    this.success.replaceChildren(
      ...cards(this.campaign.json.parameters.map((p) => successCard(this.campaign, p, rows, pick))),
    );
    this.figures.replaceChildren(...cards(FIGURES.map((f) => histogramCard(this.campaign, f, rows))));
    this.table.show(rows);
  }
}

export function showCampaign(root: HTMLElement, campaign: Campaign): void {
  const board = new Board(campaign);
  const filters = el(
    "div",
    { class: "bar" },
    board.search,
    button("All", () => board.pick("")),
    button("Failures", () => board.pick("outcome:stopped")),
    board.message,
  );
  root.append(
    el(
      "header",
      {},
      el(
        "p",
        { class: "origin" },
        `Campaign ${campaign.json.name} · ${campaign.json.origin.replace(/.*\//, "")} · seed ${campaign.json.seed}`,
      ),
      el("h1", {}, "What came of the runs"),
      board.tiles,
    ),
    el("section", {}, el("h2", {}, "Why runs did not open"), board.reasons),
    el("section", { class: "sticky" }, el("h2", {}, "Runs"), filters, board.tableElement, board.details),
    el(
      "section",
      {},
      el("h2", {}, "Success by what was drawn"),
      el(
        "p",
        { class: "soft" },
        "Height: share that opened; line: where the share truly lies at 95 %. A click shows those runs.",
      ),
      board.success,
    ),
    el(
      "section",
      {},
      el("h2", {}, "Distributions"),
      el("p", { class: "soft" }, "Green opened, red did not."),
      board.figures,
    ),
  );
}
