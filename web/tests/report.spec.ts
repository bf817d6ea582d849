import { type Page } from "@playwright/test";
import { logColumn, pageOf } from "./places";
import { expect, namelessControls, open, test } from "./watched";

const value = async (page: Page, plot: string, curve: string): Promise<string> => {
  const card = page.locator("section.plot", { has: page.getByRole("heading", { name: plot }) });
  return (await card.locator(".legend span", { hasText: curve }).first().locator("b").textContent()) ?? "";
};

const scrub = (page: Page, time: number): Promise<void> =>
  page.getByLabel("Time of the replay").evaluate((slider: HTMLInputElement, t) => {
    slider.value = String(t);
    slider.dispatchEvent(new Event("input"));
  }, time);

test("says what came of the run and how sure the robot was", async ({ page }) => {
  await open(page, pageOf("demo", "report.html"));
  await expect(page.getByRole("heading", { level: 1 })).toContainText("opened");
  await expect(page.getByRole("heading", { level: 1 })).toContainText("hinge · 9");
  await expect(page.locator(".belief")).toContainText(/a hinge, radius 0\.8\d? ?m/);
});

test("reads the right values at a time that was scrubbed to", async ({ page }) => {
  await open(page, pageOf("demo", "report.html"));
  const time = logColumn("demo", "time");
  const opening = logColumn("demo", "true_opening");
  const distance = logColumn("demo", "distance");
  for (const wanted of [18, 22.5, 27.25]) {
    await scrub(page, wanted);
    await expect(page.locator(".now")).toContainText(`${wanted.toFixed(2)} s`);
    const row = time.findLastIndex((t) => t <= wanted + 1e-6);
    // Rows stand 10 ms apart on the page; the door turns by less than 0.2° in that time.
    expect(Math.abs(parseFloat(await value(page, "Opening", "true")) - (opening[row] * 180) / Math.PI)).toBeLessThan(0.25);
    expect(Math.abs(parseFloat(await value(page, "Distance from base", "distance")) - distance[row])).toBeLessThan(0.003);
    expect(await value(page, "Opening", "true")).toMatch(/^[\d.]+°$/);
  }
});

test("keeps the peak of the normal force however the log is thinned", async ({ page }) => {
  const [time, fx, fy, fz, dx, dy, dz] = [
    "time",
    "true_force_x",
    "true_force_y",
    "true_force_z",
    "true_dir_x",
    "true_dir_y",
    "true_dir_z",
  ].map((n) => logColumn("demo", n));
  const normal = fx.map((_, i) => {
    const along = fx[i] * dx[i] + fy[i] * dy[i] + fz[i] * dz[i];
    return Math.hypot(fx[i] - along * dx[i], fy[i] - along * dy[i], fz[i] - along * dz[i]);
  });
  // The mean over 20 ms at 500 Hz.
  const mean = normal.map(
    (_, i) => normal.slice(Math.max(0, i - 9), i + 1).reduce((a, b) => a + b, 0) / Math.min(10, i + 1),
  );
  const peak = mean.indexOf(Math.max(...mean));
  await open(page, pageOf("demo", "report.html"));
  await scrub(page, time[peak] + 1e-4);
  await expect.poll(() => value(page, "Force on the handle", "normal, true")).toBe(`${mean[peak].toFixed(1)} N`);
});

test("plays, pauses and jumps by keys", async ({ page }) => {
  await open(page, pageOf("demo", "report.html"));
  const now = async (): Promise<number> => parseFloat((await page.locator(".now").textContent()) ?? "");
  await page.keyboard.press("Home");
  await expect.poll(now).toBe(0);
  await page.keyboard.press("ArrowRight");
  await expect.poll(now).toBeCloseTo(0.1, 6);
  await page.keyboard.press("Shift+ArrowRight");
  await expect.poll(now).toBeCloseTo(1.1, 6);
  await page.keyboard.press("ArrowLeft");
  await expect.poll(now).toBeCloseTo(1.0, 6);
  await page.keyboard.press(" ");
  await expect(page.getByRole("button", { name: "Pause" })).toBeVisible();
  await expect.poll(now).toBeGreaterThan(1.3);
  await page.keyboard.press(" ");
  const stood = await now();
  await page.waitForTimeout(300);
  expect(await now()).toBe(stood);
  await page.keyboard.press("End");
  await expect.poll(now).toBeGreaterThan(30);
});

