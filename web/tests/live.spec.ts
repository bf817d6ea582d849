import { spawn, type ChildProcess } from "node:child_process";
import { join } from "node:path";
import { AJAR, DATA, SCENARIOS } from "./places";
import { expect, test } from "./watched";

interface Program {
  child: ChildProcess;
  address: string;
  ended: Promise<number>;
}

/** Starts the program and waits for the address that it prints. */
function start(...args: string[]): Promise<Program> {
  const child = spawn(AJAR, args, { cwd: DATA });
  const ended = new Promise<number>((done) => child.on("exit", (code) => done(code ?? -1)));
  return new Promise((done, fail) => {
    let text = "";
    const look = (chunk: Buffer): void => {
      text += chunk.toString();
      const address = /http:\/\/127\.0\.0\.1:\d+\/[0-9a-f]{32}\//.exec(text)?.[0];
      if (address !== undefined) done({ child, address, ended });
    };
    child.stderr.on("data", look);
    child.stdout.on("data", look);
    void ended.then(() => fail(new Error(text)));
  });
}

test("a run is watched while it goes on, and its report follows", async ({ page }) => {
  const run = await start(
    "run",
    join(SCENARIOS, "kinematic_door.toml"),
    "--live",
    "--speed",
    "6",
    "--quiet",
    "--out",
    join(DATA, "live"),
  );
  await page.goto(run.address);
  await expect(page.getByRole("heading", { level: 1 })).toContainText("opening", { timeout: 10_000 });
  await expect(page.getByRole("heading", { level: 1 })).toContainText("the robot opens", { timeout: 20_000 });
  await expect(page.getByRole("heading", { name: "How it ended" })).toBeVisible({ timeout: 30_000 });
  expect(await run.ended).toBe(0);
});

test("the stop button stops the robot safely", async ({ page }) => {
  const run = await start("run", join(SCENARIOS, "demo.toml"), "--live", "--quiet", "--out", join(DATA, "stopped"));
  await page.goto(run.address);
  await expect(page.getByRole("heading", { level: 1 })).toContainText("drives up", { timeout: 10_000 });
  await page.getByRole("button", { name: "Stop the robot" }).click();
  await expect(page.getByText("Somebody stopped it.")).toBeVisible({ timeout: 10_000 });
  expect(await run.ended).toBe(1);
});

test("nobody gets in without the token or under another name", async ({ request }) => {
  const run = await start(
    "run",
    join(SCENARIOS, "kinematic_door.toml"),
    "--live",
    "--quiet",
    "--out",
    join(DATA, "guarded"),
  );
  const { origin, host } = new URL(run.address);
  expect((await request.get(run.address)).status()).toBe(200);
  expect((await request.get(`${origin}/`)).status()).toBe(404);
  expect((await request.get(`${origin}/${"0".repeat(32)}/`)).status()).toBe(404);
  expect((await request.post(`${origin}/${"0".repeat(32)}/stop`)).status()).toBe(404);
  expect((await request.get(run.address, { headers: { Host: `evil.example:${host.split(":")[1]}` } })).status()).toBe(403);
  run.child.kill("SIGINT");
  await run.ended;
});

test("a campaign is served, and a replay that was not kept is made on a click", async ({ page }) => {
  const view = await start("view", join(DATA, "large"));
  await page.goto(view.address);
  await page
    .getByRole("button", { name: /why it ended, replay/ })
    .first()
    .click();
  const link = page.getByRole("link", { name: "Open its replay" });
  await page.goto(new URL((await link.getAttribute("href"))!, view.address).href);
  await expect(page.getByRole("heading", { level: 1 })).toContainText("hinge", { timeout: 20_000 });
  view.child.kill("SIGINT");
  expect(await view.ended).toBe(0);
});
