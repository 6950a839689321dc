// What a live walk's client costs, from messages of a server that were recorded along a walk:
//   node tools/live.js record room|ADDRESS FILE [SECONDS]   ADDRESS of `rilievo serve`, with its token; room: the tests' server
//   node tools/live.js decode FILE                          depths and triangles, in this process
//   node tools/live.js stall FILE [WIDTHxHEIGHT]            frames in Chromium, with and without 5 s in which nothing comes
//   node tools/live.js look FILE FOLDER [WIDTHxHEIGHT]      frames of the walk, one a second, as PNG
import { createServer } from "node:http";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { extname, join } from "node:path";
import { WebSocket, WebSocketServer } from "ws";
import { launch, page as pageFolder, root } from "../test/browser.js";
import { serveLive } from "../test/live-mock.js";
import { load } from "../test/sources.js";

const [, , what, ...args] = process.argv;
const kPoseMs = 50, kFov = 1;
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (v) => v.map((x) => x / (Math.hypot(...v) || 1));

/** Ahead at 1.4 m/s for 2 m and back again, with turns; every tenth of a second. */
function pathFrom({ eye, target, up, unit: metres }, seconds) {
  const keys = [], ahead = unit(target.map((x, k) => x - eye[k])), aside = unit(cross(ahead, up));
  for (let i = 0; i <= 10 * seconds; ++i) {
    const t = i / 10, way = (1 / metres) * (1 - Math.cos(1.4 * t)), turn = 0.7 * Math.sin(0.8 * t);
    const at = eye.map((x, k) => x + way * ahead[k]);
    keys.push({ eye: at, target: at.map((x, k) => x + Math.cos(turn) * ahead[k] + Math.sin(turn) * aside[k]), up, vertical_fov: kFov });
  }
  return keys;
}

function readRecording(file) {
  const bytes = readFileSync(file), messages = [];
  const { keys, welcome } = JSON.parse(bytes.subarray(4, 4 + bytes.readUInt32LE(0)).toString());
  for (let at = 4 + bytes.readUInt32LE(0); at < bytes.length;) {
    const length = bytes.readUInt32LE(at + 8);
    messages.push({ ms: bytes.readDoubleLE(at), bytes: bytes.subarray(at + 12, at + 12 + length) });
    at += 12 + length;
  }
  return { keys, welcome: Buffer.from(welcome, "base64"), messages };
}

