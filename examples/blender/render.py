#!/usr/bin/python3
"""Blender's Cycles as a renderer for Rilievo: the program behind exec:examples/blender/render.py

    render.py [FILE]      FILE: a .blend, .glb or .gltf; otherwise a small scene of its own

Started by Rilievo, it starts Blender without a window, and Blender runs this file again. Requests come
as lines of JSON on the standard input, answers leave on the standard output; what Blender itself prints
goes to the standard error. rilievo/capture/shaders/exec_source.h has the protocol.

FILE may also come in RILIEVO_BLENDER_FILE; RILIEVO_BLENDER_SAMPLES replaces the samples that are asked for.
"""

import ctypes
import json
import os
import sys

ANSWERS = "RILIEVO_BLENDER_ANSWERS"  # the descriptor that Rilievo reads


def end_with_parent():
    """A bake that is killed leaves no Blender behind that renders for nobody (Linux)."""
    SIGKILL, PR_SET_PDEATHSIG = 9, 1
    try:
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, SIGKILL)
    except (OSError, AttributeError):
        pass


def start_blender():
    end_with_parent()
    answers = os.dup(1)
    os.set_inheritable(answers, True)
    os.dup2(2, 1)
    os.environ[ANSWERS] = str(answers)
    blender = os.environ.get("RILIEVO_BLENDER", "blender")
    os.execvp(blender, [blender, "--background", "--factory-startup", "--python-exit-code", "1",
                       "--python", os.path.abspath(__file__), "--", *sys.argv[1:]])


if ANSWERS not in os.environ:
    start_blender()

import bpy  # noqa: E402
from mathutils import Matrix, Vector  # noqa: E402

# Rilievo's y is up, Blender's z.
BLENDER_FROM_RILIEVO = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))


def material(name, color, roughness, metallic=0.0):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    inputs = made.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*color, 1)
    inputs["Roughness"].default_value = roughness
    inputs["Metallic"].default_value = metallic
    return made


def own_scene():
    """Glossy bodies on a floor, lit by a large lamp: soft shadows and blurred reflections."""
    bpy.ops.mesh.primitive_plane_add(size=6, location=(0, 0, 0))
    bpy.context.object.data.materials.append(material("floor", (0.6, 0.6, 0.55), 0.3))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.7, location=(-0.8, 0.2, 0.7))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material("gold", (0.9, 0.65, 0.25), 0.15, 1.0))
    bpy.ops.mesh.primitive_torus_add(major_radius=0.6, minor_radius=0.22, location=(0.9, -0.3, 0.22))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material("red", (0.7, 0.08, 0.06), 0.25))
    bpy.ops.mesh.primitive_cube_add(size=0.9, location=(0.5, 1.2, 0.45), rotation=(0, 0, 0.5))
    bpy.context.object.data.materials.append(material("blue", (0.1, 0.25, 0.6), 0.5))
    bpy.ops.object.light_add(type="AREA", location=(2, -2, 4))
    lamp = bpy.context.object
    lamp.data.size = 2
    lamp.data.energy = 250
    lamp.rotation_euler = (Vector((0, 0, 0)) - lamp.location).to_track_quat("-Z", "Y").to_euler()


def load(path):
    if path.endswith(".blend"):
        bpy.ops.wm.open_mainfile(filepath=path)
        return
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    if path:
        import numpy
        if not hasattr(numpy, "bool"):
            numpy.bool = bool  # Debian 12's importer is older than its numpy
        bpy.ops.import_scene.gltf(filepath=path)
    else:
        own_scene()
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.6, 0.8, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.5
    bpy.context.scene.world = world


def prepare():
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.use_denoising = False
    scene.cycles.seed = 0
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.use_border = False
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = True
    scene.view_layers[0].use_pass_z = True
    image = scene.render.image_settings
    image.file_format = "OPEN_EXR"
    image.color_mode = "RGBA"
    image.color_depth = "32"
    image.exr_codec = "ZIP"
    image.use_zbuffer = True
    camera = bpy.data.objects.new("rilievo", bpy.data.cameras.new("rilievo"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def bounds():
    corners = [BLENDER_FROM_RILIEVO.inverted() @ thing.matrix_world @ Vector(corner)
               for thing in bpy.context.scene.objects if thing.type == "MESH" for corner in thing.bound_box]
    if not corners:
        raise RuntimeError("the scene has no meshes")
    return [[min(c[i] for c in corners) for i in range(3)], [max(c[i] for c in corners) for i in range(3)]]


def show_only(scene, names):
    """These objects alone are seen by the camera; None: as the file has it. Shadows and reflections are all there."""
    for thing in scene.objects:
        if thing.type in {"CAMERA", "LIGHT"}:
            continue
        if "rilievo_seen" not in thing:
            thing["rilievo_seen"] = thing.visible_camera
        thing.visible_camera = bool(thing["rilievo_seen"]) and (names is None or thing.name in names)
    missing = set(names or ()) - {thing.name for thing in scene.objects}
    if missing:
        raise RuntimeError("there is no object named " + ", ".join(sorted(missing)))


def set_camera(scene, view):
    left, right, bottom, top = view["window"]
    width, height = right - left, top - bottom
    camera = scene.camera
    columns = [view["world_from_eye"][4 * i:4 * i + 4] for i in range(4)]
    camera.matrix_world = BLENDER_FROM_RILIEVO @ Matrix(columns).transposed()
    lens = camera.data
    lens.sensor_fit = "HORIZONTAL"
    if view["projection"] == "parallel":
        lens.type = "ORTHO"
        lens.ortho_scale = width
    else:
        lens.type = "PERSP"
        lens.sensor_width = 36
        lens.lens = 36 / width
    lens.shift_x = (left + right) / 2 / width
    lens.shift_y = (bottom + top) / 2 / width
    lens.clip_start, lens.clip_end = view["z_near"], view["z_far"]
    scene.render.resolution_x, scene.render.resolution_y = view["width"], view["height"]
    # How much higher than wide a texel is.
    aspect = height / view["height"] / (width / view["width"])
    scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = max(1, 1 / aspect), max(1, aspect)


def render(scene, request):
    set_camera(scene, request["camera"])
    show_only(scene, request.get("objects"))
    scene.render.film_transparent = not request.get("sky", False)
    scene.cycles.use_adaptive_sampling = "noise" in request
    scene.cycles.adaptive_threshold = request.get("noise", 0)
    scene.cycles.samples = int(os.environ.get("RILIEVO_BLENDER_SAMPLES", request["samples"]))
    scene.render.filepath = request["file"]
    scene.render.use_file_extension = False
    bpy.ops.render.render(write_still=True)


def main():
    answers = os.fdopen(int(os.environ[ANSWERS]), "w", buffering=1)
    given = sys.argv[sys.argv.index("--") + 1:]
    load(given[0] if given else os.environ.get("RILIEVO_BLENDER_FILE", ""))
    scene = prepare()
    for line in sys.stdin:
        request = json.loads(line)
        answer = {"id": request["id"]}
        try:
            if request["request"] == "bounds":
                answer["bounds"] = bounds()
            else:
                render(scene, request)
                answer["done"] = True
        except Exception as fault:  # whatever it is, Rilievo shall hear of it
            answer["error"] = str(fault)
        print(json.dumps(answer), file=answers)


main()
