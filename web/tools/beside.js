// A walk beside the same scene as plain glTF by three.js' GLTFLoader, in one browser, in turn, and
// beside one of its nodes as glTF (`rilievo export`): bytes, time to the first view, time and processor
// time of a frame, memory.
//   node tools/beside.js SCENE.glb WALK [--node NODE.glb] [--size WxH] [--frames N] [--rounds N]
// WALK is a folder of `rilievo web`. The machine's other work moves times: compare what stands beside
// each other; the processor time of all of the browser's processes is moved less.
import { readdirSync, statSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { launch, page as pageFolder, root, serve } from "../test/browser.js";
import { costOf } from "./cost.js";

const [scene, folder, ...rest] = process.argv.slice(2);
if (!folder) throw new Error("usage: node tools/beside.js SCENE.glb WALK [options]");
const option = (name, otherwise) => {
  const at = rest.indexOf(name);
  return at < 0 ? otherwise : rest[at + 1];
};
const [width, height] = option("--size", "640x360").split("x").map(Number);
const frames = Number(option("--frames", 100)), rounds = Number(option("--rounds", 3));
const bytesBelow = (path) => statSync(path).isDirectory()
  ? readdirSync(path).reduce((sum, name) => sum + bytesBelow(join(path, name)), 0)
  : statSync(path).size;

// The page of this checkout, whatever lies in the folder.
const files = { glTF: scene, node: option("--node") };
const server = await serve({ walk: [pageFolder, folder], glTF: dirname(scene),
                             node: dirname(files.node ?? scene), test: join(root, "test"), web: root });
let keys;

async function measured(kind) {
  const browser = await launch(["--js-flags=--expose-gc"]);
  try {
    const page = await browser.newPage();
    await page.setViewport({ width, height });
    await page.goto(`${server.url}/test/${kind === "walk" ? "viewer" : "gltf"}.html`);
    // Whichever needs graphics first would wait for the browser to start them.
    await page.evaluate(() => new OffscreenCanvas(4, 4).getContext("webgl2").finish());
    let first;
    if (kind === "walk") {
      first = await page.evaluate(async () => {
        const begin = performance.now();
        const box = document.getElementById("walk");
        window.viewer = window.rilievo.show(box, "/walk/walk.json", { pixelRatio: 1 });
        await window.viewer.ready;
        window.viewer.draw();
        window.drawKey = (key) => {
          window.look(key);
          window.drain();
        };
        window.drain();
        return performance.now() - begin;
      });
      keys ??= await page.evaluate((count) => window.eyesBetweenNodes(count), 8);
      // All nodes are there before frames count, those that are only likely to be needed too.
      await page.evaluate((keys) => window.settleAll(keys), keys);
    } else {
      await page.waitForFunction(() => window.openScene);
      first = await page.evaluate(
        ({ url, key, width, height }) => window.openScene(url, key, width, height),
        { url: `/${kind}/${basename(files[kind])}`, key: keys[0], width, height });
      for (const key of keys) await page.evaluate((key) => window.drawKey(key), key);
    }
    const before = costOf(browser.process().pid), begin = performance.now();
    await page.evaluate(async ({ keys, frames }) => {
      for (let i = 0; i < frames; ++i) {
        window.drawKey(keys[i % keys.length]);
        if (i % 8 === 7) await new Promise((resolve) => setTimeout(resolve, 0));
      }
    }, { keys, frames });
    const wall = performance.now() - begin, after = costOf(browser.process().pid);
    return { first_ms: first, frame_ms: wall / frames,
             frame_cpu_ms: (1e3 * (after.seconds - before.seconds)) / frames,
             memory_mb: 1e-6 * after.bytes };
  } finally {
    await browser.close();
  }
}

const middle = (numbers) => numbers.sort((a, b) => a - b)[numbers.length >> 1];
const kinds = ["walk", "glTF", ...(files.node ? ["node"] : [])];
const all = Object.fromEntries(kinds.map((kind) => [kind, []]));
for (let round = 0; round < rounds; ++round)
  for (const kind of kinds) all[kind].push(await measured(kind));
await server.close();
const table = Object.fromEntries(Object.entries(all).map(([kind, list]) => [kind, {
  bytes: bytesBelow(kind === "walk" ? folder : files[kind]),
  ...Object.fromEntries(Object.keys(list[0]).map((of) => [of, middle(list.map((one) => one[of]))])),
}]));
console.log("".padEnd(14), ...kinds.map((kind) => kind.padStart(12)));
for (const of of Object.keys(table.walk))
  console.log(of.padEnd(14), ...kinds.map((kind) => table[kind][of].toFixed(1).padStart(12)),
              ...kinds.slice(1).map((kind) => `walk : ${kind} ${(table.walk[of] / table[kind][of]).toFixed(2)}`));
