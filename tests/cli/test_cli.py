#!/usr/bin/env python3
"""The command line keeps its promises: exit codes, one-line errors, JSON, the same bytes each time.

    test_cli.py PATH/TO/rilievo [unittest arguments]
"""

import json
import os
import pathlib
import shutil
import struct
import subprocess
import unittest

import command
from command import TEAPOTS, files_below


class Folder(command.Case):
    def refused(self, *arguments):
        """Exit code 2, nothing but one line on the error output; returns that line."""
        result = command.run(*arguments)
        self.assertEqual(result.returncode, 2, (arguments, result.stdout, result.stderr))
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 1, (arguments, result.stderr))
        self.assertTrue(lines[0].startswith("rilievo: "), lines[0])
        return lines[0]


class Usage(Folder):
    def test_every_command_explains_itself_by_an_example(self):
        commands = ["info", "scene", "bake", "render", "compare", "bench"]
        for command in commands:
            self.assertIn(f"Example: rilievo {command}", self.succeeds(command, "--help").stdout)
        for command in commands:
            self.assertIn(command, self.succeeds("--help").stdout)

    def test_it_says_which_version_it_is(self):
        self.assertRegex(self.succeeds("--version").stdout, r"^rilievo \d+\.\d+\.\d+ \(\S+\)\n$")

    def test_wrong_usage_ends_in_one_line(self):
        frame = ("render", TEAPOTS, "-o", self.folder / "out")
        for arguments in [
            (), ("nonsense",), ("render",), ("render", TEAPOTS),
            (*frame, "--size", "0x0"), (*frame, "--size", "12"), (*frame, "--size", "1x"),
            (*frame, "--size", "-5x5"), (*frame, "--size", "16384x16384"),
            (*frame, "--size", "99999999999999999999x1"),
            (*frame, "--frames", "0"), (*frame, "--frames", "-1"), (*frame, "--frames", "nan"),
            (*frame, "--orbit", "3", "--walk", "3"), (*frame, "--orbit", "0"),
            (*frame, "--samples", "3"), (*frame, "--method", "magic"),
            (*frame, "--save-pictures", self.folder, "--method", "direct"),
            ("bench",), ("bench", "nonsense"), ("compare", TEAPOTS),
            ("compare", TEAPOTS, "--methods", "magic", "-o", self.folder / "out"),
            ("compare", TEAPOTS, "--size", "10x100", "-o", self.folder / "out"),
            (*frame, "--delta-bits", "7"), (*frame, "--depth", "curved"),
        ]:
            with self.subTest(arguments=arguments):
                self.refused(*arguments)
        self.assertFalse((self.folder / "out").exists())

    def test_scenes_that_are_not_there_are_named(self):
        self.refused("scene", "a" * 300, "-o", self.folder / "x.glb")
        for scene in ["/nowhere/at all.glb", "builtin:atlantis", "builtin:teapots?triangles=-1",
                      "builtin:teapots?wheels=4", str(self.folder)]:
            with self.subTest(scene=scene):
                self.assertIn(scene, self.refused("info", scene))


class Help(command.Case):
    def options(self, *arguments):
        return [line for line in self.succeeds(*arguments).stdout.splitlines()
                if line.startswith("  -")]

    def test_help_shows_what_most_need_and_help_all_the_rest(self):
        for name in ("render", "compare"):
            few, all_of_them = self.options(name, "--help"), self.options(name, "--help-all")
            self.assertLessEqual(len(few), 20, name)
            self.assertGreater(len(all_of_them), 2 * len(few), name)
            self.assertLessEqual({line.split()[0] for line in few},
                                 {line.split()[0] for line in all_of_them})
            self.assertIn(f"{len(all_of_them) - len(few)} more options: rilievo {name} --help-all",
                          self.succeeds(name, "--help").stdout)
        text = self.succeeds("render", "--help-all").stdout
        for group in ("Of cache:", "Of keyframes:", "Of auto:"):
            self.assertIn(group, text)

    def test_bash_completes_commands_options_and_values(self):
        script = self.write("completion.bash", self.succeeds("completion", "bash").stdout)

        def completed(*words):
            line = ("source %s; COMP_WORDS=(rilievo %s); COMP_CWORD=%d; _rilievo; "
                    "echo ${COMPREPLY[@]}" % (script, " ".join(f"'{word}'" for word in words), len(words)))
            done = subprocess.run(["bash", "-c", line], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.stderr, "")
            return done.stdout.split()

        self.assertEqual(completed("rend"), ["render"])
        self.assertEqual(completed("render", "--key"), ["--keyframe-ms", "--keyframe-samples"])
        self.assertEqual(completed("render", "--draw", "s"), ["software"])
        self.assertEqual(completed("info", "--units", "m"), ["m", "mm"])
        self.assertIn("#compdef rilievo", self.succeeds("completion", "zsh").stdout)

    def test_the_manual_names_every_command_and_option(self):
        manual = self.succeeds("manual").stdout
        self.assertTrue(manual.startswith(".TH RILIEVO 1"))
        for name in ("render", "bake", "web", "completion"):
            self.assertIn(f".SS rilievo {name}\n", manual)
        self.assertIn("\\-\\-keyframe\\-ms", manual)
        self.assertNotRegex(manual, r"(?m)^\.(?!TH|SH|SS|TP|B |PP|nf|fi)")


