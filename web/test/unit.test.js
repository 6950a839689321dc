// What needs no browser: digests, planes, manifests, the choice of nodes.
import assert from "node:assert/strict";
import { createHash, randomBytes } from "node:crypto";
import { gzipSync, deflateSync } from "node:zlib";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import * as esbuild from "esbuild";
import { root } from "./browser.js";

// The sources, as node can import them.
async function load(name) {
  const { outputFiles } = await esbuild.build({
    absWorkingDir: root, entryPoints: [`src/${name}.ts`], bundle: true, format: "esm",
    target: "es2021", write: false, platform: "node", external: ["three"],
  });
  const text = Buffer.from(outputFiles[0].text).toString("base64");
  return import(`data:text/javascript;base64,${text}`);
}

test("the digest is SHA-256 at every length", async () => {
  const { sha256Hex } = await load("sha256");
  for (const length of [0, 1, 54, 55, 56, 57, 63, 64, 65, 119, 120, 1000, 70000]) {
    const bytes = randomBytes(length);
    assert.equal(sha256Hex(bytes), createHash("sha256").update(bytes).digest("hex"), `${length}`);
  }
});

// As rilievo/web_walk/plane16.cpp encodes them.
function encodePlane16(plane, width, predictor) {
  const count = plane.length;
  const raw = new Uint8Array(1 + 2 * count);
  raw[0] = predictor;
  for (let i = 0; i < count; ++i) {
    const x = i % width;
    const w = x > 0 ? plane[i - 1] : 0, n = i >= width ? plane[i - width] : 0;
    const affine = w + n - (x > 0 && i >= width ? plane[i - width - 1] : 0);
    const guess = predictor === 0 ? 0 : predictor === 1 ? affine
      : Math.min(Math.max(affine, Math.min(w, n)), Math.max(w, n));
    const off = (plane[i] - guess) & 0xffff;
    const folded = ((off << 1) ^ (off & 0x8000 ? 0xffff : 0)) & 0xffff;
    raw[1 + i] = folded & 255;
    raw[1 + count + i] = folded >> 8;
  }
  return new Uint8Array(deflateSync(raw));
}

test("a plane comes back whatever its predictor", async () => {
  const { decodePlane16 } = await load("plane16");
  const plane = new Uint16Array(randomBytes(2 * 37 * 19).buffer.slice(0, 2 * 37 * 19));
  for (const predictor of [0, 1, 2]) {
    const bytes = encodePlane16(plane, 37, predictor);
    assert.deepEqual(await decodePlane16(bytes, 37, 19, "plane"), plane);
    await assert.rejects(decodePlane16(bytes, 37, 18, "plane"), /plane: is damaged/);
    await assert.rejects(decodePlane16(bytes.subarray(0, 50), 37, 19, "plane"), /plane: is damaged/);
  }
});

const kStream = { bytes: 4, count: 3 };
const kFile = { file: "pictures/00112233445566778899aabbccddeeff.bin", bytes: 16 };

function goodManifest() {
  const mesh = {
    ...kFile, surface_vertices: kStream, surface_indices: kStream, skin_vertices: kStream,
    skin_indices: kStream, surfaces: [1, 0, 0, 0, 0, 0], skins: [0, 0, 1, 0, 0, 0],
    disparity_step: 1e-4,
  };
  return {
    schema: "rilievo-walk-1", name: "room", up: [0, 1, 0],
    start: { eye: [0, 0, 0], target: [0, 0, -1], vertical_fov: 0.9, z_near: 0.1, z_far: 100 },
    nodes: [{
      world_from_node: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 3, 4, 1],
      levels: [{ face_size: 64, colors: kFile, weights: { ...kFile, steps: 15 }, mesh, error_px: 0.5, reach: 1 }],
    }],
    sketches: { ...kFile, size: 24, near: 0.1, far: 50 },
  };
}

