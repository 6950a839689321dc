// Pictures with depth that are drawn together: those of a layered impostor, or nailboards. Each is a
// layer of texture arrays. What is drawn lies in a layer of the frame as a node's surfaces do.

import type { Decoder } from "../decoder.js";
import { WalkError, asWalkError } from "../errors.js";
import { clipFromLocal, compile, type View } from "../gl/program.js";
import type { PicturesEntry } from "../manifest.js";
import { bitmapOf, type Pictures, type PicturesHost } from "./pictures.js";
import { kBoardFloats, kBoardFragment, kBoardVertex } from "./board-shaders.js";
import { kMostViews, kViewFragment, kViewVectors, kViewVertex } from "./shaders.js";
import { cellLayout, kLevels, type ViewSurface } from "./surface.js";

interface Slot {
  /** In the texture arrays; -1: not there. */
  layer: number;
  coming: boolean;
  failed: boolean;
  /** The frame of which it was one of the nearest. */
  lastUsed: number;
  key: number;
  next: { surface: ViewSurface; colors: ImageBitmap } | null;
}

interface Program {
  readonly program: WebGLProgram;
  readonly at: Record<string, WebGLUniformLocation | null>;
}

// Bytes of a texel: colour and code; slopes and links of surfaces, and cells, less than one each.
const kBoardBytes = 4 + 2, kSurfaceBytes = kBoardBytes + 8 + 1 + 1;
const kTextures = ["color", "code", "slope", "links", "cell"] as const;
type TextureName = (typeof kTextures)[number];
const kUniforms = [
  "clip_from_local", "box_min", "box_max", "view_data", "view_weights", "view_says",
  "view_counts", "forward_near",
];

export class PictureSet implements Pictures {
  readonly stats = { drawCalls: 0, triangles: 0, there: 0, drawn: 0 };
  readonly bytes: number;
  private readonly slots: Slot[];
  private readonly order: Uint32Array;
  private readonly surfaces: boolean;
  private readonly width: number;
  private readonly height: number;
  private readonly layers: number;
  private readonly textures: Partial<Record<TextureName, WebGLTexture>> = {};
  private readonly program: Program;
  private readonly vertices: WebGLVertexArrayObject | null;
  private readonly instances: WebGLBuffer | null = null;
  private readonly boardData: Float32Array;
  private readonly viewData = new Float32Array(4 * kViewVectors * kMostViews);
  private readonly weights = new Float32Array(kMostViews);
  private readonly says = new Float32Array(2 * kMostViews);
  private readonly shown = new Int32Array(kMostViews);
  private readonly clip = new Float32Array(16);
  private frame = 0;
  private disposed = false;

