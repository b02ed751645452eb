#!/usr/bin/env python3
"""Prints a scene of bodies on joints that bounce.

    python3 scenes/generators/joined.py dumbbells > dumbbells.json

dumbbells   1,000 pairs of balls on fixed joints that rain between four walls
chain       200 balls on ball joints that hang in a line and are hit from the side
"""
import json
import random
import sys


def dumbbells(count=1000):
    random.seed(3)
    walls = [((0, 0, 1), (0, 0, 0)), ((1, 0, 0), (0, 0, 0)), ((-1, 0, 0), (1, 0, 0)),
             ((0, 1, 0), (0, 0, 0)), ((0, -1, 0), (0, 1, 0))]
    bodies = [{"shape": "half_space", "normal": normal, "point": point} for normal, point in walls]
    joints = []
    for k in range(count):
        x, y, z = 0.1 + 0.108 * (k % 8), 0.07 + 0.1 * (k // 8 % 9), 0.1 + 0.1 * (k // 72)
        first = len(bodies)
        for side in (-0.03, 0.03):
            bodies.append({"shape": "sphere", "radius": 0.03, "density": 1000, "position": [x + side, y, z],
                           "velocity": [random.uniform(-1, 1), random.uniform(-1, 1), -1]})
        joints.append({"type": "fixed", "bodies": [first, first + 1], "anchor": [x, y, z]})
    return {"name": "dumbbells", "time_step": 1e-3, "duration": 0.6,
            "materials": {"default": {"friction": 0.5, "restitution": 0.3}}, "bodies": bodies, "joints": joints}


def chain(count=200):
    bodies, joints = [], []
    for k in range(count):
        bodies.append({"shape": "sphere", "radius": 0.02, "density": 7800, "position": [0, 0, -0.05 * (k + 1)]})
        joints.append({"type": "ball", "bodies": ["world" if k == 0 else k - 1, k], "anchor": [0, 0, -0.05 * k]})
    bodies.append({"shape": "sphere", "radius": 0.1, "density": 2000, "velocity": [6, 0, 0],
                   "position": [-0.141, 0.005, -0.03 * count]})
    return {"name": "chain", "precision": "double", "time_step": 1e-3, "duration": 0.04,
            "materials": {"default": {"friction": 0.3, "restitution": 0.7}}, "bodies": bodies, "joints": joints}


scenes = {"dumbbells": dumbbells, "chain": chain}
if len(sys.argv) != 2 or sys.argv[1] not in scenes:
    sys.exit(__doc__)
scene = scenes[sys.argv[1]]()
scene["output"] = {"picture": False}
print(json.dumps(scene, indent=1))
