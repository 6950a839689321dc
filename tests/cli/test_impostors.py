#!/usr/bin/env python3
"""Relief impostors from the command line: shaded by whom, of which objects, kept where.

    test_impostors.py PATH/TO/rilievo [unittest arguments]
"""

import base64
import json
import math
import struct
import unittest

import command
from command import SMALL, TEAPOTS, files_below

METHOD = ("--method", "relief-impostor", "--impostor-texels", "96", "--impostor-samples", "1")
SIZE = ("--size", "192x108")
# Around the table by a right angle, in nine frames: ten degrees from one to the next.
KEYS = [{"time": i / 60, "eye": [12 * math.sin(i / 5.7), 5, 12 * math.cos(i / 5.7)],
         "target": [0, 1, 0], "up": [0, 1, 0], "vertical_fov": 0.9} for i in range(9)]


class Impostors(command.Case):
    def setUp(self):
        super().setUp()
        path = {"schema": "rilievo-path-1", "z_near": 0.1, "z_far": 100, "keys": KEYS}
        self.walk = (*SIZE, "--path", self.write("walk.json", json.dumps(path)), "--frames", "9")

    def rendered(self, name, *arguments):
        """The frames, and how many pictures were rendered for them."""
        out = self.folder / name
        done = self.succeeds("render", TEAPOTS, *METHOD, *self.walk, *arguments, "-o", out, "--json", "-")
        return files_below(out), json.loads(done.stdout)["captures"]

    def test_frames_depend_neither_on_the_number_of_workers_nor_on_the_store(self):
        store = self.folder / "store.db"
        objects = ("--objects", "#1,#2")
        one, captures = self.rendered("one", *objects)
        self.assertGreater(captures, 2)  # made again on the way
        three, _ = self.rendered("three", *objects, "--workers", "3")
        self.assertEqual(one, three)
        kept, captures = self.rendered("kept", *objects, "--store", store)
        self.assertEqual(one, kept)
        again, rendered = self.rendered("again", *objects, "--store", store, "--workers", "2")
        self.assertEqual(one, again)
        self.assertGreater(captures, 0)
        self.assertEqual(rendered, 0)

    def test_what_bends_is_shown_by_time(self):
        # A triangle whose third corner rises within a second.
        data = struct.pack("<9f9f2f2f", 0, 0, 0, 1, 0, 0, 0, 1, 0, *[0] * 6, 0, 1, 0, 0, 1, 0, 1)
        gltf = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}]}]}],
            "animations": [{"samplers": [{"input": 2, "output": 3}], "channels": [
                {"sampler": 0, "target": {"node": 0, "path": "weights"}}]}],
            "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," +
                         base64.b64encode(data).decode()}],
            "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
            "accessors": [{"bufferView": 0, "byteOffset": offset, "componentType": 5126, "count": count,
                           "type": type} for offset, count, type in
                          ((0, 3, "VEC3"), (36, 3, "VEC3"), (72, 2, "SCALAR"), (80, 2, "SCALAR"))]}
        scene = self.write("rises.gltf", json.dumps(gltf))
        eye = {"eye": [0.5, 1, 5], "target": [0.5, 1, 0], "up": [0, 1, 0], "vertical_fov": 0.6}
        path = {"schema": "rilievo-path-1", "z_near": 0.1, "z_far": 100,
                "keys": [{"time": i / 10, **eye} for i in range(10)]}
        walk = (*SIZE, "--path", self.write("stands.json", json.dumps(path)), "--frames", "10")

        def frames(name, *arguments):
            self.succeeds("render", scene, *walk, *arguments, "-o", self.folder / name)
            return list(files_below(self.folder / name).values())

        still = frames("still", "--method", "direct", "--time", "0")
        self.assertEqual(len(set(still)), 1)
        direct = frames("direct", "--method", "direct")
        self.assertEqual(len(set(direct)), len(direct))
        bends = frames("bends", *METHOD, "--draw", "opengl")
        self.assertEqual(len(set(bends)), len(bends))
        for method in METHOD, ("--method", "direct-raster"):
            drawn = frames("software " + method[1], *method, "--draw", "software")
            self.assertEqual(len(set(drawn)), len(drawn))
        later = frames("later", "--method", "direct", "--time", "0.9")
        self.assertEqual(len(set(later)), 1)
        self.assertNotEqual(still[0], later[0])
        self.refused(["render", scene, "--time", "-1", "-o", self.folder / "bad"], "--time")
        # What bends is held against frames in which it bends, too.
        path["keys"] = [{"time": 0.7 + i / 60, **eye} for i in range(6)]
        late = (*SIZE, "--path", self.write("late.json", json.dumps(path)), "--frames", "6")
        for draw in "opengl", "software":
            report = self.folder / ("report by " + draw)
            methods = "direct-raster,relief-impostor"
            self.succeeds("compare", scene, "--methods", methods, *METHOD[2:], *late, "--draw", draw,
                          "-o", report)
            found = json.loads((report / "report.json").read_text())["methods"]
            self.assertEqual(set(found), set(methods.split(",")))
            # The triangle has grown by two thirds: what stood still would have 29 dB, what bends has 42.
            self.assertGreater(found["relief-impostor"]["psnr_db"]["min"], 38)
        self.refused(["compare", scene, "--methods", "direct-raster,nailboard", *late, "-o", self.folder / "bad"],
                     "--time")
        self.refused(["compare", scene, "--methods", "relief-impostor", *walk, "--drawn-error", "-o",
                      self.folder / "bad"], "--drawn-error")

    def test_a_field_and_a_comparison(self):
        field, captures = self.rendered("field", "--shader", "sdf:torus", "--objects", "#1")
        self.assertGreater(captures, 0)
        polygons, _ = self.rendered("polygons", "--objects", "#1")
        self.assertNotEqual(field, polygons)
        report = self.folder / "report"
        done = self.succeeds("compare", TEAPOTS, "--methods", "relief-impostor", *METHOD[2:], *self.walk,
                             "--objects", "#1", "-o", report, "--json", "-")
        self.assertIn("relief-impostor", json.loads(done.stdout)["methods"])

    def test_a_program_is_asked_and_one_that_dies_leaves_polygons_and_one_warning(self):
        started = self.folder / "started"
        program = self.write("dies.sh", f"#!/bin/sh\necho x >> {started}\nread line\n"
                             "echo '{\"id\":1,\"bounds\":[[-3,0,-3],[3,2,3]]}'\nread line\nexit 1\n")
        program.chmod(0o755)
        out = self.folder / "frames"
        done = self.succeeds("render", TEAPOTS, *METHOD, *self.walk, "--shader", f"exec:{program}",
                             "--objects", "#1", "-o", out)
        self.assertEqual(len(files_below(out)), 9)
        self.assertTrue(started.exists())
        self.assertLessEqual(len(done.stderr.strip().splitlines()), 2, done.stderr)
        self.assertIn("dies.sh", done.stderr)

    def test_bad_input_ends_in_one_line_and_leaves_no_file(self):
        out = self.folder / "out"
        other = self.write("other.db", "not a store of pictures at all, but a text" * 40)
        nowhere = other / "store.db"
        for arguments, named in (
                (("--objects", "spout"), "spout"),
                (("--shader", "raymarch"), "raymarch"),
                (("--shader", "sdf:sphere"), "sphere"),
                (("--shader", "exec:"), "--shader"),
                (("--shader", "exec:/no/such/program"), "program"),
                (("--workers", "0"), "--workers"),
                (("--impostor-texels", "2000"), "--impostor-texels"),
                (("--store", nowhere), "other.db"),
                (("--store", other), "other.db")):
            with self.subTest(arguments):
                self.refused(("render", TEAPOTS, *METHOD[:2], *self.walk, *arguments, "-o", out), named)
                self.assertFalse(out.exists() and files_below(out))
        self.assertEqual(other.read_bytes()[:10], b"not a stor")

    def test_a_map_of_valid_eyes(self):
        pictures, image = self.folder / "pictures", self.folder / "maps" / "map.png"
        self.succeeds("render", TEAPOTS, "--method", "nailboard", *SMALL, "--save-pictures", pictures,
                      "-o", self.folder / "frames")
        first = pictures / "pictures_00000.exr"
        done = self.succeeds("info", first, "--valid-eyes", image)
        self.assertRegex(done.stdout, r"map\.png: [1-9][0-9]* % of the eyes")
        self.assertEqual(image.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.refused(("info", TEAPOTS, "--valid-eyes", image), TEAPOTS)

if __name__ == "__main__":
    command.main()
