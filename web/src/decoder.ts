// Checks and decodes files beside the main thread, in a worker.

import workerText from "worker:decode-worker";
import { JobWorker } from "./job-worker.js";
import type { FileEntry, MeshEntry } from "./manifest.js";
import type { Job, JobResult } from "./jobs.js";
import type { NodeMesh } from "./mesh-layout.js";
import type { SheetEntry } from "./reliefs/samples.js";
import type { ViewDepths, ViewSurface } from "./views/surface.js";

export class Decoder {
  private readonly worker = new JobWorker(workerText);

  /** The bytes again, if they are those that the name says. */
  async check(bytes: ArrayBuffer, entry: FileEntry): Promise<ArrayBuffer> {
    return (await this.run({ kind: "check", bytes, name: entry.name })) as ArrayBuffer;
  }

  async mesh(bytes: ArrayBuffer, entry: MeshEntry): Promise<NodeMesh> {
    return (await this.run({ kind: "mesh", bytes, entry })) as NodeMesh;
  }

  /** The surface of a picture. */
  async view(bytes: ArrayBuffer, entry: FileEntry, of: ViewDepths): Promise<ViewSurface> {
    return (await this.run({ kind: "view", bytes, name: entry.name, of })) as ViewSurface;
  }

  /** The samples of a relief. */
  async samples(bytes: ArrayBuffer, name: string, entry: SheetEntry, layers: Uint16Array):
      Promise<Uint16Array> {
    const { width, height, sheetWidth, sheetHeight, samples } = entry;
    const of = { width, height, sheetWidth, sheetHeight, samples };
    return (await this.run({ kind: "samples", bytes, name, layers, of })) as Uint16Array;
  }

  /** A plane of shares, from 0 to 255. */
  async shares(bytes: ArrayBuffer, entry: FileEntry & { steps: number }, width: number,
               height: number): Promise<Uint8Array> {
    const { name, steps } = entry;
    return (await this.run({ kind: "shares", bytes, name, width, height, steps })) as Uint8Array;
  }

  async plane16(bytes: ArrayBuffer, entry: FileEntry, width: number, height: number):
      Promise<Uint16Array> {
    return (await this.run({ kind: "plane16", bytes, name: entry.name, width, height })) as
      Uint16Array;
  }

  dispose(): void {
    this.worker.dispose();
  }

  private async run(job: Job): Promise<JobResult> {
    return (await this.worker.run(job, [job.bytes])) as JobResult;
  }
}
