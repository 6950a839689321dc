// Where the samples of a layered relief lie as seen from an eye: rilievo/warp/relief_warp.h and
// rilievo/layered_relief/prewarp.cpp, where the derivations are. Allocates nothing after it is made.

import type { View } from "../gl/program.js";
import type { ReliefEntry, ReliefsEntry } from "../manifest.js";

/** No sample is drawn that is magnified more. */
const kMostMagnified = 64;
const kLargestCode = 65534;
/** What is shown begins and ends in steps of so many texels, as the library's does. */
const kViewStep = 64;
const kTexelPx = 0.75;
const kPinholeTexels = 3;

const down = (n: number) => Math.floor(n / kViewStep) * kViewStep;
const dot = (a: ArrayLike<number>, b: ArrayLike<number>) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

export class ReliefWarp {
  /** The foot of the eye is a texel with this place; displacements are enlarged by 1 / (1 + k3 d). */
  k1 = 0;
  k2 = 0;
  k3 = 0;
  /** Nearer codes are not drawn. */
  leastCode = 0;
  /** Texels of the result for one of the relief. */
  resolution = 1;
  /** The rectangle of the result, x and y from and to. */
  readonly all = new Int32Array(4);
  /** The part of it that a frame shows. */
  readonly shown = new Int32Array(4);
  /** What is seen at a texel (x, y) of the result lies in the direction g + x a + y b / resolution. */
  readonly g = new Float64Array(3);
  readonly a = new Float64Array(3);
  readonly b = new Float64Array(3);
  readonly forward = new Float64Array(3);
  zNear = 1;
  zFar = 2;
  planeZ = 1;
  /** The most texels of the result that a splat is wide. */
  widest = 1;

  private readonly origin = new Float64Array(3);
  private readonly ray = new Float64Array(3);
  private readonly polygon = new Float64Array(12);
  private readonly centre = new Float64Array(3);
  private ga = 0;
  private gb = 0;

  constructor(readonly of: ReliefEntry, private readonly set: ReliefsEntry) {
    const m = of.worldFromEye, dx = (of.right - of.left) / of.width, dy = (of.bottom - of.top) / of.height;
    const z = of.perspective ? 0 : of.planeZ, aside = of.perspective ? 0 : 1;
    for (let k = 0; k < 3; ++k) {
      const corner = of.left * m[k] + of.top * m[4 + k];
      this.a[k] = m[k] * dx;
      this.b[k] = m[4 + k] * dy;
      this.forward[k] = -m[8 + k];
      this.origin[k] = m[12 + k] - m[8 + k] * z + corner * aside;
      this.g[k] = -m[8 + k] + corner;
    }
    let low = Infinity, high = -Infinity;
    for (let k = 0; k < 3; ++k) {
      for (const corner of of.hull) {
        low = Math.min(low, corner[k]);
        high = Math.max(high, corner[k]);
      }
      this.centre[k] = 0.5 * (low + high);
      low = Infinity;
      high = -Infinity;
    }
  }

  private d(code: number): number {
    return this.of.first + code * this.of.step;
  }

  private magnified(d: number): number {
    return 1 / (1 + this.k3 * d);
  }

  /** The least displacement that is drawn. */
  private get least(): number {
    return this.k3 > 0 ? (1 / kMostMagnified - 1) / this.k3 : -Infinity;
  }

