// Walks through a real `rilievo serve` in Chromium, and compares what stands still with `rilievo render` of the same eye:
//   node tools/serve_walk.js RILIEVO FOLDER SCENE [OPTIONS of serve ...]
// FOLDER gets walk.png, still.png and true/, 640 x 360. In the environment: ADDRESS, of the page behind a proxy (with --port and
// --origin); WALK_MS; SETTLE_MS, within which a picture comes while there are any; RENDER, options of `rilievo render`.
import { spawn, spawnSync } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { launch } from "../test/browser.js";
import { load } from "../test/sources.js";

const [, , program, folder, scene, ...options] = process.argv;
if (!scene) {
  console.error("node tools/serve_walk.js RILIEVO FOLDER SCENE [OPTIONS of serve ...]");
  process.exit(2);
}
const kWidth = 640, kHeight = 360;
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
mkdirSync(folder, { recursive: true });

const server = spawn(program, ["serve", scene, ...(options.includes("--port") ? [] : ["--port", "0"]), ...options], { stdio: ["ignore", "ignore", "pipe"] });
const own = await new Promise((resolve, reject) => {
  let text = "";
  server.stderr.on("data", (data) => {
    text += data;
    const found = /open (http:\S+) in a browser/.exec(text);
    if (found) resolve(found[1]);
  });
  server.on("exit", (code) => reject(new Error(`rilievo serve ended with ${code}: ${text}`)));
});
server.removeAllListeners("exit");

const browser = await launch(["--ignore-certificate-errors"]), page = await browser.newPage(), errors = [];
page.on("pageerror", (error) => errors.push(String(error)));
await page.setViewport({ width: kWidth, height: kHeight });
// The last pose that the page told, and how many pictures came.
const session = await page.createCDPSession();
let pose = null, pictures = 0, welcome = null;
const { parseMessage } = await load("live/messages");
await session.send("Network.enable");
session.on("Network.webSocketFrameSent", ({ response }) => {
  const bytes = Buffer.from(response.payloadData, "base64");
  if (bytes[0] === 2) pose = bytes;
});
session.on("Network.webSocketFrameReceived", ({ response }) => {
  const bytes = Buffer.from(response.payloadData, "base64");
  pictures += bytes[0] === 66;
  if (bytes[0] === 65) welcome = parseMessage(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
});
await page.goto(process.env.ADDRESS ?? own);
const begin = performance.now();
const until = async (what, seconds) => {
  while (!what()) {
    if (performance.now() - begin > 1000 * seconds) throw new Error(`nothing came: ${errors}`);
    await sleep(50);
  }
};
await until(() => pictures > 0, 120);
const first = performance.now() - begin;
await page.keyboard.down("KeyW");
await page.keyboard.down("ArrowLeft");
await sleep(600);
await page.keyboard.up("ArrowLeft");
await sleep(Number(process.env.WALK_MS ?? 2500));
writeFileSync(join(folder, "walk.png"), await page.screenshot());
await page.keyboard.up("KeyW");
// It gets the view of its own place, and then the surround.
for (let before = -1; before !== pictures;) {
  before = pictures;
  await sleep(Number(process.env.SETTLE_MS ?? 4000));
}
writeFileSync(join(folder, "still.png"), await page.screenshot());

const at = { eye: [16, 24, 32].map((k) => pose.readDoubleLE(k)), orientation: [40, 44, 48, 52].map((k) => pose.readFloatLE(k)),
             vertical_fov: pose.readFloatLE(56), time: 0 };
writeFileSync(join(folder, "pose.json"), JSON.stringify({ schema: "rilievo-path-1", z_near: welcome.zNear, z_far: welcome.zFar, keys: [at] }));
let db = null;
const drawn = spawnSync(program, ["render", scene, "--path", join(folder, "pose.json"), "--frames", "1", "--size", `${kWidth}x${kHeight}`,
                                  "-o", join(folder, "true"), ...(process.env.RENDER ?? "").split(" ").filter(Boolean)]);
if (drawn.status === 0) {
  const { readdirSync } = await import("node:fs");
  const name = readdirSync(join(folder, "true")).find((one) => one.endsWith(".png"));
  const pictures = [join(folder, "true", name), join(folder, "still.png")].map((file) => readFileSync(file).toString("base64"));
  db = await page.evaluate(async (pictures) => {
    const [a, b] = await Promise.all(pictures.map(async (text) => {
      const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0)), bitmap = await createImageBitmap(new Blob([bytes]));
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
      context.drawImage(bitmap, 0, 0);
      return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
    }));
    let sum = 0;
    for (let i = 0; i < a.length; ++i) sum += i % 4 < 3 ? (a[i] - b[i]) ** 2 : 0;
    return 10 * Math.log10(255 ** 2 / (sum / (0.75 * a.length)));
  }, pictures);
} else {
  console.error(String(drawn.stderr));
}
console.log(JSON.stringify({ scene, options, address: page.url(), first_picture_s: first / 1000, pictures, eye: at.eye, still_db: db, errors }));
await browser.close();
server.kill("SIGINT");
