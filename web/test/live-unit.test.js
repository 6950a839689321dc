// What a live walk's client does without a browser: cuts and triangles of keyframes, messages.
import assert from "node:assert/strict";
import { test } from "node:test";
import { encodeKeyframe, encodeWelcome, parsePose } from "./live-mock.js";
import { axesAt, codesOf, encodePlane16, picture } from "./live-scene.js";
import { randomNumbers } from "./random-numbers.js";
import { load } from "./sources.js";

/** A plane in the back, or the sky, and rectangles of planes before it: codes, and who each texel is of. */
function rectangles(random, width, height, count) {
  const ids = new Int32Array(width * height), surfaces = [];
  const surface = (base) => {
    const a = 3 * (random() - 0.5), b = 3 * (random() - 0.5);
    return (x, y) => base + a * (x - width / 2) + b * (y - height / 2);
  };
  surfaces.push(random() < 0.3 ? () => 0 : surface(1500));
  for (let k = 1; k <= count; ++k) {
    surfaces.push(surface(1500 + 3000 * k));
    const x0 = Math.floor(random() * width), y0 = Math.floor(random() * height);
    const x1 = x0 + 1 + Math.floor(random() * width / 2), y1 = y0 + 1 + Math.floor(random() * height / 2);
    for (let y = y0; y < Math.min(y1, height); ++y)
      for (let x = x0; x < Math.min(x1, width); ++x) ids[y * width + x] = k;
  }
  const codes = new Uint16Array(width * height);
  for (let i = 0; i < codes.length; ++i)
    codes[i] = Math.round(surfaces[ids[i]](i % width + 0.5, Math.floor(i / width) + 0.5));
  return { codes, ids, surfaces };
}

function verticesOf(mesh) {
  const shorts = new Int16Array(mesh.vertices), floats = new Float32Array(mesh.vertices);
  return Array.from({ length: floats.length / 2 }, (_, i) => [shorts[4 * i], shorts[4 * i + 1], floats[2 * i + 1]]);
}

// Barycentric weights of a place, or null outside.
function weights([a, b, c], x, y) {
  const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  const u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area;
  const v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area;
  return u < 0 || v < 0 || u + v > 1 ? null : [u, v, 1 - u - v];
}

test("triangles cover each half of a texel once, with the depth of its own surface", async () => {
  const { makeMesh } = await load("live/mesh");
  const random = randomNumbers(1);
  let few = 0;
  for (let round = 0; round < 12; ++round) {
    const width = 40 + Math.floor(random() * 60), height = 30 + Math.floor(random() * 50);
    const { codes, ids, surfaces } = rectangles(random, width, height, round % 5);
    const mesh = makeMesh(codes, width, height, 0, 1, 1e6);
    assert.equal(mesh.scale, 1);
    const vertices = verticesOf(mesh), covered = new Uint8Array(2 * width * height);
    const surfaceIndices = mesh.counts[0] + mesh.counts[1];
    for (let i = 0; i < surfaceIndices; i += 3) {
      const corners = [0, 1, 2].map((k) => vertices[mesh.indices[i + k]]);
      const xs = corners.map((v) => v[0]), ys = corners.map((v) => v[1]);
      for (let y = Math.min(...ys); y < Math.max(...ys); ++y)
        for (let x = Math.min(...xs); x < Math.max(...xs); ++x)
          // Beside both diagonals of the texel, one place on each side of either.
          for (const [half, dx, dy] of [[0, 0.5, 0.2], [1, 0.5, 0.8]]) {
            const w = weights(corners, x + dx, y + dy);
            if (!w) continue;
            ++covered[2 * (y * width + x) + half];
            const code = w[0] * corners[0][2] + w[1] * corners[1][2] + w[2] * corners[2][2];
            const wanted = surfaces[ids[y * width + x]](x + dx, y + dy);
            // Half a code of rounding, a code of tolerance in each of a few sizes, and beside cuts
            // the means of texels that lie half a texel aside, of a slope of 1.5 codes in x and y.
            const limit = 0.5 + 2 + 1.5;
            assert.ok(Math.abs(code - wanted) <= limit, `round ${round}: ${code} for ${wanted} at ${x} ${y}`);
          }
    }
    assert.ok(covered.every((n) => n === 1), `round ${round}`);
    if (round % 5 === 0) few = Math.max(few, surfaceIndices / 3 / (width * height));
  }
  // A plane alone: some of two triangles for 32 x 32 texels, and its border.
  assert.ok(few < 0.4, `${few}`);
});

