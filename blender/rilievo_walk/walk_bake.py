# SPDX-License-Identifier: MIT
"""A bake as processes: rilievo bake, then rilievo web. Knows nothing of Blender, and never waits.

    bake = WalkBake(program, job)    started
    bake.poll()                      now and then: takes in what the processes say
    bake.state                       "baking", "writing", "done", "failed", "cancelled"
    bake.cancel()                    ends the processes; what is finished is kept for the next time
"""

import functools
import http.server
import json
import os
import pathlib
import queue
import shutil
import subprocess
import threading

MISSING = ("the program '{}' is not found. Build or install Rilievo, and put the folder of its program "
           "`rilievo` on the PATH, or set the program's path in this add-on's preferences")


class ProgramMissing(Exception):
    pass


def find_program(name):
    """The path of the program; raises ProgramMissing with what to do."""
    found = shutil.which(name)
    if not found:
        raise ProgramMissing(MISSING.format(name))
    return found


class Job:
    """What is baked, where eyes will be, and how well. Lengths in metres, y up."""

    def __init__(self, surfaces, folder, region=None, at=(), nodes=4, face=512, samples=64,
                 source="raytrace", program_scene=None, preview=True, environment=None):
        self.surfaces, self.folder = pathlib.Path(surfaces), pathlib.Path(folder)
        self.region, self.at, self.nodes = region, list(at), nodes
        self.face, self.samples, self.source = face, samples, source
        self.program_scene, self.preview, self.environment = program_scene, preview, environment or {}

    @property
    def file(self):
        return self.folder / "walk.exr"

    @property
    def page(self):
        return self.folder / "walk"

    def where(self):
        """The options that say where nodes stand."""
        if self.at:
            return ["--at", *(",".join(f"{x:.6g}" for x in place) for place in self.at)]
        options = ["--auto", str(self.nodes)]
        if self.region:
            options += ["--region=" + ",".join(f"{x:.6g}" for corner in self.region for x in corner)]
        return options

    def bake_command(self, program):
        command = [program, "bake", str(self.surfaces), "--as", "environment-nodes", *self.where(),
                   "--face", str(self.face), "--samples", str(self.samples), "--source", self.source,
                   "--progress", "json", "--json", str(self.folder / "bake.json"), "-o", str(self.file)]
        if self.program_scene:
            command += ["--program-scene", str(self.program_scene)]
        return command + (["--preview"] if self.preview else [])

    def web_command(self, program):
        return [program, "web", str(self.file), "-o", str(self.page)]


class Running:
    """A process whose error output is read by a thread."""

    def __init__(self, command, environment=None):
        self.lines = queue.Queue()
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True, errors="replace",
                                        env={**os.environ, **(environment or {})})
        self.output = []
        self.readers = [threading.Thread(target=self._read, args=(stream, take), daemon=True)
                        for stream, take in ((self.process.stderr, self.lines.put),
                                             (self.process.stdout, self.output.append))]
        for reader in self.readers:
            reader.start()

    @staticmethod
    def _read(stream, take):
        for line in stream:
            take(line.rstrip("\n"))

    def said(self):
        """The lines that have come since."""
        lines = []
        while True:
            try:
                lines.append(self.lines.get_nowait())
            except queue.Empty:
                return lines

    def over(self):
        """The exit code, once all that was said is read; or None."""
        code = self.process.poll()
        if code is None or any(reader.is_alive() for reader in self.readers):
            return None
        return code

    def end(self):
        self.process.terminate()
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