test("a manifest is read, and each fault in it named", async () => {
  const { parseManifest } = await load("manifest");
  const manifest = parseManifest(JSON.stringify(goodManifest()), "walk.json");
  assert.deepEqual(manifest.nodes[0].eye, [2, 3, 4]);
  const faults = [
    [(m) => (m.schema = "rilievo-walk-9"), /schema is "rilievo-walk-9"/],
    [(m) => (m.nodes = []), /no node/],
    [(m) => (m.nodes[0].levels = []), /no level/],
    [(m) => m.nodes[0].world_from_node.pop(), /16 numbers/],
    [(m) => (m.nodes[0].levels[0].face_size = 1e9), /face_size/],
    [(m) => (m.nodes[0].levels[0].mesh.surfaces = [2, 0, 0, 0, 0, 0]), /six sides/],
    [(m) => (m.nodes[0].levels[0].mesh.bytes = 17), /sum of its streams/],
    [(m) => (m.nodes[0].levels[0].colors = { file: "../secret.webp", bytes: 1 }), /beside the manifest/],
    [(m) => (m.nodes[0].levels[0].colors = { file: "https://evil/a.webp", bytes: 1 }), /beside the manifest/],
    [(m) => delete m.nodes[0].levels[0].weights.steps, /weights.steps/],
    [(m) => (m.start.vertical_fov = "wide"), /vertical_fov/],
    [(m) => (m.start.eye = [0, 0]), /start.eye/],
    [(m) => (m.sketches.bytes = -1), /sketches.bytes/],
    [(m) => delete m.up, /up/],
  ];
  for (const [damage, expected] of faults) {
    const bad = structuredClone(goodManifest());
    damage(bad);
    assert.throws(() => parseManifest(JSON.stringify(bad), "walk.json"), expected);
  }
  assert.throws(() => parseManifest('{"schema": "rilie', "walk.json"), /not JSON/);
  assert.throws(() => parseManifest("<p>There is no such file.</p>", "walk.json"), /not JSON/);
});

test("nodes that see the eye come first, and of them the nearest", async () => {
  const { NodeChooser } = await load("choose");
  const size = 4, count = 5;
  const node = (x) => ({ eye: [x, 0, 0], worldFromNode: Float64Array.from(
    [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1]), levels: [] });
  const nodes = [node(0), node(1), node(3), node(6), node(10)];
  // All see 2 m, the second nothing but its own place.
  const codes = new Uint16Array(count * 6 * size * size);
  const near = 0.1, far = 100;
  const code = (d) => 1 + Math.round((65533 * Math.log(d / near)) / Math.log(far / near));
  for (let n = 0; n < count; ++n)
    codes.fill(code(n === 1 ? 0.1 : 2), n * 6 * size * size, (n + 1) * 6 * size * size);
  const chooser = new NodeChooser(nodes, codes, { size, near, far });
  chooser.order(1.6, 0, 0);
  assert.deepEqual([...chooser.best], [2, 0, 1, 3, 4]);
  chooser.order(9, 0, 0);
  assert.deepEqual([...chooser.best], [4, 3, 2, 1, 0]);
  assert.equal(chooser.sees(2, 3, 0, 1.9), true);
  assert.equal(chooser.sees(2, 3, 0, 2.1), false);
});

test("the committed program of the page is what the sources make", async () => {
  const { pageProgram } = await import("../tools/build.js");
  assert.equal(readFileSync(join(root, "../rilievo/web_walk/page/viewer.js"), "utf8"),
               await pageProgram());
});

test("the package is at most 30 kB gzipped, without three.js and the decoder", () => {
  const files = readdirSync(join(root, "dist")).filter((name) => name.endsWith(".js"));
  const all = Buffer.concat(files.map((name) => readFileSync(join(root, "dist", name))));
  const decoder = readFileSync(join(root, "node_modules/meshoptimizer/meshopt_decoder.mjs"));
  const bytes = gzipSync(all, { level: 9 }).length - gzipSync(decoder, { level: 9 }).length;
  assert.ok(bytes <= 30000, `${bytes} bytes`);
  console.log(`gzipped without the decoder: ${bytes} bytes`);
});

function floatOfHalf(bits) {
  const sign = bits & 0x8000 ? -1 : 1, exponent = (bits >> 10) & 31, mantissa = bits & 1023;
  return sign * (exponent ? 2 ** (exponent - 15) * (1 + mantissa / 1024) : mantissa * 2 ** -24);
}

