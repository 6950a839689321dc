// A keyframe's depths as triangles: few where they are a plane, two a texel beside silhouettes.
//
// Vertices are corners of texels and have the mean code of the texels around that are one surface
// (cuts.ts); at a cut a corner has a vertex of each surface. Codes of a plane are affine in the
// picture, so that a triangle is exact on it. The triangles are those of a right-triangulated
// irregular network (W. Evans, D. Kirkpatrick and G. Townsend, 2001) as V. Agafonkin's Martini makes
// them: a square of 32 x 32 texels is two right triangles, and each is split at the middle of its
// hypotenuse if a corner within is off by more than the tolerance. Errors go from the finest
// triangles to the coarsest; the triangles on both sides of an edge see the same error in its middle and
// split there together, so that there is no crack. How this differs: squares share errors on their
// borders, and the ends of a cut count as infinite errors, so that what is beside it is split into
// halves of texels, none of which crosses it.
//
// A skin is a quad that spans a cut from one surface to the other. It has no width for the keyframe's
// own eye, and fills what another eye sees behind the nearer surface. The apron goes on around the picture with
// the depths of its border, for what nothing else shows.

import { findCuts, kCutDown, kCutRight, kGroups, kLowerLeft, kLowerRight, kUpperLeft, kUpperRight } from "./cuts.js";

/** Bytes of a vertex: x and y, corners of texels from the top left, 16 bits with sign; its code, a float. */
export const kVertexStride = 8;

export interface KeyframeMesh {
  vertices: ArrayBuffer;
  /** The triangles that touch no cut, those that do, the skins, the apron. */
  indices: Uint32Array;
  /** How many indices each of the four has. */
  counts: [number, number, number, number];
  /** Texels a unit of x and y. */
  scale: number;
}

const kSide = 32;
const kCut = 1e9;
/** Texels of the border between two vertices of the apron. */
const kApronStep = 16;
/** `a` and `b` of the hypotenuse of each triangle of a square, those of one size after the other. */
const kTriangles: Uint8Array = (() => {
  const count = 2 * kSide * kSide - 2, made = new Uint8Array(4 * count);
  for (let i = 0; i < count; ++i) {
    let id = i + 2, ax = 0, ay = 0, bx = 0, by = 0, cx = 0, cy = 0;
    if (id & 1) bx = by = cx = kSide;
    else ax = ay = cy = kSide;
    while ((id >>= 1) > 1) {
      const mx = (ax + bx) >> 1, my = (ay + by) >> 1;
      if (id & 1) bx = ax, by = ay, ax = cx, ay = cy;
      else ax = bx, ay = by, bx = cx, by = cy;
      cx = mx, cy = my;
    }
    made.set([ax, ay, bx, by], 4 * i);
  }
  return made;
})();

// What grows.
class Vertices {
  count = 0;
  private words = new Uint32Array(1 << 14);
  private floats = new Float32Array(this.words.buffer);

  add(x: number, y: number, code: number): number {
    if (2 * this.count === this.words.length) {
      const more = new Uint32Array(2 * this.words.length);
      more.set(this.words);
      this.words = more;
      this.floats = new Float32Array(more.buffer);
    }
    this.words[2 * this.count] = (x & 0xffff) | (y << 16);
    this.floats[2 * this.count + 1] = code;
    return this.count++;
  }

  take(): ArrayBuffer {
    return this.words.buffer.slice(0, kVertexStride * this.count) as ArrayBuffer;
  }
}

class Indices {
  count = 0;
  all = new Uint32Array(1 << 15);

  add(a: number, b: number, c: number): void {
    if (this.count + 3 > this.all.length) {
      const more = new Uint32Array(2 * this.all.length);
      more.set(this.all);
      this.all = more;
    }
    this.all[this.count++] = a;
    this.all[this.count++] = b;
    this.all[this.count++] = c;
  }
}

