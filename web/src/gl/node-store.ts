// Nodes on the GPU: a cube map of colours, and the meshes of surfaces and skins.

import type { LevelEntry } from "../manifest.js";
import { kSkinStride, kSurfaceStride, type NodeMesh } from "../mesh-layout.js";

export interface StoredNode {
  readonly worldFromNode: Float64Array;
  readonly level: LevelEntry;
  readonly faces: WebGLTexture;
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
}

/** What a node needs on the GPU, bytes. */
function storedBytes(level: LevelEntry, mesh: NodeMesh, objects: boolean): number {
  const texels = 6 * level.faceSize * level.faceSize;
  return (
    texels * (objects ? 6 : 4) + mesh.surfaceVertices.length + mesh.skinVertices.length +
    mesh.surfaceIndices.byteLength + mesh.skinIndices.byteLength
  );
}

function starts(counts: readonly number[]): Uint32Array {
  const made = new Uint32Array(7);
  for (let f = 0; f < 6; ++f) made[f + 1] = made[f] + counts[f];
  return made;
}

/** Creates a node without its faces' colours (uploadFace). */
export function storeNode(gl: WebGL2RenderingContext, worldFromNode: Float64Array,
                          level: LevelEntry, mesh: NodeMesh, objects: Uint16Array | null):
    StoredNode {
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
    gl.enableVertexAttribArray(2);
    if (stride === kSurfaceStride) {
      gl.vertexAttribPointer(2, 1, gl.UNSIGNED_BYTE, true, stride, 8);
    } else {
      gl.vertexAttribPointer(2, 3, gl.SHORT, false, stride, 8);
      gl.enableVertexAttribArray(3);
      gl.vertexAttribPointer(3, 1, gl.UNSIGNED_SHORT, false, stride, 14);
    }
    gl.bindVertexArray(null);
    return made as WebGLVertexArrayObject;
  };
  const surfaces = array(mesh.surfaceVertices, mesh.surfaceIndices, kSurfaceStride);
  const skins = array(mesh.skinVertices, mesh.skinIndices, kSkinStride);

  const faces = gl.createTexture() as WebGLTexture;
  gl.bindTexture(gl.TEXTURE_CUBE_MAP, faces);
  gl.texStorage2D(gl.TEXTURE_CUBE_MAP, 1, gl.RGBA8, level.faceSize, level.faceSize);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
    gl.texParameteri(gl.TEXTURE_CUBE_MAP, filter, gl.LINEAR);
  gl.bindTexture(gl.TEXTURE_CUBE_MAP, null);

  let ids: WebGLTexture | null = null;
  if (objects) {
    ids = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, ids);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.R16UI, 3 * level.faceSize, 2 * level.faceSize);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 3 * level.faceSize, 2 * level.faceSize,
                     gl.RED_INTEGER, gl.UNSIGNED_SHORT, objects);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    gl.bindTexture(gl.TEXTURE_2D, null);
  }
  const surfaceStarts = starts(level.mesh.surfaces);
  const skinStarts = starts(level.mesh.skins);
  return {
    worldFromNode, level, faces, objects: ids, surfaces, skins, buffers, surfaceStarts, skinStarts,
    reaches: mesh.reaches,
    triangles: surfaceStarts[6] + skinStarts[6],
    bytes: storedBytes(level, mesh, ids !== null),
    uploaded: 0,
  };
}

/** Uploads the next face, whose first row is the bottom one. */
export function uploadFace(gl: WebGL2RenderingContext, node: StoredNode, face: ImageBitmap): void {
  gl.bindTexture(gl.TEXTURE_CUBE_MAP, node.faces);
  // As the bitmap is: whatever was set by others.
  gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
  gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.texSubImage2D(gl.TEXTURE_CUBE_MAP_POSITIVE_X + node.uploaded, 0, 0, 0, gl.RGBA,
                   gl.UNSIGNED_BYTE, face);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.BROWSER_DEFAULT_WEBGL);
  gl.bindTexture(gl.TEXTURE_CUBE_MAP, null);
  ++node.uploaded;
}

export function deleteNode(gl: WebGL2RenderingContext, node: StoredNode): void {
  gl.deleteTexture(node.faces);
  if (node.objects) gl.deleteTexture(node.objects);
  gl.deleteVertexArray(node.surfaces);
  gl.deleteVertexArray(node.skins);
  for (const buffer of node.buffers) gl.deleteBuffer(buffer);
}
