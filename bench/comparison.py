#!/usr/bin/env python3
"""APGD, Gauss-Seidel and Jacobi on settled beds of growing size and depth: the comparison of Mazhar et al. (ACM TOG 34(3), 2015).

    bench/comparison.py run --out DIR [--scree PROGRAM] [--backend cpu|cuda] [--bodies N,N,...] [--depths L,L,...] [--limit S]
    bench/comparison.py show FILE.json... --page FILE.md

`run` lets `scree bench solvers` solve one step of each bed to eight residuals, cold and warm, and writes BACKEND_sizes.json (20
layers) and BACKEND_depths.json (bodies of the middle size). `show` turns such files of any number of machines into tables on the
page, and into a CSV file and pictures of the curves beside it. `show` needs matplotlib for the pictures.
"""

import argparse
import csv
import json
import math
import pathlib
import subprocess
import sys

from markdown import number, put_tables, table

LEVELS = [3e-1, 1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4]  # of v*
SHOWN = [1e-1, 1e-2, 1e-3, 1e-4]
BODIES = {
    "cpu": [370, 3300, 32000],
    "cuda": [370, 3300, 32000, 320000],
}  # about 1e3, 1e4, 1e5, 1e6 contacts in 20 layers
DEPTHS = [5, 80]
COLORS = {"apgd": "C0", "gauss_seidel": "C1", "gauss_seidel_colored": "C3", "jacobi": "C2"}


def run(options):
    options.out.mkdir(parents=True, exist_ok=True)
    bodies = options.bodies or BODIES[options.backend]
    middle = bodies[len(bodies) // 2] if options.backend == "cpu" else bodies[-1]
    for name, sizes, layers in (("sizes", bodies, [20]), ("depths", [middle], options.depths or DEPTHS)):
        command = [options.scree, "bench", "solvers", "--backend", options.backend, "--limit", options.limit]
        command += ["--sizes", ",".join(map(str, sizes)), "--layers", ",".join(map(str, layers))]
        command += ["--levels", ",".join(map(str, LEVELS)), "--json", options.out / f"{options.backend}_{name}.json"]
        command += ["--threads", options.threads] if options.threads else []
        command += ["--precision", options.precision] if options.precision else []
        subprocess.run(list(map(str, command)), check=True)


def rows_of(files):
    rows = []
    for file in files:
        record = json.loads(file.read_text())
        machine = {k: record[k] for k in ("device", "backend", "precision", "threads", "commit", "limit_s")}
        rows += [{**machine, **result} for result in record["results"]]
    return rows


def groups_of(rows, *keys):
    """Rows by the values of keys, in the order of their first rows."""
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[k] for k in keys), []).append(row)
    return groups


def reach(rows, level, key):
    for row in rows:
        if row["level"] == level:
            return row[key] if row["reached"] else None
    return None


def bed_name(row):
    return f"{row['contacts']:,} contacts, {row['bodies']:,} bodies, {row['layers']} layers"


def size_tables(rows):
    text = ""
    for (device, backend, precision), of_machine in groups_of(rows, "device", "backend", "precision").items():
        first = of_machine[0]
        text += f"## {device}, {backend}, {precision}, {first['threads']} threads, commit {first['commit']}\n\n"
        text += f"Applications / milliseconds of the solver to a residual; a dash: not within about {first['limit_s']:g} s.\n\n"
        for (start,), of_start in groups_of(of_machine, "start").items():
            lines = []
            for (_, layers), bed in groups_of(of_start, "bodies", "layers").items():
                for (solver,), of_solver in groups_of(bed, "solver").items():
                    cells = []
                    for level in SHOWN:
                        applications = reach(of_solver, level, "applications")
                        cells.append(
                            "-"
                            if applications is None
                            else f"{applications} / {number(reach(of_solver, level, 'solve_ms'))}"
                        )
                    lines.append([f"{bed[0]['contacts']:,}", layers, f"`{solver}`", *cells])
            text += f"### {start} start\n\n"
            text += table(["contacts", "layers", "solver"] + [f"{number(level)} v*" for level in SHOWN], lines) + "\n"
            text += growth(of_start) + ratios(of_start)
    return text


