// A walk in a WebGL 2 context, without three.js: what is loaded, and what is drawn.
//
//   const walk = new Walk(gl, "walk/", { onNeedsDraw: () => requestAnimationFrame(frame) });
//   await walk.ready;
//   walk.update(eye);                     // every frame: what is loaded next, what goes
//   walk.draw(view, framebuffer);         // colour and depth

import { NodeChooser } from "./choose.js";
import { Decoder } from "./decoder.js";
import { WalkError, asWalkError } from "./errors.js";
import { NodeDrawer, kMostDrawn } from "./gl/drawer.js";
import type { View } from "./gl/program.js";
import { deleteNode, storeNode, textureBytes, uploadFace, type StoredNode } from "./gl/node-store.js";
import type { FileEntry, LevelEntry, Manifest, SketchesEntry } from "./manifest.js";
import { kSkinStride, kSurfaceStride } from "./mesh-layout.js";
import { StaticSource, type PictureSource } from "./source.js";
import type { LiveWalk } from "./live/live-set.js";
import type { Pictures, PicturesHost } from "./views/pictures.js";

export { WalkError } from "./errors.js";
export { parseManifest } from "./manifest.js";
export type { FileEntry, LevelEntry, Manifest, MeshEntry, NodeEntry, Vector } from "./manifest.js";
export { StaticSource } from "./source.js";
export type { EyePose, PictureSource } from "./source.js";
export type { View } from "./gl/program.js";

export interface WalkOptions {
  /** Bytes on the GPU; nodes that were not drawn for longest go first. Default 192 MiB. */
  memoryBudget?: number;
  /** Nodes that are merged at a time, 1 to 4. Default 2. */
  nodes?: number;
  /** Files that are loaded at a time. Default 3. */
  connections?: number;
  /** Identifiers of objects as well, for drawObjects(). */
  objects?: boolean;
  /** The element in which a live walk tells of its connection. */
  parent?: HTMLElement;
  /** A frame drawn now would differ from the last one. */
  onNeedsDraw?: () => void;
  /** A node came, in one of its levels (0 is the coarsest). */
  onPicture?: (node: number, level: number) => void;
  /** A file could not be loaded; the walk goes on without it. */
  onError?: (error: WalkError) => void;
}

export interface WalkStats {
  drawCalls: number;
  triangles: number;
  /** Bytes on the GPU: nodes and layers. */
  bytes: number;
  /** Nodes on the GPU. */
  nodes: number;
  /** Nodes that the last frame merged. */
  drawn: number;
  /** Files that are being loaded or waited for. */
  loading: number;
  /** Bytes that were loaded. */
  loaded: number;
}

interface Slot {
  stored: StoredNode | null;
  /** The level of `stored`; -1: none. */
  level: number;
  /** Being loaded: its level; -1: none. */
  coming: number;
  /** Bytes that are kept for what comes. */
  reserved: number;
  /** Levels from here on failed. */
  most: number;
  lastUsed: number;
  /** What is being uploaded. */
  next: { stored: StoredNode; level: number; faces: ImageBitmap[] } | null;
}

const kMemoryBudget = 192 * 1024 * 1024;
const kTexelsAFrame = 512 * 512;
/** A node may stay ahead of what is drawn: so many of the next best are loaded as well. */
const kAhead = 4;

export class Walk {
  /** The manifest is read and something can be drawn. */
  readonly ready: Promise<void>;
  readonly stats: WalkStats = {
    drawCalls: 0, triangles: 0, bytes: 0, nodes: 0, drawn: 0, loading: 0, loaded: 0,
  };
  manifest: Manifest | null = null;
  /** Of a live walk: its connection. */
  live: LiveWalk | null = null;
  /** Layers of the last drawLayers(), for those who merge them themselves. */
  drawer: NodeDrawer;

  private readonly source: PictureSource;
  private readonly decoder = new Decoder();
  private readonly abort = new AbortController();
  private readonly budget: number;
  private readonly mostDrawn: number;
  private readonly mostLoading: number;
  private chooser: NodeChooser | null = null;
  /** Of an object, alone or among nodes. */
  private pictures: Pictures | null = null;
  private makePictures: ((gl: WebGL2RenderingContext) => Pictures) | null = null;
  private slots: Slot[] = [];
  private readonly drawn: StoredNode[] = [];
  private frame = 0;
  private nodeBytes = 0;
  private generation = 0;
  private readonly eye = new Float64Array(3);
  private readonly waiting: (() => void)[] = [];
  private firstPicture: (() => void) | null = null;
  private failed: WalkError | null = null;

