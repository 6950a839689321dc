// Walks through a walk for a while and counts: draw calls, triangles, memory, the main thread's time,
// what the heap grows by, the processor time of a frame.
//   node tools/budgets.js WALK [--size WxH] [--seconds N]
// The machine's other work moves frame times; the processor time of all of the browser's processes is
// moved less.
import { join } from "node:path";
import { launch, page as pageFolder, root, serve } from "../test/browser.js";
import { costOf } from "./cost.js";

const [folder, ...rest] = process.argv.slice(2);
if (!folder) throw new Error("usage: node tools/budgets.js WALK [options]");
const option = (name, otherwise) => {
  const at = rest.indexOf(name);
  return at < 0 ? otherwise : rest[at + 1];
};
const [width, height] = option("--size", "640x360").split("x").map(Number);
const seconds = Number(option("--seconds", 60));

// The page of this checkout, whatever lies in the folder.
const server = await serve({ walk: [pageFolder, folder], test: join(root, "test") });
const browser = await launch(["--js-flags=--expose-gc", "--enable-precise-memory-info"]);
try {
  const page = await browser.newPage();
  await page.setViewport({ width, height });
  await page.goto(`${server.url}/test/viewer.html`);
  await page.evaluate(async () => {
    window.viewer = window.rilievo.show(document.getElementById("walk"), "/walk/walk.json",
                                        { pixelRatio: 1 });
    await window.viewer.ready;
  });
  const keys = await page.evaluate((count) => window.eyesBetweenNodes(count), 12);
  await page.evaluate((keys) => window.settleAll(keys), keys);
  await page.evaluate((keys) => window.walked(keys, 60), keys);
  const before = costOf(browser.process().pid);
  const figures = await page.evaluate(({ keys, seconds }) => window.walked(keys, 600, seconds),
                                      { keys, seconds });
  const after = costOf(browser.process().pid);
  console.log(JSON.stringify({ ...figures, memory_mb: 1e-6 * after.bytes,
    frame_cpu_ms: (1e3 * (after.seconds - before.seconds)) / figures.frames }, null, 1));
} finally {
  await browser.close();
  await server.close();
}
