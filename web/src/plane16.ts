// Planes of 16-bit numbers as rilievo/io/plane16.h stores them: a predictor, the low bytes of the
// differences, their high bytes, all deflated.

import { WalkError } from "./errors.js";

async function inflated(bytes: Uint8Array, where: string): Promise<Uint8Array> {
  if (typeof DecompressionStream === "undefined")
    throw new WalkError("browser", "has no DecompressionStream, which walks need: update it");
  try {
    const stream = new Blob([bytes as Uint8Array<ArrayBuffer>])
      .stream()
      .pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new WalkError(where, "is damaged");
  }
}

export async function decodePlane16(
  bytes: Uint8Array,
  width: number,
  height: number,
  where: string,
): Promise<Uint16Array> {
  const raw = await inflated(bytes, where);
  const count = width * height;
  if (raw.length !== 1 + 2 * count || raw[0] > 2)
    throw new WalkError(where, "is damaged or has another size");
  return unfold(raw, width, height);
}

// Most planes have predictor 2 and nearly all texels neighbours, which are read without questions.
function unfold(raw: Uint8Array, width: number, height: number): Uint16Array {
  const predictor = raw[0], count = width * height;
  const plane = new Uint16Array(count);
  const texel = (x: number, y: number, i: number) => {
    const folded = raw[1 + i] | (raw[1 + count + i] << 8);
    let value = (folded >> 1) ^ -(folded & 1);
    if (predictor > 0) {
      const w = x > 0 ? plane[i - 1] : 0;
      const n = y > 0 ? plane[i - width] : 0;
      const affine = w + n - (x > 0 && y > 0 ? plane[i - width - 1] : 0);
      value +=
        predictor === 1 ? affine : Math.min(Math.max(affine, Math.min(w, n)), Math.max(w, n));
    }
    plane[i] = value;
  };
  for (let y = 0, i = 0; y < height; ++y) {
    const end = i + width;
    if (y === 0 || predictor !== 2) {
      for (let x = 0; i < end; ++x, ++i) texel(x, y, i);
      continue;
    }
    texel(0, y, i++);
    let w = plane[i - 1], nw = plane[i - 1 - width];
    for (; i < end; ++i) {
      const n = plane[i - width], affine = w + n - nw;
      const low = w < n ? w : n, high = w < n ? n : w;
      const folded = raw[1 + i] | (raw[1 + count + i] << 8);
      w = (((folded >> 1) ^ -(folded & 1)) + (affine < low ? low : affine > high ? high : affine)) & 0xffff;
      plane[i] = w;
      nw = n;
    }
  }
  return plane;
}
