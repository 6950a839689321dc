// What a live walk's connection is like, shown on demand: a button, or the key I. Where the connection is
// lost it says so by itself.

import type { ConnectionFigures } from "./connection.js";

export interface ShownFigures extends ConnectionFigures {
  /** How old the picture is that is warped, milliseconds; NaN: not known. */
  ageMs: number;
}

const kEveryMs = 500;
/** A connection that is lost for a moment is not worth a word. */
const kFailures = 2;

export function textOf(of: ShownFigures): string {
  if (!of.connected) return "";
  const age = Number.isFinite(of.ageMs) ? `, picture ${(of.ageMs / 1000).toFixed(1)} s old` : "";
  return `${of.roundTripMs.toFixed(0)} ms there and back, ${of.megabits.toFixed(1)} Mbit/s${age}`;
}

export function troubleOf(of: ShownFigures): string {
  if (of.connected || of.failures < kFailures) return "";
  if (of.reason) return `The server ${of.reason}. It is tried again.`;
  return of.received > 0
    ? "The connection is lost. You see what was there; it is tried again."
    : "The server does not answer, or does not let this page in (is the address complete, with its token?). It is tried again.";
}

export class Figures {
  private readonly button = document.createElement("button");
  private readonly line = document.createElement("div");
  private readonly timer: number;
  private open = false;

  constructor(parent: HTMLElement, private readonly ask: () => ShownFigures) {
    this.button.textContent = "i";
    this.button.title = "Latency and bandwidth (I)";
    this.button.style.cssText =
      "position:absolute;right:.6em;top:.6em;width:2em;height:2em;border:0;border-radius:50%;" +
      "background:#20262ea0;color:#e8eaed;font:italic 15px Georgia,serif;cursor:pointer";
    this.line.setAttribute("role", "status");
    this.line.style.cssText =
      "position:absolute;right:3.2em;top:.75em;max-width:80%;padding:.2em .7em;border-radius:8px;background:#20262ee0;" +
      "color:#e8eaed;font:13px/1.5 system-ui,sans-serif;display:none;pointer-events:none";
    parent.append(this.button, this.line);
    this.button.onclick = () => this.toggle();
    window.addEventListener("keydown", this.onKey);
    this.timer = window.setInterval(() => this.show(), kEveryMs);
  }

  dispose(): void {
    clearInterval(this.timer);
    window.removeEventListener("keydown", this.onKey);
    this.button.remove();
    this.line.remove();
  }

  private readonly onKey = (event: KeyboardEvent) => {
    if (event.code === "KeyI" && !event.ctrlKey && !event.metaKey && !event.altKey) this.toggle();
  };

  private toggle(): void {
    this.open = !this.open;
    this.show();
  }

  private show(): void {
    const figures = this.ask();
    const text = troubleOf(figures) || (this.open ? textOf(figures) : "");
    if (this.line.textContent !== text) this.line.textContent = text;
    this.line.style.display = text ? "block" : "none";
  }
}
