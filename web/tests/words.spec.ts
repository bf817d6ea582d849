/** Every name that the program gives a phase or an end must have words on the page. */
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { PHASES, REASONS } from "../src/reasons";
import { expect, test } from "@playwright/test";

const source = readFileSync(join(import.meta.dirname, "..", "..", "src", "mission", "mission.cpp"), "utf8");
const names = (of: string): string[] =>
  [...source.matchAll(new RegExp(`case ${of}::\\w+: return "(\\w+)";`, "g"))].map((m) => m[1]);

test("every phase and every end of a mission has its words", () => {
  expect(names("Phase").length).toBeGreaterThan(10);
  expect(names("EndReason").length).toBeGreaterThan(15);
  expect(names("Phase").filter((n) => !(n in PHASES))).toEqual([]);
  expect(names("EndReason").filter((n) => !(n in REASONS))).toEqual([]);
});
