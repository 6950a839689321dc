#!/usr/bin/env python3
"""Scenes far from 0, and scenes that count in other units or have another axis up.

    test_far.py PATH/TO/rilievo [unittest arguments]
"""

import json
import math
import struct

import command
from command import files_below

FAR = (4.7e5, 412.0, -5.4e6)
# As small as they come.
SCENES = ("bridge?triangles=100000", "forest?triangles=100000", "teapots?triangles=20000",
          "stonehenge?triangles=20000", "teapot", "fern", "fish", "cube")
KINDS = ("layered-impostor", "environment-nodes", "layered-relief")
SMALL_BAKES = {"layered-impostor": ("--ring", "4", "--size", "48"),
               "environment-nodes": ("--face", "48"),
               "layered-relief": ("--size", "48")}
METHODS = ("flat", "nailboard", "cache", "keyframes", "auto", "lod", "direct-raster", "direct-rays")


def edit_glb(data, edit):
    """The file with its JSON changed by `edit`."""
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + length])
    edit(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length:]
    return (data[:8] + struct.pack("<II", 20 + len(text) + len(rest), len(text)) + b"JSON" + text +
            rest)


def move_all(document):
    """Hangs everything below a node at FAR."""
    scene = document["scenes"][document.get("scene", 0)]
    document["nodes"].append({"translation": list(FAR), "children": scene["nodes"]})
    scene["nodes"] = [len(document["nodes"]) - 1]


class Far(command.Case):
    def near_and_far(self, name):
        """The scene and its path twice: as it is, and moved as a whole."""
        near, path = self.folder / "near.glb", self.folder / "near.json"
        self.succeeds("scene", name, "-o", near, "--save-path", path)
        far = self.write("far.glb", edit_glb(near.read_bytes(), move_all))
        moved = json.loads(path.read_text())
        for key in moved["keys"]:
            key["eye"] = [a + b for a, b in zip(key["eye"], FAR)]
        return (near, path), (far, self.write("far.json", json.dumps(moved)))

    def frames(self, what, path, *options):
        out = self.folder / "frames"
        self.succeeds("render", what, "--path", path, "--frames", "2", "--size", "64x48", *options,
                      "-o", out)
        return files_below(out)

    def expect_same(self, name, backend, methods):
        """Frames that are the same files: what hangs below a far root keeps its own numbers."""
        near, far = self.near_and_far(name)
        for method in methods:
            with self.subTest(scene=name, method=method, backend=backend):
                options = ("--method", method, "--draw", backend)
                self.assertEqual(self.frames(*near, *options), self.frames(*far, *options))

    def test_software_draws_the_same_frames_by_every_method(self):
        for name in SCENES:
            self.expect_same(name, "software", METHODS)

    def test_opengl_draws_the_same_frames_by_every_method(self):
        for name in SCENES:
            self.expect_same(name, "opengl", ("direct", "nailboard", "cache", "keyframes"))

    def test_every_bake_draws_the_same_frames(self):
        for name in SCENES:
            near, far = self.near_and_far(name)
            for kind in KINDS:
                drawn = []
                for scene, path in (near, far):
                    baked = self.folder / "baked.exr"
                    eye = json.loads(path.read_text())["keys"][0]["eye"]
                    at = ("--at", ",".join(map(str, eye))) if kind == "environment-nodes" else ()
                    self.succeeds("bake", scene, "--as", kind, *SMALL_BAKES[kind], *at, "-o", baked)
                    drawn.append([self.frames(baked, path, "--draw", backend)
                                  for backend in ("software", "opengl")])
                with self.subTest(scene=name, kind=kind):
                    self.assertEqual(drawn[0], drawn[1])

    def test_info_and_exports_give_the_place_back(self):
        (near, _), (far, _) = self.near_and_far("teapots?triangles=20000")
        facts = [json.loads(self.succeeds("info", file, "--json", "-").stdout)
                 for file in (near, far)]
        for corner in ("bounds_min", "bounds_max"):
            for a, b, by in zip(facts[0][corner], facts[1][corner], FAR):
                self.assertAlmostEqual(a + by, b, delta=1e-3)
        self.assertEqual(facts[1]["origin"], list(FAR))
        text = self.succeeds("info", far).stdout
        for number in facts[1]["bounds_min"]:
            # To a millimetre, without zeros at the end.
            self.assertIn(f"{number:.3f}".rstrip("0").rstrip(".")[:-1], text)
        again = self.folder / "again.glb"
        self.succeeds("scene", far, "-o", again)
        self.assertEqual(json.loads(self.succeeds("info", again, "--json", "-").stdout)["bounds_max"],
                         facts[1]["bounds_max"])
        # A node, baked and exported, and the bake's own words.
        baked, node = self.folder / "walk.exr", self.folder / "node.glb"
        at = ",".join(str(a + b) for a, b in zip(FAR, (0.5, 1.0, 6.0)))
        self.succeeds("bake", far, "--as", "environment-nodes", "--at", at, "--face", "32", "-o",
                      baked)
        said = json.loads(self.succeeds("info", baked, "--json", "-").stdout)
        for a, b in zip(said["node_eyes"][0], at.split(",")):
            self.assertAlmostEqual(a, float(b), delta=1e-3)
        self.succeeds("export", baked, "--node", "0", "-o", node)
        box = json.loads(self.succeeds("info", node, "--json", "-").stdout)
        for low, high, by in zip(box["bounds_min"], box["bounds_max"], FAR):
            self.assertLess(low - 100, by)
            self.assertGreater(high + 100, by)

    def test_a_bake_is_compared_with_its_scene(self):
        near, far = self.near_and_far("teapots?triangles=20000")
        psnr = []
        for scene, path in (near, far):
            baked = self.folder / "baked.exr"
            self.succeeds("bake", scene, *SMALL_BAKES["layered-impostor"], "-o", baked)
            done = self.succeeds("compare", baked, "--scene", scene, "--path", path, "--frames", "2",
                                 "--draw", "opengl", "--size", "64x48", "-o",
                                 self.folder / "report", "--json", "-")
            psnr.append(json.loads(done.stdout)["methods"]["layered-impostor"]["psnr_db"])
        self.assertEqual(psnr[0], psnr[1])

    def test_a_broken_place_of_a_bake_is_named(self):
        near, far = self.near_and_far("cube")
        baked = self.folder / "baked.exr"
        self.succeeds("bake", far[0], *SMALL_BAKES["layered-impostor"], "-o", baked)
        data = baked.read_bytes()
        self.assertIn(b"470000 412 -5400000 up y unit 1", data)
        for bad in (b"470000 nan -5400000 up y unit 1", b"470000 412 -5400000 up q unit 1",
                    b"470000 412 -5400000 up y unit 0", b"470000 412 -5400000 up y unit m"):
            broken = self.write("broken.exr", data.replace(b"470000 412 -5400000 up y unit 1", bad))
            self.refused(("render", broken, "-o", self.folder / "out"), broken,
                         "does not say where its scene lies")


