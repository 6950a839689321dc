// What a walk of pictures asks those that draw them: modules of their own, loaded by the walks that
// need them.

import { WalkError } from "../errors.js";
import type { View } from "../gl/program.js";
import type { FileEntry } from "../manifest.js";

export interface PicturesHost {
  fetch(entry: FileEntry): Promise<ArrayBuffer>;
  /** A picture came and waits to be uploaded. */
  arrived(): void;
  /** A picture can be drawn. */
  loaded(picture: number): void;
  failed(error: WalkError): void;
  readonly budget: number;
  /** Where a live walk tells of its connection. */
  readonly parent?: HTMLElement;
}

export interface Pictures {
  readonly stats: { drawCalls: number; triangles: number; there: number };
  /** On the GPU. */
  readonly bytes: number;
  /** Is everything there that the eye of the last update() needs? */
  readonly settled: boolean;
  readonly allFailed: boolean;
  /** Chooses, loads and uploads a part for an eye in world space. */
  update(x: number, y: number, z: number): void;
  /** Before draw(): what is drawn into textures of their own. Changes framebuffers. */
  prepare(view: View): void;
  /** Draws into the bound layer, whose near plane is `near`. */
  draw(view: View, near: number): void;
  dispose(): void;
}

/** Colours as the shaders want them: multiplied by alpha. */
export async function bitmapOf(bytes: ArrayBuffer, entry: FileEntry, width: number,
                               height: number): Promise<ImageBitmap> {
  const options: ImageBitmapOptions = {
    premultiplyAlpha: "premultiply", colorSpaceConversion: "none",
  };
  const made = await createImageBitmap(new Blob([bytes], { type: "image/webp" }), options)
    .catch(() => {
      throw new WalkError(entry.name, "is no WebP picture that this browser reads");
    });
  if (made.width !== width || made.height !== height) {
    made.close();
    throw new WalkError(entry.name, `is not ${width} x ${height} texels large`);
  }
  return made;
}
