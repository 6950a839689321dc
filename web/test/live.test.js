// A live walk in Chromium, from a server of tests that sends keyframes of a room: what frames show, and what happens
// when the network is slow, silent or gone.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { launch } from "./browser.js";
import { kStart, serveLive, trueFrame } from "./live-mock.js";

const kSize = [320, 180];
const kFov = kStart.verticalFov;
// Where frames are kept to be looked at.
const kShow = process.env.LIVE_FRAMES;
let browser, painter;

before(async () => {
  browser = await launch();
  painter = await browser.newPage();
});

after(() => browser?.close());

// A WebP without loss, by the browser.
async function encode(rgba, width, height) {
  const text = await painter.evaluate(async (text, width, height) => {
    const bytes = Uint8ClampedArray.from(atob(text), (c) => c.charCodeAt(0)), canvas = new OffscreenCanvas(width, height);
    canvas.getContext("2d").putImageData(new ImageData(bytes, width, height), 0, 0);
    const made = new Uint8Array(await (await canvas.convertToBlob({ type: "image/webp", quality: 1 })).arrayBuffer());
    let out = "";
    for (const byte of made) out += String.fromCharCode(byte);
    return btoa(out);
  }, Buffer.from(rgba).toString("base64"), width, height);
  return Buffer.from(text, "base64");
}

async function open(server, address = "/test/live.html") {
  const page = await browser.newPage(), errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.setViewport({ width: kSize[0], height: kSize[1] });
  await page.goto(server.url + address);
  return { page, errors };
}

async function png(page, name) {
  if (kShow) writeFileSync(`${kShow}/${name}.png`, await page.screenshot());
}

/** The PSNR of the last frame against the truth, and the share of pixels that are off by more than a sixth. */
async function compared(page, key) {
  const drawn = Buffer.from(await page.evaluate(() => window.frame()), "base64"), truth = trueFrame(key, ...kSize);
  let sum = 0, wrong = 0;
  for (let i = 0; i < truth.length; i += 4) {
    let most = 0;
    for (let c = 0; c < 3; ++c) {
      const off = drawn[i + c] - truth[i + c];
      sum += off * off;
      most = Math.max(most, Math.abs(off));
    }
    if (most > 42) ++wrong;
  }
  const count = truth.length / 4;
  return { psnr: 10 * Math.log10((255 * 255 * 3 * count) / sum), wrong: wrong / count };
}

const key = (eye, target) => ({ eye, target, vertical_fov: kFov });
const kFirst = key(kStart.eye, kStart.target);

test("a frame from a keyframe's own eye is its picture, and near it nearly the true frame", async () => {
  const server = await serveLive(encode);
  const { page, errors } = await open(server);
  await page.evaluate(() => window.viewer.ready);
  await page.evaluate((key) => window.settle(key), kFirst);
  await png(page, "own");
  const own = await compared(page, kFirst);
  server.options.fine = server.options.coarse = false;
  const aside = key([0.25, 1.6, 2.9], [0.15, 1.5, 0]);
  await page.evaluate((key) => window.settle(key), aside);
  await png(page, "aside");
  const beside = await compared(page, aside);
  console.log(JSON.stringify({ own, beside }));
  assert.ok(own.psnr > 30 && own.wrong < 0.004, JSON.stringify(own));
  assert.ok(beside.psnr > 27 && beside.wrong < 0.01, JSON.stringify(beside));
  assert.deepEqual(await page.evaluate(() => window.errors), []);
  assert.deepEqual(errors, []);
  await page.close();
  await server.close();
});

test("a sudden turn shows what lies around, coarsely and nowhere nothing", async () => {
  const server = await serveLive(encode);
  const { page } = await open(server);
  await page.evaluate(() => window.viewer.ready);
  await page.evaluate((key) => window.settle(key), kFirst);
  server.options.fine = server.options.coarse = false;
  const turned = key(kStart.eye, [3, 1.4, 6]);
  await page.evaluate((key) => window.look(key), turned);
  await png(page, "turned");
  const after = await compared(page, turned);
  console.log(JSON.stringify(after));
  assert.ok(after.psnr > 25 && after.wrong < 0.03, JSON.stringify(after));
  await page.close();
  await server.close();
});

