"""A furnished room for path tracers: tools/make_room's, with what no frame can afford.

    blender -b --factory-startup --python blender/light_room.py -- ROOM.glb LIT.blend LIT.glb

Cuts a window into the wall at z = 0, hangs a mirror, makes the floor glossy, and puts up lamps that have a
size; a pale sky stands outside. LIT.blend is for Cycles, LIT.glb has the same surfaces.
"""

import sys

import bpy
from mathutils import Vector

# Of the living room, in metres of the glTF file (y up): Blender's y is -z.
WINDOW = Vector((3.0, 0.0, 1.5)), Vector((1.6, 0.6, 1.2))  # centre and size, Blender's axes
MIRROR = Vector((5.93, -1.2, 1.3)), 0.9, 1.3  # place, width, height; on the wall between the rooms
LAMPS = ((2.7, -2.5, 2.5, 0.8, 60), (8.6, -2.5, 2.5, 0.8, 60), (0.5, -0.5, 2.2, 0.3, 15))  # x y z size watts


def principled(material):
    material.use_nodes = True
    return next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED").inputs


def box(name, center, size):
    bpy.ops.mesh.primitive_cube_add(size=1, location=center)
    made = bpy.context.object
    made.name, made.scale = name, size
    bpy.ops.object.transform_apply(location=False, scale=True)
    return made


def walls():
    """What reaches over a whole room and is flat: as (object, its lowest and highest corner)."""
    for thing in [o for o in bpy.data.objects if o.type == "MESH"]:
        corners = [thing.matrix_world @ Vector(c) for c in thing.bound_box]
        low = Vector([min(c[i] for c in corners) for i in range(3)])
        high = Vector([max(c[i] for c in corners) for i in range(3)])
        yield thing, low, high


def cut_window():
    hole = box("hole", *WINDOW)
    for thing, low, high in list(walls()):
        # The walls may be one mesh, or several; furniture is smaller.
        if thing is hole or max(high - low) < 5:
            continue
        cut = thing.modifiers.new("window", "BOOLEAN")
        cut.object, cut.operation, cut.solver = hole, "DIFFERENCE", "EXACT"
        bpy.context.view_layer.objects.active = thing
        bpy.ops.object.modifier_apply(modifier=cut.name)
    bpy.data.objects.remove(hole)
    # A frame, and a cross of thin bars.
    wood = bpy.data.materials.new("frame")
    principled(wood)["Base Color"].default_value = (0.8, 0.78, 0.72, 1)
    center, size = WINDOW
    for offset, extent in (((0, 0, 0), (0.03, 0.05, size.z)), ((0, 0, 0), (size.x, 0.05, 0.03)),
                           ((size.x / 2, 0, 0), (0.05, 0.12, size.z)), ((-size.x / 2, 0, 0), (0.05, 0.12, size.z)),
                           ((0, 0, size.z / 2), (size.x, 0.12, 0.05)), ((0, 0, -size.z / 2), (size.x, 0.12, 0.05))):
        bar = box("frame", center + Vector(offset) + Vector((0, 0.03, 0)), Vector(extent))
        bar.data.materials.append(wood)


def glossy_floor():
    bpy.ops.mesh.primitive_plane_add(size=1, location=(5.5, -2.5, 0.003))
    floor = bpy.context.object
    floor.name, floor.scale = "parquet", (11, 5, 1)
    bpy.ops.object.transform_apply(location=False, scale=True)
    wood = bpy.data.materials.new("parquet")
    inputs = principled(wood)
    inputs["Base Color"].default_value = (0.30, 0.17, 0.09, 1)
    inputs["Roughness"].default_value = 0.15
    floor.data.materials.append(wood)


def mirror():
    center, width, height = MIRROR
    glass = box("mirror", center, Vector((0.02, width, height)))
    silver = bpy.data.materials.new("silver")
    inputs = principled(silver)
    inputs["Base Color"].default_value = (0.95, 0.95, 0.95, 1)
    inputs["Metallic"].default_value, inputs["Roughness"].default_value = 1, 0
    glass.data.materials.append(silver)


def lamps():
    for x, y, z, size, watts in LAMPS:
        bpy.ops.object.light_add(type="AREA", location=(x, y, z))
        lamp = bpy.context.object.data
        lamp.size, lamp.energy = size, watts


def sky():
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"].inputs
    background["Color"].default_value, background["Strength"].default_value = (0.65, 0.8, 1, 1), 4
    bpy.context.scene.world = world


def main():
    room, blend, glb = sys.argv[sys.argv.index("--") + 1:]
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    import numpy
    if "bool" not in numpy.__dict__:
        numpy.bool = bool  # Debian 12's importer is older than its numpy
    bpy.ops.import_scene.gltf(filepath=room)
    glossy_floor()
    mirror()
    cut_window()
    lamps()
    sky()
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    bpy.ops.export_scene.gltf(filepath=glb, export_format="GLB", export_yup=True, export_apply=True)


main()