class Paths(Folder):
    def path_file(self, text):
        file = self.folder / "path.json"
        file.write_text(text)
        return file

    def test_a_broken_path_file_is_named(self):
        key = '{"time": 0, "eye": [0, 1, 9], "target": [0, 0, 0], "vertical_fov": 0.9}'
        for text in ["", "{", "[]", "{}", '{"schema": "rilievo-path-1", "keys": []}',
                     '{"schema": "rilievo-path-1", "keys": [%s, %s]}' % (key, key),
                     '{"schema": "rilievo-path-1", "keys": [%s]}' % key.replace("9]", "NaN]"),
                     '{"schema": "rilievo-path-1", "keys": [%s]}' % key.replace("9]", "1e999]"),
                     '{"schema": "rilievo-path-1", "keys": [%s]}' % key.replace("0.9", "9")]:
            with self.subTest(text=text):
                file = self.path_file(text)
                self.assertIn(str(file), self.refused("render", TEAPOTS, "--path", file, "-o",
                                                      self.folder / "out"))

    def test_a_path_of_one_key_is_one_frame(self):
        file = self.path_file('{"schema": "rilievo-path-1", "keys": [{"time": 0, "eye": [0, 3, 9],'
                              ' "target": [0, 0, 0], "vertical_fov": 0.9}]}')
        self.succeeds("render", TEAPOTS, "--path", file, "--size", "64x36", "-o", self.folder / "a" / "b")
        self.assertEqual(list(files_below(self.folder / "a" / "b")), ["frame_00000.png"])

    def test_frames_in_linear_light_are_pictures_that_draw_again(self):
        frame = ("render", TEAPOTS, "--method", "direct-raster", "--draw", "software", "--frames", "1", "--size", "64x36")
        self.succeeds(*frame, "--format", "exr", "-o", self.folder / "linear")
        self.succeeds(*frame, "-o", self.folder / "screen")
        linear = self.folder / "linear" / "frame_00000.exr"
        self.assertEqual(list(files_below(self.folder / "linear")), ["frame_00000.exr"])
        info = json.loads(self.succeeds("info", linear, "--json", "-").stdout)
        self.assertIn("64", str(info))
        self.succeeds("render", linear, "--draw", "software", "-o", self.folder / "again")
        self.assertEqual(list(files_below(self.folder / "again")), ["frame_00000.png"])


