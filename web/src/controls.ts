// An eye that walks: keys, pointer, touch and gamepad. Turns about `up`; speeds are a person's.

import type { Vector } from "./manifest.js";

const kWalk = 1.4;  // m/s
const kTurn = 1.6;  // rad/s, by keys and gamepad
const kPerPixel = 0.004;  // rad
const kMostPitch = 1.5;
const kDeadZone = 0.15;
const kNone: readonly never[] = [];

const kKeys: Record<string, readonly [axis: string, amount: number]> = {
  KeyW: ["ahead", 1], ArrowUp: ["ahead", 1], KeyS: ["ahead", -1], ArrowDown: ["ahead", -1],
  KeyD: ["aside", 1], KeyA: ["aside", -1], KeyE: ["above", 1], PageUp: ["above", 1],
  KeyQ: ["above", -1], PageDown: ["above", -1], ArrowLeft: ["turn", 1], ArrowRight: ["turn", -1],
};

/** As WebXR's input sources. */
export interface Controller {
  readonly handedness: string;
  readonly gamepad?: { readonly axes: ArrayLike<number> };
}

function cross(a: ArrayLike<number>, b: ArrayLike<number>): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function unit(v: ArrayLike<number>): Vector {
  const length = Math.hypot(v[0], v[1], v[2]) || 1;
  return [v[0] / length, v[1] / length, v[2] / length];
}

export class WalkControls {
  readonly eye = new Float64Array(3);
  /** Metres a second; keys with shift go three times as fast. */
  speed = kWalk;
  yaw = 0;
  pitch = 0;
  readonly worldFromEye = new Float64Array(16);

  private up: Vector = [0, 1, 0];
  private north: Vector = [0, 0, -1];
  private east: Vector = [1, 0, 0];
  private readonly held = new Set<string>();
  private readonly touches = new Map<number, { x: number; y: number }>();
  private readonly removers: (() => void)[] = [];
  private spread = 0;
  private plugged = false;

  /** `moved` is called when something was pressed or dragged. */
  constructor(element: HTMLElement, private readonly moved: () => void) {
    element.tabIndex = 0;
    element.style.touchAction = "none";
    element.style.outline = "none";
    const on = <T extends Event>(target: EventTarget, type: string, act: (event: T) => void,
                                 options?: AddEventListenerOptions) => {
      target.addEventListener(type, act as EventListener, options);
      this.removers.push(() => target.removeEventListener(type, act as EventListener, options));
    };
    on<KeyboardEvent>(window, "keydown", (event) => {
      if (!kKeys[event.code] || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      this.held.add(event.code);
      if (event.shiftKey) this.held.add("Shift");
      this.moved();
    });
    on<KeyboardEvent>(window, "keyup", (event) => {
      this.held.delete(event.code);
      if (event.key === "Shift") this.held.delete("Shift");
    });
    on(window, "blur", () => this.held.clear());
    on(window, "gamepadconnected", () => {
      this.plugged = true;
      this.moved();
    });
    on<PointerEvent>(element, "pointerdown", (event) => {
      this.touches.set(event.pointerId, { x: event.clientX, y: event.clientY });
      this.spread = this.fingersApart();
      element.setPointerCapture?.(event.pointerId);
      element.focus({ preventScroll: true });
    });
    on<PointerEvent>(element, "pointermove", (event) => this.drag(event));
    for (const type of ["pointerup", "pointercancel"])
      on<PointerEvent>(element, type, (event) => {
        this.touches.delete(event.pointerId);
        this.spread = this.fingersApart();
      });
    on<WheelEvent>(element, "wheel", (event) => {
      event.preventDefault();
      this.step(-0.002 * event.deltaY * this.speed, 0, 0);
      this.moved();
    }, { passive: false });
  }

  /** Stands at `eye` and looks at `target`. */
  stand(eye: ArrayLike<number>, target: ArrayLike<number>, up: Vector): void {
    this.up = unit(up);
    const forward = unit([target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]]);
    const height = forward[0] * this.up[0] + forward[1] * this.up[1] + forward[2] * this.up[2];
    let east = cross(forward, this.up);
    if (Math.hypot(...east) < 1e-6) east = cross([this.up[1], this.up[2], this.up[0]], this.up);
    this.east = unit(east);
    this.north = unit(cross(this.up, this.east));
    this.yaw = 0;
    this.pitch = Math.max(-kMostPitch, Math.min(kMostPitch, Math.asin(Math.max(-1, Math.min(1, height)))));
    this.eye.set(eye);
    this.place();
  }

