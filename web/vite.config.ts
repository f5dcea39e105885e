import { defineConfig } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

// One document with everything in it: the program embeds it, and recordings are copies of it.
export default defineConfig({
  plugins: [viteSingleFile()],
  build: { target: "es2022", emptyOutDir: false, chunkSizeWarningLimit: 2000 },
});