class Results(Folder):
    def test_info_in_json_counts_the_scene(self):
        result = self.succeeds("info", TEAPOTS, "--json", "-")
        info = json.loads(result.stdout)
        self.assertEqual(info["schema"], "rilievo-info-1")
        self.assertLessEqual(abs(info["triangles"] - 20000), 1000)
        self.assertEqual(result.stderr, "")  # no progress in a pipe

    def test_a_machine_is_measured_and_stored_and_its_costs_are_used(self):
        file = self.folder / "machine.json"
        self.succeeds("info", "--machine", "--json", file)
        machine = json.loads(file.read_text())
        self.assertEqual(machine["schema"], "rilievo-machine-1")
        text = self.succeeds("info", "--machine").stdout
        for name in ["software", "rasterizer", "rays", machine["cpu"]]:
            self.assertIn(name, text)
        # What was measured is of a machine that does other things, too.
        for costs in [machine["draw"]["software"], *machine["capture"].values()]:
            costs.update({name: 10.0 for name in costs})
        frames = {}
        for name, triangle_ns in [("cheap", 1.0), ("dear", 1e5)]:
            machine["draw"]["software"]["triangle_ns"] = triangle_ns
            stored = self.write(name + ".json", json.dumps(machine))
            out = self.folder / name
            done = self.succeeds("compare", "builtin:bridge?triangles=100000", "--methods", "cache",
                                 "--draw", "software", "--machine", stored, "--size", "96x64",
                                 "--frames", "3", "-o", out, "--json", "-")
            frames[name] = json.loads(done.stdout)["methods"]["cache"]
        self.assertGreater(frames["dear"]["captures"], frames["cheap"]["captures"])

    def test_a_broken_file_of_a_machine_is_named(self):
        good = {"schema": "rilievo-machine-1",
                "draw": {"software": {"picture_ns": 1, "picture_pixel_ns": 1, "object_ns": 1,
                                      "triangle_ns": 1, "polygon_pixel_ns": 1}},
                "capture": {"rasterizer": {"picture_ns": 1, "triangle_ns": 1, "texel_ns": 1},
                            "rays": {"texel_ns": 1}}}
        text = json.dumps(good)
        frame = ("render", TEAPOTS, "--method", "cache", "--size", "32x32", "--frames", "1",
                 "-o", self.folder / "out", "--machine")
        for name, content in [("empty", ""), ("nan", text.replace("1", "NaN")),
                              ("negative", text.replace(" 1", " -1")), ("cut", text[:-9]),
                              ("huge", text.replace(" 1", " 1e300")), ("schema", "{}"),
                              ("missing", text.replace("object_ns", "objects"))]:
            with self.subTest(name=name):
                file = self.write(name, content)
                self.assertIn(str(file), self.refused(*frame, file))
        self.assertIn("none.json", self.refused(*frame, self.folder / "none.json"))
        self.assertFalse((self.folder / "out").exists())
        # It knows nothing of OpenGL.
        line = self.refused(*frame, self.write("good", text), "--draw", "opengl")
        self.assertIn("--machine", line)
        self.succeeds(*frame, self.folder / "good", "--draw", "software")
        self.refused("info", "--machine", "builtin:teapots")
        self.refused("info")

    def test_compare_reports_every_method_and_direct_drawing(self):
        out = self.folder / "new" / "report"
        result = self.succeeds("compare", TEAPOTS, "--methods", "nailboard,flat", "--frames", "3",
                           "--size", "160x90", "-o", out, "--json", "-")
        report = json.loads(result.stdout)
        self.assertEqual(report, json.loads((out / "report.json").read_text()))
        self.assertEqual(report["schema"], "rilievo-report-1")
        self.assertEqual(report["size"], [160, 90])
        self.assertEqual(report["frames"], 3)
        self.assertEqual(set(report["methods"]), {"direct", "nailboard", "flat"})
        for method in report["methods"].values():
            for figure, parts in {"frame_ms": ["p50", "p99", "max"], "psnr_db": ["mean", "min"],
                                  "ssim": ["mean", "min"], "flip": ["mean", "max"],
                                  "wrong_visibility": ["mean", "max"], "depth_error": ["p50", "p99"],
                                  "uncovered": ["mean", "max"]}.items():
                self.assertEqual(set(method[figure]), set(parts))
            self.assertGreater(method["frame_ms"]["p50"], 0)
            for figure in ["captures", "capture_ms", "picture_bytes"]:
                self.assertIn(figure, method)
        direct, nailboard, flat = (report["methods"][m] for m in ["direct", "nailboard", "flat"])
        self.assertEqual(direct["wrong_visibility"]["max"], 0)
        self.assertEqual(direct["ssim"]["min"], 1)
        self.assertGreater(nailboard["captures"], 0)
        # The things on the table touch each other: a flat picture cannot get that right.
        self.assertGreater(flat["wrong_visibility"]["mean"], nailboard["wrong_visibility"]["mean"])
        page = (out / "report.html").read_text()
        self.assertNotIn("http://", page.replace("http://www.w3.org/", ""))

    def test_a_scene_written_as_a_file_draws_the_same(self):
        # One that stands still: motions are written as quaternions, which come back rounded.
        forest = "forest?triangles=20000"
        glb = self.folder / "made" / "forest.glb"
        path = self.folder / "made" / "path.json"
        self.succeeds("scene", forest, "-o", glb, "--save-path", path)
        same = ("--method", "direct", "--path", path, "--frames", "2", "--size", "160x90")
        self.succeeds("render", "builtin:" + forest, *same, "-o", self.folder / "built")
        self.succeeds("render", glb, *same, "-o", self.folder / "loaded")
        self.assertEqual(files_below(self.folder / "loaded"), files_below(self.folder / "built"))
        self.assertIn("name must end in .glb", self.refused("scene", "teapots", "-o", "t.obj"))

    def test_a_loop_reports_its_memory(self):
        # Beside other tests one frame may take a second.
        result = self.succeeds("render", TEAPOTS, "--size", "64x36", "--frames", "4", "--loop-seconds",
                           "8", "--json", "-")
        loop = json.loads(result.stdout)
        self.assertGreaterEqual(loop["seconds"], 8)
        self.assertGreater(loop["frames"], 4)
        self.assertGreater(loop["memory_mb_after_warm_up"], 1)
        self.assertGreaterEqual(loop["memory_mb_most"], loop["memory_mb_after_warm_up"])

    def test_saved_pictures_draw_the_frame_they_were_saved_from(self):
        frame = ("--frames", "1", "--size", "320x180")
        for bits in ["8", "16"]:
            self.succeeds("render", "builtin:teapot?triangles=5000", *frame, "--delta-bits", bits, "--draw", "opengl", "-o",
                      self.folder / "live", "--save-pictures", self.folder / "pictures")
            self.succeeds("render", self.folder / "pictures" / "pictures_00000.exr", "--draw", "opengl",
                      "-o", self.folder / "again")
            self.assertEqual(files_below(self.folder / "again"), files_below(self.folder / "live"))
        info = self.succeeds("info", self.folder / "pictures" / "pictures_00000.exr", "--json", "-")
        self.assertEqual(len(json.loads(info.stdout)["pictures"]), 1)

    def test_saved_pictures_refuse_what_is_for_other_frames_than_theirs(self):
        out, pictures = self.folder / "out", self.folder / "pictures"
        self.succeeds("render", TEAPOTS, "--frames", "1", "--size", "64x36", "-o", self.folder / "live",
                      "--save-pictures", pictures)
        draw = ("render", pictures / "pictures_00000.exr", "-o", out)
        for option, value in (("--orbit", "6"), ("--walk", "6"), ("--frames", "2"), ("--size", "32x32"),
                              ("--method", "flat"), ("--method", "cache")):
            with self.subTest(option=option):
                self.assertIn(option, self.refused(*draw, option, value))
        self.assertFalse(out.exists())
        self.refused("render", TEAPOTS, "--save-pictures", pictures, "--loop-seconds", "1")
        path = self.write("path.json", '{"schema": "rilievo-path-1", "keys": '
                                       '[{"time": 0, "eye": [0, 1, 9], "target": [0, 1, 0], "vertical_fov": 0.8}]}')
        self.succeeds(*draw, "--path", path, "--frames", "2", "--size", "32x32")
        self.assertEqual(len(files_below(out)), 2)

    def test_a_walk_past_a_scene_is_not_the_scenes_own_path(self):
        self.succeeds("render", TEAPOTS, "--size", "32x32", "--frames", "3", "-o", self.folder / "own")
        self.succeeds("render", TEAPOTS, "--size", "32x32", "--walk", "3", "-o", self.folder / "walk")
        own, walk = files_below(self.folder / "own"), files_below(self.folder / "walk")
        self.assertEqual(len(walk), 3)
        for frame in own:
            self.assertNotEqual(own[frame], walk[frame])

    def test_options_of_several_kinds_can_have_the_same_name(self):
        small = ("--size", "48x32", "--frames", "1", "-o", self.folder / "out")
        self.succeeds("compare", "builtin:teapot?triangles=2000", *small, "--methods",
                      "layered-relief,environment-nodes", "--draw", "software",
                      *command.settings("environment-nodes", merge="first"),
                      *command.settings("layered-relief", merge=0.2, size=32))