def growth(rows):
    """How applications to 1e-2 v* grow: exponents between the least and the largest bed of equal depth, or of equal size."""
    lines = []
    for (solver,), of_solver in groups_of(rows, "solver").items():
        cells = [f"`{solver}`"]
        for fixed, key, by in (("layers", "contacts", "contacts"), ("bodies", "layers", "layers")):
            best = None
            for group in groups_of(of_solver, fixed).values():
                points = [
                    (bed[0][by], reach(bed, 1e-2, "applications"))
                    for bed in groups_of(group, "bodies", "layers").values()
                ]
                points = sorted(p for p in points if p[1])
                if len(points) > 1 and (best is None or len(points) > len(best)):
                    best = points
            if best is None:
                cells.append("-")
            else:
                exponent = math.log(best[-1][1] / best[0][1]) / math.log(best[-1][0] / best[0][0])
                cells.append(f"{exponent:.2f} ({best[0][0]:,} to {best[-1][0]:,})")
        lines.append(cells)
    return table(["applications to 1e-2 v* grow like", "contacts to the power", "layers to the power"], lines) + "\n"


def ratios(rows):
    lines = []
    for bed in groups_of(rows, "bodies", "layers").values():
        solvers = {solver: of for (solver,), of in groups_of(bed, "solver").items()}
        for solver in solvers:
            if solver == "apgd" or "apgd" not in solvers:
                continue
            cells = []
            for level in SHOWN:
                times = [reach(solvers[name], level, "solve_ms") for name in (solver, "apgd")]
                cells.append(number(times[0] / times[1]) if all(times) else "-")
            lines.append([f"{bed[0]['contacts']:,}", bed[0]["layers"], f"`{solver}`", *cells])
    header = ["contacts", "layers", "time over that of `apgd`"] + [f"{number(level)} v*" for level in SHOWN]
    return table(header, lines) + "\n"


def draw(rows, path):
    try:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        sys.exit("bench/comparison.py show needs matplotlib for pictures (pip install matplotlib)")
    cold = [row for row in rows if row["start"] == "cold" and row["reached"]]
    beds = list(groups_of(cold, "device", "backend", "bodies", "layers").values())
    figure, axes = pyplot.subplots(len(beds), 2, figsize=(11, 3.3 * len(beds)), squeeze=False, sharey="row")
    for (by_work, by_time), bed in zip(axes, beds):
        for (solver,), points in groups_of(bed, "solver").items():
            residual = [p["residual_relative"] for p in points]
            for axis, key in ((by_work, "applications"), (by_time, "solve_ms")):
                axis.loglog([p[key] for p in points], residual, ".-", label=solver, color=COLORS[solver])
        by_work.set_title(f"{bed[0]['device']}, {bed[0]['precision']}: {bed_name(bed[0])}", fontsize=9, loc="left")
        by_work.set_xlabel("applications")
        by_time.set_xlabel("milliseconds")
        by_work.set_ylabel("residual / v*")
        for axis in (by_work, by_time):
            axis.grid(alpha=0.3)
    axes.flat[0].legend(fontsize=8)
    figure.suptitle("One step of a settled bed, cold start")
    figure.tight_layout(rect=(0, 0, 1, 0.99))
    figure.savefig(path, dpi=100)


def show(options):
    rows = rows_of(options.files)
    stem = options.page.with_suffix("")
    with stem.with_suffix(".csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, stem.with_suffix(".png"))
    put_tables(options.page, size_tables(rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    runner = commands.add_parser("run")
    runner.set_defaults(action=run)
    runner.add_argument("--out", type=pathlib.Path, required=True)
    runner.add_argument("--scree", default="build/release/bin/scree")
    runner.add_argument("--backend", choices=BODIES, default="cpu")
    runner.add_argument("--limit", type=float, default=5, help="seconds of a solve, about")
    runner.add_argument("--threads", type=int)
    runner.add_argument("--precision", choices=["float", "double"])
    numbers = lambda text: [int(float(x)) for x in text.split(",")]
    runner.add_argument("--bodies", type=numbers)
    runner.add_argument("--depths", type=numbers)
    shower = commands.add_parser("show")
    shower.set_defaults(action=show)
    shower.add_argument("files", type=pathlib.Path, nargs="+")
    shower.add_argument("--page", type=pathlib.Path, required=True)
    options = parser.parse_args()
    options.action(options)


if __name__ == "__main__":
    main()