  /** For an eye in world space. False: nothing can be seen from there. */
  place(x: number, y: number, z: number): boolean {
    const { of, set, origin, a, b, g, forward, all, ray: c } = this;
    c[0] = origin[0] - x;
    c[1] = origin[1] - y;
    c[2] = origin[2] - z;
    const height = dot(c, forward);
    if (of.perspective) {
      this.k3 = -height || 1e-30;
      this.k1 = (-dot(c, a) - this.k3 * dot(g, a)) / dot(a, a);
      this.k2 = (-dot(c, b) - this.k3 * dot(g, b)) / dot(b, b);
    } else {
      if (!(height > 0)) return false;
      g.set(c);
      this.k3 = 1 / height;
      this.k1 = -this.k3 * dot(c, a) / dot(a, a);
      this.k2 = -this.k3 * dot(c, b) / dot(b, b);
    }
    this.ga = dot(g, a) / dot(a, a);
    this.gb = dot(g, b) / dot(b, b);
    const { k1, k2 } = this;
    this.leastCode = Math.max(0, Math.min(65535, Math.ceil((this.least - of.first) / of.step)));
    const least = this.d(this.leastCode);
    const beyond = Math.max(0, 0.5 * (set.splat * of.splatScale - 1));
    let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity, most = -Infinity, largest = 0;
    for (let i = 0; i < of.hull.length; ++i) {
      const corner = of.hull[i], d = Math.max(corner[2], least), m = this.magnified(d);
      most = Math.max(most, corner[2]);
      largest = Math.max(largest, m);
      x0 = Math.min(x0, m * (corner[0] + k1 * d - beyond));
      y0 = Math.min(y0, m * (corner[1] + k2 * d - beyond));
      x1 = Math.max(x1, m * (corner[0] + k1 * d + beyond));
      y1 = Math.max(y1, m * (corner[1] + k2 * d + beyond));
    }
    if (!(most >= least)) return false;
    this.resolution = set.resolution;
    while (Math.max(x1 - x0, y1 - y0) * this.resolution > set.maxSize - 2) this.resolution *= 0.5;
    all[0] = Math.floor(x0 * this.resolution);
    all[1] = Math.floor(y0 * this.resolution);
    all[2] = Math.max(all[0] + 1, Math.ceil(x1 * this.resolution));
    all[3] = Math.max(all[1] + 1, Math.ceil(y1 * this.resolution));
    this.widest = set.splat * of.splatScale * this.resolution * largest;
    this.placeDepths(height, least);
    return true;
  }

  // The planes of the result's camera, which stands at the eye: no sample on one of them.
  private placeDepths(height: number, least: number): void {
    const { of } = this, far = this.d(kLargestCode);
    if (of.perspective) {
      this.zNear = (1 - 1e-5) * -(1 + this.k3 * least) / least;
      this.zFar = (1 + 1e-5) * -(1 + this.k3 * far) / far;
      this.planeZ = 2 * this.zNear * this.zFar / (this.zNear + this.zFar);
    } else {
      this.planeZ = height;
      this.zNear = height + least - of.step;
      this.zFar = height + far + of.step;
    }
  }

  /** Which part of the result does a frame show? False: none. */
  show(view: View): boolean {
    const { all, shown, polygon, ray, a, b, g, forward, resolution: s } = this;
    const e = view.worldFromEye, p = view.clipFromEye;
    const depth = dot(g, forward), aa = dot(a, a), bb = dot(b, b);
    for (let i = 0; i < 4; ++i) {
      // Around the frame.
      const x = ((i === 1 || i === 2 ? 1 : -1) + p[8]) / p[0], y = ((i > 1 ? 1 : -1) + p[9]) / p[5];
      for (let k = 0; k < 3; ++k) ray[k] = e[k] * x + e[4 + k] * y - e[8 + k];
      const w = dot(ray, forward) / depth;
      polygon[3 * i] = (dot(ray, a) / aa - w * this.ga) * s;
      polygon[3 * i + 1] = (dot(ray, b) / bb - w * this.gb) * s;
      polygon[3 * i + 2] = w;
    }
    let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity;
    // Of what lies before the eye, by far.
    const least = 1e-4 / depth;
    for (let i = 0; i < 4; ++i) {
      const at = 3 * i, next = (at + 3) % 12, w = polygon[at + 2], v = polygon[next + 2];
      for (let k = 0; k < 2; ++k) {
        let t = 0;
        if (k === 0 ? w < least : w < least === v < least) continue;
        if (k === 1) t = (least - w) / (v - w);
        const q = w + t * (v - w);
        const x = (polygon[at] + t * (polygon[next] - polygon[at])) / q;
        const y = (polygon[at + 1] + t * (polygon[next + 1] - polygon[at + 1])) / q;
        x0 = Math.min(x0, x);
        y0 = Math.min(y0, y);
        x1 = Math.max(x1, x);
        y1 = Math.max(y1, y);
      }
    }
    shown[0] = Math.max(all[0], down(Math.max(x0, all[0])));
    shown[1] = Math.max(all[1], down(Math.max(y0, all[1])));
    shown[2] = Math.min(all[2], down(Math.min(x1, all[2])) + kViewStep);
    shown[3] = Math.min(all[3], down(Math.min(y1, all[3])) + kViewStep);
    return shown[2] > shown[0] && shown[3] > shown[1];
  }

