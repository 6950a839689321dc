// What is drawn into a node's textures once, when it comes. What it sees in each direction, for those
// who ask whether it sees through a place (S3.7), and beside silhouettes: its disparities, drawn from
// its own mesh as its own eye sees it, where surfaces cover each texel once. Nothing of it is in a
// file.

import { kFaceAxes } from "../choose.js";
import { beginProgram, checkProgram, kScreenVertex } from "./program.js";
import type { StoredNode } from "./node-store.js";

// A side lies on the plane in front of its face, so that disparity is linear in the face. What is
// drawn is the code of a disparity as the bits of a half float, 11 of them exact, plus 1; 0 is
// nothing.
const kVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec3 direction;     // times N
layout(location = 1) in float disparity;    // code
uniform vec3 right, up;                     // of the face, by N
out float v_disparity;
void main() {
  gl_Position = vec4(dot(direction, right), dot(direction, up), 0.0, 1.0);
  v_disparity = disparity;
}
`;

const kFragment = `#version 300 es
precision highp float;
precision highp int;
in float v_disparity;
layout(location = 0) out uvec4 out_code;
void main() {
  out_code = uvec4(packHalf2x16(vec2(clamp(v_disparity, 0.0, 65504.0), 0.0)) + 1u, 0u, 0u, 0u);
}
`;

// What frames ask: red is the code, of which bit 15 says that the four texels from here to the right
// and up do not agree, so that colours between them may be those of several surfaces; green is the
// largest of the four.
const kAskedFragment = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
uniform usampler2D codes;
uniform float agree;  // by how much of the lesser one disparities may differ
layout(location = 0) out uvec4 out_codes;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(codes, 0) / ivec2(3, 2);
  // On this face.
  ivec2 last = (at / size + 1) * size - 1;
  uint own = texelFetch(codes, at, 0).r, least = own, most = own;
  for (int k = 1; k < 4; ++k) {
    uint code = texelFetch(codes, min(at + ivec2(k & 1, k >> 1), last), 0).r;
    least = min(least, code);
    most = max(most, code);
  }
  bool agrees = least == most;
  if (!agrees && least != 0u)
    agrees = unpackHalf2x16(most - 1u).x <= (1.0 + agree) * unpackHalf2x16(least - 1u).x;
  out_codes = uvec4(agrees ? own : own | 0x8000u, most, 0u, 0u);
}
`;

const kWeightFragment = `#version 300 es
precision highp float;
uniform sampler2D weights;
layout(location = 0) out vec4 out_color;
void main() {
  out_color = vec4(texelFetch(weights, ivec2(gl_FragCoord.xy), 0).r);
}
`;

// A layer of faces from the cube map: a face, and around it one texel of those beside.
const kFaceFragment = `#version 300 es
precision highp float;
uniform samplerCube cube;
uniform mat3 face;   // right, up, forward
uniform float size;  // texels
layout(location = 0) out vec4 out_color;
void main() {
  vec2 st = 2.0 * (gl_FragCoord.xy - 1.0) / size - 1.0;
  out_color = textureLod(cube, face * vec3(st, 1.0), 0.0);
}
`;

/** Draws into a node's textures. Changes framebuffer, viewport and programs. */
export class NodePainter {
  private readonly framebuffer: WebGLFramebuffer | null;
  private readonly noVertices: WebGLVertexArrayObject | null;
  private readonly weights: WebGLProgram;
  private readonly faces: WebGLProgram;
  private readonly seen: WebGLProgram;
  private readonly asked: WebGLProgram;
  private readonly checked = new Set<WebGLProgram>();

  /** Disparities that differ by the share `agree` are those of one surface. */
  constructor(private readonly gl: WebGL2RenderingContext, private readonly agree: number) {
    this.framebuffer = gl.createFramebuffer();
    this.noVertices = gl.createVertexArray();
    this.weights = beginProgram(gl, "weights", kScreenVertex, kWeightFragment);
    this.faces = beginProgram(gl, "faces", kScreenVertex, kFaceFragment);
    this.seen = beginProgram(gl, "seen", kVertex, kFragment);
    this.asked = beginProgram(gl, "asked", kScreenVertex, kAskedFragment);
  }

