// The connection to a server of a live walk: tells where the eye is, hands on what comes, connects again by itself.

import { asWalkError, WalkError } from "../errors.js";
import type { View } from "../gl/program.js";
import { quaternionOf } from "./camera.js";
import {
  encodeDropped, encodePing, encodePose, parseMessage, type KeyframePart, type PoseMessage, type Welcome,
} from "./messages.js";
import { Motion } from "./motion.js";

export interface ConnectionEvents {
  /** The first one, and after each lost connection another: what the server sent before means nothing to it. */
  welcome(welcome: Welcome): void;
  keyframe(part: KeyframePart, message: ArrayBuffer): void;
  failed(error: WalkError): void;
}

/** What the connection is like, for those who ask. */
export interface ConnectionFigures {
  connected: boolean;
  /** Connections that ended, or did not begin, since the last one that was welcomed. */
  failures: number;
  /** There and back, milliseconds; 0: not known yet. */
  roundTripMs: number;
  /** Received in the last two seconds. */
  megabits: number;
  received: number;
  /** What was wrong with the last message, if that ended the connection. */
  reason: string;
}

const kPoseMs = 33, kStopMs = 150, kPingMs = 1000;
/** Without an answer for so long a connection is taken to be dead. */
const kSilenceMs = 15000;
const kFirstWaitMs = 250, kLongestWaitMs = 8000;
const kWindowMs = 2000;

/** The address of a live walk's socket, beside its manifest, with the token of the page's address. */
export function socketAddress(socket: string, base: string, page: string): string {
  const url = new URL(socket, base), from = new URL(page);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  url.search = url.hash = "";
  // Behind # it is in no proxy's log.
  const token = from.searchParams.get("token") ?? new URLSearchParams(from.hash.slice(1)).get("token");
  if (token) url.searchParams.set("token", token);
  return url.href;
}

/** How long to wait after so many failures; `random` from 0 to 1 keeps clients from coming back at once. */
export function waitAfter(failures: number, random: number): number {
  return Math.min(kLongestWaitMs, kFirstWaitMs * 2 ** Math.max(0, failures - 1)) * (0.75 + 0.5 * random);
}

export class LiveConnection {
  readonly figures: ConnectionFigures = { connected: false, failures: 0, roundTripMs: 0, megabits: 0, received: 0, reason: "" };
  private socket: WebSocket | null = null;
  private disposed = false;
  private welcomed = false;
  private timers: { again: number; pose: number; stop: number; ping: number } = { again: 0, pose: 0, stop: 0, ping: 0 };
  private lastHeard = 0;
  private lastPose = -Infinity;
  private clockAhead = NaN;
  private seenAt = 0;
  private began = false;
  private width = 0;
  private height = 0;
  private readonly arrivals: { at: number; bytes: number }[] = [];
  private readonly before = new Float64Array(16);
  private readonly motion = new Motion();
  private readonly message: PoseMessage = {
    sequence: 0, time: 0, eye: new Float64Array(3), orientation: new Float64Array(4), verticalFov: 1, aspect: 1,
    velocity: this.motion.velocity, turnRate: this.motion.turnRate, latency: 0, cell: 0,
  };

  constructor(private readonly url: string, private readonly hello: () => ArrayBuffer,
              private readonly events: ConnectionEvents) {
    this.timers.ping = window.setInterval(() => this.ping(), kPingMs);
    this.open();
  }

  /** Where the eye is: as often as frames are drawn. */
  look(view: View): void {
    const { before, message } = this, e = view.worldFromEye, p = view.clipFromEye;
    const now = performance.now(), seconds = (now - this.seenAt) / 1000;
    // Controls that do not stand anywhere yet have no axes.
    if (!(Math.abs(Math.hypot(e[0], e[1], e[2]) - 1) < 1e-3) || !Number.isFinite(e[12] + e[13] + e[14])) return;
    let moved = !this.began;
    for (let k = 0; k < 16; ++k) if (e[k] !== before[k]) moved = true;
    const fov = 2 * Math.atan(1 / p[5]), aspect = p[5] / p[0];
    if (fov !== message.verticalFov || aspect !== message.aspect) moved = true;
    if (view.width !== this.width || view.height !== this.height) {
      this.width = view.width;
      this.height = view.height;
      if (this.figures.connected) this.send(this.hello());
    }
    if (!moved) return;
    this.motion.see(e, seconds);
    for (let k = 0; k < 16; ++k) before[k] = e[k];
    this.seenAt = now;
    this.began = true;
    message.eye.set([e[12], e[13], e[14]]);
    quaternionOf(e, message.orientation);
    message.verticalFov = fov;
    message.aspect = aspect;
    this.poseSoon();
    // Frames end where nothing moves: then it stands.
    clearTimeout(this.timers.stop);
    this.timers.stop = window.setTimeout(() => {
      this.motion.stop();
      this.poseSoon();
    }, kStopMs);
  }

