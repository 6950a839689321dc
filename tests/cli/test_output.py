#!/usr/bin/env python3
"""Output is there whole, or the program says that it is not: places, devices, full disks, signals;
and numbers and names that would pass in silence.

    test_output.py PATH/TO/rilievo [unittest arguments]
"""

import json
import os
import pathlib
import random
import resource
import signal
import stat
import subprocess
import threading
import time

import command
from command import TEAPOTS, SMALL, files_below

TEAPOT = "builtin:teapot?triangles=4000"
SMALL_BAKE = ("--views", "12", "--size", "16", "--layers", "4")
MISSING = "gone.glb"  # who complains about this scene has begun to work


class Places(command.Case):
    def outputs(self):
        """Every option that names an output, the extension that it wants, and whether it is a
        folder."""
        out = self.folder / "made"
        return [
            (("info", MISSING, "--json"), "", False),
            (("scene", MISSING, "-o"), ".glb", False),
            (("scene", MISSING, "-o", out / "s.glb", "--save-path"), "", False),
            (("bake", MISSING, "-o"), ".exr", False),
            (("bake", MISSING, "-o", out / "b.exr", "--json"), "", False),
            (("render", MISSING, "-o"), "", True),
            (("render", MISSING, "-o", out, "--save-pictures"), "", True),
            (("render", MISSING, "-o", out, "--json"), "", False),
            (("render", MISSING, "--loop-seconds", "1", "--json"), "", False),
            (("compare", MISSING, "-o"), "", True),
            (("compare", MISSING, "-o", out, "--json"), "", False),
            (("bench", "rgbd", "--capture", MISSING, "--json"), "", False),
            (("bench", "rgbd", "--capture", MISSING, "--html"), "", False),
        ]

    def test_a_place_that_cannot_be_written_is_refused_before_the_work(self):
        blocker = self.write("file", b"x")
        for arguments, extension, takes_folder in self.outputs():
            taken = self.folder / ("folder" + extension)
            taken.mkdir(exist_ok=True)
            places = [(blocker / ("below" + extension), blocker),
                      (blocker / "far" / ("below" + extension), blocker),
                      # Not even root makes a file there.
                      (pathlib.Path("/proc/no_such_thing" + extension), "/proc")]
            places.append((blocker, blocker) if takes_folder else (taken, taken))
            for place, named in places:
                with self.subTest(arguments=arguments, place=place):
                    self.refused([*arguments, place], named)
            self.assertEqual(files_below(self.folder), {"file": b"x"})
        self.assertFalse((self.folder / "made").exists())

    def test_reports_do_not_go_where_a_folder_has_their_name(self):
        (self.folder / "report.html").mkdir()
        self.refused(["compare", MISSING, "-o", self.folder], self.folder / "report.html")

    def test_folders_that_are_missing_are_made(self):
        self.succeeds("scene", "teapot?triangles=500", "-o", self.folder / "a" / "b" / "t.glb",
                      "--save-path", self.folder / "c" / "path.json")
        self.succeeds("info", TEAPOT, "--json", self.folder / "d" / "e" / "info.json")
        self.succeeds("bake", TEAPOT, *SMALL_BAKE, "-o", self.folder / "f" / "t.exr",
                      "--json", self.folder / "g" / "bake.json")
        self.succeeds("render", TEAPOT, "--method", "relief-impostor", "--orbit", "1", "--size", "32x24",
                      "--draw", "software", "-o", self.folder / "h" / "i", "--store",
                      self.folder / "j" / "k" / "store.db", "--json", self.folder / "l" / "render.json")
        self.assertEqual(files_below(self.folder).keys(),
                         {"a/b/t.glb", "c/path.json", "d/e/info.json", "f/t.exr", "g/bake.json",
                          "h/i/frame_00000.png", "j/k/store.db", "l/render.json"})

    def test_a_link_stays_and_its_target_keeps_its_permissions(self):
        for name, arguments in (("t.glb", ("scene", "teapot?triangles=500", "-o")),
                                ("t.exr", ("bake", TEAPOT, *SMALL_BAKE, "-o")),
                                ("t.json", ("info", TEAPOT, "--json"))):
            with self.subTest(name):
                target = self.write("target", b"old")
                target.chmod(0o640)
                link = self.folder / name
                link.symlink_to("target")
                self.succeeds(*arguments, link)
                self.assertTrue(link.is_symlink())
                self.assertGreater(target.stat().st_size, 100)
                self.assertEqual(stat.S_IMODE(target.stat().st_mode), 0o640)
                link.unlink()
                self.assertEqual(files_below(self.folder).keys(), {"target"})

    def test_a_device_is_written_into_and_stays(self):
        # A device of our own: what replaces it harms nobody.
        null = self.folder / "null"
        try:
            os.mknod(null, stat.S_IFCHR | 0o666, os.makedev(1, 3))
            null.write_bytes(b"x")
        except OSError:
            null = None  # only root may
        link = self.folder / "null.exr"
        link.symlink_to("/dev/null")
        places = [("bake", TEAPOT, *SMALL_BAKE, "-o", link)]
        if null:
            places += [("info", TEAPOT, "--json", null),
                       ("bench", "nailboard-error", "--quick", "--html", null)]
        for arguments in places:
            with self.subTest(arguments):
                self.succeeds(*arguments)
        self.assertTrue(link.is_symlink())
        self.assertTrue(null is None or stat.S_ISCHR(null.lstat().st_mode))

    def test_a_pipe_is_written_into(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        read = []
        # A daemon, for whom nobody waits if nothing is ever written.
        reader = threading.Thread(target=lambda: read.append(pipe.read_text()), daemon=True)
        reader.start()
        self.succeeds("info", TEAPOT, "--json", pipe)
        self.assertTrue(stat.S_ISFIFO(pipe.lstat().st_mode))
        reader.join(60)
        self.assertEqual(json.loads(read[0])["schema"], "rilievo-info-1")

    def test_the_standard_output_by_its_name_keeps_what_is_there(self):
        for name in ("/dev/stdout", "/dev/fd/1"):
            self.assertIn("schema", json.loads(
                self.succeeds("info", TEAPOT, "--json", name).stdout))
            file = self.write("log", "first\n")
            with open(file, "a") as log:
                subprocess.run([command.program, "info", TEAPOT, "--json", name], stdout=log,
                               check=True, timeout=command.TIMEOUT_S)
            head, figures = file.read_text().split("\n", 1)
            self.assertEqual(head, "first")
            self.assertIn("schema", json.loads(figures))


class Lost(command.Case):
    """Output that did not arrive."""

    def to(self, device, *arguments, stream="stdout"):
        streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        with open(device, "wb") as sink:
            streams[stream] = sink
            return subprocess.run([command.program, *map(str, arguments)], **streams,
                                  text=True, timeout=command.TIMEOUT_S)

    def test_printing_to_a_full_disk_is_an_error(self):
        baked, pictures = self.folder / "baked.exr", self.folder / "pictures"
        self.succeeds("bake", TEAPOT, *SMALL_BAKE, "-o", baked)
        self.succeeds("render", TEAPOT, "--size", "32x32", "--frames", "1", "-o",
                      self.folder / "frames", "--save-pictures", pictures)
        picture = pictures / "pictures_00000.exr"
        for arguments in (
                ("--help",), ("bake", "--help"), ("info", TEAPOT), ("info", baked),
                ("info", picture), ("info", TEAPOT, "--json", "-"), ("info", baked, "--json", "-"),
                ("info", picture, "--json", "-"), ("info", TEAPOT, "--json", "/dev/stdout"),
                ("bake", TEAPOT, *SMALL_BAKE, "-o", baked),
                ("bake", TEAPOT, *SMALL_BAKE, "-o", baked, "--json", "-"),
                ("render", TEAPOT, "--size", "8x8", "--loop-seconds", "0.1"),
                ("render", TEAPOT, "--size", "8x8", "--frames", "1", "-o", self.folder / "f",
                 "--json", "-"),
                ("compare", TEAPOT, "--size", "32x32", "--frames", "1", "--methods", "direct", "-o",
                 self.folder / "r"),
                ("compare", TEAPOT, "--size", "32x32", "--frames", "1", "--methods", "direct", "-o",
                 self.folder / "r", "--json", "-"),
                ("bench", "nailboard-error", "--quick"),
                ("bench", "nailboard-error", "--quick", "--json", "-")):
            with self.subTest(arguments):
                done = self.to("/dev/full", *arguments)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertRegex(done.stderr, r"\Arilievo: (standard output|/dev/stdout): cannot be "
                                              r"written: No space left on device\n\Z")

    def test_an_error_is_an_error_where_nobody_can_be_told(self):
        self.assertEqual(self.to("/dev/full", "info", MISSING, stream="stderr").returncode, 2)
        scene = self.write("s.obj", "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.assertIn("warning", self.succeeds("info", scene).stderr)
        self.assertEqual(self.to("/dev/full", "info", scene, stream="stderr").returncode, 0)

    def test_an_error_of_the_work_is_the_one_that_is_told(self):
        done = self.to("/dev/full", "info", MISSING)
        self.assertEqual(done.returncode, 2)
        self.assertEqual(len(done.stderr.splitlines()), 1)
        self.assertIn(MISSING, done.stderr)

    def test_a_closed_output_is_an_error_where_something_is_printed(self):
        def closed(*arguments):
            return subprocess.run(["sh", "-c", 'exec "$0" "$@" >&-', command.program,
                                   *map(str, arguments)], stderr=subprocess.PIPE, text=True,
                                  timeout=command.TIMEOUT_S)
        done = closed("info", TEAPOT)
        self.assertEqual(done.returncode, 2)
        self.assertIn("standard output", done.stderr)
        # Its number is not given to the file.
        out = self.folder / "t.glb"
        self.assertEqual(closed("scene", "teapot?triangles=500", "-o", out).returncode, 0)
        self.succeeds("info", out)

    def test_a_reader_who_leaves_ends_the_program_without_noise(self):
        for ignored, code in ((False, -signal.SIGPIPE), (True, 2)):
            read, write = os.pipe()
            os.close(read)
            disposition = signal.SIG_IGN if ignored else signal.SIG_DFL
            done = subprocess.run(
                [command.program, "info", TEAPOT], stdout=write, stderr=subprocess.PIPE, text=True,
                timeout=command.TIMEOUT_S, restore_signals=False,
                preexec_fn=lambda how=disposition: signal.signal(signal.SIGPIPE, how))
            os.close(write)
            self.assertEqual(done.returncode, code)
            self.assertEqual(len(done.stderr.splitlines()), 1 if ignored else 0, done.stderr)

    def test_a_file_that_does_not_fit_is_an_error_and_leaves_nothing(self):
        # As a shell's `ulimit -f` does: the signal of this limit would end the program. The old
        # files stay.
        old = {name: b"old" for name in ("t.glb", "t.exr", "t.json", "t.html", "p.json")}
        for name, content in old.items():
            self.write(name, content)
        at = {name: self.folder / name for name in old}

        def small():
            resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
        for file, arguments in (
                ("t.glb", ("scene", "teapot?triangles=500", "-o", at["t.glb"])),
                ("t.exr", ("bake", TEAPOT, *SMALL_BAKE, "-o", at["t.exr"])),
                ("t.json", ("info", TEAPOT, "--json", at["t.json"])),
                ("t.html", ("bench", "nailboard-error", "--quick", "--html", at["t.html"])),
                ("frame_00000.png", ("render", TEAPOT, *SMALL, "-o", self.folder)),
                ("report.json", ("compare", TEAPOT, *SMALL, "--methods", "flat", "-o", self.folder))):
            with self.subTest(arguments):
                self.refused(arguments, self.folder / file, "File too large", preexec_fn=small)
                self.assertEqual(files_below(self.folder), old)

    def test_a_full_device_is_an_error_and_stays(self):
        for name, arguments in (("t.glb", ("scene", "teapot?triangles=500", "-o")),
                                ("t.exr", ("bake", TEAPOT, *SMALL_BAKE, "-o")),
                                ("t.json", ("info", TEAPOT, "--json"))):
            with self.subTest(name):
                link = self.folder / name
                link.symlink_to("/dev/full")
                self.refused([*arguments, link], link, "No space left on device")
                self.assertTrue(link.is_symlink())


class Signals(command.Case):
    BIG = ("scene", "bridge?triangles=1000000", "-o")

    def start(self, *arguments):
        return subprocess.Popen([command.program, *map(str, arguments)], stdin=subprocess.DEVNULL,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def unfinished(self):
        return [name for name in os.listdir(self.folder) if name.endswith(".part")]

    def end(self, process, number):
        process.send_signal(number)
        _, errors = process.communicate(timeout=command.TIMEOUT_S)
        self.assertIn(process.returncode, (-number, 0))  # it may have been done already
        self.assertEqual(errors, "")
        self.assertEqual(list(self.folder.rglob("*.part")), [])
        return process.returncode

    def test_a_signal_while_a_file_is_written_removes_it(self):
        """Waits until the unfinished file is there; it takes some 10 ms to write."""
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            ended = []
            # A try misses the moment on a busy machine; what it leaves is looked at all the same.
            while len(ended) < 5 and -number not in ended:
                process = self.start(*self.BIG, self.folder / "b.glb")
                while process.poll() is None and not self.unfinished():
                    pass
                ended.append(self.end(process, number))
            self.assertIn(-number, ended)

    def test_signals_at_any_moment_leave_nothing_unfinished(self):
        moments = random.Random(12)
        work = (("bake", TEAPOT, "--size", "128", "-o", self.folder / "t.exr"),
                ("render", TEAPOTS, "--size", "640x360", "--frames", "20", "-o",
                 self.folder / "frames", "--save-pictures", self.folder / "pictures"))
        for arguments in work:
            for number in (signal.SIGINT, signal.SIGTERM):
                for _ in range(3):
                    process = self.start(*arguments)
                    time.sleep(moments.uniform(0, 1))
                    code = self.end(process, number)
                    if code == 0:
                        continue
                    # What is there is whole.
                    for file in files_below(self.folder):
                        if file.endswith(".exr"):
                            self.succeeds("info", self.folder / file)

    def test_a_signal_that_the_caller_ignores_stays_ignored(self):
        process = subprocess.Popen(
            [command.program, "render", TEAPOT, "--size", "8x8", "--loop-seconds", "1"],
            stdout=subprocess.PIPE, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        time.sleep(0.3)
        process.send_signal(signal.SIGHUP)
        process.communicate(timeout=command.TIMEOUT_S)
        self.assertEqual(process.returncode, 0)


class Values(command.Case):
    NUMBERS = {
        "render": ("--angle", "--error-px", "--capture-ms", "--late", "--texel-px",
                   "--memory-mb", "--bake-mb", "--delta-bits",
                   "--frames", "--orbit", "--walk", "--samples", "--size", "--loop-seconds"),
        "bake": ("--overlap", "--ring", "--size", "--layers", "--views", "--box"),
    }

    def test_no_option_takes_what_is_no_number(self):
        for name, options in self.NUMBERS.items():
            out = () if name == "bake" else ("-o", self.folder / "out")
            for option in options:
                output = () if option == "--loop-seconds" else out
                for value in ("nan", "-nan", "inf", "-inf", "1e999", ""):
                    if option == "--box" and value:
                        value = f"0,0,0,1,1,{value}"
                    with self.subTest(option=option, value=value):
                        self.refused([name, MISSING, f"{option}={value}", *output,
                                      *(("-o", self.folder / "t.exr") if name == "bake" else ())],
                                     option)
        self.assertEqual(files_below(self.folder), {})

    def test_an_empty_name_is_an_error(self):
        for arguments in (
                ("info", ""), ("info", TEAPOT, "--json", ""), ("scene", "teapot", "-o", ""),
                ("scene", "teapot", "-o", self.folder / "t.glb", "--save-path", ""),
                ("bake", TEAPOT, "-o", ""), ("bake", "", "-o", self.folder / "t.exr"),
                ("render", TEAPOT, "-o", ""), ("render", TEAPOT, "-o", self.folder, "--path", ""),
                ("render", TEAPOT, "-o", self.folder, "--save-pictures", ""),
                ("compare", TEAPOT, "-o", ""), ("compare", TEAPOT, "-o", self.folder, "--scene", ""),
                ("bench", "rgbd", "--quick", "--capture", ""),
                ("bench", "nailboard-error", "--quick", "--html", "")):
            with self.subTest(arguments):
                self.refused(arguments, "empty")
        self.assertEqual(files_below(self.folder), {})

    def test_a_name_that_is_not_utf_8_makes_sound_json(self):
        out = self.folder / "out"
        odd = os.fsdecode(b"t\xff\xe9 \xc3")
        scene, baked = self.folder / f"{odd}.glb", self.folder / f"{odd}.exr"
        self.succeeds("scene", "teapot?triangles=500", "-o", scene)
        for arguments in (
                ("info", scene), ("bake", scene, *SMALL_BAKE, "-o", baked), ("info", baked),
                ("render", scene, *SMALL, "-o", out, "--save-pictures", self.folder / odd),
                ("info", self.folder / odd / "pictures_00000.exr"),
                ("render", scene, "--size", "8x8", "--loop-seconds", "0.1"),
                ("compare", scene, "--size", "32x32", "--frames", "1", "--methods", "flat", "-o",
                 out)):
            with self.subTest(arguments):
                done = subprocess.run([command.program, *map(str, arguments), "--json", "-"],
                                      capture_output=True, timeout=command.TIMEOUT_S)
                self.assertEqual((done.returncode, done.stderr), (0, b""))
                figures = json.loads(done.stdout.decode())  # strict: it is UTF-8
                self.assertIn("schema", figures)
                if arguments[0] in ("bake", "render"):
                    self.assertTrue(figures["scene"].endswith("t�� �.glb"), figures)


if __name__ == "__main__":
    command.main()