  constructor(
    private gl: WebGL2RenderingContext,
    source: string | URL | PictureSource,
    private readonly options: WalkOptions = {},
  ) {
    this.source =
      typeof source === "string" || source instanceof URL ? new StaticSource(source) : source;
    this.budget = options.memoryBudget ?? kMemoryBudget;
    this.mostDrawn = Math.min(kMostDrawn, Math.max(1, options.nodes ?? 2));
    this.mostLoading = Math.max(1, options.connections ?? 3);
    // Loads while shaders are compiled.
    this.ready = this.open();
    // Who does not wait for it hears of its error by onError.
    this.ready.catch(() => {});
    try {
      this.drawer = new NodeDrawer(gl);
    } catch (error) {
      this.abort.abort();
      this.decoder.dispose();
      throw error;
    }
  }

  /**
   * What the eye at (x, y, z) needs is loaded, and a part of it uploaded that takes a millisecond.
   * Call it once a frame.
   */
  update(x: number, y: number, z: number): void {
    const { eye, chooser } = this;
    ++this.frame;
    eye[0] = x;
    eye[1] = y;
    eye[2] = z;
    if (this.gl.isContextLost()) return;
    this.pictures?.update(x, y, z);
    if (!chooser) return;
    chooser.order(x, y, z);
    this.upload();
    this.choose();
    this.load();
  }

