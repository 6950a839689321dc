// What a browser costs, all of its processes together.
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";

const kTicksPerSecond = Number(execFileSync("getconf", ["CLK_TCK"]));

/** Of a process and all that it started: seconds of processor time, and bytes of its own. */
export function costOf(root) {
  const children = new Map();
  for (const name of readdirSync("/proc").filter((of) => /^\d+$/.test(of))) {
    try {
      const parts = readFileSync(`/proc/${name}/stat`, "utf8").replace(/^.*\) /, "").split(" ");
      const status = readFileSync(`/proc/${name}/smaps_rollup`, "utf8");
      const own = /Pss:\s+(\d+)/.exec(status);
      children.set(Number(name), { parent: Number(parts[1]), own: own ? 1024 * Number(own[1]) : 0,
                                   ticks: Number(parts[11]) + Number(parts[12]) });
    } catch { /* it has ended */ }
  }
  const isBelow = (pid) => pid === root || (children.has(pid) && children.get(pid).parent > 1 &&
                                            isBelow(children.get(pid).parent));
  let ticks = 0, bytes = 0;
  for (const [pid, of] of children) if (isBelow(pid)) ticks += of.ticks, bytes += of.own;
  return { seconds: ticks / kTicksPerSecond, bytes };
}
