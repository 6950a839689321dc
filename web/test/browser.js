// A headless browser with software WebGL, and a web server whose files can be damaged.
import { existsSync, readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import puppeteer from "puppeteer-core";

export const root = dirname(dirname(fileURLToPath(import.meta.url)));
/** The tests' walk: its files, and the page that `rilievo web` puts beside them. */
export const walk = join(root, "test/walk");
export const page = join(root, "../rilievo/web_walk/page");

const kTypes = {
  ".html": "text/html", ".js": "text/javascript", ".json": "application/json",
  ".webp": "image/webp", ".png": "image/png", ".glb": "model/gltf-binary",
};

/**
 * Serves folders: `mounts` maps a path's first part to a folder, or to several, the first first. `damage(path, bytes)` may return
 * other bytes, or null for a file that is missing.
 */
export async function serve(mounts, damage = (_path, bytes) => bytes) {
  const asked = [];
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, "http://host").pathname);
    asked.push(path);
    const [, mount, ...rest] = normalize(path).split("/");
    const name = rest.join("/") || "index.html";
    const file = [mounts[mount] ?? []].flat().map((folder) => join(folder, name))
      .find((path) => existsSync(path) && statSync(path).isFile());
    let bytes = file ? readFileSync(file) : null;
    if (bytes) bytes = damage(path, bytes);
    if (!bytes) {
      response.writeHead(404, { "content-type": "text/html" });
      response.end("<p>There is no such file.</p>");
      return;
    }
    // No length: a walk trusts its manifest alone.
    response.writeHead(200, { "content-type": kTypes[extname(file)] ?? "application/octet-stream" });
    response.end(bytes);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return {
    url: `http://127.0.0.1:${server.address().port}`,
    asked,
    close() {
      const closed = new Promise((resolve) => server.close(resolve));
      // Browsers keep connections open.
      server.closeAllConnections();
      return closed;
    },
  };
}

export function findChromium() {
  const known = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser",
                 "/usr/bin/google-chrome"];
  const found = known.find((path) => path && existsSync(path));
  if (!found) throw new Error("there is no Chromium: tools/setup web installs Debian's");
  return found;
}

export async function launch(extra = []) {
  return puppeteer.launch({
    executablePath: findChromium(),
    headless: true,
    // The page's own frames pace what is measured, not a screen.
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--ignore-gpu-blocklist", "--disable-dev-shm-usage", "--force-color-profile=srgb",
           ...extra],
  });
}
