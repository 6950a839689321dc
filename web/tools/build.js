// Builds dist/ (modules and their types) and the page's program, which the C++ library carries:
//   node tools/build.js          writes both
//   node tools/build.js --check  fails if the committed program is not what the sources make
import { spawnSync } from "node:child_process";
import { readFileSync, rmSync, writeFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import * as esbuild from "esbuild";

const root = dirname(dirname(fileURLToPath(import.meta.url)));
const page = join(root, "../rilievo/web_walk/page");
const common = {
  absWorkingDir: root,
  bundle: true,
  minify: true,
  target: ["es2021"],
  legalComments: "inline",
  logLevel: "warning",
};

// Shaders are text that esbuild does not shorten: without their comments and white space.
const shaders = {
  name: "shaders",
  setup(build) {
    build.onLoad({ filter: /(shaders|seen)\.ts$/ }, ({ path }) => ({
      contents: readFileSync(path, "utf8").replace(/^\s+/gm, "").replace(/(^|\s+)\/\/ .*$/gm, "")
        // But not of directives.
        .replace(/^[^#].*$/gm, (line) => line.replace(/ *([=*/<>,;(){?:&|]) */g, "$1")),
      loader: "ts",
    }));
  },
};

// A program of a worker, as text within the module that starts it.
const workers = {
  name: "workers",
  setup(build) {
    build.onResolve({ filter: /^worker:/ }, ({ path }) => ({ path, namespace: "worker" }));
    build.onLoad({ filter: /.*/, namespace: "worker" }, async ({ path }) => {
      const { outputFiles } = await esbuild.build({
        ...common,
        entryPoints: [join("src", `${path.slice("worker:".length)}.ts`)],
        format: "iife",
        write: false,
      });
      return { contents: outputFiles[0].text, loader: "text" };
    });
  },
};

// What only some walks or browsers need, as modules beside the page's program.
const parts = {
  "pictures.js": "src/views/picture-set.ts", "reliefs.js": "src/reliefs/relief-set.ts",
  "headset.js": "src/headset.ts", "live.js": "src/live/live-set.ts",
};
const besides = {
  name: "parts",
  setup(build) {
    build.onResolve({ filter: /\.js$/ }, ({ path, kind }) => {
      if (kind !== "dynamic-import") return undefined;
      const name = basename(path).replace(".js", ".ts");
      return { path: `./${Object.keys(parts).find((of) => basename(parts[of]) === name)}`, external: true };
    });
  },
};

/** The files of the page's program: texts by name. */
export async function pageProgram() {
  const bundled = async (entry, options) => (await esbuild.build({
    ...common,
    entryPoints: [entry],
    plugins: [workers, shaders, besides],
    banner: { js: "// Generated from web/src by web/tools/build.js: do not edit." },
    write: false,
    ...options,
  })).outputFiles[0].text;
  const made = { "viewer.js": await bundled("src/viewer.ts", { format: "iife", globalName: "rilievo" }) };
  for (const [name, entry] of Object.entries(parts)) made[name] = await bundled(entry, { format: "esm" });
  return made;
}

async function build() {
  rmSync(join(root, "dist"), { recursive: true, force: true });
  await esbuild.build({
    ...common,
    entryPoints: ["src/index.ts", "src/core.ts", "src/viewer.ts"],
    outdir: "dist",
    format: "esm",
    splitting: true,
    chunkNames: "chunk-[hash]",
    external: ["three"],
    plugins: [workers, shaders],
  });
  const types = spawnSync(
    process.execPath,
    [join(root, "node_modules/typescript/bin/tsc"), "--emitDeclarationOnly"],
    { cwd: root, stdio: "inherit" },
  );
  if (types.status !== 0) process.exit(1);
  for (const [name, text] of Object.entries(await pageProgram())) writeFileSync(join(page, name), text);
}

const started = process.argv[1] && process.argv[1] === fileURLToPath(import.meta.url);
if (started && process.argv.includes("--check")) {
  for (const [name, text] of Object.entries(await pageProgram())) {
    if (readFileSync(join(page, name), "utf8") === text) continue;
    console.error(`rilievo/web_walk/page/${name} is older than web/src: run \`npm run build\` in web/`);
    process.exit(1);
  }
} else if (started) {
  await build();
}