test("edges of triangles meet edges, but at cuts and at the border", async () => {
  const { makeMesh } = await load("live/mesh");
  const random = randomNumbers(2);
  for (let round = 0; round < 6; ++round) {
    const width = 64 + 7 * round, height = 64;
    const { codes, ids } = rectangles(random, width, height, round);
    // Not only planes.
    for (let i = 0; i < codes.length; ++i) if (codes[i]) codes[i] += Math.round(3 * random());
    const mesh = makeMesh(codes, width, height, 0, 1, 1e6);
    const vertices = verticesOf(mesh), edges = new Map();
    for (let i = 0; i < mesh.counts[0] + mesh.counts[1]; i += 3)
      for (let k = 0; k < 3; ++k) {
        const a = mesh.indices[i + k], b = mesh.indices[i + ((k + 1) % 3)];
        const key = a < b ? `${a} ${b}` : `${b} ${a}`;
        edges.set(key, (edges.get(key) ?? 0) + 1);
      }
    const id = (x, y) => ids[y * width + x];
    for (const [key, count] of edges) {
      if (count === 2) continue;
      assert.equal(count, 1);
      const [[x0, y0], [x1, y1]] = key.split(" ").map((v) => vertices[v]);
      if ((x0 === x1 && (x0 === 0 || x0 === width)) || (y0 === y1 && (y0 === 0 || y0 === height))) continue;
      // A side of a texel between two surfaces.
      assert.equal(Math.abs(x1 - x0) + Math.abs(y1 - y0), 1, `round ${round}: ${key}`);
      const x = Math.min(x0, x1), y = Math.min(y0, y1);
      assert.notEqual(id(x, y), x0 === x1 ? id(x - 1, y) : id(x, y - 1), `round ${round}`);
    }
  }
});

test("skins span every cut, from one surface to the other", async () => {
  const { makeMesh } = await load("live/mesh");
  const width = 48, height = 40, random = randomNumbers(3);
  const { codes, ids } = rectangles(random, width, height, 4);
  const mesh = makeMesh(codes, width, height, 0, 1, 1e6), vertices = verticesOf(mesh);
  const spanned = new Set(), begin = mesh.counts[0] + mesh.counts[1];
  for (let i = begin; i < begin + mesh.counts[2]; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => vertices[mesh.indices[i + k]]);
    const places = new Set([a, b, c].map(([x, y]) => `${x} ${y}`));
    assert.equal(places.size, 2);
    spanned.add([...places].sort().join(" "));
  }
  let cuts = 0;
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const id = ids[y * width + x];
      if (x + 1 < width && ids[y * width + x + 1] !== id) {
        ++cuts;
        assert.ok(spanned.has([`${x + 1} ${y}`, `${x + 1} ${y + 1}`].sort().join(" ")));
      }
      if (y + 1 < height && ids[(y + 1) * width + x] !== id) {
        ++cuts;
        assert.ok(spanned.has([`${x} ${y + 1}`, `${x + 1} ${y + 1}`].sort().join(" ")));
      }
    }
  assert.equal(spanned.size, cuts);
});

test("what would have too many triangles is made of larger texels", async () => {
  const { makeMesh } = await load("live/mesh");
  const width = 256, height = 192, random = randomNumbers(4);
  const codes = Uint16Array.from({ length: width * height }, () => 1 + 60000 * random());
  const mesh = makeMesh(codes, width, height, 0, 1, 60000);
  assert.ok(mesh.scale > 1);
  assert.ok(mesh.counts[0] + mesh.counts[1] + mesh.counts[2] <= 3 * 60000);
});

