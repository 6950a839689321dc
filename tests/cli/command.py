"""What the tests of the command line share: the program under test, and cases with a folder."""

import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

# Enough for the slowest case under sanitizers on a busy machine; a hang, not slowness, is the fault.
TIMEOUT_S = 280
SMALL = ("--size", "96x64", "--frames", "3")
TEAPOTS = "builtin:teapots?triangles=20000"

program = ""


def run(*arguments, **options):
    options.setdefault("timeout", TIMEOUT_S)
    options.setdefault("stdin", subprocess.DEVNULL)
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True,
                          errors="replace", **options)


def files_below(folder):
    """Name -> content of every file below `folder`; of long ones its hash, because a failed comparison
    takes minutes to show how two pictures differ."""
    def short(content):
        return content if len(content) < 100 else hashlib.sha256(content).hexdigest()
    return {path.relative_to(folder).as_posix(): short(path.read_bytes())
            for path in sorted(folder.rglob("*")) if path.is_file()}


def settings(kind, **options):
    """--set for options of a kind; `_` stands for `-`."""
    return tuple(word for name, value in options.items()
                 for word in ("--set", f"{kind}.{name.replace('_', '-')}={value}"))


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rilievo-cli-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def write(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def succeeds(self, *arguments, **options):
        done = run(*arguments, **options)
        self.assertEqual(done.returncode, 0, f"{arguments}: {done.stderr}")
        return done

    def refused(self, arguments, *named, **options):
        """Exit code 2 and one line that names what is wrong; a loader may warn before it."""
        done = run(*arguments, **options)
        self.assertEqual(done.returncode, 2, f"{arguments}: {done.stdout}{done.stderr}")
        lines = [line for line in done.stderr.splitlines() if ": warning: " not in line]
        self.assertEqual(len(lines), 1, f"{arguments}: {done.stderr}")
        self.assertRegex(lines[0], r"^rilievo: .{10,}$")
        for name in named:
            self.assertIn(str(name), lines[0])


def main():
    """FILE.py PATH/TO/rilievo [unittest arguments]"""
    global program
    program = os.path.abspath(sys.argv[1])
    unittest.main(module="__main__", argv=[sys.argv[0], *sys.argv[2:]])
