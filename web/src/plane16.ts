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
  const predictor = raw[0];
  const plane = new Uint16Array(count);
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, ++i) {
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
    }
  return plane;
}