class Units(command.Case):
    def bounds(self, *arguments):
        facts = json.loads(self.succeeds("info", *arguments, "--json", "-").stdout)
        return facts["bounds_min"] + facts["bounds_max"]

    def test_axes_and_units(self):
        file = self.write("box.obj", "v 0 0 0\nv 2 0 0\nv 0 4 0\nv 0 0 8\nf 1 2 3\nf 1 3 4\n")
        self.assertEqual(self.bounds(file), [0, 0, 0, 2, 4, 8])
        self.assertEqual(self.bounds(file, "--up", "z"), [0, 0, -4, 2, 8, 0])
        self.assertEqual(self.bounds(file, "--up", "x"), [-4, 0, 0, 0, 2, 8])
        for unit, metres in (("m", 1), ("cm", 0.01), ("mm", 0.001), ("ft", 0.3048), ("in", 0.0254)):
            for a, b in zip(self.bounds(file, "--units", unit), [0, 0, 0, 2, 4, 8]):
                self.assertTrue(math.isclose(a, b * metres, rel_tol=1e-6), unit)

    def test_info_says_what_was_assumed(self):
        file = self.write("box.obj", "v 0 0 0\nv 2 0 0\nv 0 4 0\nf 1 2 3\n")
        self.assertIn("y up, metres (assumed", self.succeeds("info", file).stdout)
        self.assertIn("z up, units of 0.001 m",
                      self.succeeds("info", file, "--up", "z", "--units", "mm").stdout)

    def test_bakes_keep_them(self):
        file = self.write("box.obj", "v 0 0 0\nv 2 0 0\nv 0 4 0\nv 0 0 8\nf 1 2 3\nf 1 3 4\n")
        baked = self.folder / "baked.exr"
        self.succeeds("bake", file, "--up", "z", "--units", "cm", *SMALL_BAKES["layered-impostor"],
                      "-o", baked)
        said = json.loads(self.succeeds("info", baked, "--json", "-").stdout)
        self.assertEqual((said["up"], said["metres_per_unit"]), ("z", 0.01))
        # And its scene is taken alike.
        done = self.succeeds("compare", baked, "--scene", file, "--frames", "2", "--size", "64x48",
                             "-o", self.folder / "report", "--json", "-")
        report = json.loads(done.stdout)["methods"]["layered-impostor"]
        self.assertGreater(report["psnr_db"]["mean"], 20)

    def test_what_is_no_scene_s_file_has_none(self):
        self.refused(("info", "builtin:cube", "--units", "mm"), "--units", "builtin:cube")
        self.refused(("info", self.folder / "x.obj", "--units", "furlong"), "--units")


if __name__ == "__main__":
    command.main()
