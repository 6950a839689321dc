// What the tests ask a page for. `viewer` is the page's viewer.

import { randomNumbers } from "./random-numbers.js";

function normalized(v) {
  const length = Math.hypot(...v);
  return v.map((x) => x / length);
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** The view of a key of a camera path (rilievo-path-1) with a target. */
function viewOf(key, width, height, near, far) {
  const back = normalized(key.eye.map((e, i) => e - key.target[i]));
  const right = normalized(cross(key.up ?? [0, 1, 0], back));
  const up = cross(back, right);
  const tall = 1 / Math.tan(0.5 * key.vertical_fov);
  return {
    worldFromEye: [...right, 0, ...up, 0, ...back, 0, ...key.eye, 1],
    clipFromEye: [(tall * height) / width, 0, 0, 0, 0, tall, 0, 0,
                  0, 0, -(far + near) / (far - near), -1, 0, 0, (-2 * far * near) / (far - near), 0],
    width, height,
  };
}

/** Loads what a key needs, and draws it. */
window.settle = async (key) => {
  const { viewer } = window;
  const { width, height } = viewer.canvas;
  viewer.setView(viewOf(key, width, height, key.z_near ?? 0.05, key.z_far ?? 50));
  const end = performance.now() + 30000;
  do {
    viewer.draw();
    await new Promise((resolve) => setTimeout(resolve, 1));
  } while (!viewer.walk.settled && performance.now() < end);
  if (!viewer.walk.settled) throw new Error("the walk does not settle");
  viewer.draw();
  drain();
};

// Waits until all that was asked of the rasteriser is drawn.
const pixel = new Uint8Array(4);
function drain() {
  const gl = window.viewer.canvas.getContext("webgl2");
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
}
window.drain = drain;

/** The same of several, until nothing more comes. */
window.settleAll = async (keys) => {
  const { walk } = window.viewer;
  for (const key of keys) await window.settle(key);
  for (let quiet = 0, loaded = walk.stats.loaded; quiet < 60; ++quiet) {
    await window.settle(keys[quiet % keys.length]);
    await new Promise((resolve) => setTimeout(resolve, 10));
    if (walk.stats.loaded !== loaded || walk.stats.loading > 0) quiet = 0;
    loaded = walk.stats.loaded;
  }
};

/** RGBA, the bottom row first. */
function pixels() {
  const { canvas } = window.viewer;
  const gl = canvas.getContext("webgl2");
  const made = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, made);
  return made;
}
window.pixels = pixels;

