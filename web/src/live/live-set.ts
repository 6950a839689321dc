// The keyframes of a live walk: what came, what is drawn of it, what goes. Frames never wait for the network.

import { WalkError } from "../errors.js";
import type { View } from "../gl/program.js";
import type { Pictures, PicturesHost } from "../views/pictures.js";
import { chooseKeyframes, costOf, eyeDistance, type Candidate } from "./choose-keyframes.js";
import { LiveConnection, socketAddress } from "./connection.js";
import { PartDecoder } from "./decoder.js";
import { Figures } from "./figures.js";
import { kSpare } from "./live-shaders.js";
import { KeyframeDrawer, kMostKeyframes, type DrawnKeyframe } from "./keyframe-drawer.js";
import { encodeHello, type KeyframePart, type Welcome } from "./messages.js";
import { StoredPart } from "./store.js";

/** Bytes that a frame uploads, about a millisecond. */
const kUploadBytes = 1 << 20;
/** Pictures that wait for the worker; older ones of the same keyframe's eye are skipped. */
const kMostWaiting = 8;
/** Codes by which triangles may be off: half a pixel for an eye at the end of the cell. */
const kTolerance = 1;
const kMostTriangles = 400000;
const kMostMerged = kMostKeyframes - 1;
const kFadeMs = 250;
/** Sides of what lies around are shown up to so far from their middle, radians. */
const kHalfSide = Math.atan(Math.SQRT2);

/** A keyframe of a view: the best that is there of it. */
class Keyframe implements Candidate, DrawnKeyframe {
  parts: StoredPart[] = [];
  /** From 0 to 1: it comes and goes by degrees. */
  shown = 0;
  count = 0;

  constructor(first: StoredPart) {
    this.parts.push(first);
  }

  get camera(): KeyframePart {
    return this.parts[0].part;
  }

  get axes(): Float64Array {
    return this.parts[0].axes;
  }

  get fine(): boolean {
    return this.camera.fine;
  }

  get bytes(): number {
    return this.parts.reduce((sum, { bytes }) => sum + bytes, 0);
  }
}

/** What stays when the graphics are lost: the connection and the worker. */
export class LiveWalk {
  readonly connection: LiveConnection;
  readonly decoder = new PartDecoder();
  readonly welcome: Promise<Welcome>;
  private set: LiveSet | null = null;
  private coming = 0;
  private generation = 0;
  private readonly figures: Figures | null;

  constructor(gl: WebGL2RenderingContext, socket: string, base: string, private readonly host: PicturesHost) {
    const texture = gl.getParameter(gl.MAX_TEXTURE_SIZE) as number;
    let first: (welcome: Welcome) => void = () => {};
    this.welcome = new Promise((resolve) => (first = resolve));
    const hello = () => encodeHello(gl.drawingBufferWidth, gl.drawingBufferHeight, texture, host.budget);
    this.connection = new LiveConnection(socketAddress(socket, base, location.href), hello, {
      welcome: (welcome) => {
        ++this.generation;
        this.set?.forget();
        first(welcome);
      },
      keyframe: (part, message) => void this.decode(part, message),
      failed: (error) => host.failed(error),
    });
    this.figures = host.parent ? new Figures(host.parent, () => this.tell()) : null;
  }

  makeSet(gl: WebGL2RenderingContext): Pictures {
    // Pictures that were there are gone with the graphics.
    if (this.set) this.connection.restart();
    return (this.set = new LiveSet(gl, this, this.host));
  }

  get waiting(): number {
    return this.coming;
  }

  dispose(): void {
    this.figures?.dispose();
    this.connection.dispose();
    this.decoder.dispose();
  }

  private tell() {
    const figures = this.connection.count(), newest = this.set?.best;
    return { ...figures, ageMs: newest ? this.connection.age(newest.begun) : NaN };
  }

