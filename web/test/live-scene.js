// A room with pillars, by rays: what a live walk's server would send, and what frames should show.
import { deflateSync } from "node:zlib";

const kRoom = { low: [-6, 0, -6], high: [6, 3, 6] };
const kPillars = [
  { low: [-0.4, 0, -2.4], high: [0.4, 3, -1.6], color: [200, 60, 50] },
  { low: [1.8, 0, -3.4], high: [2.2, 2, -3], color: [60, 160, 70] },
  { low: [-2.6, 0, 0.6], high: [-1.8, 1.2, 1.4], color: [60, 90, 200] },
];
/** Where there is a window in the wall at z = -6, the sky is seen. */
const isWindow = (x, y) => Math.abs(x + 3.5) < 1 && y > 1 && y < 2.2;

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (v) => v.map((x) => x / Math.hypot(...v));

/** Right, up and back of an eye that looks at a target. */
export function axesAt(eye, target) {
  const back = unit(eye.map((x, k) => x - target[k])), right = unit(cross([0, 1, 0], back));
  return [right, cross(back, right), back];
}

/** The axes of a quaternion x y z w. */
export function axesOfQuaternion([x, y, z, w]) {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
    [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
    [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
  ];
}

/** x y z w of axes. */
export function quaternionOfAxes([r, u, b]) {
  // Signs by the differences across the diagonal: exact enough, and never of a small number.
  const w = 0.5 * Math.sqrt(Math.max(0, 1 + r[0] + u[1] + b[2]));
  const x = 0.5 * Math.sqrt(Math.max(0, 1 + r[0] - u[1] - b[2])) * (u[2] < b[1] ? -1 : 1);
  const y = 0.5 * Math.sqrt(Math.max(0, 1 - r[0] + u[1] - b[2])) * (b[0] < r[2] ? -1 : 1);
  const z = 0.5 * Math.sqrt(Math.max(0, 1 - r[0] - u[1] + b[2])) * (r[1] < u[0] ? -1 : 1);
  return [x, y, z, w];
}

// Where a ray enters a box, or leaves the room: distance along the direction, and the axis of the side.
function hitBox(eye, d, { low, high }, inside) {
  let near = -Infinity, far = Infinity, nearAxis = 0, farAxis = 0;
  for (let k = 0; k < 3; ++k) {
    let a = (low[k] - eye[k]) / d[k], b = (high[k] - eye[k]) / d[k];
    if (a > b) [a, b] = [b, a];
    if (a > near) near = a, nearAxis = k;
    if (b < far) far = b, farAxis = k;
  }
  if (near > far || far < 0) return null;
  return inside ? [far, farAxis] : near > 0 ? [near, nearAxis] : null;
}

// A soft pattern, whose colours between texels are what bilinear lookups say.
function shade(color, p, axis) {
  const light = [0.8, 1, 0.65][axis], wave = Math.sin(3 * p[0] + 1) * Math.sin(3 * p[1] + 2) * Math.sin(3 * p[2]);
  return color.map((c) => c * light * (0.8 + 0.2 * wave));
}

const kSky = [150, 190, 240];

/** A picture: RGBA and 1 / eye_z of each texel, 0 where it shows the sky; the top row first. */
export function picture({ eye, axes, left, right, bottom, top, width, height }) {
  const [r, u, b] = axes;
  const colors = new Uint8Array(4 * width * height), inverse = new Float64Array(width * height);
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, ++i) {
      const s = left + ((right - left) * (x + 0.5)) / width, t = top + ((bottom - top) * (y + 0.5)) / height;
      const d = [0, 1, 2].map((k) => s * r[k] + t * u[k] - b[k] || 1e-12);
      const [wall, axis] = hitBox(eye, d, kRoom, true);
      let at = wall, color = [190, 180, 160], side = axis;
      for (const pillar of kPillars) {
        const hit = hitBox(eye, d, pillar, false);
        if (hit && hit[0] < at) [at, side, color] = [hit[0], hit[1], pillar.color];
      }
      const p = eye.map((e, k) => e + at * d[k]);
      const sky = at === wall && side === 2 && d[2] < 0 && isWindow(p[0], p[1]);
      const rgb = sky ? kSky : shade(color, p, side);
      for (let c = 0; c < 3; ++c) colors[4 * i + c] = Math.round(rgb[c]);
      colors[4 * i + 3] = 255;
      inverse[i] = sky ? 0 : 1 / at;
    }
  return { colors, inverse };
}

/** Codes of inverse depths: c > 0 is (c + offset) step. */
export function codesOf(inverse, step, offset) {
  return Uint16Array.from(inverse, (w) => (w === 0 ? 0 : Math.max(1, Math.round(w / step - offset))));
}

/** As rilievo/io/plane16.cpp encodes them, by the median of left, up and the plane. */
export function encodePlane16(plane, width) {
  const count = plane.length, raw = new Uint8Array(1 + 2 * count);
  raw[0] = 2;
  for (let i = 0; i < count; ++i) {
    const x = i % width, w = x > 0 ? plane[i - 1] : 0, n = i >= width ? plane[i - width] : 0;
    const affine = w + n - (x > 0 && i >= width ? plane[i - width - 1] : 0);
    const off = (plane[i] - Math.min(Math.max(affine, Math.min(w, n)), Math.max(w, n))) & 0xffff;
    const folded = ((off << 1) ^ (off & 0x8000 ? 0xffff : 0)) & 0xffff;
    raw[1 + i] = folded & 255;
    raw[1 + count + i] = folded >> 8;
  }
  return deflateSync(raw);
}
