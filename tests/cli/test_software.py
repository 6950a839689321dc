#!/usr/bin/env python3
"""Frames without OpenGL from the command line: on a machine that has none, and beside OpenGL's.

    test_software.py PATH/TO/rilievo [unittest arguments]
"""

import json
import os
import unittest

import command
from command import SMALL, TEAPOTS, files_below

BAKED = {"layered-impostor": ("--views", "12", "--size", "48"),
         "layered-relief": ("--size", "64", "--textures", "6")}


class NoOpenGL(command.Case):
    """As on a machine whose EGL finds no driver."""

    def setUp(self):
        super().setUp()
        self.none = {"env": {**os.environ, "__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent"}}
        out = ("render", TEAPOTS, *SMALL, "-o", self.folder / "refused")
        if command.run(*out, "--draw", "opengl", **self.none).returncode == 0:
            self.skipTest("this EGL does not choose its driver by the variable")
        self.refused((*out, "--draw", "opengl"), "EGL", **self.none)

    def compared(self, *arguments):
        done = self.succeeds("compare", *arguments, *SMALL, "-o", self.folder / "report", "--json",
                             "-", **self.none)
        return json.loads(done.stdout)

    def test_every_method_draws_a_scene(self):
        methods = ["direct", "direct-raster", "direct-rays", "lod", "flat", "nailboard", "cache", "keyframes", "auto",
                   "layered-slices"]
        baked = command.settings("layered-impostor", views=12, size=32)
        for method in methods:
            # Baking takes a sanitized build seconds an object.
            scene = "builtin:teapot?triangles=2000" if method == "layered-slices" else TEAPOTS
            for draw in "automatic", "software":
                done = self.succeeds("render", scene, "--method", method, "--draw", draw, *SMALL,
                                     *baked, "-o", self.folder / method / draw, "--json", "-", **self.none)
                self.assertEqual(json.loads(done.stdout)["draw"], "software")
            frames = [files_below(self.folder / method / draw) for draw in ("automatic", "software")]
            self.assertEqual(len(frames[0]), 3)
            self.assertEqual(frames[0], frames[1])

    def test_methods_are_compared_with_the_rasteriser_s_frames(self):
        report = self.compared(TEAPOTS)
        self.assertEqual(list(report["methods"]), ["direct-raster", "flat", "nailboard", "cache"])
        self.assertEqual(report["machine"]["gl_renderer"], "none")
        self.assertGreater(report["methods"]["nailboard"]["psnr_db"]["min"], 30)
        report = self.compared(TEAPOTS, "--methods", "direct-rays,nailboard", "--drawn-error")
        self.assertGreater(report["methods"]["direct-rays"]["psnr_db"]["min"], 45)
        self.assertEqual(report["methods"]["direct-rays"]["wrong_visibility"]["max"], 0)

    def test_a_file_is_compared_with_its_scene(self):
        for kind, options in BAKED.items():
            file = self.folder / (kind + ".exr")
            self.succeeds("bake", TEAPOTS, "--as", kind, *options, "-o", file, **self.none)
            report = self.compared(file, "--scene", TEAPOTS)
            self.assertEqual(list(report["methods"])[:2], ["direct-raster", kind])
            self.assertGreater(report["methods"][kind]["psnr_db"]["min"], 15)

    def test_benches_run_or_say_that_they_need_opengl(self):
        for draw in "automatic", "software":
            self.succeeds("bench", "nailboard-bits", "--quick", "--draw", draw, **self.none)
        done = self.succeeds("bench", "kinds", "--quick", "--json", "-", **self.none)
        figures = json.loads(done.stdout)["figures"]
        for kind in ("teapots_impostor_surfaces", "teapots_impostor_slices", "teapots_relief",
                     "stonehenge_nodes_merged", "stonehenge_nodes_layering"):
            self.assertGreater(figures[f"{kind}_ms"], 0)
            self.assertNotIn(f"{kind}_opengl_over_software", figures)
        for bench, draw in (("draw", "automatic"), ("nailboard-bits", "opengl")):
            self.refused(("bench", bench, "--quick", "--draw", draw), f"bench {bench}: needs OpenGL",
                         **self.none)


class Software(command.Case):
    """Asked for, or chosen, where OpenGL may be there as well."""

    def drawn_by(self, kept):
        """Who draws by default, as draw_speed.json under `kept` says, or as is measured."""
        done = self.succeeds("render", TEAPOTS, *SMALL, "-o", self.folder / "frames", "--json", "-",
                             env={**os.environ, "XDG_CACHE_HOME": str(kept)})
        return json.loads(done.stdout)["draw"]

    def test_whoever_is_faster_draws(self):
        kept = self.folder / "cache"
        self.drawn_by(kept)
        file = kept / "rilievo" / "draw_speed.json"
        if not file.exists():
            self.skipTest("there is no OpenGL to compare with")
        def write(*kept):
            file.write_text(json.dumps({**whole, "kept": kept}))
        whole = json.loads(file.read_text())
        speed, = whole["kept"]
        for faster, slower in (("opengl", "software"), ("software", "opengl")):
            for part in "triangle_ns", "pixel_ns":
                speed[faster][part], speed[slower][part] = 1, 100
            write(speed)
            self.assertEqual(self.drawn_by(kept), faster)
        # Damaged, another machine's or build's, or of long ago: it is measured again.
        old = {"measured_at": speed["measured_at"] - 40 * 24 * 3600, "agreed": 1}
        for other in None, {"gl_renderer": "another"}, {"program": "another"}, old:
            write({**speed, **other}) if other else file.write_text("{")
            # Beside other work either may be found to be the faster one.
            self.assertIn(self.drawn_by(kept), ("opengl", "software"))
            again = json.loads(file.read_text())["kept"][0]
            self.assertEqual(set(again), set(speed))
            self.assertNotIn("another", (again["gl_renderer"], again["program"]))
            self.assertGreaterEqual(again["measured_at"], speed["measured_at"])
            self.assertNotEqual(again["software"]["triangle_ns"], speed["software"]["triangle_ns"])
        # What another one keeps stays, and ours is used.
        write({**speed, "program": "another", "measured_at": speed["measured_at"] + 9}, speed)
        self.assertEqual(self.drawn_by(kept), "software")
        write({**speed, "program": "another"})
        self.drawn_by(kept)
        self.assertEqual(json.loads(file.read_text())["kept"][1]["program"], "another")

    def test_no_place_to_keep_what_was_measured_is_no_error(self):
        self.assertIn(self.drawn_by("/dev/null"), ("opengl", "software"))

    def test_a_file_looks_the_same_by_both(self):
        file = self.folder / "relief.exr"
        self.succeeds("bake", TEAPOTS, "--as", "layered-relief", *BAKED["layered-relief"], "-o", file)
        psnr = {}
        for draw in "opengl", "software":
            done = self.succeeds("compare", file, "--scene", TEAPOTS, "--draw", draw, *SMALL, "-o",
                                 self.folder / draw, "--json", "-")
            psnr[draw] = json.loads(done.stdout)["methods"]["layered-relief"]["psnr_db"]["mean"]
        # Each against its own true frames, which differ where triangles are smaller than pixels.
        self.assertAlmostEqual(psnr["opengl"], psnr["software"], delta=1)


if __name__ == "__main__":
    command.main()