class Settings(Folder):
    def test_what_info_lists_is_what_set_takes(self):
        listed = json.loads(self.succeeds("info", "--kinds", "--json", "-").stdout)
        self.assertEqual([one["kind"] for one in listed],
                         ["layered-impostor", "environment-nodes", "layered-relief"])
        text = self.succeeds("info", "--kinds").stdout
        words = self.succeeds("completion", "bash").stdout
        for kind in listed:
            self.assertGreater(len(kind["options"]), 5)
            for option in kind["options"]:
                self.assertIn(option["name"], text)
                self.assertIn(option["name"], words)
                # Known, so that the value is what is refused.
                self.refused(["render", "missing.glb", "--set", option["name"] + "=", "-o",
                              self.folder / "out"], option["name"], "is not")

    def test_what_is_no_setting_is_refused_by_name(self):
        out = ("-o", self.folder / "out")
        for text, *named in (("views=12", "KIND.NAME"), ("statue.views=12", "statue", "layered-relief"),
                             ("layered-impostor.face=12", "layered-impostor.face"),
                             ("layered-impostor.views=13", "13", "12, 20, 32"),
                             ("layered-impostor.views", "12, 20, 32"), ("", "KIND.NAME")):
            with self.subTest(text):
                self.refused(["render", TEAPOTS, "--set", text, *out], "--set", *named)

    def test_a_setting_is_of_its_kind_alone_and_the_last_one_counts(self):
        report = json.loads(self.succeeds(
            "compare", "builtin:teapot?triangles=2000", "--methods",
            "layered-relief,layered-impostor", "--size", "48x32", "--frames", "1", "--draw",
            "software", *command.settings("layered-impostor", views=20, size=32),
            *command.settings("layered-impostor", views=12),
            *command.settings("layered-relief", size=32, textures=1), "-o", self.folder / "out",
            "--json", "-").stdout)
        self.assertEqual(report["methods"]["layered-impostor"]["captures"], 12)
        self.assertEqual(report["methods"]["layered-relief"]["captures"], 1)


