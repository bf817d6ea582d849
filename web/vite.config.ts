import { renameSync } from "node:fs";
import { resolve } from "node:path";
import { defineConfig, type Plugin } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

/** The program asks for page.html. */
function namePage(): Plugin {
  let folder = "";
  return {
    name: "name-page",
    configResolved: (config) => void (folder = resolve(config.root, config.build.outDir)),
    closeBundle: () => renameSync(resolve(folder, "index.html"), resolve(folder, "page.html")),
  };
}

// One file that the program fills with data: dist/page.html. It must not depend on the machine that builds it.
export default defineConfig({
  plugins: [viteSingleFile({ removeViteModuleLoader: true }), namePage()],
  build: {
    target: "es2022",
    modulePreload: false,
    chunkSizeWarningLimit: 2000,
    reportCompressedSize: false,
    emptyOutDir: true,
  },
});
