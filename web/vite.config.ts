import { renameSync } from "node:fs";
import { defineConfig } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

// One file that the program fills with data: dist/page.html. It must not depend on the machine that builds it.
export default defineConfig({
  plugins: [
    viteSingleFile({ removeViteModuleLoader: true }),
    {
      name: "name-of-the-page",
      closeBundle: () => renameSync(new URL("dist/index.html", import.meta.url), new URL("dist/page.html", import.meta.url)),
    },
  ],
  build: { target: "es2022", modulePreload: false, chunkSizeWarningLimit: 2000, reportCompressedSize: false },
});
