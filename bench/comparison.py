#!/usr/bin/env python3
"""APGD, Gauss-Seidel and Jacobi on settled beds of growing size and depth: the comparison of Mazhar et al. (ACM TOG 34(3), 2015).

    bench/comparison.py run --out DIR [--scree PROGRAM] [--backend cpu|cuda] [--bodies N,N,...] [--depths L,L,...] [--limit S]
    bench/comparison.py show FILE.json... --page FILE.md

`run` lets `scree bench solvers` solve one step of each bed to eight residuals, cold and warm, and writes BACKEND_sizes.json (20
layers) and BACKEND_depths.json (bodies of the middle size; on CUDA the largest). `show` turns such files of any number of machines into
tables on the page, and into a CSV file and a picture of the curves beside it. `show` needs matplotlib for the picture.
"""

import argparse
import csv
import itertools
import json
import math
import pathlib
import subprocess
import sys

import programs
from markdown import number, put_tables, table

LEVELS = [3e-1, 1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4]  # of v*
SHOWN = [1e-1, 1e-2, 1e-3, 1e-4]
BODIES = {
    "cpu": [370, 3300, 32000],
    "cuda": [370, 3300, 32000, 320000],
}  # about 1e3, 1e4, 1e5, 1e6 contacts in 20 layers
LAYERS = 20  # of the beds of growing size
DEPTHS = [5, 80]
COLORS = {"apgd": "C0", "gauss_seidel": "C1", "gauss_seidel_colored": "C3", "jacobi": "C2", "schwarz": "C4"}
STYLES = ["-", "--", ":", "-."]  # of machines


def run(options):
    program = programs.scree(options.scree)
    options.out.mkdir(parents=True, exist_ok=True)
    bodies = options.bodies or BODIES[options.backend]
    middle = bodies[len(bodies) // 2] if options.backend == "cpu" else bodies[-1]
    for name, sizes, layers in (("sizes", bodies, [LAYERS]), ("depths", [middle], options.depths or DEPTHS)):
        command = [program, "bench", "solvers", "--backend", options.backend, "--limit", options.limit]
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
        machine["machine"] = machine_name(machine)
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


def machine_name(row):
    threads = f", {row['threads']} thread{'s' if row['threads'] > 1 else ''}" if row["backend"] == "cpu" else ""
    return f"{row['device']}, {row['backend']}, {row['precision']}{threads}"


def size_tables(rows):
    text = ""
    for (_,), of_machine in groups_of(rows, "machine").items():
        first = of_machine[0]
        text += f"## {first['machine']}, commit {first['commit']}\n\n"
        text += "Applications / milliseconds of the solver to a residual; "
        text += f"a dash: not within about {first['limit_s']:g} s.\n\n"
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


def machine_table(rows):
    """What an application costs and what 1e-2 v* takes on each machine, on beds of growing size from a cold start."""
    rows = [row for row in rows if row["start"] == "cold" and row["layers"] == LAYERS]
    machines = [name for (name,) in groups_of(rows, "machine")]
    lines = []
    for (bodies,), bed in sorted(groups_of(rows, "bodies").items()):
        for (solver,), of_solver in groups_of(bed, "solver").items():
            by_machine = {name: of for (name,), of in groups_of(of_solver, "machine").items()}
            cells = []
            for name in machines:
                longest = max(by_machine.get(name, []), key=lambda row: row["applications"], default=None)
                if longest is None:
                    cells.append("")
                    continue
                microseconds = 1e3 * longest["solve_ms"] / longest["applications"]
                cells.append(f"{number(microseconds)} / {number(reach(by_machine[name], 1e-2, 'solve_ms'))}")
            lines.append([f"{bodies:,}", f"`{solver}`", *cells])
    text = "## By machine\n\nMicroseconds an application, of the longest solve / milliseconds to 1e-2 v*; "
    text += f"cold, {LAYERS} layers.\n\n"
    return text + table(["bodies", "solver", *machines], lines) + "\n"


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
    cold = [row for row in rows if row["start"] == "cold" and row["reached"] and row["applications"] > 0]
    styles = dict(zip((name for (name,) in groups_of(cold, "machine")), itertools.cycle(STYLES)))
    beds = [bed for _, bed in sorted(groups_of(cold, "bodies", "layers").items())]
    size = {"figsize": (11, 2.9 * len(beds)), "squeeze": False}
    figure, axes = pyplot.subplots(len(beds), 2, sharey=True, sharex="col", **size)
    for (by_work, by_time), bed in zip(axes, beds):
        for (machine, solver), points in groups_of(bed, "machine", "solver").items():
            residual = [p["residual_relative"] for p in points]
            for axis, key in ((by_work, "applications"), (by_time, "solve_ms")):
                axis.loglog([p[key] for p in points], residual, styles[machine], marker=".", color=COLORS[solver])
        name = f"{bed[0]['bodies']:,} bodies in {bed[0]['layers']} layers, {bed[0]['contacts']:,} contacts"
        by_work.set_title(f"Cold start, {name}", fontsize=9, loc="left")
        by_work.set_ylabel("residual / v*")
        for axis in (by_work, by_time):
            axis.grid(alpha=0.3)
    axes[-1][0].set_xlabel("applications")
    axes[-1][1].set_xlabel("milliseconds")
    line = pyplot.Line2D
    of_solvers = [line([], [], color=color, label=solver) for solver, color in COLORS.items()]
    of_machines = [line([], [], color="0.3", linestyle=style, label=name) for name, style in styles.items()]
    figure.legend(handles=of_solvers, loc="upper left", ncols=2, fontsize=8)
    figure.legend(handles=of_machines, loc="upper right", fontsize=8)
    figure.tight_layout(rect=(0, 0, 1, 1 - 0.7 / figure.get_figheight()))
    figure.savefig(path, dpi=90)


def show(options):
    rows = rows_of(options.files)
    stem = options.page.with_suffix("")
    with stem.with_suffix(".csv").open("w", newline="") as file:
        columns = [key for key in rows[0] if key != "machine"]  # which is made of others
        writer = csv.DictWriter(file, columns, lineterminator="\n", extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, stem.with_suffix(".png"))
    put_tables(options.page, machine_table(rows) + size_tables(rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    runner = commands.add_parser("run")
    runner.set_defaults(action=run)
    runner.add_argument("--out", type=pathlib.Path, required=True)
    runner.add_argument("--scree", metavar="PROGRAM", help="default: that of the newest build")
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
