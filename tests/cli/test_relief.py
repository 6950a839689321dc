#!/usr/bin/env python3
"""Layered reliefs from the command line: baked of scenes and of deep images, looked into, drawn.

    test_relief.py PATH/TO/rilievo [unittest arguments]
"""

import json
import os
import pathlib
import unittest

import command
from command import files_below

FERN = "builtin:fern?triangles=16000"
AS = ("--as", "layered-relief")
SMALL = (*AS, "--size", "48", "--textures", "2")
DATA = os.environ.get("RILIEVO_DATA")


class Relief(command.Case):
    def test_what_is_baked_says_what_it_is_and_is_drawn(self):
        out = self.folder / "new" / "fern.exr"
        baked = json.loads(self.succeeds("bake", FERN, *SMALL, "-o", out, "--json", "-").stdout)
        self.assertEqual((baked["as"], baked["textures"]), ("layered-relief", 2))
        self.assertEqual(max(baked["sizes"][0]), 48)
        self.assertGreater(baked["samples_a_line"], 1.5)  # a bush hides itself
        self.assertEqual(baked["relief_bytes"], 32 * baked["samples"])
        self.assertEqual(baked["file_bytes"], out.stat().st_size)
        info = json.loads(self.succeeds("info", out, "--json", "-").stdout)
        self.assertEqual(info["representation"], "layered-relief")
        for key in ("samples", "textures", "sizes", "bounds_min", "bounds_max", "merged_m"):
            self.assertEqual(info[key], baked[key], key)
        self.assertIn("on a line of sight", self.succeeds("info", out).stdout)
        frames = self.folder / "frames"
        self.succeeds("render", out, "--size", "96x64", "--frames", "2", "--orbit", "1",
                      "-o", frames)
        self.assertEqual(len(files_below(frames)), 2)
        report = self.folder / "report"
        done = self.succeeds("compare", out, "--scene", FERN, "--size", "96x64", "--frames", "3",
                             "--orbit", "1", "-o", report, "--json", "-")
        methods = json.loads(done.stdout)["methods"]
        self.assertIn("layered-relief", methods)

    def test_the_same_bytes_each_time(self):
        for name in ("a.exr", "b.exr"):
            self.succeeds("bake", FERN, *SMALL, "-o", self.folder / "out" / name)
        made = files_below(self.folder / "out")
        self.assertEqual(made["a.exr"], made["b.exr"])

    def test_a_scene_is_drawn_by_the_method_and_by_the_cache(self):
        report = self.folder / "report"
        done = self.succeeds("compare", "builtin:teapots?triangles=20000", "--methods",
                             "layered-relief,cache", "--bake-as", "layered-relief", "--bake-mb",
                             "64", *command.settings("layered-relief", relief_resolution=0.5, size=64,
                                                     textures=6), "--size", "96x64", "--frames", "2", "-o", report, "--json", "-")
        methods = json.loads(done.stdout)["methods"]
        self.assertEqual(set(methods), {"direct", "layered-relief", "cache"})

    def test_the_cache_chooses_the_same_with_and_without_opengl(self):
        drawn = {}
        for draw in ("opengl", "software"):
            done = self.succeeds("compare", "builtin:fern?triangles=200000", "--methods", "cache",
                                 "--draw", draw, "--bake-as", "layered-relief", "--bake-mb", "64",
                                 *command.settings("layered-relief", size=128), "--error-px", "4", "--size", "192x128",
                                 "--frames", "3", "--orbit", "30", "-o", self.folder / draw,
                                 "--json", "-")
            cache = json.loads(done.stdout)["methods"]["cache"]
            self.assertLessEqual(cache["bound_px"]["max"], 4)
            drawn[draw] = cache["drawn_as"]["layered-relief"]
        self.assertGreater(drawn["software"], 0)
        self.assertEqual(drawn["software"], drawn["opengl"])

    def test_all_that_stands_still_is_baked_as_one(self):
        one = ("--method", "cache", "--bake-together", "--bake-mb", "8", "--bake-as",
               "layered-relief")
        out = ("-o", self.folder / "out")
        self.succeeds("render", command.TEAPOTS, *one,
                      *command.settings("layered-relief", size=64), "--size", "96x64", "--frames", "1",
                      *out)
        self.refused(("render", command.TEAPOTS, *one, *out), "memory")
        self.refused(("render", command.TEAPOTS, *one, "--bake-as", "layered-impostor", *out),
                     "--bake-together")

    def test_bad_input_ends_in_one_line_and_leaves_no_file(self):
        out = ("-o", self.folder / "out.exr")
        for arguments, named in (
                ((FERN, *AS, *out, "--textures", "7"), "--textures"),
                ((FERN, *AS, *out, "--size", "0"), "--size"),
                ((FERN, *AS, *out, "--merge", "-1"), "--merge"),
                ((FERN, *AS, *out, "--views", "12"), "--views"),
                ((FERN, *AS, *out, "--fov", "50"), "--fov"),
                ((FERN, *AS, *out, "--ray-depth"), "--ray-depth"),
                ((FERN, *AS, *out, "--max-depth", "3"), "--max-depth")):
            with self.subTest(arguments):
                self.refused(("bake", *arguments), named)
                self.assertFalse((self.folder / "out.exr").exists())


