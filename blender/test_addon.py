#!/usr/bin/python3
"""The add-on, installed in a Blender of its own without a window.

    blender/test_addon.py PATH/TO/rilievo [ROOM.blend]

Needs Blender (3.4 or later) on the PATH, and the Python that it was built for. Nothing of the user's own
Blender is read or written.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

here = pathlib.Path(__file__).resolve()


def outside(program, room):
    folder = pathlib.Path(tempfile.mkdtemp(prefix="rilievo-addon-"))
    try:
        archive = folder / "rilievo_walk.zip"
        subprocess.run([sys.executable, here.parent / "make_addon", archive], check=True)
        (folder / "config").mkdir()
        environment = {**os.environ, "BLENDER_USER_SCRIPTS": str(folder / "scripts"), "HOME": str(folder),
                       "BLENDER_USER_CONFIG": str(folder / "config"), "RILIEVO_TEST_PROGRAM": program,
                       "RILIEVO_TEST_ARCHIVE": str(archive), "RILIEVO_TEST_FOLDER": str(folder)}
        done = subprocess.run(["blender", "--background", "--factory-startup", "--python-exit-code", "1",
                               "--python", here, "--", *room], env=environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=1500)
        lines = done.stdout.splitlines() + done.stderr.splitlines()
        print("\n".join(line for line in lines if line.startswith(("test:", "Traceback", "  ")) or "Error" in line))
        return done.returncode
    finally:
        shutil.rmtree(folder)


if "RILIEVO_TEST_PROGRAM" not in os.environ:
    sys.exit(outside(os.path.abspath(sys.argv[1]), sys.argv[2:]))

import json  # noqa: E402
import time  # noqa: E402
import urllib.request  # noqa: E402

import addon_utils  # noqa: E402
import bpy  # noqa: E402

folder = pathlib.Path(os.environ["RILIEVO_TEST_FOLDER"])


def passed(what):
    print("test: passed:", what, flush=True)


def fails(operator, *named):
    """The operator reports an error, which names these."""
    try:
        operator()
    except RuntimeError as error:  # what an error of an operator becomes
        for name in named:
            assert name in str(error), (name, str(error))
        return
    raise AssertionError("no error")


def settings():
    return bpy.context.scene.rilievo_walk


def small(name):
    settings().face, settings().samples, settings().nodes = "64", 2, 1
    settings().folder = str(folder / name)


def wait(work, busy, until=lambda work: False):
    deadline = time.time() + 600
    while work.poll() in busy and not until(work):
        assert time.time() < deadline, work.text()
        time.sleep(0.02)


def cameras_of(name):
    return json.loads((folder / name / "bake.json").read_text())["pictures"]


def main():
    bpy.ops.preferences.addon_install(filepath=os.environ["RILIEVO_TEST_ARCHIVE"], overwrite=True)
    assert bpy.ops.preferences.addon_enable(module="rilievo_walk") == {"FINISHED"}
    import rilievo_walk
    from rilievo_walk import walk_bake
    preferences = bpy.context.preferences.addons["rilievo_walk"].preferences
    passed("installed from its archive, and enabled")

    preferences.program = "rilievo-that-is-nowhere"
    small("none")
    fails(lambda: bpy.ops.rilievo.bake_walk(), "rilievo-that-is-nowhere", "not found", "PATH", "preferences")
    fails(lambda: bpy.ops.rilievo.propose_nodes(), "not found")
    assert not (folder / "none").exists()
    preferences.program = os.environ["RILIEVO_TEST_PROGRAM"]
    passed("without the program: a message that says what to do")

    settings().eyes = "BOX"
    fails(lambda: bpy.ops.rilievo.bake_walk(), "no box is chosen")
    settings().eyes = "FLOOR"
    bpy.context.view_layer.objects.active = None
    fails(lambda: bpy.ops.rilievo.bake_walk(), "no floor is selected")
    settings().eyes = "PATH"
    camera = bpy.context.scene.camera
    bpy.context.scene.camera = None
    fails(lambda: bpy.ops.rilievo.bake_walk(), "no camera")
    bpy.context.scene.camera = camera
    passed("what is missing is named")

    assert bpy.ops.rilievo.propose_nodes() == {"FINISHED"}
    assert settings().nodes >= 1 and settings().share > 50, (settings().nodes, settings().share)
    passed(f"proposed for Blender's default scene: {settings().status}")

    small("default")
    selected = [o.name for o in bpy.context.selected_objects]
    assert bpy.ops.rilievo.bake_walk() == {"FINISHED"}, settings().status
    for file in ("walk.exr", "walk/index.html", "walk/walk.json", "scene.blend", "surfaces.glb"):
        assert (folder / "default" / file).stat().st_size > 0, file
    assert cameras_of("default")["rendered"] == 6, cameras_of("default")
    assert [o.name for o in bpy.context.selected_objects] == selected
    assert not bpy.data.filepath  # the user's file is as it was
    passed("Blender's default scene baked by Cycles, with a page")

    server = walk_bake.PageServer(folder / "default" / "walk")
    page = urllib.request.urlopen(server.address).read()
    server.close()
    assert b"viewer.js" in page
    passed("the page is served on this machine")

    # A floor of 4 x 4 m, with eyes above it; the ray tracer, which is quick.
    bpy.ops.mesh.primitive_plane_add(size=4, location=(0, 0, -1))
    settings().eyes, settings().light = "FLOOR", "RAYTRACE"
    low, high = rilievo_walk.region_of_eyes(bpy.context)
    assert all(abs(a - b) < 1e-5 for a, b in zip(low + high, [-1.6, 0.4, -1.6, 1.6, 0.9, 1.6])), (low, high)
    small("floor")
    assert bpy.ops.rilievo.bake_walk() == {"FINISHED"}, settings().status
    settings().eyes, settings().light = "PATH", "CYCLES"
    passed("eyes above the selected floor")

    # Cancelled halfway, and started again.
    small("halfway")
    # Long enough to be cancelled.
    settings().nodes, settings().samples, settings().preview = 2, 256, False
    work = walk_bake.WalkBake(preferences.program, rilievo_walk.make_job(bpy.context, render=True))
    wait(work, ("baking",), until=lambda w: w.done >= 3)
    assert work.state == "baking", work.text()
    work.cancel()
    assert work.state == "cancelled" and work.running.process.poll() is not None
    assert not work.job.file.exists()
    work = walk_bake.WalkBake(preferences.program, rilievo_walk.make_job(bpy.context, render=True))
    wait(work, ("baking", "writing"))
    assert work.state == "done", work.text()
    pictures = cameras_of("halfway")
    assert pictures["kept"] >= 3 and (pictures["kept"] + pictures["rendered"]) % 6 == 0, pictures
    passed(f"cancelled halfway and started again: {pictures['kept']} pictures kept, {pictures['rendered']} rendered")

    for room in sys.argv[sys.argv.index("--") + 1:]:
        bpy.ops.wm.open_mainfile(filepath=room)
        small("room")
        for thing in bpy.context.scene.objects:
            if thing.name == "parquet":
                bpy.context.view_layer.objects.active = thing
                settings().eyes = "FLOOR"
        assert bpy.ops.rilievo.propose_nodes() == {"FINISHED"}, settings().status
        proposed = settings().status
        small("room")
        assert bpy.ops.rilievo.bake_walk() == {"FINISHED"}, settings().status
        passed(f"{pathlib.Path(room).name}: {proposed}; one node baked")

    addon_utils.disable("rilievo_walk")
    assert not hasattr(bpy.types.Scene, "rilievo_walk")
    passed("disabled")


main()
