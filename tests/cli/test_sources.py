#!/usr/bin/env python3
"""Bakes by slow sources from the command line: whose light, kept where, in which pieces.

    test_sources.py PATH/TO/rilievo [unittest arguments]
"""

import json
import os
import pathlib
import random
import select
import shutil
import signal
import subprocess
import sys
import time
import unittest

import command
from command import files_below

STONES = "builtin:stonehenge?triangles=10000"
TEAPOTS = "builtin:teapots?triangles=10000"
KINDS = {
    "environment-nodes": ("--face", "24", "--at", "0,1.7,8", "-3,1.7,8"),
    "layered-impostor": ("--size", "24", "--ring", "3", "--layers", "4", "--no-fills"),
    "layered-relief": ("--size", "24", "--textures", "2"),
}

# A renderer that knows no scene: an eye is in the middle of a ball of 2 m, or before a plane where it sees
# nothing so near, in the colour of the direction. It notes what it is asked for.
PROGRAM = """#!@PYTHON@ -SE
import json, os, struct, sys, time
fault = open(@FAULT@).read().split() if os.path.exists(@FAULT@) else ["none"]
log = open(@LOG@, "a")
log.write("opens %s\\n" % " ".join(sys.argv[1:])); log.flush()
def write(camera, path):
    w, h = camera["width"], camera["height"]
    if fault[0] == "size": w += 1
    left, right, bottom, top = camera["window"]
    pose = camera["world_from_eye"]
    attribute = lambda name, kind, data: name + b"\\0" + kind + b"\\0" + struct.pack("<i", len(data)) + data
    names = b"ABGRZ"
    head = struct.pack("<ii", 20000630, 2)
    head += attribute(b"channels", b"chlist",
                      b"".join(bytes([n]) + b"\\0" + struct.pack("<iiii", 2, 0, 1, 1) for n in names) + b"\\0")
    box = struct.pack("<4i", 0, 0, w - 1, h - 1)
    head += attribute(b"compression", b"compression", b"\\0")
    head += attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box)
    head += attribute(b"lineOrder", b"lineOrder", b"\\0")
    head += attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    head += attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0))
    head += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\\0"
    size = 20 * w
    rows, table = b"", b""
    for y in range(h):
        table += struct.pack("<Q", len(head) + 8 * h + y * (8 + size))
        row = {n: [] for n in names}
        for x in range(w):
            u, v = left + (right - left) * (x + 0.5) / w, top + (bottom - top) * (y + 0.5) / h
            way = [u * pose[i] + v * pose[4 + i] - pose[8 + i] for i in range(3)]
            length = sum(c * c for c in way) ** 0.5
            for n, c in zip(b"RGB", way): row[n].append(0.5 + 0.4 * c / length)
            row[ord("A")].append(1.0)
            z = 2.0 / length if camera["z_near"] < 1 else (camera["z_near"] + camera["z_far"]) / 2
            row[ord("Z")].append(z * length if fault[0] == "ray" else z)
        rows += struct.pack("<ii", y, size) + b"".join(struct.pack("<%df" % w, *row[n]) for n in names)
    with open(path, "wb") as file: file.write(head + table + rows)
for line in sys.stdin:
    ask = json.loads(line)
    if ask["request"] == "bounds":
        print(json.dumps({"id": ask["id"], "bounds": [[-3, -3, -3], [3, 3, 3]]}), flush=True)
        continue
    log.write("picture %s\\n" % json.dumps(ask["camera"], sort_keys=True))
    log.write("samples %d noise %s\\n" % (ask["samples"], ask.get("noise"))); log.flush()
    if sys.argv[1:]: log.write("opened %s\\n" % open(sys.argv[1], "rb").read(4).decode()); log.flush()
    if fault[0] == "dies": os._exit(3)
    if fault[0] == "garbage": print("Fra:1 Mem:23M", flush=True); continue
    if fault[0] == "says": print(json.dumps({"id": ask["id"], "error": "out of paint"}), flush=True); continue
    if fault[0] == "slow": time.sleep(float(fault[1]))
    write(ask["camera"], ask["file"])
    print(json.dumps({"id": ask["id"], "done": True}), flush=True)
"""


