// A node's mesh, from the file (rilievo/web_walk/pack_mesh.h) to what the GPU draws.

import { MeshoptDecoder } from "meshoptimizer/decoder";
import { WalkError } from "./errors.js";
import type { MeshEntry, StreamEntry } from "./manifest.js";
import { kSkinStride, kSurfaceStride, type NodeMesh } from "./mesh-layout.js";

/** Decodes a file of a mesh. */
export async function decodeMesh(bytes: Uint8Array, entry: MeshEntry): Promise<NodeMesh> {
  if (!MeshoptDecoder.supported)
    throw new WalkError("browser", "has no WebAssembly, which walks need");
  await MeshoptDecoder.ready;
  let at = 0;
  const take = (stream: StreamEntry) => bytes.subarray(at, (at += stream.bytes));
  const vertices = (stream: StreamEntry, stride: number) => {
    const target = new Uint8Array(stride * stream.count);
    const source = take(stream);
    if (stream.count > 0) MeshoptDecoder.decodeVertexBuffer(target, stream.count, stride, source);
    return target;
  };
  const indices = (stream: StreamEntry, of: number) => {
    const target = new Uint32Array(stream.count);
    const source = take(stream);
    if (stream.count > 0)
      MeshoptDecoder.decodeIndexBuffer(new Uint8Array(target.buffer), stream.count, 4, source);
    for (let i = 0; i < target.length; ++i)
      if (target[i] >= of) throw new WalkError(entry.name, "names a vertex that there is not");
    return target;
  };
  try {
    const surfaceVertices = vertices(entry.surfaceVertices, kSurfaceStride);
    const surfaceIndices = indices(entry.surfaceIndices, entry.surfaceVertices.count);
    const skinVertices = vertices(entry.skinVertices, kSkinStride);
    const skinIndices = indices(entry.skinIndices, entry.skinVertices.count);
    const reaches = new Float64Array(12);
    for (let f = 0; f < 6; ++f) {
      reaches[2 * f] = Infinity;
      reaches[2 * f + 1] = -Infinity;
    }
    const reach = (of: Uint8Array, stride: number, used: Uint32Array, sides: readonly number[]) => {
      const codes = new Uint16Array(of.buffer, of.byteOffset, of.length / 2);
      let i = 0;
      for (let f = 0; f < 6; ++f)
        for (const end = i + 3 * sides[f]; i < end; ++i) {
          const d = codes[(used[i] * stride) / 2 + 3] * entry.disparityStep;
          reaches[2 * f] = Math.min(reaches[2 * f], d);
          reaches[2 * f + 1] = Math.max(reaches[2 * f + 1], d);
        }
    };
    reach(surfaceVertices, kSurfaceStride, surfaceIndices, entry.surfaces);
    reach(skinVertices, kSkinStride, skinIndices, entry.skins);
    return { surfaceVertices, surfaceIndices, skinVertices, skinIndices, reaches };
  } catch (error) {
    if (error instanceof WalkError) throw error;
    throw new WalkError(entry.name, "is damaged");
  }
}
