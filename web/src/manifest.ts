// The manifest of a walk, schema `rilievo-walk-1`. Whatever a server sends is checked here, once.

import { WalkError } from "./errors.js";
import { kReliefBlock, type SheetEntry } from "./reliefs/samples.js";
import type { LinkLimits } from "./views/surface.js";

/** The version of a live walk's messages (docs/protocol.md). */
export const kProtocol = 1;

export type Vector = readonly [number, number, number];

/** A file of a walk; `name` is relative to the manifest. */
export interface FileEntry {
  readonly name: string;
  readonly bytes: number;
}

export interface StreamEntry {
  readonly bytes: number;
  readonly count: number;
}

/** A node's mesh: four streams of meshoptimizer, one behind the other. */
export interface MeshEntry extends FileEntry {
  readonly surfaceVertices: StreamEntry;
  readonly surfaceIndices: StreamEntry;
  readonly skinVertices: StreamEntry;
  readonly skinIndices: StreamEntry;
  /** Triangles of each side, +x -x +y -y +z -z. */
  readonly surfaces: readonly number[];
  readonly skins: readonly number[];
  readonly disparityStep: number;
}

/** A node in one resolution. */
export interface LevelEntry {
  /** Texels a side of a face. */
  readonly faceSize: number;
  readonly colors: FileEntry;
  readonly mesh: MeshEntry;
  readonly weights: FileEntry & { readonly steps: number };
  readonly objects: FileEntry | null;
  /** The error of the mesh for an eye `reach` metres away, in texels. */
  readonly errorPx: number;
  readonly reach: number;
}

export interface NodeEntry {
  /** Column by column. */
  readonly worldFromNode: Float64Array;
  readonly eye: Vector;
  /** The coarsest first. */
  readonly levels: readonly LevelEntry[];
}

export interface SketchesEntry extends FileEntry {
  readonly size: number;
  readonly near: number;
  readonly far: number;
}

/** A picture with depth. */
export interface PictureEntry {
  readonly worldFromEye: Float64Array;
  /** The window on the plane z = -1. */
  readonly left: number;
  readonly right: number;
  readonly bottom: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
  /** Sides of a texel on that plane. */
  readonly du: number;
  readonly dv: number;
  readonly zNear: number;
  readonly zFar: number;
  readonly colors: FileEntry;
  /** Code c > 0 is the disparity least + (c - 1) step, 1/m. */
  readonly depths: FileEntry & { readonly least: number; readonly step: number };
  readonly backPerspective: boolean;
  readonly complete: boolean;
  /** Its empty texels may show what is seen from behind only. */
  readonly seesThrough: boolean;
  /** Towards the viewers whom it serves. */
  readonly direction: Vector;
  /** Of a nailboard's polygon. */
  readonly planeZ: number;
}

/** Pictures that are drawn together. */
export interface PicturesEntry {
  readonly drawn: "surfaces" | "nailboards";
  readonly low: Vector;
  readonly high: Vector;
  readonly center: Vector;
  /** Metres by which what is drawn may reach over the bounds. */
  readonly slack: number;
  /** Radians in which pictures fade into each other. */
  readonly handover: number;
  readonly links: LinkLimits;
  readonly list: readonly PictureEntry[];
}

/** A layered relief. */
export interface ReliefEntry extends SheetEntry {
  readonly worldFromEye: Float64Array;
  readonly perspective: boolean;
  /** The window; of a perspective one on the plane z = -1. */
  readonly left: number;
  readonly right: number;
  readonly bottom: number;
  readonly top: number;
  readonly planeZ: number;
  /** Its splats are so many times as large as the set's. */
  readonly splatScale: number;
  /** Code c > 0 is the displacement first + (c - 1) step. */
  readonly first: number;
  readonly step: number;
  /** u, v, displacement. */
  readonly hull: readonly Vector[];
  readonly colors: FileEntry;
  readonly codes: FileEntry;
  readonly layers: FileEntry;
}

/** Reliefs of one object, of which one is drawn. */
export interface ReliefsEntry {
  readonly low: Vector;
  readonly high: Vector;
  readonly center: Vector;
  /** The side of a splat, texels of a relief. */
  readonly splat: number;
  /** Texels of what is drawn for one of a relief, and at most along a side. */
  readonly resolution: number;
  readonly maxSize: number;
  readonly list: readonly ReliefEntry[];
}

/** A walk whose pictures a server makes while an eye walks. */
export interface LiveEntry {
  /** The address of its WebSocket, relative to the manifest. */
  readonly socket: string;
  /** Metres of a unit of length; of a manifest that a server's welcome has completed. */
  readonly unit: number;
}

/** A sky of two colours, blended by elevation; linear. */
export interface SkyEntry {
  readonly zenith: Vector;
  readonly horizon: Vector;
  readonly ground: Vector;
}