def ends(number, within_s=60):
    """Does the process end? One that nobody waits for may stay as a zombie."""
    until = time.monotonic() + within_s
    while time.monotonic() < until:
        try:
            state = pathlib.Path(f"/proc/{number}/stat").read_text().rsplit(")", 1)[1].split()[0]
        except OSError:
            return True
        if state in "ZX":
            return True
        time.sleep(0.02)
    return False


def kill_silent(number):
    """Kills a process of the silent program, unless the number is another's by now."""
    try:
        command_line = pathlib.Path(f"/proc/{number}/cmdline").read_bytes()
        if b"/silent\0" in command_line or command_line == b"sleep\x001000\0":
            os.kill(number, signal.SIGKILL)
    except OSError:
        pass


class Case(command.Case):
    def setUp(self):
        super().setUp()
        self.log, self.fault = self.folder / "log", self.folder / "fault"
        text = (PROGRAM.replace("@PYTHON@", sys.executable).replace("@LOG@", repr(str(self.log)))
                .replace("@FAULT@", repr(str(self.fault))))
        self.program = self.write("renderer", text)
        self.program.chmod(0o755)
        self.exec = f"exec:{self.program}"

    def bake(self, kind, source, *arguments, scene=STONES, out="out.exr"):
        """The file, and what the bake says of it."""
        out = self.folder / out
        done = self.succeeds("bake", scene, "--as", kind, *KINDS[kind], "--source", source, *arguments,
                             "-o", out, "--json", "-")
        return out, json.loads(done.stdout)

    def asked(self):
        """The cameras of the pictures that the program was asked for."""
        if not self.log.exists():
            return []
        return [line for line in self.log.read_text().splitlines() if line.startswith("picture")]