test("halves are the nearest ones", async () => {
  const { halfOf } = await load("views/surface");
  for (let bits = 0; bits < 0x7c00; bits += 37) {
    assert.equal(halfOf(floatOfHalf(bits)), bits);
    assert.equal(halfOf(-floatOfHalf(bits)), bits | 0x8000);
    // Between two of them.
    const step = floatOfHalf(bits + 1) - floatOfHalf(bits);
    if (bits + 1 < 0x7c00) {
      assert.equal(halfOf(floatOfHalf(bits) + 0.49 * step), bits);
      assert.equal(halfOf(floatOfHalf(bits) + 0.51 * step), bits + 1);
    }
  }
});

const kSurface = {
  width: 24, height: 20, du: 0.02, dv: 0.03, least: 0.5, step: 1e-5, sigma: 1,
  links: { gentle: 6, steepest: 20, growth: 2 },
};
const codesOf = (q) => Uint16Array.from({ length: 24 * 20 }, (_, i) => {
  const at = q(i % 24, Math.floor(i / 24));
  return at === 0 ? 0 : 1 + Math.round((at - kSurface.least) / kSurface.step);
});
const slopesAt = ({ slopes }, i) => [0, 16].flatMap((shift) => [slopes[2 * i], slopes[2 * i + 1]]
  .map((word) => floatOfHalf((word >>> shift) & 0xffff)));

test("a plane is one surface, and ends where depth jumps and where nothing is", async () => {
  const { makeSurface } = await load("views/surface");
  const plane = (x, y) => 0.6 + 0.002 * x + 0.001 * y;
  // Nearly twice as near from column 12 on; a hole at (5, 5).
  const surface = makeSurface(
    codesOf((x, y) => (x === 5 && y === 5 ? 0 : plane(x, y) * (x < 12 ? 0.85 : 1.5))), kSurface);
  const linksAt = (x, y) => surface.links[24 * y + x];
  assert.equal(linksAt(8, 8), 255);
  assert.equal(linksAt(5, 5), 0);
  // Right of it: nothing to the left, nor on the corners there.
  assert.equal(linksAt(6, 5), 0b11000111);
  assert.equal(linksAt(11, 8), 0b01111100);
  assert.equal(linksAt(12, 8), 0b11000111);
  const [right, left, down, up] = slopesAt(surface, 24 * 8 + 8);
  for (const [slope, wanted] of [[right, 0.0017], [left, -0.0017], [down, 0.00085], [up, -0.00085]])
    assert.ok(Math.abs(slope - wanted) < 2e-5, `${slope} instead of ${wanted}`);
  // Where it ends it goes on straight.
  assert.ok(Math.abs(slopesAt(surface, 24 * 8 + 11)[0] - 0.0017) < 2e-5);
});

test("cells hold the surfaces below them, whichever way the picture looks", async () => {
  const { makeSurface, cellLayout } = await load("views/surface");
  const random = Float64Array.from(randomBytes(24 * 20), (byte) => byte / 255);
  for (const sigma of [1, -1]) {
    const surface = makeSurface(
      codesOf((x, y) => (random[24 * y + x] < 0.1 ? 0 : 0.6 + 0.3 * random[24 * y + x])),
      { ...kSurface, sigma });
    const { columns, levelAt } = cellLayout(24, 20);
    for (let y = 0; y < 20; ++y)
      for (let x = 0; x < 24; ++x) {
        const i = 24 * y + x, code = surface.codes[i];
        for (let level = 0; level < 4; ++level) {
          const side = 4 ** (level + 1);
          const cell = columns * Math.floor(y / side) + levelAt[level] + Math.floor(x / side);
          const front = surface.cells[2 * cell], back = surface.cells[2 * cell + 1];
          if (code === 0) assert.ok(back < 0);
          if (code === 0) continue;
          const [right, left, down, up] = slopesAt(surface, i);
          for (const u of [right, left, 0])
            for (const v of [down, up, 0]) {
              const q = kSurface.least + (code - 1) * kSurface.step + 0.5 * (u + v);
              assert.ok(sigma * q <= front + 1e-3, `${sigma * q} before ${front}`);
              assert.ok(sigma * q >= sigma * Math.abs(back) - 1e-3);
            }
        }
      }
  }
});
