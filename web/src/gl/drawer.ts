// Draws nodes (S3.3 to S3.7): the surfaces of each node into a layer of its own, colour, weight and
// depth, the skins of all into the last, and then one pass that merges the layers. Allocates nothing in a frame of the size of the last one.

import { kFaceAxes } from "../choose.js";
import { Layers } from "./layers.js";
import type { SkyEntry } from "../manifest.js";
import {
  kDefaultSky, kSkyTexels, mergeProgram, nodeProgram, showObjectsProgram, skyProgram, skyTexels,
} from "./shaders.js";
import type { StoredNode } from "./node-store.js";
import { checkProgram, nearOf, type View } from "./program.js";
import { NodePainter } from "./seen.js";

/** The most nodes that are merged. */
export const kMostDrawn = 4;
/** Surfaces are equal if their distances differ by at most this share. */
export const kTolerance = 0.03;
// Gaps of this width, pixels, count as cracks, which are always filled.
const kCrack = 2;
const kAnyWidth = 1e30;
/** Right, up; and the number of each face. */
const kFaces = kFaceAxes.map((a, f) => Float32Array.of(a[3], a[6], 0, a[4], a[7], 0, a[5], a[8], f));
const kNoNodes: readonly StoredNode[] = [];
const kDepthClamp = 0x864f;
const kLowerLeft = 0x8ca1, kNegativeOneToOne = 0x935e;

interface NodeProgram {
  readonly program: WebGLProgram;
  readonly clip: WebGLUniformLocation | null;
  readonly scales: WebGLUniformLocation | null;
  readonly widest: WebGLUniformLocation | null;
  readonly unmix: WebGLUniformLocation | null;
  readonly face: WebGLUniformLocation | null;
  readonly size: WebGLUniformLocation | null;
}

interface MergeProgram {
  readonly program: WebGLProgram;
  readonly merge: WebGLUniformLocation | null;
  readonly nearness: WebGLUniformLocation | null;
  readonly steps: WebGLUniformLocation | null;
  readonly nodeFromPixel: WebGLUniformLocation | null;
  readonly projection: WebGLUniformLocation | null;
  readonly place: WebGLUniformLocation | null;
  readonly corner: WebGLUniformLocation | null;
}

export class NodeDrawer {
  readonly stats = { drawCalls: 0, triangles: 0 };
  /** How many layers the last drawLayers() drew. */
  layers = 0;
  /** Of the last drawLayers(), what mergeFunction() names likewise. */
  readonly mergeUniform = new Float32Array(2);
  readonly nearness = new Float32Array(kMostDrawn);
  readonly steps = new Float32Array(kMostDrawn);
  readonly nodeFromPixel = new Float32Array(16 * kMostDrawn);
  readonly seen: (WebGLTexture | null)[] = new Array<null>(kMostDrawn).fill(null);

