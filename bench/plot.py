#!/usr/bin/env python3
"""Draws the results of scree bench as PNG files.

    bench/plot.py FILE.json... [--out DIR]

FILE is what `scree bench MODE --json FILE` wrote, of any mode and machine; files of the same mode are drawn in
one picture. The pictures go to DIR, by default docs/:

    bench_iteration.png   contact-iterations per second over bodies        (iteration)
    bench_steps.png       milliseconds a step over bodies                   (collision, step)
    bench_solvers.png     time to residual, solver by solver                (solvers)
    bench_memory.png      bytes a body over bodies                          (capacity)

Needs matplotlib, and nothing else beside Python 3.8.
"""
import argparse
import json
import sys
from collections import defaultdict
from pathlib import Path

try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
except ImportError:
    sys.exit("plot.py needs matplotlib, which is not installed: pip install matplotlib, "
             "or on Debian and Ubuntu apt install python3-matplotlib")


def read(path):
    try:
        document = json.loads(path.read_text())
        if not isinstance(document["results"], list) or not isinstance(document["benchmark"], str):
            raise TypeError
    except (OSError, ValueError) as error:
        sys.exit(f"{path}: cannot be read: {error}")
    except (KeyError, TypeError):
        sys.exit(f"{path}: is not a result of scree bench (written with --json FILE)")
    return document


def machine(document):
    return f"{document['device']}, {document['precision']}"


def curve(axes, points, label, **style):
    points = sorted(points)
    if points:
        axes.plot(*zip(*points), marker="o", markersize=4, label=label, **style)


def new_axes(title, x, y, count=1):
    figure, axes = pyplot.subplots(1, count, figsize=(7 * count, 4.8), squeeze=False, sharey=True)
    for each in axes[0]:
        each.set(title=title, xlabel=x, xscale="log", yscale="log")
        each.grid(True, which="both", linewidth=0.3)
    axes[0][0].set_ylabel(y)
    return figure, axes[0]


def draw_iteration(documents):
    figure, (axes,) = new_axes("Solver iterations on a settled bed", "bodies", "contact-iterations / s")
    rates, floors = defaultdict(list), defaultdict(list)
    for d in documents:
        for r in d["results"]:
            rates[machine(d)].append((r["bodies"], r["contact_iterations_per_s"]))
            if "least_bytes_per_iteration" in r:
                floor = d["copy_bandwidth_bytes_per_s"] * r["contacts"] / r["least_bytes_per_iteration"]
                floors[machine(d)].append((r["bodies"], floor))
    for name, points in rates.items():
        curve(axes, points, name)
        curve(axes, floors[name], f"{name}: least bytes at copy speed", linestyle=":")
    axes.set_yscale("linear")
    axes.set_ylim(0, 1.1 * axes.get_ylim()[1])
    return figure


def draw_steps(documents):
    figure, (axes,) = new_axes("Time of a step", "bodies", "ms, median")
    groups = defaultdict(list)
    for d in documents:
        for r in d["results"]:
            if d["benchmark"] == "collision":
                sizes = "1:10 spheres" if r["polydisperse"] else "equal spheres"
                label, stage = f"collision, {sizes}", "collision"
            else:
                label, stage = f"{r['scene']} to {r['stop']}, {r['solver']}", "total"
            groups[f"{label}; {machine(d)}"].append((r["bodies"], r["ms"][stage]["median"]))
    for label, points in groups.items():
        curve(axes, points, label)
    return figure


def draw_solvers(documents):
    cases = defaultdict(list)
    for d in documents:
        for r in d["results"]:
            cases[machine(d), r["bodies"], r["layers"]].append(r)
    figure, columns = new_axes("", "residual reached / v*", "solve, ms", len(cases))
    for axes, ((name, bodies, layers), results) in zip(columns, cases.items()):
        axes.set_title(f"{bodies} spheres in {layers} layers; {name}", fontsize=10)
        solvers = list(dict.fromkeys(r["solver"] for r in results))
        for start, line in (("warm", "-"), ("cold", "--")):
            for k, solver in enumerate(solvers):
                mine = [r for r in results if r["solver"] == solver and r["start"] == start]
                reached = [(r["level"], r["solve_ms"]) for r in mine if r["reached"]]
                curve(axes, reached, f"{solver}, {start}", color=f"C{k}", linestyle=line)
                ends = [(r["residual_relative"], r["solve_ms"]) for r in mine if not r["reached"]]
                if ends:  # where the time limit stopped it
                    axes.plot(*ends[0], marker="x", color=f"C{k}")
        axes.invert_xaxis()
    return figure


def draw_memory(documents):
    figure, (axes,) = new_axes("Memory", "bodies", "bytes a body")
    for d in documents:
        results = [r for r in d["results"] if r["fits"]]
        curve(axes, [(r["bodies"], r["memory_bytes_per_body"]) for r in results], f"held at the peak; {machine(d)}")
        curve(axes, [(r["bodies"], r["expected_memory_bytes"] / r["bodies"]) for r in results],
              f"expected; {machine(d)}", linestyle=":")
    axes.set_yscale("linear")
    axes.set_ylim(0, 1.1 * axes.get_ylim()[1])
    return figure


PICTURES = [("bench_iteration.png", ("iteration",), draw_iteration),
            ("bench_steps.png", ("collision", "step"), draw_steps),
            ("bench_solvers.png", ("solvers",), draw_solvers),
            ("bench_memory.png", ("capacity",), draw_memory)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE.json")
    parser.add_argument("--out", type=Path, metavar="DIR", default=Path(__file__).resolve().parent.parent / "docs")
    options = parser.parse_args()
    documents = [read(path) for path in options.files]
    options.out.mkdir(parents=True, exist_ok=True)
    written = 0
    for name, benchmarks, draw in PICTURES:
        mine = [d for d in documents if d["benchmark"] in benchmarks and d["results"]]
        if not mine:
            continue
        figure = draw(mine)
        for axes in figure.axes:
            if axes.get_legend_handles_labels()[0]:
                axes.legend(fontsize=7)
        commits = ", ".join(sorted({d["commit"] for d in mine}))
        figure.text(0.99, 0.01, f"scree {commits}", ha="right", fontsize=6)
        figure.tight_layout()
        figure.savefig(options.out / name, dpi=120)
        pyplot.close(figure)
        print(options.out / name)
        written += 1
    if written == 0:
        sys.exit("nothing to draw: expected results of iteration, collision, step, solvers or capacity")


if __name__ == "__main__":
    main()
