#!/usr/bin/env python3
"""How solvers of stored contact problems fare on a GPU and on a CPU, from what `scree solve` wrote on both.

    bench/backends.py RESULTS.csv... --page FILE.md

The files hold rows of results.csv of any number of runs with one friction model and one limit, at least one with `--backend cuda` and
one with `--backend cpu`. Puts a table per file on the page and, with matplotlib, a picture NAME.png beside each NAME.csv.
"""

import argparse
import csv
import pathlib
import sys

from markdown import number, put_tables, table


class Runs:
    """Rows of one file by solver, backend and problem."""

    def __init__(self, file):
        self.rows = {}
        for row in csv.DictReader(file.open()):
            of_solver = self.rows.setdefault(row["solver"], {"cuda": {}, "cpu": {}})
            of_solver[row["backend"]][row["problem"]] = row

    def both(self, solver):
        """Pairs of rows (cuda, cpu) of the problems that ran on both."""
        cuda, cpu = (self.rows[solver][backend] for backend in ("cuda", "cpu"))
        return [(cuda[name], cpu[name]) for name in cuda if name in cpu]


def solved(row):
    return row["status"] == "converged"


def seconds(rows):
    return sum(float(row["seconds"]) for row in rows)


def microseconds(row):
    """Of one application."""
    return 1e6 * float(row["seconds"]) / int(row["applications"])


def solver_table(runs):
    lines = []
    for solver, backends in runs.rows.items():
        counts = [sum(map(solved, backends[b].values())) if backends[b] else "" for b in ("cuda", "cpu")]
        common = [pair for pair in runs.both(solver) if all(map(solved, pair))]
        times = [number(seconds(rows)) for rows in zip(*common)] or ["", ""]
        largest = max(runs.both(solver), key=lambda pair: int(pair[0]["contacts"]), default=None)
        costs = ["", ""]
        if largest:
            costs = [number(microseconds(row)) for row in largest]
        lines.append([f"`{solver}`", *counts, *times, *costs])
    header = ["solver", "solved on CUDA", "on the CPU", "seconds of those solved on both: CUDA", "CPU"]
    return table(header + ["microseconds an application, most contacts: CUDA", "CPU"], lines)


def draw(runs, path):
    try:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        sys.exit("bench/backends.py needs matplotlib for pictures (pip install matplotlib)")
    figure, axis = pyplot.subplots(figsize=(8, 4.5))
    for solver in runs.rows:
        pairs = [pair for pair in runs.both(solver) if int(pair[0]["contacts"]) > 1]
        pairs = [pair for pair in pairs if all(float(row["seconds"]) > 0 for row in pair)]
        pairs.sort(key=lambda pair: int(pair[0]["contacts"]))
        if not pairs:
            continue
        ratio = [microseconds(cpu) / microseconds(cuda) for cuda, cpu in pairs]
        axis.loglog([int(cuda["contacts"]) for cuda, _ in pairs], ratio, "o", alpha=0.7, markersize=5, label=solver)
    axis.axhline(1, color="0.4", linewidth=1)
    axis.set_xlabel("contacts")
    axis.set_ylabel("seconds an application: CPU over CUDA")
    axis.set_title("Above the line the GPU is faster", fontsize=9, loc="left")
    axis.grid(alpha=0.3)
    axis.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", type=pathlib.Path, nargs="+")
    parser.add_argument("--page", type=pathlib.Path, required=True)
    options = parser.parse_args()
    text = ""
    for file in options.files:
        runs = Runs(file)
        text += f"[{file.name}]({file.name})\n\n{solver_table(runs)}\n"
        draw(runs, file.with_suffix(".png"))
    put_tables(options.page, text)


if __name__ == "__main__":
    main()
