// Which keyframes are drawn for a view: the nearest ones of those that show it.

import type { View } from "../gl/program.js";
import type { KeyframePart } from "./messages.js";

/** A keyframe as the choice sees it. */
export interface Candidate {
  readonly camera: KeyframePart;
  /** Right, up, back. */
  readonly axes: Float64Array;
}

/** What a view that a keyframe does not show at all costs, in cells of distance. */
const kUnseen = 4;
/** Directions a side of the frame. */
const kRays = 5;

function fractionSeen(view: View, of: Candidate, open: Uint8Array): number {
  const e = view.worldFromEye, p = view.clipFromEye, { axes, camera } = of;
  let seen = 0, all = 0;
  for (let j = 0, k = 0; j < kRays; ++j)
    for (let i = 0; i < kRays; ++i, ++k) {
      if (!open[k]) continue;
      ++all;
      // Where clip x and y are these shares of w, on the plane z = -1.
      const x = ((2 * i) / (kRays - 1) - 1 + p[8]) / p[0], y = ((2 * j) / (kRays - 1) - 1 + p[9]) / p[5];
      const dx = e[0] * x + e[4] * y - e[8], dy = e[1] * x + e[5] * y - e[9], dz = e[2] * x + e[6] * y - e[10];
      const ahead = -(axes[6] * dx + axes[7] * dy + axes[8] * dz);
      if (ahead <= 1e-6) continue;
      const right = (axes[0] * dx + axes[1] * dy + axes[2] * dz) / ahead;
      const up = (axes[3] * dx + axes[4] * dy + axes[5] * dz) / ahead;
      if (right >= camera.left && right <= camera.right && up >= camera.bottom && up <= camera.top) {
        ++seen;
        open[k] |= 2;
      }
    }
  return all ? seen / all : 0;
}

export function eyeDistance(view: View, camera: KeyframePart): number {
  const e = view.worldFromEye;
  return Math.hypot(e[12] - camera.eye[0], e[13] - camera.eye[1], e[14] - camera.eye[2]);
}

/** In cells of distance, how much worse than a keyframe of the view itself. */
export function costOf(view: View, of: Candidate, open: Uint8Array = new Uint8Array(kRays * kRays).fill(1)): number {
  const cell = of.camera.cell > 0 ? of.camera.cell : 1;
  return eyeDistance(view, of.camera) / cell + kUnseen * (1 - fractionSeen(view, of, open));
}

/** The best `most` keyframes for a view, the best first. Later ones count by what those before leave open, too. */
export function chooseKeyframes<Of extends Candidate>(view: View, from: Iterable<Of>, most: number): Of[] {
  const chosen: Of[] = [], rest = new Set(from);
  const open = new Uint8Array(kRays * kRays).fill(1);
  while (chosen.length < most && rest.size > 0) {
    let best: Of | null = null, least = Infinity;
    for (const of of rest) {
      const whole = costOf(view, of);
      // What shows nothing of the view is of no use.
      if (whole >= kUnseen + eyeDistance(view, of.camera) / (of.camera.cell || 1) - 1e-9) continue;
      const some = open.includes(1) ? costOf(view, of, open.slice()) : whole;
      if (0.5 * (whole + some) < least) {
        least = 0.5 * (whole + some);
        best = of;
      }
    }
    if (!best) break;
    chosen.push(best);
    rest.delete(best);
    fractionSeen(view, best, open);
    for (let k = 0; k < open.length; ++k) open[k] = open[k] === 1 ? 1 : 0;
  }
  return chosen;
}