test("a floor at a flat angle is not cut, and a step in it is", async () => {
  const { findCuts, kCutDown } = await load("live/cuts");
  const width = 3, height = 20;
  const floor = Uint16Array.from({ length: width * height }, (_, i) => 100 + 60 * Math.floor(i / width));
  assert.ok(findCuts(floor, width, height, 0).every((cut) => cut === 0));
  const step = floor.map((code, i) => (i >= 10 * width ? code + 500 : code));
  const cuts = findCuts(step, width, height, 0);
  cuts.forEach((cut, i) => assert.equal(cut, Math.floor(i / width) === 9 ? kCutDown : 0, `${i}`));
});

const kCamera = {
  eye: [0.5, 1.6, 3], axes: axesAt([0.5, 1.6, 3], [0, 1, 0]), left: -0.8, right: 0.7, bottom: -0.5, top: 0.6,
  width: 24, height: 16, fine: true, keyframe: 3, id: 2n ** 63n + 5n,
};

function kept(bytes) {
  return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
}

function keyframe(of = {}) {
  const camera = { ...kCamera, ...of };
  const codes = codesOf(picture(camera).inverse, 1 / 12000, -0.5);
  return encodeKeyframe(camera, Buffer.from("colours"), encodePlane16(codes, camera.width));
}

test("a keyframe's header is read as it was written", async () => {
  const { parseMessage } = await load("live/messages"), { axesOf } = await load("live/camera");
  const bytes = keyframe(), read = parseMessage(kept(bytes));
  assert.equal(read.kind, "keyframe");
  assert.equal(read.id, kCamera.id);
  assert.equal(read.keyframe, 3n);
  assert.deepEqual([read.width, read.height, read.side, read.layer, read.fine], [24, 16, -1, 0, true]);
  assert.deepEqual([...read.eye], kCamera.eye);
  assert.equal(read.left, Math.fround(-0.8));
  assert.equal(bytes.subarray(read.colors.at).toString(), "colours");
  // Singles have 24 bits.
  axesOf(read.orientation).forEach((x, k) => assert.ok(Math.abs(x - kCamera.axes.flat()[k]) < 1e-6));
});