class Deep(command.Case):
    def test_a_deep_image_is_baked(self):
        deep, again = self.folder / "deep.exr", self.folder / "again.exr"
        self.succeeds("bake", FERN, *AS, "--size", "40", "--textures", "1", "-o", deep)
        self.succeeds("bake", deep, *AS, "--merge", "0", "-o", again)
        a, b = (json.loads(self.succeeds("info", f, "--json", "-").stdout) for f in (deep, again))
        self.assertEqual(a["samples"], b["samples"])
        self.assertEqual(b["moved_m"], 0)
        self.refused(("bake", deep, *AS, "--textures", "2", "-o", again), "--textures")
        self.refused(("bake", deep, "--as", "layered-impostor", "-o", again), "deep.exr")

    def test_damaged_files_end_in_one_line(self):
        deep = self.folder / "deep.exr"
        self.succeeds("bake", FERN, *AS, "--size", "24", "--textures", "2", "-o", deep)
        whole = deep.read_bytes()
        for size in (10, len(whole) // 3, len(whole) // 2):
            cut = self.write("cut.exr", whole[:size])
            for verb in (("info", cut), ("render", cut, "-o", self.folder / "f"),
                         ("bake", cut, *AS, "-o", self.folder / "out.exr")):
                self.refused(verb, "cut.exr")
        # What it was moved by is gone.
        broken = self.write("broken.exr", whole.replace(b"rilievo.picture.merged",
                                                        b"rilievo.picture.merge_"))
        self.refused(("info", broken), "broken.exr", "moved")

    @unittest.skipUnless(DATA, "RILIEVO_DATA is not set")
    def test_images_of_other_renderers_are_baked_with_a_camera_and_refused_without(self):
        deep = pathlib.Path(DATA) / "deep"
        out = self.folder / "out.exr"
        self.succeeds("bake", deep / "arnold_deep.exr", *AS, "-o", out)
        self.succeeds("render", out, "--size", "64x64", "--orbit", "1", "--frames", "1", "-o",
                      self.folder / "arnold")
        balls = deep / "LowResLeftView" / "Balls.exr"
        self.refused(("bake", balls, *AS, "-o", out), "Balls.exr", "worldToCamera", "--fov")
        self.succeeds("bake", balls, *AS, "--fov", "54", "--max-depth", "1000", "-o", out)
        info = json.loads(self.succeeds("info", out, "--json", "-").stdout)
        self.assertEqual(info["moved_m"], 0)
        self.assertGreater(info["samples"], 1000)


if __name__ == "__main__":
    command.main()
