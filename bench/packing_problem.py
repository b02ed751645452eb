#!/usr/bin/env python3
"""Makes the contact problem of 1702 contacts, mu = 0.8, after Preclik, Iglberger and Ruede (ECCOMAS 2009).

    bench/packing_problem.py --out DIR [--scree PROGRAM] [--contacts 1702]

700 spheres of 16 to 24 mm rain into a box of 0.2 m x 0.2 m and settle for 4 s under exact Coulomb friction. Nothing in that law
stops a loose sphere that rolls on, so all are halted once and settle again for 0.2 s; they must be slower than 1 mm/s then.
The problem is one more step of 1 ms, with all contacts up to the gap that gives the number asked for, and without the gaps
themselves. It goes to DIR/problem.hdf5. Needs h5py and numpy. bench/problems/packing_1702.hdf5 was made so; another compiler
or processor gives another packing, which is why it is kept.
"""

import argparse
import json
import pathlib
import subprocess
import sys

import programs

try:
    import h5py
    import numpy as np
except ImportError:
    sys.exit("bench/packing_problem.py needs h5py and numpy (pip install h5py numpy)")

SPHERES = 700
HALF_WIDTH = 0.1  # m, of the box


def scene(particles, duration, envelope=None):
    document = {
        "name": "packing",
        "seed": 1702,
        "time_step": 1e-3,
        "duration": duration,
        "materials": {"default": {"friction": 0.8}},
        "bodies": [
            {
                "shape": "container",
                "min": [-HALF_WIDTH, -HALF_WIDTH, 0],
                "max": [HALF_WIDTH, HALF_WIDTH, 0.8],
                "open": ["+z"],
            }
        ],
        "particles": [particles],
        "solver": {"model": "exact"},
        "output": {"picture": False},
    }
    if envelope is not None:
        document["collision"] = {"envelope": envelope}
    return document


def rain():
    return {
        "layout": "rain",
        "count": SPHERES,
        "radius": {"min": 0.008, "max": 0.012},
        "density": 2600,
        "velocity": [0, 0, -1],
        "region": {"min": [-0.09, -0.09, 0.4], "max": [0.09, 0.09, 0.43]},
        "spacing": 0.0251,
        "jitter": 1,
        "layers": 16,
        "interval": 0.05,
    }


def from_file(path):
    return {"layout": "file", "file": str(path.resolve()), "density": 2600}


def simulate(options, name, document, more=()):
    folder = options.out / name
    path = options.out / f"{name}.json"
    path.write_text(json.dumps(document, indent=1))
    command = [
        options.scree,
        "run",
        str(path),
        "--backend",
        "cpu",
        "--precision",
        "double",
        "--threads",
        "1",
        "--out",
        str(folder),
        "--force",
        "--quiet",
    ]
    subprocess.run(command + list(more), check=True)
    return folder


def state(checkpoint):
    with h5py.File(checkpoint) as file:
        return {name: file["body/" + name][()] for name in ("position", "velocity", "angular_velocity", "radius")}


def halt(bodies, path):
    lines = ["x,y,z,radius"]
    lines += [",".join(repr(float(v)) for v in [*p, r]) for p, r in zip(bodies["position"], bodies["radius"])]
    path.write_text("\n".join(lines) + "\n")
    return path


def dump(options, bodies, envelope):
    """The problem of one step with contacts up to a gap, without the gaps, and how many contacts it has."""
    run = simulate(options, "step", scene(from_file(bodies), 1e-3, envelope), ["--steps", "1", "--dump-problem", "1"])
    problem = options.out / "problem.hdf5"
    problem.write_bytes((run / "problem_1.hdf5").read_bytes())
    with h5py.File(problem, "r+") as file:
        file["contact/bias"][...] = 0
        file["warm_start/impulse"][...] = 0
        return problem, len(file["contact/mu"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--scree", metavar="PROGRAM", help="default: that of the newest build")
    parser.add_argument("--contacts", type=int, default=1702)
    options = parser.parse_args()
    options.scree = programs.scree(options.scree)
    options.out.mkdir(parents=True, exist_ok=True)

    settled = simulate(options, "settle", scene(rain(), 4))
    table = halt(state(settled / "checkpoint.h5"), options.out / "halted.csv")
    rest = simulate(options, "rest", scene(from_file(table), 0.2)) / "checkpoint.h5"
    speed = np.linalg.norm(state(rest)["velocity"], axis=1).max()
    if speed > 1e-3:
        sys.exit(f"not at rest: {speed} m/s")
    least, most = 0.0, 1e-3
    for _ in range(50):
        envelope = 0.5 * (least + most)
        problem, count = dump(options, rest, envelope)
        if count == options.contacts:
            print(f"{problem}: {count} contacts with gaps up to {envelope:.4g} m, fastest sphere {speed:.2g} m/s")
            return
        least, most = (envelope, most) if count < options.contacts else (least, envelope)
    sys.exit(f"no gap gives {options.contacts} contacts")


if __name__ == "__main__":
    main()