  /** Texels of a frame's result are averaged by two so many times. */
  level(view: View): number {
    const side = Math.sqrt(dot(this.a, this.a)) / this.resolution / dot(this.g, this.forward);
    let px = 0.5 * view.width * Math.abs(view.clipFromEye[0]) * side, level = 0;
    for (; level < 8 && 2 * px <= kTexelPx; ++level) px *= 2;
    return level;
  }

  /** A neighbour of a pinhole is nearer by so many codes of 16 bits. */
  get pinholeStep(): number {
    const { zNear: near, zFar: far, planeZ: z } = this;
    const side = Math.sqrt(dot(this.a, this.a)) / this.resolution / dot(this.g, this.forward);
    const perMetre = kLargestCode * far * near / ((far - near) * z * z);
    return Math.max(1, Math.min(65535, Math.ceil(kPinholeTexels * z * side * perMetre)));
  }

  /** Coefficients of the shaders: x, y and w of a code (one, code, u or v) and the depth. */
  coefficients(out: Float32Array): void {
    const { of, k1, k2, k3, resolution: s, zNear: near } = this;
    const steps = kLargestCode * this.zFar / (this.zFar - near), d = of.first, step = of.step;
    out[0] = s * (0.5 + k1 * d);
    out[1] = s * k1 * step;
    out[2] = s * (0.5 + k2 * d);
    out[3] = s * k2 * step;
    out[4] = 1 + k3 * d;
    out[5] = k3 * step;
    out[6] = s;
    out[7] = s * this.set.splat * of.splatScale;
    if (of.perspective) {
      out[8] = steps * (1 + (k3 + near) * d);
      out[9] = steps * (k3 + near) * step;
      out[10] = out[4];
      out[11] = out[5];
    } else {
      out[8] = steps * (1 / k3 + d - near);
      out[9] = steps * step;
      out[10] = 1 / k3 + d;
      out[11] = step;
    }
  }

  /** Between the way to the eye of the last place() and the way the relief faces; -1: not whole. */
  facing(x: number, y: number, z: number): number {
    const { of, origin, a, b, centre } = this;
    for (let i = 0; i < of.hull.length; ++i) if (!(of.hull[i][2] >= this.least)) return -1;
    let along = 0, length = 0;
    for (let k = 0; k < 3; ++k) {
      const aside = centre[0] * a[k] + centre[1] * b[k];
      const at = of.perspective
        ? origin[k] - (this.g[k] + aside) / centre[2]
        : origin[k] + aside + centre[2] * this.forward[k];
      const to = (k === 0 ? x : k === 1 ? y : z) - at;
      along -= to * this.forward[k];
      length += to * to;
    }
    return 2 + along / Math.sqrt(length);
  }

  /** How far the middle of all reliefs lies ahead of an eye, in this one's direction. */
  along(x: number, y: number, z: number): number {
    const { set: { center: c }, forward } = this;
    return forward[0] * (c[0] - x) + forward[1] * (c[1] - y) + forward[2] * (c[2] - z);
  }

  /** Surely warped as a whole from an eye? As pick_relief() asks (relief_bound.cpp). */
  isSure(x: number, y: number, z: number): boolean {
    if (this.of.perspective) return false;
    const { set: { low, high }, forward } = this;
    const radius = 0.5 * Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    const wrong = 4 * radius / 32767;
    const plane = forward[0] * (this.origin[0] - x) + forward[1] * (this.origin[1] - y) +
      forward[2] * (this.origin[2] - z);
    let nearest = -wrong;
    for (let k = 0; k < 3; ++k) {
      const at = k === 0 ? x : k === 1 ? y : z;
      nearest += Math.min(forward[k] * (low[k] - at), forward[k] * (high[k] - at));
    }
    return plane > wrong && nearest > 1.01 * (plane + wrong) / kMostMagnified;
  }
}
