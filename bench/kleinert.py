#!/usr/bin/env python3
"""Contact problems of settled piles: makes one from a table of spheres, for solvers to be compared on.

    bench/kleinert.py TABLE.csv --out DIR [--scree PROGRAM] [--friction 0.4] [--no-rotations]

The table has the columns x, y, z, vx, vy, vz, radius, mass, as `scree` scenes take them; those of J. Kleinert's thesis (2015) are
in github.com/joergbrech/nonsmooth-granular-benchmarks. The problem is one step of 1 ms from rest under 10 m/s^2 on a floor at
z = 0, with all contacts of gaps up to 0.1 mm; gaps are then left out, so that W and v* alone decide. It goes to
DIR/problem.hdf5, ready for `scree solve`. Needs h5py.
"""
import argparse
import json
import pathlib
import subprocess
import sys

import programs


def scene(table, friction, rotations):
    particles = {"layout": "file", "file": str(table.resolve()), "density": 1650}
    if not rotations:
        particles["lock"] = ["rotation"]
    return {
        "name": table.stem,
        "gravity": [0, 0, -10],
        "duration": 1e-3,
        "time_step": 1e-3,
        "materials": {"default": {"friction": friction}},
        "bodies": [{"shape": "half_space", "normal": [0, 0, 1], "point": [0, 0, 0]}],
        "particles": [particles],
        "collision": {"envelope": 1e-4},
        "solver": {"max_iterations": 10},
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--scree", metavar="PROGRAM", help="default: that of the newest build")
    parser.add_argument("--friction", type=float, default=0.4)
    parser.add_argument("--no-rotations", action="store_true")
    options = parser.parse_args()
    options.scree = programs.scree(options.scree)
    try:
        import h5py
    except ImportError:
        sys.exit("bench/kleinert.py needs h5py (pip install h5py)")

    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / "scene.json"
    path.write_text(json.dumps(scene(options.table, options.friction, not options.no_rotations), indent=1))
    run = options.out / "run"
    subprocess.run(
        [options.scree, "run", str(path), "--backend", "cpu", "--precision", "double", "--steps", "1"]
        + ["--dump-problem", "1", "--out", str(run), "--force", "--quiet"],
        check=True,
    )
    problem = options.out / "problem.hdf5"
    problem.write_bytes((run / "problem_1.hdf5").read_bytes())
    with h5py.File(problem, "r+") as file:
        file["contact/bias"][...] = 0
        file["warm_start/impulse"][...] = 0
        print(f"{problem}: {len(file['contact/mu'])} contacts")


if __name__ == "__main__":
    main()
