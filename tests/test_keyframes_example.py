#!/usr/bin/env python3
"""Does the example draw frames from keyframes of each source?

    test_keyframes_example.py PROGRAM
"""

import pathlib
import re
import subprocess
import sys
import tempfile


def main(program):
    with tempfile.TemporaryDirectory() as folder:
        frame = pathlib.Path(folder) / "frame.png"
        for source in ("raster", "rays", "raytrace"):
            done = subprocess.run([program, frame, "builtin:teapots?triangles=20000", "6", source], check=True,
                                  capture_output=True, text=True)
            found = re.search(r"from (\d+) keyframes, (\d+) of them coarse; ([\d.]+) % filled", done.stdout)
            assert found and int(found[1]) > 0 and float(found[3]) < 20, done.stdout
            # Nobody waits for the ray tracer: its first frames are from a coarse keyframe.
            assert source == "raytrace" or int(found[2]) == 0, done.stdout
            assert len(frame.read_bytes()) > 20_000, f"{source}: nothing is drawn"
        wrong = subprocess.run([program, frame, "builtin:teapots", "1", "paint"], capture_output=True, text=True)
        assert wrong.returncode == 2 and "--source" in wrong.stderr, wrong.stderr


if __name__ == "__main__":
    main(sys.argv[1])
