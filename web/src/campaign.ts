/** The rows of a campaign by column, as campaign_page.cpp packed them. */
import { unpackColumns } from "./unpack";

export interface CampaignJson {
  name: string;
  /** As it was called when the page was made. */
  folder: string;
  /** Campaign file and seed that give the same runs again. */
  origin: string;
  seed: string;
  rows: number;
  numbers: string[];
  data: string;
  texts: Record<string, { values: string[]; index: number[] }>;
  /** Columns that were drawn for every run. */
  parameters: string[];
  /** Run numbers whose folder has a report. */
  stored: number[];
}

export class Campaign {
  private readonly numbers = new Map<string, Float32Array>();
  readonly stored: Set<number>;

  private constructor(readonly json: CampaignJson) {
    this.stored = new Set(json.stored);
  }

  static async load(json: CampaignJson): Promise<Campaign> {
    const campaign = new Campaign(json);
    const columns = await unpackColumns(json.data, json.numbers.length, json.rows);
    json.numbers.forEach((name, i) => campaign.numbers.set(name, columns[i]));
    return campaign;
  }

  get rows(): number {
    return this.json.rows;
  }

  isNumber(column: string): boolean {
    return this.numbers.has(column);
  }
  number(column: string, row: number): number {
    return this.numbers.get(column)?.[row] ?? NaN;
  }
  text(column: string, row: number): string {
    const texts = this.json.texts[column];
    return texts === undefined ? "" : (texts.values[texts.index[row]] ?? "");
  }
  columns(): string[] {
    return [...this.json.numbers, ...Object.keys(this.json.texts)];
  }
  opened(row: number): boolean {
    return this.text("outcome", row) === "opened";
  }
}

/** Share with the interval in which it truly lies at 95 % (Wilson 1927, equation of the score interval). */
export function wilson(good: number, all: number): [number, number] {
  if (all === 0) return [0, 1];
  const z = 1.96;
  const p = good / all;
  const middle = (p + (z * z) / (2 * all)) / (1 + (z * z) / all);
  const half = (z / (1 + (z * z) / all)) * Math.sqrt((p * (1 - p)) / all + (z * z) / (4 * all * all));
  return [Math.max(0, middle - half), Math.min(1, middle + half)];
}

/** Finite values of a column in rising order. */
export function sortedValues(campaign: Campaign, column: string, rows: number[]): Float32Array {
  const values = new Float32Array(rows.length);
  let count = 0;
  for (const row of rows) {
    const v = campaign.number(column, row);
    if (Number.isFinite(v)) values[count++] = v;
  }
  return values.subarray(0, count).sort();
}

export function quantile(sorted: ArrayLike<number>, share: number): number {
  if (sorted.length === 0) return NaN;
  const at = share * (sorted.length - 1);
  const low = Math.floor(at);
  return sorted[low] + (at - low) * ((sorted[low + 1] ?? sorted[low]) - sorted[low]);
}
