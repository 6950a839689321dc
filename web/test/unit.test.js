// What needs no browser: digests, planes, manifests, the choice of nodes.
import assert from "node:assert/strict";
import { createHash, randomBytes } from "node:crypto";
import { gzipSync, deflateSync } from "node:zlib";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { root } from "./browser.js";
import { numbersBetween } from "./random-numbers.js";
import { load } from "./sources.js";

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
    [(m) => (m.sky = { zenith: [0, 0, 1], horizon: [1, 1, 1] }), /sky.ground/],
  ];
  assert.equal(manifest.sky, null);
  const sky = { zenith: [0, 0.25, 1], horizon: [1, 1, 1], ground: [0, 0, 0] };
  assert.deepEqual(parseManifest(JSON.stringify({ ...goodManifest(), sky }), "walk.json").sky, sky);
  for (const [damage, expected] of faults) {
    const bad = structuredClone(goodManifest());
    damage(bad);
    assert.throws(() => parseManifest(JSON.stringify(bad), "walk.json"), expected);
  }
  assert.throws(() => parseManifest('{"schema": "rilie', "walk.json"), /not JSON/);
  assert.throws(() => parseManifest("<p>There is no such file.</p>", "walk.json"), /not JSON/);
});

function goodReliefs() {
  const { nodes, sketches, ...manifest } = goodManifest();
  return { ...manifest, reliefs: {
    bounds: [[-1, -1, -1], [1, 1, 1]], splat: 1.5, resolution: 1, max_size: 2048,
    list: [{
      world_from_eye: nodes[0].world_from_node, projection: "parallel", window: [-1, 1, -1, 1],
      size: [40, 40], plane_z: 3, first: -1, step: 1e-5, hull: [[0, 0, -1], [40, 40, 1]],
      samples: 100, sheet: [48, 64], colors: kFile, codes: kFile, layers: kFile,
    }],
  } };
}

test("a manifest of reliefs is read, and each fault in it named", async () => {
  const { parseManifest } = await load("manifest");
  const { reliefs, nodes } = parseManifest(JSON.stringify(goodReliefs()), "walk.json");
  assert.equal(nodes.length, 0);
  assert.equal(reliefs.list[0].sheetHeight, 64);
  const faults = [
    [(m) => (m.reliefs.list = []), /reliefs.list is empty/],
    [(m) => (m.reliefs.max_size = 1e6), /max_size/],
    [(m) => (m.reliefs.splat = 0), /splat/],
    [(m) => (m.reliefs.bounds = [[0, 0, 0]]), /bounds/],
    [(m) => (m.reliefs.list[0].projection = "fish eye"), /projection/],
    [(m) => (m.reliefs.list[0].hull = []), /hull/],
    [(m) => (m.reliefs.list[0].hull[0] = [1, 2]), /hull/],
    [(m) => (m.reliefs.list[0].sheet = [40, 64]), /parts of blocks/],
    [(m) => (m.reliefs.list[0].sheet = [1 << 20, 64]), /sheet/],
    [(m) => (m.reliefs.list[0].samples = 48 * 64 + 1), /samples/],
    [(m) => (m.reliefs.list[0].step = 0), /step/],
    [(m) => (m.reliefs.list[0].window = [1, 1, 0, 1]), /window/],
    [(m) => (m.reliefs.list[0].codes = { file: "/etc/passwd", bytes: 1 }), /beside the manifest/],
  ];
  for (const [damage, expected] of faults) {
    const bad = structuredClone(goodReliefs());
    damage(bad);
    assert.throws(() => parseManifest(JSON.stringify(bad), "walk.json"), expected);
  }
});

test("an object may stand among nodes", async () => {
  const { parseManifest } = await load("manifest");
  const { nodes, reliefs, sketches } = parseManifest(
    JSON.stringify({ ...goodReliefs(), ...goodManifest() }), "walk.json");
  assert.equal(nodes.length, 1);
  assert.equal(reliefs.list.length, 1);
  assert.equal(sketches.size, 24);
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
  for (const [name, text] of Object.entries(await pageProgram()))
    assert.equal(readFileSync(join(root, "../rilievo/web_walk/page", name), "utf8"), text, name);
});

