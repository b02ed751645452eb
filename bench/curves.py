"""Runs scree solve on one stored problem and reads the curves it writes: shared by the scripts of the experiments.

Errors are e = |v - v*|_M / |v_free|_M over all bodies, from the kinetic energies of the difference (curves) and of the free
velocities (problem file). Needs h5py and numpy.
"""

import csv
import json
import math
import subprocess
import sys

try:
    import h5py
    import numpy as np
except ImportError:
    sys.exit("this script needs h5py and numpy (pip install h5py numpy)")


def free_energy(problem):
    """Kinetic energy of the bodies that can move, with their free velocities [J]. Problems of layout `radial`."""
    with h5py.File(problem) as file:
        count = file.attrs["free_count"]
        velocity = file["body/free_velocity"][:count]
        weights = np.column_stack(3 * [file["body/inv_mass"][:count]] + 3 * [file["body/inv_spin"][:count]])
    moves = weights > 0
    return 0.5 * float((velocity[moves] ** 2 / weights[moves]).sum())


def solve(program, problem, solvers, out, *more):
    """Runs the solvers and returns their records, each with its curve and the reference's record."""
    command = [
        str(program),
        "solve",
        str(problem),
        "--solver",
        ",".join(solvers),
        "--out",
        str(out),
        "--force",
        *map(str, more),
    ]
    subprocess.run(command, check=True)
    document = json.loads((out / "results.json").read_text())["problems"][0]
    energy = free_energy(problem)
    for run in document["runs"]:
        path = out / "curves" / f"{document['problem']}_{run['solver']}.csv"
        run["curve"] = read_curve(path, energy)
        run["reference"] = document.get("reference")
    return document["runs"]


def read_curve(path, energy):
    with path.open(newline="") as file:
        points = [{k: float(v) for k, v in row.items() if v} for row in csv.DictReader(file)]
    for point in points:
        if "kinetic_error_J" in point:
            point["e"] = math.sqrt(point["kinetic_error_J"] / energy)
    return points


def reached(curve, key, level):
    """The first point from which on `key` stays at or below the level, or None."""
    found = None
    for point in reversed(curve):
        if point[key] > level:
            break
        found = point
    return found


def at(curve, iteration, key):
    """Value at the last check up to an iteration that the curve reaches, or None."""
    if curve[-1]["iteration"] < iteration:
        return None
    return [point for point in curve if point["iteration"] <= iteration][-1][key]