  /**
   * Draws into a framebuffer (null: the canvas), with depth, as large as the view, from (x, y) on.
   * With `sky` what the walk does not show is its own sky or, if it has none, the library's default, at the far plane.
   */
  draw(view: View, framebuffer: WebGLFramebuffer | null, sky = false, x = 0, y = 0): void {
    const { gl } = this;
    if (gl.isContextLost()) return;
    let calls = 0, triangles = 0, drawn = false;
    // The nodes and, by depth, what stands among them.
    for (const some of [this.drawNodes, this.drawObject]) {
      if (!some.call(this, view)) continue;
      const { stats } = this.drawer;
      stats.drawCalls += calls;
      stats.triangles += triangles;
      gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
      gl.viewport(x, y, view.width, view.height);
      this.drawer.merge(view, sky && !drawn, x, y);
      ({ drawCalls: calls, triangles } = stats);
      drawn = true;
    }
    if (!drawn && sky) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
      gl.viewport(x, y, view.width, view.height);
      this.drawer.drawSky(view, x, y);
    }
    this.count();
  }

  /** Draws nodes, or an object that is alone, into the layers of `drawer` alone: how many? */
  drawLayers(view: View): number {
    return this.drawNodes(view) || this.drawObject(view) ? this.drawer.layers : 0;
  }

  private drawNodes(view: View): boolean {
    if (this.drawn.length === 0) return false;
    this.drawer.drawLayers(view, this.drawn, this.drawn.length);
    this.count();
    return true;
  }

  private drawObject(view: View): boolean {
    const { pictures } = this;
    if (!pictures || pictures.stats.there === 0) return false;
    pictures.prepare(view);
    pictures.draw(view, this.drawer.beginOther(view));
    this.drawer.endOther();
    this.drawer.stats.drawCalls = pictures.stats.drawCalls;
    this.drawer.stats.triangles = pictures.stats.triangles;
    this.count();
    return true;
  }

  /** Draws identifiers of objects as colours (red + 256 green), if the walk and the options have them. */
  drawObjects(view: View, framebuffer: WebGLFramebuffer | null): void {
    const withObjects = this.drawn.filter((node) => node.objects !== null);
    this.drawer.drawObjects(view, withObjects, withObjects.length, framebuffer);
  }

  /** Is everything there that an eye needs which is where update() was told last? */
  get settled(): boolean {
    const { chooser } = this;
    if (this.pictures && !this.pictures.settled) return false;
    if (!chooser) return this.pictures !== null || this.failed !== null;
    for (let k = 0; k < Math.min(this.mostDrawn, this.slots.length); ++k) {
      const slot = this.slots[chooser.best[k]];
      if (slot.level < slot.most - 1 || slot.next) return false;
    }
    return true;
  }

  /** After a lost context came back: everything is loaded and uploaded again. */
  restore(gl: WebGL2RenderingContext): void {
    this.gl = gl;
    ++this.generation;
    this.drawer = new NodeDrawer(gl);
    if (this.manifest?.sky) this.drawer.useSky(this.manifest.sky);
    this.nodeBytes = 0;
    this.drawn.length = 0;
    this.pictures?.dispose();
    if (this.makePictures) this.pictures = this.makePictures(gl);
    for (const slot of this.slots) {
      for (const face of slot.next?.faces ?? []) face.close();
      slot.stored = slot.next = null;
      slot.level = slot.coming = -1;
      slot.reserved = 0;
    }
    this.options.onNeedsDraw?.();
  }

  dispose(): void {
    ++this.generation;
    this.abort.abort();
    this.source.close();
    this.decoder.dispose();
    for (const slot of this.slots) {
      for (const face of slot.next?.faces ?? []) face.close();
      if (slot.next) deleteNode(this.gl, slot.next.stored);
      if (slot.stored) deleteNode(this.gl, slot.stored);
      slot.stored = slot.next = null;
    }
    this.drawn.length = 0;
    this.pictures?.dispose();
    this.live?.dispose();
    this.drawer.dispose();
  }

  private async open(): Promise<void> {
    try {
      const { signal } = this.abort;
      let manifest = await this.source.manifest(signal);
      const first = new Promise<void>((resolve) => (this.firstPicture = resolve));
      const { sketches } = manifest;
      manifest = await this.openPictures(manifest);
      if (sketches) await this.openNodes(manifest, sketches);
      this.manifest = manifest;
      if (manifest.sky) this.drawer.useSky(manifest.sky);
      this.update(...manifest.start.eye);
      this.options.onNeedsDraw?.();
      await first;
      if (this.failed) throw this.failed;
    } catch (error) {
      const told = asWalkError(error, "walk");
      if (this.failed !== told && !this.abort.signal.aborted) this.options.onError?.(told);
      this.failed = told;
      throw told;
    }
  }

  private async openNodes(manifest: Manifest, sketches: SketchesEntry): Promise<void> {
    const codes = await this.decoder.plane16(
      await this.fetch(sketches), sketches, sketches.size,
      6 * sketches.size * manifest.nodes.length,
    );
    this.chooser = new NodeChooser(manifest.nodes, codes, sketches);
    this.slots = manifest.nodes.map((node) => ({
      stored: null, level: -1, coming: -1, reserved: 0, most: node.levels.length, lastUsed: 0,
      next: null,
    }));
  }

  // The manifest again; a live walk's has what its server says.
  private async openPictures(manifest: Manifest): Promise<Manifest> {
    const { pictures, reliefs, live } = manifest;
    const host: PicturesHost = {
      budget: this.budget, parent: this.options.parent,
      fetch: (file) => this.fetch(file),
      arrived: () => this.options.onNeedsDraw?.(),
      loaded: (picture) => {
        this.options.onPicture?.(picture, 0);
        this.firstPicture?.();
        this.firstPicture = null;
      },
      failed: (error) => {
        if (this.firstPicture && this.pictures?.allFailed) {
          this.failed = error;
          this.firstPicture();
          this.firstPicture = null;
        }
        this.options.onError?.(error);
        this.options.onNeedsDraw?.();
      },
    };
    // Programs that walks of nodes do not need.
    if (pictures) {
      const { PictureSet } = await part(import("./views/picture-set.js"));
      this.makePictures = (gl) => new PictureSet(gl, pictures, this.decoder, host);
    } else if (reliefs) {
      const { ReliefSet } = await part(import("./reliefs/relief-set.js"));
      this.makePictures = (gl) => new ReliefSet(gl, reliefs, this.decoder, host);
    } else if (live) {
      const { LiveWalk } = await part(import("./live/live-set.js"));
      this.abort.signal.throwIfAborted();
      const walk = (this.live = new LiveWalk(this.gl, live.socket, this.source.base ?? document.baseURI, host));
      this.makePictures = (gl) => walk.makeSet(gl);
      this.pictures = this.makePictures(this.gl);
      const { up, eye, target, verticalFov, zNear, zFar, unit, name } = await walk.welcome;
      return { ...manifest, name, up, start: { eye, target, verticalFov, zNear, zFar }, live: { ...live, unit } };
    }
    this.abort.signal.throwIfAborted();
    if (this.makePictures) this.pictures = this.makePictures(this.gl);
    return manifest;
  }

  private async fetch(entry: FileEntry): Promise<ArrayBuffer> {
    while (this.stats.loading >= this.mostLoading)
      await new Promise<void>((resolve) => this.waiting.push(resolve));
    ++this.stats.loading;
    try {
      const bytes = await this.source.file(entry, this.abort.signal);
      this.stats.loaded += bytes.byteLength;
      return bytes;
    } finally {
      --this.stats.loading;
      this.waiting.shift()?.();
    }
  }

  // The nodes that are drawn: of the best those that are there.
  private choose(): void {
    const { chooser, drawn, slots } = this;
    if (!chooser) return;
    drawn.length = 0;
    for (let k = 0; k < slots.length && drawn.length < this.mostDrawn; ++k) {
      const slot = slots[chooser.best[k]];
      if (!slot.stored) continue;
      slot.lastUsed = this.frame;
      drawn.push(slot.stored);
    }
  }

  // The next level that is missing: first something of the nodes that are drawn, then all of it,
  // then of those that come next, then something of all others.
  private load(): void {
    const { chooser, slots } = this;
    if (!chooser) return;
    let coming = 0;
    for (let i = 0; i < slots.length; ++i) if (slots[i].coming >= 0) ++coming;
    const count = slots.length;
    const near = Math.min(this.mostDrawn, count), ahead = Math.min(near + kAhead, count);
    for (let pass = 0; pass < 4 && coming < 2; ++pass) {
      const end = pass < 2 ? near : pass === 2 ? ahead : count;
      for (let k = 0; k < end && coming < 2; ++k) {
        const i = chooser.best[k], slot = slots[i];
        if (slot.coming >= 0 || slot.next) continue;
        const level = pass === 0 || pass === 3 ? 0 : Math.max(slot.level + 1, 0);
        if (slot.level >= level || level >= slot.most) continue;
        const bytes = this.expectedBytes(i, level);
        if (!this.makeRoom(bytes, k < near)) return;
        slot.coming = level;
        slot.reserved = bytes;
        this.nodeBytes += bytes;
        ++coming;
        void this.loadLevel(i, level);
      }
    }
  }

  private expectedBytes(node: number, level: number): number {
    const entry = this.manifest?.nodes[node].levels[level] as LevelEntry;
    const { mesh } = entry;
    return (
      textureBytes(entry.faceSize, Boolean(entry.objects && this.options.objects)) +
      kSurfaceStride * mesh.surfaceVertices.count + kSkinStride * mesh.skinVertices.count +
      4 * (mesh.surfaceIndices.count + mesh.skinIndices.count)
    );
  }

  // Those go that were not drawn for longest and are not among the next best. What is drawn is
  // loaded whatever the budget is.
  private makeRoom(bytes: number, needed: boolean): boolean {
    const { chooser, slots } = this;
    const keep = Math.min(this.mostDrawn + kAhead, slots.length);
    while (this.nodeBytes + bytes > this.budget) {
      let oldest = -1;
      for (let k = needed ? this.mostDrawn : keep; k < slots.length; ++k) {
        const i = chooser?.best[k] as number;
        if (slots[i].stored && slots[i].coming < 0 && !slots[i].next &&
            (oldest < 0 || slots[i].lastUsed < slots[oldest].lastUsed))
          oldest = i;
      }
      if (oldest < 0) return needed;
      this.drop(slots[oldest]);
    }
    return true;
  }

  private release(slot: Slot): void {
    this.nodeBytes -= slot.reserved;
    slot.reserved = 0;
  }

  private drop(slot: Slot): void {
    if (!slot.stored) return;
    this.nodeBytes -= slot.stored.bytes;
    deleteNode(this.gl, slot.stored);
    slot.stored = null;
    slot.level = -1;
  }

  private async loadLevel(node: number, level: number): Promise<void> {
    const { generation } = this;
    const slot = this.slots[node];
    const of = this.manifest?.nodes[node];
    const entry = of?.levels[level];
    if (!of || !entry) return;
    const faces: ImageBitmap[] = [];
    try {
      const meshComes = this.fetch(entry.mesh).then((bytes) =>
        this.decoder.mesh(bytes, entry.mesh),
      );
      const weightsCome = this.fetch(entry.weights).then((bytes) =>
        this.decoder.shares(bytes, entry.weights, 3 * entry.faceSize, 2 * entry.faceSize),
      );
      const objectsCome = entry.objects && this.options.objects
        ? this.fetch(entry.objects).then((bytes) =>
            this.decoder.plane16(bytes, entry.objects as FileEntry, 3 * entry.faceSize,
                                 2 * entry.faceSize))
        : null;
      const facesCome = this.fetch(entry.colors).then((bytes) => this.faces(bytes, entry, faces));
      const [mesh, weights, objects] =
        await Promise.all([meshComes, weightsCome, objectsCome, facesCome]);
      if (generation !== this.generation) throw new WalkError("walk", "is another by now");
      const stored = storeNode(this.gl, of.worldFromNode, entry, mesh, weights, objects);
      this.release(slot);
      this.nodeBytes += stored.bytes;
      slot.next = { stored, level, faces };
      slot.coming = -1;
      this.options.onNeedsDraw?.();
    } catch (error) {
      for (const face of faces) face.close();
      if (generation !== this.generation) return;
      this.release(slot);
      slot.coming = -1;
      slot.most = level;
      const told = asWalkError(error, `node ${node}`);
      if (this.firstPicture && this.slots.every((s) => s.most === 0 || s.stored)) {
        this.failed = told;
        this.firstPicture();
        this.firstPicture = null;
      }
      this.options.onError?.(told);
      this.options.onNeedsDraw?.();
    }
  }

  private async faces(bytes: ArrayBuffer, entry: LevelEntry, faces: ImageBitmap[]): Promise<void> {
    const checked = await this.decoder.check(bytes, entry.colors);
    const options: ImageBitmapOptions = {
      premultiplyAlpha: "none", colorSpaceConversion: "none",
    };
    const sheet = await createImageBitmap(new Blob([checked], { type: "image/webp" }), options)
      .catch(() => {
        throw new WalkError(entry.colors.name, "is no WebP picture that this browser reads");
      });
    const size = entry.faceSize;
    if (sheet.width !== 3 * size || sheet.height !== 2 * size)
      throw new WalkError(entry.colors.name, `is not ${3 * size} x ${2 * size} texels large`);
    try {
      for (let f = 0; f < 6; ++f)
        faces.push(
          await createImageBitmap(sheet, (f % 3) * size, Math.floor(f / 3) * size, size, size,
                                  options),
        );
    } finally {
      sheet.close();
    }
  }

  // As many texels a frame as one large face has, which takes a millisecond. The old level is drawn
  // until all six faces are there.
  private upload(): void {
    const { chooser, slots } = this;
    if (!chooser) return;
    for (let k = 0; k < slots.length; ++k) {
      const i = chooser.best[k], slot = slots[i], next = slot.next;
      if (!next) continue;
      const { stored } = next;
      this.options.onNeedsDraw?.();
      const texels = stored.level.faceSize * stored.level.faceSize;
      for (let left = kTexelsAFrame; left > 0 && stored.uploaded < 6; left -= texels) {
        const face = next.faces[stored.uploaded];
        uploadFace(this.gl, stored, face, this.drawer.painter);
        face.close();
      }
      if (stored.uploaded < 6) return;
      this.drawer.painter.finish(stored);
      this.drop(slot);
      slot.stored = stored;
      slot.level = next.level;
      slot.next = null;
      this.options.onPicture?.(i, next.level);
      this.firstPicture?.();
      this.firstPicture = null;
      return;
    }
  }

  private count(): void {
    const { stats, drawer } = this;
    stats.drawCalls = drawer.stats.drawCalls;
    stats.triangles = drawer.stats.triangles;
    stats.drawn = drawer.layers;
    stats.bytes = this.nodeBytes + drawer.bytes + (this.pictures?.bytes ?? 0);
    let nodes = 0;
    for (let i = 0; i < this.slots.length; ++i) if (this.slots[i].stored) ++nodes;
    stats.nodes = nodes;
  }
}

/** A part of the program, as an error of a walk if it does not come. */
function part<Module>(coming: Promise<Module>): Promise<Module> {
  return coming.catch(() => {
    throw new WalkError("program", "a part of it, which belongs beside it, could not be loaded");
  });
}
