#!/usr/bin/env python3
"""Prints a scene of bodies on joints.

    python3 scenes/generators/joined.py dumbbells > dumbbells.json

dumbbells   1,000 pairs of balls on fixed joints that rain between four walls
chain       200 balls on ball joints that hang in a line and are hit from the side
arc         1,000 rods of 3 cm on ball joints between two hooks, on an arc from which they swing
cables      a flat net of 16 x 16 knots that hangs from its corners, with 1 kg on a cable at its middle
rods        the same of distances
springs     the same of stiff springs
slack       a net of cables that are a tenth longer than their knots are apart, thrown up
catch       a ball that falls into a net of cables which is held at its rim
limits      30 links that stick out from a wall and sink until each lies against the limit of its hinge
motors      the same, held by motors of 1,000 N m
"""
import json
import math
import random
import sys


def dumbbells(count=1000):
    random.seed(3)
    walls = [((0, 0, 1), (0, 0, 0)), ((1, 0, 0), (0, 0, 0)), ((-1, 0, 0), (1, 0, 0)),
             ((0, 1, 0), (0, 0, 0)), ((0, -1, 0), (0, 1, 0))]
    bodies = [{"shape": "half_space", "normal": normal, "point": point} for normal, point in walls]
    joints = []
    for k in range(count):
        x, y, z = 0.09 + 0.13 * (k % 7), 0.07 + 0.1 * (k // 7 % 9), 0.1 + 0.1 * (k // 63)
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


def arc(count=1000, length=0.03, half_angle=1):
    angle = 2 * half_angle / count
    radius = 0.5 * length / math.sin(angle / 2)

    def at(k):
        turn = angle * k - half_angle
        return [radius * math.sin(turn), 0, -radius * math.cos(turn)]

    bodies = [{"shape": "box", "size": [length, 0.008, 0.008], "mass": 0.01,
               "position": [0.5 * (a + b) for a, b in zip(at(k), at(k + 1))],
               "rotation_deg": {"axis": [0, 1, 0], "angle": math.degrees(half_angle - angle * (k + 0.5))}}
              for k in range(count)]
    joints = [{"type": "ball", "bodies": ["world" if k == 0 else k - 1, "world" if k == count else k], "anchor": at(k)}
              for k in range(count + 1)]
    return {"name": "arc", "precision": "double", "time_step": 1e-3, "duration": 10, "solver": {"max_iterations": 4000},
            "bodies": bodies, "joints": joints}


def net(kind, knots=16, length=None, rim=False, velocity=0, duration=0.2):
    space = 0.1
    bodies, joints = [], []

    def at(i, j):
        return [space * i, space * j, 0]

    def line(a, b):
        joint = {"type": kind, "bodies": [a[0] * knots + a[1], b[0] * knots + b[1]], "anchors": [at(*a), at(*b)]}
        if length:
            joint["length"] = length
        if kind == "spring":
            joint.update(stiffness=2e5, damping=0.2)
        joints.append(joint)

    for i in range(knots):
        for j in range(knots):
            bodies.append({"shape": "sphere", "radius": 0.002, "mass": 0.02, "position": at(i, j),
                           "velocity": [0, 0, velocity]})
            if i > 0:
                line((i - 1, j), (i, j))
            if j > 0:
                line((i, j - 1), (i, j))
            ends = (i in (0, knots - 1)) + (j in (0, knots - 1))
            if ends > (0 if rim else 1):
                joints.append({"type": "ball", "bodies": ["world", i * knots + j], "anchor": at(i, j)})
    return {"precision": "double", "time_step": 1e-3, "duration": duration, "bodies": bodies, "joints": joints}


def weighted(kind):
    scene = net(kind)
    scene["bodies"].append({"shape": "sphere", "radius": 0.05, "mass": 1, "position": [0.75, 0.75, -0.3]})
    scene["joints"].append({"type": "cable", "bodies": [7 * 16 + 7, 256], "anchors": [[0.7, 0.7, 0], [0.75, 0.75, -0.25]]})
    return {"name": kind, **scene}


def slack():
    return {"name": "slack", **net("cable", length=0.11, velocity=1, duration=0.6)}


def catch():
    scene = net("cable", knots=12, length=0.102, rim=True, duration=0.4)
    scene["bodies"].append({"shape": "sphere", "radius": 0.15, "mass": 1, "position": [0.55, 0.55, 0.2],
                            "velocity": [0, 0, -3]})
    return {"name": "catch", **scene}


def cantilever(**drive):
    bodies, joints = [], []
    for k in range(30):
        bodies.append({"shape": "box", "size": [0.1, 0.02, 0.02], "mass": 0.05, "position": [0.1 * k + 0.05, 0, 0]})
        joints.append({"type": "hinge", "bodies": ["world" if k == 0 else k - 1, k], "anchor": [0.1 * k, 0, 0],
                       "axis": [0, 1, 0], **drive})
    return {"name": "cantilever", "precision": "double", "time_step": 1e-3, "duration": 1, "bodies": bodies,
            "joints": joints}


scenes = {"dumbbells": dumbbells, "chain": chain, "arc": arc, "cables": lambda: weighted("cable"),
          "rods": lambda: weighted("distance"), "springs": lambda: weighted("spring"), "slack": slack, "catch": catch,
          "limits": lambda: cantilever(limits=[-0.05, 0.05]),
          "motors": lambda: cantilever(motor={"speed": 0, "max_force": 1000})}
if len(sys.argv) != 2 or sys.argv[1] not in scenes:
    sys.exit(__doc__)
scene = scenes[sys.argv[1]]()
scene["output"] = {"picture": False}
print(json.dumps(scene, indent=1))
