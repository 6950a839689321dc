// What is drawn into a node's textures once, when it comes. What it sees in each direction, for those who ask whether it sees through a place (S3.7): its
// disparities, drawn from its own mesh as its own eye sees it, where surfaces cover each texel once.
// Nothing of it is in a file.

import { kFaceAxes } from "../choose.js";
import { compile } from "./program.js";
import type { StoredNode } from "./node-store.js";

// A side lies on the plane in front of its face, so that disparity is linear in the face. What is
// stored is the code of a disparity as the bits of a half float, 11 of them exact, plus 1; 0 is
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

const kWeightVertex = `#version 300 es
void main() {
  gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
                     1.0);
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

// Before something is drawn into a texture.
function plainState(gl: WebGL2RenderingContext): void {
  for (const of of [gl.SCISSOR_TEST, gl.BLEND, gl.STENCIL_TEST, gl.DEPTH_TEST, gl.CULL_FACE])
    gl.disable(of);
}

/**
 * Writes what texels count into the alpha of their colours. Not in the colours' file: browsers that
 * multiply bitmaps by alpha would lose colours where nothing counts.
 */
export class WeightWriter {
  private readonly program: WebGLProgram;
  private readonly framebuffer: WebGLFramebuffer | null;
  private readonly vertices: WebGLVertexArrayObject | null;

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.program = compile(gl, "weights", kWeightVertex, kWeightFragment);
    this.framebuffer = gl.createFramebuffer();
    this.vertices = gl.createVertexArray();
  }

  /** Of a face of a sheet of 3 x 2. Changes framebuffer, viewport and programs. */
  write(sheet: Uint8Array, face: number, size: number, faces: WebGLTexture): void {
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
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0,
                            gl.TEXTURE_CUBE_MAP_POSITIVE_X + face, faces, 0);
    plainState(gl);
    gl.colorMask(false, false, false, true);
    gl.viewport(0, 0, size, size);
    gl.useProgram(this.program);
    gl.bindVertexArray(this.vertices);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
    gl.colorMask(true, true, true, true);
    // A texture that is drawn must not be attached.
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0,
                            gl.TEXTURE_CUBE_MAP_POSITIVE_X + face, null, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteTexture(texture);
  }

  dispose(): void {
    this.gl.deleteProgram(this.program);
    this.gl.deleteFramebuffer(this.framebuffer);
    this.gl.deleteVertexArray(this.vertices);
  }
}

export class SeenDrawer {
  private readonly program: WebGLProgram;
  private readonly right: WebGLUniformLocation | null;
  private readonly up: WebGLUniformLocation | null;
  private readonly framebuffer: WebGLFramebuffer | null;

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.program = compile(gl, "seen", kVertex, kFragment);
    this.right = gl.getUniformLocation(this.program, "right");
    this.up = gl.getUniformLocation(this.program, "up");
    this.framebuffer = gl.createFramebuffer();
  }

  /** Draws what a node sees into its `seen`. Changes framebuffer, viewport and programs. */
  draw(node: StoredNode): void {
    const { gl } = this;
    const size = node.level.faceSize, scale = 1 / size;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, node.seen, 0);
    plainState(gl);
    gl.colorMask(true, true, true, true);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.useProgram(this.program);
    gl.bindVertexArray(node.surfaces);
    for (let f = 0; f < 6; ++f) {
      const a = kFaceAxes[f];
      gl.viewport((f % 3) * size, Math.floor(f / 3) * size, size, size);
      gl.uniform3f(this.right, a[3] * scale, a[4] * scale, a[5] * scale);
      gl.uniform3f(this.up, a[6] * scale, a[7] * scale, a[8] * scale);
      const begin = node.surfaceStarts[f], count = node.surfaceStarts[f + 1] - begin;
      if (count > 0) gl.drawElements(gl.TRIANGLES, 3 * count, gl.UNSIGNED_INT, 12 * begin);
    }
    gl.bindVertexArray(null);
    // A texture that is drawn must not be attached.
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, null, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  dispose(): void {
    this.gl.deleteProgram(this.program);
    this.gl.deleteFramebuffer(this.framebuffer);
  }
}
