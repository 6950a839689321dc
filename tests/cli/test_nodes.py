#!/usr/bin/env python3
"""Environment nodes from the command line: baked, looked into, drawn, exported.

    test_nodes.py PATH/TO/rilievo [unittest arguments]
"""

import json
import shutil
import struct
import subprocess
import unittest

import command
from command import files_below

STONES = "builtin:stonehenge?triangles=10000"
SMALL_BAKE = ("--as", "environment-nodes", "--face", "24")
SMALL_METHOD = command.settings("environment-nodes", face=32, auto=2)
AT = ("--at", "0,1.7,8", "-3,1.7,8")
FRAME = ("--size", "64x48", "--frames", "2")


class Nodes(command.Case):
    def bake(self, *arguments, name="n.exr", scene=STONES):
        out = self.folder / name
        done = self.succeeds("bake", scene, *SMALL_BAKE, *arguments, "-o", out, "--json", "-")
        return out, json.loads(done.stdout)

    def test_a_bake_says_where_its_nodes_are_and_what_they_hold(self):
        out, figures = self.bake(*AT)
        self.assertEqual((figures["nodes"], figures["face"]), (2, 24))
        self.assertEqual(figures["node_eyes"], [[0, 1.7, 8], [-3, 1.7, 8]])
        self.assertTrue(0.1 < figures["visible_share_held"] < 1, figures["visible_share_held"])
        self.assertEqual(figures["file_bytes"], out.stat().st_size)
        info = json.loads(self.succeeds("info", out, "--json", "-").stdout)
        self.assertEqual(info["representation"], "environment-nodes")
        self.assertEqual(info["node_eyes"], figures["node_eyes"])
        text = self.succeeds("info", out).stdout
        self.assertIn("2 of 6 x 24 x 24", text)

    def test_more_nodes_placed_by_worth_hold_more(self):
        held = [self.bake("--auto", n, "--region", "-8,1.4,-8,8,1.9,8")[1]["visible_share_held"]
                for n in ("1", "4")]
        self.assertGreater(held[1], held[0])

    def test_the_same_bytes_each_time(self):
        for name in ("a.exr", "b.exr"):
            self.bake("--auto", "2", name=name)
        made = files_below(self.folder)
        self.assertEqual(made["a.exr"], made["b.exr"])

    def test_every_merge_is_drawn_and_frames_repeat(self):
        out, _ = self.bake("--at", "0,1.7,8", "-3,1.7,8", "-1,1.7,6", "--triangles", "800")
        pictures = {}
        for setting in ("merge=layering", "merge=binary", "merge=weighted", "merge=positional",
                        "merge=first", "gaps", "skin", "resident=1", ""):
            arguments = ("--set", "environment-nodes." + setting) if setting else ()
            for attempt in range(1 if setting else 2):
                folder = self.folder / f"frames{attempt}{setting}"
                self.succeeds("render", out, *arguments, *FRAME, "-o", folder)
                pictures[setting, attempt] = files_below(folder)
                self.assertEqual(len(pictures[setting, attempt]), 2)
        self.assertEqual(pictures["", 0], pictures["", 1])
        self.assertEqual(pictures["", 0], pictures["skin", 0])  # the defaults
        self.assertEqual(pictures["", 0], pictures["merge=positional", 0])

    def test_compared_with_its_scene_and_as_a_method(self):
        out, _ = self.bake(*AT)
        report = self.folder / "report"
        self.succeeds("compare", out, "--scene", STONES, *FRAME, "-o", report)
        for name, methods in (("r", ["direct", "environment-nodes"]),):
            done = self.succeeds("compare", STONES, "--methods", "environment-nodes", *SMALL_METHOD,
                                 *FRAME, "-o", self.folder / name, "--json", "-")
            self.assertEqual(list(json.loads(done.stdout)["methods"]), methods)

    def test_a_scene_is_baked_and_drawn_without_opengl(self):
        self.succeeds("render", STONES, "--method", "environment-nodes", *SMALL_METHOD, "--draw", "software", *FRAME, "-o", self.folder / "frames")
        self.assertEqual(len(files_below(self.folder / "frames")), 2)
        self.succeeds("render", STONES, "--method", "cache", "--bake-as", "environment-nodes",
                      "--bake-mb", "64", *SMALL_METHOD, "--draw", "software", *FRAME, "-o",
                      self.folder / "cached")
        self.assertEqual(len(files_below(self.folder / "cached")), 2)

    def test_nodes_stand_for_what_is_far_in_the_cache(self):
        def cache(*arguments):
            done = self.succeeds("compare", "builtin:stonehenge", "--methods", "cache", *arguments,
                                 "--frames", "3", "--size", "96x64", "-o", self.folder / "report",
                                 "--json", "-")
            return json.loads(done.stdout)["methods"]["cache"]

        nodes = ("--bake-mb", "8", "--bake-as", "environment-nodes")
        self.assertNotIn("environment-nodes", cache()["drawn_as"])
        # Whether they are drawn is a matter of cost; pictures are cheaper where there are few.
        drawn = cache(*nodes, "--bake-beyond", "8",
                      *command.settings("environment-nodes", face=64, auto=2))
        self.assertIn("environment-nodes", drawn["drawn_as"])
        self.assertLess(drawn["wrong_visibility"]["mean"], 0.01)
        for wrong, named in ((("--bake-beyond", "1e6"), "environment-nodes"),
                             (("--bake-beyond", "nan"), "--bake-beyond")):
            self.refused(["compare", "builtin:stonehenge", "--methods", "cache", *nodes, *wrong,
                          "-o", self.folder / "none"], named)

    def test_bad_input_ends_in_one_line_and_leaves_no_file(self):
        out = ("-o", self.folder / "out.exr")
        for arguments, named in (
                (("--at", "0,1.7"), "--at"), (("--at", "0,1,2", "x"), "--at"),
                (("--at", "0,1,2", "--auto", "2"), "--at"),
                (("--auto", "-1"), "--auto"), (("--region", "0,0,0,0,1,1"), "--region"),
                (("--triangles", "-1"), "--triangles"), (("--error-px", "0"), "--error-px"),
                (("--views", "12"), "--views"), (("--face", "100000"), "--face")):
            with self.subTest(arguments):
                self.refused(["bake", STONES, *SMALL_BAKE, *arguments, *out], named)
                self.assertEqual(files_below(self.folder), {})

    def test_options_that_do_not_go_together_are_refused(self):
        out, _ = self.bake(*AT)
        self.refused(["render", out, "--set", "environment-nodes.skin", "--set", "environment-nodes.gaps",
                      *FRAME, "-o", self.folder / "f"], "--gaps")
        self.refused(["render", out, "--set", "environment-nodes.merge=glue", *FRAME, "-o", self.folder / "f"],
                     "environment-nodes.merge", "glue")
        self.refused(["render", out, "--method", "layered-impostor", *FRAME,
                      "-o", self.folder / "f"], "--method")

    def test_a_damaged_face_is_found_by_every_command(self):
        out, _ = self.bake(*AT)
        whole = out.read_bytes()
        damaged = self.folder / "damaged.exr"
        # Scan lines lie in the file's second half; a hit may leave a face readable.
        refused = 0
        for at in range(len(whole) // 2, len(whole) - 64, max(1, len(whole) // 12)):
            damaged.write_bytes(whole[:at] + bytes(64) + whole[at + 64:])
            done = command.run("info", damaged)
            self.assertIn(done.returncode, (0, 2), done.stderr)
            if done.returncode == 0:
                continue
            refused += 1
            self.refused(["info", damaged], "damaged.exr")
            self.refused(["render", damaged, *FRAME, "-o", self.folder / "f"], "damaged.exr")
            self.refused(["export", damaged, "-o", self.folder / "f.glb"], "damaged.exr")
        self.assertGreater(refused, 2)
        damaged.write_bytes(whole[:len(whole) * 3 // 4])
        self.refused(["info", damaged], "damaged.exr")

    def test_attributes_that_make_no_nodes_are_refused(self):
        out, _ = self.bake(*AT)
        whole = out.read_bytes()
        at = whole.index(b"0 0.5 0")  # the mesh: triangles, error, reach
        broken = self.folder / "broken.exr"
        for text in (b"0 0 0.0", b"x 0.5 0", b"0 -.5 0", b"0 0.5 1"):
            broken.write_bytes(whole[:at] + text + whole[at + 7:])
            done = command.run("info", broken)
            if text == b"0 0.5 1":
                self.assertEqual(done.returncode, 0, done.stderr)
            else:
                self.refused(["info", broken], "broken.exr", "triangulate")


class Export(command.Case):
    def setUp(self):
        super().setUp()
        self.exr = self.folder / "n.exr"
        self.succeeds("bake", STONES, *SMALL_BAKE, *AT, "-o", self.exr)

    def chunks(self, path):
        data = path.read_bytes()
        magic, version, length = struct.unpack_from("<4sII", data)
        self.assertEqual((magic, version, length), (b"glTF", 2, len(data)))
        size, = struct.unpack_from("<I", data, 12)
        return json.loads(data[20:20 + size])

    def test_a_node_is_a_textured_mesh_that_we_read_again(self):
        out = self.folder / "new" / "n.glb"
        self.succeeds("export", self.exr, "-o", out)
        gltf = self.chunks(out)
        self.assertEqual(len(gltf["images"]), 6)
        self.assertEqual(len(gltf["materials"]), 6)
        info = json.loads(self.succeeds("info", out, "--json", "-").stdout)
        self.assertGreater(info["triangles"], 100)
        open_ = self.folder / "gaps.glb"
        self.succeeds("export", self.exr, "--gaps", "--node", "1", "-o", open_)
        self.assertLess(json.loads(self.succeeds("info", open_, "--json", "-").stdout)["triangles"],
                        info["triangles"])

    @unittest.skipUnless(shutil.which("assimp"), "assimp is not installed")
    def test_assimp_opens_it(self):
        out = self.folder / "n.glb"
        self.succeeds("export", self.exr, "-o", out)
        triangles = json.loads(self.succeeds("info", out, "--json", "-").stdout)["triangles"]
        done = subprocess.run(["assimp", "info", out, "--silent"], capture_output=True, text=True,
                              timeout=command.TIMEOUT_S)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        counts = {}
        for line in done.stdout.splitlines():
            name, colon, value = line.partition(":")
            if colon and value.strip().isdigit():
                counts[name.strip()] = int(value)
        self.assertEqual(counts["Faces"], triangles)
        self.assertEqual(counts["Materials"], 6)
        self.assertEqual(counts["Textures (embed.)"], 6)

    def test_what_cannot_be_exported_is_refused(self):
        out = self.folder / "o.glb"
        self.refused(["export", self.exr, "-o", self.folder / "o.obj"], ".glb")
        self.refused(["export", self.exr, "--node", "2", "-o", out], "--node")
        self.refused(["export", self.folder / "gone.exr", "-o", out], "gone.exr")
        layered = self.folder / "l.exr"
        self.succeeds("bake", "builtin:teapot?triangles=500", "--ring", "3", "--size", "16",
                      "--layers", "4", "-o", layered)
        self.refused(["export", layered, "-o", out], "l.exr", "layered-impostor")
        self.assertFalse(out.exists())


if __name__ == "__main__":
    command.main()