export interface Manifest {
  readonly name: string;
  readonly up: Vector;
  readonly start: {
    readonly eye: Vector;
    readonly target: Vector;
    /** Radians. */
    readonly verticalFov: number;
    readonly zNear: number;
    readonly zFar: number;
  };
  readonly nodes: readonly NodeEntry[];
  /** Of the nodes; null: there are none, but an object alone. */
  readonly sketches: SketchesEntry | null;
  /** Behind what nodes show; null: the viewer's own. */
  readonly sky: SkyEntry | null;
  /** Of an object, alone or among the nodes. */
  readonly pictures: PicturesEntry | null;
  readonly reliefs: ReliefsEntry | null;
  /** Where a walk begins the server says. */
  readonly live: LiveEntry | null;
}

type Json = Record<string, unknown>;

const kMostFileBytes = 1 << 30;
const kMostElements = 1 << 26;

/** Reads a manifest; an error names what is wrong in it. */
export function parseManifest(text: string, where: string): Manifest {
  const fail = (what: string): never => {
    throw new WalkError(where, what);
  };
  const object = (value: unknown, name: string): Json =>
    typeof value === "object" && value !== null && !Array.isArray(value)
      ? (value as Json)
      : fail(`${name} is no object`);
  const list = (value: unknown, name: string): unknown[] =>
    Array.isArray(value) ? value : fail(`${name} is no list`);
  const number = (value: unknown, name: string, least = -Infinity, most = Infinity): number =>
    typeof value === "number" && Number.isFinite(value) && value >= least && value <= most
      ? value
      : fail(`${name} is no number${least > -Infinity ? ` from ${least} to ${most}` : ""}`);
  const count = (value: unknown, name: string, most = kMostElements): number => {
    const n = number(value, name, 0, most);
    return Number.isInteger(n) ? n : fail(`${name} is no whole number`);
  };
  const vector = (value: unknown, name: string): Vector => {
    const v = list(value, name);
    if (v.length !== 3) fail(`${name} has not three numbers`);
    return [number(v[0], name), number(v[1], name), number(v[2], name)];
  };
  const file = (value: unknown, name: string): FileEntry => {
    const entry = object(value, name);
    const path = entry.file;
    // Nothing outside the walk's own folder.
    if (typeof path !== "string" || !/^[\w-]+(\/[\w-]+)*\.\w+$/.test(path))
      return fail(`${name} names no file beside the manifest`);
    return { name: path, bytes: count(entry.bytes, `${name}.bytes`, kMostFileBytes) };
  };
  const stream = (value: unknown, name: string): StreamEntry => {
    const entry = object(value, name);
    return {
      bytes: count(entry.bytes, `${name}.bytes`, kMostFileBytes),
      count: count(entry.count, `${name}.count`),
    };
  };
  const sides = (value: unknown, name: string, indices: number): number[] => {
    const counts = list(value, name).map((n) => count(n, name));
    if (counts.length !== 6 || 3 * counts.reduce((a, b) => a + b, 0) !== indices)
      fail(`${name} is not the triangles of six sides`);
    return counts;
  };
  const mesh = (value: unknown, name: string): MeshEntry => {
    const entry = object(value, name);
    const made = {
      ...file(entry, name),
      surfaceVertices: stream(entry.surface_vertices, `${name}.surface_vertices`),
      surfaceIndices: stream(entry.surface_indices, `${name}.surface_indices`),
      skinVertices: stream(entry.skin_vertices, `${name}.skin_vertices`),
      skinIndices: stream(entry.skin_indices, `${name}.skin_indices`),
      disparityStep: number(entry.disparity_step, `${name}.disparity_step`, 0, 1e30),
    };
    const inside =
      made.surfaceVertices.bytes + made.surfaceIndices.bytes + made.skinVertices.bytes +
      made.skinIndices.bytes;
    if (inside !== made.bytes) fail(`${name}.bytes is not the sum of its streams`);
    return {
      ...made,
      surfaces: sides(entry.surfaces, `${name}.surfaces`, made.surfaceIndices.count),
      skins: sides(entry.skins, `${name}.skins`, made.skinIndices.count),
    };
  };

  const weights = (value: unknown, name: string) => ({
    ...file(value, name),
    steps: Math.max(1, count(object(value, name).steps, `${name}.steps`, 65535)),
  });

  const skyOf = (of: Json): SkyEntry => {
    const color = (name: string): Vector => vector(of[name], `sky.${name}`);
    return { zenith: color("zenith"), horizon: color("horizon"), ground: color("ground") };
  };
  const matrix = (value: unknown, name: string): Float64Array => {
    const numbers = list(value, name).map((n) => number(n, name));
    if (numbers.length !== 16) fail(`${name} has not 16 numbers`);
    return Float64Array.from(numbers);
  };
  const windowOf = (of: Json, name: string) => {
    const [left, right, bottom, top] = list(of.window, `${name}.window`).map((n) =>
      number(n, `${name}.window`, -1e9, 1e9));
    if (!(right > left && top > bottom)) fail(`${name}.window is empty`);
    return { left, right, bottom, top };
  };
  const sizeOf = (value: unknown, name: string, most: number): [number, number] => {
    const [width, height] = list(value, name).map((n) => count(n, name, most));
    return width > 0 && height > 0 ? [width, height] : fail(`${name} is empty`);
  };
  const boundsOf = (value: unknown, name: string) => {
    const corners = list(value, name), low = vector(corners[0], name), high = vector(corners[1], name);
    const middle = (k: 0 | 1 | 2) => 0.5 * (low[k] + high[k]);
    return { low, high, center: [middle(0), middle(1), middle(2)] as Vector };
  };
  const pictureOf = (value: unknown, name: string, surfaces: boolean): PictureEntry => {
    const of = object(value, name), depths = object(of.depths, `${name}.depths`);
    const window = windowOf(of, name), [width, height] = sizeOf(of.size, `${name}.size`, 8192);
    return {
      worldFromEye: matrix(of.world_from_eye, `${name}.world_from_eye`),
      ...window, width, height,
      du: (window.right - window.left) / width, dv: (window.top - window.bottom) / height,
      zNear: number(of.z_near, `${name}.z_near`, 1e-12, 1e12),
      zFar: number(of.z_far, `${name}.z_far`, 1e-12, 1e12),
      colors: file(of.colors, `${name}.colors`),
      depths: {
        ...file(depths, `${name}.depths`),
        least: number(depths.least, `${name}.depths.least`, 0, 1e30),
        step: number(depths.step, `${name}.depths.step`, 0, 1e30),
      },
      backPerspective: of.back_perspective === true,
      complete: of.complete === true,
      seesThrough: of.sees_through === true,
      direction: surfaces ? vector(of.direction, `${name}.direction`) : [0, 0, 0],
      planeZ: surfaces ? 1 : number(of.plane_z, `${name}.plane_z`, 1e-12, 1e12),
    };
  };
  const picturesOf = (of: Json): PicturesEntry => {
    const { drawn } = of;
    if (drawn !== "surfaces" && drawn !== "nailboards")
      return fail(`pictures.drawn is ${JSON.stringify(drawn)}, which this viewer cannot draw`);
    const surfaces = drawn === "surfaces";
    const bounds = boundsOf(of.bounds, "pictures.bounds"), { low, high } = bounds;
    const links = surfaces ? object(of.links, "pictures.links") : {};
    const limit = (name: string) =>
      surfaces ? number(links[name], `pictures.links.${name}`, 0, 1e9) : 0;
    const made = list(of.list, "pictures.list").map((value, i) =>
      pictureOf(value, `pictures.list[${i}]`, surfaces));
    if (made.length === 0) fail("pictures.list is empty");
    return {
      drawn, ...bounds,
      // Rounding must not cut off what lies on a face of the bounds.
      slack: 0.5e-4 * Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]) + 1e-9,
      handover: surfaces ? number(of.handover, "pictures.handover", 0, 7) : 0,
      links: { gentle: limit("gentle"), steepest: limit("steepest"), growth: limit("growth") },
      list: made,
    };
  };

  const reliefOf = (value: unknown, name: string): ReliefEntry => {
    const of = object(value, name);
    const [width, height] = sizeOf(of.size, `${name}.size`, 32768);
    const [sheetWidth, sheetHeight] = sizeOf(of.sheet, `${name}.sheet`, 4096);
    if ((sheetWidth | sheetHeight) % kReliefBlock) fail(`${name}.sheet has parts of blocks`);
    const perspective = of.projection === "perspective";
    if (!perspective && of.projection !== "parallel") fail(`${name}.projection is not known`);
    const hull = list(of.hull, `${name}.hull`).map((corner) => vector(corner, `${name}.hull`));
    if (hull.length === 0) fail(`${name}.hull is empty`);
    const samples = count(of.samples, `${name}.samples`, sheetWidth * sheetHeight);
    return {
      worldFromEye: matrix(of.world_from_eye, `${name}.world_from_eye`),
      perspective, ...windowOf(of, name), width, height, sheetWidth, sheetHeight, samples, hull,
      planeZ: number(of.plane_z, `${name}.plane_z`, -1e12, 1e12),
      // None in walks from before there were any.
      splatScale: of.splat_scale === undefined ? 1 : number(of.splat_scale, `${name}.splat_scale`, 0.01, 64),
      first: number(of.first, `${name}.first`, -1e30, 1e30),
      step: number(of.step, `${name}.step`, 1e-30, 1e30),
      colors: file(of.colors, `${name}.colors`),
      codes: file(of.codes, `${name}.codes`),
      layers: file(of.layers, `${name}.layers`),
    };
  };
  const reliefsOf = (of: Json): ReliefsEntry => {
    const made = list(of.list, "reliefs.list").map((value, i) => reliefOf(value, `reliefs.list[${i}]`));
    if (made.length === 0) fail("reliefs.list is empty");
    return {
      ...boundsOf(of.bounds, "reliefs.bounds"),
      splat: number(of.splat, "reliefs.splat", 0.01, 64),
      resolution: number(of.resolution, "reliefs.resolution", 0.01, 64),
      maxSize: Math.max(16, count(of.max_size, "reliefs.max_size", 4096)),
      list: made,
    };
  };

  const liveOf = (of: Json): LiveEntry => {
    if (of.protocol !== kProtocol)
      fail(`its server speaks version ${JSON.stringify(of.protocol)} of the protocol, this page ${kProtocol}: load it again`);
    // Nothing outside the walk's own folder.
    if (typeof of.socket !== "string" || !/^[\w-]+(\/[\w-]+)*$/.test(of.socket))
      return fail("live.socket is no address beside the manifest");
    return { socket: of.socket, unit: 1 };
  };

  let parsed: unknown;
  try {
    parsed = JSON.parse(text);
  } catch {
    fail("is not JSON: perhaps it is cut short, or a page that says that there is no such file");
  }
  const root = object(parsed, "the manifest");
  if (root.schema !== "rilievo-walk-1")
    fail(`its schema is ${JSON.stringify(root.schema) ?? "missing"}, not "rilievo-walk-1"`);
  const live = root.live === undefined ? null : liveOf(object(root.live, "live"));
  const start = live ? {} : object(root.start, "start");
  const pictures = root.pictures === undefined ? null : picturesOf(object(root.pictures, "pictures"));
  const reliefs = root.reliefs === undefined ? null : reliefsOf(object(root.reliefs, "reliefs"));
  // Nodes, an object, or an object among nodes.
  const others = pictures ?? reliefs ?? live, alone = others !== null && root.nodes === undefined;
  const sketches = alone ? null : object(root.sketches, "sketches");
  const nodes = (alone ? [] : list(root.nodes, "nodes")).map((value, i): NodeEntry => {
    const name = `nodes[${i}]`;
    const node = object(value, name);
    const worldFromNode = matrix(node.world_from_node, `${name}.world_from_node`);
    const levels = list(node.levels, `${name}.levels`).map((of, k): LevelEntry => {
      const level = object(of, `${name}.levels[${k}]`);
      return {
        faceSize: Math.max(1, count(level.face_size, `${name}.levels[${k}].face_size`, 4096)),
        colors: file(level.colors, `${name}.levels[${k}].colors`),
        mesh: mesh(level.mesh, `${name}.levels[${k}].mesh`),
        weights: weights(level.weights, `${name}.levels[${k}].weights`),
        objects: level.objects === undefined ? null : file(level.objects, `${name}.objects`),
        errorPx: number(level.error_px, `${name}.levels[${k}].error_px`),
        reach: number(level.reach, `${name}.levels[${k}].reach`),
      };
    });
    if (levels.length === 0) fail(`${name} has no level`);
    return {
      worldFromNode,
      eye: [worldFromNode[12], worldFromNode[13], worldFromNode[14]],
      levels,
    };
  });
  if (!alone && nodes.length === 0) fail("it has no node");
  return {
    name: typeof root.name === "string" ? root.name : "",
    up: live ? [0, 1, 0] : vector(root.up, "up"),
    start: live ? { eye: [0, 0, 0], target: [0, 0, -1], verticalFov: 0.9, zNear: 0.1, zFar: 1000 } : {
      eye: vector(start.eye, "start.eye"),
      target: vector(start.target, "start.target"),
      verticalFov: number(start.vertical_fov, "start.vertical_fov", 0.01, 3),
      zNear: number(start.z_near, "start.z_near", 1e-9, 1e9),
      zFar: number(start.z_far, "start.z_far", 1e-9, 1e12),
    },
    nodes,
    sky: root.sky === undefined ? null : skyOf(object(root.sky, "sky")),
    pictures,
    reliefs,
    live,
    sketches: sketches && {
      ...file(sketches, "sketches"),
      size: Math.max(1, count(sketches.size, "sketches.size", 256)),
      near: number(sketches.near, "sketches.near", 1e-30, 1e30),
      far: number(sketches.far, "sketches.far", 1e-30, 1e30),
    },
  };
}
