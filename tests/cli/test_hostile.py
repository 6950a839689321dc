#!/usr/bin/env python3
"""What strangers' files may cost, where they may lead, and what the program says of them.

    test_hostile.py PATH/TO/rilievo [unittest arguments]
"""

import base64
import json
import os
import resource
import struct
import subprocess
import time
import unittest
import zlib

import command

MIB = 1 << 20


def is_sanitized():
    """Shadow memory hides what the program itself takes."""
    with open(command.program, "rb") as file:
        return b"__asan_init" in file.read()


def png(width, height, color, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, color, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def triangle(**more):
    """The smallest .gltf, and what else it is to have."""
    data = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    document = {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36,
                     "uri": "data:;base64," + base64.b64encode(data).decode()}]}
    return document | more


def zeros(count, kind):
    return {"componentType": 5126, "count": count, "type": kind}


class Cost(command.Case):
    """Peak memory is at most 64 MiB + 32 times the bytes of the files + 4 bytes a decoded texel."""

    def peak(self, file, *options):
        """(exit code, error output, peak resident bytes, seconds)"""
        started = time.monotonic()
        process = subprocess.Popen([command.program, "info", str(file), *options],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True, errors="replace")
        errors = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        process.stderr.close()
        return process.returncode, errors, usage.ru_maxrss * 1024, time.monotonic() - started

    def costs_little(self, file, texels=0, files=(), refused=True):
        code, errors, peak, _ = self.peak(file)
        self.assertEqual(code, 2 if refused else 0, errors)
        if refused:
            self.assertIn("--memory-limit-mb", errors)
        if not is_sanitized():
            read = sum(f.stat().st_size for f in (file, *files))
            self.assertLessEqual(peak, 64 * MIB + 32 * read + 4 * texels, f"{file.name}: {errors}")
        return errors

    def gltf(self, name, document):
        return self.write(name, json.dumps(document))

    def test_numbers_that_no_byte_stands_for(self):
        vertices = triangle()
        vertices["accessors"] = [zeros(300000000, "VEC3")]
        self.costs_little(self.gltf("vertices.gltf", vertices))

        keys = triangle(animations=[{
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
            "samplers": [{"input": 1, "output": 2}]}])
        keys["accessors"] += [zeros(100000000, "SCALAR"), zeros(100000000, "VEC3")]
        self.costs_little(self.gltf("keys.gltf", keys))

        instances = triangle()
        instances["accessors"].append(zeros(10000000, "VEC3"))
        instances["nodes"][0]["extensions"] = {
            "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}}
        self.costs_little(self.gltf("instances.gltf", instances))

        sparse = triangle()
        sparse["accessors"][0]["count"] = 50000000
        sparse["accessors"][0].pop("bufferView")
        sparse["accessors"][0]["sparse"] = {
            "count": 1, "indices": {"bufferView": 0, "componentType": 5121},
            "values": {"bufferView": 0}}
        self.costs_little(self.gltf("sparse.gltf", sparse))

    def test_small_marks_that_become_large_things(self):
        self.costs_little(self.write("deep.gltf", '{"asset":' + "[" * 2000000))
        nodes = triangle()
        nodes["nodes"] *= 150000
        nodes["scenes"][0]["nodes"] = list(range(150000))
        self.costs_little(self.gltf("nodes.gltf", nodes))
        faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * 1000000
        self.costs_little(self.write("faces.obj", faces), refused=False)
        meshes = triangle()
        meshes["meshes"][0]["primitives"] *= 3000
        big = base64.b64encode(bytes(36) * 4000).decode()
        meshes["accessors"][0]["count"] = 12000
        meshes["bufferViews"][0]["byteLength"] = 36 * 4000
        meshes["buffers"] = [{"byteLength": 36 * 4000, "uri": "data:;base64," + big}]
        self.costs_little(self.gltf("meshes.gltf", meshes))

    def test_sixty_textures_of_one_picture(self):
        side = 4096
        picture = self.write("p.png", png(side, side, 0, bytes((side + 1) * side)))
        scene = triangle(
            images=[{"uri": "./" * (i % 3) + "p.png"} for i in range(60)],
            samplers=[{"wrapS": wrap} for wrap in (10497, 33071, 33648)],
            textures=[{"source": i, "sampler": i % 3} for i in range(60)],
            materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}}
                       for i in range(60)])
        scene["meshes"][0]["primitives"] = [{"attributes": {"POSITION": 0}, "material": i}
                                            for i in range(60)]
        self.costs_little(self.gltf("sixty.gltf", scene), side * side, [picture], refused=False)

        mtl = "".join(f"newmtl m{i}\nmap_Kd {'./' * (i % 3)}p.png\n" for i in range(60))
        obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n" + "".join(
            f"usemtl m{i}\nf 1/1 2/1 3/1\n" for i in range(60))
        files = [picture, self.write("m.mtl", mtl)]
        self.costs_little(self.write("sixty.obj", obj), side * side, files, refused=False)

    def test_a_picture_that_its_bytes_cannot_hold_is_left_out(self):
        picture = self.write("p.png", png(16384, 16384, 6, b"few"))
        scene = triangle(images=[{"uri": "p.png"}], textures=[{"source": 0}],
                         materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])
        scene["meshes"][0]["primitives"][0]["material"] = 0
        errors = self.costs_little(self.gltf("a.gltf", scene), 0, [picture], refused=False)
        self.assertIn("claims 16384 x 16384 texels", errors)

    def test_a_library_that_is_the_file_itself_is_read_once(self):
        lines = "".join(f"mtllib {'./' * (i % 50)}a.obj\n" for i in range(40000))
        file = self.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + lines + "f 1 2 3\n")
        code, errors, _, seconds = self.peak(file)
        self.assertEqual(code, 0, errors)
        # Over a minute where it is read for each line.
        self.assertLess(seconds, 20 if not is_sanitized() else 200)

    def test_the_limit_holds_and_is_named(self):
        file = self.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "#" * (5 * MIB) + "\nf 1 2 3\n")
        self.assertEqual(self.peak(file, "--memory-limit-mb", "40")[0], 0)
        code, errors, _, _ = self.peak(file, "--memory-limit-mb", "4")
        self.assertEqual(code, 2)
        self.assertIn("more than the 4 that --memory-limit-mb allows", errors)
        self.refused(["info", file, "--memory-limit-mb", "0"], "--memory-limit-mb")

    # 1 GiB of addresses, of which the libraries take a third.
    def test_a_machine_with_little_memory_is_enough(self):
        if is_sanitized():
            self.skipTest("the sanitizer itself takes terabytes of addresses")
        scene = triangle()
        scene["accessors"] = [zeros(300000000, "VEC3")]
        self.refused(["info", self.gltf("a.gltf", scene)], "--memory-limit-mb",
                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30)))