test("a message that lies about itself is refused by name", async () => {
  const { parseMessage } = await load("live/messages");
  const changed = (change, message = keyframe()) => {
    change(message);
    return () => parseMessage(kept(message));
  };
  assert.throws(changed((b) => (b[1] = 2)), /server: speaks version 2/);
  assert.throws(changed((b) => (b[0] = 99)), /its kind is 99/);
  assert.throws(changed((b) => (b[4] = 2)), /level is 2/);
  assert.throws(changed((b) => (b[6] = 0)), /kind of colours is 0/);
  assert.throws(changed((b) => b.writeDoubleLE(NaN, 40)), /eye is NaN/);
  assert.throws(changed((b) => b.fill(0, 64, 80)), /orientation's norm is 0/);
  assert.throws(changed((b) => b.writeFloatLE(0.8, 80)), /window/);
  assert.throws(changed((b) => b.writeUInt16LE(9000, 96)), /width is 9000/);
  assert.throws(changed((b) => b.writeFloatLE(0, 100)), /step is 0/);
  assert.throws(changed((b) => b.writeFloatLE(-1, 104)), /offset is -1/);
  assert.throws(changed((b) => b.writeUInt32LE(b.readUInt32LE(132) + 1, 132)), /sizes/);
  assert.throws(changed((b) => b.writeUInt16LE(7, 4), encodeWelcome()), /welcome's name/);
  assert.throws(changed((b) => b.writeFloatLE(4, 128), encodeWelcome()), /vertical field of view is 4/);
  assert.throws(() => parseMessage(new ArrayBuffer(3)), /too short/);
  assert.throws(() => parseMessage(kept(keyframe().subarray(0, 100))), /keyframe has 100 bytes/);
});

test("damaged messages are errors of a walk, or messages, whatever is damaged", async () => {
  const { parseMessage } = await load("live/messages");
  const random = randomNumbers(5), whole = [keyframe(), encodeWelcome(), Buffer.from([67, 1, ...new Array(22).fill(0)])];
  let refused = 0;
  for (let round = 0; round < 20000; ++round) {
    const bytes = Buffer.from(whole[round % 3]);
    for (let k = 0; k < 1 + (round % 4); ++k) bytes[Math.floor(random() * Math.min(200, bytes.length))] = Math.floor(random() * 256);
    const cut = random() < 0.2 ? Math.floor(random() * bytes.length) : bytes.length;
    try {
      parseMessage(kept(bytes.subarray(0, cut)));
    } catch (error) {
      assert.equal(error.name, "WalkError");
      ++refused;
    }
  }
  assert.ok(refused > 5000 && refused < 20000, `${refused}`);
});

test("a pose is written as the protocol says", async () => {
  const { encodePose, encodeDropped } = await load("live/messages"), { quaternionOf, axesOf } = await load("live/camera");
  const random = randomNumbers(6);
  for (let round = 0; round < 100; ++round) {
    const eye = [random(), random(), random()], target = [random() - 0.5, 3 * random() - 1.5, random() - 0.5];
    const [r, u, b] = axesAt(eye, target), q = new Float64Array(4);
    quaternionOf([...r, 0, ...u, 0, ...b, 0, ...eye, 1], q);
    axesOf(q).forEach((x, k) => assert.ok(Math.abs(x - [r, u, b].flat()[k]) < 1e-12));
    const bytes = Buffer.from(encodePose({
      sequence: 7, time: 5, eye, orientation: q, verticalFov: 1, aspect: 2, velocity: [1, 2, 3], turnRate: [4, 5, 6],
      latency: 8, cell: 0,
    }));
    assert.equal(bytes.length, 104);
    const read = parsePose(bytes);
    assert.deepEqual(read.eye, eye);
    assert.deepEqual([read.sequence, read.verticalFov, read.aspect, ...read.velocity, ...read.turnRate], [7, 1, 2, 1, 2, 3, 4, 5, 6]);
  }
  const messages = encodeDropped(Array.from({ length: 1001 }, (_, k) => BigInt(k)));
  assert.deepEqual(messages.map((bytes) => new DataView(bytes).getUint32(4, true)), [500, 500, 1]);
  assert.ok(messages.every((bytes) => bytes.byteLength <= 4096));
});

test("a texel's corner goes where its ray and its depth say", async () => {
  const { clipFromRaster, axesOf } = await load("live/camera"), { parseMessage } = await load("live/messages");
  const part = parseMessage(kept(keyframe())), axes = axesOf(part.orientation);
  const eye = [0.9, 1.2, 2.4], [r, u, b] = axesAt(eye, [0, 1.5, -1]);
  const clip = [1.3, 0, 0, 0, 0, 1.7, 0, 0, 0.1, -0.05, -1.002, -1, 0, 0, -0.2, 0];
  const matrix = new Float32Array(16);
  clipFromRaster({ worldFromEye: [...r, 0, ...u, 0, ...b, 0, ...eye, 1], clipFromEye: clip, width: 9, height: 9 }, part, axes, matrix);
  for (const [x, y, w] of [[0, 0, 0.3], [24, 16, 0.1], [7.5, 3.25, 2]]) {
    const s = part.left + ((part.right - part.left) * x) / 24, t = part.top + ((part.bottom - part.top) * y) / 16;
    const point = [0, 1, 2].map((k) => part.eye[k] + (s * axes[k] + t * axes[3 + k] - axes[6 + k]) / w);
    const from = point.map((p, k) => p - eye[k]), along = (a) => a.reduce((sum, c, k) => sum + c * from[k], 0);
    const p = [along(r), along(u), along(b), 1];
    const wanted = [0, 1, 3].map((row) => [0, 1, 2, 3].reduce((sum, k) => sum + clip[4 * k + row] * p[k], 0));
    const made = [0, 1, 3].map((row) => [x, y, w, 1].reduce((sum, c, k) => sum + matrix[4 * k + row] * c, 0));
    // Singles, of which some cancel.
    for (const k of [0, 1]) assert.ok(Math.abs(made[k] / made[2] - wanted[k] / wanted[2]) < 1e-4);
    // Its w is the distance times 1 / eye_z.
    assert.ok(Math.abs(made[2] / w - wanted[2]) < 1e-3 * Math.abs(wanted[2]));
  }
});

test("the keyframe that shows the view and is near is chosen, then one that shows what it does not", async () => {
  const { chooseKeyframes } = await load("live/choose-keyframes"), { axesOf } = await load("live/camera");
  const { parseMessage } = await load("live/messages");
  const at = (eye, target, of = {}) => {
    const camera = parseMessage(kept(keyframe({ eye, axes: axesAt(eye, target), left: -1, right: 1, bottom: -0.7, top: 0.7, ...of })));
    return { camera, axes: axesOf(camera.orientation) };
  };
  const [r, u, b] = axesAt([0, 1.6, 3], [0, 1.6, 0]);
  const view = { worldFromEye: [...r, 0, ...u, 0, ...b, 0, 0, 1.6, 3, 1],
                 clipFromEye: [1.2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1, -1, 0, 0, -0.2, 0], width: 16, height: 9 };
  const near = at([0.05, 1.6, 3], [0.05, 1.6, 0]), far = at([0.6, 1.6, 3], [0.6, 1.6, 0]);
  const behind = at([0, 1.6, 3], [0, 1.6, 6]), half = at([0, 1.6, 3], [2, 1.6, 0]), other = at([0, 1.6, 3], [-2, 1.6, 0]);
  assert.deepEqual(chooseKeyframes(view, [behind, far, near], 2), [near, far]);
  assert.deepEqual(chooseKeyframes(view, [behind], 2), []);
  // Two that look to the right by nearly the same: the one on the other side is of more use.
  const nearly = at([0.01, 1.6, 3], [2, 1.6, 0]);
  assert.deepEqual(chooseKeyframes(view, [half, nearly, other], 2).includes(other), true);
});

test("the socket lies beside the manifest and has the page's token", async () => {
  const { socketAddress, waitAfter } = await load("live/connection");
  assert.equal(socketAddress("live", "http://host:8080/a/walk.json", "http://host:8080/a/"), "ws://host:8080/a/live");
  assert.equal(socketAddress("live", "https://host/walk.json?x=1", "https://host/?token=t%2B1"), "wss://host/live?token=t%2B1");
  assert.equal(socketAddress("live", "https://host/b/c/walk.json", "https://host/b/c/#token=abc"), "wss://host/b/c/live?token=abc");
  // Twice as long each time, at most 8 s, and a quarter more or less.
  assert.deepEqual([1, 2, 3, 20].map((failures) => waitAfter(failures, 0.5)), [250, 500, 1000, 8000]);
  assert.equal(waitAfter(1, 0), 187.5);
});

test("a steady eye's speed and turn rate are measured, and a leap has none", async () => {
  const { Motion } = await load("live/motion");
  const at = (yaw, eye) => [Math.cos(yaw), 0, -Math.sin(yaw), 0, 0, 1, 0, 0, Math.sin(yaw), 0, Math.cos(yaw), 0, ...eye, 1];
  const motion = new Motion();
  // 1.4 m/s along x, and 0.5 rad/s to the left, at 50 frames a second.
  for (let k = 0; k < 60; ++k) motion.see(at(0.01 * k, [0.028 * k, 1, 2]), 0.02);
  // What is left of the beginning is 0.8 to the power of 59; of a turn of 0.01 the sine is 1.7e-5 of it less.
  assert.ok(Math.abs(motion.velocity[0] - 1.4) < 1e-4 && Math.abs(motion.velocity[1]) < 1e-9);
  assert.ok(Math.abs(motion.turnRate[1] - 0.5) < 1e-4 && Math.abs(motion.turnRate[0]) < 1e-9);
  motion.see(at(0, [9, 1, 2]), 0.1);
  assert.deepEqual([...motion.velocity, ...motion.turnRate], [0, 0, 0, 0, 0, 0]);
  // 8 mm in no time are no more than in a 250th of a second.
  motion.see(at(0, [9.008, 1, 2]), 0);
  assert.ok(motion.velocity[0] > 0 && motion.velocity[0] <= 2);
});
