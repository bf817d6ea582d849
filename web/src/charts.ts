/** Bars of a campaign: success by what was drawn, distributions of what came out. */
import { quantile, sortedValues, wilson, type Campaign } from "./campaign";
import { el } from "./dom";
import { degrees, figure, quantity } from "./format";

const BINS = 8;

/** Columns in radians or ratios, as people read them. */
export function readable(column: string): { label: string; scale: (v: number) => number; unit: string } {
  const units: [RegExp, string, (v: number) => number][] = [
    [/_rad$/, "°", degrees],
    [/_deg$/, "°", (v) => v],
    [/_per_m$/, "1/m", (v) => v],
    [/_Nm$/, "N m", (v) => v],
    [/_N$/, "N", (v) => v],
    [/_ms$/, "ms", (v) => v],
    [/_m$/, "m", (v) => v],
    [/_s$/, "s", (v) => v],
  ];
  for (const [end, unit, scale] of units) {
    if (end.test(column)) return { label: column.replace(end, "").replace(/[_.]/g, " "), scale, unit };
  }
  return { label: column.replace(/[_.]/g, " "), scale: (v) => v, unit: "" };
}

interface Bin {
  label: string;
  filter: string;
  good: number;
  all: number;
}

/** The different values if there are few enough for a bar each, else null. */
function fewValues(sorted: Float32Array): number[] | null {
  const different: number[] = [];
  for (const v of sorted) {
    if (v === different.at(-1)) continue;
    different.push(v);
    if (different.length > BINS) return null;
  }
  return different;
}

function numberBins(campaign: Campaign, column: string, rows: number[]): Bin[] {
  const sorted = sortedValues(campaign, column, rows);
  if (sorted.length === 0 || sorted[0] === sorted[sorted.length - 1]) return [];
  const few = fewValues(sorted);
  const edges = few ?? [...new Set(Array.from({ length: BINS + 1 }, (_, i) => quantile(sorted, i / BINS)))];
  if (few !== null) edges.push(Infinity);
  const { scale, unit } = readable(column);
  const bins: Bin[] = [];
  for (let b = 0; b + 1 < edges.length; ++b) {
    const [low, high] = [edges[b], edges[b + 1]];
    const last = b + 2 === edges.length;
    const single = few !== null;
    const label = single ? quantity(scale(low), unit) : `${figure(scale(low))} to ${quantity(scale(high), unit)}`;
    bins.push({
      label,
      filter: `${column}>=${low} ${column}${last ? "<=" : "<"}${high === Infinity ? 1e30 : high}`,
      good: 0,
      all: 0,
    });
  }
  for (const row of rows) {
    const v = campaign.number(column, row);
    if (!Number.isFinite(v)) continue;
    let b = bins.length - 1;
    while (b > 0 && v < edges[b]) --b;
    bins[b].all += 1;
    if (campaign.opened(row)) bins[b].good += 1;
  }
  return bins;
}

function textBins(campaign: Campaign, column: string, rows: number[]): Bin[] {
  const bins = new Map<string, Bin>();
  for (const row of rows) {
    const text = campaign.text(column, row);
    const bin = bins.get(text) ?? { label: text || "none", filter: `${column}:${text}`, good: 0, all: 0 };
    bin.all += 1;
    if (campaign.opened(row)) bin.good += 1;
    bins.set(text, bin);
  }
  return bins.size > 1 && bins.size <= 12 ? [...bins.values()].sort((a, b) => a.label.localeCompare(b.label)) : [];
}

/** Share of opened runs by a drawn parameter; a bar is a button that filters. Null where there is nothing to tell. */
export function successCard(
  campaign: Campaign,
  column: string,
  rows: number[],
  pick: (filter: string) => void,
): HTMLElement | null {
  const bins = (campaign.isNumber(column) ? numberBins : textBins)(campaign, column, rows).filter((b) => b.all > 0);
  if (bins.length < 2) return null;
  const bars = el("div", { class: "bars" });
  for (const bin of bins) {
    const share = bin.good / bin.all;
    const [low, high] = wilson(bin.good, bin.all);
    const words = `${readable(column).label} ${bin.label}: ${bin.good} of ${bin.all} opened (${figure(100 * share, 0)} %)`;
    const bar = el("button", { type: "button", class: "column", title: words, "aria-label": words });
    bar.append(
      el("i", { class: "share", style: `height:${100 * share}%` }),
      el("i", { class: "doubt", style: `bottom:${100 * low}%;height:${100 * (high - low)}%` }),
    );
    bar.addEventListener("click", () => pick(bin.filter));
    bars.append(bar);
  }
  const ends = el("div", { class: "ends" }, el("span", {}, bins[0].label), el("span", {}, bins[bins.length - 1].label));
  return el("section", { class: "card mini" }, el("h3", {}, readable(column).label), bars, ends);
}

/** Digits with which values up to a size are told apart. */
const digitsFor = (size: number): number => (size < 0.05 ? 4 : size < 1 ? 3 : size < 20 ? 2 : 1);

/** How often which value came out, opened runs and others on top of each other; values beyond p99 share the last bar. */
export function histogramCard(campaign: Campaign, column: string, rows: number[]): HTMLElement | null {
  const { label, scale, unit } = readable(column);
  const sorted = sortedValues(campaign, column, rows).map(scale);
  if (sorted.length < 2) return null;
  const low = Math.min(0, sorted[0]);
  const high = quantile(sorted, 0.99) || sorted[sorted.length - 1] || 1;
  const count = 24;
  const digits = digitsFor(high);
  const good = new Array<number>(count).fill(0);
  const bad = new Array<number>(count).fill(0);
  for (const row of rows) {
    const v = scale(campaign.number(column, row));
    if (!Number.isFinite(v)) continue;
    const bin = Math.min(count - 1, Math.max(0, Math.floor((count * (v - low)) / (high - low || 1))));
    (campaign.opened(row) ? good : bad)[bin] += 1;
  }
  const most = Math.max(...good.map((g, i) => g + bad[i]));
  const bars = el("div", { class: "bars" });
  for (let i = 0; i < count; ++i) {
    const from = low + ((high - low) * i) / count;
    const to = i + 1 === count ? sorted[sorted.length - 1] : low + ((high - low) * (i + 1)) / count;
    const bar = el("span", {
      class: "column",
      title: `${figure(from, digits)} to ${quantity(to, unit, digits)}: ${good[i]} opened, ${bad[i]} not`,
    });
    bar.append(
      el("i", { class: "share", style: `height:${(100 * good[i]) / most}%` }),
      el("i", { class: "rest", style: `bottom:${(100 * good[i]) / most}%;height:${(100 * bad[i]) / most}%` }),
    );
    bars.append(bar);
  }
  const words = `median ${quantity(quantile(sorted, 0.5), unit, digits)} · p90 ${quantity(quantile(sorted, 0.9), unit, digits)} · largest ${quantity(sorted[sorted.length - 1], unit, digits)}`;
  const ends = el(
    "div",
    { class: "ends" },
    el("span", {}, figure(low)),
    el("span", {}, `≥ ${quantity(high, unit, digits)}`),
  );
  bars.setAttribute("role", "img");
  bars.setAttribute("aria-label", `Distribution of ${label}: ${words}`);
  return el("section", { class: "card mini" }, el("h3", {}, label), bars, ends, el("p", { class: "soft" }, words));
}
