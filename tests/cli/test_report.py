#!/usr/bin/env python3
"""What `rilievo compare` leaves behind: the figures as promised, and a page that stands alone.

    test_report.py PATH/TO/rilievo [unittest arguments]
"""

import json
import pathlib
import re
import shutil
import tempfile

import command
from command import TEAPOTS, SMALL


class Report(command.Case):
    # As report.json has been promised: later versions add keys, they rename none.
    FIGURES = {"frame_ms": {"p50", "p99", "max"}, "psnr_db": {"mean", "min"},
               "ssim": {"mean", "min"}, "flip": {"mean", "max"},
               "wrong_visibility": {"mean", "max"}, "depth_error": {"p50", "p99"},
               "uncovered": {"mean", "max"}}

    @classmethod
    def setUpClass(cls):
        cls.out = pathlib.Path(tempfile.mkdtemp(prefix="rilievo-cli-"))
        cls.done = command.run("compare", TEAPOTS, *SMALL, "--methods", "direct,flat,nailboard", "-o", cls.out)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.out)

    def setUp(self):
        super().setUp()
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        self.report = json.loads((self.out / "report.json").read_text())

    def test_the_json_has_every_promised_key(self):
        report = self.report
        self.assertEqual(report["schema"], "rilievo-report-1")
        self.assertLessEqual({"commit", "machine", "scene", "size", "frames", "methods"},
                             report.keys())
        self.assertLessEqual({"cpu", "threads", "gl_renderer"}, report["machine"].keys())
        self.assertLessEqual({"name", "triangles", "objects"}, report["scene"].keys())
        self.assertEqual(report["size"], [96, 64])
        self.assertEqual(report["frames"], 3)
        self.assertLessEqual({"direct", "flat", "nailboard"}, report["methods"].keys())
        for figures in report["methods"].values():
            for name, keys in self.FIGURES.items():
                self.assertLessEqual(keys, figures[name].keys())
            self.assertLessEqual({"captures", "capture_ms", "picture_bytes"}, figures.keys())

    def test_direct_drawing_is_the_truth(self):
        direct = self.report["methods"]["direct"]
        self.assertEqual(direct["wrong_visibility"]["max"], 0)
        self.assertEqual(direct["uncovered"]["max"], 0)
        self.assertEqual(direct["flip"]["max"], 0)
        self.assertEqual(direct["ssim"]["min"], 1)
        self.assertEqual(direct["captures"], 0)

    def test_pictures_are_captured_and_counted(self):
        for method in ("flat", "nailboard"):
            figures = self.report["methods"][method]
            self.assertGreater(figures["captures"], 0)
            self.assertGreater(figures["picture_bytes"], 0)
            self.assertGreater(figures["psnr_db"]["min"], 15)

    def test_the_page_needs_nothing_else(self):
        page = (self.out / "report.html").read_text(encoding="utf-8")
        self.assertIn("data:image/", page)
        # Links to follow are fine; things to load are not.
        for tag in re.findall(r"<(?:script|link|img|iframe|source)\b[^>]*>", page):
            self.assertNotRegex(tag, r"(src|href)\s*=\s*[\"']?(?!data:|#)")
        self.assertNotRegex(page, r"@import|url\(\s*[\"']?https?:|fetch\(")

    def test_the_error_that_is_drawn_takes_a_second_walk(self):
        for figures in self.report["methods"].values():
            self.assertNotIn("error_px", figures)
        out = self.out / "drawn"
        done = command.run("compare", TEAPOTS, *SMALL, "--methods", "nailboard,lod", "--drawn-error",
                           "-o", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        methods = json.loads((out / "report.json").read_text())["methods"]
        # Its polygons show their own positions.
        self.assertNotIn("error_px", methods["lod"])
        for name in ("direct", "nailboard"):
            error = methods[name]["error_px"]
            self.assertLessEqual(error["p50"], error["p99"])
            self.assertLessEqual(error["p99"], error["max"])
            shares = sum(error[key] for key in ("measured_share", "boundary_share", "mixed_share",
                                                "unresolved_share"))
            self.assertAlmostEqual(shares, 1)
            self.assertGreater(error["measured_share"], 0)
        direct = methods["direct"]["error_px"]
        self.assertLess(direct["max"], direct["resolution"])
        self.assertLess(direct["max"], methods["nailboard"]["error_px"]["max"])

    def test_frames_of_another_program_are_measured(self):
        plan = (*SMALL, "--draw", "software", "--samples", "1")
        self.succeeds("render", TEAPOTS, *plan, "--method", "nailboard", "-o", self.folder / "theirs")
        done = ("compare", TEAPOTS, *plan, "--methods", "nailboard", "-o", self.folder / "report", "--frames-of")
        self.succeeds(*done, f"them={self.folder}/theirs")
        methods = json.loads((self.folder / "report/report.json").read_text())["methods"]
        self.assertEqual(list(methods), ["direct-raster", "nailboard", "them"])
        for figure in ("psnr_db", "ssim", "flip"):
            self.assertEqual(methods["them"][figure], methods["nailboard"][figure])
        self.refused((*done, "theirs"), "--frames-of", "NAME=FOLDER")
        self.refused((*done, f"them={self.folder}/nowhere"), "frame_00000.png")

    def test_the_error_that_is_drawn_is_of_scenes_and_frames(self):
        done = command.run("compare", TEAPOTS, *SMALL, "--drawn-error", "--real-time", "-o", self.out)
        self.assertEqual(done.returncode, 2)


if __name__ == "__main__":
    command.main()
