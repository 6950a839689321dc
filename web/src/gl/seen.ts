// What a node sees in each direction, for those who ask whether it sees through a place (S3.7): its
// disparities, drawn from its own mesh as its own eye sees it, where surfaces cover each texel once.
// Nothing of it is in a file.

import { kFaceAxes } from "../choose.js";
import { compile } from "./shaders.js";
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
    for (const of of [gl.SCISSOR_TEST, gl.BLEND, gl.STENCIL_TEST, gl.DEPTH_TEST, gl.CULL_FACE])
      gl.disable(of);
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
