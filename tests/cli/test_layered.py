#!/usr/bin/env python3
"""Layered impostors from the command line: baked, looked into, drawn.

    test_layered.py PATH/TO/rilievo [unittest arguments]
"""

import json

import command
from command import files_below

TEAPOT = "builtin:teapot?triangles=4000"
SMALL_BAKE = ("--views", "12", "--size", "48", "--layers", "24")


class Bake(command.Case):
    def test_figures_say_what_was_made_and_how_long_it_took(self):
        out = self.folder / "new" / "teapot.exr"
        done = self.succeeds("bake", TEAPOT, "--as", "layered-impostor", *SMALL_BAKE, "-o", out,
                             "--json", "-")
        self.assertEqual(done.stderr, "")  # no progress in a pipe
        figures = json.loads(done.stdout)
        self.assertEqual(figures["schema"], "rilievo-bake-1")
        self.assertEqual((figures["views"], figures["size"], figures["layers"]), (12, 48, 24))
        self.assertEqual(figures["paper_bytes"], 12 * 48 * 48 * 4)
        self.assertEqual(figures["file_bytes"], out.stat().st_size)
        # A teapot fills between a tenth and all of the rectangle around it.
        self.assertTrue(0.1 < figures["coverage"] < 1, figures["coverage"])
        parts = figures["seconds"]
        self.assertAlmostEqual(parts["total"], parts["capture"] + parts["slice"] + parts["save"])
        self.assertAlmostEqual(figures["ms_per_view"], 1e3 * parts["total"] / 12)
        for size in ("48x48", "1280x720"):
            self.assertGreater(figures["direct_ms"][size], 0)
            self.assertAlmostEqual(figures["direct_frames_per_view"][size],
                                   figures["ms_per_view"] / figures["direct_ms"][size])

    def test_views_are_those_asked_for(self):
        for arguments, views in ((("--views", "20"), 20), (("--ring", "5"), 5),
                                 (("--views", "12", "--hemisphere"), None)):
            with self.subTest(arguments):
                done = self.succeeds("bake", TEAPOT, *arguments, "--size", "16", "--layers", "4",
                                     "-o", self.folder / "t.exr", "--json", "-")
                found = json.loads(done.stdout)["views"]
                if views:
                    self.assertEqual(found, views)
                else:
                    self.assertTrue(6 <= found < 12, found)

    def test_the_same_bytes_each_time(self):
        for name in ("a.exr", "b.exr"):
            self.succeeds("bake", TEAPOT, *SMALL_BAKE, "-o", self.folder / "out" / name)
        made = files_below(self.folder / "out")
        self.assertEqual(made["a.exr"], made["b.exr"])

    def test_bad_input_ends_in_one_line_and_leaves_no_file(self):
        out = ("-o", self.folder / "out.exr")
        for arguments, named in (
                ((TEAPOT,), "--output"), ((TEAPOT, "-o", self.folder / "out.png"), ".exr"),
                (("builtin:atlantis", *out), "atlantis"),
                ((self.folder / "gone.glb", *out), "gone.glb"),
                ((self.folder / "gone.exr", *out), "gone.exr"),
                ((TEAPOT, *out, "--as", "statue"), "statue"),
                ((TEAPOT, *out, "--views", "13"), "--views"),
                ((TEAPOT, *out, "--ring", "2"), "--ring"),
                ((TEAPOT, *out, "--ring", "8", "--views", "12"), "--views"),
                ((TEAPOT, *out, "--ring", "8", "--hemisphere"), "--hemisphere"),
                ((TEAPOT, *out, "--size", "0"), "--size"),
                ((TEAPOT, *out, "--size", "100000"), "--size"),
                ((TEAPOT, *out, "--layers", "0"), "--layers"),
                ((TEAPOT, *out, "--overlap", "-1"), "--overlap"),
                ((TEAPOT, *out, "--overlap", "nan"), "--overlap"),
                ((TEAPOT, *out, "--layers", "4", "--overlap", "5"), "--overlap")):
            with self.subTest(arguments):
                self.refused(["bake", *arguments], named)
                self.assertEqual(files_below(self.folder), {})


if __name__ == "__main__":
    command.main()