  private async decode(part: KeyframePart, message: ArrayBuffer): Promise<void> {
    const { generation } = this;
    if (this.coming >= kMostWaiting) {
      this.connection.dropped([part.id]);
      return;
    }
    ++this.coming;
    try {
      const decoded = await this.decoder.decode({ bytes: message, part, tolerance: kTolerance, triangles: kMostTriangles });
      if (generation === this.generation) this.set?.add(part, decoded);
      this.host.arrived();
    } catch (error) {
      this.connection.dropped([part.id]);
      this.host.failed(error as WalkError);
    } finally {
      --this.coming;
    }
  }
}

export class LiveSet implements Pictures {
  readonly stats = { drawCalls: 0, triangles: 0, there: 0 };
  readonly allFailed = false;
  private readonly drawer: KeyframeDrawer;
  private readonly uploads: StoredPart[] = [];
  private keyframes = new Map<bigint, Keyframe>();
  /** Of a server that is gone, still shown. */
  private old: Keyframe[] = [];
  private sides: StoredPart[] = [];
  private drawn: Keyframe[] = [];
  private fading = false;
  private before = 0;
  private held = 0;

  constructor(private readonly gl: WebGL2RenderingContext, private readonly walk: LiveWalk,
              private readonly host: PicturesHost) {
    this.drawer = new KeyframeDrawer(gl);
  }

  get bytes(): number {
    return this.held + this.drawer.bytes;
  }

  get settled(): boolean {
    return !this.fading && this.uploads.length === 0 && this.stats.there > 0;
  }

  /** The keyframe that counts most in the last frame. */
  get best(): KeyframePart | null {
    return this.drawn[0]?.camera ?? null;
  }

  add(part: KeyframePart, decoded: ConstructorParameters<typeof StoredPart>[2]): void {
    if (this.gl.isContextLost()) return;
    const made = new StoredPart(this.gl, part, decoded);
    this.held += made.bytes;
    this.uploads.push(made);
  }

  /** The server knows nothing of what is here any more; it is shown until there is better. */
  forget(): void {
    this.old.push(...this.keyframes.values());
    this.keyframes.clear();
    for (const of of this.uploads.splice(0)) this.drop(of, false);
  }

  update(): void {
    for (let left = kUploadBytes; left > 0 && this.uploads.length > 0;) {
      const next = this.uploads[0];
      left = next.upload(left);
      if (!next.there) break;
      this.uploads.shift();
      this.place(next);
      // What lies around alone is no view.
      if (next.part.side < 0) this.host.loaded(Number(next.part.id & 0xffffffffn));
    }
    if (this.uploads.length) this.host.arrived();
  }

  prepare(view: View): void {
    const now = performance.now(), passed = Math.min(100, now - this.before) / kFadeMs;
    this.before = now;
    this.walk.connection.look(view);
    const all = [...this.keyframes.values(), ...this.old];
    // Coarse ones fill, unless there is nothing fine.
    const fine = all.filter((of) => of.fine);
    const chosen = chooseKeyframes(view, fine, kMostMerged);
    const shown = chosen.length ? chosen : chooseKeyframes(view, all, kMostMerged);
    this.fade(view, shown, passed);
    const fills = this.fills(view, all);
    const spare = this.drawn.findIndex((of) => of.count < kSpare * this.drawn[0].count);
    const mixed = spare < 0 ? this.drawn.length : spare;
    this.drawer.drawLayers(view, this.drawn.slice(0, mixed), this.drawn.slice(mixed), fills);
    this.makeRoom(view, all);
  }

  draw(_view: View, near: number): void {
    this.drawer.merge(near);
    this.stats.drawCalls = this.drawer.stats.drawCalls;
    this.stats.triangles = this.drawer.stats.triangles;
  }

  dispose(): void {
    for (const of of [...this.keyframes.values(), ...this.old]) for (const part of of.parts) part.dispose();
    for (const of of [...this.sides, ...this.uploads]) of.dispose();
    this.drawer.dispose();
  }

