#!/usr/bin/env python3
"""Solvers of the convex model on the piles of J. Kleinert (2015): velocity error against iterations, products and seconds.

    bench/kleinert_curves.py --piles TABLE.csv... --out DIR [--page FILE.md] [--scree PROGRAM] [--iterations 20000] [--seconds 30]

Makes the problems with bench/kleinert.py, with and without rotations, runs the solvers on each against the velocities of the
interior point method, and puts tables into the page: error after k iterations, iterations, products and seconds to an error, objective.
With matplotlib a picture of all curves goes beside the page, with the page's name. Needs h5py and numpy.
"""

import argparse
import pathlib
import subprocess
import sys

import programs
from curves import at, h5py, reached, solve
from markdown import number, put_tables, table

SOLVERS = ["apgd", "apgd_plain", "spg", "gauss_seidel", "jacobi"]
COUNTS = [10, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000]
LEVELS = [1e-2, 1e-3, 1e-4, 1e-6]


def problem_of(options, pile, rotations):
    folder = options.out / (pile.stem + ("" if rotations else "_no_rotations"))
    command = [sys.executable, str(pathlib.Path(__file__).parent / "kleinert.py"), str(pile), "--out", str(folder)]
    command += ["--scree", str(options.scree)] + ([] if rotations else ["--no-rotations"])
    subprocess.run(command, check=True)
    return folder / "problem.hdf5", folder / "solve"


def section(title, runs):
    reference = runs[0]["reference"]
    text = f"## {title}\n\nf* = {reference['objective']:.12e} J by `{reference['solver']}`, residual {reference['residual']:.1e}, "
    text += f"{reference['iterations']} iterations in {number(reference['seconds'])} s.\n\n"
    text += table(
        ["e after k iterations"] + [str(k) for k in COUNTS],
        [[f"`{run['solver']}`"] + [number(at(run["curve"], k, "e")) for k in COUNTS] for run in runs],
    )
    rows = []
    for run in runs:
        points = [reached(run["curve"], "e", level) for level in LEVELS]
        cells = [
            "-" if p is None else f"{p['iteration']:.0f} / {p['applications']:.0f} / {number(p['seconds'])}" for p in points
        ]
        last = run["curve"][-1]
        gap = (run["objective"] - reference["objective"]) / abs(reference["objective"])
        done = f"{last['iteration']:.0f} / {number(last['seconds'])}"
        rows.append([f"`{run['solver']}`", *cells, done, number(last["e"]), number(gap)])
    header = (
        ["iterations / products / seconds to e ="]
        + [number(x) for x in LEVELS]
        + ["iterations / seconds done", "e then", "(f - f*) / \\|f*\\|"]
    )
    return text + "\n" + table(header, rows)


def draw(sections, path):
    try:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        sys.exit("bench/kleinert_curves.py needs matplotlib for the picture (pip install matplotlib)")
    figure, axes = pyplot.subplots(len(sections), 3, figsize=(13, 3 * len(sections)), squeeze=False, sharex="col")
    columns = [("iteration", "e", "iterations"), ("seconds", "e", "seconds"), ("iteration", "residual", "iterations")]
    for row, (title, runs) in zip(axes, sections.items()):
        for axis, (x, y, _) in zip(row, columns):
            for run in runs:
                points = [p for p in run["curve"] if p["iteration"] > 0 and p[y] > 0]
                axis.loglog([p[x] for p in points], [p[y] for p in points], linewidth=1, label=run["solver"])
            axis.grid(alpha=0.3)
            axis.set_ylabel({"e": "velocity error e", "residual": "|r - P(r - v)| / |q|"}[y])
        row[0].set_title(title, fontsize=9, loc="left")
    for axis, (_, _, name) in zip(axes[-1], columns):
        axis.set_xlabel(name)
    axes[0][0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--piles", type=pathlib.Path, nargs="+", required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--page", type=pathlib.Path, help="page that gets the tables (default: DIR/kleinert.md)")
    parser.add_argument("--scree", metavar="PROGRAM", help="default: that of the newest build")
    parser.add_argument("--iterations", type=int, default=20000)
    parser.add_argument("--seconds", type=float, default=30, help="limit per solver")
    options = parser.parse_args()
    options.scree = programs.scree(options.scree)
    options.out.mkdir(parents=True, exist_ok=True)
    sections = {}
    for pile in options.piles:
        for rotations in (True, False):
            problem, out = problem_of(options, pile, rotations)
            with h5py.File(problem) as file:
                contacts = len(file["contact/mu"])
            arguments = ["--model", "convex", "--reference", "interior_point", "--tolerance", "1e-13", "--check-every", "10"]
            arguments += ["--max-iterations", options.iterations, "--max-seconds", options.seconds]
            name = f"{pile.stem}, {contacts} contacts, {'with' if rotations else 'without'} rotations"
            sections[name] = solve(options.scree, problem, SOLVERS, out, *arguments)
    page = options.page or options.out / "kleinert.md"
    text = "\n".join(section(name, runs) for name, runs in sections.items())
    put_tables(page, text)
    print(text)
    draw(sections, page.with_suffix(".png"))


if __name__ == "__main__":
    main()
