import { pageOf } from "./places";
import { expect, namelessControls, open, test } from "./watched";

test("filters ten thousand rows in less than 200 ms", async ({ page }) => {
  await open(page, pageOf("large", "report.html"));
  const search = page.getByLabel("Filter the runs");
  const times: number[] = [];
  for (const filter of ["outcome:stopped", "hinge peak_normal_force_N>3", "reason:goal_reached run<5000", "", "stopped"]) {
    times.push(
      await search.evaluate(
        (input: HTMLInputElement, text) =>
          new Promise<number>((done) => {
            const start = performance.now();
            input.value = text;
            input.dispatchEvent(new Event("input"));
            // The second frame after the change is on the screen.
            requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now() - start)));
          }),
        filter,
      ),
    );
  }
  times.sort((a, b) => a - b);
  console.log(`filter of 10 000 rows to the picture [ms]: ${times.map((t) => t.toFixed(0)).join(", ")}`);
  expect(times[2]).toBeLessThan(200);
  await expect(page.getByRole("status")).toContainText("of 10000 runs");
});

test("sorts and scrolls ten thousand rows", async ({ page }) => {
  await open(page, pageOf("large", "report.html"));
  const table = page.getByRole("table", { name: "Runs" });
  await page.getByRole("button", { name: "peak force N" }).click();
  await page.getByRole("button", { name: "peak force N" }).click();
  await expect(page.getByRole("columnheader", { name: "peak force N" })).toHaveAttribute("aria-sort", "descending");
  const column = await table
    .getByRole("row")
    .evaluateAll((rows) => rows.slice(1, 8).map((r) => Number(r.children[7].textContent)));
  expect(column).toEqual([...column].sort((a, b) => b - a));
  await table.evaluate((t) => (t.scrollTop = t.scrollHeight / 2));
  await expect(table.getByRole("row").nth(10)).toBeAttached();
  expect(await table.getByRole("row").count()).toBeLessThan(80);
});

test("says what a filter does not understand", async ({ page }) => {
  await open(page, pageOf("large", "report.html"));
  await page.getByLabel("Filter the runs").fill("nothing_like_it>3");
  await expect(page.getByRole("status")).toContainText("no column");
});

test("a failure tells why and opens its replay", async ({ page }) => {
  await open(page, pageOf("small", "report.html"));
  await page.getByRole("button", { name: "Failures" }).click();
  await expect(page.getByRole("status")).toContainText(/[1-6] of 6 runs/);
  await page
    .getByRole("button", { name: /why it ended, replay/ })
    .first()
    .click();
  const chosen = page.getByRole("region", { name: "The chosen run" });
  await expect(chosen).toContainText("stopped");
  await expect(chosen).toContainText("In numbers:");
  const replay = await chosen.getByRole("link", { name: "Open its replay" }).getAttribute("href");
  await open(page, new URL(replay!, page.url()).href);
  await expect(page.getByRole("heading", { level: 1 })).toContainText("stopped");
});

test("a run whose replay was not kept says how to make it again", async ({ page }) => {
  await open(page, pageOf("large", "report.html"));
  await page
    .getByRole("button", { name: /why it ended, replay/ })
    .first()
    .click();
  await expect(page.getByRole("region", { name: "The chosen run" })).toContainText(
    /ajar campaign .*campaign\.toml --seed 3 --replay 0/,
  );
});

test("a bar of a parameter shows its runs", async ({ page }) => {
  await open(page, pageOf("large", "report.html"));
  await page
    .getByRole("button", { name: /mechanism radius .* opened/ })
    .first()
    .click();
  await expect(page.getByLabel("Filter the runs")).toHaveValue(/mechanism\.radius/);
  await expect(page.getByRole("status")).not.toContainText("10000 of");
  expect(await namelessControls(page)).toEqual([]);
});
