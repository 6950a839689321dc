// A worker from a program's text that answers jobs by their numbers.

import { WalkError } from "./errors.js";

export class JobWorker {
  private readonly worker: Worker;
  private readonly waiting = new Map<
    number,
    { resolve: (result: unknown) => void; reject: (error: unknown) => void }
  >();
  private next = 1;
  private failed: WalkError | null = null;

  constructor(text: string) {
    const url = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
    this.worker = new Worker(url);
    this.worker.onmessage = (event) => {
      URL.revokeObjectURL(url);
      const { id, result, error } = event.data;
      const job = this.waiting.get(id);
      this.waiting.delete(id);
      if (error) job?.reject(new WalkError(error.where, error.reason));
      else job?.resolve(result);
    };
    this.worker.onerror = (event) => {
      event.preventDefault();
      this.fail(
        new WalkError(
          "browser",
          "does not start the worker that decodes pictures: the page's Content-Security-Policy " +
            "must allow worker-src blob:",
        ),
      );
    };
  }

  /** The worker gets what is transferred. */
  run(job: unknown, transfer: Transferable[]): Promise<unknown> {
    return new Promise((resolve, reject) => {
      if (this.failed) {
        reject(this.failed);
        return;
      }
      const id = this.next++;
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, job }, transfer);
    });
  }

  dispose(): void {
    this.worker.terminate();
    this.fail(new WalkError("walk", "was disposed of"));
  }

  private fail(error: WalkError): void {
    this.failed = error;
    for (const job of this.waiting.values()) job.reject(error);
    this.waiting.clear();
  }
}
