#!/usr/bin/env python3
"""Layered impostors from the command line: baked, looked into, drawn.

    test_layered.py PATH/TO/rilievo [unittest arguments]
"""

import base64
import json
import math
import struct
import zlib

import command
from command import TEAPOTS, files_below

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


class Baked(command.Case):
    """What is done with a file, without the scene."""

    def setUp(self):
        super().setUp()
        self.file = self.folder / "teapot.exr"
        self.succeeds("bake", TEAPOT, *SMALL_BAKE, "-o", self.file)

    def test_info_says_what_is_in_it(self):
        info = json.loads(self.succeeds("info", self.file, "--json", "-").stdout)
        self.assertEqual(info["schema"], "rilievo-info-1")
        self.assertEqual(info["representation"], "layered-impostor")
        self.assertEqual((info["views"], info["size"], info["layers"]), (12, [48, 48], 24))
        self.assertEqual(info["file_bytes"], self.file.stat().st_size)
        self.assertEqual(info["paper_bytes"], 12 * 48 * 48 * 4)
        self.assertGreater(info["texture_bytes"]["surfaces"], info["texture_bytes"]["slices"])
        self.assertEqual(info["slices"] + info["empty_slices"], 12 * 24)
        self.assertAlmostEqual(info["fill_share"] + info["fill_saved"], 1)
        self.assertTrue(info["holes_looked_for"])
        self.assertIn("12 back-perspective pictures", self.succeeds("info", self.file).stdout)

    def test_it_is_drawn_from_new_eyes_by_either_warp(self):
        made = {}
        for name, arguments in {"default": (),
                                "surfaces": command.settings("layered-impostor", warp="surfaces"),
                                "slices": command.settings("layered-impostor", warp="slices"),
                                "method": ("--method", "layered-slices")}.items():
            self.succeeds("render", self.file, *arguments, "--orbit", "3", "--size", "96x64", "-o",
                          self.folder / name, "--json", self.folder / f"{name}.json")
            made[name] = files_below(self.folder / name)
            self.assertEqual(len(set(made[name].values())), 3)
        self.assertEqual(made["default"], made["surfaces"])
        self.assertEqual(made["method"], made["slices"])
        self.assertNotEqual(made["surfaces"], made["slices"])
        figures = json.loads((self.folder / "default.json").read_text())
        self.assertEqual(figures["method"], "layered-impostor")
        self.assertEqual(figures["captures"], 0)

    def test_it_is_compared_with_the_scene_it_was_baked_of(self):
        out = self.folder / "report"
        done = self.succeeds("compare", self.file, "--scene", TEAPOT, "--frames", "2", "--size",
                             "96x64", "-o", out, "--json", "-")
        methods = json.loads(done.stdout)["methods"]
        self.assertEqual(set(methods), {"direct", "layered-impostor", "layered-slices"})
        for name in ("layered-impostor", "layered-slices"):
            # A teapot against the sky: where it is drawn at all it is mostly right, and 12 small
            # views are no more than that.
            self.assertLess(methods[name]["wrong_visibility"]["mean"], 0.01)
            self.assertGreater(methods[name]["psnr_db"]["mean"], 20)
            self.assertEqual(methods[name]["captures"], 0)
            self.assertGreater(methods[name]["picture_bytes"], 0)
        self.refused(["compare", self.file, "-o", out], self.file, "--scene")
        self.refused(["compare", TEAPOT, "--scene", TEAPOT, "-o", out], "--scene")
        self.refused(["compare", self.file, "--scene", self.file, "-o", out], self.file)
        self.refused(["compare", self.file, "--scene", TEAPOT, "--methods", "flat", "-o", out],
                     "flat", "layered")

    def test_what_a_file_cannot_do_is_refused(self):
        out = ("-o", self.folder / "out")
        self.refused(["render", self.file, "--method", "nailboard", *out], "nailboard", "layered")
        self.refused(["render", self.file, "--save-pictures", self.folder, *out], "file already")
        self.refused(["view", self.file, "--split"], "--split")
        self.refused(["view", self.file, "--method", "cache"], "cache", "layered")

    def test_a_file_cut_short_is_named(self):
        data = self.file.read_bytes()
        for size in (0, 4, 100, len(data) // 2, len(data) - 1):
            with self.subTest(size):
                cut = self.write("cut.exr", data[:size])
                for arguments in (["render", cut, "-o", self.folder / "out"], ["info", cut]):
                    self.refused(arguments, cut)
        self.assertFalse((self.folder / "out").exists())


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def exr(channels, matrices, size=4):
    """A picture of `size` x `size` texels, not compressed, every texel {channel: value}."""
    box = struct.pack("<4i", 0, 0, size - 1, size - 1)
    listed = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1)
                      for name in sorted(channels)) + b"\0"
    header = struct.pack("<II", 20000630, 2)
    header += attribute("channels", "chlist", listed)
    header += attribute("compression", "compression", b"\0")
    header += attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box)
    header += attribute("lineOrder", "lineOrder", b"\0")
    header += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    for name, rows in matrices.items():
        header += attribute(name, "m44f", struct.pack("<16f", *(x for row in rows for x in row)))
    header += b"\0"
    line = b"".join(struct.pack(f"<{size}f", *[channels[name]] * size) for name in sorted(channels))
    lines = [struct.pack("<ii", y, len(line)) + line for y in range(size)]
    first = len(header) + 8 * size
    offsets = b"".join(struct.pack("<Q", first + y * len(lines[0])) for y in range(size))
    return header + offsets + b"".join(lines)


