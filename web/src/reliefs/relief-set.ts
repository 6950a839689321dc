// Layered reliefs of one object: the one that faces the eye most is warped for it, and drawn into a
// layer of the frame as a node's surfaces are.

import type { Decoder } from "../decoder.js";
import { WalkError, asWalkError } from "../errors.js";
import { clipFromLocal, compile, kScreenVertex, type View } from "../gl/program.js";
import type { ReliefsEntry } from "../manifest.js";
import { bitmapOf, type Pictures, type PicturesHost } from "../views/pictures.js";
import {
  kHalveFragment, kPinholeFragment, kShowFragment, kShowVertex, kSplatFragment, kSplatVertex,
} from "./relief-shaders.js";
import { kSampleWords, blocksAcross } from "./samples.js";
import { ReliefWarp } from "./warp.js";

interface Slot {
  readonly warp: ReliefWarp;
  readonly bytes: number;
  coming: boolean;
  failed: boolean;
  lastUsed: number;
  next: { samples: Uint16Array; colors: ImageBitmap } | null;
  stored: { vertices: WebGLVertexArrayObject; buffer: WebGLBuffer; sheet: WebGLTexture } | null;
}

interface Target {
  readonly color: WebGLTexture;
  readonly code: WebGLTexture;
  readonly framebuffer: WebGLFramebuffer;
}

interface Program {
  readonly program: WebGLProgram;
  readonly at: Record<string, WebGLUniformLocation | null>;
}

const kUniforms = ["warp", "frame", "order", "limits", "place", "clip_from_local", "forward_near",
                   "corner", "right", "down"];
const kEmpty = new Uint32Array([65535, 0, 0, 0]), kClear = new Float32Array(4), kFar = new Float32Array([1]);
const kStep = 256;

export class ReliefSet implements Pictures {
  readonly stats = { drawCalls: 0, triangles: 0, there: 0 };
  private readonly slots: Slot[];
  private readonly splat: Program;
  private readonly pinhole: Program;
  private readonly halve: Program;
  private readonly board: Program;
  private readonly noVertices: WebGLVertexArrayObject | null;
  private targets: Target[] = [];
  private depth: WebGLRenderbuffer | null = null;
  private splatBuffer: WebGLFramebuffer | null = null;
  private width = 0;
  private height = 0;
  private readonly clip = new Float32Array(16);
  private readonly coefficients = new Float32Array(12);
  /** What prepare() made: of which slot, where, how large. */
  private shown = -1;
  private result: Target | null = null;
  private level = 0;
  private wide = 0;
  private high = 0;
  private frame = 0;
  private best = -1;
  private used = 0;
  private disposed = false;

  constructor(private readonly gl: WebGL2RenderingContext, entry: ReliefsEntry,
              private readonly decoder: Decoder, private readonly host: PicturesHost) {
    this.slots = entry.list.map((of) => ({
      warp: new ReliefWarp(of, entry),
      bytes: 4 * of.sheetWidth * of.sheetHeight + 2 * kSampleWords * of.samples,
      coming: false, failed: false, lastUsed: 0, next: null, stored: null,
    }));
    this.splat = this.link("splats", kSplatVertex, kSplatFragment);
    this.pinhole = this.link("pinholes", kScreenVertex, kPinholeFragment);
    this.halve = this.link("halves", kScreenVertex, kHalveFragment);
    this.board = this.link("relief", kShowVertex, kShowFragment);
    this.noVertices = gl.createVertexArray();
  }

  get bytes(): number {
    // Two colours and codes, and one depth.
    return this.used + 16 * this.width * this.height;
  }

  get allFailed(): boolean {
    return this.slots.every((slot) => slot.failed);
  }

  get settled(): boolean {
    return this.best < 0 || this.slots[this.best].stored !== null || this.slots[this.best].failed;
  }

  update(x: number, y: number, z: number): void {
    ++this.frame;
    this.best = this.pick(x, y, z, false);
    this.upload();
    let coming = 0;
    for (const slot of this.slots) if (slot.coming || slot.next) ++coming;
    if (this.best >= 0) this.want(this.best, true);
    for (let i = 0; i < this.slots.length && coming < 1; ++i) if (this.want(i, false)) ++coming;
  }

