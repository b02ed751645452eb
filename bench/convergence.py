#!/usr/bin/env python3
"""Residual against passes, solver by solver, for one cold-started step of a settled pile.

    bench/convergence.py PROGRAM STATE.csv.gz [--out curves.csv] [--backend cpu] [--time-step 1e-3]

STATE is a table of spheres with columns x, y, z, vx, vy, vz and r = 0.05 m, density 2500 kg/m^3, mu = 0.5, in a
box with its corner at the origin whose edge is 0.1 m times the cube root of the number of spheres. Each point
of a curve is a run of its own with that many passes, so the program is measured as users run it. Recovery
speed is zero: the step neither heals nor bounces old overlaps.
"""
import argparse
import csv
import gzip
import json
import subprocess
import tempfile
from pathlib import Path

PASSES = [10, 20, 40, 60, 80, 100, 120, 140, 160, 180, 200, 250, 300, 400, 500, 600, 700, 800, 1000, 1200,
          1500, 2000, 3000]
QUALITY = 0.01  # residual relative to v*


def read_state(path):
    with gzip.open(path, "rt") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def write_scene(folder, rows, time_step):
    edge = round(0.1 * len(rows) ** (1 / 3), 6)
    columns = ["x", "y", "z", "vx", "vy", "vz"]
    with open(folder / "state.csv", "w") as out:
        print(",".join(columns + ["radius"]), file=out)
        for row in rows:
            print(",".join([row[c] for c in columns] + ["0.05"]), file=out)
    scene = {
        "name": "settled", "time_step": time_step, "duration": time_step,
        "materials": {"rock": {"friction": 0.5}},
        "bodies": [{"shape": "container", "min": [0, 0, 0], "max": [edge, edge, 2 * edge], "open": ["+z"]}],
        "particles": [{"layout": "file", "file": "state.csv", "density": 2500}],
        "stepping": {"max_recovery_speed": 0},
    }
    (folder / "settled.json").write_text(json.dumps(scene))
    return folder / "settled.json"


def point(program, scene, solver, passes, backend):
    settings = [f"solver.name={solver}", f"solver.max_iterations={passes}", "solver.stop=fixed",
                "solver.check_every=10", "solver.warm_start=false"]
    command = [program, "bench", str(scene), "--warmup", "0", "--steps", "1", "--json", "--backend", backend]
    for setting in settings:
        command += ["--set", setting]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("state", type=Path)
    parser.add_argument("--out", default="curves.csv")
    parser.add_argument("--backend", default="cpu")
    parser.add_argument("--time-step", type=float, default=1e-3)
    parser.add_argument("--solvers", nargs="+", default=["apgd", "gauss_seidel_colored", "jacobi"])
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name, open(options.out, "w") as out:
        scene = write_scene(Path(name), read_state(options.state), options.time_step)
        print("solver,passes,residual_rms_m_per_s,residual_relative,contacts,solve_ms", file=out)
        for solver in options.solvers:
            reached = None
            for passes in PASSES:
                result = point(options.program, scene, solver, passes, options.backend)
                relative = result["residual_relative"]
                print(solver, passes, result["residual_rms_m_per_s"], relative, round(result["contacts"]),
                      result["ms"]["solve"]["median"], sep=",", file=out)
                if relative <= QUALITY:
                    reached = passes
                    break
            print(f"{solver}: quality after {reached or 'more than ' + str(PASSES[-1])} passes")


if __name__ == "__main__":
    main()
