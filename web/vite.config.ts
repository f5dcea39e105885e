import { readFileSync, writeFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { defineConfig, type Plugin } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

/** Compresses the document, which the program embeds so. */
const compress: Plugin = {
  name: "compress",
  closeBundle() {
    const page = readFileSync("dist/index.html");
    writeFileSync("dist/index.html.gz", gzipSync(page, { level: 9 }));
  },
};

// One document with everything in it: recordings are copies of it.
export default defineConfig({
  plugins: [viteSingleFile(), compress],
  build: { target: "es2022", emptyOutDir: false, chunkSizeWarningLimit: 2000 },
});
