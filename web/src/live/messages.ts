// The messages of a live walk (docs/protocol.md). Whatever a server sends is checked here, once.

import { WalkError } from "../errors.js";
import { kProtocol, type Vector } from "../manifest.js";

const kHello = 1, kPose = 2, kDropped = 4, kPing = 5;
const kWelcome = 65, kKeyframe = 66, kPong = 67, kBye = 68;

const kWelcomeBytes = 152, kKeyframeBytes = 160;
const kMostSide = 8192;
/** Identifiers in a message, so that it stays below 4 KiB. */
const kMostIds = 500;
const kFar = 1e12;

/** What a walk is, and where it begins. World space. */
export interface Welcome {
  readonly kind: "welcome";
  readonly name: string;
  readonly low: Vector;
  readonly high: Vector;
  readonly up: Vector;
  readonly eye: Vector;
  readonly target: Vector;
  readonly verticalFov: number;
  readonly zNear: number;
  readonly zFar: number;
  /** Metres. */
  readonly unit: number;
}

/** A picture of a keyframe: colour and depth of one level and one layer, or of a side of what lies around. */
export interface KeyframePart {
  readonly kind: "keyframe";
  readonly fine: boolean;
  /** 1: what lies behind what the first layer shows. */
  readonly layer: number;
  readonly type: "image/jpeg" | "image/webp";
  /** Sides of what lies around share a keyframe; -1: it is no such side. */
  readonly side: number;
  readonly keyframe: bigint;
  readonly id: bigint;
  readonly eye: Vector;
  /** x y z w; from the eye, which looks to -z, into the world. */
  readonly orientation: readonly [number, number, number, number];
  /** On the plane z = -1. */
  readonly left: number;
  readonly right: number;
  readonly bottom: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
  /** Code c > 0 is the disparity (c + offset) step; 0 the sky. */
  readonly step: number;
  readonly offset: number;
  readonly cell: number;
  readonly errorPx: number;
  /** The server's clock, ms. */
  readonly begun: number;
  readonly pose: number;
  /** Where depths and colours begin in the message. */
  readonly depths: { readonly at: number; readonly bytes: number };
  readonly colors: { readonly at: number; readonly bytes: number };
}

export interface Pong {
  readonly kind: "pong";
  readonly sent: number;
  readonly server: number;
}

export interface Bye {
  readonly kind: "bye";
  readonly reason: number;
}

export type ServerMessage = Welcome | KeyframePart | Pong | Bye;

export interface PoseMessage {
  sequence: number;
  time: number;
  readonly eye: Float64Array;
  readonly orientation: Float64Array;
  verticalFov: number;
  aspect: number;
  readonly velocity: Float64Array;
  readonly turnRate: Float64Array;
  latency: number;
  cell: number;
}