class Foreign(command.Case):
    """Files that are no layered impostor, or no longer one."""

    CHANNELS = {"R": 0.5, "G": 0.25, "B": 0.125, "Z": 3.0}
    # An eye at the origin that looks along -z, 90 degrees wide.
    MATRICES = {"worldToCamera": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]],
                "worldToNDC": [[0.5, 0, 0, 0], [0, -0.5, 0, 0], [-0.5, -0.5, -1, -1],
                               [0, 0, -0.1, 0]]}

    def refuses(self, content, *named):
        file = self.write("file.exr", content)
        for arguments in (["render", file, "-o", self.folder / "out"],
                          ["compare", file, "--scene", TEAPOT, "-o", self.folder / "out"]):
            with self.subTest(arguments):
                self.refused(arguments, file, *named)
        self.assertFalse((self.folder / "out").exists())

    def matrix(self, name, change):
        rows = [list(row) for row in self.MATRICES[name]]
        change(rows)
        return {**self.MATRICES, name: rows}

    def test_a_picture_of_another_program_is_drawn_but_is_no_layered_impostor(self):
        file = self.write("file.exr", exr(self.CHANNELS, self.MATRICES))
        self.succeeds("render", file, "-o", self.folder / "out")
        self.assertEqual(list(files_below(self.folder / "out")), ["frame_00000.png"])
        self.refused(["compare", file, "--scene", TEAPOT, "-o", self.folder / "report"], file,
                     "nothing that was baked")
        self.refused(["view", file], file, "nothing that was baked")

    def test_missing_channels_are_named(self):
        for name in self.CHANNELS:
            kept = {key: value for key, value in self.CHANNELS.items() if key != name}
            self.refuses(exr(kept, self.MATRICES), f"no channel {name}")

    def test_depths_and_colours_that_are_no_numbers(self):
        for name, value, reason in (("Z", math.nan, "not a number"), ("Z", -1.0, "negative")):
            # What compares refuses plain pictures before it reads them.
            file = self.write("file.exr", exr({**self.CHANNELS, name: value}, self.MATRICES))
            self.refused(["render", file, "-o", self.folder / "out"], file, reason)
        # As renderers write them: docs/formats.md.
        for name, value in (("R", math.nan), ("G", math.inf)):
            file = self.write("file.exr", exr({**self.CHANNELS, name: value}, self.MATRICES))
            self.succeeds("render", file, "--draw", "software", "-o", self.folder / "frames")

    def test_matrices_that_are_no_camera(self):
        self.refuses(exr(self.CHANNELS, {}), "no camera")
        changes = (lambda m: m[0].__setitem__(0, math.nan), lambda m: m.__setitem__(1, [0] * 4),
                   lambda m: m[0].__setitem__(0, -m[0][0]), lambda m: m[3].__setitem__(0, math.inf))
        for change in changes:
            for name in self.MATRICES:
                self.refuses(exr(self.CHANNELS, self.matrix(name, change)))

    def test_a_layered_impostor_that_somebody_damaged(self):
        whole = self.folder / "whole.exr"
        self.succeeds("bake", TEAPOT, "--views", "12", "--size", "16", "--layers", "24", "-o", whole)
        data = whole.read_bytes()

        def patched(name, kind, at, value):
            """With bytes of the first picture's attribute replaced."""
            begin = data.index(f"{name}\0{kind}\0".encode()) + len(name) + len(kind) + 2 + 4 + at
            return data[:begin] + value + data[begin + len(value):]

        pose = struct.unpack_from("<3d", data, data.index(b"rilievo.worldFromEye\0m44d\0") + 30)
        for value, reason in ((struct.pack("<d", math.nan), "not finite"),
                              (struct.pack("<3d", 0, 0, 0), "orthonormal"),
                              (struct.pack("<3d", *(-x for x in pose)), "mirrored")):
            self.refuses(patched("rilievo.worldFromEye", "m44d", 0, value), "part 0", reason)
        for name, value in (("windowMax", -9.0), ("windowMin", math.nan), ("depthRange", math.inf)):
            self.refuses(patched(f"rilievo.{name}", "v2d", 0, struct.pack("<d", value)), "part 0")
        self.refuses(patched("rilievo.size", "v2i", 0, struct.pack("<i", 17)), "resized")
        self.refuses(patched("rilievo.file.slicing", "string", 0, b"0 "), "slice views")
        self.refuses(patched("rilievo.picture.fills", "string", 0, b"xx"), "fills holes")
        # It no longer says what it is: pictures that no nailboard can show.
        self.refuses(patched("rilievo.file.representation", "string", 0, b"L"), "")


