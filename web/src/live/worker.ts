// The program of the worker (decoder.ts), a bundle of its own: from a keyframe's bytes to what the GPU draws.

import { WalkError } from "../errors.js";
import { answerJobs } from "../job-port.js";
import { decodePlane16 } from "../plane16.js";
import { makeMesh } from "./mesh.js";
import type { DecodedPart, PartJob } from "./decoder.js";

// As numbers, so that a frame uploads a few rows of them: a bitmap would be converted whole.
async function colorsOf(bytes: Uint8Array<ArrayBuffer>, type: string, width: number, height: number):
    Promise<ArrayBuffer> {
  const bitmap = await createImageBitmap(new Blob([bytes], { type }),
                                         { premultiplyAlpha: "none", colorSpaceConversion: "none" })
    .catch(() => {
      throw new WalkError("server", `sent colours that are no ${type} which this browser reads`);
    });
  try {
    if (bitmap.width !== width || bitmap.height !== height)
      throw new WalkError("server", `sent colours of ${bitmap.width} x ${bitmap.height} for ${width} x ${height}`);
    const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    if (!context) throw new WalkError("browser", "gives a worker no canvas: update it");
    context.drawImage(bitmap, 0, 0);
    return context.getImageData(0, 0, width, height).data.buffer as ArrayBuffer;
  } finally {
    bitmap.close();
  }
}

async function decode({ bytes, part, tolerance, triangles }: PartJob): Promise<DecodedPart> {
  const { width, height, depths, colors, offset } = part;
  const colorsCome = colorsOf(new Uint8Array(bytes, colors.at, colors.bytes), part.type, width, height);
  // Whoever fails first is told of.
  colorsCome.catch(() => {});
  const begin = performance.now();
  const codes = await decodePlane16(new Uint8Array(bytes, depths.at, depths.bytes), width, height, "server");
  const decoded = performance.now();
  const mesh = makeMesh(codes, width, height, offset, tolerance, triangles);
  const meshed = performance.now();
  return {
    colors: await colorsCome, codes: codes.buffer as ArrayBuffer, mesh,
    depthMs: decoded - begin, meshMs: meshed - decoded,
  };
}

answerJobs(decode, ({ colors, codes, mesh }) => [colors, codes, mesh.vertices, mesh.indices.buffer]);