// What a page loads: an entry, all that it imports, and one of the parts that it imports when a walk
// needs it.
test("no page loads more than 32 kB gzipped, a live one 39, without three.js and the decoder", () => {
  const read = (name) => readFileSync(join(root, "dist", name), "utf8");
  const named = (name, pattern) => [...read(name).matchAll(pattern)].map((match) => match[1]);
  const imported = (name, found = new Set()) => {
    if (found.has(name)) return found;
    found.add(name);
    for (const next of named(name, /(?:from|import)"\.\/([^"]+)"/g)) imported(next, found);
    return found;
  };
  const gzipped = (text) => gzipSync(text, { level: 9 }).length;
  const decoder = gzipped(readFileSync(join(root, "node_modules/meshoptimizer/meshopt_decoder.mjs")));
  const bytesOf = (names) => gzipped([...names].map(read).join("")) - decoder;
  for (const entry of ["index.js", "core.js", "viewer.js"]) {
    const always = imported(entry);
    const parts = new Set([...always].flatMap((name) => named(name, /import\("\.\/([^"]+)"\)/g)));
    assert.ok(parts.size >= 2);
    const bytes = [always, ...[...parts].map((part) => imported(part, new Set(always)))].map(bytesOf);
    console.log(`${entry} gzipped without the decoder: ${bytes.join(", ")} bytes`);
    // It has a worker of its own.
    const most = ["", ...parts].map((part) => part && read(part).includes("LiveWalk") ? 39000 : 32000);
    bytes.forEach((count, k) => assert.ok(count <= most[k], `${bytes} bytes`));
  }
});

// A picture of lines of sight with up to three samples, and the sheet that holds them.
function sheetOfLines(of, random) {
  const side = 16, across = Math.ceil(of.width / side), down = Math.ceil(of.height / side);
  const layers = new Uint16Array(across * down);
  const samples = [];
  for (let y = 0; y < of.height; ++y)
    for (let x = 0; x < of.width; ++x) {
      const block = Math.floor(y / side) * across + Math.floor(x / side);
      // In the second block there is nothing.
      const count = block === 1 ? 0 : Math.floor(random(0, 4));
      layers[block] = Math.max(layers[block], count);
      for (let layer = 0; layer < count; ++layer)
        samples.push({ x, y, layer, block, code: 1 + Math.floor(random(0, 65534)) });
    }
  const codes = new Uint16Array(of.sheetWidth * of.sheetHeight);
  for (const sample of samples) {
    // The blocks that come before.
    let place = 0;
    for (let layer = 0; layer <= sample.layer; ++layer)
      for (let block = 0; block < layers.length; ++block)
        if (layers[block] > layer && (layer < sample.layer || block < sample.block)) ++place;
    sample.column = (place % (of.sheetWidth / side)) * side + (sample.x % side);
    sample.row = Math.floor(place / (of.sheetWidth / side)) * side + (sample.y % side);
    codes[sample.row * of.sheetWidth + sample.column] = sample.code;
  }
  return { layers, codes, samples };
}

test("samples come back from their sheet, and one that is damaged is named", async () => {
  const { unpackSamples } = await load("reliefs/samples");
  const size = { width: 37, height: 20, sheetWidth: 48, sheetHeight: 96 };
  const { layers, codes, samples } = sheetOfLines(size, numbersBetween(1));
  const of = { ...size, samples: samples.length };
  const made = unpackSamples(codes, layers, of, "codes");
  const found = samples.map((_, i) => made.slice(6 * i, 6 * i + 6).join(" "));
  assert.deepEqual(found.sort(), samples.map((t) =>
    [t.x, t.y, t.code - 1, t.layer, t.column, t.row].join(" ")).sort());
  const bad = (codes, layers, other) => assert.throws(
    () => unpackSamples(codes, layers, { ...of, ...other }, "codes"), /codes: is damaged/);
  bad(codes, layers, { samples: of.samples - 1 });
  bad(codes, layers, { samples: of.samples + 1 });
  bad(codes, layers.map(() => 60000), {});
  // Beyond the picture's right edge.
  bad(codes.map(() => 7), layers, {});
});

// A relief that looks along a slanting direction; what is at (u, v) and d lies at `world`.
function slantingRelief(perspective) {
  const turned = (x, y, z) => { // by any rotation
    const c = Math.cos(0.7), s = Math.sin(0.7), a = c * x + s * z, b = c * z - s * x;
    const C = Math.cos(0.4), S = Math.sin(0.4);
    return [a, C * y + S * b, C * b - S * y];
  };
  const right = turned(1, 0, 0), up = turned(0, 1, 0), back = turned(0, 0, 1), eye = [0.3, -0.2, 0.5];
  const of = {
    worldFromEye: Float64Array.from([...right, 0, ...up, 0, ...back, 0, ...eye, 1]), perspective,
    left: -0.6, right: 0.5, bottom: -0.4, top: 0.7, width: 110, height: 90,
    planeZ: perspective ? 1 : 3, first: perspective ? -0.5 : -0.8, step: perspective ? 5e-6 : 2.5e-5,
    hull: [[0, 0, perspective ? -0.5 : -0.8], [110, 90, perspective ? -0.18 : 0.8]], samples: 1, splatScale: 1,
  };
  const world = (u, v, code) => {
    const d = of.first + code * of.step, z = perspective ? -1 / d : of.planeZ + d;
    const scale = perspective ? z : 1;
    const x = scale * (of.left + (u / of.width) * (of.right - of.left));
    const y = scale * (of.top + (v / of.height) * (of.bottom - of.top));
    return eye.map((e, k) => e + x * right[k] + y * up[k] - z * back[k]);
  };
  const set = { low: [-3, -3, -3], high: [3, 3, 3], center: [0, 0, 0], splat: 1.5, resolution: 1, maxSize: 2048,
                list: [of] };
  return { of, set, world, forward: back.map((x) => -x) };
}

test("samples are warped to where their places are seen, with their depths", async () => {
  const { ReliefWarp } = await load("reliefs/warp");
  const random = numbersBetween(2);
  for (const perspective of [false, true]) {
    const { of, set, world, forward } = slantingRelief(perspective);
    const warp = new ReliefWarp(of, set), out = new Float32Array(12);
    for (let tried = 0; tried < 40; ++tried) {
      const middle = world(55, 45, 20000);
      const eye = middle.map((x, k) => x - forward[k] * random(perspective ? 2 : 1.5, 6) + random(-0.8, 0.8));
      if (!warp.place(...eye)) continue;
      warp.coefficients(out);
      for (let i = 0; i < 10; ++i) {
        const u = random(0, 100), v = random(0, 80), code = Math.floor(random(0, 60000));
        if (code < warp.leastCode) continue;
        const w = out[4] + out[5] * code;
        const x = (out[6] * u + out[0] + out[1] * code) / w, y = (out[6] * v + out[2] + out[3] * code) / w;
        // The line of sight through this texel of the result meets the sample's middle.
        const at = world(u + 0.5, v + 0.5, code).map((p, k) => p - eye[k]);
        const ray = [0, 1, 2].map((k) =>
          warp.g[k] + (x * warp.a[k] + y * warp.b[k]) / warp.resolution);
        const along = (p) => p.reduce((sum, p, k) => sum + p * forward[k], 0);
        const scale = along(at) / along(ray);
        // In texels where the sample is.
        const off = Math.hypot(...at.map((p, k) => p - scale * ray[k])) / (scale * Math.hypot(...warp.a));
        assert.ok(off < 2e-3, `${off} texels off`);
        const delta = Math.round((out[8] + out[9] * code) / (out[10] + out[11] * code));
        const z = warp.zNear * warp.zFar / (warp.zFar - (delta / 65534) * (warp.zFar - warp.zNear));
        // A step of Delta here.
        const step = z * z * (warp.zFar - warp.zNear) / (65534 * warp.zNear * warp.zFar);
        assert.ok(Math.abs(z - along(at)) < step + 1e-4 * z, `${z} instead of ${along(at)}`);
      }
    }
  }
});

test("what a frame shows of a relief is all that its pixels see", async () => {
  const { ReliefWarp } = await load("reliefs/warp");
  const { of, set, world, forward } = slantingRelief(false);
  const warp = new ReliefWarp(of, set);
  const random = numbersBetween(3);
  let seen = 0;
  for (let tried = 0; tried < 60; ++tried) {
    const middle = world(55, 45, 30000);
    const eye = middle.map((x, k) => x - forward[k] * random(1.2, 4) + random(-1, 1));
    const yaw = random(0, 6.28), pitch = random(-1.2, 1.2);
    const back = [Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch), Math.cos(pitch) * Math.cos(yaw)];
    const right = [Math.cos(yaw), 0, -Math.sin(yaw)];
    const up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2],
                back[0] * right[1] - back[1] * right[0]];
    const view = {
      worldFromEye: [...right, 0, ...up, 0, ...back, 0, ...eye, 1], width: 64, height: 48,
      clipFromEye: [1.2, 0, 0, 0, 0, 1.6, 0, 0, 0.1, -0.2, -1, -1, 0, 0, -0.1, 0],
    };
    if (!warp.place(...eye)) continue;
    const [x0, y0, x1, y1] = warp.all;
    const shows = warp.show(view);
    for (let i = 0; i < 30; ++i) {
      // A texel of the result, if the frame shows it.
      const x = random(x0, x1), y = random(y0, y1);
      const ray = [0, 1, 2].map((k) => warp.g[k] + (x * warp.a[k] + y * warp.b[k]) / warp.resolution);
      const dot = (a, b) => a.reduce((sum, p, k) => sum + p * b[k], 0);
      const z = -dot(ray, back);
      const at = [(1.2 * dot(ray, right)) / z - 0.1, (1.6 * dot(ray, up)) / z + 0.2];
      if (!(z > 1e-3 * Math.hypot(...ray)) || Math.max(Math.abs(at[0]), Math.abs(at[1])) > 1) continue;
      ++seen;
      assert.ok(shows);
      const [l, t, r, b] = warp.shown;
      assert.ok(x >= l - 1e-6 && x <= r + 1e-6 && y >= t - 1e-6 && y <= b + 1e-6,
                `(${x}, ${y}) outside ${warp.shown} of ${warp.all}`);
    }
  }
  assert.ok(seen > 30, `${seen}`);
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