class Sources(Case):
    def test_every_kind_is_baked_by_every_source(self):
        for kind in KINDS:
            made = {}
            for source in ("raster", "rays", "raytrace", self.exec):
                with self.subTest(kind=kind, source=source):
                    out, said = self.bake(kind, source, out=f"{kind}-{len(made)}.exr")
                    self.assertEqual(said["as"], kind)
                    made[source] = out.read_bytes()
                    if source in ("raster", "rays"):
                        self.assertNotIn("pictures", said)
                        self.assertFalse(pathlib.Path(f"{out}.pictures").exists())
                    else:
                        self.assertGreater(said["pictures"]["rendered"], 0)
                        self.assertEqual(said["pictures"]["kept"], 0)
            # Of shadows, and of another world.
            self.assertEqual(len({made["rays"], made["raytrace"], made[self.exec]}), 3)

    def test_keyframes_are_made_by_every_source(self):
        made = {}
        for source in ("raster", "rays", "raytrace", self.exec):
            with self.subTest(source=source):
                out = self.folder / f"frames-{len(made)}"
                self.succeeds("render", STONES, "--method", "keyframes", "--source", source, "--size", "64x48",
                              "--frames", "6", "--draw", "software", "-o", out)
                made[source] = files_below(out)
                self.assertEqual(len(made[source]), 6)
        # Each frame shows what its source does.
        first = sorted(made["raytrace"])[0]
        self.assertEqual(len({made[source][first] for source in ("rays", "raytrace", self.exec)}), 3)

    def test_a_silent_program_is_said_to_be_waited_for_and_dies_with_us(self):
        # With a child of its own, which a signal reaches only through their group.
        program = self.write("silent", f"#!/bin/sh\nsleep 1000 &\necho $$ $! > {self.log}; wait\n")
        program.chmod(0o755)
        for end in (signal.SIGTERM, signal.SIGINT, signal.SIGKILL):
            with self.subTest(end=end):
                ours, theirs = os.openpty()
                self.log.unlink(missing_ok=True)
                running = subprocess.Popen(
                    [command.program, "render", STONES, "--method", "keyframes", "--source", f"exec:{program}",
                     "--draw", "software", "-o", str(self.folder / "frames")],
                    stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=theirs)
                os.close(theirs)
                self.addCleanup(os.close, ours)
                self.addCleanup(running.wait)
                self.addCleanup(running.kill)
                said = b""
                while b"waiting for its bounds, 1 s" not in said:
                    self.assertTrue(select.select([ours], [], [], command.TIMEOUT_S)[0], said)
                    said += os.read(ours, 4096)
                self.assertIn(f"exec:{program}".encode(), said)
                started = self.silent_programs(2)
                running.send_signal(end)
                self.assertEqual(running.wait(command.TIMEOUT_S), -end)
                # SIGKILL lets nobody tidy up: the kernel kills the program, not what it has started.
                for number in started[:1 if end == signal.SIGKILL else 2]:
                    self.assertTrue(ends(number), f"{number} is left after {end!r}")

    def silent_programs(self, count, within_s=60):
        """The process ids in the log, once there are so many; they are killed at the end."""
        until = time.monotonic() + within_s
        numbers = []
        while len(numbers) < count and time.monotonic() < until:
            time.sleep(0.05)
            numbers = self.log.read_text().split() if self.log.exists() else []
        self.assertEqual(len(numbers), count, "the program has not started all")
        for number in numbers:
            self.addCleanup(kill_silent, int(number))
        return [int(number) for number in numbers]

    def test_frames_by_the_clock_do_not_wait_for_slow_sources(self):
        made = []
        for source in ("raytrace", self.exec):
            out = self.folder / f"clock-{len(made)}"
            self.succeeds("render", STONES, "--method", "keyframes", "--source", source, "--by-clock", "--size",
                          "64x48", "--frames", "1", "--draw", "software", "-o", out)
            made.append(list(files_below(out).values()))
        # They begin with a coarse keyframe by rays.
        self.assertEqual(made[0], made[1])

    def test_a_program_gets_the_scene_and_may_have_one_of_its_own(self):
        glb = self.folder / "stones.glb"
        self.succeeds("scene", STONES, "-o", glb)
        own = self.write("own.blend", "a scene of the program's")
        for arguments, scene, opens in (((), glb, glb), (("--program-scene", own), glb, own)):
            self.log.unlink(missing_ok=True)
            self.bake("layered-relief", self.exec, *arguments, scene=scene)
            self.assertEqual(self.log.read_text().splitlines()[0], f"opens {opens}")
            for store in self.folder.glob("*.pictures*"):
                store.unlink()
        # A built-in one, and one on other axes, are written for it, and gone with it.
        for arguments, scene in (((), STONES), (("--up", "z", "--units", "cm"), glb)):
            self.log.unlink()
            self.bake("layered-relief", self.exec, *arguments, scene=scene)
            opened = self.log.read_text().splitlines()[0].split()[1]
            self.assertTrue(opened.endswith("/scene.glb"), opened)
            self.assertIn("opened glTF", self.log.read_text())
            self.assertFalse(pathlib.Path(opened).exists())

    def test_a_program_that_makes_keyframes_gets_the_scene_or_one_of_its_own(self):
        glb = self.folder / "stones.glb"
        self.succeeds("scene", STONES, "-o", glb)
        own = self.write("own.blend", "a scene of the program's")
        # A built-in one, and one on other axes, are written for it, and gone with it.
        for arguments, scene, opens in (((), glb, glb), (("--program-scene", own), glb, own), ((), STONES, None),
                                        (("--up", "z", "--units", "cm"), glb, None)):
            self.log.unlink(missing_ok=True)
            for command in (("render", scene, "--method"), ("compare", scene, "--methods")):
                self.succeeds(*command, "keyframes", "--source", self.exec, *arguments, "--size", "64x48",
                              "--frames", "1", "--draw", "software", "-o", self.folder / command[0])
                opened = self.log.read_text().splitlines()[0].removeprefix("opens ")
                if opens:
                    self.assertEqual(opened, str(opens))
                else:
                    self.assertTrue(opened.endswith("/scene.glb"), opened)
                    self.assertIn("opened glTF", self.log.read_text())
                    self.assertFalse(pathlib.Path(opened).exists())
                self.log.unlink()

    def test_a_program_beside_frames_gives_way_to_them(self):
        heard = self.folder / "nice"
        gives_way = self.write("gives_way.sh", f"#!/bin/sh\nnice > '{heard}'\nexec '{self.program}' \"$@\"\n")
        gives_way.chmod(0o755)
        for arguments, nice in (((), os.nice(0)), (("--by-clock",), 19)):
            self.succeeds("render", STONES, "--method", "keyframes", "--source", f"exec:{gives_way}", *arguments,
                          "--size", "64x48", "--frames", "1", "--draw", "software", "-o", self.folder / "frames")
            self.assertEqual(int(heard.read_text()), nice)

    def test_a_programs_own_scene_has_depth_along_what_two_pictures_tell(self):
        own = self.write("own.blend", "a scene of the program's")
        sizes = {}
        for fault in ("none", "ray"):
            self.fault.write_text(fault)
            out = self.folder / f"{fault}.exr"
            self.succeeds("bake", own, "--as", "environment-nodes", "--face", "24", "--at", "0,0,0",
                          "--source", self.exec, "-o", out)
            info = json.loads(self.succeeds("info", out, "--json", "-").stdout)
            sizes[fault] = info["bounds"] if "bounds" in info else info
        # A ball of 2 m, either way.
        self.assertEqual(json.dumps(sizes["none"])[:60], json.dumps(sizes["ray"])[:60])
        self.fault.write_text("none")
        self.refused(["bake", own, "--as", "environment-nodes", "--face", "24", "--source", self.exec,
                      "-o", self.folder / "o.exr"], "--at")

    def test_a_program_that_fails_is_named_with_the_reason(self):
        for fault, reason in (("dies", "has ended without an answer"), ("garbage", "Fra:1 Mem:23M"),
                              ("says", "out of paint"), ("size", "not of the size")):
            with self.subTest(fault):
                self.fault.write_text(fault)
                self.refused(["bake", STONES, *KINDS["layered-relief"], "--as", "layered-relief",
                              "--source", self.exec, "-o", self.folder / "o.exr"], self.exec, reason)
                self.assertFalse((self.folder / "o.exr").exists())

    def test_a_program_hears_of_samples_and_of_noise(self):
        def heard():
            lines = self.log.read_text().splitlines()
            self.log.unlink()
            return [line for line in lines if line.startswith("samples")]
        self.bake("environment-nodes", self.exec, "--samples", "9")
        self.assertEqual(heard(), ["samples 9 noise None"] * 12)
        # Other noise, other pictures.
        self.bake("environment-nodes", self.exec, "--samples", "9", "--noise", "0.125")
        self.assertEqual(heard(), ["samples 9 noise 0.125"] * 12)
        # A relief of each of two sides, and what is seen from all around.
        self.bake("layered-relief", self.exec, "--samples", "9", "--around-samples", "2", out="relief.exr")
        said = heard()
        self.assertEqual((said.count("samples 9 noise None"), said.count("samples 2 noise None")), (2, 12))

    def test_options_that_do_not_go_together_are_refused(self):
        nodes = ["--as", "environment-nodes", *KINDS["environment-nodes"], "-o", self.folder / "o.exr"]
        for arguments, named in (
                (["--source", "paint"], "--source"), (["--source", "exec:"], "--source"),
                (["--source", "exec:/no/such/program"], "/no/such/program"),
                (["--source", "rays", "--store", "x"], "--store"),
                (["--source", "rays", "--plan", "x"], "--plan"), (["--slurm", "2"], "--slurm"),
                (["--preview"], "--preview"), (["--samples", "0"], "--samples"),
                (["--source", "rays", "--samples", "9"], "samples"),
                (["--axis-depth"], "--axis-depth"), (["--program-scene", "x"], "--program-scene"),
                (["--source", "raytrace", "--pieces", "3"], "--pieces"),
                (["--source", "raytrace", "--noise", "0.1"], "--noise"),
                (["--source", "raytrace", "--around-samples", "3"], "--around-samples"),
                (["--piece", "1"], "--plan"), (["--join"], "--plan"),
                (["--plan", "p.json", "--piece", "1"], "SCENE")):
            with self.subTest(arguments):
                self.refused(["bake", STONES, *nodes, *arguments], named)
        self.refused(["bake", "-o", self.folder / "o.exr"], "SCENE")
        self.refused(["bake", STONES], "--output")
        self.assertFalse((self.folder / "o.exr").exists())

    def test_progress_is_silent_in_a_pipe_and_lines_of_json_if_asked_for(self):
        arguments = ("bake", TEAPOTS, "--as", "environment-nodes", *KINDS["environment-nodes"],
                     "--source", "raytrace", "-o", self.folder / "o.exr")
        self.assertEqual(self.succeeds(*arguments).stderr, "")
        lines = [json.loads(line) for line in
                 self.succeeds(*arguments, "--progress", "json").stderr.splitlines()]
        self.assertGreater(len(lines), 10)
        self.assertEqual({line["schema"] for line in lines}, {"rilievo-progress-1"})
        self.assertEqual([line["done"] for line in lines], sorted(line["done"] for line in lines))
        self.assertEqual((lines[-1]["done"], lines[-1]["total"], lines[-1]["kept"]), (12, 12, 12))

    def test_a_preview_is_refined_into_what_is_made_without_it(self):
        arguments = ("bake", STONES, "--as", "environment-nodes", "--at", "0,1.7,8", "--face", "128",
                     "--source", "raytrace", "--samples", "8", "-o")
        self.succeeds(*arguments, self.folder / "plain.exr")
        done = self.succeeds(*arguments, self.folder / "seen.exr", "--preview", "--progress", "json")
        self.assertEqual((self.folder / "plain.exr").read_bytes(),
                         (self.folder / "seen.exr").read_bytes())
        written = [json.loads(line) for line in done.stderr.splitlines() if "written" in line]
        self.assertEqual([line["what"] for line in written],
                         [f"a preview with {n} of 128 texels a side, {s} samples"
                          for n, s in ((16, 1), (32, 1), (64, 2))])