  /** Parts that are not held any more. */
  dropped(ids: readonly bigint[]): void {
    if (this.figures.connected) for (const message of encodeDropped(ids)) this.send(message);
  }

  /** Everything anew. */
  restart(): void {
    this.socket?.close();
    this.lost(this.socket);
  }

  /** Milliseconds since the server's clock showed `time`; NaN: not known yet. */
  age(time: number): number {
    return performance.now() + this.clockAhead - time;
  }

  /** Brings `figures` up to date. */
  count(): ConnectionFigures {
    const { arrivals, figures } = this, first = performance.now() - kWindowMs;
    while (arrivals.length && arrivals[0].at < first) arrivals.shift();
    figures.megabits = (8e-3 * arrivals.reduce((sum, { bytes }) => sum + bytes, 0)) / kWindowMs;
    return figures;
  }

  dispose(): void {
    this.disposed = true;
    clearInterval(this.timers.ping);
    clearTimeout(this.timers.again);
    clearTimeout(this.timers.pose);
    clearTimeout(this.timers.stop);
    this.socket?.close();
  }

  private open(): void {
    if (this.disposed) return;
    let socket: WebSocket;
    try {
      socket = new WebSocket(this.url);
    } catch (error) {
      this.events.failed(asWalkError(error, "server"));
      return;
    }
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.lastHeard = performance.now();
      this.send(this.hello());
      this.ping();
      if (this.began) this.sendPose();
    };
    socket.onmessage = ({ data }) => this.receive(data);
    socket.onclose = () => this.lost(socket);
  }

  private lost(socket: WebSocket | null): void {
    if (this.disposed || socket !== this.socket) return;
    this.socket = null;
    this.welcomed = false;
    this.figures.connected = false;
    ++this.figures.failures;
    clearTimeout(this.timers.again);
    this.timers.again = window.setTimeout(() => this.open(), waitAfter(this.figures.failures, Math.random()));
  }

  private receive(data: unknown): void {
    this.lastHeard = performance.now();
    try {
      if (!(data instanceof ArrayBuffer)) throw new WalkError("server", "sent text instead of numbers");
      this.arrivals.push({ at: this.lastHeard, bytes: data.byteLength });
      this.figures.received += data.byteLength;
      const message = parseMessage(data);
      if (!this.welcomed && message.kind === "keyframe") throw new WalkError("server", "sent a keyframe before its welcome");
      switch (message.kind) {
        case "welcome":
          this.welcomed = true;
          this.figures.connected = true;
          this.figures.failures = 0;
          this.figures.reason = "";
          this.motion.unit = message.unit;
          this.events.welcome(message);
          if (!this.began) this.stand(message);
          this.sendPose();
          return;
        case "keyframe":
          this.events.keyframe(message, data);
          return;
        case "pong": {
          const there = this.lastHeard - message.sent;
          this.figures.roundTripMs = there;
          this.clockAhead = message.server - (message.sent + 0.5 * there);
          return;
        }
        case "bye":
          return;
      }
    } catch (error) {
      const told = asWalkError(error, "server");
      this.figures.reason = told.reason;
      this.events.failed(told);
      // Whoever sends what is damaged once may do so again: from the beginning, and not at once.
      this.socket?.close();
      this.lost(this.socket);
    }
  }

  // Until the first frame the eye stands where the walk begins.
  private stand(welcome: Welcome): void {
    const { message } = this, { eye, target, up } = welcome;
    const unit = (v: number[]) => v.map((x) => x / (Math.hypot(...v) || 1));
    const cross = (a: ArrayLike<number>, b: ArrayLike<number>) =>
      [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const back = unit([eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]]);
    const right = unit(cross(up, back)), above = cross(back, right);
    message.eye.set(eye);
    quaternionOf([...right, 0, ...above, 0, ...back, 0, 0, 0, 0, 1], message.orientation);
    message.verticalFov = welcome.verticalFov;
    message.aspect = window.innerWidth / Math.max(1, window.innerHeight);
  }

  private ping(): void {
    if (this.socket?.readyState !== WebSocket.OPEN) return;
    if (performance.now() - this.lastHeard > kSilenceMs) {
      this.restart();
      return;
    }
    this.send(encodePing(performance.now()));
  }

  private poseSoon(): void {
    if (!this.figures.connected || this.timers.pose) return;
    const wait = this.lastPose + kPoseMs - performance.now();
    if (wait <= 0) {
      this.sendPose();
      return;
    }
    this.timers.pose = window.setTimeout(() => {
      this.timers.pose = 0;
      this.sendPose();
    }, wait);
  }

  private sendPose(): void {
    const { message } = this;
    message.sequence = (message.sequence + 1) >>> 0;
    message.time = this.lastPose = performance.now();
    message.latency = 0.5 * this.figures.roundTripMs;
    this.send(encodePose(message));
  }

  private send(bytes: ArrayBuffer): void {
    // What the network does not take now would be out of date when it does.
    if (this.socket?.readyState === WebSocket.OPEN && this.socket.bufferedAmount < 65536) this.socket.send(bytes);
  }
}
