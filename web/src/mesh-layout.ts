// A node's mesh as the GPU draws it.

// Bytes of a vertex, in the file and on the GPU (rilievo/web_walk/pack_mesh.h).
export const kSurfaceStride = 8;
export const kSkinStride = 16;

export interface NodeMesh {
  surfaceVertices: Uint8Array;
  surfaceIndices: Uint32Array;
  skinVertices: Uint8Array;
  skinIndices: Uint32Array;
  /** Of each side the least and the most disparity, 1/m; the most is below the least if it is empty. */
  reaches: Float64Array;
}