class Resume(Case):
    def test_only_what_changed_is_rendered_again(self):
        node = ("--as", "environment-nodes", "--face", "24")
        out = self.folder / "o.exr"

        def pictures(*arguments, scene=TEAPOTS):
            done = self.succeeds("bake", scene, *node, "--source", "raytrace", *arguments, "-o", out,
                                 "--json", "-")
            said = json.loads(done.stdout)["pictures"]
            return said["rendered"], said["kept"]

        at = ("--at", "0,2,12", "3,2,12")
        self.assertEqual(pictures(*at), (12, 0))
        once = out.read_bytes()
        self.assertEqual(pictures(*at), (0, 12))
        self.assertEqual(out.read_bytes(), once)
        self.assertEqual(pictures(*at, "5,2,11"), (6, 12))  # a node more
        self.assertEqual(pictures(*at, "--triangles", "300"), (0, 12))  # another mesh
        self.assertEqual(pictures(*at, "--samples", "5"), (12, 0))
        self.assertEqual(pictures(*at, scene=TEAPOTS + "&seed=7"), (12, 0))
        self.assertEqual(pictures(*at), (0, 12))

    def run_until(self, arguments, seconds, how):
        """Starts a bake and ends it after so long; false if it was over."""
        bake = subprocess.Popen([command.program, *map(str, arguments)], stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)
        try:
            bake.wait(seconds)
            return False
        except subprocess.TimeoutExpired:
            bake.send_signal(how)
            bake.wait(command.TIMEOUT_S)
            return True

    def killed(self, kills, how, seed, pause):
        """A bake that is ended again and again makes the same bytes, and nothing twice but what it was at."""
        self.fault.write_text(f"slow {pause}")
        out, store = self.folder / "o.exr", self.folder / "o.exr.pictures"
        arguments = ("bake", STONES, "--as", "environment-nodes", *KINDS["environment-nodes"],
                     "--source", self.exec, "-o", out)
        chance = random.Random(seed)
        ended = 0
        for _ in range(kills):
            # Until the first picture at least, as otherwise nothing is ever done.
            ended += self.run_until(arguments, chance.uniform(0.05, 0.3 + 2 * pause), how)
            self.assertFalse(ended and out.exists() and out.stat().st_size == 0)
        self.succeeds(*arguments)
        asked = self.asked()
        once = set(asked)
        self.assertEqual(len(once), 12)
        self.assertLessEqual(len(asked), 12 + ended)
        self.fault.write_text("none")
        whole = self.folder / "whole.exr"
        self.succeeds(*arguments[:-1], whole)
        self.assertEqual(out.read_bytes(), whole.read_bytes())
        self.assertFalse(list(self.folder.glob("*.part")))
        return ended

    def test_killed_at_random_moments_a_bake_goes_on(self):
        self.assertGreater(self.killed(6, signal.SIGKILL, seed=1, pause=0.05), 2)

    def test_so_it_does_after_an_interrupt(self):
        self.assertGreater(self.killed(3, signal.SIGINT, seed=2, pause=0.05), 0)

    @unittest.skipUnless(os.environ.get("RILIEVO_KILLS"), "RILIEVO_KILLS=20 kills so often")
    def test_killed_at_many_random_moments_a_bake_goes_on(self):
        kills = int(os.environ["RILIEVO_KILLS"])
        self.assertGreater(self.killed(kills, signal.SIGKILL, seed=3, pause=0.4), kills // 2)


class Pieces(Case):
    def plan(self, kind, source, *arguments, scene=STONES, pieces=1000):
        plan = self.folder / "pieces.json"
        self.succeeds("bake", scene, "--as", kind, *KINDS[kind], "--source", source, *arguments, "-o",
                      self.folder / "joined.exr", "--plan", plan, *(["--pieces", pieces] if pieces else []))
        return plan, len(json.loads(plan.read_text())["pieces"])

    def test_pieces_made_in_any_order_join_to_the_same_bytes(self):
        for kind in KINDS:
            for source in ("raytrace", self.exec):
                with self.subTest(kind=kind, source=source):
                    whole, said = self.bake(kind, source, out="whole.exr")
                    plan, count = self.plan(kind, source)
                    self.assertEqual(count, said["pictures"]["rendered"] + said["pictures"]["kept"])
                    named = ("--source", source) if source != "raytrace" else ()
                    order = list(range(count))
                    random.Random(4).shuffle(order)
                    self.log.unlink(missing_ok=True)
                    # Two at a time, as xargs -P does, from another folder.
                    subprocess.run(["xargs", "-P", "2", "-I", "{}", command.program, "bake", "--plan",
                                    str(plan), "--piece", "{}", *named], check=True, text=True,
                                   input="\n".join(map(str, order)), stdout=subprocess.DEVNULL, cwd="/",
                                   timeout=command.TIMEOUT_S)
                    if source != "raytrace":
                        self.assertEqual(len(self.asked()), count)
                    again = self.succeeds("bake", "--plan", plan, "--piece", "0", *named)
                    self.assertIn("was there", again.stdout)
                    self.log.unlink(missing_ok=True)
                    joined = self.succeeds("bake", "--plan", plan, "--join", *named, "--json", "-")
                    self.assertFalse(self.log.exists())  # the program is not even started
                    self.assertEqual(json.loads(joined.stdout)["pictures"]["rendered"], 0)
                    self.assertEqual((self.folder / "joined.exr").read_bytes(), whole.read_bytes())
                    for file in self.folder.rglob("*.picture*"):
                        if file.is_file():
                            file.unlink()

    def test_pieces_of_several_pictures_join_to_the_same_bytes(self):
        whole, _ = self.bake("environment-nodes", "raytrace", out="whole.exr")
        # Three, and as many as are even by their time on this machine now.
        for pieces in (3, None):
            plan, count = self.plan("environment-nodes", "raytrace", pieces=pieces)
            listed = json.loads(plan.read_text())
            self.assertEqual(count, pieces or count)
            self.assertEqual(sorted(i for piece in listed["pieces"] for i in piece["pictures"]), list(range(12)))
            self.assertEqual(len(listed["pictures"]), 12)
            self.assertTrue(all(piece["seconds"] > 0 for piece in listed["pieces"]))
            for piece in range(count):
                self.assertIn("rendered", self.succeeds("bake", "--plan", plan, "--piece", piece).stdout)
            joined = json.loads(self.succeeds("bake", "--plan", plan, "--join", "--json", "-").stdout)
            self.assertEqual(joined["pictures"]["rendered"], 0)
            self.assertEqual((self.folder / "joined.exr").read_bytes(), whole.read_bytes())
            shutil.rmtree(self.folder / "pieces.json.pictures")

    def test_what_is_missing_or_damaged_is_named_or_made_again(self):
        plan, count = self.plan("environment-nodes", "raytrace")
        for piece in set(range(count)) - {3, 7}:
            self.succeeds("bake", "--plan", plan, "--piece", piece)
        self.refused(["bake", "--plan", plan, "--join"], "pieces 3 and 7 of 12 are missing")
        for piece in (3, 7):
            self.succeeds("bake", "--plan", plan, "--piece", piece)
        damaged = next((self.folder / "pieces.json.pictures").glob("*.picture"))
        damaged.write_bytes(damaged.read_bytes()[:-5])
        joined = json.loads(self.succeeds("bake", "--plan", plan, "--join", "--json", "-").stdout)
        self.assertEqual(joined["pictures"], {"rendered": 1, "kept": 11,
                                              "in": str(self.folder / "pieces.json.pictures")})

    def test_bad_plans_and_pieces_are_refused(self):
        plan, count = self.plan("environment-nodes", "raytrace")
        piece = ("bake", "--plan", plan, "--piece")
        self.refused([*piece, count], "--piece", f"has {count}, from 0")
        self.refused([*piece, "-1"], "--piece")
        whole = plan.read_text()
        for text in ("", "{}", whole[:len(whole) // 2], whole.replace("rilievo-pieces-2", "other"),
                     whole.replace('"world_from_eye"', '"world"', 1)):
            plan.write_text(text)
            self.refused([*piece, "0"], "pieces.json")
        plan.write_text(whole.replace("builtin:stonehenge", "builtin:teapots"))
        self.refused([*piece, "0"], "has changed since", "pieces.json")
        # No file starts a program.
        plan, _ = self.plan("environment-nodes", self.exec)
        self.refused([*piece, "0"], "--source", self.exec)
        self.refused([*piece, "0", "--source", "exec:/bin/true"], "--source", self.exec)
        self.assertFalse(self.log.exists())

    def test_without_slurm_nothing_is_planned(self):
        self.refused(["bake", STONES, "--as", "environment-nodes", *KINDS["environment-nodes"], "--source",
                      "raytrace", "--slurm", "2", "-o", self.folder / "o.exr"], "--slurm", "sbatch",
                     env={**os.environ, "PATH": str(self.folder)})
        self.assertEqual(files_below(self.folder).keys(), {"renderer"})

    def test_a_full_disk_is_an_error_of_the_piece_and_leaves_nothing(self):
        plan, _ = self.plan("environment-nodes", "raytrace")
        small = subprocess.run(
            ["sh", "-c", 'ulimit -f 4; exec "$@"', "sh", command.program, "bake", "--plan", str(plan),
             "--piece", "0"], capture_output=True, text=True, timeout=command.TIMEOUT_S)
        self.assertEqual(small.returncode, 2, small.stderr)
        self.assertIn("piece 0 cannot be kept", small.stderr)
        self.assertEqual(files_below(self.folder / "pieces.json.pictures"), {})


if __name__ == "__main__":
    command.main()
