#!/usr/bin/env python3
"""Writes a ring wall of bricks that lie on each other without mortar, each over the joint of two: a scene and a table of its
bricks.

    python3 scenes/generators/ring.py --bricks 110000 ring.json

The bricks are cubes of 1 m. With --ball, a ball is shot at the wall from the inside.
"""
import argparse
import json
import math
from pathlib import Path


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path, help="file to write; the table lies beside it")
    parser.add_argument("--bricks", type=int, default=110000, help="about so many (default: %(default)s)")
    parser.add_argument("--courses", type=int, default=20, help="bricks above each other (default: %(default)s)")
    parser.add_argument("--ball", action="store_true", help="with a ball")
    options = parser.parse_args()

    per_course = round(options.bricks / options.courses)
    turn = 2 * math.pi / per_course
    joint = 0.02  # between corners of the inside, which come nearest to each other [m]
    radius = 0.5 + 0.5 / math.tan(turn / 2) + 0.5 * joint / math.sin(turn / 2)
    table = options.scene.with_suffix(".csv")
    with open(table, "w") as out:
        out.write("x,y,z,qw,qx,qy,qz\n")
        for course in range(options.courses):
            for k in range(per_course):
                angle = (k + 0.5 * (course % 2)) * turn
                out.write(f"{radius * math.cos(angle):.9g},{radius * math.sin(angle):.9g},{course + 0.5},"
                          f"{math.cos(angle / 2):.17g},0,0,{math.sin(angle / 2):.17g}\n")
    bodies = [{"shape": "half_space"}]
    if options.ball:
        bodies.append({"shape": "sphere", "radius": 4, "density": 4000, "group": "ball",
                       "position": [radius - 20, 0, 0.4 * options.courses], "velocity": [60, 0, 0]})
    scene = {
        "name": options.scene.stem,
        "time_step": 1 / 60,
        "duration": 10,
        "materials": {"default": {"friction": 0.5}},
        "bodies": bodies,
        "particles": [{"layout": "file", "file": table.name, "shape": "box", "size": [1, 1, 1], "density": 1000}],
    }
    with open(options.scene, "w") as out:
        json.dump(scene, out, indent=2)
        out.write("\n")
    print(f"{options.scene}, {table}: {per_course * options.courses} bricks in {options.courses} courses, "
          f"{radius:.1f} m from the middle")


if __name__ == "__main__":
    main()