class WalkBake:
    def __init__(self, program, job):
        self.program, self.job = find_program(program), job
        self.state, self.error = "baking", ""
        self.done, self.total, self.left_s = 0, 0, None
        self.previewing = False
        self.held = None  # the share of the visible surface that the nodes hold
        job.folder.mkdir(parents=True, exist_ok=True)
        self.running = Running(job.bake_command(self.program), job.environment)

    def poll(self):
        """Takes in what has happened; returns the state."""
        if self.state not in ("baking", "writing"):
            return self.state
        code = self.running.over()  # before what it said, so that nothing is missed
        for line in self.running.said():
            if line.startswith('{"') and "rilievo-progress-1" in line:
                progress = json.loads(line)
                if "written" in progress:  # a preview
                    continue
                self.done, self.total, self.left_s = (progress[k] for k in ("done", "total", "left_s"))
                self.previewing = progress["what"] == "preview"
            elif line.startswith("rilievo: "):
                self.error = line[len("rilievo: "):]
        if code is None:
            return self.state
        if code != 0:
            self.state = "failed"
            self.error = self.error or f"rilievo ended with code {code}"
        elif self.state == "baking":
            with open(self.job.folder / "bake.json", encoding="utf-8") as file:
                self.held = json.load(file).get("visible_share_held")
            self.state = "writing"
            self.running = Running(self.job.web_command(self.program))
        else:
            self.state = "done"
        return self.state

    def cancel(self):
        if self.state in ("baking", "writing"):
            self.running.end()
            self.state = "cancelled"

    def text(self):
        """The state in a few words."""
        if self.state == "baking":
            left = "" if self.left_s is None else f", {duration(self.left_s)} left"
            what = "preview" if self.previewing else "picture"
            return f"{what} {self.done} of {self.total}{left}" if self.total else "placing nodes"
        return {"writing": "writing the page", "failed": self.error}.get(self.state, self.state)


class Proposal:
    """How many nodes are worth having: the fewest of a few numbers that hold most of what is seen."""

    NUMBERS = (1, 2, 3, 4, 6, 8, 12, 16)
    ENOUGH = 0.995

    def __init__(self, program, job):
        self.program, self.job = find_program(program), job
        self.tried = []  # (nodes, share held)
        self.state, self.error = "trying", ""
        job.folder.mkdir(parents=True, exist_ok=True)
        self._start()

    def _start(self):
        self.job.nodes = self.NUMBERS[len(self.tried)]
        # Only rays, and hardly any: nothing is rendered.
        command = [self.program, "bake", str(self.job.surfaces), "--as", "environment-nodes", *self.job.where(),
                   "--face", "8", "--source", "rays", "--json", "-", "-o", str(self.job.folder / "places.exr")]
        self.running = Running(command)

    def poll(self):
        if self.state != "trying":
            return self.state
        code = self.running.over()
        if code is None:
            return self.state
        said = self.running.said()
        if code != 0:
            self.state, self.error = "failed", said[-1].removeprefix("rilievo: ") if said else f"code {code}"
            return self.state
        report = json.loads("\n".join(self.running.output))
        self.tried.append((self.job.nodes, report.get("visible_share_held", 0.0)))
        if self.tried[-1][1] >= self.ENOUGH or len(self.tried) == len(self.NUMBERS):
            self.state = "done"
        else:
            self._start()
        return self.state

    @property
    def nodes(self):
        """The fewest nodes that hold within 0.2 % of what the most hold, or enough."""
        if not self.tried:
            return None
        best = max(share for _, share in self.tried)
        return next(n for n, share in self.tried if share >= min(self.ENOUGH, best - 0.002))

    @property
    def share(self):
        return dict(self.tried)[self.nodes]

    def cancel(self):
        if self.state == "trying":
            self.running.end()
            self.state = "cancelled"


def duration(seconds):
    if seconds < 100:
        return f"{seconds:.0f} s"
    if seconds < 6000:
        return f"{seconds / 60:.0f} min"
    return f"{seconds // 3600:.0f} h {seconds % 3600 / 60:.0f} min"


class _Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


class PageServer:
    """Serves a folder on this machine alone, until this program ends."""

    def __init__(self, folder):
        handler = functools.partial(_Quiet, directory=str(folder))
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    @property
    def address(self):
        return f"http://127.0.0.1:{self.server.server_address[1]}/"

    def close(self):
        self.server.shutdown()
        self.server.server_close()
