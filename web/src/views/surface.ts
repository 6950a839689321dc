// The surface that a picture's texels stand for, from its disparities: what
// rilievo/warp/texel_surface.cpp, texel_links.cpp and surface_pyramid.cpp make, as the GPU reads it.
// There are the rules and their reasons.

/** A picture's depths: codes, of which c > 0 is the disparity least + (c - 1) step, 1/m. */
export interface ViewDepths {
  readonly width: number;
  readonly height: number;
  /** Sides of a texel where eye_z = 1. */
  readonly du: number;
  readonly dv: number;
  readonly least: number;
  readonly step: number;
  /** +1 ordinary, -1 back-perspective. */
  readonly sigma: number;
  /** Slopes up to which texels are linked (LinkOptions); null: only the codes are asked for. */
  readonly links: LinkLimits | null;
}

export interface LinkLimits {
  readonly gentle: number;
  readonly steepest: number;
  readonly growth: number;
}

export interface ViewSurface {
  codes: Uint16Array;
  /** Two words a texel: halves of the slopes to the right and down, to the left and up. */
  slopes: Uint32Array;
  links: Uint8Array;
  /** Two numbers a cell, levels side by side (CellLayout). */
  cells: Float32Array;
}

const kEndSlope = 2, kPatchGap = 0.25, kTwist = 2 * kPatchGap;
export const kBlock = 4, kFactor = 4, kLevels = 4;

export interface CellLayout {
  readonly columns: number;
  readonly rows: number;
  readonly levelAt: readonly number[];
}

export function cellLayout(width: number, height: number): CellLayout {
  const levelAt: number[] = [];
  let columns = 0, side = kBlock;
  for (let level = 0; level < kLevels; ++level, side *= kFactor) {
    levelAt.push(columns);
    columns += Math.ceil(width / side);
  }
  return { columns, rows: Math.ceil(height / kBlock), levelAt };
}

const f32 = new Float32Array(1), u32 = new Uint32Array(f32.buffer);

/** The bits of the nearest half float. */
export function halfOf(value: number): number {
  f32[0] = value;
  const bits = u32[0], sign = (bits >>> 16) & 0x8000;
  const exponent = ((bits >>> 23) & 255) - 112;
  if (exponent >= 31) return sign | 0x7bff;
  if (exponent > 0) {
    const kept = (exponent << 10) | ((bits >>> 13) & 0x3ff), rest = bits & 0x1fff;
    return sign | Math.min(0x7bff, kept + (rest > 0x1000 || (rest === 0x1000 && (kept & 1)) ? 1 : 0));
  }
  if (exponent < -10) return sign;
  return sign | Math.round(Math.abs(f32[0]) * 16777216);
}