/** Reads a message of a server. An error says what is wrong in it. */
export function parseMessage(bytes: ArrayBuffer): ServerMessage {
  const fail = (what: string): never => {
    throw new WalkError("server", `sent a message that is damaged: ${what}`);
  };
  if (bytes.byteLength < 4) fail("it is too short");
  const view = new DataView(bytes);
  const kind = view.getUint8(0), version = view.getUint8(1);
  if (version !== kProtocol)
    throw new WalkError("server", `speaks version ${version} of the protocol, this page ${kProtocol}: load it again`);
  const need = (count: number, name: string) => {
    if (bytes.byteLength < count) fail(`${name} has ${bytes.byteLength} bytes`);
  };
  const checked = (value: number, name: string, least: number, most: number): number =>
    value >= least && value <= most ? value : fail(`${name} is ${value}`);
  const f64 = (at: number, name: string, least = -kFar, most = kFar) => checked(view.getFloat64(at, true), name, least, most);
  const f32 = (at: number, name: string, least = -1e9, most = 1e9) => checked(view.getFloat32(at, true), name, least, most);
  const u16 = (at: number, name: string, least: number, most: number) => checked(view.getUint16(at, true), name, least, most);
  const vector = (at: number, name: string): Vector => [f64(at, name), f64(at + 8, name), f64(at + 16, name)];

  switch (kind) {
    case kWelcome: {
      need(kWelcomeBytes, "welcome");
      const length = view.getUint16(4, true);
      if (bytes.byteLength !== kWelcomeBytes + length) fail("welcome's name");
      return {
        kind: "welcome",
        name: new TextDecoder().decode(new Uint8Array(bytes, kWelcomeBytes, length)),
        low: vector(8, "low"), high: vector(32, "high"), up: vector(56, "up"),
        eye: vector(80, "eye"), target: vector(104, "target"),
        verticalFov: f32(128, "vertical field of view", 0.01, 3),
        zNear: f32(132, "near", 1e-9, 1e9), zFar: f32(136, "far", 1e-9, 1e12),
        unit: f32(140, "unit", 1e-9, 1e9),
      };
    }
    case kKeyframe: {
      need(kKeyframeBytes, "keyframe");
      const depths = view.getUint32(132, true), colors = view.getUint32(136, true);
      if (depths + colors + kKeyframeBytes !== bytes.byteLength) fail("a keyframe's sizes");
      const orientation = [0, 1, 2, 3].map((k) => f32(64 + 4 * k, "orientation", -1.01, 1.01)) as
        [number, number, number, number];
      const norm = Math.hypot(...orientation);
      checked(norm, "orientation's norm", 0.99, 1.01);
      const left = f32(80, "left"), right = f32(84, "right"), bottom = f32(88, "bottom"), top = f32(92, "top");
      if (!(right > left && top > bottom)) fail("a keyframe's window");
      const surround = checked(view.getUint8(7), "role", 0, 1) === 1;
      return {
        kind: "keyframe",
        fine: checked(view.getUint8(4), "level", 0, 1) === 1,
        layer: checked(view.getUint8(5), "layer", 0, 1),
        type: checked(view.getUint8(6), "kind of colours", 1, 2) === 1 ? "image/jpeg" : "image/webp",
        side: surround ? checked(view.getUint8(140), "side", 0, 5) : -1,
        keyframe: view.getBigUint64(8, true), id: view.getBigUint64(16, true),
        eye: vector(40, "eye"),
        orientation: orientation.map((x) => x / norm) as [number, number, number, number],
        left, right, bottom, top,
        width: u16(96, "width", 1, kMostSide), height: u16(98, "height", 1, kMostSide),
        step: f32(100, "step", 1e-30, 1e9), offset: f32(104, "offset", -0.999, 1e9),
        cell: f32(108, "cell", 0, 1e9), errorPx: f32(112, "error", 0, 1e6),
        begun: f64(120, "time"), pose: view.getUint32(128, true),
        depths: { at: kKeyframeBytes, bytes: depths },
        colors: { at: kKeyframeBytes + depths, bytes: colors },
      };
    }
    case kPong:
      need(24, "pong");
      return { kind: "pong", sent: f64(8, "time", -1e15, 1e15), server: f64(16, "time", -1e15, 1e15) };
    case kBye:
      need(8, "bye");
      return { kind: "bye", reason: view.getUint16(4, true) };
    default:
      return fail(`its kind is ${kind}`);
  }
}

function message(kind: number, bytes: number): DataView {
  const view = new DataView(new ArrayBuffer(bytes));
  view.setUint8(0, kind);
  view.setUint8(1, kProtocol);
  return view;
}

export function encodeHello(width: number, height: number, texture: number, memory: number): ArrayBuffer {
  const view = message(kHello, 24);
  view.setUint32(4, width, true);
  view.setUint32(8, height, true);
  view.setUint32(12, texture, true);
  view.setBigUint64(16, BigInt(Math.round(memory)), true);
  return view.buffer as ArrayBuffer;
}

export function encodePose(pose: PoseMessage): ArrayBuffer {
  const view = message(kPose, 104);
  view.setUint32(4, pose.sequence, true);
  view.setFloat64(8, pose.time, true);
  for (let k = 0; k < 3; ++k) view.setFloat64(16 + 8 * k, pose.eye[k], true);
  for (let k = 0; k < 4; ++k) view.setFloat32(40 + 4 * k, pose.orientation[k], true);
  view.setFloat32(56, pose.verticalFov, true);
  view.setFloat32(60, pose.aspect, true);
  for (let k = 0; k < 3; ++k) {
    view.setFloat32(64 + 4 * k, pose.velocity[k], true);
    view.setFloat32(76 + 4 * k, pose.turnRate[k], true);
  }
  view.setFloat32(88, pose.latency, true);
  view.setFloat32(92, pose.cell, true);
  return view.buffer as ArrayBuffer;
}

/** Parts that were there and are not any more, in as many messages as that takes. */
export function encodeDropped(ids: readonly bigint[]): ArrayBuffer[] {
  const made: ArrayBuffer[] = [];
  for (let first = 0; first < ids.length; first += kMostIds) {
    const some = ids.slice(first, first + kMostIds), view = message(kDropped, 8 + 8 * some.length);
    view.setUint32(4, some.length, true);
    some.forEach((id, k) => view.setBigUint64(8 + 8 * k, id, true));
    made.push(view.buffer as ArrayBuffer);
  }
  return made;
}

export function encodePing(time: number): ArrayBuffer {
  const view = message(kPing, 16);
  view.setFloat64(8, time, true);
  return view.buffer as ArrayBuffer;
}
