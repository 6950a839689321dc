// A server of a live walk for tests: the page, and a socket that answers poses with keyframes of a room. It can be
// slow, silent, and send what is damaged.
import { createServer } from "node:http";
import { existsSync, readFileSync } from "node:fs";
import { extname, join } from "node:path";
import { WebSocketServer } from "ws";
import { page, root } from "./browser.js";
import { axesAt, axesOfQuaternion, codesOf, encodePlane16, picture, quaternionOfAxes } from "./live-scene.js";

export const kStart = { eye: [0, 1.6, 3], target: [0, 1.5, 0], verticalFov: 1.0 };
const kTypes = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json" };
const kStep = 1 / 12000, kOffset = -0.5;

export function encodeWelcome() {
  const name = Buffer.from("A room"), bytes = Buffer.alloc(152 + name.length);
  bytes[0] = 65, bytes[1] = 1;
  bytes.writeUInt16LE(name.length, 4);
  const vectors = [[-6, 0, -6], [6, 3, 6], [0, 1, 0], kStart.eye, kStart.target];
  vectors.flat().forEach((x, k) => bytes.writeDoubleLE(x, 8 + 8 * k));
  [kStart.verticalFov, 0.1, 100, 1].forEach((x, k) => bytes.writeFloatLE(x, 128 + 4 * k));
  name.copy(bytes, 152);
  return bytes;
}

/** A part of a keyframe; `of` has what live-scene.js' picture() takes, and what the header says. */
export function encodeKeyframe(of, colors, depths) {
  const bytes = Buffer.alloc(160 + depths.length + colors.length);
  bytes.set([66, 1, 0, 0, of.fine ? 1 : 0, of.layer ?? 0, 2, of.side >= 0 ? 1 : 0]);
  bytes.writeBigUInt64LE(BigInt(of.keyframe), 8);
  bytes.writeBigUInt64LE(BigInt(of.id), 16);
  of.eye.forEach((x, k) => bytes.writeDoubleLE(x, 40 + 8 * k));
  quaternionOfAxes(of.axes).forEach((x, k) => bytes.writeFloatLE(x, 64 + 4 * k));
  [of.left, of.right, of.bottom, of.top].forEach((x, k) => bytes.writeFloatLE(x, 80 + 4 * k));
  bytes.writeUInt16LE(of.width, 96);
  bytes.writeUInt16LE(of.height, 98);
  [kStep, kOffset, of.cell ?? 0.5, 0.25, 0.1].forEach((x, k) => bytes.writeFloatLE(x, 100 + 4 * k));
  bytes.writeDoubleLE(performance.now(), 120);
  bytes.writeUInt32LE(of.pose ?? 0, 128);
  bytes.writeUInt32LE(depths.length, 132);
  bytes.writeUInt32LE(colors.length, 136);
  bytes[140] = Math.max(0, of.side ?? 0);
  bytes.set(depths, 160);
  bytes.set(colors, 160 + depths.length);
  return bytes;
}

export function parsePose(bytes) {
  const floats = (at, count) => Array.from({ length: count }, (_, k) => bytes.readFloatLE(at + 4 * k));
  return {
    sequence: bytes.readUInt32LE(4), eye: [0, 1, 2].map((k) => bytes.readDoubleLE(16 + 8 * k)),
    orientation: floats(40, 4), verticalFov: bytes.readFloatLE(56), aspect: bytes.readFloatLE(60),
    velocity: floats(64, 3), turnRate: floats(76, 3),
  };
}

const kSides = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

// Looks to a side; up and down have their own upper side.
function sideAxes(side) {
  const back = kSides[side].map((x) => -x), above = Math.abs(back[1]) > 0.5 ? [0, 0, back[1]] : [0, 1, 0];
  const right = [above[1] * back[2] - above[2] * back[1], above[2] * back[0] - above[0] * back[2],
                 above[0] * back[1] - above[1] * back[0]];
  return [right, above, back];
}

/**
 * `encode(rgba, width, height)` makes a WebP. The server's `options` may be changed at any time: `surround`, `coarse` and `fine`
 * pictures or none of them, `height` of a fine one, `silent`, `damage(bytes)`.
 */
