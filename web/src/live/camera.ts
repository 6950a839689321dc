// Cameras of keyframes, and how what they show is sent to clip space.

import type { View } from "../gl/program.js";
import type { KeyframePart } from "./messages.js";

/** Right, up and back of a quaternion x y z w: a matrix of 3 x 3, column by column. */
export function axesOf(q: ArrayLike<number>): Float64Array {
  const [x, y, z, w] = [q[0], q[1], q[2], q[3]];
  return Float64Array.of(
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w),
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y));
}

/** The quaternion x y z w of the turn of a matrix of 4 x 4, column by column. */
export function quaternionOf(m: ArrayLike<number>, out: Float64Array): void {
  const trace = m[0] + m[5] + m[10];
  // By the largest of the four, whose square cannot be small.
  if (trace > 0) {
    const s = 2 * Math.sqrt(trace + 1);
    out.set([(m[6] - m[9]) / s, (m[8] - m[2]) / s, (m[1] - m[4]) / s, 0.25 * s]);
  } else if (m[0] > m[5] && m[0] > m[10]) {
    const s = 2 * Math.sqrt(1 + m[0] - m[5] - m[10]);
    out.set([0.25 * s, (m[1] + m[4]) / s, (m[8] + m[2]) / s, (m[6] - m[9]) / s]);
  } else if (m[5] > m[10]) {
    const s = 2 * Math.sqrt(1 + m[5] - m[0] - m[10]);
    out.set([(m[1] + m[4]) / s, 0.25 * s, (m[6] + m[9]) / s, (m[8] - m[2]) / s]);
  } else {
    const s = 2 * Math.sqrt(1 + m[10] - m[0] - m[5]);
    out.set([(m[8] + m[2]) / s, (m[6] + m[9]) / s, 0.25 * s, (m[1] - m[4]) / s]);
  }
}

/**
 * Clip coordinates of (x, y, disparity, 1), x and y in texels from the top left: the point is
 * E + R / disparity with R the ray of the texel, which goes to the plane one metre ahead, and times the
 * disparity it is R + (E - eye) disparity from the eye.
 */
export function clipFromRaster(view: View, part: KeyframePart, axes: Float64Array, out: Float32Array): void {
  const e = view.worldFromEye, p = view.clipFromEye;
  const du = (part.right - part.left) / part.width, dv = (part.bottom - part.top) / part.height;
  // Depth follows from w, which is the distance: so is w of any projection here.
  const scale = 1 / (-p[11] || 1);
  for (let column = 0; column < 4; ++column) {
    let x = 0, y = 0, z = 0;
    for (let k = 0; k < 3; ++k) {
      const along = column === 0 ? axes[k] * du : column === 1 ? axes[3 + k] * dv
        : column === 2 ? part.eye[k] - e[12 + k]
        : axes[k] * part.left + axes[3 + k] * part.top - axes[6 + k];
      x += e[k] * along;
      y += e[4 + k] * along;
      z += e[8 + k] * along;
    }
    const d = column === 2 ? 1 : 0;
    for (let row = 0; row < 4; ++row)
      out[4 * column + row] = scale * (p[row] * x + p[4 + row] * y + p[8 + row] * z + p[12 + row] * d);
  }
}
