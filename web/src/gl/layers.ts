// Layers as large as the frame, colour (RGBA8) and depth (32 bits), in two texture arrays.

import { WalkError } from "../errors.js";

export class Layers {
  colors: WebGLTexture | null = null;
  depths: WebGLTexture | null = null;
  private framebuffers: WebGLFramebuffer[] = [];
  private width = 0;
  private height = 0;

  constructor(private readonly gl: WebGL2RenderingContext) {}

  /** At least `count` of them; allocates nothing if they are there. */
  make(width: number, height: number, count: number): void {
    if (width === this.width && height === this.height && count <= this.framebuffers.length) return;
    const { gl } = this;
    this.drop();
    const texture = (format: number) => {
      const made = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, made);
      gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, format, width, height, count);
      for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
        gl.texParameteri(gl.TEXTURE_2D_ARRAY, name, gl.NEAREST);
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, null);
      return made;
    };
    this.colors = texture(gl.RGBA8);
    this.depths = texture(gl.DEPTH_COMPONENT32F);
    for (let i = 0; i < count; ++i) {
      const framebuffer = gl.createFramebuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
      gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, this.colors, 0, i);
      gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, this.depths, 0, i);
      if (framebuffer) this.framebuffers.push(framebuffer);
    }
    const status = gl.checkFramebufferStatus(gl.FRAMEBUFFER);
    if (status !== gl.FRAMEBUFFER_COMPLETE && !gl.isContextLost()) {
      this.drop();
      throw new WalkError("WebGL", `there is no memory for frames of ${width} x ${height}`);
    }
    this.width = width;
    this.height = height;
  }

  /** The state in which surfaces are drawn into layers, whatever a host has left. */
  prepare(width: number, height: number): void {
    const { gl } = this;
    gl.viewport(0, 0, width, height);
    gl.disable(gl.SCISSOR_TEST);
    gl.disable(gl.BLEND);
    gl.disable(gl.STENCIL_TEST);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
    gl.colorMask(true, true, true, true);
    gl.frontFace(gl.CCW);
    gl.cullFace(gl.BACK);
    gl.clearColor(0, 0, 0, 0);
    gl.clearDepth(1);
  }

  /** Binds a layer and clears it. */
  begin(layer: number): void {
    const { gl } = this;
    this.bind(layer);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  bind(layer: number): void {
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, this.framebuffers[layer]);
  }

  get bytes(): number {
    return 8 * this.width * this.height * this.framebuffers.length;
  }

  drop(): void {
    const { gl } = this;
    for (const framebuffer of this.framebuffers) gl.deleteFramebuffer(framebuffer);
    this.framebuffers = [];
    gl.deleteTexture(this.colors);
    gl.deleteTexture(this.depths);
    this.colors = this.depths = null;
    this.width = this.height = 0;
  }
}
