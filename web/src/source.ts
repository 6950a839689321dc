// Who delivers pictures. A walk asks for files by their content's name; static files answer here,
// and a server that renders while an eye walks can answer likewise, and tell of new pictures.

import { WalkError, asWalkError } from "./errors.js";
import { parseManifest, type FileEntry, type Manifest } from "./manifest.js";

/** Where the eye is: for sources that choose what to send next. World space. */
export interface EyePose {
  readonly eye: ArrayLike<number>;
  readonly forward: ArrayLike<number>;
}

/** Delivers a walk. Methods may be called again after an error. */
export interface PictureSource {
  /** What addresses in the manifest are relative to; else the page's own. */
  readonly base?: string;
  /** What there is. */
  manifest(signal: AbortSignal): Promise<Manifest>;
  /** The bytes of a file; as many as its entry says. */
  file(entry: FileEntry, signal: AbortSignal): Promise<ArrayBuffer>;
  /** Called once: the source calls `changed` when manifest() has more to say than before. */
  watch?(changed: () => void): void;
  /** Where the eye is now; often. */
  pose?(pose: EyePose): void;
  close(): void;
}

/** Files beside each other on any web host. */
export class StaticSource implements PictureSource {
  readonly base: string;

  /** `url` of the manifest, or of the folder that holds it, relative to the page. */
  constructor(url: string | URL) {
    const whole = new URL(url, document.baseURI);
    if (!whole.pathname.endsWith(".json")) {
      if (!whole.pathname.endsWith("/")) whole.pathname += "/";
      whole.pathname += "walk.json";
    }
    this.base = whole.href;
  }

  async manifest(signal: AbortSignal): Promise<Manifest> {
    const response = await this.get("walk.json", this.base, signal, "no-cache");
    const text = await response.text().catch((error) => {
      throw asWalkError(error, "walk.json");
    });
    return parseManifest(text, "walk.json");
  }

  async file(entry: FileEntry, signal: AbortSignal): Promise<ArrayBuffer> {
    const url = new URL(entry.name, this.base).href;
    // What a cache on the way damaged is asked for once again.
    for (const cache of ["default", "reload"] as const) {
      const response = await this.get(entry.name, url, signal, cache);
      const bytes = await response.arrayBuffer().catch(() => null);
      if (signal.aborted) throw new WalkError(entry.name, "is no longer wanted");
      if (bytes && bytes.byteLength === entry.bytes) return bytes;
      if (cache === "reload")
        throw new WalkError(
          entry.name,
          bytes
            ? `has ${bytes.byteLength} bytes instead of ${entry.bytes}`
            : "the connection was lost before its end",
        );
    }
    throw new WalkError(entry.name, "cannot be read");
  }

  close(): void {}

  private async get(name: string, url: string, signal: AbortSignal, cache: RequestCache):
      Promise<Response> {
    let response: Response;
    try {
      response = await fetch(url, { signal, cache });
    } catch (error) {
      if (signal.aborted) throw new WalkError(name, "is no longer wanted");
      const local = new URL(url).protocol === "file:";
      throw new WalkError(
        name,
        local
          ? "this browser does not let a page read files beside it: serve the folder, " +
            "for example by: python3 -m http.server -d FOLDER"
          : `cannot be loaded (${error instanceof Error ? error.message : error})`,
      );
    }
    if (!response.ok)
      throw new WalkError(
        name,
        response.status === 404 ? "is missing on the server" : `the server answers ${response.status}`,
      );
    return response;
  }
}
