// The program of the worker (decoder.ts), a bundle of its own.

import { asWalkError } from "./errors.js";
import { runJob, transferOf } from "./jobs.js";

const port = self as unknown as {
  onmessage: (event: MessageEvent) => void;
  postMessage(message: unknown, transfer?: Transferable[]): void;
};

port.onmessage = async (event) => {
  const { id, job } = event.data;
  try {
    const result = await runJob(job);
    port.postMessage({ id, result }, transferOf(result));
  } catch (error) {
    const { where, reason } = asWalkError(error, "worker");
    port.postMessage({ id, error: { where, reason } });
  }
};
