// What a scene's walk costs and how right it is, in one run: bakes the scene, writes the walk, draws
// it in Chromium from eyes between its nodes, and compares these frames and those of the C++ drawer
// with true ones.
//   node tools/measure.js SCENE FOLDER [--eyes N] [--size WxH] [--program RILIEVO] [BAKE OPTIONS...]
// FOLDER gets all files, and figures.json; what an earlier run left there is taken as it is.
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { launch, page as pageFolder, root, serve } from "../test/browser.js";

const [scene, folder, ...rest] = process.argv.slice(2);
if (!folder) throw new Error("usage: node tools/measure.js SCENE FOLDER [options]");
function option(name, otherwise) {
  const at = rest.indexOf(name);
  return at < 0 ? otherwise : rest.splice(at, 2)[1];
}
const eyes = Number(option("--eyes", 100));
const [width, height] = option("--size", "320x180").split("x").map(Number);
const program = option("--program", join(root, "../build/release/bin/rilievo"));
const threshold = option("--psnr", "54");
mkdirSync(folder, { recursive: true });
const inside = (name) => join(folder, name);

function rilievo(...args) {
  const begin = performance.now();
  const done = spawnSync(program, args, { encoding: "utf8", maxBuffer: 1 << 28 });
  if (done.status !== 0) throw new Error(`rilievo ${args.join(" ")}: ${done.stderr}`);
  return 1e-3 * (performance.now() - begin);
}
const read = (name) => JSON.parse(readFileSync(inside(name), "utf8"));

if (!existsSync(inside("baked.exr")))
  rilievo("bake", scene, "--as", "environment-nodes", ...rest, "-o", inside("baked.exr"),
          "--json", inside("bake.json"));
if (!existsSync(inside("walk")))
  rilievo("web", inside("baked.exr"), "--psnr", threshold, "-o", inside("walk"),
          "--json", inside("web.json"));
if (!existsSync(inside("identified")))
  rilievo("web", inside("baked.exr"), "--psnr", threshold, "--objects", "-o", inside("identified"));

const size = `${width}x${height}`;
// The page of this checkout, whatever lies in the folder.
const server = await serve({ walk: [pageFolder, inside("identified")], out: folder, test: join(root, "test") });
const browser = await launch();
let toLibrary;
try {
  const page = await browser.newPage();
  await page.setViewport({ width, height });
  await page.goto(`${server.url}/test/viewer.html`);
  if (!existsSync(inside("path.json"))) {
    await page.evaluate(async () => {
      window.viewer = window.rilievo.show(document.getElementById("walk"), "/walk/walk.json",
                                          { pixelRatio: 1, objects: true });
      await window.viewer.ready;
    });
    const keys = await page.evaluate((eyes) => window.eyesBetweenNodes(eyes), eyes);
    mkdirSync(inside("page"), { recursive: true });
    for (const [k, key] of keys.entries()) {
      const { frame, objects } = await page.evaluate((key) => window.pngsOf(key), key);
      const name = String(k).padStart(5, "0");
      writeFileSync(inside(`page/frame_${name}.png`), Buffer.from(frame, "base64"));
      writeFileSync(inside(`page/objects_${name}.png`), Buffer.from(objects, "base64"));
    }
    const { start } = read("walk/walk.json");
    writeFileSync(inside("path.json"), JSON.stringify({
      schema: "rilievo-path-1", z_near: start.z_near, z_far: start.z_far,
      // Each eye ends at a cut.
      keys: keys.flatMap(({ eye, target, up, vertical_fov }, k) => [
        { time: k / 60, eye, target, up, vertical_fov },
        { time: (k + 1) / 60 - 1e-3, eye, target, up, vertical_fov },
      ]),
    }));
  }
  const path = ["--path", inside("path.json"), "--frames", String(eyes), "--size", size,
                "--samples", "1"];
  if (!existsSync(inside("report")))
    rilievo("compare", inside("baked.exr"), "--scene", scene, ...path,
            "--frames-of", `page=${inside("page")}`, "-o", inside("report"));
  if (!existsSync(inside("library")))
    rilievo("render", inside("baked.exr"), ...path, "-o", inside("library"));
  toLibrary = await page.evaluate((eyes) => window.psnrsOf("/out/page", "/out/library", eyes), eyes);
} finally {
  await browser.close();
  await server.close();
}

const web = read("web.json"), bake = read("bake.json");
const { "environment-nodes": library, page: inPage } = read("report/report.json").methods;
const figuresOf = (method) => ({
  psnr_db: method.psnr_db.mean, least_psnr_db: method.psnr_db.min, ssim: method.ssim.mean,
  flip: method.flip.mean, wrong_percent: 100 * method.wrong_visibility.mean,
});
const manifest = read("walk/walk.json");
const figures = {
  scene, nodes: manifest.nodes.length, eyes, first_view_bytes: web.first_view_bytes,
  bytes: web.bytes, bake_seconds: bake.seconds.total, write_seconds: web.seconds,
  held_percent: bake.visible_share_held === undefined ? null : 100 * bake.visible_share_held,
  library: figuresOf(library), page: figuresOf(inPage),
  page_to_library_db: { mean: toLibrary.reduce((a, b) => a + b) / eyes, least: Math.min(...toLibrary) },
};
writeFileSync(inside("figures.json"), JSON.stringify(figures, null, 1));
console.log(JSON.stringify(figures, null, 1));
