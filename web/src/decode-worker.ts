// The program of the worker (decoder.ts), a bundle of its own.

import { answerJobs } from "./job-port.js";
import { runJob, transferOf } from "./jobs.js";

answerJobs(runJob, transferOf);
