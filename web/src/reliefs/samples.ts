// The samples of a layered relief, from the sheet that they are stored in (rilievo/web_walk/walk.h).

import { WalkError } from "../errors.js";

/** What the files of a relief hold. */
export interface SheetEntry {
  /** Of the picture and of the sheet, texels. */
  readonly width: number;
  readonly height: number;
  readonly sheetWidth: number;
  readonly sheetHeight: number;
  readonly samples: number;
}

/** Texels a side of a block. */
export const kReliefBlock = 16;
/** Of a sample: u, v, code, its number on its line of sight, from 0; its texel of the sheet. */
export const kSampleWords = 6;

export const blocksAcross = (texels: number) => Math.ceil(texels / kReliefBlock);

/** `layers`: how many blocks of the sheet each block of the picture has; `codes`: of the sheet. */
export function unpackSamples(codes: Uint16Array, layers: Uint16Array, of: SheetEntry,
                              where: string): Uint16Array {
  const damaged = () => new WalkError(where, "is damaged, or of another walk");
  const made = new Uint16Array(kSampleWords * of.samples);
  const columns = of.sheetWidth / kReliefBlock, places = columns * (of.sheetHeight / kReliefBlock);
  const across = blocksAcross(of.width);
  let most = 0, out = 0, place = 0;
  for (const count of layers) most = Math.max(most, count);
  for (let layer = 0; layer < most; ++layer)
    for (let block = 0; block < layers.length; ++block) {
      if (layers[block] <= layer) continue;
      if (place === places) throw damaged();
      const left = (place % columns) * kReliefBlock, top = Math.floor(place++ / columns) * kReliefBlock;
      const u = (block % across) * kReliefBlock, v = Math.floor(block / across) * kReliefBlock;
      for (let j = 0; j < kReliefBlock; ++j)
        for (let i = 0; i < kReliefBlock; ++i) {
          const code = codes[(top + j) * of.sheetWidth + left + i];
          if (code === 0) continue;
          if (out === made.length || u + i >= of.width || v + j >= of.height) throw damaged();
          made[out++] = u + i;
          made[out++] = v + j;
          made[out++] = code - 1;
          made[out++] = layer;
          made[out++] = left + i;
          made[out++] = top + j;
        }
    }
  if (out !== made.length) throw damaged();
  return made;
}
