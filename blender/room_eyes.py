"""Eyes in the lit room at which walks are compared with Cycles, as a path of Rilievo's.

    blender -b LIT.blend --python blender/room_eyes.py -- COUNT SEED PATH.json

Eyes stand anywhere in both rooms, at the height of people's, at least 0.3 m from every surface. Each looks at
something that is in sight, in turn: the window, the mirror, the floor, the table and its chairs, the doorway, the bed.
"""

import json
import random
import sys

import bpy
from mathutils import Vector

CLEAR = 0.3
# Rilievo's axes: y up. Something to look at, and the room from whose x it is looked at.
LIVING, BEDROOM = (0.4, 5.6), (6.4, 10.6)
TARGETS = ((LIVING, (3.0, 1.5, 0.0)), (LIVING, (5.9, 1.3, 1.2)), (LIVING, (2.6, 0.0, 2.5)), (LIVING, (4.6, 0.6, 3.6)),
           (LIVING, (6.5, 1.2, 2.5)), (BEDROOM, (8.6, 0.5, 1.3)), (BEDROOM, (5.5, 1.2, 2.5)), (LIVING, (1.5, 0.6, 1.2)))


def in_blender(place):
    return Vector((place[0], -place[2], place[1]))


def is_clear(scene, graph, eye):
    """No surface within CLEAR, in 26 directions."""
    for i in range(27):
        way = Vector((i % 3 - 1, i // 3 % 3 - 1, i // 9 - 1))
        if way.length > 0 and scene.ray_cast(graph, eye, way.normalized(), distance=CLEAR)[0]:
            return False
    return True


def in_sight(scene, graph, eye, target):
    """Nothing stands in the nearer half of the way."""
    way = target - eye
    return not scene.ray_cast(graph, eye, way.normalized(), distance=way.length / 2)[0]


def main():
    count, seed, path = sys.argv[sys.argv.index("--") + 1:]
    scene, graph = bpy.context.scene, bpy.context.evaluated_depsgraph_get()
    chance = random.Random(int(seed))
    keys = []
    while len(keys) < int(count):
        room, target = TARGETS[len(keys) % len(TARGETS)]
        eye = (round(chance.uniform(*room), 3), round(chance.uniform(1.4, 1.9), 3), round(chance.uniform(0.4, 4.6), 3))
        at = in_blender(eye)
        if (at - in_blender(target)).length < 1 or not is_clear(scene, graph, at):
            continue
        if in_sight(scene, graph, at, in_blender(target)):
            keys.append({"time": len(keys) / 60, "eye": eye, "target": target, "vertical_fov": 1.0})
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"schema": "rilievo-path-1", "z_near": 0.05, "z_far": 100, "keys": keys}, file, indent=1)


main()
