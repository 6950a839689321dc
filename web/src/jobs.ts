// What a worker does for a walk. Every job checks first that the bytes are those that the file's
// name says: the beginning of their SHA-256.

import { WalkError } from "./errors.js";
import type { MeshEntry } from "./manifest.js";
import type { NodeMesh } from "./mesh-layout.js";
import { decodeMesh } from "./node-mesh.js";
import { decodePlane16 } from "./plane16.js";
import { unpackSamples, type SheetEntry } from "./reliefs/samples.js";
import { sha256Hex } from "./sha256.js";
import { makeSurface, type ViewDepths, type ViewSurface } from "./views/surface.js";

export type Job =
  | { kind: "check"; bytes: ArrayBuffer; name: string }
  | { kind: "mesh"; bytes: ArrayBuffer; entry: MeshEntry }
  | { kind: "plane16"; bytes: ArrayBuffer; name: string; width: number; height: number }
  | { kind: "view"; bytes: ArrayBuffer; name: string; of: ViewDepths }
  | { kind: "samples"; bytes: ArrayBuffer; name: string; layers: Uint16Array; of: SheetEntry }
  | { kind: "shares"; bytes: ArrayBuffer; name: string; width: number; height: number; steps: number };

export type JobResult = ArrayBuffer | NodeMesh | Uint16Array | Uint8Array | ViewSurface;

function expectHash(bytes: Uint8Array, name: string): void {
  const wanted = /([0-9a-f]+)\.\w+$/.exec(name)?.[1] ?? "";
  if (!sha256Hex(bytes).startsWith(wanted) || wanted.length < 16)
    throw new WalkError(name, "has not the contents that its name says: it is damaged, or of another walk");
}

export async function runJob(job: Job): Promise<JobResult> {
  const bytes = new Uint8Array(job.bytes);
  expectHash(bytes, job.kind === "mesh" ? job.entry.name : job.name);
  switch (job.kind) {
    case "check":
      return job.bytes;
    case "mesh":
      return decodeMesh(bytes, job.entry);
    case "plane16":
      return decodePlane16(bytes, job.width, job.height, job.name);
    case "view":
      return makeSurface(await decodePlane16(bytes, job.of.width, job.of.height, job.name), job.of);
    case "samples": {
      const { of, layers, name } = job;
      const codes = await decodePlane16(bytes, of.sheetWidth, of.sheetHeight, name);
      return unpackSamples(codes, layers, of, name);
    }
    case "shares": {
      const plane = await decodePlane16(bytes, job.width, job.height, job.name);
      return Uint8Array.from(plane, (step) => Math.min(255, Math.round((255 * step) / job.steps)));
    }
  }
}

export function transferOf(result: JobResult): ArrayBuffer[] {
  if (result instanceof ArrayBuffer) return [result];
  if (result instanceof Uint16Array || result instanceof Uint8Array)
    return [result.buffer as ArrayBuffer];
  // Each array of a mesh or a surface has its own.
  return Object.values(result).map((array) => array.buffer as ArrayBuffer);
}
