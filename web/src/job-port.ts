// A worker's end of JobWorker (job-worker.ts): jobs come with numbers, and go back as results or as errors.

import { asWalkError } from "./errors.js";

const port = self as unknown as {
  onmessage: (event: MessageEvent) => void;
  postMessage(message: unknown, transfer?: Transferable[]): void;
};

/** Answers each job from now on. What `transferOf` names goes along without a copy. */
export function answerJobs<Job, Result>(run: (job: Job) => Promise<Result>,
                                        transferOf: (result: Result) => Transferable[]): void {
  port.onmessage = async (event) => {
    const { id, job } = event.data;
    try {
      const result = await run(job);
      port.postMessage({ id, result }, transferOf(result));
    } catch (error) {
      const { where, reason } = asWalkError(error, "worker");
      port.postMessage({ id, error: { where, reason } });
    }
  };
}
