"""Frames of a .blend by Cycles, from the eyes of a camera path: what walks are compared with.

    blender -b SCENE.blend --python blender/cycles_frames.py -- PATH.json FOLDER WIDTH HEIGHT SAMPLES

PATH.json is a path of Rilievo's (rilievo-path-1): a frame for each of its keys. Frames are PNG, as Rilievo's
are: linear light, cut off at 1, as sRGB. Frames that are there are kept: started again, it goes on.
"""

import json
import os
import sys

import bpy
from mathutils import Vector


def main():
    path, folder, width, height, samples = sys.argv[sys.argv.index("--") + 1:]
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = int(samples)
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    # Other noise than that of the pictures, and of frames with other samples.
    scene.cycles.seed = 1000 + int(samples)
    scene.render.resolution_x, scene.render.resolution_y = int(width), int(height)
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = True
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.dither_intensity = 0
    camera = bpy.data.objects.new("frames", bpy.data.cameras.new("frames"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.data.sensor_fit = "VERTICAL"
    camera.data.clip_start = 0.01
    with open(path, encoding="utf-8") as file:
        keys = json.load(file)["keys"]
    for i, key in enumerate(keys):
        in_blender = [Vector((p[0], -p[2], p[1])) for p in (key["eye"], key["target"])]
        camera.location = in_blender[0]
        camera.rotation_euler = (in_blender[1] - in_blender[0]).to_track_quat("-Z", "Y").to_euler()
        camera.data.angle = key["vertical_fov"]
        frame, part = (os.path.join(folder, f"{name}frame_{i:05}.png") for name in ("", "part_"))
        if os.path.exists(frame):
            continue
        scene.render.filepath = part
        bpy.ops.render.render(write_still=True)
        os.rename(part, frame)


main()
