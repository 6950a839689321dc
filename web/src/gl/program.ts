// Programs, and what all that draw ask a view.

/** A frame to draw. Matrices column by column; clip space as OpenGL's. */
export interface View {
  readonly worldFromEye: ArrayLike<number>;
  /** A perspective projection, eye space to clip space. */
  readonly clipFromEye: ArrayLike<number>;
  readonly width: number;
  readonly height: number;
  /** The near plane, metres; else that of an OpenGL projection. */
  readonly near?: number;
}

/** A view's near plane, metres. */
export function nearOf(view: View): number {
  const p = view.clipFromEye;
  return view.near ?? Math.abs(p[14] / (p[10] - 1));
}

/** A triangle that covers the viewport. */
export const kScreenVertex = `#version 300 es
void main() {
  gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
                     1.0);
}
`;

/** Begins to make a program, which a browser does beside the page until checkProgram() asks for it. */
export function beginProgram(gl: WebGL2RenderingContext, name: string, vertex: string,
                             fragment: string): WebGLProgram {
  const program = gl.createProgram();
  if (!program) throw new Error(`${name}: the WebGL context is lost`);
  for (const [type, source] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ] as const) {
    const shader = gl.createShader(type);
    if (!shader) throw new Error(`${name}: the WebGL context is lost`);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    gl.deleteShader(shader);
  }
  gl.linkProgram(program);
  return program;
}

export function checkProgram(gl: WebGL2RenderingContext, name: string, program: WebGLProgram): void {
  if (gl.getProgramParameter(program, gl.LINK_STATUS) || gl.isContextLost()) return;
  const logs = (gl.getAttachedShaders(program) ?? []).map((s) => gl.getShaderInfoLog(s));
  throw new Error(`${name}: ${[gl.getProgramInfoLog(program), ...logs].join(" ").trim()}`);
}

export function compile(gl: WebGL2RenderingContext, name: string, vertex: string,
                        fragment: string): WebGLProgram {
  const program = beginProgram(gl, name, vertex, fragment);
  checkProgram(gl, name, program);
  return program;
}

/** From offsets to the eye, along the world's axes, to clip space. */
export function clipFromLocal(view: View, out: Float32Array): void {
  const e = view.worldFromEye, p = view.clipFromEye;
  for (let column = 0; column < 3; ++column)
    for (let row = 0; row < 4; ++row)
      out[4 * column + row] =
        p[row] * e[column] + p[4 + row] * e[4 + column] + p[8 + row] * e[8 + column];
  for (let row = 0; row < 4; ++row) out[12 + row] = p[12 + row];
}