test("replays with at least 30 pictures a second without a graphics card", async ({ page }) => {
  await open(page, pageOf("demo", "report.html"));
  await page.keyboard.press("Home");
  await page.keyboard.press(" ");
  await page.waitForTimeout(1000);
  const rates: number[] = [];
  for (let i = 0; i < 5; ++i) {
    const rate = await page.evaluate(
      () =>
        new Promise<number>((done) => {
          const viewer = document.querySelector<HTMLElement>(".viewer")!;
          const from = Number(viewer.dataset.frames);
          const start = performance.now();
          setTimeout(() => done((1000 * (Number(viewer.dataset.frames) - from)) / (performance.now() - start)), 1000);
        }),
    );
    rates.push(rate);
  }
  rates.sort((a, b) => a - b);
  console.log(`pictures per second, median of ${rates.length}: ${rates[2].toFixed(1)}`);
  expect(rates[2]).toBeGreaterThanOrEqual(30);
});

test("hovering a plot reads values with units, a click moves the replay, a drag zooms all plots", async ({ page }) => {
  await open(page, pageOf("demo", "report.html"));
  const over = page.locator("section.plot .u-over").nth(1);
  const box = (await over.boundingBox())!;
  await page.mouse.move(box.x + box.width * 0.7, box.y + 40);
  const hovered = await value(page, "Force on the handle", "normal, true");
  expect(hovered).toMatch(/^-?[\d.]+ N$/);
  await page.mouse.down();
  await page.mouse.up();
  const end = logColumn("demo", "time").at(-1)!;
  const now = parseFloat((await page.locator(".now").textContent()) ?? "");
  expect(Math.abs(now - 0.7 * end)).toBeLessThan(0.08 * end);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.9, box.y + 40, { steps: 4 });
  await page.mouse.up();
  const labels = await page.locator("section.plot .u-over").count();
  expect(labels).toBeGreaterThan(8);
  await page.mouse.dblclick(box.x + box.width * 0.5, box.y + 40);
});

test("a newcomer reads why a run failed", async ({ page }) => {
  await open(page, pageOf("locked", "report.html"));
  const why = page.getByRole("region", { name: "Why it ended" });
  await expect(why).toContainText("Why it did not open");
  await expect(why).toContainText("nothing gave: it is locked or stuck");
  await expect(why).toContainText("nothing gives at");
  await page.getByRole("button", { name: "Show that moment" }).click();
  await expect(page.locator(".now")).toContainText("probe");
});

test("a run that was killed is shown up to its last complete row", async ({ page }) => {
  await open(page, pageOf("cut", "report.html"));
  await expect(page.getByRole("heading", { level: 1 })).toContainText("broken off");
  await expect(page.getByRole("heading", { name: "The run was broken off" })).toBeVisible();
  const rows = logColumn("cut", "time").length - 1;
  await expect(page.locator(".remarks")).toContainText(`its ${rows} complete rows`);
});

test("text of files stays text", async ({ page }) => {
  await open(page, pageOf("<b>odd", "report.html"));
  await expect(page.locator(".said")).toContainText("<img src=x onerror=alert(1)></script>");
  await expect(page.locator(".origin")).toContainText("Run <b>odd");
  await page.getByText("The scenario, complete").click();
  await expect(page.locator("pre")).toContainText("<script>alert(2)</script>");
});

test("two runs lie on top of each other", async ({ page }) => {
  await open(page, pageOf("comparison.html"));
  await expect(page.getByRole("heading", { level: 1 })).toHaveText("2 runs");
  await expect(page.locator(".compared thead")).toContainText("demo");
  await expect(page.locator(".compared thead")).toContainText("drawer");
  await scrub(page, 2);
  const share = page.locator("section.plot", { hasText: "Opening, share of what was wanted" });
  await expect(share.locator(".legend b").first()).toHaveText(/%$/);
  await expect(share.locator(".legend b").nth(1)).toHaveText(/%$/);
  await page.getByLabel("Lay the runs on top of each other by").selectOption("start");
  await expect(page.locator(".now").first()).toContainText("2.00 s");
});

for (const scheme of ["light", "dark"] as const) {
  test(`has a name for every control and fits a phone, ${scheme}`, async ({ page }) => {
    await page.emulateMedia({ colorScheme: scheme });
    await page.setViewportSize({ width: 390, height: 800 });
    await open(page, pageOf("demo", "report.html"));
    expect(await namelessControls(page)).toEqual([]);
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    expect(width).toBeLessThanOrEqual(390);
    const background = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    expect(background).toBe(scheme === "dark" ? "rgb(18, 21, 25)" : "rgb(244, 245, 247)");
  });
}
