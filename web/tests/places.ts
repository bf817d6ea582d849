import { readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const ROOT = join(import.meta.dirname, "..", "..");
export const AJAR = process.env.AJAR ?? join(ROOT, "build", "bin", "ajar");
export const SCENARIOS = join(ROOT, "scenarios");
export const DATA = join(ROOT, "web", "test-results", "data");

export const pageOf = (...parts: string[]): string => pathToFileURL(join(DATA, ...parts)).href;

/** One column of a log as the program wrote it. */
export function logColumn(run: string, name: string): number[] {
  const [head, ...rows] = readFileSync(join(DATA, run, "log.csv"), "utf8")
    .trimEnd()
    .split("\n");
  const at = head.split(",").indexOf(name);
  return rows.map((row) => Number(row.split(",")[at]));
}
