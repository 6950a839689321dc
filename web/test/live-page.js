// What the tests of live walks ask a page for. `viewer` is the page's viewer.

const unit = (v) => v.map((x) => x / Math.hypot(...v));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

window.errors = [];
window.viewer = window.rilievo.show(document.getElementById("walk"), "../walk.json", {
  pixelRatio: 1, preserveDrawingBuffer: true, onError: (error) => window.errors.push(error.message),
});

/** The view of an eye, a target, and a vertical field of view. */
window.viewOf = ({ eye, target, vertical_fov, up = [0, 1, 0] }, near = 0.1, far = 100) => {
  const { width, height } = window.viewer.canvas;
  const back = unit(eye.map((e, i) => e - target[i])), right = unit(cross(up, back)), above = cross(back, right);
  const tall = 1 / Math.tan(0.5 * vertical_fov);
  return {
    worldFromEye: [...right, 0, ...above, 0, ...back, 0, ...eye, 1],
    clipFromEye: [(tall * height) / width, 0, 0, 0, 0, tall, 0, 0,
                  0, 0, -(far + near) / (far - near), -1, 0, 0, (-2 * far * near) / (far - near), 0],
    width, height,
  };
};

window.sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

const pixel = new Uint8Array(4);
function drain() {
  window.viewer.canvas.getContext("webgl2").readPixels(0, 0, 1, 1, 6408, 5121, pixel);
}

/** Stands at a key until nothing more comes. */
window.settle = async (key, quietMs = 700) => {
  const { viewer } = window;
  viewer.setView(window.viewOf(key));
  const end = performance.now() + 30000;
  let received = -1, since = performance.now();
  for (;;) {
    viewer.draw();
    await window.sleep(5);
    const now = performance.now(), bytes = viewer.walk.live.connection.figures.received;
    if (bytes > received + 100) received = bytes, since = now;
    if (now - since > quietMs && viewer.walk.settled && viewer.walk.live.waiting === 0) break;
    if (now > end) throw new Error("the walk does not settle");
  }
  viewer.draw();
  drain();
};

/** Draws a key's frame now. */
window.look = (key) => {
  window.viewer.setView(window.viewOf(key));
  window.viewer.draw();
  drain();
};

/** RGBA of the last frame, the top row first, as base64. */
window.frame = () => {
  const { canvas } = window.viewer, { width, height } = canvas;
  const gl = canvas.getContext("webgl2"), all = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, all);
  let text = "";
  for (let y = height - 1; y >= 0; --y)
    text += String.fromCharCode(...all.subarray(4 * width * y, 4 * width * (y + 1)));
  return btoa(text);
};

/**
 * Walks in a circle with turns, so many frames, each `paceMs` after the one before: milliseconds of each frame's own work,
 * drawn to the end.
 */
window.walked = async ({ center, radius, vertical_fov }, frames, paceMs, step = 0.01) => {
  const times = [];
  for (let i = 0; i < frames; ++i) {
    const at = i * step, eye = [center[0] + radius * Math.cos(at), center[1], center[2] + radius * Math.sin(at)];
    const turn = 0.8 * Math.sin(2.5 * at);
    const target = [eye[0] - Math.sin(at + turn), eye[1] - 0.05, eye[2] + Math.cos(at + turn)];
    const begin = performance.now();
    window.look({ eye, target, vertical_fov });
    times.push(performance.now() - begin);
    await window.sleep(Math.max(0, paceMs - (performance.now() - begin)));
  }
  return times;
};

/** Follows keys, ten a second, of which `passed` ms are over, at 30 frames a second at most: what each frame took, ms. */
window.followed = async (keys, passed, seconds) => {
  const times = [], start = performance.now() - passed;
  for (;;) {
    const begin = performance.now(), at = (begin - start) / 100, k = Math.floor(at), s = at - k;
    if (at >= 10 * seconds - 1) return times;
    const mix = (a, b) => a.map((x, c) => x + s * (b[c] - x));
    window.look({ ...keys[k], eye: mix(keys[k].eye, keys[k + 1].eye), target: mix(keys[k].target, keys[k + 1].target) });
    times.push(performance.now() - begin);
    await window.sleep(Math.max(0, 33 - (performance.now() - begin)));
  }
};