  /** Warps what a frame shows. */
  prepare(view: View): void {
    const { gl, stats, slots } = this, e = view.worldFromEye;
    stats.drawCalls = stats.triangles = 0;
    this.shown = this.pick(e[12], e[13], e[14], true);
    if (this.shown < 0) return;
    const { warp, stored } = slots[this.shown];
    slots[this.shown].lastUsed = this.frame;
    if (!stored || !warp.place(e[12], e[13], e[14]) || !warp.show(view)) {
      this.shown = -1;
      return;
    }
    const margin = Math.min(64, Math.ceil(0.5 * warp.widest) + 1);
    const x = warp.shown[0], y = warp.shown[1];
    this.wide = warp.shown[2] - x;
    this.high = warp.shown[3] - y;
    this.makeTargets(this.wide + 2 * margin, this.high + 2 * margin);
    gl.disable(gl.SCISSOR_TEST);
    gl.disable(gl.BLEND);
    gl.disable(gl.STENCIL_TEST);
    gl.disable(gl.CULL_FACE);
    gl.colorMask(true, true, true, true);
    this.drawSplats(warp, stored, x - margin, y - margin, this.wide + 2 * margin,
                    this.high + 2 * margin);
    gl.disable(gl.DEPTH_TEST);
    gl.bindVertexArray(this.noVertices);
    gl.useProgram(this.pinhole.program);
    gl.uniform4i(this.pinhole.at.place, margin, margin, warp.pinholeStep, 0);
    this.pass(0, 1, this.wide, this.high);
    this.level = warp.level(view);
    let from = 1;
    for (let k = 0; k < this.level; ++k, from = 1 - from) {
      gl.useProgram(this.halve.program);
      gl.uniform4i(this.halve.at.place, this.wide, this.high, 0, 0);
      this.wide = (this.wide + 1) >> 1;
      this.high = (this.high + 1) >> 1;
      this.pass(from, 1 - from, this.wide, this.high);
    }
    gl.bindVertexArray(null);
    this.result = this.targets[from];
  }

