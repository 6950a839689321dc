// The page in WebKitGTK, as Debian has it (webkit2gtk-driver, xvfb): draws the tests' walks from the
// tests' eyes and compares the frames with those of the C++ drawer.
//   node tools/webkit.js [FOLDER FOR SCREENSHOTS]
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { page, root, serve, walk } from "../test/browser.js";

// As test/walk.test.js has it.
const kLeastPsnr = { walk: 38, impostor: 38, nailboards: 37.5, reliefs: 45 };
const lib = "/usr/lib/x86_64-linux-gnu";
const browser = readdirSync(lib).map((name) => join(lib, name, "MiniBrowser")).find(existsSync);
assert.ok(browser && existsSync("/usr/bin/WebKitWebDriver"), "tools/setup web installs WebKitGTK");

const children = [];
function start(program, args, env = {}) {
  const child = spawn(program, args, { env: { ...process.env, ...env }, stdio: "ignore" });
  children.push(child);
  return child;
}
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

const display = `:${90 + (process.pid % 400)}`;
const port = 20000 + (process.pid % 20000);
const driver = `http://127.0.0.1:${port}`;

async function ask(method, path, body) {
  const response = await fetch(driver + path, { method, body: body && JSON.stringify(body) });
  const { value } = await response.json();
  if (!response.ok) throw new Error(`${path}: ${value.error}: ${value.message}`);
  return value;
}

const server = await serve({
  walk: [walk, page], impostor: join(root, "test/impostor"),
  nailboards: join(root, "test/nailboards"), reliefs: join(root, "test/reliefs"), test: join(root, "test"),
});
try {
  start("Xvfb", [display, "-screen", "0", "800x600x24"]);
  await pause(1000);
  start("WebKitWebDriver", [`--port=${port}`], {
    DISPLAY: display, LIBGL_ALWAYS_SOFTWARE: "1", WEBKIT_DISABLE_SANDBOX_THIS_IS_DANGEROUS: "1",
    GDK_BACKEND: "x11",
  });
  await pause(1000);
  const session = await ask("POST", "/session", {
    capabilities: { alwaysMatch: { "webkitgtk:browserOptions": { binary: browser, args: ["--automation"] } } },
  });
  const at = `/session/${session.sessionId}`;
  await ask("POST", `${at}/timeouts`, { script: 120000 });
  const run = async (script, ...args) => {
    const value = await ask("POST", `${at}/execute/async`, {
      script: `const done = arguments[arguments.length - 1];
        (async () => { ${script} })().then((value) => done({ value }), (error) => done({ error: String(error) }));`,
      args,
    });
    if (value.error) throw new Error(value.error);
    return value.value;
  };
  await ask("POST", `${at}/url`, { url: `${server.url}/test/viewer.html` });
  console.log(`${session.capabilities.browserName} ${session.capabilities.browserVersion}`);
  for (const [which, least] of Object.entries(kLeastPsnr)) {
    const file = join(root, "test", which === "walk" ? "path.json" : `${which}/path.json`);
    const { keys, z_near, z_far } = JSON.parse(readFileSync(file));
    const psnrs = await run(`
      window.viewer?.dispose();
      const box = document.getElementById("walk");
      box.style.cssText = "position:fixed;left:0;top:0;width:320px;height:180px";
      window.viewer = window.rilievo.show(box, "/${which}/walk.json",
                                          { pixelRatio: 1, preserveDrawingBuffer: true });
      await window.viewer.ready;
      return window.comparedFrames(${JSON.stringify(
        keys.filter((_, i) => i % 2 === 0).map((key) => ({ z_near, z_far, ...key })))},
        "${which === "walk" ? "/test/frames" : `/${which}/frames`}");`);
    console.log(`${which}:`, psnrs.map((psnr) => `${psnr.toFixed(1)} dB`).join(", "));
    for (const psnr of psnrs) assert.ok(psnr > least, `${which}: ${psnr} dB`);
    if (!process.argv[2]) continue;
    // From the second eye.
    await run(`await window.settle(${JSON.stringify({ z_near, z_far, ...keys[2] })});`);
    writeFileSync(join(process.argv[2], `${which}.png`),
                  Buffer.from(await ask("GET", `${at}/screenshot`), "base64"));
  }
  await ask("DELETE", at);
} finally {
  for (const child of children.reverse()) child.kill();
  await server.close();
}
