// Which nodes are drawn for an eye: those that see it before the others, and of these the nearest
// (nodes_for_eye of rilievo/environment_nodes/environment_nodes.cpp). Nothing is allocated.

import type { NodeEntry, SketchesEntry } from "./manifest.js";

/** forward, right, up of the faces +x -x +y -y +z -z, as OpenGL's cube maps are turned. */
export const kFaceAxes: readonly (readonly number[])[] = [
  [1, 0, 0, 0, 0, -1, 0, -1, 0],
  [-1, 0, 0, 0, 0, 1, 0, -1, 0],
  [0, 1, 0, 1, 0, 0, 0, 0, 1],
  [0, -1, 0, 1, 0, 0, 0, 0, -1],
  [0, 0, 1, 1, 0, 0, 0, -1, 0],
  [0, 0, -1, -1, 0, 0, 0, -1, 0],
];

export class NodeChooser {
  /** Indices of nodes, the best first, after order(). */
  readonly best: Uint32Array;
  private readonly keys: Float64Array;
  private readonly table = new Float32Array(65536);

  constructor(
    private readonly nodes: readonly NodeEntry[],
    private readonly codes: Uint16Array,
    private readonly sketches: SketchesEntry,
  ) {
    this.best = new Uint32Array(nodes.length);
    this.keys = new Float64Array(nodes.length);
    const { near, far } = sketches;
    for (let c = 1; c < 65535; ++c) this.table[c] = near * Math.pow(far / near, (c - 1) / 65533);
    this.table[65535] = Infinity;
  }

  /** Is there no surface between node and eye? */
  sees(node: number, x: number, y: number, z: number): boolean {
    const m = this.nodes[node].worldFromNode;
    const wx = x - m[12], wy = y - m[13], wz = z - m[14];
    const distance = Math.sqrt(wx * wx + wy * wy + wz * wz);
    if (distance === 0) return true;
    const nx = m[0] * wx + m[1] * wy + m[2] * wz;
    const ny = m[4] * wx + m[5] * wy + m[6] * wz;
    const nz = m[8] * wx + m[9] * wy + m[10] * wz;
    let face = 0, most = 0;
    for (let f = 0; f < 6; ++f) {
      const a = kFaceAxes[f];
      const along = nx * a[0] + ny * a[1] + nz * a[2];
      if (along > most) {
        most = along;
        face = f;
      }
    }
    const a = kFaceAxes[face];
    const size = this.sketches.size;
    const i = this.place((nx * a[3] + ny * a[4] + nz * a[5]) / most);
    const j = this.place(-(nx * a[6] + ny * a[7] + nz * a[8]) / most);
    return distance <= this.table[this.codes[((node * 6 + face) * size + j) * size + i]];
  }

  /** Sorts `best` for an eye in world space. */
  order(x: number, y: number, z: number): void {
    const { best, keys, nodes } = this;
    for (let i = 0; i < nodes.length; ++i) {
      const e = nodes[i].eye;
      const dx = e[0] - x, dy = e[1] - y, dz = e[2] - z;
      const distance = Math.sqrt(dx * dx + dy * dy + dz * dz);
      // Those that do not see the eye lie behind all others.
      const key = this.sees(i, x, y, z) ? distance : 1e30 + distance * 1e15;
      let at = i;
      for (; at > 0 && keys[at - 1] > key; --at) {
        keys[at] = keys[at - 1];
        best[at] = best[at - 1];
      }
      keys[at] = key;
      best[at] = i;
    }
  }

  private place(at: number): number {
    const size = this.sketches.size;
    return Math.min(size - 1, Math.max(0, Math.trunc(0.5 * (1 + at) * size)));
  }
}