async function record(address, file, seconds = 20) {
  const { encodeHello, encodePose, encodePing, parseMessage } = await load("live/messages");
  const { quaternionOf } = await load("live/camera"), { socketAddress } = await load("live/connection");
  let browser = null, server = null;
  if (address === "room") {
    browser = await launch();
    const painter = await browser.newPage();
    const encode = async (rgba, width, height) => Buffer.from(await painter.evaluate(async (text, width, height) => {
      const bytes = Uint8ClampedArray.from(atob(text), (c) => c.charCodeAt(0)), canvas = new OffscreenCanvas(width, height);
      canvas.getContext("2d").putImageData(new ImageData(bytes, width, height), 0, 0);
      const made = new Uint8Array(await (await canvas.convertToBlob({ type: "image/webp", quality: 0.85 })).arrayBuffer());
      let out = "";
      for (let k = 0; k < made.length; k += 4096) out += String.fromCharCode(...made.subarray(k, k + 4096));
      return btoa(out);
    }, Buffer.from(rgba).toString("base64"), width, height), "base64");
    server = await serveLive(encode, { height: 720 });
    address = `${server.url}/`;
  }
  const socket = new WebSocket(socketAddress("live", new URL("walk.json", address).href, address),
                               { perMessageDeflate: false, origin: new URL(address).origin });
  const records = [];
  let welcome = null, bytesOfWelcome = null, begin = 0, received = 0;
  const welcomed = new Promise((resolve, reject) => {
    socket.on("error", reject);
    socket.on("close", () => reject(new Error("the server closed the connection")));
    socket.on("message", (data) => {
      const message = Buffer.from(data), kept = message.buffer.slice(message.byteOffset, message.byteOffset + message.length);
      const { kind } = parseMessage(kept);
      received += message.length;
      if (kind === "welcome") {
        welcome = parseMessage(kept);
        bytesOfWelcome = message;
        resolve();
      } else if (kind === "keyframe") {
        const head = Buffer.alloc(12);
        head.writeDoubleLE(performance.now() - begin, 0);
        head.writeUInt32LE(message.length, 8);
        records.push(head, message);
      }
    });
  });
  await new Promise((resolve) => socket.on("open", resolve));
  socket.send(encodeHello(1280, 720, 8192, 192 << 20));
  await welcomed;
  const keys = pathFrom(welcome, Number(seconds)), start = performance.now();
  const pose = { sequence: 0, time: 0, eye: new Float64Array(3), orientation: new Float64Array(4), verticalFov: kFov, aspect: 16 / 9,
                 velocity: new Float64Array(3), turnRate: new Float64Array(3), latency: 5, cell: 0 };
  begin = start;
  while (performance.now() - start < 1000 * seconds) {
    const at = (performance.now() - start) / 100, k = Math.min(keys.length - 2, Math.floor(at)), { eye, target, up } = keys[k];
    const next = keys[k + 1].eye;
    for (let c = 0; c < 3; ++c) {
      pose.eye[c] = eye[c] + (at - k) * (next[c] - eye[c]);
      pose.velocity[c] = 10 * (next[c] - eye[c]);
    }
    const back = unit(eye.map((x, c) => x - target[c])), right = unit(cross(up, back));
    quaternionOf([...right, 0, ...cross(back, right), 0, ...back, 0, 0, 0, 0, 1], pose.orientation);
    pose.time = performance.now();
    ++pose.sequence;
    socket.send(encodePose(pose));
    if (pose.sequence % 20 === 0) socket.send(encodePing(pose.time));
    await sleep(kPoseMs);
  }
  socket.terminate();
  const json = Buffer.from(JSON.stringify({ keys, welcome: bytesOfWelcome.toString("base64") })), length = Buffer.alloc(4);
  length.writeUInt32LE(json.length);
  writeFileSync(file, Buffer.concat([length, json, ...records]));
  console.log(JSON.stringify({ messages: records.length / 2, megabits_a_second: (8e-6 * received) / seconds }));
  // Pictures that are still in the making are of no use.
  browser?.process()?.kill();
  process.exit(0);
}

async function decode(file) {
  const { parseMessage } = await load("live/messages"), { decodePlane16 } = await load("plane16");
  const { makeMesh } = await load("live/mesh");
  const rows = [];
  // The second time programs are warm.
  for (const round of [0, 1])
    for (const { bytes } of readRecording(file).messages) {
      const kept = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), part = parseMessage(kept);
      const begin = performance.now();
      const codes = await decodePlane16(new Uint8Array(kept, part.depths.at, part.depths.bytes), part.width, part.height, "");
      const decoded = performance.now();
      const mesh = makeMesh(codes, part.width, part.height, part.offset, 1, 400000);
      const meshed = performance.now();
      if (round === 0) continue;
      rows.push({ fine: part.fine, texels: part.width * part.height, depth: part.depths.bytes, color: part.colors.bytes,
                  decode: decoded - begin, mesh: meshed - decoded, triangles: mesh.indices.length / 3, halved: mesh.scale > 1 });
    }
  for (const fine of [true, false]) {
    const some = rows.filter((row) => row.fine === fine), sum = (name) => some.reduce((total, row) => total + row[name], 0);
    if (some.length === 0) continue;
    console.log(JSON.stringify({
      pictures: some.length, fine, texels: Math.round(sum("texels") / some.length),
      depth_bits_a_texel: (8 * sum("depth")) / sum("texels"), color_bits_a_texel: (8 * sum("color")) / sum("texels"),
      decode_megapixels_a_second: sum("texels") / sum("decode") / 1000, mesh_megapixels_a_second: sum("texels") / sum("mesh") / 1000,
      triangles: Math.round(sum("triangles") / some.length), most_triangles: Math.max(...some.map((row) => row.triangles)),
      halved: some.filter((row) => row.halved).length,
    }));
  }
}