  /** Of nodes when they come. */
  readonly painter: NodePainter;
  private readonly begun: { readonly surface: WebGLProgram; readonly skin: WebGLProgram };
  private surface: NodeProgram | null = null;
  private skin: NodeProgram | null = null;
  private surfaceObject: NodeProgram | null = null;
  private skinObject: NodeProgram | null = null;
  private showObjects: WebGLProgram | null = null;
  private sky: { program: WebGLProgram; place: WebGLUniformLocation | null } | null = null;
  private skyTexture: WebGLTexture | null = null;
  private skyColors: SkyEntry = kDefaultSky;
  private readonly pixels = new Float32Array(9);
  private readonly mergePrograms: (MergeProgram | null)[] = [];
  private readonly noVertices: WebGLVertexArrayObject | null;
  private readonly clamps: boolean;
  private readonly clipControl: { clipControlEXT(origin: number, depth: number): void } | null;
  private readonly targets: Layers;
  private objectTarget: { framebuffer: WebGLFramebuffer; texture: WebGLTexture; depth: WebGLRenderbuffer } | null = null;
  private unmix = -1;
  private readonly clip = new Float64Array(16);
  private readonly clip32 = new Float32Array(16);
  private readonly scales = new Float32Array(4);
  private readonly projection = new Float32Array(4);
  private readonly corners = new Float64Array(12);
  private readonly apex = new Float64Array(3);
  private readonly visible = new Uint8Array(6);

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.targets = new Layers(gl);
    this.begun = { surface: nodeProgram(gl, "SIDE"), skin: nodeProgram(gl, "SKIN") };
    // Half, so that none is missed that frames would call different.
    this.painter = new NodePainter(gl, 0.5 * kTolerance);
    this.noVertices = gl.createVertexArray();
    this.clamps = gl.getExtension("EXT_depth_clamp") !== null;
    this.clipControl = gl.getExtension("EXT_clip_control");
  }

  /**
   * Draws at least one node into the layers, the best first. Changes framebuffer, viewport and
   * programs.
   */
  drawLayers(view: View, nodes: readonly StoredNode[], count: number): void {
    const { gl, stats } = this;
    const surface = (this.surface ??= this.located(this.begun.surface));
    const skin = (this.skin ??= this.located(this.begun.skin));
    stats.drawCalls = 0;
    stats.triangles = 0;
    // The first node shows everything that is seen from its own place, and mixes it: what is beside
    // each other for the node is so for the eye.
    const e = view.worldFromEye;
    const fromOwn =
      eyeDistance(view, nodes[0]) < 1e-6 * Math.max(1, Math.hypot(e[12], e[13], e[14]));
    if (fromOwn) count = 1;
    this.unmix = fromOwn ? -1 : kTolerance;
    // One for each node's surfaces, and one for all skins.
    this.targets.make(view.width, view.height, Math.max(2, count) + 1);
    this.layers = count;
    const near = this.begin(view);
    this.setMerge(view, nodes, count, near);
    for (let i = 0; i < count; ++i) {
      this.targets.begin(i);
      this.beginNode(view, nodes[i], near);
      gl.activeTexture(gl.TEXTURE1);
      gl.bindTexture(gl.TEXTURE_2D, nodes[i].seen);
      this.drawSurfaces(surface, nodes[i], i === 0);
      if (count === 1) this.drawSkins(skin, nodes[i], true);
    }
    if (count > 1) {
      this.targets.begin(count);
      for (let i = 0; i < count; ++i) {
        this.beginNode(view, nodes[i], near);
        this.drawSkins(skin, nodes[i], i === 0);
      }
    }
    this.end();
  }

  /**
   * Merges the layers into the bound framebuffer and viewport, whose corner is (x, y), with depth.
   * With `sky` what no node shows is sky, at the far plane.
   */
  merge(view: View, sky = false, x = 0, y = 0): void {
    const { gl } = this;
    if (this.layers === 0) return;
    const of = this.mergeFor(this.layers, sky);
    gl.useProgram(of.program);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.colors);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.depths);
    gl.uniform2fv(of.merge, this.mergeUniform);
    if (this.layers > 1) {
      for (let i = 0; i < this.layers; ++i) {
        gl.activeTexture(gl.TEXTURE2 + i);
        gl.bindTexture(gl.TEXTURE_2D, this.seen[i]);
      }
      gl.uniform1fv(of.nearness, this.nearness, 0, this.layers);
      gl.uniform1fv(of.steps, this.steps, 0, this.layers);
      gl.uniformMatrix4fv(of.nodeFromPixel, false, this.nodeFromPixel, 0, 16 * this.layers);
    }
    gl.activeTexture(gl.TEXTURE0);
    const p = view.clipFromEye;
    this.projection[0] = p[10];
    this.projection[1] = p[14];
    this.projection[2] = p[11];
    this.projection[3] = p[15];
    gl.uniform4fv(of.projection, this.projection);
    gl.uniform2i(of.corner, x, y);
    if (sky) this.setSky(view, of.place, x, y, 2 + this.layers);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    gl.disable(gl.CULL_FACE);
    gl.bindVertexArray(this.noVertices);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
    ++this.stats.drawCalls;
    ++this.stats.triangles;
  }

  /** The sky that is drawn from now on. */
  useSky(sky: SkyEntry): void {
    this.gl.deleteTexture(this.skyTexture);
    this.skyTexture = null;
    this.skyColors = sky;
  }

  /** Draws the sky where nothing was drawn, into the bound framebuffer and viewport. */
  drawSky(view: View, x = 0, y = 0): void {
    const { gl } = this;
    if (!this.sky) {
      const program = skyProgram(gl);
      this.sky = { program, place: gl.getUniformLocation(program, "world_from_pixel") };
    }
    gl.useProgram(this.sky.program);
    this.setSky(view, this.sky.place, x, y, 0);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.bindVertexArray(this.noVertices);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
    ++this.stats.drawCalls;
  }

  /**
   * Draws identifiers of objects, one z-buffer for all nodes, into `target` as red + 256 green; for
   * measures. Nodes must have identifiers.
   */
  drawObjects(view: View, nodes: readonly StoredNode[], count: number,
              target: WebGLFramebuffer | null): void {
    const { gl } = this;
    this.surfaceObject ??= this.located(nodeProgram(gl, "OBJECT"));
    this.skinObject ??= this.located(nodeProgram(gl, "SKIN", "OBJECT"));
    this.showObjects ??= showObjectsProgram(gl);
    const into = this.makeObjectTarget(view.width, view.height);
    const near = this.begin(view);
    gl.bindFramebuffer(gl.FRAMEBUFFER, into.framebuffer);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    for (let i = 0; i < count; ++i) {
      gl.activeTexture(gl.TEXTURE1);
      gl.bindTexture(gl.TEXTURE_2D, nodes[i].objects);
      this.beginNode(view, nodes[i], near);
      this.drawSurfaces(this.surfaceObject, nodes[i], i === 0);
      this.drawSkins(this.skinObject, nodes[i], i === 0);
    }
    this.end();
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.useProgram(this.showObjects);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, into.texture);
    gl.disable(gl.DEPTH_TEST);
    gl.bindVertexArray(this.noVertices);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
    gl.bindTexture(gl.TEXTURE_2D, null);
  }

  /** The layers of the last drawLayers(): texture arrays of sRGB-encoded colours and of depths. */
  get colors(): WebGLTexture | null {
    return this.targets.colors;
  }
  get depths(): WebGLTexture | null {
    return this.targets.depths;
  }

  /** Bytes of the layers. */
  get bytes(): number {
    return this.targets.bytes;
  }

  dispose(): void {
    const { gl } = this;
    this.targets.drop();
    this.painter.dispose();
    for (const of of [this.begun.surface, this.begun.skin]) gl.deleteProgram(of);
    for (const of of [this.surfaceObject, this.skinObject]) if (of) gl.deleteProgram(of.program);
    for (const of of this.mergePrograms) if (of) gl.deleteProgram(of.program);
    if (this.showObjects) gl.deleteProgram(this.showObjects);
    if (this.sky) gl.deleteProgram(this.sky.program);
    gl.deleteTexture(this.skyTexture);
    gl.deleteVertexArray(this.noVertices);
    this.dropObjectTarget();
  }

  private located(program: WebGLProgram): NodeProgram {
    const { gl } = this;
    checkProgram(gl, "node", program);
    gl.useProgram(program);
    gl.uniform1i(gl.getUniformLocation(program, "faces"), 0);
    gl.uniform1i(gl.getUniformLocation(program, "objects"), 1);
    gl.uniform1i(gl.getUniformLocation(program, "seen"), 1);
    return {
      program,
      clip: gl.getUniformLocation(program, "clip_from_node"),
      scales: gl.getUniformLocation(program, "scales"),
      widest: gl.getUniformLocation(program, "widest_skin"),
      unmix: gl.getUniformLocation(program, "unmix"),
      face: gl.getUniformLocation(program, "face"),
      size: gl.getUniformLocation(program, "size"),
    };
  }

  private mergeFor(layers: number, sky: boolean): MergeProgram {
    const index = 2 * layers + (sky ? 1 : 0);
    const known = this.mergePrograms[index];
    if (known) return known;
    const { gl } = this;
    const program = mergeProgram(gl, layers, sky);
    gl.useProgram(program);
    gl.uniform1i(gl.getUniformLocation(program, "node_colors"), 0);
    gl.uniform1i(gl.getUniformLocation(program, "node_depths"), 1);
    for (let i = 0; i < layers; ++i)
      gl.uniform1i(gl.getUniformLocation(program, `node_seen${i}`), 2 + i);
    gl.uniform1i(gl.getUniformLocation(program, "sky"), 2 + layers);
    return (this.mergePrograms[index] = {
      program,
      merge: gl.getUniformLocation(program, "node_merge"),
      nearness: gl.getUniformLocation(program, "node_nearness"),
      steps: gl.getUniformLocation(program, "node_steps"),
      nodeFromPixel: gl.getUniformLocation(program, "node_from_pixel"),
      projection: gl.getUniformLocation(program, "projection"),
      place: gl.getUniformLocation(program, "world_from_pixel"),
      corner: gl.getUniformLocation(program, "corner"),
    });
  }

  // The near plane of the layers. Where depths cannot be clamped, nearer than the frame's.
  private begin(view: View): number {
    const { gl } = this;
    const near = nearOf(view);
    this.targets.prepare(view.width, view.height);
    if (this.clamps) gl.enable(kDepthClamp);
    // A host whose depth is reversed may have left it otherwise.
    this.clipControl?.clipControlEXT(kLowerLeft, kNegativeOneToOne);
    return this.clamps ? near : near / 4;
  }

  private end(): void {
    const { gl } = this;
    if (this.clamps) gl.disable(kDepthClamp);
    gl.disable(gl.CULL_FACE);
    gl.bindVertexArray(null);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, null);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, null);
  }

  /** Begins to draw something else into the one layer, whose near plane it returns. */
  beginOther(view: View): number {
    this.stats.drawCalls = this.stats.triangles = 0;
    this.targets.make(view.width, view.height, 1);
    this.layers = 1;
    const near = this.begin(view);
    this.setMerge(view, kNoNodes, 0, near);
    this.targets.begin(0);
    return near;
  }

  endOther(): void {
    this.end();
  }

  private setSky(view: View, place: WebGLUniformLocation | null, left: number, bottom: number,
                 unit: number): void {
    const { gl, pixels } = this;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, this.skyTexture ??= this.makeSky());
    gl.activeTexture(gl.TEXTURE0);
    const e = view.worldFromEye, p = view.clipFromEye;
    const sx = 2 / (view.width * p[0]), sy = 2 / (view.height * p[5]);
    const x = (p[8] - 1) / p[0] - left * sx, y = (p[9] - 1) / p[5] - bottom * sy;
    for (let k = 0; k < 3; ++k) {
      pixels[k] = e[k] * sx;
      pixels[3 + k] = e[4 + k] * sy;
      pixels[6 + k] = e[k] * x + e[4 + k] * y - e[8 + k];
    }
    gl.uniformMatrix3fv(place, false, pixels);
  }

  private makeSky(): WebGLTexture {
    const { gl } = this;
    const made = gl.createTexture() as WebGLTexture;
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, kSkyTexels, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE,
                  skyTexels(this.skyColors));
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    return made;
  }

  // What the merge of `count` nodes asks for.
  private setMerge(view: View, nodes: readonly StoredNode[], count: number, near: number): void {
    const { nearness, steps, nodeFromPixel } = this;
    this.mergeUniform[0] = kTolerance;
    this.mergeUniform[1] = near;
    let sum = 0;
    for (let i = 0; i < count; ++i) sum += 1 / Math.max(1e-9, eyeDistance(view, nodes[i]));
    const e = view.worldFromEye, p = view.clipFromEye;
    // Of a pixel's (x, y): at z = -1.
    const sx = 2 / (view.width * p[0]), sy = 2 / (view.height * p[5]);
    const x = (p[8] - 1) / p[0], y = (p[9] - 1) / p[5];
    for (let i = 0; i < count; ++i) {
      const node = nodes[i], w = node.worldFromNode;
      // Squared: the nearer node's texels are smaller in both directions.
      const share = 1 / Math.max(1e-9, eyeDistance(view, node)) / sum;
      nearness[i] = Math.max(1e-9, share * share);
      steps[i] = node.level.mesh.disparityStep;
      this.seen[i] = node.seen;
      for (let row = 0; row < 3; ++row) {
        const right = dotOf(w, row, e, 0), up = dotOf(w, row, e, 1), back = dotOf(w, row, e, 2);
        const at = 16 * i + row;
        nodeFromPixel[at] = right * sx;
        nodeFromPixel[at + 4] = up * sy;
        nodeFromPixel[at + 8] = right * x + up * y - back;
        nodeFromPixel[at + 12] = w[4 * row] * (e[12] - w[12]) + w[4 * row + 1] * (e[13] - w[13]) +
          w[4 * row + 2] * (e[14] - w[14]);
      }
    }
  }

  // Before the surfaces and the skins of a node are drawn.
  private beginNode(view: View, node: StoredNode, near: number): void {
    const { gl, scales } = this;
    this.setClip(view, node);
    this.findVisible(view, node);
    for (let i = 0; i < 16; ++i) this.clip32[i] = this.clip[i];
    scales[0] = 1 / node.level.faceSize;
    scales[1] = node.level.mesh.disparityStep;
    scales[2] = 0.25 / node.level.faceSize;
    scales[3] = 2 * near;
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, node.faces);
  }

  private drawSurfaces(of: NodeProgram, node: StoredNode, first: boolean): void {
    const { gl } = this;
    // The first node sees the eye. What the eye would see from behind of another node's surfaces,
    // that node saw around a corner: it must not cover what the first node knows.
    if (first) gl.disable(gl.CULL_FACE);
    else gl.enable(gl.CULL_FACE);
    this.drawSides(of, node, node.surfaces, node.surfaceStarts, 0);
    gl.disable(gl.CULL_FACE);
  }

  private drawSkins(of: NodeProgram, node: StoredNode, first: boolean): void {
    this.drawSides(of, node, node.skins, node.skinStarts, first ? kAnyWidth : kCrack);
  }

  private drawSides(of: NodeProgram, node: StoredNode, array: WebGLVertexArrayObject,
                    starts: Uint32Array, widest: number): void {
    const { gl, visible, stats } = this;
    gl.useProgram(of.program);
    gl.uniformMatrix4fv(of.clip, false, this.clip32);
    gl.uniform4fv(of.scales, this.scales);
    if (of.widest) gl.uniform1f(of.widest, widest);
    if (of.unmix) gl.uniform1f(of.unmix, this.unmix);
    gl.uniform1f(of.size, node.level.faceSize);
    gl.bindVertexArray(array);
    for (let f = 0; f < 6; ++f) {
      if (!visible[f]) continue;
      const begin = starts[f];
      // Neighbouring sides in one call, where it does not depend on the side.
      while (!of.face && f + 1 < 6 && visible[f + 1]) ++f;
      const count = starts[f + 1] - begin;
      if (count === 0) continue;
      if (of.face) gl.uniformMatrix3fv(of.face, false, kFaces[f]);
      gl.drawElements(gl.TRIANGLES, 3 * count, gl.UNSIGNED_INT, 12 * begin);
      ++stats.drawCalls;
      stats.triangles += count;
    }
  }

  // Clip coordinates of (direction, disparity): a point at c / d from the node's place E is
  // R c + (E - eye) d relative to the eye, times d.
  private setClip(view: View, node: StoredNode): void {
    const w = node.worldFromNode, e = view.worldFromEye, p = view.clipFromEye, m = this.clip;
    for (let column = 0; column < 4; ++column) {
      const x = w[4 * column] - (column === 3 ? e[12] : 0);
      const y = w[4 * column + 1] - (column === 3 ? e[13] : 0);
      const z = w[4 * column + 2] - (column === 3 ? e[14] : 0);
      const ex = e[0] * x + e[1] * y + e[2] * z;
      const ey = e[4] * x + e[5] * y + e[6] * z;
      const ez = e[8] * x + e[9] * y + e[10] * z;
      const d = column === 3 ? 1 : 0;
      for (let row = 0; row < 4; ++row)
        m[4 * column + row] = p[row] * ex + p[4 + row] * ey + p[8 + row] * ez + p[12 + row] * d;
    }
    // Depth follows from w (shaders.ts), which is the distance: so is w of any projection here.
    const scale = -p[11] || 1;
    if (scale !== 1) for (let i = 0; i < 16; ++i) m[i] /= scale;
  }

  // As visible_faces.cpp: a side is left out whose pyramid is apart from the frustum (S3.5).
  private findVisible(view: View, node: StoredNode): void {
    const { corners, apex, visible, clip } = this;
    const w = node.worldFromNode, e = view.worldFromEye, p = view.clipFromEye;
    const toNode = (x: number, y: number, z: number, out: Float64Array, at: number) => {
      out[at] = w[0] * x + w[1] * y + w[2] * z;
      out[at + 1] = w[4] * x + w[5] * y + w[6] * z;
      out[at + 2] = w[8] * x + w[9] * y + w[10] * z;
    };
    toNode(e[12] - w[12], e[13] - w[13], e[14] - w[14], apex, 0);
    for (let k = 0; k < 4; ++k) {
      // Where clip x and y are +-w on the plane z = -1.
      const x = (((k & 1) ? 1 : -1) + p[8]) / p[0], y = (((k & 2) ? 1 : -1) + p[9]) / p[5];
      toNode(e[0] * x + e[4] * y - e[8], e[1] * x + e[5] * y - e[9], e[2] * x + e[6] * y - e[10],
             corners, 3 * k);
    }
    for (let f = 0; f < 6; ++f) {
      visible[f] = 0;
      const least = node.reaches[2 * f], most = node.reaches[2 * f + 1];
      if (!(most >= least)) continue;
      const a = kFaceAxes[f];
      let outside = 0x1f;
      for (let k = 0; k < 8; ++k) {
        const u = (k & 1) ? 1 : -1, v = (k & 2) ? 1 : -1, d = (k & 4) ? most : least;
        const x = a[0] + u * a[3] + v * a[6], y = a[1] + u * a[4] + v * a[7],
          z = a[2] + u * a[5] + v * a[8];
        const cx = clip[0] * x + clip[4] * y + clip[8] * z + clip[12] * d;
        const cy = clip[1] * x + clip[5] * y + clip[9] * z + clip[13] * d;
        const cw = clip[3] * x + clip[7] * y + clip[11] * z + clip[15] * d;
        outside &= (cx < -cw ? 1 : 0) | (cx > cw ? 2 : 0) | (cy < -cw ? 4 : 0) |
          (cy > cw ? 8 : 0) | (cw < 0 ? 16 : 0);
      }
      if (outside) continue;
      let apart = false;
      for (let side = 0; side < 4; ++side) {
        const s = (side & 1) ? -1 : 1, at = side < 2 ? 3 : 6;
        const x = a[0] + s * a[at], y = a[1] + s * a[at + 1], z = a[2] + s * a[at + 2];
        let beyond = x * apex[0] + y * apex[1] + z * apex[2] < 0;
        for (let k = 0; k < 4; ++k)
          beyond = beyond && x * corners[3 * k] + y * corners[3 * k + 1] + z * corners[3 * k + 2] < 0;
        apart = apart || beyond;
      }
      if (!apart) visible[f] = 1;
    }
  }

  private makeObjectTarget(width: number, height: number) {
    const { gl } = this;
    this.dropObjectTarget();
    const texture = gl.createTexture() as WebGLTexture;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA16UI, width, height);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    const depth = gl.createRenderbuffer() as WebGLRenderbuffer;
    gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT32F, width, height);
    const framebuffer = gl.createFramebuffer() as WebGLFramebuffer;
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
    return (this.objectTarget = { framebuffer, texture, depth });
  }

  private dropObjectTarget(): void {
    const { gl, objectTarget } = this;
    if (!objectTarget) return;
    gl.deleteFramebuffer(objectTarget.framebuffer);
    gl.deleteTexture(objectTarget.texture);
    gl.deleteRenderbuffer(objectTarget.depth);
    this.objectTarget = null;
  }
}

/** Of two columns. */
function dotOf(a: ArrayLike<number>, i: number, b: ArrayLike<number>, j: number): number {
  return a[4 * i] * b[4 * j] + a[4 * i + 1] * b[4 * j + 1] + a[4 * i + 2] * b[4 * j + 2];
}

function eyeDistance(view: View, node: StoredNode): number {
  const e = view.worldFromEye, w = node.worldFromNode;
  return Math.hypot(e[12] - w[12], e[13] - w[13], e[14] - w[14]);
}