class Method(command.Case):
    """Drawn of any scene, baked before the first frame."""

    BAKE = command.settings("layered-impostor", views=12, layers=16)
    LARGE = command.settings("layered-impostor", size=256)

    def test_compare_reports_them_like_any_other_method(self):
        # 12 * 32^2 texels of 17 bytes: memory for four of the fifteen, for ten by slices.
        done = self.succeeds("compare", TEAPOTS, *self.BAKE,
                             *command.settings("layered-impostor", size=32), "--memory-mb", "1",
                             "--methods", "layered,layered-slices", "--frames", "2", "--size", "96x64",
                             "-o", self.folder / "report", "--json", "-")
        methods = json.loads(done.stdout)["methods"]
        for name in ("layered", "layered-slices"):
            self.assertGreater(methods[name]["captures"], 0)
            self.assertEqual(methods[name]["captures"] % 12, 0)
            self.assertGreater(methods[name]["capture_ms"], 0)
            self.assertLess(methods[name]["wrong_visibility"]["mean"], 0.1)

    def test_memory_and_size_decide_what_is_polygons(self):
        def captures(*arguments):
            done = self.succeeds("render", TEAPOTS, *self.BAKE, "--method", "layered",
                                 *arguments, "--frames", "1", "--size", "96x64", "-o",
                                 self.folder / "out", "--json", "-")
            return json.loads(done.stdout)["captures"]

        # 12 * 256^2 texels of 17 bytes: 13 MB an object.
        self.assertEqual(captures(*self.LARGE, "--memory-mb", "14"), 12)
        self.assertEqual(captures(*self.LARGE, "--memory-mb", "12"), 0)

    def spinning_ring(self):
        """38 400 triangles that turn by a right angle and more in each of many short spans."""
        n, m = 160, 120
        vertices, triangles = [], []
        for j in range(m):
            for i in range(n):
                a, b = 2 * math.pi * i / n, 2 * math.pi * j / m
                r = 1 + 0.3 * math.cos(b)
                vertices += [r * math.sin(a), 0.3 * math.sin(b), r * math.cos(a)]
                c = [n * ((j + v) % m) + (i + u) % n for u, v in ((0, 0), (1, 0), (1, 1), (0, 1))]
                triangles += [c[0], c[1], c[2], c[0], c[2], c[3]]
        keys = range(81)
        times = [k / 40 for k in keys]
        turns = [v for k in keys for v in (math.sin(k), 0.0, 0.0, math.cos(k))]
        parts = [struct.pack(f"<{len(values)}{code}", *values) for code, values in
                 (("f", vertices), ("I", triangles), ("f", times), ("f", turns))]
        data = b"".join(parts)
        views, at = [], 0
        for part in parts:
            views.append({"buffer": 0, "byteOffset": at, "byteLength": len(part)})
            at += len(part)
        return self.write("ring.gltf", json.dumps({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "animations": [{"channels": [{"sampler": 0, "target": {"node": 0,
                                                                   "path": "rotation"}}],
                            "samplers": [{"input": 2, "output": 3}]}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": n * m, "type": "VEC3",
                 "min": [-1.3, -0.3, -1.3], "max": [1.3, 0.3, 1.3]},
                {"bufferView": 1, "componentType": 5125, "count": 6 * n * m, "type": "SCALAR"},
                {"bufferView": 2, "componentType": 5126, "count": len(keys),
                 "type": "SCALAR", "min": [0], "max": [2]},
                {"bufferView": 3, "componentType": 5126, "count": len(keys), "type": "VEC4"}],
            "bufferViews": views,
            "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," +
                         base64.b64encode(data).decode()}]}))

    def test_the_cache_draws_what_spins_from_what_is_baked(self):
        ring = self.spinning_ring()

        def drawn_as(*arguments):
            done = self.succeeds("compare", ring, "--methods", "cache", "--error-px", "3",
                                 *arguments, "--frames", "4", "--size", "96x64", "-o",
                                 self.folder / "report", "--json", "-")
            cache = json.loads(done.stdout)["methods"]["cache"]
            self.assertLessEqual(cache["bound_px"]["max"] if "bound_px" in cache else 0, 3)
            self.assertLess(cache["wrong_visibility"]["mean"], 0.01)
            return cache["drawn_as"]

        slices = command.settings("layered-impostor", warp="slices", views=12, layers=32, size=128)
        self.assertNotIn("layered-impostor", drawn_as())
        # Without OpenGL polygons cost less than that.
        self.assertGreater(drawn_as("--bake-mb", "8", "--draw", "opengl", *slices)["layered-impostor"], 1)
        drawn_as("--bake-mb", "8", "--draw", "software", *slices)
        self.refused(["compare", ring, "--methods", "cache", "--bake-mb", "64", "--memory-mb", "64",
                      "-o", self.folder / "none"], "--bake-mb")

    def test_pictures_that_are_baked_are_not_saved_a_frame_at_a_time(self):
        self.refused(["render", TEAPOTS, "--method", "layered", "--save-pictures", self.folder,
                      "-o", self.folder / "out"], "rilievo bake")