class Mesher {
  private readonly stride: number;
  private readonly across: number;
  private readonly down: number;
  private readonly cuts: Uint8Array;
  /** By corner: its code; of one that is at a cut, which edges around it are cut, and its number. */
  private readonly values: Float32Array;
  private readonly edges: Uint8Array;
  private readonly errors: Float32Array;
  private readonly known: Int32Array;
  private atCuts: Int32Array;
  private cutCorners = 0;
  private readonly vertices = new Vertices();
  private readonly smooth = new Indices();
  private readonly beside = new Indices();
  private readonly skins = new Indices();
  private readonly apron = new Indices();
  private readonly parts = [this.smooth, this.beside, this.skins, this.apron];
  private numbered = 0;

  constructor(private readonly codes: Uint16Array, private readonly width: number,
              private readonly height: number, offset: number, private readonly tolerance: number) {
    this.across = Math.ceil(width / kSide);
    this.down = Math.ceil(height / kSide);
    this.stride = kSide * this.across + 1;
    const corners = this.stride * (kSide * this.down + 1);
    this.cuts = findCuts(codes, width, height, offset);
    this.values = new Float32Array(corners);
    this.edges = new Uint8Array(corners);
    this.errors = new Float32Array(corners);
    this.known = new Int32Array(corners).fill(-1);
    this.atCuts = new Int32Array(1 << 12).fill(-1);
  }

  make(mostTriangles: number): KeyframeMesh | null {
    this.findCorners();
    // A corner at a cut has at least these.
    if (6 * this.cutCorners > mostTriangles) return null;
    this.findErrors();
    for (let ty = 0; ty < this.down; ++ty)
      for (let tx = 0; tx < this.across; ++tx) {
        const x = kSide * tx, y = kSide * ty, right = x + kSide, bottom = y + kSide;
        this.split(x, y, right, bottom, right, y);
        this.split(right, bottom, x, y, x, bottom);
      }
    this.makeSkins();
    const { parts } = this, counts = parts.map((part) => part.count);
    const count = counts.reduce((a, b) => a + b, 0);
    if (count > 3 * mostTriangles) return null;
    this.makeApron();
    counts[3] = this.apron.count;
    const indices = new Uint32Array(count + counts[3]);
    let at = 0;
    for (const { all, count: of } of parts) {
      indices.set(all.subarray(0, of), at);
      at += of;
    }
    return {
      vertices: this.vertices.take(), indices, counts: counts as KeyframeMesh["counts"], scale: 1,
    };
  }

  // The code of each corner. Around the picture lie its outermost texels again.
  private findCorners(): void {
    const { codes, cuts, width, height, stride, values, edges, errors } = this;
    const last = width - 1;
    for (let y = 0; y <= height; ++y) {
      const up = Math.max(y - 1, 0) * width, low = Math.min(y, height - 1) * width;
      const inside = y > 0 && y < height;
      for (let x = 0, c = y * stride; x <= width; ++x, ++c) {
        const left = x > 0 ? x - 1 : 0, right = x < width ? x : last;
        let cut = 0;
        if (x > 0 && x < width)
          cut = (cuts[up + left] & kCutRight) | ((cuts[low + left] & kCutRight) << 2);
        if (inside) cut |= (cuts[up + right] & kCutDown) | ((cuts[up + left] & kCutDown) << 2);
        values[c] = 0.25 * (codes[up + left] + codes[up + right] + codes[low + left] + codes[low + right]);
        if (cut) {
          edges[c] = cut;
          errors[c] = kCut;
          ++this.cutCorners;
        }
      }
    }
    // Squares that reach over the picture are cut at its border.
    if (width % kSide) for (let y = 0; y <= height; ++y) errors[y * stride + width] = kCut;
    if (height % kSide) for (let x = 0; x <= width; ++x) errors[height * stride + x] = kCut;
  }

