/** Pages that complain, or ask the network for anything, fail their test. */
import { test as base, expect, type Page } from "@playwright/test";

export const test = base.extend<{ complaints: string[] }>({
  complaints: [
    async ({ page }, use) => {
      const complaints: string[] = [];
      page.on("console", (m) => {
        // What the browser says of its own software rendering is no complaint about the page.
        if (/GL Driver Message/.test(m.text())) return;
        if (m.type() === "error" || m.type() === "warning") complaints.push(`console: ${m.text()}`);
      });
      page.on("pageerror", (e) => complaints.push(`error: ${e.message}`));
      page.on("dialog", (d) => {
        complaints.push(`dialog: ${d.message()}`);
        void d.dismiss();
      });
      page.on("request", (r) => {
        if (!/^(file|blob|data):/.test(r.url()) && !r.url().startsWith("http://127.0.0.1:"))
          complaints.push(`request: ${r.url()}`);
      });
      await use(complaints);
      expect(complaints).toEqual([]);
    },
    { auto: true },
  ],
});

export async function open(page: Page, url: string): Promise<void> {
  await page.goto(url);
  await expect(page.locator("#page[data-ready]")).toBeAttached();
}

/** Names of controls that a screen reader could not say. */
export function namelessControls(page: Page): Promise<string[]> {
  return page
    .locator("button, input, select, a, [role=img], summary")
    .evaluateAll((all) =>
      all
        .filter(
          (e) => !(e.getAttribute("aria-label") ?? e.textContent ?? "").trim() && !(e as HTMLInputElement).labels?.length,
        )
        .map((e) => e.outerHTML.slice(0, 80)),
    );
}

export { expect };
