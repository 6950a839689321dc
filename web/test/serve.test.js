// The page of `rilievo serve` in Chromium, from the program itself: it walks, and comes back after the program was killed.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import { launch, root } from "./browser.js";

const program = process.env.RILIEVO_PROGRAM ?? join(root, "../build/release/bin/rilievo");
const skip = !existsSync(program) ? `${program} is not built: tools/test builds it, or RILIEVO_PROGRAM names another`
  : spawnSync(program, ["serve", "--help"]).status !== 0 ? `${program} has no serve: it is older than this test` : false;
const started = [];

after(() => started.forEach((child) => child.kill("SIGKILL")));

/** Starts the program; its port comes with the address that it prints. */
async function start(port) {
  const child = spawn(program, ["serve", "builtin:stonehenge", "--port", String(port)], { stdio: ["ignore", "pipe", "pipe"] });
  started.push(child);
  const address = await new Promise((resolve, reject) => {
    let text = "";
    for (const stream of [child.stdout, child.stderr])
      stream.on("data", (data) => {
        text += data;
        const found = /http:\/\/127\.0\.0\.1:(\d+)\//.exec(text);
        if (found) resolve(found);
      });
    child.on("exit", (code) => reject(new Error(`rilievo serve ended with ${code}: ${text}`)));
  });
  return { child, url: address[0], port: Number(address[1]) };
}

// Colours of the screenshot that differ by a step of 32.
const colorsOf = (page) => page.evaluate(async (text) => {
  const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${text}`)).blob());
  const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height), found = new Set();
  for (let i = 0; i < data.length; i += 4) found.add(((data[i] >> 5) << 6) | ((data[i + 1] >> 5) << 3) | (data[i + 2] >> 5));
  return found.size;
}, Buffer.from(page.shot).toString("base64"));

test("the page of the program walks, and goes on after the program was killed", { skip, timeout: 240000 }, async () => {
  const first = await start(0), browser = await launch(), page = await browser.newPage(), errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.setViewport({ width: 320, height: 180 });
  await page.goto(first.url);
  await page.waitForFunction(() => document.title === "stonehenge", { timeout: 60000 });
  await page.keyboard.press("KeyI");
  const line = () => document.querySelector("[role=status]")?.textContent ?? "";
  await page.waitForFunction(`/Mbit.s, picture/.test((${line})())`, { timeout: 60000 });
  await page.keyboard.down("KeyW");
  await new Promise((resolve) => setTimeout(resolve, 1500));
  await page.keyboard.up("KeyW");
  page.shot = await page.screenshot();
  // Sky, grass, stones and ten coloured balls; the default sky alone has a few.
  const colors = await colorsOf(page);
  assert.ok(colors > 30, `${colors} colours`);

  first.child.removeAllListeners("exit");
  first.child.kill("SIGKILL");
  await page.waitForFunction(`/is lost/.test((${line})())`, { timeout: 60000 });
  // What was there is shown.
  page.shot = await page.screenshot();
  assert.ok((await colorsOf(page)) > 30);
  await start(first.port);
  await page.waitForFunction(`/Mbit.s/.test((${line})())`, { timeout: 60000 });
  assert.deepEqual(errors, []);
  await browser.close();
});
