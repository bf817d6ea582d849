/** Makes docs/pictures from runs of the built program: ./dev pictures. */
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "@playwright/test";
import { BROWSER } from "./browser.js";

const ROOT = join(import.meta.dirname, "..");
const PICTURES = join(ROOT, "docs", "pictures");
const folder = mkdtempSync(join(tmpdir(), "ajar-pictures-"));

function ajar(...args) {
  try {
    execFileSync(join(ROOT, "build", "bin", "ajar"), args, { cwd: ROOT, stdio: ["ignore", "ignore", "inherit"] });
  } catch (error) {
    if (error.status !== 1) throw error; // 1: ended safely without the goal, as some of these shall
  }
}

function makeRuns() {
  for (const name of ["demo", "locked"]) ajar("run", `scenarios/${name}.toml`, "--quiet", "--out", join(folder, name));
  const wrong = ["--set", "belief.direction_error_deg=60", "--seed", "3"];
  ajar("run", "scenarios/demo.toml", ...wrong, "--quiet", "--out", join(folder, "guess wrong by 60°"));
  ajar("report", join(folder, "demo"), join(folder, "guess wrong by 60°"), "--out", join(folder, "comparison.html"));
  ajar("campaign", "campaigns/doors.toml", "--runs", "24", "--quiet", "--out", join(folder, "doors"));
}

const SHOTS = [
  { name: "run", page: "demo/report.html", height: 980 },
  { name: "failure", page: "locked/report.html", height: 980, dark: true },
  { name: "comparison", page: "comparison.html", height: 1000, time: 6 },
  {
    name: "campaign",
    page: "doors/report.html",
    height: 1250,
    act: (page) => page.getByRole("button", { name: "Failures" }).click(),
  },
];

mkdirSync(PICTURES, { recursive: true });
makeRuns();
const browser = await chromium.launch(BROWSER);
for (const shot of SHOTS) {
  const page = await browser.newPage({
    viewport: { width: 1360, height: shot.height },
    colorScheme: shot.dark ? "dark" : "light",
  });
  await page.goto(pathToFileURL(join(folder, shot.page)).href);
  await page.locator("#page[data-ready]").waitFor();
  if (shot.time !== undefined) {
    await page.getByLabel("Time of the replay").evaluate((slider, time) => {
      slider.value = String(time);
      slider.dispatchEvent(new Event("input"));
    }, shot.time);
  }
  await shot.act?.(page);
  await page.waitForTimeout(1000); // the picture that was asked for last is drawn
  await page.screenshot({ path: join(PICTURES, `${shot.name}.png`) });
  await page.close();
}
await browser.close();
rmSync(folder, { recursive: true });
