#!/usr/bin/env python3
"""Solvers of the convex model on the piles of J. Kleinert (2015): velocity error against iterations.

    bench/kleinert_curves.py --piles TABLE.csv... --out DIR [--page FILE.md] [--scree PROGRAM] [--iterations 5000] [--seconds S]

Makes the problems with bench/kleinert.py, with and without rotations, runs the solvers on each against the velocities of a
reference, and puts tables into the page: error after k iterations, iterations to an error, objective. The reference is the
interior point method up to 5000 contacts; beyond, where its factors fill the memory, a run of `apgd` to 1e-13. Needs h5py and numpy.
"""

import argparse
import pathlib
import subprocess
import sys

import h5py

from curves import at, reached, solve
from markdown import number, put_tables, table

SOLVERS = ["apgd", "apgd_plain", "spg", "gauss_seidel", "jacobi"]
COUNTS = [10, 50, 100, 200, 500, 1000, 2000, 5000]
LEVELS = [1e-2, 1e-3, 1e-4, 1e-6]


def problem_of(options, pile, rotations):
    folder = options.out / (pile.stem + ("" if rotations else "_no_rotations"))
    command = [sys.executable, str(pathlib.Path(__file__).parent / "kleinert.py"), str(pile), "--out", str(folder)]
    command += ["--scree", str(options.scree)] + ([] if rotations else ["--no-rotations"])
    subprocess.run(command, check=True)
    return folder / "problem.hdf5", folder / "solve"


def section(title, runs):
    reference = runs[0]["reference"]
    text = f"## {title}\n\nf* = {reference['objective']:.12e} J by `{reference['solver']}`, residual {reference['residual']:.0e}.\n\n"
    text += table(
        ["e after k iterations"] + [str(k) for k in COUNTS],
        [[f"`{run['solver']}`"] + [number(at(run["curve"], k, "e")) for k in COUNTS] for run in runs],
    )
    rows = []
    for run in runs:
        points = [reached(run["curve"], "e", level) for level in LEVELS]
        cells = ["-" if p is None else f"{p['iteration']:.0f} / {p['applications']:.0f}" for p in points]
        last = run["curve"][-1]
        gap = (run["objective"] - reference["objective"]) / abs(reference["objective"])
        rows.append([f"`{run['solver']}`", *cells, f"{last['iteration']:.0f}", number(last["e"]), number(gap)])
    header = (
        ["iterations / products with W to e ="]
        + [number(x) for x in LEVELS]
        + ["iterations done", "e then", "(f - f*) / \\|f*\\|"]
    )
    return text + "\n" + table(header, rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--piles", type=pathlib.Path, nargs="+", required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--page", type=pathlib.Path, help="page that gets the tables (default: DIR/kleinert.md)")
    parser.add_argument("--scree", default="build/release/bin/scree")
    parser.add_argument("--iterations", type=int, default=5000)
    parser.add_argument("--seconds", type=float, default=100, help="limit per solver")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    text = ""
    for pile in options.piles:
        for rotations in (True, False):
            problem, out = problem_of(options, pile, rotations)
            with h5py.File(problem) as file:
                contacts = len(file["contact/mu"])
            reference = "interior_point" if contacts <= 5000 else "apgd"
            arguments = ["--model", "convex", "--reference", reference, "--tolerance", "1e-13", "--check-every", "10"]
            arguments += ["--max-iterations", options.iterations, "--max-seconds", options.seconds]
            runs = solve(options.scree, problem, SOLVERS, out, *arguments)
            name = f"{pile.stem}, {contacts} contacts, {'with' if rotations else 'without'} rotations"
            text += section(name, runs) + "\n"
    put_tables(options.page or options.out / "kleinert.md", text)
    print(text)


if __name__ == "__main__":
    main()
