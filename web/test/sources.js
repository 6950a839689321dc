// The sources, as node can import them.
import * as esbuild from "esbuild";
import { root } from "./browser.js";

export async function load(name) {
  const { outputFiles } = await esbuild.build({
    absWorkingDir: root, entryPoints: [`src/${name}.ts`], bundle: true, format: "esm",
    target: "es2021", write: false, platform: "node", external: ["three"],
  });
  const text = Buffer.from(outputFiles[0].text).toString("base64");
  return import(`data:text/javascript;base64,${text}`);
}