class Capture(command.Case):
    """Photographs with depth and their poses: a wall at two metres, seen from three places."""

    SIZE = (64, 48)

    def png(self, bits, rows):
        def chunk(kind, body):
            return (struct.pack(">I", len(body)) + kind + body +
                    struct.pack(">I", zlib.crc32(kind + body)))
        head = struct.pack(">IIBBBBB", *self.SIZE, bits, 0 if bits == 16 else 2, 0, 0, 0)
        return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) +
                chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) +
                chunk(b"IEND", b""))

    def setUp(self):
        super().setUp()
        self.capture = self.folder / "capture"
        self.capture.mkdir()
        width, height = self.SIZE
        (self.capture / "camera-intrinsics.txt").write_text("60 0 31.5 0 60 23.5 0 0 1")
        for i in range(3):
            frame = self.capture / f"frame-{i:06}"
            frame.with_suffix(".color.png").write_bytes(self.png(8, [
                bytes(v for x in range(width) for v in (4 * x, 5 * y, 90)) for y in range(height)]))
            frame.with_suffix(".depth.png").write_bytes(self.png(16, [
                struct.pack(">H", 2000) * width] * height))
            a = 0.1 * i  # radians, turned about the vertical
            frame.with_suffix(".pose.txt").write_text(
                f"{math.cos(a)} 0 {math.sin(a)} {0.1 * i}\n0 1 0 0\n"
                f"{-math.sin(a)} 0 {math.cos(a)} 0\n0 0 0 1\n")

    def test_info_says_what_it_holds(self):
        text = self.succeeds("info", self.capture).stdout
        self.assertIn("frames     3", text)
        self.assertIn("64 x 48", text)
        info = json.loads(self.succeeds("info", self.capture, "--json", "-").stdout)
        self.assertEqual((info["schema"], info["frames"], info["size"]),
                         ("rilievo-info-1", 3, [64, 48]))
        self.assertGreater(info["bounds"][1][2], 1.9)

    def test_it_is_baked_and_drawn_and_its_holes_are_told(self):
        out = self.folder / "wall.exr"
        for arguments, views in (((), 3), (("--around", "--views", "12", "--size", "32"), None)):
            with self.subTest(arguments):
                done = self.succeeds("bake", self.capture, *arguments, "-o", out, "--json", "-")
                baked = json.loads(done.stdout)
                self.assertEqual(baked["photographs"], 3)
                if views:
                    self.assertEqual(baked["views"], views)
                self.assertGreater(baked["filled_texels"], 100)
                self.assertTrue(0 < baked["hole_share"] < 1)
                self.assertIn("holes", self.succeeds("bake", self.capture, *arguments,
                                                     "-o", out).stdout)
                self.succeeds("render", out, "--size", "32x32", "--frames", "1", "-o",
                              self.folder / "frames")

    def test_up_is_told_from_the_poses_or_by_hand(self):
        out = self.folder / "wall.exr"
        up = json.loads(self.succeeds("bake", self.capture, "-o", out, "--json", "-").stdout)["up"]
        for value, expected in zip(up, (0, -1, 0)):  # these poses have y down
            self.assertAlmostEqual(value, expected, places=4)
        up = json.loads(self.succeeds("bake", self.capture, "--upright", "0,0,-2", "-o", out,
                                      "--json", "-").stdout)["up"]
        self.assertEqual(up, [0, 0, -1])
        self.refused(("bake", self.capture, "--upright", "0,0,0", "-o", out), "--upright")
        self.refused(("bake", self.capture, "--upright", "nan,0,0", "-o", out), "--upright")
        self.refused(("bake", TEAPOT, "--upright", "0,1,0", "-o", out), "--upright")

    def test_only_what_lies_in_the_box(self):
        done = self.succeeds("bake", self.capture, "--box", "-0.3,-0.3,1,0.3,0.3,3", "-o",
                             self.folder / "part.exr", "--json", "-")
        self.assertEqual(json.loads(done.stdout)["box"][0][2], 1)

    def test_what_cannot_be_baked_is_told_in_one_line(self):
        out = ("-o", self.folder / "out.exr")
        bake = ("bake", self.capture)
        self.refused((*bake, "--box", "1,1,1,0,0,0", *out), "--box")
        self.refused((*bake, "--box", "1,1,1", *out), "--box")
        self.refused((*bake, "--box", "8,8,8,9,9,9", *out), self.capture)
        self.refused(("bake", TEAPOT, "--around", *out), "--around")
        pose = self.capture / "frame-000001.pose.txt"
        pose.write_text("nan " * 16)
        # One lost camera costs its picture, all of them the capture.
        self.assertIn(pose.name, self.succeeds("info", self.capture).stderr)
        for pose in self.capture.glob("*.pose.txt"):
            pose.write_text("nan " * 16)
        self.refused((*bake, *out), self.capture)
        self.refused(("info", self.capture), self.capture)
        self.assertFalse((self.folder / "out.exr").exists())


if __name__ == "__main__":
    command.main()
