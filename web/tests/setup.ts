/** Makes with the real program what the tests look at: runs that opened, failed and were killed, and a campaign. */
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, readFileSync, rmSync, truncateSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { AJAR, DATA, SCENARIOS } from "./places";

function ajar(...args: string[]): void {
  try {
    execFileSync(AJAR, args, { stdio: ["ignore", "ignore", "inherit"] });
  } catch (error) {
    // 1: the mission ended safely without its goal, which some of these are meant to do.
    if ((error as { status?: number }).status !== 1) throw error;
  }
}

/** Ten thousand rows from a few real ones, with other numbers. */
function enlarge(from: string, to: string, rows: number): void {
  mkdirSync(to, { recursive: true });
  const [head, ...body] = readFileSync(join(from, "runs.csv"), "utf8").trimEnd().split("\n");
  const lines = [head];
  for (let i = 0; i < rows; ++i) {
    const cells = body[i % body.length].split(",");
    const change = 0.8 + 0.4 * ((i * 0.6180339887) % 1);
    lines.push(
      cells.map((c, k) => (k === 0 ? String(i) : /^\d+\.\d+$/.test(c) ? (Number(c) * change).toPrecision(6) : c)).join(","),
    );
  }
  writeFileSync(join(to, "runs.csv"), `${lines.join("\n")}\n`);
  cpSync(join(from, "origin.json"), join(to, "origin.json"));
}

const CAMPAIGN = `runs = 6
seed = 3
[sample.keys]
"mechanism.radius_m" = { uniform = [0.4, 0.9] }
"belief.direction_error_deg" = { uniform = [0, 60] }
"mechanism.coulomb" = { choice = [1.0, 90.0] }
[base.mechanism]
type = "hinge"
[base.plant]
kind = "kinematic"
[base.goal]
opening_deg = 15
`;

export default function setup(): void {
  rmSync(DATA, { recursive: true, force: true });
  mkdirSync(DATA, { recursive: true });
  for (const name of ["demo", "locked", "drawer"])
    ajar("run", join(SCENARIOS, `${name}.toml`), "--quiet", "--out", join(DATA, name));
  const cut = join(DATA, "cut");
  cpSync(join(DATA, "demo"), cut, { recursive: true });
  rmSync(join(cut, "result.json"));
  truncateSync(join(cut, "log.csv"), Math.floor(statSync(join(cut, "log.csv")).size * 0.6));
  ajar("report", cut);
  const odd = join(DATA, "<b>odd");
  cpSync(join(DATA, "locked"), odd, { recursive: true });
  const result = JSON.parse(readFileSync(join(odd, "result.json"), "utf8")) as Record<string, unknown>;
  result.explanation = "<img src=x onerror=alert(1)></script>";
  writeFileSync(join(odd, "result.json"), JSON.stringify(result));
  writeFileSync(join(odd, "scenario.toml"), "# <script>alert(2)</script>\n");
  ajar("report", odd);
  ajar("report", join(DATA, "demo"), join(DATA, "drawer"), "--out", join(DATA, "comparison.html"));
  writeFileSync(join(DATA, "campaign.toml"), CAMPAIGN);
  ajar("campaign", join(DATA, "campaign.toml"), "--quiet", "--out", join(DATA, "small"));
  enlarge(join(DATA, "small"), join(DATA, "large"), 10_000);
  ajar("report", join(DATA, "large"));
}
