// Frames of a walk as Chromium draws them, one for each key of a camera path (rilievo-path-1, with targets):
//   node tools/frames.js WALK PATH.json FOLDER [--size WxH]
// WALK is a folder of `rilievo web`; FOLDER gets frame_00000.png ...
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { launch, page as pageFolder, root, serve } from "../test/browser.js";

const [walk, path, folder, ...rest] = process.argv.slice(2);
if (!folder) throw new Error("usage: node tools/frames.js WALK PATH.json FOLDER [--size WxH]");
const at = rest.indexOf("--size");
const [width, height] = (at < 0 ? "320x180" : rest[at + 1]).split("x").map(Number);
const { keys, z_near, z_far } = JSON.parse(readFileSync(path, "utf8"));
mkdirSync(folder, { recursive: true });

// The page of this checkout, whatever lies in the folder.
const server = await serve({ walk: [pageFolder, walk], test: join(root, "test") });
const browser = await launch();
try {
  const page = await browser.newPage();
  await page.setViewport({ width, height });
  await page.goto(`${server.url}/test/viewer.html`);
  await page.evaluate(async () => {
    window.viewer = window.rilievo.show(document.getElementById("walk"), "/walk/walk.json", { pixelRatio: 1 });
    await window.viewer.ready;
  });
  for (const [k, key] of keys.entries()) {
    const png = await page.evaluate(async (key) => {
      await window.settle(key);
      return window.pngOfFrame();
    }, { z_near, z_far, ...key });
    writeFileSync(join(folder, `frame_${String(k).padStart(5, "0")}.png`), Buffer.from(png, "base64"));
  }
} finally {
  await browser.close();
  await server.close();
}
