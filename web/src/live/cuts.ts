// Where neighbouring texels of a keyframe's depths are two surfaces. A cut lies on the edge between
// two texels; four of them meet at a corner.
//
// Depths are codes: 0 is the sky, code c > 0 the disparity (c + offset) * step, so that codes of a
// plane are affine in the picture. Neighbours are one surface if their codes are close, or if one
// side goes on as steeply as from one to the other: a floor that is seen at a flat angle.

/** Codes by which neighbours may differ in any case: a step of the codec is half a pixel in the cell. */
const kClose = 4;
/** The share of the smaller disparity by which they may differ. */
const kShare = 0.01;
/** What a slope may change by from texel to texel: codes, and a share of the slope. */
const kBend = 2, kBendShare = 0.15;

export const kCutRight = 1, kCutDown = 2;

/** Is the edge between `a` and `b` cut? `before` and `after` lie beyond them on the same line. */
export function isCut(before: number, a: number, b: number, after: number, offset: number): boolean {
  if (a === 0 || b === 0) return a !== b;
  const slope = b - a, steep = Math.abs(slope);
  if (steep <= kClose || steep <= kShare * (Math.min(a, b) + offset)) return false;
  const bend = kBend + kBendShare * steep;
  if (before !== 0 && Math.abs(a - before - slope) <= bend) return false;
  return after === 0 || Math.abs(after - b - slope) > bend;
}

/** By texel: kCutRight, is it cut from the one to the right, and kCutDown, from the one below. */
export function findCuts(codes: Uint16Array, width: number, height: number, offset: number): Uint8Array {
  const cuts = new Uint8Array(width * height);
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, ++i) {
      const a = codes[i];
      if (x + 1 < width) {
        const b = codes[i + 1], steep = a > b ? a - b : b - a;
        // Most are close.
        if ((steep > kClose || a === 0 || b === 0) && a !== b &&
            isCut(x > 0 ? codes[i - 1] : 0, a, b, x + 2 < width ? codes[i + 2] : 0, offset))
          cuts[i] |= kCutRight;
      }
      if (y + 1 < height) {
        const b = codes[i + width], steep = a > b ? a - b : b - a;
        if ((steep > kClose || a === 0 || b === 0) && a !== b &&
            isCut(y > 0 ? codes[i - width] : 0, a, b, y + 2 < height ? codes[i + 2 * width] : 0, offset))
          cuts[i] |= kCutDown;
      }
    }
  return cuts;
}

/** The four texels around a corner: to the upper left, upper right, lower right, lower left. */
export const kUpperLeft = 0, kUpperRight = 1, kLowerRight = 2, kLowerLeft = 3;

/**
 * Which texels around a corner are one surface with the one at `place`, a bit each. Of `edges` bit
 * k says that the edge between places k and k + 1 is cut.
 */
export const kGroups: Uint8Array = (() => {
  const groups = new Uint8Array(64);
  for (let edges = 0; edges < 16; ++edges)
    for (let place = 0; place < 4; ++place) {
      let group = 1 << place;
      for (let k = place; !((edges >> k) & 1) && !((group >> ((k + 1) & 3)) & 1); k = (k + 1) & 3)
        group |= 1 << ((k + 1) & 3);
      for (let k = (place + 3) & 3; !((edges >> k) & 1) && !((group >> k) & 1); k = (k + 3) & 3)
        group |= 1 << k;
      groups[4 * edges + place] = group;
    }
  return groups;
})();
