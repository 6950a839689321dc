#!/usr/bin/env python3
"""Does the example draw a frame, and load no OpenGL?

    test_software_frame.py PROGRAM
"""

import pathlib
import re
import subprocess
import sys
import tempfile


def main(program):
    libraries = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
    for name in ("libepoxy", "libEGL", "libGL", "libOpenGL"):
        assert name not in libraries, f"{program} loads {name}"
    with tempfile.TemporaryDirectory() as folder:
        frame = pathlib.Path(folder) / "frame.png"
        scene = "builtin:forest?triangles=200000"
        done = subprocess.run([program, frame, scene, "8"], check=True, capture_output=True, text=True)
        found = re.search(r": (\d+) pictures, (\d+) objects as polygons", done.stdout)
        assert found and int(found[1]) > 0, done.stdout
        picture = frame.read_bytes()
        assert picture.startswith(b"\x89PNG\r\n"), "no PNG"
        assert picture[16:24] == (1280).to_bytes(4, "big") + (720).to_bytes(4, "big"), "its size"
        # What is empty packs to some kilobytes.
        assert len(picture) > 50_000, f"{len(picture)} bytes: nothing is drawn"
        wrong = subprocess.run([program, frame, "builtin:nothing"], capture_output=True, text=True)
        assert wrong.returncode == 2 and "nothing" in wrong.stderr, wrong.stderr


if __name__ == "__main__":
    main(sys.argv[1])