async function pictureOf(url) {
  const bitmap = await createImageBitmap(await (await fetch(url)).blob(),
                                         { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  return context.getImageData(0, 0, bitmap.width, bitmap.height);
}

/** PSNR of frames in two folders, at most 100 dB. */
window.psnrsOf = async (folder, other, count) => {
  const psnrs = [];
  for (let k = 0; k < count; ++k) {
    const name = `frame_${String(k).padStart(5, "0")}.png`;
    const [a, b] = await Promise.all([folder, other].map((of) => pictureOf(`${of}/${name}`)));
    let sum = 0;
    for (let i = 0; i < a.data.length; i += 4)
      for (let c = 0; c < 3; ++c) sum += (a.data[i + c] - b.data[i + c]) ** 2;
    psnrs.push(Math.min(100, 10 * Math.log10((255 * 255 * 3 * a.width * a.height) / sum)));
  }
  return psnrs;
};

/** PSNR of each key's frame against FOLDER/K.png. */
window.comparedFrames = async (keys, folder) => {
  const psnrs = [];
  for (let k = 0; k < keys.length; ++k) {
    await window.settle(keys[k]);
    const drawn = pixels();
    const truth = await pictureOf(`${folder}/${k}.png`);
    const { width, height, data } = truth;
    let sum = 0;
    for (let y = 0; y < height; ++y)
      for (let x = 0; x < width; ++x)
        for (let c = 0; c < 3; ++c)
          sum += (drawn[4 * ((height - 1 - y) * width + x) + c] - data[4 * (y * width + x) + c]) ** 2;
    psnrs.push(10 * Math.log10((255 * 255 * 3 * width * height) / sum));
  }
  return psnrs;
};

/** The middle pixel of a frame of sky alone. */
window.skyAt = (key) => {
  const { viewer } = window;
  const { width, height } = viewer.canvas;
  const gl = viewer.canvas.getContext("webgl2");
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, width, height);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  viewer.walk.drawer.drawSky(viewOf(key, width, height, 0.1, 100));
  return Array.from(pixels().subarray(4 * ((height >> 1) * width + (width >> 1))).subarray(0, 3));
};

/** The objects that each key's frame shows. */
window.shownObjects = async (keys) => {
  const all = [];
  for (const key of keys) {
    await window.settle(key);
    window.viewer.walk.drawObjects(window.viewer.view(), null);
    const ids = new Set();
    const drawn = pixels();
    for (let i = 0; i < drawn.length; i += 4) ids.add(drawn[i] + 256 * drawn[i + 1]);
    all.push([...ids]);
  }
  return all;
};

// Two eyes of a headset whose head is turned by `yaw`, as they stand in the space of a session.
function headsetEyes(yaw) {
  const c = Math.cos(yaw), s = Math.sin(yaw);
  return [-0.032, 0.032].map((aside, index) => ({
    index, transform: { matrix: Float32Array.from(
      [c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, c * aside + 0.1, 0.2, -s * aside, 1]) },
    // Wider outwards.
    projectionMatrix: Float32Array.from([1.1, 0, 0, 0, 0, 1.2, 0, 0, index === 0 ? -0.15 : 0.15, 0.05,
                                         -1.002, -1, 0, 0, -0.1, 0]),
  }));
}

/** Frames of a mocked session (walk.test.js): what both eyes see, and where they stand. */
window.inHeadset = async () => {
  const { headset, viewer } = window;
  let now = 0;
  const frame = (eyes) => headset.frame((now += 50), { getViewerPose: () => ({ views: eyes }) });
  const { controls, walk } = viewer;
  // The controllers' sticks.
  const eye = Array.from(controls.eye), { yaw } = controls;
  frame(headsetEyes(0));
  headset.session.inputSources = [{ handedness: "left", gamepad: { axes: [0, 0, 0, -1] } },
                                  { handedness: "right", gamepad: { axes: [0, 0, 0.5, 0] } }];
  for (let k = 0; k < 3; ++k) frame(headsetEyes(0));
  headset.session.inputSources = [];
  const walked = Math.hypot(...eye.map((x, k) => x - controls.eye[k])), turned = yaw - controls.yaw;
  const eyes = headsetEyes(0.3);
  const end = performance.now() + 30000;
  do {
    frame(eyes);
    await new Promise((resolve) => setTimeout(resolve, 1));
  } while (!walk.settled && performance.now() < end);
  frame(eyes);
  return { walked, turned, pixels: Array.from(pixels()) };
};

/** Pixels of which these eyes differ from the same ones alone, and from each other. */
window.outOfHeadset = async ({ pixels: together }) => {
  const { viewer } = window, { controls, canvas } = viewer, { width, height } = canvas;
  const { eye, yaw, up, north, east } = controls;
  const level = [0, 1, 2].map((k) => north[k] * Math.cos(yaw) - east[k] * Math.sin(yaw));
  const right = [0, 1, 2].map((k) => east[k] * Math.cos(yaw) + north[k] * Math.sin(yaw));
  const standing = [...right, 0, ...up, 0, ...level.map((x) => -x), 0, ...eye, 1];
  let different = 0, eyesDiffer = 0;
  for (const { index, transform: { matrix: m }, projectionMatrix } of headsetEyes(0.3)) {
    const worldFromEye = Float32Array.from({ length: 16 }, (_, i) => [0, 1, 2, 3].reduce(
      (sum, k) => sum + standing[4 * k + (i % 4)] * m[4 * Math.floor(i / 4) + k], 0));
    viewer.setView({ worldFromEye, clipFromEye: projectionMatrix, width: width / 2, height });
    viewer.draw();
    const alone = pixels();
    for (let y = 0; y < height; ++y)
      for (let x = 0; x < width / 2; ++x)
        for (let c = 0; c < 3; ++c) {
          const at = 4 * (y * width + x + (index * width) / 2) + c;
          const other = 4 * (y * width + x + ((1 - index) * width) / 2) + c;
          if (alone[4 * (y * width + x) + c] !== together[at]) ++different;
          if (together[at] !== together[other]) ++eyesDiffer;
        }
  }
  return { different, eyesDiffer };
};

// Draws a frame as the page does, and asks for no other: milliseconds of update() and of the rest.
function drawView(view, times) {
  const { walk, canvas } = window.viewer;
  const gl = canvas.getContext("webgl2"), e = view.worldFromEye;
  const begin = performance.now();
  walk.update(e[12], e[13], e[14]);
  const updated = performance.now();
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, view.width, view.height);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  walk.draw(view, null, true);
  times[0] = updated - begin;
  times[1] = performance.now() - updated;
}

const percentile = (times, share) => {
  const sorted = Array.from(times).sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
};

