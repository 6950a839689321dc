// Draws keyframes: the surfaces of each that is mixed into a layer of its own, what fills gaps behind those of the
// best, and one pass that merges the layers.

import { Layers } from "../gl/layers.js";
import { nearOf, type View } from "../gl/program.js";
import { clipFromRaster } from "./camera.js";
import { keyframeProgram, kFillDepth, kFills, mergeProgram } from "./live-shaders.js";
import type { StoredPart } from "./store.js";

/** The most keyframes that are merged. */
export const kMostKeyframes = 3;
// Surfaces are equal if their distances differ by at most this share.
const kTolerance = 0.03;

const enum Range { smooth, beside, skins, apron }

interface Program {
  readonly program: WebGLProgram;
  readonly clip: WebGLUniformLocation | null;
  readonly scales: WebGLUniformLocation | null;
  readonly size: WebGLUniformLocation | null;
}

interface Merge {
  readonly program: WebGLProgram;
  readonly counts: WebGLUniformLocation | null;
  readonly ratio: WebGLUniformLocation | null;
}

/** The pictures of a keyframe that are drawn, and what it counts in the merge. */
export interface DrawnKeyframe {
  readonly parts: readonly StoredPart[];
  readonly count: number;
}

export class KeyframeDrawer {
  readonly stats = { drawCalls: 0, triangles: 0 };
  private readonly layers: Layers;
  private readonly surface: Program;
  private readonly beside: Program;
  private readonly skin: Program;
  private readonly merges: (Merge | null)[] = [];
  private readonly noVertices: WebGLVertexArrayObject | null;
  private readonly clip = new Float32Array(16);
  private readonly scales = new Float32Array(4);
  private readonly size = new Float32Array(4);
  private readonly counts = new Float32Array(kMostKeyframes);
  private drawn = 0;
  /** By how much farther than it is what is drawn seems. */
  private farther = 1;
  private near = 1;

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.layers = new Layers(gl);
    const located = (program: WebGLProgram): Program => {
      gl.useProgram(program);
      gl.uniform1i(gl.getUniformLocation(program, "colors"), 0);
      gl.uniform1i(gl.getUniformLocation(program, "codes"), 1);
      return {
        program, clip: gl.getUniformLocation(program, "clip_from_raster"),
        scales: gl.getUniformLocation(program, "scales"), size: gl.getUniformLocation(program, "size"),
      };
    };
    this.surface = located(keyframeProgram(gl, "SURFACE"));
    this.beside = located(keyframeProgram(gl, "BESIDE"));
    this.skin = located(keyframeProgram(gl, "SKIN"));
    this.noVertices = gl.createVertexArray();
  }

  get bytes(): number {
    return this.layers.bytes;
  }

  /**
   * Draws keyframes, the best first, into a layer each; `spares` into that of the best, which they do not mix with; and
   * there what fills gaps: `fills`, whose surfaces do so before skins. Changes framebuffer, viewport and programs.
   */
  drawLayers(view: View, keyframes: readonly DrawnKeyframe[], spares: readonly DrawnKeyframe[],
             fills: readonly StoredPart[]): void {
    const { gl, layers, stats } = this;
    stats.drawCalls = stats.triangles = 0;
    this.drawn = Math.min(kMostKeyframes, keyframes.length);
    // So near that nothing is cut off where depths cannot be clamped.
    this.near = nearOf(view) / 4;
    layers.make(view.width, view.height, Math.max(1, this.drawn));
    layers.prepare(view.width, view.height);
    for (let i = 0; i < this.drawn; ++i) {
      const { parts, count } = keyframes[i];
      this.counts[i] = count;
      layers.begin(i);
      gl.depthRange(0, kFillDepth);
      // What the eye would see from behind another keyframe's surfaces must not cover what the best one shows.
      if (i > 0) gl.enable(gl.CULL_FACE);
      for (const part of parts) this.drawSurfaces(view, part);
      if (i > 0) continue;
      // From here on the nearest first, so that little is drawn twice.
      gl.enable(gl.CULL_FACE);
      this.farther = 1 + kTolerance;
      for (const spare of spares) for (const part of spare.parts) this.drawSurfaces(view, part);
      this.farther = 1;
      gl.disable(gl.CULL_FACE);
      gl.depthRange(1 / kFills, 1 / kFills + kFillDepth);
      for (const part of fills) this.drawSurfaces(view, part);
      // Skins of the first layer alone: what lies behind it is known.
      gl.depthRange(2 / kFills, 2 / kFills + kFillDepth);
      for (const of of [...keyframes, ...spares]) this.drawRange(view, of.parts[0], this.skin, Range.skins);
      for (const part of fills) this.drawRange(view, part, this.skin, Range.skins);
      gl.depthRange(3 / kFills, 3 / kFills + kFillDepth);
      this.drawRange(view, parts[0], this.skin, Range.apron);
    }
    if (this.drawn === 0) {
      layers.begin(0);
      gl.depthRange(1 / kFills, 1 / kFills + kFillDepth);
      for (const part of fills) this.drawSurfaces(view, part);
    }
    gl.disable(gl.CULL_FACE);
    gl.depthRange(0, 1);
    gl.bindVertexArray(null);
    this.unbind();
  }

  /** Merges them into the bound framebuffer, whose depths are 1 - `near` / distance. */
  merge(near: number): void {
    const { gl, layers } = this, of = this.mergeOf(Math.max(1, this.drawn));
    gl.useProgram(of.program);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, layers.depths);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, layers.colors);
    if (of.counts) gl.uniform1fv(of.counts, this.counts);
    gl.uniform1f(of.ratio, near / this.near);
    gl.bindVertexArray(this.noVertices);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
    ++this.stats.drawCalls;
    this.unbind();
  }

  dispose(): void {
    const { gl } = this;
    this.layers.drop();
    for (const { program } of [this.surface, this.beside, this.skin]) gl.deleteProgram(program);
    for (const of of this.merges) if (of) gl.deleteProgram(of.program);
    gl.deleteVertexArray(this.noVertices);
  }

  private unbind(): void {
    const { gl } = this;
    for (const unit of [gl.TEXTURE1, gl.TEXTURE0]) {
      gl.activeTexture(unit);
      gl.bindTexture(gl.TEXTURE_2D, null);
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, null);
    }
  }

  private drawSurfaces(view: View, part: StoredPart): void {
    this.drawRange(view, part, this.surface, Range.smooth);
    this.drawRange(view, part, this.beside, Range.beside);
  }

  private drawRange(view: View, of: StoredPart, by: Program, range: Range): void {
    const { gl, scales, size, stats } = this, { part } = of;
    const begin = of.starts[range], count = of.starts[range + 1] - begin;
    if (count === 0) return;
    clipFromRaster(view, part, of.axes, this.clip);
    scales[0] = of.scale;
    scales[1] = part.step;
    scales[2] = part.offset;
    scales[3] = (2 * this.near) / this.farther;
    size[0] = 1 / part.width;
    size[1] = 1 / part.height;
    size[2] = part.offset;
    size[3] = kTolerance;
    gl.useProgram(by.program);
    gl.uniformMatrix4fv(by.clip, false, this.clip);
    gl.uniform4fv(by.scales, scales);
    gl.uniform4fv(by.size, size);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, of.codes);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, of.colors);
    gl.bindVertexArray(of.array);
    gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * begin);
    ++stats.drawCalls;
    stats.triangles += count / 3;
  }

  private mergeOf(count: number): Merge {
    const known = this.merges[count];
    if (known) return known;
    const { gl } = this, program = mergeProgram(gl, count);
    gl.useProgram(program);
    gl.uniform1i(gl.getUniformLocation(program, "colors"), 0);
    gl.uniform1i(gl.getUniformLocation(program, "depths"), 1);
    gl.uniform1f(gl.getUniformLocation(program, "tolerance"), kTolerance);
    return (this.merges[count] = {
      program, counts: gl.getUniformLocation(program, "counts"), ratio: gl.getUniformLocation(program, "near_ratio"),
    });
  }
}
