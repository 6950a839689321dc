// A keyframe's pictures on the GPU. What a picture has is uploaded in steps, a few in each frame.

import type { DecodedPart } from "./decoder.js";
import { axesOf } from "./camera.js";
import { kVertexStride, type KeyframeMesh } from "./mesh.js";
import type { KeyframePart } from "./messages.js";

export class StoredPart {
  readonly axes: Float64Array;
  /** Indices of surfaces that touch no cut, of those that do, of skins, of the apron: where each begins, and the end. */
  readonly starts: readonly number[];
  readonly scale: number;
  readonly triangles: number;
  readonly bytes: number;
  readonly colors: WebGLTexture | null;
  readonly codes: WebGLTexture | null;
  readonly array: WebGLVertexArrayObject | null;
  private readonly vertices: WebGLBuffer | null;
  private readonly indices: WebGLBuffer | null;
  private waiting: { decoded: DecodedPart; row: number; codeRow: number; vertexByte: number; indexByte: number } | null;

  constructor(private readonly gl: WebGL2RenderingContext, readonly part: KeyframePart, decoded: DecodedPart) {
    const { width, height } = part, { mesh } = decoded;
    this.axes = axesOf(part.orientation);
    this.starts = startsOf(mesh);
    this.scale = mesh.scale;
    this.triangles = mesh.indices.length / 3;
    this.bytes = 6 * width * height + mesh.vertices.byteLength + mesh.indices.byteLength;
    const texture = (format: number, filter: number) => {
      const made = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, made);
      gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
      for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
      for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T])
        gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
      gl.bindTexture(gl.TEXTURE_2D, null);
      return made;
    };
    this.colors = texture(gl.RGBA8, gl.LINEAR);
    this.codes = texture(gl.R16UI, gl.NEAREST);
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    const buffer = (target: number, bytes: number) => {
      const made = gl.createBuffer();
      gl.bindBuffer(target, made);
      gl.bufferData(target, bytes, gl.STATIC_DRAW);
      return made;
    };
    this.vertices = buffer(gl.ARRAY_BUFFER, mesh.vertices.byteLength);
    this.indices = buffer(gl.ELEMENT_ARRAY_BUFFER, mesh.indices.byteLength);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.SHORT, false, kVertexStride, 0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 1, gl.FLOAT, false, kVertexStride, 4);
    gl.bindVertexArray(null);
    this.waiting = { decoded, row: 0, codeRow: 0, vertexByte: 0, indexByte: 0 };
  }

  /** Can it be drawn? */
  get there(): boolean {
    return this.waiting === null;
  }

  /** Uploads about so many bytes more; returns how many of them are left. */
  upload(bytes: number): number {
    const { gl, waiting } = this;
    if (!waiting) return bytes;
    const { width, height } = this.part, { decoded } = waiting, { mesh } = decoded;
    // As the numbers are: whatever was set by others.
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    const rows = (from: number, row: number) => Math.min(height - from, Math.max(1, Math.floor(bytes / row)));
    gl.activeTexture(gl.TEXTURE0);
    if (bytes > 0 && waiting.row < height) {
      const count = rows(waiting.row, 4 * width);
      gl.bindTexture(gl.TEXTURE_2D, this.colors);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, waiting.row, width, count, gl.RGBA, gl.UNSIGNED_BYTE,
                       new Uint8Array(decoded.colors), 4 * width * waiting.row);
      waiting.row += count;
      bytes -= 4 * width * count;
    }
    if (bytes > 0 && waiting.codeRow < height) {
      const count = rows(waiting.codeRow, 2 * width);
      gl.bindTexture(gl.TEXTURE_2D, this.codes);
      gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, waiting.codeRow, width, count, gl.RED_INTEGER, gl.UNSIGNED_SHORT,
                       new Uint16Array(decoded.codes), width * waiting.codeRow);
      gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
      waiting.codeRow += count;
      bytes -= 2 * width * count;
    }
    gl.bindTexture(gl.TEXTURE_2D, null);
    const send = (target: number, of: WebGLBuffer | null, all: ArrayBufferLike, from: number) => {
      const count = Math.min(all.byteLength - from, bytes);
      if (count <= 0) return from;
      gl.bindBuffer(target, of);
      gl.bufferSubData(target, from, new Uint8Array(all, from, count));
      bytes -= count;
      return from + count;
    };
    waiting.vertexByte = send(gl.ARRAY_BUFFER, this.vertices, mesh.vertices, waiting.vertexByte);
    // An element buffer belongs to the array that is bound.
    gl.bindVertexArray(this.array);
    waiting.indexByte = send(gl.ELEMENT_ARRAY_BUFFER, this.indices, mesh.indices.buffer, waiting.indexByte);
    gl.bindVertexArray(null);
    if (waiting.row === height && waiting.codeRow === height && waiting.vertexByte === mesh.vertices.byteLength &&
        waiting.indexByte === mesh.indices.byteLength)
      this.waiting = null;
    return bytes;
  }

  dispose(): void {
    const { gl } = this;
    gl.deleteTexture(this.colors);
    gl.deleteTexture(this.codes);
    gl.deleteVertexArray(this.array);
    gl.deleteBuffer(this.vertices);
    gl.deleteBuffer(this.indices);
    this.waiting = null;
  }
}

function startsOf(mesh: KeyframeMesh): number[] {
  const starts = [0];
  for (const count of mesh.counts) starts.push(starts[starts.length - 1] + count);
  return starts;
}