  /**
   * Writes what texels count into the alpha of their colours, of a face of a sheet of 3 x 2. Not in
   * the colours' file: browsers that multiply bitmaps by alpha would lose colours where nothing counts.
   */
  writeWeights(sheet: Uint8Array, face: number, size: number, cube: WebGLTexture): void {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, 3 * size);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, size, size, 0, gl.RED, gl.UNSIGNED_BYTE, sheet,
                  size * ((face % 3) + 3 * size * Math.floor(face / 3)));
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, 0);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    this.begin(this.weights, size, size);
    this.attach(gl.TEXTURE_CUBE_MAP_POSITIVE_X + face, cube);
    gl.colorMask(false, false, false, true);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.colorMask(true, true, true, true);
    this.end(gl.TEXTURE_CUBE_MAP_POSITIVE_X + face);
    gl.deleteTexture(texture);
  }

  /** Of a node of which all faces are there: their layers, and what it sees. Its cube map goes. */
  finish(node: StoredNode): void {
    this.writeFaces(node);
    this.drawSeen(node);
  }

  dispose(): void {
    const { gl } = this;
    for (const of of [this.weights, this.faces, this.seen, this.asked]) gl.deleteProgram(of);
    gl.deleteFramebuffer(this.framebuffer);
    gl.deleteVertexArray(this.noVertices);
  }

  private writeFaces(node: StoredNode): void {
    const { gl } = this;
    const { faceSize } = node.level;
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_CUBE_MAP, node.cube);
    this.begin(this.faces, faceSize + 2, faceSize + 2);
    gl.uniform1f(gl.getUniformLocation(this.faces, "size"), faceSize);
    const face = gl.getUniformLocation(this.faces, "face");
    kFaceAxes.forEach((a, f) => {
      gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, node.faces, 0, f);
      gl.uniformMatrix3fv(face, false, [...a.slice(3), ...a.slice(0, 3)]);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    });
    gl.bindTexture(gl.TEXTURE_CUBE_MAP, null);
    gl.deleteTexture(node.cube);
    node.cube = null;
  }

  private drawSeen(node: StoredNode): void {
    const { gl } = this;
    const size = node.level.faceSize, scale = 1 / size;
    const codes = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, codes);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.R16UI, 3 * size, 2 * size);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    this.begin(this.seen, size, size);
    this.attach(gl.TEXTURE_2D, codes);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.bindVertexArray(node.surfaces);
    const right = gl.getUniformLocation(this.seen, "right"), up = gl.getUniformLocation(this.seen, "up");
    for (let f = 0; f < 6; ++f) {
      const a = kFaceAxes[f];
      gl.viewport((f % 3) * size, Math.floor(f / 3) * size, size, size);
      gl.uniform3f(right, a[3] * scale, a[4] * scale, a[5] * scale);
      gl.uniform3f(up, a[6] * scale, a[7] * scale, a[8] * scale);
      const begin = node.surfaceStarts[f], count = node.surfaceStarts[f + 1] - begin;
      if (count > 0) gl.drawElements(gl.TRIANGLES, 3 * count, gl.UNSIGNED_INT, 12 * begin);
    }
    this.begin(this.asked, 3 * size, 2 * size);
    this.attach(gl.TEXTURE_2D, node.seen);
    gl.uniform1f(gl.getUniformLocation(this.asked, "agree"), this.agree);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    this.end(gl.TEXTURE_2D);
    gl.bindTexture(gl.TEXTURE_2D, null);
    gl.deleteTexture(codes);
  }

  private begin(program: WebGLProgram, width: number, height: number): void {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    for (const of of [gl.SCISSOR_TEST, gl.BLEND, gl.STENCIL_TEST, gl.DEPTH_TEST, gl.CULL_FACE])
      gl.disable(of);
    gl.colorMask(true, true, true, true);
    gl.viewport(0, 0, width, height);
    if (!this.checked.has(program)) checkProgram(gl, "a node's textures", program);
    this.checked.add(program);
    gl.useProgram(program);
    gl.bindVertexArray(this.noVertices);
  }

  private attach(target: number, texture: WebGLTexture | null): void {
    const { gl } = this;
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, target, texture, 0);
  }

  // A texture that is drawn must not be attached.
  private end(target: number): void {
    const { gl } = this;
    gl.bindVertexArray(null);
    this.attach(target, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }
}
