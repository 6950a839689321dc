#!/usr/bin/env python3
"""Files from outside: broken scenes made on the spot, disks that are full, pictures that other
programs must open.

    test_files.py PATH/TO/rilievo [unittest arguments]
"""

import base64
import json
import resource
import shutil
import signal
import struct
import subprocess

import command
from command import TEAPOTS, SMALL, files_below


def triangle():
    """The smallest of scenes: a triangle, its buffer inside."""
    data = struct.pack("<9f3H2x", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2)
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," +
                     base64.b64encode(data).decode()}],
        "bufferViews": [{"buffer": 0, "byteLength": 36},
                        {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                       "min": [0, 0, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
    }


class Scenes(command.Case):
    def test_a_missing_file(self):
        for command in ("info", "render", "compare"):
            with self.subTest(command):
                out = [] if command == "info" else ["-o", self.folder / "out"]
                self.refused([command, self.folder / "gone.glb", *out], "gone.glb")
                self.assertFalse((self.folder / "out").exists())

    def test_files_that_are_not_what_their_name_says(self):
        junk = bytes(range(256)) * 8
        glb = struct.pack("<4sII", b"glTF", 2, 4096)
        for name, content in {
            "empty.glb": b"", "junk.glb": junk, "header.glb": glb, "empty.gltf": b"",
            "junk.gltf": junk, "text.gltf": b"{", "null.gltf": b"null", "deep.gltf": b"[" * 100000,
            "empty.obj": b"", "junk.ply": junk, "header.ply": b"ply\nformat ascii 1.0\n",
            "junk.stl": b"solid", "junk.exr": junk, "empty.exr": b"",
            "big.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 2000000000\n"
                       b"property float x\nend_header\n",
        }.items():
            with self.subTest(name):
                self.refused(["info", self.write(name, content)], name)

    def test_an_unknown_kind_of_file(self):
        self.refused(["info", self.write("scene.blend", b"BLENDER")], "scene.blend")

    def test_an_index_out_of_range(self):
        gltf = triangle()
        gltf["accessors"][1]["count"] = 3000
        self.refused(["info", self.write("range.gltf", json.dumps(gltf))], "range.gltf")

    def test_a_required_extension_that_is_not_supported(self):
        gltf = triangle()
        gltf["extensionsRequired"] = gltf["extensionsUsed"] = ["EXT_unheard_of"]
        path = self.write("extension.gltf", json.dumps(gltf))
        self.refused(["info", path], "extension.gltf", "EXT_unheard_of")

    def test_an_optional_extension_that_is_not_supported_is_a_warning(self):
        gltf = triangle()
        gltf["extensionsUsed"] = ["EXT_unheard_of"]
        done = self.succeeds("info", self.write("extension.gltf", json.dumps(gltf)))
        self.assertIn("EXT_unheard_of", done.stderr)

    def test_a_name_with_spaces_and_accents(self):
        path = self.write("un modèle à moi.gltf", json.dumps(triangle()))
        self.succeeds("info", path)


class Output(command.Case):
    def test_saved_pictures_open_in_other_programs(self):
        out, pictures = self.folder / "out", self.folder / "pictures"
        self.succeeds("render", TEAPOTS, *SMALL, "--method", "nailboard", "-o", out,
                      "--save-pictures", pictures)
        saved = sorted(pictures.rglob("*.exr"))
        self.assertTrue(saved)
        for path in saved:
            self.succeeds("info", path)
            if shutil.which("exrinfo"):
                # That of OpenEXR 3.1 ends with any exit code: now and then another one for one file.
                info = subprocess.run(["exrinfo", "-v", path], capture_output=True, text=True)
                self.assertEqual(info.stderr, "")
                for attribute in ("worldToCamera", "worldToNDC"):
                    self.assertIn(attribute, info.stdout)
            if shutil.which("oiiotool"):
                subprocess.run(["oiiotool", "--stats", path], capture_output=True, check=True)

    def test_a_full_disk_is_an_error_and_leaves_nothing_half_written(self):
        out, tiny = self.folder / "out", ("--size", "8x6", "--frames", "1")
        # A limit on the size of a file stands for the disk: the write that crosses it fails.
        for limit, arguments in (
                (1500, ["render", TEAPOTS, *SMALL, "-o", out]),
                (1500, ["render", TEAPOTS, *tiny, "--method", "flat", "-o", self.folder / "frames",
                        "--save-pictures", out]),
                (1500, ["compare", TEAPOTS, *SMALL, "--methods", "flat", "-o", out]),
                (100, ["info", TEAPOTS, "--json", out])):
            def fill_disk(limit=limit):
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

            with self.subTest(arguments):
                self.refused(arguments, out, preexec_fn=fill_disk, restore_signals=False)
                self.assertEqual(files_below(self.folder).keys() - {"frames/frame_00000.png"}, set())

    def test_a_folder_that_cannot_be_made(self):
        blocker = self.write("file", b"")
        for command in (["render", TEAPOTS, *SMALL, "-o"],
                        ["compare", TEAPOTS, *SMALL, "--methods", "flat", "-o"]):
            self.refused([*command, blocker / "out"], "file")
        self.assertEqual(blocker.read_bytes(), b"")


class WrittenScenes(command.Case):
    def test_a_scene_written_and_read_again_has_the_same_triangles(self):
        for text in ("bridge?triangles=100000", "forest?triangles=20000",
                     "teapots?triangles=20000", "teapot?triangles=2000"):
            with self.subTest(text):
                made = json.loads(self.succeeds("info", f"builtin:{text}", "--json", "-").stdout)
                path = self.folder / "scene.glb"
                self.succeeds("scene", text, "-o", path)
                read = json.loads(self.succeeds("info", path, "--json", "-").stdout)
                self.assertEqual(read["triangles"], made["triangles"])
                self.assertEqual(read["objects"], made["objects"])
                self.assertEqual(read["moving_objects"], made["moving_objects"])


if __name__ == "__main__":
    command.main()