class Benches(Folder):
    def test_benches_report_their_figures(self):
        figures = {
            "nailboard-error": ["max_error_percent_rotation_30", "max_error_percent_translation_5"],
            "nailboard-bits": [f"wrong_visibility_{bits}bit" for bits in [2, 4, 6, 8, 16]],
            "pop": ["pop_max_faded", "pop_max_unfaded"],
            "spinning": [f"{what}_{way}" for way in ["direct", "cache", "walk", "slices"] for what in
                         ["frame_ms_p50", "psnr_db", "bound_px_max", "layered_share"]],
            "bound": ["cases", "violations", "tightness_median"],
            "draw": ["fill_cost_ratio", "nailboards_per_ms", "ten_thousand_ms"],
            "coverage": [f"covered_teapot_{what}" for what in
                         ["back_1", "ordinary_1", "12", "20", "32"]],
            "rgbd": [f"{what}_{way}" for way in ["cameras", "around", "direct"] for what in
                     ["psnr", "uncovered", "uncovered_seen", "holes"]],
            "prewarp": ["memcpy_ratio_nearest_256_1t", "memcpy_ratio_splat_256_1t",
                        "msamples_per_s_splat_512_2t"],
            "splats": [f"{what}_{way}" for what in ["flip", "ms"] for way in
                       ["ldi_rect", "ldi_gauss", "lrt_rect", "lrt_gauss"]],
            "relief-run": [f"{what}_{name}" for what in
                           ["warp_p50_ms", "warp_p99_ms", "warped_over_drawn"] for name in
                           ["fish", "cube", "fern"]],
            "layered": ["psnr_db_teapot_32_256_64", "uncovered_teapot_32_256_64",
                        "tears_overlap_0_at_20deg", "jump_slices_switch_12"],
            "layered-cost": ["memory_mb_32_256", "draw_ms_64_220", "break_even_triangles_64_220"],
        }
        for bench, names in figures.items():
            with self.subTest(bench=bench):
                html = self.folder / "pages" / f"{bench}.html"
                result = self.succeeds("bench", bench, "--quick", "--json", "-", "--html", html)
                report = json.loads(result.stdout)
                self.assertEqual(report["schema"], "rilievo-bench-1")
                self.assertEqual(report["bench"], bench)
                for name in names:
                    self.assertIsInstance(report["figures"][name], (int, float))
                self.assertIn("<html", html.read_text())