export function makeSurface(codes: Uint16Array, of: ViewDepths): ViewSurface {
  const { width: w, height: h, sigma, links: limits } = of;
  if (!limits)
    return { codes, slopes: new Uint32Array(), links: new Uint8Array(), cells: new Float32Array() };
  const count = w * h;
  const q = new Float32Array(count);
  for (let i = 0; i < count; ++i) q[i] = codes[i] === 0 ? 0 : of.least + (codes[i] - 1) * of.step;

  // Bits 0 right, 2 down, 4 left, 6 up; and, of closed corners, those between.
  const links = new Uint8Array(count);
  const isLinked = (a: number, b: number, before: number, after: number, lateral: number) => {
    const za = 1 / q[a], zb = 1 / q[b];
    const slope = Math.abs(zb - za) / (lateral * Math.min(za, zb));
    if (slope <= limits.gentle) return true;
    if (slope > limits.steepest) return false;
    const step = q[b] - q[a], sign = step < 0 ? -1 : 1;
    let beside = 0;
    if (before >= 0 && q[before] > 0) beside = Math.max(beside, sign * (q[a] - q[before]));
    if (after >= 0 && q[after] > 0) beside = Math.max(beside, sign * (q[after] - q[b]));
    return sign * step <= limits.growth * beside;
  };
  for (let y = 0, i = 0; y < h; ++y)
    for (let x = 0; x < w; ++x, ++i) {
      if (q[i] === 0) continue;
      if (x + 1 < w && q[i + 1] > 0 &&
          isLinked(i, i + 1, x > 0 ? i - 1 : -1, x + 2 < w ? i + 2 : -1, of.du)) {
        links[i] |= 1;
        links[i + 1] |= 1 << 4;
      }
      if (y + 1 < h && q[i + w] > 0 &&
          isLinked(i, i + w, y > 0 ? i - w : -1, y + 2 < h ? i + 2 * w : -1, of.dv)) {
        links[i] |= 1 << 2;
        links[i + w] |= 1 << 6;
      }
    }

  // Patches end flat or continued, but never steep.
  const slopes = new Uint32Array(2 * count);
  const cells = cellLayout(w, h);
  const front = new Float32Array(cells.columns * cells.rows).fill(-1e30);
  const back = new Float32Array(cells.columns * cells.rows).fill(1e30);
  const holes = new Uint8Array(cells.columns * cells.rows);
  const sides = [1, w, -1, -w], slope = [0, 0, 0, 0];
  for (let y = 0, i = 0; y < h; ++y)
    for (let x = 0; x < w; ++x, ++i) {
      const cell = (y >> 2) * cells.columns + (x >> 2);
      if (q[i] === 0) {
        holes[cell] = 1;
        continue;
      }
      for (let side = 0; side < 4; ++side)
        slope[side] = (links[i] >> (2 * side)) & 1 ? q[i + sides[side]] - q[i] : 0;
      for (let side = 0; side < 4; ++side) {
        const other = (side + 2) % 4;
        if ((links[i] >> (2 * side)) & 1 || !((links[i] >> (2 * other)) & 1)) continue;
        const steepest = kEndSlope * (side % 2 === 0 ? of.du : of.dv) * q[i];
        slope[side] = Math.max(-steepest, Math.min(steepest, -slope[other]));
      }
      slopes[2 * i] = halfOf(slope[0]) | (halfOf(slope[1]) << 16);
      slopes[2 * i + 1] = halfOf(slope[2]) | (halfOf(slope[3]) << 16);
      const low = q[i] + 0.5 * (Math.min(0, slope[0], slope[2]) + Math.min(0, slope[1], slope[3]));
      const high = q[i] + 0.5 * (Math.max(0, slope[0], slope[2]) + Math.max(0, slope[1], slope[3]));
      const nearest = sigma > 0 ? high : -low, farthest = sigma > 0 ? low : -high;
      front[cell] = Math.max(front[cell], nearest + 1e-6 * Math.abs(nearest));
      back[cell] = Math.min(back[cell], farthest - 1e-6 * Math.abs(farthest));
    }

  const texel = Math.min(of.du, of.dv);
  for (let y = 0; y + 1 < h; ++y)
    for (let x = 0; x + 1 < w; ++x) {
      const a = y * w + x, b = a + 1, c = a + w, d = c + 1;
      if (!(links[a] & 1 && links[a] & 4 && links[d] & 16 && links[d] & 64)) continue;
      if (!(Math.abs(q[a] + q[d] - q[b] - q[c]) <= kTwist * texel * q[a])) continue;
      links[a] |= 1 << 1;
      links[b] |= 1 << 3;
      links[d] |= 1 << 5;
      links[c] |= 1 << 7;
    }

  for (let level = 1, side = kBlock; level < kLevels; ++level, side *= kFactor) {
    const from = cells.levelAt[level - 1], to = cells.levelAt[level];
    const columns = Math.ceil(w / side), rows = Math.ceil(h / side);
    for (let y = 0; y < rows; ++y)
      for (let x = 0; x < columns; ++x) {
        const fine = y * cells.columns + from + x, coarse = (y >> 2) * cells.columns + to + (x >> 2);
        front[coarse] = Math.max(front[coarse], front[fine]);
        back[coarse] = Math.min(back[coarse], back[fine]);
        holes[coarse] |= holes[fine];
      }
  }
  const packed = new Float32Array(2 * front.length);
  for (let i = 0; i < front.length; ++i) {
    packed[2 * i] = front[i];
    packed[2 * i + 1] = Math.abs(back[i]) * (holes[i] ? -1 : 1);
  }
  return { codes, slopes, links, cells: packed };
}
