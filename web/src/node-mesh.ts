// A node's mesh, from the file (rilievo/environment_nodes/pack_mesh.h) to what the GPU draws.
//
// GLSL ES 3.00 does not tell a fragment which triangle it belongs to, and the merge of nodes wants
// the triangle's quality. It is a flat attribute of the triangle's last vertex, the provoking one:
// each triangle is turned, or its last vertex doubled, until it has a provoking vertex of its own.

import { MeshoptDecoder } from "meshoptimizer/decoder";
import { WalkError } from "./errors.js";
import type { MeshEntry, StreamEntry } from "./manifest.js";
import { kSkinStride, kSurfaceStride, type NodeMesh } from "./mesh-layout.js";

// |cos| of the angle between a triangle's normal and the line of sight to its middle, as
// triangle_quality of node_mesh.cpp.
function quality(v: Int16Array, d: Uint16Array, size: number, step: number,
                 ia: number, ib: number, ic: number): number {
  const s = 1 / size;
  const a = 4 * ia, b = 4 * ib, c = 4 * ic;
  const ax = v[a] * s, ay = v[a + 1] * s, az = v[a + 2] * s, aw = d[a + 3] * step;
  const bx = v[b] * s, by = v[b + 1] * s, bz = v[b + 2] * s, bw = d[b + 3] * step;
  const cx = v[c] * s, cy = v[c + 1] * s, cz = v[c + 2] * s, cw = d[c + 3] * step;
  const nx = aw * (by * cz - bz * cy) + bw * (cy * az - cz * ay) + cw * (ay * bz - az * by);
  const ny = aw * (bz * cx - bx * cz) + bw * (cz * ax - cx * az) + cw * (az * bx - ax * bz);
  const nz = aw * (bx * cy - by * cx) + bw * (cx * ay - cy * ax) + cw * (ax * by - ay * bx);
  const mx = ax + bx + cx, my = ay + by + cy, mz = az + bz + cz;
  const length = Math.sqrt((nx * nx + ny * ny + nz * nz) * (mx * mx + my * my + mz * mz));
  if (!(length > 1e-30)) return aw === 0 && bw === 0 && cw === 0 ? 1 : 0;
  return Math.abs(nx * mx + ny * my + nz * mz) / length;
}

/** How the merge reads a surface's quality: 0 is nothing, 1 a skin (node_shaders.cpp). */
function qualityByte(value: number): number {
  return Math.min(255, Math.round(2 + 253 * value));
}

function withQuality(vertices: Uint8Array, indices: Uint32Array, size: number, step: number):
    { vertices: Uint8Array; indices: Uint32Array } {
  const count = vertices.length / 8;
  const shorts = new Int16Array(vertices.buffer, vertices.byteOffset, 4 * count);
  const codes = new Uint16Array(vertices.buffer, vertices.byteOffset, 4 * count);
  const triangles = indices.length / 3;
  const out = new Uint32Array(indices.length);
  // 0: not yet the last of a triangle; else its quality.
  const claimed = new Uint8Array(count);
  const doubled = new Uint32Array(triangles);
  const doubledQuality = new Uint8Array(triangles);
  let extra = 0;
  for (let t = 0; t < triangles; ++t) {
    const a = indices[3 * t], b = indices[3 * t + 1], c = indices[3 * t + 2];
    const q = qualityByte(quality(shorts, codes, size, step, a, b, c));
    const free = (v: number) => claimed[v] === 0 || claimed[v] === q;
    let u = a, v = b, last = c;
    if (!free(c)) {
      if (free(a)) {
        u = b; v = c; last = a;
      } else if (free(b)) {
        u = c; v = a; last = b;
      } else {
        doubled[extra] = c;
        doubledQuality[extra] = q;
        last = count + extra++;
      }
    }
    if (last < count) claimed[last] = q;
    out[3 * t] = u;
    out[3 * t + 1] = v;
    out[3 * t + 2] = last;
  }
  const made = new Uint8Array(kSurfaceStride * (count + extra));
  for (let i = 0; i < count + extra; ++i) {
    const from = 8 * (i < count ? i : doubled[i - count]);
    for (let k = 0; k < 8; ++k) made[kSurfaceStride * i + k] = vertices[from + k];
    made[kSurfaceStride * i + 8] = i < count ? claimed[i] : doubledQuality[i - count];
  }
  return { vertices: made, indices: out };
}

/** Decodes a file of a mesh. */
export async function decodeMesh(bytes: Uint8Array, entry: MeshEntry, size: number):
    Promise<NodeMesh> {
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
    const surfaceVertices = vertices(entry.surfaceVertices, 8);
    const surfaceIndices = indices(entry.surfaceIndices, entry.surfaceVertices.count);
    const skinVertices = vertices(entry.skinVertices, kSkinStride);
    const skinIndices = indices(entry.skinIndices, entry.skinVertices.count);
    const surfaces = withQuality(surfaceVertices, surfaceIndices, size, entry.disparityStep);
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
    reach(surfaceVertices, 8, surfaceIndices, entry.surfaces);
    reach(skinVertices, kSkinStride, skinIndices, entry.skins);
    return {
      surfaceVertices: surfaces.vertices,
      surfaceIndices: surfaces.indices,
      skinVertices,
      skinIndices,
      reaches,
    };
  } catch (error) {
    if (error instanceof WalkError) throw error;
    throw new WalkError(entry.name, "is damaged");
  }
}