class Threads(Folder):
    # Software drawing with 0 (in the calling thread), 1 or 2 threads of llvmpipe; measuring with as
    # many as the process may use.
    THREADS = [("0", "1"), ("1", "2"), ("2", "2"), ("2", "2")]

    def with_threads(self, drawing, measuring, *arguments):
        environment = {**os.environ, "LP_NUM_THREADS": drawing, "LIBGL_ALWAYS_SOFTWARE": "1"}
        one_core = {min(os.sched_getaffinity(0))}
        pin = (lambda: os.sched_setaffinity(0, one_core)) if measuring == "1" else None
        return self.succeeds(*arguments, env=environment, preexec_fn=pin)

    def test_frames_are_the_same_whatever_the_threads_and_from_run_to_run(self):
        for method in ["direct", "flat", "nailboard", "cache"]:
            with self.subTest(method=method):
                runs = []
                for i, threads in enumerate(self.THREADS):
                    out = self.folder / f"{method}{i}"
                    self.with_threads(*threads, "render", TEAPOTS, "--method", method, "--draw",
                                      "opengl", "--size", "320x180", "--frames", "5", "-o", out)
                    runs.append(files_below(out))
                self.assertEqual(len(runs[0]), 5)
                for run in runs[1:]:
                    self.assertEqual(run, runs[0])

    # Which of the two is faster depends on the threads, and is not asked here.
    def test_figures_are_the_same_whatever_the_threads_except_for_times(self):
        for draw in ("opengl", "software"):
            with self.subTest(draw=draw):
                runs = []
                for threads in self.THREADS[:3]:
                    result = self.with_threads(*threads, "compare", TEAPOTS, "--draw", draw, "--size",
                                               "160x90", "--frames", "3", "--pop", "-o",
                                               self.folder / "report", "--json", "-")
                    report = json.loads(result.stdout)
                    for method in report["methods"].values():
                        for times in (method, method["series"]):
                            times.pop("frame_ms")
                        method.pop("capture_ms")
                        method.pop("first_frame_ms")
                    runs.append(report["methods"])
                self.assertEqual(runs[1], runs[0])
                self.assertEqual(runs[2], runs[0])


@unittest.skipUnless(shutil.which("xvfb-run"), "needs xvfb-run")
class Window(Folder):
    """With a display that nobody sees. EMBED is the program of examples/embed."""

    def xvfb(self, *command):
        result = subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1280x800x24", *map(str, command)],
                                capture_output=True, text=True, timeout=240)
        self.assertEqual(result.returncode, 0, result.stderr)

    def is_picture(self, file):
        data = file.read_bytes()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(struct.unpack(">II", data[16:24]), (640, 360))
        # One colour all over would shrink to far less.
        self.assertGreater(len(data), 20000)

    def test_the_window_plays_a_path_and_saves_what_it_shows(self):
        shot = self.folder / "made" / "view.png"
        self.xvfb(command.program, "view", TEAPOTS, "--size", "640x360", "--frames", "3", "--split",
                  "--outlines", "--screenshot", shot)
        self.is_picture(shot)

    def test_the_window_shows_frames_of_either_backend(self):
        shot = self.folder / "view.png"
        for draw in ("opengl", "software"):
            self.xvfb(command.program, "view", TEAPOTS, "--size", "640x360", "--frames", "3",
                      "--draw", draw, "--screenshot", shot)
            self.is_picture(shot)

    def test_the_window_shows_a_layered_impostor_from_a_file(self):
        baked, shot = self.folder / "teapot.exr", self.folder / "view.png"
        self.succeeds("bake", "builtin:teapot?triangles=4000", "--views", "12", "--size", "64",
                      "-o", baked)
        self.xvfb(command.program, "view", baked, "--size", "640x360", "--frames", "2",
                  "--screenshot", shot)
        self.is_picture(shot)

    def test_another_program_embeds_pictures_in_its_own_loop(self):
        shot = self.folder / "embed.png"
        self.xvfb(os.environ["EMBED"], TEAPOTS, "3", shot)
        self.assertEqual(shot.read_bytes()[:4], b"\x89PNG")
        self.assertGreater(shot.stat().st_size, 20000)


class NoWindow(Folder):
    def test_without_a_display_there_is_one_line(self):
        result = subprocess.run([command.program, "view", TEAPOTS], capture_output=True, text=True,
                                timeout=240, env={k: v for k, v in os.environ.items()
                                                  if k not in ("DISPLAY", "WAYLAND_DISPLAY")})
        self.assertEqual(result.returncode, 2)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)


if __name__ == "__main__":
    command.main()
