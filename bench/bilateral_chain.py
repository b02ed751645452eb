#!/usr/bin/env python3
"""Time and memory of `scree solve` on chains of joints with contacts, against their length.

    bench/bilateral_chain.py [--links N...] [--solvers NAMES] [--model convex|exact] [--steps N] [--page FILE.md] [--scree PROGRAM]

A chain of spheres lies on the ground in waves and moves sideways in places: ball joints hold neighbors, each link has a contact.
The contact problem of a step is written by `scree run --dump-problem` and solved by each solver alone, from zero.
"""

import argparse
import json
import math
import os
import pathlib
import resource
import subprocess
import tempfile

import programs
from markdown import number, put_tables, table


def chain(links, steps):
    bodies = [{"name": "floor", "shape": "half_space"}]
    joints = []
    x = y = turn = 0.0
    for k in range(links):
        speed = [0, 0.3 * math.sin(0.1 * k), -0.05]
        bodies.append(
            {"name": f"link {k}", "shape": "sphere", "radius": 0.02, "density": 2000, "position": [x, y, 0.02], "velocity": speed}
        )
        turn = 0.8 * math.sin(0.05 * k)
        middle = [x + 0.025 * math.cos(turn), y + 0.025 * math.sin(turn), 0.02]
        if k + 1 < links:
            joints.append({"type": "ball", "bodies": [f"link {k}", f"link {k + 1}"], "anchor": middle})
        x, y = 2 * middle[0] - x, 2 * middle[1] - y
    return {
        "name": "chain",
        "time_step": 1e-3,
        "duration": steps * 1e-3,
        "materials": {"default": {"friction": 0.4}},
        "bodies": bodies,
        "joints": joints,
        "solver": {"max_iterations": 50},
    }


def measured(command):
    """Output of a program, and the most memory it had [MB]."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    out = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{' '.join(command)} ended with {status}")
    return out, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--links", type=int, nargs="+", default=[1000, 2000, 5000, 10000])
    parser.add_argument("--solvers", default="auto,interior_point,proximal,newton,admm,apgd,nlgs")
    parser.add_argument("--model", default="convex")
    parser.add_argument("--steps", type=int, default=4)
    parser.add_argument("--tolerance", default="1e-8")
    parser.add_argument("--page", type=pathlib.Path)
    parser.add_argument("--scree", metavar="PROGRAM", help="default: that of the newest build")
    options = parser.parse_args()
    options.scree = programs.scree(options.scree)
    rows = []
    for links in options.links:
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "chain.json"
            scene.write_text(json.dumps(chain(links, options.steps)))
            run = [options.scree, "run", str(scene), "--backend", "cpu", "--precision", "double", "--steps", str(options.steps)]
            measured(run + ["--dump-problem", str(options.steps), "--quiet", "--out", folder + "/out"])
            problem = f"{folder}/out/problem_{options.steps}.hdf5"
            for solver in options.solvers.split(","):
                command = [options.scree, "solve", problem, "--json", "--model", options.model, "--solver", solver]
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                out, memory = measured(command + ["--tolerance", options.tolerance, "--max-seconds", "100"])
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                found = json.loads(out)["problems"][0]
                result = found["runs"][0]
                rows.append(
                    [
                        links - 1,
                        found["bilateral_rows"],
                        found["contacts"],
                        f"`{solver}`",
                        result["iterations"],
                        number(result["seconds"]),
                        number(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime),
                        f"{memory:.0f}",
                        number(result["residual"]),
                        result["status"],
                    ]
                )
                print(*rows[-1], flush=True)
    header = ["joints", "rows", "contacts", "solver", "iterations", "solve [s]", "whole program [CPU s]", "most memory [MB]", "residual", "status"]
    if options.page:
        put_tables(options.page, table(header, rows))


if __name__ == "__main__":
    main()