  /** Moves by what is held, and by controllers of a headset, for `seconds`. Did it? */
  advance(seconds: number, controllers?: Iterable<Controller>): boolean {
    let ahead = 0, aside = 0, above = 0, turn = 0, look = 0;
    for (const code of this.held) {
      const [axis, amount] = kKeys[code] ?? ["", 0];
      if (axis === "ahead") ahead += amount;
      if (axis === "aside") aside += amount;
      if (axis === "above") above += amount;
      if (axis === "turn") turn += amount;
    }
    for (const pad of this.pads) {
      if (!pad) continue;
      const axis = (k: number) => {
        const value = pad.axes[k] ?? 0;
        return Math.abs(value) > kDeadZone ? value : 0;
      };
      aside += axis(0);
      ahead -= axis(1);
      turn -= axis(2);
      look -= axis(3);
    }
    for (const { gamepad, handedness } of controllers ?? kNone) {
      // The left stick walks, the right one turns.
      const x = gamepad?.axes[2] ?? 0, y = gamepad?.axes[3] ?? 0;
      if (Math.hypot(x, y) < kDeadZone) continue;
      if (handedness === "right") turn -= x;
      else aside += x, ahead -= y;
    }
    if (!ahead && !aside && !above && !turn && !look) return false;
    const way = seconds * this.speed * (this.held.has("Shift") ? 3 : 1);
    this.turn(turn * kTurn * seconds, look * kTurn * seconds);
    this.step(ahead * way, aside * way, above * way);
    return true;
  }

  /** Where the eye stands, upright: the space of a headset that begins there, into the world. */
  standing(out: Float64Array): void {
    const { pitch } = this;
    this.pitch = 0;
    this.place();
    out.set(this.worldFromEye);
    this.pitch = pitch;
    this.place();
  }

  /** Is anything held or a gamepad there, so that frames go on? */
  get active(): boolean {
    if (this.held.size > 0 || this.touches.size > 0) return true;
    for (const pad of this.pads) if (pad) return true;
    return false;
  }

  dispose(): void {
    for (const remove of this.removers) remove();
  }

  // Those that have been told of: asking makes garbage.
  private get pads(): readonly (Gamepad | null)[] {
    return this.plugged ? navigator.getGamepads() : kNone;
  }

  private drag(event: PointerEvent): void {
    const from = this.touches.get(event.pointerId);
    if (!from) return;
    const dx = event.clientX - from.x, dy = event.clientY - from.y;
    from.x = event.clientX;
    from.y = event.clientY;
    if (this.touches.size > 1) {
      // Two fingers: together they shift the eye, apart they take it ahead.
      const share = 1 / this.touches.size, spread = this.fingersApart();
      this.step(0.01 * (spread - this.spread) + 0.01 * dy * share, -0.01 * dx * share, 0);
      this.spread = spread;
    } else {
      this.turn(dx * kPerPixel, dy * kPerPixel);
    }
    this.moved();
  }

  private fingersApart(): number {
    if (this.touches.size !== 2) return 0;
    const [a, b] = [...this.touches.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  }

  private turn(yaw: number, pitch: number): void {
    this.yaw += yaw;
    this.pitch = Math.max(-kMostPitch, Math.min(kMostPitch, this.pitch + pitch));
    this.place();
  }

  private step(ahead: number, aside: number, above: number): void {
    const m = this.worldFromEye;
    for (let k = 0; k < 3; ++k)
      this.eye[k] += -m[8 + k] * ahead + m[k] * aside + this.up[k] * above;
    this.place();
  }

  private place(): void {
    const { north, east, up, worldFromEye: m } = this;
    const cy = Math.cos(this.yaw), sy = Math.sin(this.yaw);
    const cp = Math.cos(this.pitch), sp = Math.sin(this.pitch);
    for (let k = 0; k < 3; ++k) {
      const level = north[k] * cy - east[k] * sy;
      m[k] = east[k] * cy + north[k] * sy;
      m[4 + k] = up[k] * cp - level * sp;
      m[8 + k] = -(level * cp + up[k] * sp);
      m[12 + k] = this.eye[k];
    }
    m[3] = m[7] = m[11] = 0;
    m[15] = 1;
  }
}