  /** Draws what prepare() made. */
  draw(view: View, near: number): void {
    const { gl, stats, result } = this;
    if (this.shown < 0 || !result) return;
    const { warp } = this.slots[this.shown];
    const { at, program } = this.board, e = view.worldFromEye, s = warp.resolution;
    const { a, b, g, forward, shown } = warp;
    clipFromLocal(view, this.clip);
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.clip_from_local, false, this.clip);
    gl.uniform4f(at.forward_near, -e[8], -e[9], -e[10], near);
    const x = shown[0] / s, y = shown[1] / s;
    gl.uniform4f(at.corner, g[0] + x * a[0] + y * b[0], g[1] + x * a[1] + y * b[1],
                 g[2] + x * a[2] + y * b[2],
                 g[0] * forward[0] + g[1] * forward[1] + g[2] * forward[2]);
    const w = (this.wide << this.level) / s, h = (this.high << this.level) / s;
    gl.uniform4f(at.right, w * a[0], w * a[1], w * a[2], this.wide);
    gl.uniform4f(at.down, h * b[0], h * b[1], h * b[2], this.high);
    gl.uniform4f(at.place, this.wide, this.high, warp.zNear, warp.zFar);
    this.bind(result);
    gl.bindVertexArray(this.noVertices);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.bindVertexArray(null);
    ++stats.drawCalls;
    stats.triangles += 2;
  }

  dispose(): void {
    const { gl } = this;
    this.disposed = true;
    for (const slot of this.slots) {
      slot.next?.colors.close();
      this.drop(slot);
    }
    this.dropTargets();
    for (const of of [this.splat, this.pinhole, this.halve, this.board]) gl.deleteProgram(of.program);
    gl.deleteVertexArray(this.noVertices);
  }

  private link(name: string, vertex: string, fragment: string): Program {
    const { gl } = this;
    const program = compile(gl, name, vertex, fragment);
    gl.useProgram(program);
    gl.uniform1i(gl.getUniformLocation(program, "codes"), 1);
    return {
      program,
      at: Object.fromEntries(kUniforms.map((of) => [of, gl.getUniformLocation(program, of)])),
    };
  }

  // The one that faces the eye most, of those that can surely be warped as a whole; else of those
  // that can; else one of which something is seen: pick_relief() of relief_bound.h and relief_set.h.
  private pick(x: number, y: number, z: number, there: boolean): number {
    let best = -1, most = -Infinity;
    for (let i = 0; i < this.slots.length; ++i) {
      const { warp, stored, failed } = this.slots[i];
      if (there ? !stored : failed) continue;
      if (!warp.place(x, y, z)) continue;
      const sure = warp.isSure(x, y, z), whole = warp.facing(x, y, z);
      const rank = sure ? 8 + warp.along(x, y, z) : whole >= 0 ? 4 + whole : -i;
      if (rank <= most) continue;
      most = rank;
      best = i;
    }
    return best;
  }

  // Begins to load a relief: did it?
  private want(i: number, needed: boolean): boolean {
    const slot = this.slots[i];
    if (slot.stored || slot.coming || slot.failed || slot.next) return false;
    while (this.used + slot.bytes > this.host.budget) {
      let oldest: Slot | null = null;
      for (const of of this.slots)
        if (of.stored && (!oldest || of.lastUsed < oldest.lastUsed)) oldest = of;
      if (!needed) return false;
      if (!oldest) break;
      this.drop(oldest);
    }
    slot.coming = true;
    this.used += slot.bytes;
    void this.load(i);
    return true;
  }

  private drop(slot: Slot): void {
    const { gl } = this;
    if (!slot.stored) return;
    gl.deleteVertexArray(slot.stored.vertices);
    gl.deleteBuffer(slot.stored.buffer);
    gl.deleteTexture(slot.stored.sheet);
    slot.stored = null;
    this.used -= slot.bytes;
    --this.stats.there;
  }

  private async load(i: number): Promise<void> {
    const slot = this.slots[i], { of } = slot.warp;
    let colors: ImageBitmap | null = null;
    try {
      const samplesCome = Promise.all([of.layers, of.codes].map((file) => this.host.fetch(file)))
        .then(async ([layers, codes]) => this.decoder.samples(
          codes, of.codes.name, of,
          await this.decoder.plane16(layers, of.layers, blocksAcross(of.width), blocksAcross(of.height))));
      const colorsCome = this.host.fetch(of.colors).then(async (bytes) => {
        colors = await bitmapOf(await this.decoder.check(bytes, of.colors), of.colors,
                                of.sheetWidth, of.sheetHeight);
      });
      const [samples] = await Promise.all([samplesCome, colorsCome]);
      if (this.disposed) throw new WalkError("walk", "was disposed of");
      slot.next = { samples, colors: colors as unknown as ImageBitmap };
      this.host.arrived();
    } catch (error) {
      (colors as ImageBitmap | null)?.close();
      if (this.disposed) return;
      slot.failed = true;
      this.used -= slot.bytes;
      this.host.failed(asWalkError(error, `relief ${i}`));
    } finally {
      slot.coming = false;
    }
  }

  private upload(): void {
    const { gl } = this;
    let i = 0;
    while (i < this.slots.length && !this.slots[i].next) ++i;
    if (i === this.slots.length) return;
    const slot = this.slots[i], { samples, colors } = slot.next as NonNullable<Slot["next"]>;
    slot.next = null;
    const sheet = texture(gl, gl.RGBA8, colors.width, colors.height);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, gl.RGBA, gl.UNSIGNED_BYTE, colors);
    gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.BROWSER_DEFAULT_WEBGL);
    gl.bindTexture(gl.TEXTURE_2D, null);
    colors.close();
    const vertices = gl.createVertexArray() as WebGLVertexArrayObject;
    const buffer = gl.createBuffer() as WebGLBuffer;
    gl.bindVertexArray(vertices);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, samples, gl.STATIC_DRAW);
    for (const [location, words, first] of [[0, 4, 0], [1, 2, 4]]) {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribIPointer(location, words, gl.UNSIGNED_SHORT, 2 * kSampleWords, 2 * first);
    }
    gl.bindVertexArray(null);
    slot.stored = { vertices, buffer, sheet };
    ++this.stats.there;
    this.host.loaded(i);
  }

  private drawSplats(warp: ReliefWarp, stored: NonNullable<Slot["stored"]>, x: number, y: number,
                     width: number, height: number): void {
    const { gl, stats } = this, { of, k1, k2, k3 } = warp, { at } = this.splat;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.splatBuffer);
    gl.viewport(0, 0, width, height);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LESS);
    gl.depthMask(true);
    gl.clearBufferfv(gl.COLOR, 0, kClear);
    gl.clearBufferuiv(gl.COLOR, 1, kEmpty);
    gl.clearBufferfv(gl.DEPTH, 0, kFar);
    gl.useProgram(this.splat.program);
    warp.coefficients(this.coefficients);
    gl.uniform4fv(at.warp, this.coefficients);
    gl.uniform4f(at.frame, x, y, width, height);
    // The epipole; beyond the picture it may as well lie beside it.
    const span = Math.max(of.width, of.height) + 2;
    const column = Math.max(-1, Math.min(of.width, Math.floor(k1 / k3)));
    const row = Math.max(-1, Math.min(of.height, Math.floor(k2 / k3)));
    gl.uniform4i(at.order, column, row, span, k3 < 0 ? 1 : 0);
    // Floats from 2^-126 to 1 have so many bits.
    gl.uniform2i(at.limits, warp.leastCode,
                 Math.max(1, Math.min(64, Math.floor(0x3e800000 / ((span + 1) * span)))));
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, stored.sheet);
    gl.bindVertexArray(stored.vertices);
    gl.drawArrays(gl.POINTS, 0, of.samples);
    ++stats.drawCalls;
    stats.triangles += of.samples;
  }

  private bind(of: Target): void {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, of.code);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, of.color);
  }

  private pass(from: number, to: number, width: number, height: number): void {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.targets[to].framebuffer);
    gl.viewport(0, 0, width, height);
    this.bind(this.targets[from]);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    ++this.stats.drawCalls;
    ++this.stats.triangles;
  }

  private makeTargets(width: number, height: number): void {
    if (width <= this.width && height <= this.height) return;
    const { gl } = this;
    const up = (n: number, least: number) => Math.max(least, Math.ceil(n / kStep) * kStep);
    const w = up(width, this.width), h = up(height, this.height);
    this.dropTargets();
    for (let k = 0; k < 2; ++k) {
      const color = texture(gl, gl.RGBA8, w, h, gl.LINEAR), code = texture(gl, gl.R16UI, w, h);
      this.targets.push({ color, code, framebuffer: this.framebuffer(color, code) });
    }
    this.splatBuffer = this.framebuffer(this.targets[0].color, this.targets[0].code);
    this.depth = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, this.depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT32F, w, h);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.depth);
    gl.bindTexture(gl.TEXTURE_2D, null);
    this.width = w;
    this.height = h;
  }

  private framebuffer(color: WebGLTexture, code: WebGLTexture): WebGLFramebuffer {
    const { gl } = this;
    const made = gl.createFramebuffer() as WebGLFramebuffer;
    gl.bindFramebuffer(gl.FRAMEBUFFER, made);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, color, 0);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT1, gl.TEXTURE_2D, code, 0);
    gl.drawBuffers([gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1]);
    return made;
  }

  private dropTargets(): void {
    const { gl } = this;
    for (const of of this.targets) {
      gl.deleteTexture(of.color);
      gl.deleteTexture(of.code);
      gl.deleteFramebuffer(of.framebuffer);
    }
    this.targets = [];
    this.result = null;
    gl.deleteFramebuffer(this.splatBuffer);
    gl.deleteRenderbuffer(this.depth);
    this.width = this.height = 0;
  }
}

function texture(gl: WebGL2RenderingContext, format: number, width: number, height: number,
                 filter: number = gl.NEAREST): WebGLTexture {
  const made = gl.createTexture() as WebGLTexture;
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
    gl.texParameteri(gl.TEXTURE_2D, name, filter);
  return made;
}