  // The mean of the texels of a set of places around a corner.
  private mean(x: number, y: number, group: number): number {
    const { codes, width, height } = this;
    const left = Math.max(x - 1, 0), right = Math.min(x, width - 1);
    const up = Math.max(y - 1, 0) * width, low = Math.min(y, height - 1) * width;
    let sum = 0, count = 0;
    if (group & (1 << kUpperLeft)) sum += codes[up + left], ++count;
    if (group & (1 << kUpperRight)) sum += codes[up + right], ++count;
    if (group & (1 << kLowerRight)) sum += codes[low + right], ++count;
    if (group & (1 << kLowerLeft)) sum += codes[low + left], ++count;
    return sum / count;
  }

  // The place at a corner of the texel that lies towards (dx, dy).
  private static place(dx: number, dy: number): number {
    return dy < 0 ? (dx < 0 ? kUpperLeft : kUpperRight) : (dx < 0 ? kLowerLeft : kLowerRight);
  }

  private code(x: number, y: number, dx: number, dy: number): number {
    const corner = y * this.stride + x, edges = this.edges[corner];
    return edges ? this.mean(x, y, kGroups[4 * edges + Mesher.place(dx, dy)]) : this.values[corner];
  }

  private findErrors(): void {
    const { errors, stride, values, edges, width, height, across, down } = this;
    // By triangle and relative to its square's first corner: the ends and the middle of its hypotenuse, and the
    // middles of its halves' hypotenuses.
    const places = new Int32Array(5 * (kTriangles.length / 4));
    for (let i = 0; i < kTriangles.length / 4; ++i) {
      const [ax, ay, bx, by] = kTriangles.subarray(4 * i, 4 * i + 4);
      const mx = (ax + bx) >> 1, my = (ay + by) >> 1, cx = mx + my - ay, cy = my + ax - mx;
      places.set([ay * stride + ax, by * stride + bx, my * stride + mx, ((ay + cy) >> 1) * stride + ((ax + cx) >> 1),
                  ((by + cy) >> 1) * stride + ((bx + cx) >> 1)], 5 * i);
    }
    const active = this.findActive();
    const parents = kSide * kSide - 2;
    for (let first = parents; first >= 0; first = (first >> 1) - 1)
      for (let ty = 0, square = 0; ty < down; ++ty)
        for (let tx = 0; tx < across; ++tx, ++square) {
          if (!active[square]) continue;
          const bent = active[square] > 1;
          const ox = kSide * tx, oy = kSide * ty, base = oy * stride + ox;
          const inside = ox + kSide <= width && oy + kSide <= height;
          for (let i = first, p = 5 * first; i < 2 * first + 2; ++i, p += 5) {
            const m = base + places[p + 2];
            let error = errors[m];
            if (bent && error < kCut) {
              const a = base + places[p], b = base + places[p + 1];
              const off = (edges[a] | edges[b]) || !inside ? this.offset(ox, oy, i, values[m])
                : Math.abs(0.5 * (values[a] + values[b]) - values[m]);
              if (off > error) error = off;
            }
            if (i < parents) {
              const l = errors[base + places[p + 3]], r = errors[base + places[p + 4]];
              if (l > error) error = l;
              if (r > error) error = r;
            }
            errors[m] = error;
          }
        }
  }

  // By how much the middle of a hypotenuse is off, of whose ends one may be at a cut or outside.
  private offset(ox: number, oy: number, triangle: number, value: number): number {
    const { width, height } = this;
    const ax = ox + kTriangles[4 * triangle], ay = oy + kTriangles[4 * triangle + 1];
    const bx = ox + kTriangles[4 * triangle + 2], by = oy + kTriangles[4 * triangle + 3];
    const mx = (ax + bx) >> 1, my = (ay + by) >> 1;
    if (mx > width || my > height) return 0;
    if (ax > width || ay > height || bx > width || by > height) return kCut;
    const a = this.code(ax, ay, mx - ax, my - ay), b = this.code(bx, by, mx - bx, my - by);
    // A sky beside a surface: what is one at the corner is not so in between.
    return (a === 0) !== (b === 0) ? kCut : Math.abs(0.5 * (a + b) - value);
  }

