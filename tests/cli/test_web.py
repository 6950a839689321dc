#!/usr/bin/env python3
"""What `rilievo web` writes: folders that a browser walks through.

    test_web.py PATH/TO/rilievo [unittest arguments]
"""

import json
import pathlib

import command
from command import TEAPOTS


class Web(command.Case):
    def written(self, *arguments, parts=()):
        """The manifest of a walk, all of whose files are there, and those parts of the program."""
        folder = self.folder / "walk"
        self.succeeds("web", *arguments, "-o", folder)
        names = set()

        def find_files(value):
            for one in value.values() if isinstance(value, dict) else value if isinstance(value, list) else []:
                find_files(one)
            if isinstance(value, dict) and "file" in value:
                names.add(value["file"])
                self.assertEqual((folder / value["file"]).stat().st_size, value["bytes"])

        manifest = json.loads((folder / "walk.json").read_text())
        self.assertEqual(manifest["schema"], "rilievo-walk-1")
        find_files(manifest)
        self.assertEqual(names | {"index.html", "viewer.js", "headset.js", "walk.json", *parts},
                         {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()})
        return manifest

    def test_a_scene_becomes_nodes(self):
        manifest = self.written(TEAPOTS, "--at", "0,2,6", "--face", "32", "--coarse", "16")
        self.assertEqual([level["face_size"] for level in manifest["nodes"][0]["levels"]], [16, 32])
        self.assertNotIn("pictures", manifest)
        # Where its node stands nothing is missing.
        for place, at in zip(manifest["start"]["eye"], (0, 2, 6)):
            self.assertAlmostEqual(place, at, places=5)

    def test_an_impostor_becomes_pictures_that_are_marched_through(self):
        baked = self.folder / "teapots.exr"
        self.succeeds("bake", TEAPOTS, "--as", "layered-impostor", "--views", "12", "--size", "16", "-o", baked)
        pictures = self.written(baked, parts=["pictures.js"])["pictures"]
        self.assertEqual((pictures["drawn"], len(pictures["list"])), ("surfaces", 12))
        # Of 12 views the covering angle is 0.65 rad: what is steep is looked up in others.
        self.assertEqual(pictures["links"]["gentle"], 4)

    def test_a_frame_becomes_nailboards(self):
        self.succeeds("render", TEAPOTS, "--draw", "software", "--method", "nailboard", "--frames", "1", "--size",
                      "96x64", "--save-pictures", self.folder, "-o", self.folder / "frame")
        manifest = self.written(self.folder / "pictures_00000.exr", parts=["pictures.js"])
        self.assertEqual(manifest["pictures"]["drawn"], "nailboards")
        self.assertGreater(len(manifest["pictures"]["list"]), 1)
        self.assertNotIn("nodes", manifest)

    def test_reliefs_become_sheets_of_samples(self):
        baked = self.folder / "relief.exr"
        self.succeeds("bake", TEAPOTS, "--as", "layered-relief", "--size", "32", "-o", baked)
        reliefs = self.written(baked, parts=["reliefs.js"])["reliefs"]
        self.assertEqual(len(reliefs["list"]), 6)
        # As `render` draws them by default; splats that do not face the eye are a little larger.
        self.assertAlmostEqual(reliefs["splat"], 1.5, delta=0.01)
        self.assertEqual((reliefs["resolution"], reliefs["max_size"]), (1, 2048))
        info = self.folder / "info.json"
        self.succeeds("info", baked, "--json", info)
        self.assertEqual(sum(relief["samples"] for relief in reliefs["list"]),
                         json.loads(info.read_text())["samples"])
        # A walk of another kind in the same folder leaves nothing of this one.
        self.written(TEAPOTS, "--at", "0,2,6", "--face", "16")

    def test_what_is_baked_is_not_baked_again(self):
        baked = self.folder / "relief.exr"
        self.succeeds("bake", TEAPOTS, "--as", "layered-relief", "--size", "16", "-o", baked)
        self.refused(("web", baked, "--as", "layered-impostor", "-o", self.folder / "walk"), "--as")
        self.assertFalse((self.folder / "walk").exists())


if __name__ == "__main__":
    command.main()
