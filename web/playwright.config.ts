import { defineConfig } from "@playwright/test";
import { BROWSER } from "./browser.js";

export default defineConfig({
  testDir: "tests",
  globalSetup: "./tests/setup.ts",
  outputDir: "test-results/failures",
  workers: 1,
  timeout: 60_000,
  reporter: [["list"]],
  use: { viewport: { width: 1280, height: 800 }, screenshot: "only-on-failure", launchOptions: BROWSER },
});