  // 2: squares of which two triangles are not exact enough. 1: those beside them, whose borders may be split.
  private findActive(): Uint8Array {
    const { errors, values, stride, across, down, tolerance } = this;
    const bent = new Uint8Array(across * down), active = new Uint8Array(across * down);
    for (let ty = 0; ty < down; ++ty)
      for (let tx = 0; tx < across; ++tx) {
        const base = kSide * (ty * stride + tx), c = values[base];
        const right = values[base + kSide], low = values[base + kSide * stride], last = values[base + kSide * (stride + 1)];
        let flat = true;
        for (let y = 0; y <= kSide && flat; ++y) {
          // To the diagonal the lower triangle, from there on the upper one.
          let wanted = c + (y * (low - c)) / kSide, step = (last - low) / kSide;
          for (let x = 0, at = base + y * stride; x <= kSide; ++x, ++at, wanted += step) {
            if (x === y) step = (right - c) / kSide;
            const off = values[at] - wanted;
            if (errors[at] > 0 || off > tolerance || off < -tolerance) {
              flat = false;
              break;
            }
          }
        }
        bent[ty * across + tx] = flat ? 0 : 1;
      }
    for (let ty = 0, k = 0; ty < down; ++ty)
      for (let tx = 0; tx < across; ++tx, ++k)
        active[k] = 2 * bent[k] | (tx > 0 ? bent[k - 1] : 0) | (tx + 1 < across ? bent[k + 1] : 0) |
          (ty > 0 ? bent[k - across] : 0) | (ty + 1 < down ? bent[k + across] : 0);
    return active;
  }

  private split(ax: number, ay: number, bx: number, by: number, cx: number, cy: number): void {
    const mx = (ax + bx) >> 1, my = (ay + by) >> 1;
    if (Math.abs(ax - cx) + Math.abs(ay - cy) > 1 && this.errors[my * this.stride + mx] > this.tolerance) {
      this.split(cx, cy, ax, ay, mx, my);
      this.split(bx, by, cx, cy, mx, my);
      return;
    }
    const { width, height, edges, stride } = this;
    if (ax > width || bx > width || cx > width || ay > height || by > height || cy > height) return;
    // Three times the middle.
    const gx = ax + bx + cx, gy = ay + by + cy;
    const a = this.vertex(ax, ay, gx - 3 * ax, gy - 3 * ay);
    const b = this.vertex(bx, by, gx - 3 * bx, gy - 3 * by);
    const c = this.vertex(cx, cy, gx - 3 * cx, gy - 3 * cy);
    const cut = edges[ay * stride + ax] | edges[by * stride + bx] | edges[cy * stride + cx];
    (cut ? this.beside : this.smooth).add(a, b, c);
  }

  // The vertex of a corner that belongs to the texel towards (dx, dy).
  private vertex(x: number, y: number, dx: number, dy: number): number {
    const corner = y * this.stride + x, edges = this.edges[corner];
    if (!edges) {
      const known = this.known[corner];
      return known >= 0 ? known : (this.known[corner] = this.vertices.add(x, y, this.values[corner]));
    }
    return this.vertexOf(x, y, corner, kGroups[4 * edges + Mesher.place(dx, dy)]);
  }

  private vertexOf(x: number, y: number, corner: number, group: number): number {
    let number = -2 - this.known[corner];
    if (number < 0) {
      number = this.numbered++;
      this.known[corner] = -2 - number;
      if (4 * number + 4 > this.atCuts.length) {
        const more = new Int32Array(2 * this.atCuts.length).fill(-1);
        more.set(this.atCuts);
        this.atCuts = more;
      }
    }
    // Of the first place of the group.
    const at = 4 * number + (31 - Math.clz32(group & -group));
    return this.atCuts[at] >= 0
      ? this.atCuts[at] : (this.atCuts[at] = this.vertices.add(x, y, this.mean(x, y, group)));
  }