test("a walk is sharp where it ends", async () => {
  const server = await serveLive(encode);
  const { page, errors } = await open(server);
  await page.evaluate(() => window.viewer.ready);
  await page.evaluate((key) => window.settle(key), kFirst);
  const way = { center: [0, 1.6, 3.2], radius: 0.8, vertical_fov: kFov };
  await page.evaluate((key) => window.look(key), key([0.8, 1.6, 3.2], [0.8, 1.55, 4.2]));
  await page.evaluate((way) => window.sleep(600).then(() => window.walked(way, 60, 30)), way);
  await png(page, "walking");
  const end = key([0.6, 1.6, 3.5], [0.2, 1.5, 0]);
  await page.evaluate((key) => window.settle(key), end);
  await png(page, "walked");
  const at = await compared(page, end);
  console.log(JSON.stringify(at));
  assert.ok(at.psnr > 28 && at.wrong < 0.006, JSON.stringify(at));
  assert.ok(server.poses.every((pose) => Math.abs(Math.hypot(...pose.orientation) - 1) < 1e-5));
  assert.deepEqual(errors, []);
  await page.close();
  await server.close();
});

test("the page of the program walks behind a prefix and sends its token", async () => {
  const server = await serveLive(encode);
  const { page, errors } = await open(server, "/prefix/#token=abcdefghijklmnopq");
  await page.waitForFunction(() => document.title === "A room", { timeout: 20000 });
  assert.equal(server.messages.find(({ kind }) => kind === "open").url, "/prefix/live?token=abcdefghijklmnopq");
  await page.keyboard.press("KeyI");
  await page.waitForFunction(() => /Mbit\/s, picture/.test(document.querySelector("[role=status]")?.textContent ?? ""), { timeout: 5000 });
  await png(page, "page");
  assert.deepEqual(errors, []);
  await page.close();
  await server.close();
});

test("a server that is gone and comes back disturbs no frame", async () => {
  const server = await serveLive(encode);
  const { page, errors } = await open(server);
  await page.evaluate(() => window.viewer.ready);
  await page.evaluate((key) => window.settle(key), kFirst);
  await server.kill();
  const aside = key([0.1, 1.6, 2.9], [0.1, 1.5, 0]);
  await page.evaluate((key) => window.look(key), aside);
  const gone = await compared(page, aside);
  assert.ok(gone.psnr > 27, JSON.stringify(gone));
  await page.waitForFunction(() => /connection is lost/.test(document.querySelector("[role=status]").textContent), { timeout: 20000 });
  await server.listen();
  await page.waitForFunction(() => window.viewer.walk.live.connection.figures.connected, { timeout: 20000 });
  const other = key([0.5, 1.6, 2.2], [0.1, 1.5, -2]);
  await page.evaluate((key) => window.settle(key), other);
  const back = await compared(page, other);
  assert.ok(back.psnr > 28, JSON.stringify(back));
  assert.deepEqual(errors, []);
  await page.close();
  await server.close();
});

test("what is damaged is told of, and the walk goes on", async () => {
  const server = await serveLive(encode);
  const { page, errors } = await open(server);
  await page.evaluate(() => window.viewer.ready);
  await page.evaluate((key) => window.settle(key), kFirst);
  // Depths that end too soon: the picture alone is lost.
  server.options.damage = (bytes) => {
    if (bytes[0] === 66) bytes.fill(0, 170, 200);
    return bytes;
  };
  const moved = key([0.3, 1.6, 2.6], [0.1, 1.5, 0]);
  await page.evaluate((key) => window.look(key), moved);
  await page.waitForFunction(() => window.errors.some((text) => /server: is damaged/.test(text)), { timeout: 20000 });
  // A header that lies ends the connection, and the next one begins.
  server.options.damage = (bytes) => {
    if (bytes[0] === 66) bytes[4] = 7;
    return bytes;
  };
  const sockets = server.sockets;
  await page.evaluate((key) => window.look(key), key([0.6, 1.6, 2.6], [0.1, 1.5, 0]));
  await page.waitForFunction(() => window.errors.some((text) => /level is 7/.test(text)), { timeout: 20000 });
  server.options.damage = (bytes) => bytes;
  const end = Date.now() + 20000;
  while (server.sockets === sockets && Date.now() < end) await new Promise((resolve) => setTimeout(resolve, 50));
  await page.evaluate((key) => window.settle(key), moved);
  const after = await compared(page, moved);
  assert.ok(after.psnr > 28, JSON.stringify(after));
  assert.deepEqual(errors, []);
  await page.close();
  await server.close();
});