export async function serveLive(encode, options = {}) {
  const state = { surround: true, coarse: true, fine: true, silent: false, height: 180, margin: 1.3, damage: (b) => b, ...options };
  const poses = [], messages = [];
  let next = 1, sockets = 0;
  const http = createServer((request, response) => {
    // Behind a prefix, as a reverse proxy that keeps it would ask.
    const name = new URL(request.url, "http://host").pathname.replace(/^\/prefix/, "").slice(1) || "index.html";
    if (name === "walk.json") {
      response.writeHead(200, { "content-type": kTypes[".json"] });
      response.end(JSON.stringify({ schema: "rilievo-walk-1", name: "live", live: { socket: "live", protocol: 1, token: false } }));
      return;
    }
    const file = [join(page, name), join(root, name)].find((path) => existsSync(path));
    response.writeHead(file ? 200 : 404, { "content-type": kTypes[extname(name)] ?? "text/plain" });
    response.end(file ? readFileSync(file) : "");
  });
  const live = new WebSocketServer({ server: http, perMessageDeflate: false, maxPayload: 4096 });
  const part = async (of) => {
    const { colors, inverse } = picture(of);
    return encodeKeyframe(of, await encode(colors, of.width, of.height),
                          encodePlane16(codesOf(inverse, kStep, kOffset), of.width));
  };
  live.on("connection", (socket, request) => {
    ++sockets;
    let wanted = null, busy = false, surroundAt = null, made = null;
    messages.push({ kind: "open", url: request.url });
    const send = (bytes) => {
      if (!state.silent && socket.readyState === socket.OPEN) socket.send(state.damage(bytes));
    };
    const work = async () => {
      if (busy) return;
      busy = true;
      while (wanted && socket.readyState === socket.OPEN) {
        const pose = wanted;
        wanted = null;
        const { eye } = pose, axes = axesOfQuaternion(pose.orientation);
        const far = (a, of) => Math.hypot(...eye.map((x, k) => x - of.eye[k])) > a;
        if (state.surround && (!surroundAt || far(2, { eye: surroundAt }))) {
          surroundAt = eye;
          const keyframe = next++;
          for (let side = 0; side < 6; ++side)
            send(await part({ eye, axes: sideAxes(side), left: -1, right: 1, bottom: -1, top: 1, width: 96, height: 96,
                              fine: false, side, keyframe, id: next++ }));
        }
        const back = axes[2], turned = made ? Math.acos(Math.min(1, made.axes[2].reduce((s, x, k) => s + x * back[k], 0))) : 9;
        if (made && !far(0.15, made) && turned < 0.15) continue;
        const top = state.margin * Math.tan(0.5 * pose.verticalFov), right = top * pose.aspect;
        const camera = { eye, axes, left: -right, right, bottom: -top, top, keyframe: next++, pose: pose.sequence };
        made = camera;
        for (const fine of [false, true]) {
          if (!(fine ? state.fine : state.coarse)) continue;
          const height = Math.round(state.height * state.margin * (fine ? 1 : 0.25)), width = Math.round(height * pose.aspect);
          send(await part({ ...camera, fine, width, height, id: next++ }));
        }
      }
      busy = false;
    };
    socket.on("message", (data) => {
      const bytes = Buffer.from(data);
      messages.push({ kind: bytes[0], bytes });
      if (bytes[0] === 1) send(encodeWelcome());
      if (bytes[0] === 5) {
        const pong = Buffer.alloc(24);
        pong[0] = 67, pong[1] = 1;
        bytes.copy(pong, 8, 8, 16);
        pong.writeDoubleLE(performance.now(), 16);
        send(pong);
      }
      if (bytes[0] === 2) {
        const pose = parsePose(bytes);
        poses.push(pose);
        wanted = pose;
        // A picture that is in the making when a test ends is of no use.
        work().catch((error) => {
          if (socket.readyState === socket.OPEN) throw error;
        });
      }
    });
  });
  const listen = (port) => new Promise((resolve) => http.listen(port, "127.0.0.1", resolve));
  await listen(0);
  const { port } = http.address();
  return {
    url: `http://127.0.0.1:${port}`, options: state, poses, messages,
    get sockets() {
      return sockets;
    },
    /** Ends all connections, as a server that is killed; `listen()` starts it again. */
    async kill() {
      for (const client of live.clients) client.terminate();
      http.closeAllConnections();
      await new Promise((resolve) => http.close(resolve));
    },
    listen: () => listen(port),
    async close() {
      live.close();
      await this.kill();
    },
  };
}

/** The true frame of a view, from a key's eye and target. */
export function trueFrame({ eye, target, vertical_fov }, width, height) {
  const top = Math.tan(0.5 * vertical_fov), right = (top * width) / height;
  return picture({ eye, axes: axesAt(eye, target), left: -right, right, bottom: -top, top, width, height }).colors;
}