// Serves the page, and the recording in its own time, but for what comes from `from` to `to`, ms.
async function replay({ welcome, messages }, from, to) {
  const types = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json" };
  const http = createServer((request, response) => {
    const name = new URL(request.url, "http://host").pathname.slice(1);
    const file = [join(pageFolder, name), join(root, name)].find((path) => existsSync(path));
    const live = { schema: "rilievo-walk-1", name: "", live: { socket: "live", protocol: 1 } };
    response.writeHead(200, { "content-type": types[extname(name)] ?? "text/plain" });
    response.end(name === "walk.json" ? JSON.stringify(live) : file ? readFileSync(file) : "");
  });
  const sockets = new WebSocketServer({ server: http, perMessageDeflate: false });
  let begin = 0;
  sockets.on("connection", (socket) => {
    const timers = [];
    socket.on("close", () => timers.forEach(clearTimeout));
    socket.on("message", (data) => {
      if (Buffer.from(data)[0] !== 1 || timers.length) return;
      socket.send(welcome);
      begin = performance.now();
      // After the stall what is newest comes, as a server would send it.
      const held = messages.filter(({ ms }) => ms >= from && ms < to).slice(-2).map((message) => ({ ...message, ms: to }));
      for (const { ms, bytes } of [...messages.filter(({ ms }) => ms < from || ms >= to), ...held])
        timers.push(setTimeout(() => socket.send(bytes), ms));
    });
  });
  await new Promise((resolve) => http.listen(0, "127.0.0.1", resolve));
  return {
    url: `http://127.0.0.1:${http.address().port}`,
    get passed() {
      return performance.now() - begin;
    },
    close() {
      for (const client of sockets.clients) client.terminate();
      sockets.close();
      http.closeAllConnections();
      http.close();
    },
  };
}

async function openReplay(browser, recording, size, from, to) {
  const server = await replay(recording, from, to), page = await browser.newPage();
  await page.setViewport({ width: size[0], height: size[1] });
  await page.goto(`${server.url}/test/live.html`);
  await page.evaluate(() => window.viewer.ready);
  return { server, page };
}

const sizeOf = (text) => text.split("x").map(Number);
const percentile = (times, share) => [...times].sort((a, b) => a - b)[Math.floor(share * (times.length - 1))];

async function stall(file, size = "1280x720") {
  const recording = readRecording(file), browser = await launch(), seconds = (recording.keys.length - 1) / 10;
  const made = {};
  // In turns, so that what disturbs the machine disturbs both.
  for (const [name, from, to] of [["flowing", 1e9, 1e9], ["stalled", 6000, 11000], ["flowing", 1e9, 1e9], ["stalled", 6000, 11000]]) {
    const { server, page } = await openReplay(browser, recording, sizeOf(size), from, to);
    const times = await page.evaluate((keys, passed, seconds) => window.followed(keys, passed, seconds), recording.keys, server.passed, seconds);
    (made[name] ??= []).push(...times);
    console.error(name, percentile(times, 0.5).toFixed(1), percentile(times, 0.99).toFixed(1));
    await page.close();
    server.close();
  }
  await browser.close();
  const row = (times) => ({ frames: times.length, p50_ms: percentile(times, 0.5), p90_ms: percentile(times, 0.9), p99_ms: percentile(times, 0.99) });
  console.log(JSON.stringify({ size, flowing: row(made.flowing), stalled: row(made.stalled),
                               p99_ratio: percentile(made.stalled, 0.99) / percentile(made.flowing, 0.99) }));
}

async function look(file, folder, size = "1280x720") {
  const recording = readRecording(file), browser = await launch();
  const { server, page } = await openReplay(browser, recording, sizeOf(size), 1e9, 1e9);
  for (let k = 1; k < recording.keys.length / 10; ++k) {
    while (server.passed < 1000 * k) await sleep(5);
    await page.evaluate((key) => window.look(key), recording.keys[10 * k]);
    writeFileSync(join(folder, `frame_${String(k).padStart(2, "0")}.png`), await page.screenshot());
  }
  await browser.close();
  server.close();
}

const modes = { record, decode, stall, look };
if (!modes[what]) {
  console.error("node tools/live.js record room|ADDRESS FILE [SECONDS] | decode FILE | stall FILE [SIZE] | look FILE FOLDER [SIZE]");
  process.exit(2);
}
await modes[what](...args);