class Outside(command.Case):
    """What a scene refers to lies in its own folder, unless it is allowed to lie elsewhere."""

    def setUp(self):
        super().setUp()
        self.model = self.folder / "model"
        self.model.mkdir()

    def test_a_buffer(self):
        self.write("out.bin", struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
        for uri in ("../out.bin", "%2e%2e/out.bin", str(self.folder / "out.bin")):
            file = self.write("model/a.gltf", json.dumps(
                triangle(buffers=[{"byteLength": 36, "uri": uri}])))
            self.refused(["info", file], "outside", "--allow-outside")
            self.succeeds("info", file, "--allow-outside")
        file = self.write("model/a.gltf", json.dumps(
            triangle(buffers=[{"byteLength": 36, "uri": "../" * 20 + "etc/passwd"}])))
        for arguments in (["render", file, "-o", self.folder / "out"],
                          ["bake", file, "-o", self.folder / "a.exr"],
                          ["scene", file, "-o", self.folder / "a.glb"],
                          ["compare", file, "-o", self.folder / "out"]):
            self.refused(arguments, "etc/passwd", "--allow-outside")

    def test_a_library(self):
        file = self.write("model/a.obj",
                          "mtllib ../../../../../../../../../etc/passwd\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.assertIn("--allow-outside", self.succeeds("info", file).stderr)

    def test_images_of_a_capture(self):
        self.write("c.png", png(4, 4, 0, bytes(20)))
        self.write("model/transforms.json", json.dumps({
            "fl_x": 4, "frames": [{"file_path": "../c.png", "depth_file_path": "../c.png",
                                   "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0],
                                                        [0, 0, 0, 1]]}]}))
        self.refused(["info", self.model], "outside", "--allow-outside")
        # Read now, and found to be no depth.
        self.refused(["info", self.model, "--allow-outside"], "16-bit grey")


class Words(command.Case):
    """Messages say what is wrong and what to do, and never more than they mean to."""

    def test_a_name_cannot_write_to_the_terminal(self):
        name = "\x1b]0;pwned\x07\x1b[31mred\r\x9b2J\u202egpj.txt\x7f"
        file = self.write("a.gltf", json.dumps(
            triangle(buffers=[{"byteLength": 36, "uri": name}])))
        done = command.run("info", file)
        self.assertEqual(done.returncode, 2)
        self.assertIn(r"\x1b]0;pwned\x07\x1b[31mred\x0d", done.stderr)
        self.assertNotRegex(done.stderr, "[\x00-\x09\x0b-\x1f\x7f-\x9f\u202e]")
        missing = self.folder / "no\x1b[2Jsuch.glb"
        self.refused(["info", missing], r"no\x1b[2Jsuch.glb")
        self.refused(["info", file, "--no\x1b[2Jsuch"], r"\x1b[2J")

    def test_nothing_is_not_only_0(self):
        skin = triangle()
        skin["nodes"][0]["skin"] = 0
        file = self.write("a.gltf", json.dumps(skin))
        self.refused(["info", file], "nodes[0].skin refers to 0, but there are none")
        file = self.write("a.obj", "f 1 2 3\n")
        self.refused(["info", file], "refers to vertex 1, but there are none")
        file = self.write("a.gltf", json.dumps(triangle(asset={"version": ""})))
        self.refused(["info", file], "asset.version is empty")

    def test_an_undecodable_picture_has_a_reason(self):
        def chunk(kind, body):
            return (struct.pack(">I", len(body)) + kind + body +
                    struct.pack(">I", zlib.crc32(kind + body)))
        # A deflate block of type 3, of which stb_image had nothing to say.
        bad = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 6, 0, 0, 0)) +
               chunk(b"IDAT", b"\x78\x01\x07" + bytes(7)) + chunk(b"IEND", b""))
        self.write("p.png", bad)
        scene = triangle(images=[{"uri": "p.png"}], textures=[{"source": 0}],
                         materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])
        scene["meshes"][0]["primitives"][0]["material"] = 0
        gltf = self.write("a.gltf", json.dumps(scene))
        self.write("m.mtl", "newmtl m\nmap_Kd p.png\n")
        obj = self.write("a.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\n"
                                  "f 1/1 2/1 3/1\n")
        for file in (gltf, obj):
            self.assertRegex(self.succeeds("info", file).stderr, "cannot be decoded: [A-Za-z]")
        self.write("transforms.json", json.dumps({
            "fl_x": 4, "frames": [{"file_path": "p.png", "depth_file_path": "p.png",
                                   "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0],
                                                        [0, 0, 0, 1]]}]}))
        self.refused(["info", self.folder], "cannot be decoded: ")

    def test_a_folder_and_pictures_by_another_name(self):
        self.refused(["info", self.folder], "folder", ".gltf", "transforms.json")
        self.write("b.obj", "")
        self.refused(["render", self.folder, "-o", self.folder / "out"], "name a file in it", "b.obj")
        pictures = self.folder / "teapot.exr"
        self.succeeds("bake", "builtin:teapot?triangles=2000", "--views", "12", "--size", "16",
                      "-o", pictures)
        renamed = pictures.rename(self.folder / "teapot.pictures")
        self.assertIn("layered-impostor", self.succeeds("info", renamed).stdout)
        self.succeeds("render", renamed, "--frames", "1", "--size", "32x32", "-o",
                      self.folder / "out")


if __name__ == "__main__":
    command.main()