/** Walks between the keys in so many frames, again until the seconds have passed; what a frame costs. */
window.walked = async (keys, frames, seconds = 0) => {
  const { viewer } = window;
  for (const key of keys) await window.settle(key);
  // Once what is no longer used has gone, if the browser lets us ask for that.
  const heap = () => {
    window.gc?.();
    return performance.memory?.usedJSHeapSize ?? 0;
  };
  let drawCalls = 0, triangles = 0;
  const update = new Float32Array(frames), draw = new Float32Array(frames), views = [];
  const times = new Float32Array(2);
  for (let i = 0; i < frames; ++i) {
    const at = (i / frames) * (keys.length - 1), k = Math.floor(at), s = at - k;
    const mix = (a, b) => a.map((x, c) => x + s * (b[c] - x));
    const { width, height } = viewer.canvas;
    views.push(viewOf({ ...keys[k], eye: mix(keys[k].eye, keys[k + 1].eye),
                        target: mix(keys[k].target, keys[k + 1].target) },
                      width, height, keys[k].z_near ?? 0.05, keys[k].z_far ?? 50));
  }
  const before = heap(), begin = performance.now();
  let drawn = 0;
  for (; drawn < frames || performance.now() < begin + 1e3 * seconds; ++drawn) {
    const i = drawn % frames;
    drawView(views[i], times);
    update[i] = times[0];
    draw[i] = times[1];
    const { stats } = viewer.walk;
    drawCalls = Math.max(drawCalls, stats.drawCalls);
    triangles = Math.max(triangles, stats.triangles);
    drain();
    if (i % 8 === 0) await new Promise((resolve) => setTimeout(resolve, 0));
  }
  return {
    frames: drawn, seconds: 1e-3 * (performance.now() - begin), drawCalls, triangles, bytes: viewer.walk.stats.bytes, nodes: viewer.walk.stats.nodes,
    loaded: viewer.walk.stats.loaded,
    frame_ms: (performance.now() - begin) / drawn,
    update_p50_ms: percentile(update, 0.5), update_p99_ms: percentile(update, 0.99),
    draw_p50_ms: percentile(draw, 0.5), draw_p99_ms: percentile(draw, 0.99),
    heap_grown: heap() - before,
  };
};

/** Keys between nodes that see each other, or around a node that is alone; they look anywhere. */
window.eyesBetweenNodes = (count) => {
  const { manifest, chooser } = window.viewer.walk;
  const { nodes, start, up } = manifest;
  const random = randomNumbers(7);
  const keys = [];
  const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  for (let tried = 0; keys.length < count; ++tried) {
    if (tried > 1000 * count) throw new Error("there is no place for eyes");
    const i = tried % nodes.length, at = nodes[i].eye;
    const seen = nodes.map((_, j) => j)
      .filter((j) => j !== i && chooser.sees(i, ...nodes[j].eye))
      .sort((a, b) => distance(nodes[a].eye, at) - distance(nodes[b].eye, at)).slice(0, 3);
    const to = seen.length ? nodes[seen[Math.floor(random() * seen.length)]].eye : at;
    const share = 0.1 + 0.4 * random(), jitter = seen.length ? 0.15 * distance(at, to) : 0.3;
    const away = at.map((x, k) => share * (to[k] - x) + jitter * (2 * random() - 1));
    const eye = at.map((x, k) => x + away[k]);
    // With some room behind it.
    if (!chooser.sees(i, ...at.map((x, k) => x + 1.2 * away[k]))) continue;
    const yaw = 2 * Math.PI * random(), pitch = 0.6 * (random() - 0.5);
    // Any two directions across `up`.
    const a = Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1];
    const across = normalized(cross(up, a)), other = cross(up, across);
    const target = eye.map((x, k) => x + Math.cos(pitch) * (Math.cos(yaw) * across[k] +
      Math.sin(yaw) * other[k]) + Math.sin(pitch) * up[k]);
    keys.push({ eye, target, up, vertical_fov: start.verticalFov, z_near: start.zNear,
                z_far: start.zFar });
  }
  return keys;
};

/** The last frame as PNG in base64. */
async function png() {
  const { canvas } = window.viewer;
  const { width, height } = canvas;
  const drawn = pixels(), data = new ImageData(width, height);
  for (let y = 0; y < height; ++y)
    data.data.set(drawn.subarray(4 * width * (height - 1 - y), 4 * width * (height - y)),
                  4 * width * y);
  for (let i = 3; i < data.data.length; i += 4) data.data[i] = 255;
  const sheet = new OffscreenCanvas(width, height);
  sheet.getContext("2d").putImageData(data, 0, 0);
  const blob = await sheet.convertToBlob({ type: "image/png" });
  const bytes = new Uint8Array(await blob.arrayBuffer());
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text);
}

window.pngOfFrame = png;

/** A key's frame, and the objects that it shows as red + 256 green, as PNG in base64. */
window.pngsOf = async (key) => {
  await window.settle(key);
  const frame = await png();
  window.viewer.walk.drawObjects(window.viewer.view(), null);
  return { frame, objects: await png() };
};

/** Draws a key's frame now, and asks for no other. */
window.look = (key) => {
  const { width, height } = window.viewer.canvas;
  drawView(viewOf(key, width, height, key.z_near, key.z_far), new Float32Array(2));
};
