// The page: a canvas, an eye that walks, and plain words where something fails.

import { Walk, WalkError, type PictureSource, type View, type WalkOptions } from "./core.js";
import { WalkControls } from "./controls.js";
import { asWalkError } from "./errors.js";

export { Walk, WalkError } from "./core.js";

export interface ViewerOptions extends WalkOptions {
  /** Pixels of the frame for each of the page; default the screen's own, at most 2. */
  pixelRatio?: number;
  /** Draw the library's default sky where no node shows anything. Default true. */
  sky?: boolean;
  /** Keep what was drawn readable, for tests. */
  preserveDrawingBuffer?: boolean;
}

export interface Viewer {
  readonly canvas: HTMLCanvasElement;
  readonly controls: WalkControls;
  readonly walk: Walk | null;
  readonly ready: Promise<void>;
  /** Milliseconds of update() and draw() on the main thread: the last frames. */
  readonly times: { update: Float32Array; draw: Float32Array; frames: number };
  /** Draws one frame now. */
  draw(): void;
  /** The view of the frame that is drawn now. */
  view(): View;
  /** Instead of the controls' eye; null: the controls' again. */
  setView(view: View | null): void;
  dispose(): void;
}

const kTimes = 4096;

function message(parent: HTMLElement): { show(text: string): void; hide(): void } {
  const box = document.createElement("div");
  box.setAttribute("role", "alert");
  box.style.cssText =
    "position:absolute;left:50%;top:50%;transform:translate(-50%,-50%);max-width:min(36em,86%);" +
    "padding:1em 1.3em;border-radius:8px;background:#20262ef0;color:#e8eaed;display:none;" +
    "font:16px/1.5 system-ui,sans-serif;overflow-wrap:anywhere;white-space:pre-line";
  parent.append(box);
  return {
    show(text) {
      box.textContent = text;
      box.style.display = "block";
    },
    hide() {
      box.style.display = "none";
    },
  };
}

function hint(parent: HTMLElement): (text: string) => void {
  const line = document.createElement("div");
  line.style.cssText =
    "position:absolute;left:0;right:0;bottom:0;padding:.5em 1em;color:#e8eaedcc;pointer-events:none;" +
    "font:13px/1.4 system-ui,sans-serif;text-shadow:0 1px 2px #000";
  parent.append(line);
  return (text) => {
    if (line.textContent !== text) line.textContent = text;
  };
}

