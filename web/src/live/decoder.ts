// Decodes keyframes beside the main thread, in a worker.

import workerText from "worker:live/worker";
import { JobWorker } from "../job-worker.js";
import type { KeyframeMesh } from "./mesh.js";
import type { KeyframePart } from "./messages.js";

export interface PartJob {
  readonly bytes: ArrayBuffer;
  readonly part: KeyframePart;
  /** Codes by which triangles may be off. */
  readonly tolerance: number;
  /** The most triangles. */
  readonly triangles: number;
}

export interface DecodedPart {
  /** RGBA, 8 bits each, the top row first. */
  readonly colors: ArrayBuffer;
  /** 16 bits each. */
  readonly codes: ArrayBuffer;
  readonly mesh: KeyframeMesh;
  /** What the depths and the mesh took, milliseconds of the worker. */
  readonly depthMs: number;
  readonly meshMs: number;
}

export class PartDecoder {
  private readonly worker = new JobWorker(workerText);

  async decode(job: PartJob): Promise<DecodedPart> {
    return (await this.worker.run(job, [job.bytes])) as DecodedPart;
  }

  dispose(): void {
    this.worker.dispose();
  }
}