  // What is uploaded takes the place of what was there in its stead.
  private place(made: StoredPart): void {
    const { part } = made;
    if (part.side >= 0) {
      // One older side stays: who walks on is between two places.
      const same = this.sides.filter((of) => of.part.side === part.side);
      if (same.length > 1) {
        this.sides.splice(this.sides.indexOf(same[0]), 1);
        this.drop(same[0], true);
      }
      this.sides.push(made);
    } else {
      const keyframe = this.keyframes.get(part.keyframe);
      if (!keyframe) {
        if (part.layer === 0) this.keyframes.set(part.keyframe, new Keyframe(made));
        else this.drop(made, true);
      } else if (part.layer === 1) {
        keyframe.parts.push(made);
      } else if (part.fine || !keyframe.fine) {
        // Who holds the fine picture needs the coarse one no more, which the server knows.
        for (const of of keyframe.parts) this.drop(of, false);
        keyframe.parts = [made];
      } else {
        this.drop(made, false);
      }
    }
    this.stats.there = this.keyframes.size + this.old.length + this.sides.length;
  }

  private fade(view: View, chosen: readonly Keyframe[], passed: number): void {
    // The first picture is there at once.
    const step = this.drawn.length ? passed : 1;
    this.fading = false;
    for (const of of this.drawn)
      if (!chosen.includes(of)) {
        of.shown = Math.max(0, of.shown - step);
        if (of.shown > 0) this.fading = true;
      }
    for (const of of chosen) {
      of.shown = Math.min(1, of.shown + step);
      if (of.shown < 1) this.fading = true;
    }
    const gone = this.drawn.filter((of) => of.shown > 0 && !chosen.includes(of) && of.parts.length > 0);
    this.drawn = [...chosen, ...gone].slice(0, kMostKeyframes);
    for (const of of this.drawn) {
      const distance = eyeDistance(view, of.camera), { cell, left, right, width } = of.camera;
      const texel = (right - left) / width, least = 0.02 * (cell || 1);
      const near = distance * distance + least * least;
      // Nearness counts twice, so that few pixels of few frames are mixed: where frames are drawn without a GPU
      // each layer costs.
      of.count = Math.max(1e-6, of.shown) / (near * near) / (texel * texel);
    }
    this.drawn.sort((a, b) => b.count - a.count);
  }

  // Coarse keyframes, and of each side around the nearest.
  private fills(view: View, all: readonly Keyframe[]): StoredPart[] {
    const e = view.worldFromEye, p = view.clipFromEye;
    const reach = Math.atan(Math.hypot((1 + Math.abs(p[8])) / p[0], (1 + Math.abs(p[9])) / p[5])) + kHalfSide;
    const best: StoredPart[] = [];
    for (const of of this.sides) {
      const { axes, part } = of;
      const ahead = axes[6] * e[8] + axes[7] * e[9] + axes[8] * e[10];
      if (Math.acos(Math.max(-1, Math.min(1, ahead))) > reach) continue;
      const known = best[part.side];
      if (!known || eyeDistance(view, part) < eyeDistance(view, known.part)) best[part.side] = of;
    }
    const coarse = chooseKeyframes(view, all.filter((of) => !of.fine && !this.drawn.includes(of)), 1);
    return [...coarse.map((of) => of.parts[0]), ...Object.values(best)];
  }

  // The worst for this view go, when there is too much.
  private makeRoom(view: View, all: readonly Keyframe[]): void {
    if (this.held <= this.host.budget) return;
    const rest = all.filter((of) => !this.drawn.includes(of));
    const costs = new Map(rest.map((of) => [of, costOf(view, of)]));
    rest.sort((a, b) => (costs.get(b) ?? 0) - (costs.get(a) ?? 0));
    for (const of of rest) {
      if (this.held <= 0.9 * this.host.budget) break;
      const old = this.old.indexOf(of);
      if (old >= 0) this.old.splice(old, 1);
      else this.keyframes.delete(of.camera.keyframe);
      for (const part of of.parts) this.drop(part, old < 0);
    }
    this.stats.there = this.keyframes.size + this.old.length + this.sides.length;
  }

  private drop(of: StoredPart, tell: boolean): void {
    this.held -= of.bytes;
    of.dispose();
    if (tell) this.walk.connection.dropped([of.part.id]);
  }
}