/** Shows a walk in an element, which it fills. */
export function show(parent: HTMLElement, source: string | URL | PictureSource,
                     options: ViewerOptions = {}): Viewer {
  if (getComputedStyle(parent).position === "static") parent.style.position = "relative";
  const canvas = document.createElement("canvas");
  canvas.style.cssText = "position:absolute;inset:0;width:100%;height:100%;display:block";
  canvas.setAttribute("aria-label", "A walk. Drag to look, arrow keys or W A S D to walk.");
  parent.append(canvas);
  const alarm = message(parent);
  const tell = hint(parent);
  const times = {
    update: new Float32Array(kTimes), draw: new Float32Array(kTimes), frames: 0,
  };

  let walk: Walk | null = null;
  let lost = false, disposed = false, presenting = false, requested = 0, before = 0;
  let fixed: View | null = null;
  let missing = "";

  const request = () => {
    if (!requested && !disposed) requested = requestAnimationFrame(frame);
  };
  const controls = new WalkControls(canvas, request);

  const gl = canvas.getContext("webgl2", {
    antialias: false, alpha: false, powerPreference: "high-performance",
    preserveDrawingBuffer: options.preserveDrawingBuffer ?? false,
  });
  if (!gl) {
    const error = new WalkError(
      "browser",
      "has no WebGL 2, which walks are drawn with: update it, or switch hardware acceleration on",
    );
    alarm.show(`This walk cannot be shown. The ${error.message}.`);
    options.onError?.(error);
    const ready = Promise.reject(error);
    ready.catch(() => {});
    return {
      canvas, controls, walk, ready, times, draw() {}, setView() {},
      view: () => ({ worldFromEye: controls.worldFromEye, clipFromEye: new Float64Array(16), width: 1, height: 1 }),
      dispose() {
        controls.dispose();
        parent.replaceChildren();
      },
    };
  }

  const projection = new Float64Array(16);
  const view: { -readonly [K in keyof View]: View[K] } = {
    worldFromEye: controls.worldFromEye, clipFromEye: projection, width: 1, height: 1,
  };
  const resize = () => {
    const ratio = options.pixelRatio ?? Math.min(2, window.devicePixelRatio || 1);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    view.width = width;
    view.height = height;
    const start = walk?.manifest?.start;
    const near = start?.zNear ?? 0.1, far = start?.zFar ?? 1000;
    const tall = 1 / Math.tan(0.5 * (start?.verticalFov ?? 0.9));
    projection.fill(0);
    projection[0] = (tall * height) / width;
    projection[5] = tall;
    projection[10] = -(far + near) / (far - near);
    projection[11] = -1;
    projection[14] = (-2 * far * near) / (far - near);
  };
  const observer = new ResizeObserver(request);
  observer.observe(canvas);

  const draw = () => {
    if (!walk || lost || disposed || presenting) return;
    resize();
    const now = fixed ?? view;
    const e = now.worldFromEye;
    const begin = performance.now();
    walk.update(e[12], e[13], e[14]);
    const updated = performance.now();
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0.063, 0.078, 0.094, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    walk.draw(now, null, options.sky ?? true);
    const at = times.frames++ % kTimes;
    times.update[at] = updated - begin;
    times.draw[at] = performance.now() - updated;
  };
  const frame = (now: number) => {
    requested = 0;
    if (presenting) return;
    const seconds = Math.min(0.1, before ? (now - before) / 1000 : 1 / 60);
    before = now;
    controls.advance(seconds);
    try {
      draw();
    } catch (error) {
      alarm.show(`This walk cannot be drawn. ${asWalkError(error, "drawing").message}.`);
      return;
    }
    const loading = walk ? !walk.settled : false;
    // A live walk is never complete, and tells of its connection itself.
    tell(missing || (loading && !(walk?.live && walk.stats.drawn) ? "Loading…" : ""));
    if (controls.active || loading) request();
    else before = 0;
  };

  try {
    walk = new Walk(gl, source, {
      parent, ...options,
      onNeedsDraw() {
        request();
        options.onNeedsDraw?.();
      },
      onError(error) {
        if (walk?.manifest && !walk.live) missing = `Something is missing: ${error.message}.`;
        request();
        options.onError?.(error);
      },
    });
  } catch (error) {
    alarm.show(`This walk cannot be drawn. ${asWalkError(error, "WebGL").message}.`);
  }
  const opened = walk?.ready ?? Promise.reject(new WalkError("WebGL", "cannot be used"));
  const ready = opened.catch((error) => {
    if (walk && !disposed) alarm.show(`This walk cannot be loaded. ${asWalkError(error, "walk").message}.`);
    throw error;
  });
  ready.catch(() => {});
  tell("Loading…");

  // The eye stands before the first picture is there.
  const stand = () => {
    const manifest = walk?.manifest;
    if (!manifest) return;
    controls.stand(manifest.start.eye, manifest.start.target, manifest.up);
    if (manifest.live) controls.speed /= manifest.live.unit;
    document.title = manifest.name || document.title;
  };
  ready.then(() => {
    stand();
    request();
  }, () => {});

  const onLost = (event: Event) => {
    event.preventDefault();
    lost = true;
    alarm.show("The browser took the graphics away. The walk goes on when it gives them back.");
  };
  const onRestored = () => {
    lost = false;
    try {
      walk?.restore(gl);
      alarm.hide();
    } catch (error) {
      alarm.show(`This walk cannot be drawn. ${asWalkError(error, "WebGL").message}.`);
    }
    request();
  };
  // What draws into it is loaded only where there is one.
  const findHeadset = async () => {
    try {
      if (!(await navigator.xr?.isSessionSupported("immersive-vr"))) return;
      const { offerHeadset } = await import("./headset.js");
      if (disposed) return;
      offerHeadset(parent, {
        gl, controls, walk: () => walk, sky: options.sky ?? true,
        changed(on) {
          presenting = on;
          request();
        },
        failed: (error) =>
          alarm.show(`The headset does not show it. ${asWalkError(error, "WebXR").message}.`),
      });
    } catch {
      // It walks without one.
    }
  };
  canvas.addEventListener("webglcontextlost", onLost);
  canvas.addEventListener("webglcontextrestored", onRestored);
  void findHeadset();
  request();

  return {
    canvas, controls, ready, times, draw,
    get walk() {
      return walk;
    },
    view: () => fixed ?? view,
    setView(next) {
      fixed = next;
      request();
    },
    dispose() {
      disposed = true;
      cancelAnimationFrame(requested);
      observer.disconnect();
      canvas.removeEventListener("webglcontextlost", onLost);
      canvas.removeEventListener("webglcontextrestored", onRestored);
      controls.dispose();
      walk?.dispose();
      parent.replaceChildren();
    },
  };
}
