/** What the reader types above the table: words, `column:word`, `column>number`; all must hold. */
import type { Campaign } from "./campaign";

type Test = (row: number) => boolean;

const COMPARE: Record<string, (a: number, b: number) => boolean> = {
  "<": (a, b) => a < b,
  "<=": (a, b) => a <= b,
  ">": (a, b) => a > b,
  ">=": (a, b) => a >= b,
  "=": (a, b) => a === b,
};

/** The column a reader means: its name, or the only one that contains what was typed. */
function findColumn(campaign: Campaign, typed: string): string {
  const columns = campaign.columns();
  if (columns.includes(typed)) return typed;
  const close = columns.filter((c) => c.toLowerCase().includes(typed.toLowerCase()));
  if (close.length === 1) return close[0];
  throw new Error(close.length === 0 ? `no column “${typed}”` : `“${typed}” may be ${close.slice(0, 4).join(", ")}`);
}

function wordTest(campaign: Campaign, word: string): Test {
  const needle = word.toLowerCase();
  // Each different text is looked at once, however many rows have it.
  const hits = Object.values(campaign.json.texts).map((texts) => ({
    index: texts.index,
    hit: texts.values.map((v) => v.toLowerCase().includes(needle)),
  }));
  return (row) => hits.some(({ index, hit }) => hit[index[row]]);
}

function compile(campaign: Campaign, token: string): Test {
  const compared = /^([\w.]+)(<=|>=|<|>|=)(-?[\d.]+(?:e-?\d+)?)$/i.exec(token);
  if (compared !== null) {
    const column = findColumn(campaign, compared[1]);
    const holds = COMPARE[compared[2]];
    const limit = Number(compared[3]);
    return (row) => holds(campaign.number(column, row), limit);
  }
  const named = /^([\w.]+):(.*)$/.exec(token);
  if (named === null) return wordTest(campaign, token);
  const column = findColumn(campaign, named[1]);
  const needle = named[2].toLowerCase();
  if (campaign.isNumber(column)) return (row) => campaign.number(column, row) === Number(needle);
  const texts = campaign.json.texts[column];
  const hit = texts.values.map((v) => v.toLowerCase() === needle || (needle !== "" && v.toLowerCase().includes(needle)));
  return (row) => hit[texts.index[row]];
}

/** Rows that pass. @throws Error with words for the reader if the filter cannot be understood */
export function filterRows(campaign: Campaign, text: string): number[] {
  const tests = text
    .split(/\s+/)
    .filter((t) => t !== "")
    .map((t) => compile(campaign, t));
  const out: number[] = [];
  for (let row = 0; row < campaign.rows; ++row) if (tests.every((t) => t(row))) out.push(row);
  return out;
}
