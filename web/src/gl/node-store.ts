// Nodes on the GPU: colours and what texels count, what the node sees of all sides, and the meshes of
// surfaces and skins.

import type { LevelEntry } from "../manifest.js";
import { kSkinStride, kSurfaceStride, type NodeMesh } from "../mesh-layout.js";
import type { NodePainter } from "./seen.js";

export interface StoredNode {
  readonly worldFromNode: Float64Array;
  readonly level: LevelEntry;
  /**
   * Six layers of a face each, with one more texel on all sides: those of the faces beside. Alpha is
   * what texels count.
   */
  readonly faces: WebGLTexture;
  /** The same as a cube map, until all are there and NodePainter (seen.ts) has written `faces`. */
  cube: WebGLTexture | null;
  /** 3 x 2 faces of two codes of disparities as NodePainter (seen.ts) draws them. */
  readonly seen: WebGLTexture;
  readonly objects: WebGLTexture | null;
  readonly surfaces: WebGLVertexArrayObject;
  readonly skins: WebGLVertexArrayObject;
  readonly buffers: readonly WebGLBuffer[];
  /** By side: the first triangle of each, and the end. */
  readonly surfaceStarts: Uint32Array;
  readonly skinStarts: Uint32Array;
  readonly reaches: Float64Array;
  readonly triangles: number;
  readonly bytes: number;
  /** Faces uploaded so far; drawn from 6 on. */
  uploaded: number;
  /** Of all faces, until they are uploaded. */
  weightSheet: Uint8Array | null;
}

/** Bytes of the textures of a node: colours and weights, disparities, identifiers if there are any. */
export function textureBytes(faceSize: number, objects: boolean): number {
  return 6 * (4 * (faceSize + 2) ** 2 + (objects ? 6 : 4) * faceSize ** 2);
}

function storedBytes(level: LevelEntry, mesh: NodeMesh, objects: boolean): number {
  return (
    textureBytes(level.faceSize, objects) +
    mesh.surfaceVertices.length + mesh.skinVertices.length +
    mesh.surfaceIndices.byteLength + mesh.skinIndices.byteLength
  );
}

function starts(counts: readonly number[]): Uint32Array {
  const made = new Uint32Array(7);
  for (let f = 0; f < 6; ++f) made[f + 1] = made[f] + counts[f];
  return made;
}

function cubeMap(gl: WebGL2RenderingContext, size: number): WebGLTexture {
  const made = gl.createTexture() as WebGLTexture;
  gl.bindTexture(gl.TEXTURE_CUBE_MAP, made);
  gl.texStorage2D(gl.TEXTURE_CUBE_MAP, 1, gl.RGBA8, size, size);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
    gl.texParameteri(gl.TEXTURE_CUBE_MAP, filter, gl.NEAREST);
  gl.bindTexture(gl.TEXTURE_CUBE_MAP, null);
  return made;
}

function faceArray(gl: WebGL2RenderingContext, size: number): WebGLTexture {
  const made = gl.createTexture() as WebGLTexture;
  gl.bindTexture(gl.TEXTURE_2D_ARRAY, made);
  gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA8, size + 2, size + 2, 6);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, filter, gl.LINEAR);
  gl.bindTexture(gl.TEXTURE_2D_ARRAY, null);
  return made;
}

// 3 x 2 faces of one or two 16-bit numbers.
function sheet16(gl: WebGL2RenderingContext, format: number, size: number,
                 texels: Uint16Array | null): WebGLTexture {
  const made = gl.createTexture() as WebGLTexture;
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, 3 * size, 2 * size);
  if (texels) {
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 3 * size, 2 * size, gl.RED_INTEGER,
                     gl.UNSIGNED_SHORT, texels);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
  }
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
    gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  gl.bindTexture(gl.TEXTURE_2D, null);
  return made;
}

/** Creates a node without its faces (uploadFace) and what it sees (SeenDrawer). */
export function storeNode(gl: WebGL2RenderingContext, worldFromNode: Float64Array,
                          level: LevelEntry, mesh: NodeMesh, weights: Uint8Array,
                          objects: Uint16Array | null): StoredNode {
  const buffers: WebGLBuffer[] = [];
  const buffer = (target: number, data: ArrayBufferView) => {
    const made = gl.createBuffer();
    gl.bindBuffer(target, made);
    gl.bufferData(target, data, gl.STATIC_DRAW);
    if (made) buffers.push(made);
  };
  const array = (vertices: Uint8Array, indices: Uint32Array, stride: number) => {
    const made = gl.createVertexArray();
    gl.bindVertexArray(made);
    buffer(gl.ARRAY_BUFFER, vertices);
    buffer(gl.ELEMENT_ARRAY_BUFFER, indices);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.SHORT, false, stride, 0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 1, gl.UNSIGNED_SHORT, false, stride, 6);
    if (stride === kSkinStride) {
      gl.enableVertexAttribArray(2);
      gl.vertexAttribPointer(2, 3, gl.SHORT, false, stride, 8);
      gl.enableVertexAttribArray(3);
      gl.vertexAttribPointer(3, 1, gl.UNSIGNED_SHORT, false, stride, 14);
    }
    gl.bindVertexArray(null);
    return made as WebGLVertexArrayObject;
  };
  const surfaces = array(mesh.surfaceVertices, mesh.surfaceIndices, kSurfaceStride);
  const skins = array(mesh.skinVertices, mesh.skinIndices, kSkinStride);
  const surfaceStarts = starts(level.mesh.surfaces);
  const skinStarts = starts(level.mesh.skins);
  return {
    worldFromNode, level,
    faces: faceArray(gl, level.faceSize),
    cube: cubeMap(gl, level.faceSize),
    seen: sheet16(gl, gl.RG16UI, level.faceSize, null),
    objects: objects ? sheet16(gl, gl.R16UI, level.faceSize, objects) : null,
    surfaces, skins, buffers, surfaceStarts, skinStarts,
    reaches: mesh.reaches,
    triangles: surfaceStarts[6] + skinStarts[6],
    bytes: storedBytes(level, mesh, objects !== null),
    uploaded: 0,
    weightSheet: weights,
  };
}

/** Uploads the next face, whose first row is the bottom one. */
export function uploadFace(gl: WebGL2RenderingContext, node: StoredNode, face: ImageBitmap,
                           painter: NodePainter): void {
  const target = gl.TEXTURE_CUBE_MAP_POSITIVE_X + node.uploaded;
  // As the bitmap is: whatever was set by others.
  gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
  gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.bindTexture(gl.TEXTURE_CUBE_MAP, node.cube);
  gl.texSubImage2D(target, 0, 0, 0, gl.RGBA, gl.UNSIGNED_BYTE, face);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.BROWSER_DEFAULT_WEBGL);
  gl.bindTexture(gl.TEXTURE_CUBE_MAP, null);
  if (node.weightSheet && node.cube)
    painter.writeWeights(node.weightSheet, node.uploaded, node.level.faceSize, node.cube);
  if (++node.uploaded === 6) node.weightSheet = null;
}

export function deleteNode(gl: WebGL2RenderingContext, node: StoredNode): void {
  for (const texture of [node.faces, node.cube, node.seen, node.objects]) gl.deleteTexture(texture);
  gl.deleteVertexArray(node.surfaces);
  gl.deleteVertexArray(node.skins);
  for (const buffer of node.buffers) gl.deleteBuffer(buffer);
}