  private makeSkins(): void {
    const { cuts, width, height } = this;
    for (let y = 0, i = 0; y < height; ++y)
      for (let x = 0; x < width; ++x, ++i) {
        if (cuts[i] & kCutRight) this.skin(x + 1, y, x + 1, y + 1, -1, 0);
        if (cuts[i] & kCutDown) this.skin(x, y + 1, x + 1, y + 1, 0, -1);
      }
  }

  // Over the cut from corner (x0, y0) to (x1, y1); (dx, dy) goes to the texel on its first side.
  private skin(x0: number, y0: number, x1: number, y1: number, dx: number, dy: number): void {
    // Both texels lie between the corners.
    const ix = dx === 0 ? 1 : dx, iy = dy === 0 ? 1 : dy;
    const a = this.vertex(x0, y0, ix, iy), c = this.vertex(x1, y1, dx === 0 ? -1 : dx, dy === 0 ? -1 : dy);
    const b = this.vertex(x0, y0, dx === 0 ? 1 : -dx, dy === 0 ? 1 : -dy);
    const d = this.vertex(x1, y1, dx === 0 ? -1 : -dx, dy === 0 ? -1 : -dy);
    // At the end of a tear both sides are one.
    if (a !== b) this.skins.add(a, b, c);
    if (c !== d) this.skins.add(b, d, c);
  }

  // Around the picture, as far out as it is large.
  private makeApron(): void {
    const { width, height, vertices, apron } = this;
    const line = (x0: number, y0: number, x1: number, y1: number, ox: number, oy: number) => {
      const count = Math.max(1, Math.ceil(Math.max(Math.abs(x1 - x0), Math.abs(y1 - y0)) / kApronStep));
      let before = -1, beforeOut = -1;
      for (let k = 0; k <= count; ++k) {
        const x = Math.round(x0 + ((x1 - x0) * k) / count), y = Math.round(y0 + ((y1 - y0) * k) / count);
        const code = this.code(x, y, x < width ? 1 : -1, y < height ? 1 : -1);
        // Corners go out in both directions.
        const outX = ox || (x === 0 ? -width : x === width ? width : 0);
        const outY = oy || (y === 0 ? -height : y === height ? height : 0);
        const own = vertices.add(x, y, code), out = vertices.add(x + outX, y + outY, code);
        if (k > 0) {
          apron.add(before, beforeOut, own);
          apron.add(own, beforeOut, out);
        }
        before = own;
        beforeOut = out;
      }
    };
    line(0, 0, width, 0, 0, -height);
    line(0, height, width, height, 0, height);
    line(0, 0, 0, height, -width, 0);
    line(width, 0, width, height, width, 0);
  }
}

// Half as large: of four texels the nearest.
function halved(codes: Uint16Array, width: number, height: number): Uint16Array {
  const across = Math.ceil(width / 2), down = Math.ceil(height / 2);
  const made = new Uint16Array(across * down);
  for (let y = 0, i = 0; y < down; ++y) {
    const up = 2 * y * width, low = Math.min(2 * y + 1, height - 1) * width;
    for (let x = 0; x < across; ++x, ++i) {
      const left = 2 * x, right = Math.min(left + 1, width - 1);
      made[i] = Math.max(codes[up + left], codes[up + right], codes[low + left], codes[low + right]);
    }
  }
  return made;
}

/**
 * Makes the triangles of a plane of codes (cuts.ts says what they are), at most about `most` of
 * them: where there would be more, as among leaves, those of a plane of half the size. Triangles
 * are off by about `tolerance` codes at most.
 */
export function makeMesh(codes: Uint16Array, width: number, height: number, offset: number,
                         tolerance: number, most: number): KeyframeMesh {
  let scale = 1;
  for (;;) {
    const last = width <= 64 || height <= 64;
    const made = new Mesher(codes, width, height, offset, tolerance).make(last ? Infinity : most);
    if (made) return { ...made, scale };
    codes = halved(codes, width, height);
    width = Math.ceil(width / 2);
    height = Math.ceil(height / 2);
    scale *= 2;
  }
}