  constructor(private readonly gl: WebGL2RenderingContext, private readonly entry: PicturesEntry,
              private readonly decoder: Decoder, private readonly host: PicturesHost) {
    const { list } = entry;
    this.surfaces = entry.drawn === "surfaces";
    this.width = Math.max(...list.map((of) => of.width));
    this.height = Math.max(...list.map((of) => of.height));
    const layerBytes = this.width * this.height * (this.surfaces ? kSurfaceBytes : kBoardBytes);
    this.layers = Math.min(list.length, gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS) as number,
                           Math.max(kMostViews, Math.floor(host.budget / layerBytes)));
    this.bytes = this.layers * layerBytes;
    this.slots = list.map(() => ({
      layer: -1, coming: false, failed: false, lastUsed: 0, key: 0, next: null,
    }));
    this.order = Uint32Array.from(list, (_, i) => i);
    this.boardData = new Float32Array(this.surfaces ? 0 : kBoardFloats * this.layers);
    this.makeTextures();
    this.vertices = gl.createVertexArray();
    if (this.surfaces) {
      this.program = this.link("views", kViewVertex, kViewFragment);
      const levels = cellLayout(this.width, this.height).levelAt;
      gl.uniform1iv(gl.getUniformLocation(this.program.program, "level_at"), levels);
    } else {
      this.program = this.link("boards", kBoardVertex, kBoardFragment);
      this.instances = gl.createBuffer();
      gl.bindVertexArray(this.vertices);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
      gl.bufferData(gl.ARRAY_BUFFER, this.boardData.byteLength, gl.DYNAMIC_DRAW);
      for (let i = 0; i < kBoardFloats / 4; ++i) {
        gl.enableVertexAttribArray(i);
        gl.vertexAttribPointer(i, 4, gl.FLOAT, false, 4 * kBoardFloats, 16 * i);
        gl.vertexAttribDivisor(i, 1);
      }
      gl.bindVertexArray(null);
    }
  }

  update(x: number, y: number, z: number): void {
    ++this.frame;
    this.sort(x, y, z);
    this.upload();
    let coming = 0;
    for (const slot of this.slots) if (slot.coming || slot.next) ++coming;
    for (let k = 0; k < this.layers && coming < 2; ++k) {
      const i = this.order[k], slot = this.slots[i];
      if (slot.layer >= 0 || slot.coming || slot.failed || slot.next) continue;
      slot.coming = true;
      ++coming;
      void this.load(i);
    }
  }

  get settled(): boolean {
    const needed = this.surfaces ? Math.min(kMostViews, this.slots.length) : this.layers;
    for (let k = 0; k < needed; ++k) {
      const slot = this.slots[this.order[k]];
      if (slot.layer < 0 && !slot.failed) return false;
    }
    return true;
  }

  get allFailed(): boolean {
    return this.slots.every((slot) => slot.failed);
  }

  prepare(): void {}

  draw(view: View, near: number): void {
    const { gl, stats } = this;
    stats.drawCalls = stats.triangles = stats.drawn = 0;
    if (stats.there === 0) return;
    clipFromLocal(view, this.clip);
    const e = view.worldFromEye;
    gl.useProgram(this.program.program);
    const { at } = this.program;
    gl.uniformMatrix4fv(at.clip_from_local, false, this.clip);
    gl.uniform4f(at.forward_near, -e[8], -e[9], -e[10], near);
    this.bind();
    gl.bindVertexArray(this.vertices);
    if (this.surfaces) this.drawSurfaces(e);
    else this.drawBoards(e);
    gl.bindVertexArray(null);
    stats.drawCalls = 1;
  }

  dispose(): void {
    const { gl } = this;
    this.disposed = true;
    for (const slot of this.slots) slot.next?.colors.close();
    for (const texture of Object.values(this.textures)) gl.deleteTexture(texture);
    gl.deleteProgram(this.program.program);
    gl.deleteVertexArray(this.vertices);
    gl.deleteBuffer(this.instances);
  }

  private link(name: string, vertex: string, fragment: string): Program {
    const { gl } = this;
    const program = compile(gl, name, vertex, fragment);
    gl.useProgram(program);
    kTextures.forEach((texture, unit) =>
      gl.uniform1i(gl.getUniformLocation(program, `${texture}_texture`), unit));
    return {
      program,
      at: Object.fromEntries(kUniforms.map((of) => [of, gl.getUniformLocation(program, of)])),
    };
  }

  private makeTextures(): void {
    const { gl, width, height } = this;
    const make = (name: TextureName, format: number, w = width, h = height,
                  filter: number = gl.NEAREST) => {
      const made = gl.createTexture() as WebGLTexture;
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, made);
      gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, format, w, h, this.layers);
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, filter);
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MAG_FILTER, filter);
      this.textures[name] = made;
    };
    make("color", gl.RGBA8, width, height, gl.LINEAR);
    make("code", gl.R16UI);
    if (this.surfaces) {
      const cells = cellLayout(width, height);
      make("slope", gl.RG32UI);
      make("links", gl.R8UI);
      make("cell", gl.RG32F, cells.columns, cells.rows);
    }
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, null);
  }

  private bind(): void {
    const { gl, textures } = this;
    for (let unit = 0; unit < kTextures.length; ++unit) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, textures[kTextures[unit]] ?? null);
    }
    gl.activeTexture(gl.TEXTURE0);
  }

  // The best first: pictures for viewers in the eye's direction, or taken near the eye.
  private sort(x: number, y: number, z: number): void {
    const { entry, order, slots } = this;
    const c = entry.center;
    for (let i = 0; i < order.length; ++i) {
      const of = entry.list[i], m = of.worldFromEye, d = of.direction;
      const key = this.surfaces
        ? -(d[0] * (x - c[0]) + d[1] * (y - c[1]) + d[2] * (z - c[2]))
        : Math.hypot(m[12] - x, m[13] - y, m[14] - z);
      slots[i].key = key;
      let at = i;
      for (; at > 0 && slots[order[at - 1]].key > key; --at) order[at] = order[at - 1];
      order[at] = i;
    }
    for (let k = 0; k < this.layers; ++k) slots[order[k]].lastUsed = this.frame;
  }

  private async load(i: number): Promise<void> {
    const slot = this.slots[i], of = this.entry.list[i];
    let colors: ImageBitmap | null = null;
    try {
      const depthsCome = this.host.fetch(of.depths).then((bytes) =>
        this.decoder.view(bytes, of.depths, {
          width: of.width, height: of.height, du: of.du, dv: of.dv, least: of.depths.least,
          step: of.depths.step, sigma: of.backPerspective ? -1 : 1,
          links: this.surfaces ? this.entry.links : null,
        }));
      const colorsCome = this.host.fetch(of.colors).then(async (bytes) => {
        colors = await bitmapOf(await this.decoder.check(bytes, of.colors), of.colors, of.width,
                                of.height);
      });
      const [surface] = await Promise.all([depthsCome, colorsCome]);
      if (this.disposed) throw new WalkError("walk", "was disposed of");
      slot.next = { surface, colors: colors as unknown as ImageBitmap };
      this.host.arrived();
    } catch (error) {
      (colors as ImageBitmap | null)?.close();
      if (this.disposed) return;
      slot.failed = true;
      this.host.failed(asWalkError(error, `picture ${i}`));
    } finally {
      slot.coming = false;
    }
  }

  // A layer that is free, or that of the picture which was not among the best for longest.
  private freeLayer(): number {
    const taken = new Set(this.slots.map((slot) => slot.layer));
    for (let layer = 0; layer < this.layers; ++layer) if (!taken.has(layer)) return layer;
    const oldest = this.slots.filter((slot) => slot.layer >= 0)
      .reduce((a, b) => (b.lastUsed < a.lastUsed ? b : a));
    const { layer } = oldest;
    oldest.layer = -1;
    --this.stats.there;
    return layer;
  }

  private upload(): void {
    const { gl, textures } = this;
    let i = 0;
    while (i < this.slots.length && !this.slots[i].next) ++i;
    if (i === this.slots.length) return;
    const slot = this.slots[i], of = this.entry.list[i];
    const { surface, colors } = slot.next as NonNullable<Slot["next"]>;
    slot.next = null;
    const layer = this.freeLayer();
    const { width: w, height: h } = of;
    const store = (name: TextureName, format: number, type: number, data: ArrayBufferView,
                   columns = w, rows = h) => {
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, textures[name] ?? null);
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, layer, columns, rows, 1, format, type, data);
    };
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, textures.color ?? null);
    gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, layer, w, h, 1, gl.RGBA, gl.UNSIGNED_BYTE, colors);
    gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.BROWSER_DEFAULT_WEBGL);
    colors.close();
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    store("code", gl.RED_INTEGER, gl.UNSIGNED_SHORT, surface.codes);
    if (this.surfaces) {
      store("slope", gl.RG_INTEGER, gl.UNSIGNED_INT, surface.slopes);
      store("links", gl.RED_INTEGER, gl.UNSIGNED_BYTE, surface.links);
      this.storeCells(layer, w, h, surface.cells);
    }
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, null);
    slot.layer = layer;
    ++this.stats.there;
    this.host.loaded(i);
  }

  // Each level to where the largest picture's begins.
  private storeCells(layer: number, w: number, h: number, cells: Float32Array): void {
    const { gl } = this;
    const from = cellLayout(w, h), to = cellLayout(this.width, this.height);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.textures.cell ?? null);
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, from.columns);
    for (let level = 0; level < kLevels; ++level) {
      const columns = (from.levelAt[level + 1] ?? from.columns) - from.levelAt[level];
      gl.pixelStorei(gl.UNPACK_SKIP_PIXELS, from.levelAt[level]);
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, to.levelAt[level], 0, layer, columns, from.rows, 1,
                       gl.RG, gl.FLOAT, cells);
    }
    gl.pixelStorei(gl.UNPACK_SKIP_PIXELS, 0);
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, 0);
  }

  private drawSurfaces(e: ArrayLike<number>): void {
    const { gl, entry, slots, stats } = this;
    const { at } = this.program;
    // Those that are there of the nearest, and how they fade (handover_weights()).
    let count = 0, weighty = 0, sum = 0;
    const c = entry.center;
    const length = Math.hypot(e[12] - c[0], e[13] - c[1], e[14] - c[2]) || 1;
    let nearest = 0;
    for (let k = 0; k < this.order.length && count < kMostViews; ++k) {
      const i = this.order[k];
      if (slots[i].layer < 0) continue;
      const angle = Math.acos(Math.max(-1, Math.min(1, -slots[i].key / length)));
      if (count === 0) nearest = angle;
      const weight = count === 0 ? 1
        : entry.handover > 0 ? Math.max(0, 1 - (angle - nearest) / entry.handover) : 0;
      if (weight > 0) ++weighty;
      this.weights[count] = weight;
      this.says[2 * count] = entry.list[i].complete ? 1 : 0;
      this.says[2 * count + 1] = entry.list[i].seesThrough ? 1 : 0;
      this.shown[count++] = i;
      sum += weight;
    }
    for (let k = 0; k < count; ++k) {
      this.weights[k] /= sum;
      this.setView(k, e);
    }
    stats.drawn = count;
    const { low, high } = entry, slack = entry.slack;
    gl.uniform3f(at.box_min, low[0] - slack - e[12], low[1] - slack - e[13], low[2] - slack - e[14]);
    gl.uniform3f(at.box_max, high[0] + slack - e[12], high[1] + slack - e[13], high[2] + slack - e[14]);
    gl.uniform4fv(at.view_data, this.viewData);
    gl.uniform1fv(at.view_weights, this.weights);
    gl.uniform2fv(at.view_says, this.says);
    gl.uniform2i(at.view_counts, count, weighty);
    gl.enable(gl.CULL_FACE);
    gl.cullFace(gl.FRONT);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 14);
    gl.cullFace(gl.BACK);
    gl.disable(gl.CULL_FACE);
    stats.triangles = 12;
  }

  // view_block() of layered_drawer.cpp.
  private setView(k: number, e: ArrayLike<number>): void {
    const i = this.shown[k], of = this.entry.list[i], m = of.worldFromEye, out = this.viewData;
    const { left: l, right: r, bottom: b, top: t } = of;
    const w = of.width, h = of.height, at = 4 * kViewVectors * k;
    let du = 0, dv = 0, dw = 0;
    for (let a = 0; a < 3; ++a) {
      const x = m[a], y = m[4 + a], forward = -m[8 + a], apex = m[12 + a] - e[12 + a];
      const u = ((x - l * forward) * w) / (r - l), v = ((t * forward - y) * h) / (t - b);
      out[at + a] = u;
      out[at + 4 + a] = v;
      out[at + 8 + a] = forward;
      out[at + 12 + a] = apex;
      out[at + 16 + a] = forward + l * x + t * y;
      out[at + 20 + a] = (x * (r - l)) / w;
      out[at + 24 + a] = (-y * (t - b)) / h;
      du -= u * apex;
      dv -= v * apex;
      dw -= forward * apex;
    }
    out[at + 3] = du;
    out[at + 7] = dv;
    out[at + 11] = dw;
    out[at + 15] = of.backPerspective ? -1 : 1;
    out[at + 19] = this.slots[i].layer;
    out[at + 23] = w;
    out[at + 27] = h;
    out[at + 28] = of.zNear;
    out[at + 29] = of.zFar;
    out[at + 30] = of.depths.least;
    out[at + 31] = of.depths.step;
  }

  private drawBoards(e: ArrayLike<number>): void {
    const { gl, entry, slots, stats, boardData: out } = this;
    let count = 0;
    for (let i = 0; i < slots.length; ++i) {
      if (slots[i].layer < 0) continue;
      const of = entry.list[i], m = of.worldFromEye, z = of.planeZ, at = kBoardFloats * count++;
      for (let a = 0; a < 3; ++a) {
        const x = m[a], y = m[4 + a], forward = -m[8 + a];
        out[at + a] = m[12 + a] - e[12 + a];
        out[at + 4 + a] = z * (forward + of.left * x + of.top * y);
        out[at + 8 + a] = z * (of.right - of.left) * x;
        out[at + 12 + a] = -z * (of.top - of.bottom) * y;
      }
      out[at + 3] = slots[i].layer;
      out[at + 7] = z;
      out[at + 11] = of.width;
      out[at + 15] = of.height;
      out[at + 16] = of.depths.least;
      out[at + 17] = of.depths.step;
      out[at + 18] = 1 / this.width;
      out[at + 19] = 1 / this.height;
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, out, 0, kBoardFloats * count);
    gl.disable(gl.CULL_FACE);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
    stats.drawn = count;
    stats.triangles = 2 * count;
  }
}
