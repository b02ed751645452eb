#!/usr/bin/env python3
"""Makes the pictures of docs/ and the table of measured speeds in README.md from the results of scree bench.

    bench/figures.py FILE.json... [--out DIR] [--readme FILE]

FILE is what `scree bench MODE --json FILE` wrote, of any mode, or a list of such (`bench/device.sh OUT record` writes
one for all modes). All must be of one commit of the program, so that no two figures disagree. The pictures go to
DIR, by default docs/:

    bench_iteration.png   contact-iterations per second over bodies        (iteration)
    bench_steps.png       milliseconds a step over bodies                   (collision, step)
    bench_solvers.png     time to residual, solver by solver                (solvers)
    bench_memory.png      bytes a body over bodies                          (capacity)
    bench_scaling.png     efficiency over ranks                             (scaling)

With --readme the table between the two comments "measured" of that file is replaced (step, iteration, solvers).
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
    sys.exit("figures.py needs matplotlib, which is not installed: pip install matplotlib, "
             "or on Debian and Ubuntu apt install python3-matplotlib")


def read(path):
    """The documents of a file: one of scree bench, or a list of them."""
    try:
        content = json.loads(path.read_text())
        documents = content if isinstance(content, list) else [content]
        for d in documents:
            if not isinstance(d["results"], list) or not isinstance(d["benchmark"], str):
                raise TypeError
    except (OSError, ValueError) as error:
        sys.exit(f"{path}: cannot be read: {error}")
    except (KeyError, TypeError):
        sys.exit(f"{path}: is not a result of scree bench (written with --json FILE)")
    return documents


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
    """Time over the residual that was reached: a level that the first iterations pass by is the same point as the next."""
    cases = defaultdict(list)
    for d in documents:
        for r in d["results"]:
            cases[machine(d), r["bodies"], r["layers"]].append(r)
    figure, columns = new_axes("", "residual reached / v*", "solve, ms", len(cases))
    solvers = list(dict.fromkeys(r["solver"] for d in documents for r in d["results"]))
    for axes, ((name, bodies, layers), results) in zip(columns, cases.items()):
        axes.set_title(f"{bodies:,} spheres in {layers} layers; {name}", fontsize=10)
        for k, solver in enumerate(solvers):
            for start, style in (("warm", {"linestyle": "-", "fillstyle": "full"}),
                                 ("cold", {"linestyle": (0, (4, 3)), "fillstyle": "none"})):
                mine = [r for r in results if r["solver"] == solver and r["start"] == start]
                reached = {(r["residual_relative"], r["solve_ms"]) for r in mine if r["reached"]}
                curve(axes, reached, f"{solver}, {start}", color=f"C{k}", linewidth=1.4, **style)
                ends = [(r["residual_relative"], r["solve_ms"]) for r in mine if not r["reached"]]
                if ends:
                    axes.plot(*ends[0], marker="x", color=f"C{k}", linestyle="none")
        if any(not r["reached"] for r in results):
            axes.plot([], [], marker="x", color="gray", linestyle="none", label="time limit, not reached")
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


def draw_scaling(documents):
    """Weak scaling has so many bodies on each rank, strong scaling on all."""
    figure, columns = new_axes("", "ranks", "efficiency", 2)
    for axes, kind in zip(columns, ("weak", "strong")):
        axes.set_title(f"{kind} scaling")
        groups = defaultdict(lambda: [(1, 1.0)])
        for d in documents:
            for r in d["results"]:
                if r["kind"] == kind:
                    bodies = r["bodies"] // (r["ranks"] if kind == "weak" else 1)
                    each = " on each rank" if kind == "weak" else ""
                    each += {"nccl": " over NCCL", "hosts": " through hosts"}.get(r.get("transport"), "")
                    groups[f"{short(bodies)} bodies{each}; {machine(d)}"].append((r["ranks"], r["efficiency"]))
        for label, points in groups.items():
            curve(axes, points, label)
        ranks = sorted({n for points in groups.values() for n, _ in points})
        axes.set_xscale("log", base=2)
        axes.set_xticks(ranks, labels=[str(n) for n in ranks])
        axes.set_yscale("linear")
        axes.set_ylim(0, 1.1)
    return figure


PICTURES = [("bench_iteration.png", ("iteration",), draw_iteration),
            ("bench_steps.png", ("collision", "step"), draw_steps),
            ("bench_solvers.png", ("solvers",), draw_solvers),
            ("bench_memory.png", ("capacity",), draw_memory),
            ("bench_scaling.png", ("scaling",), draw_scaling)]


def short(value):
    """Three digits: 8.86, 205, 3.30e6."""
    return f"{value:#.3g}".rstrip(".") if value < 1e5 else f"{value:.2e}".replace("e+0", "e").replace("e+", "e")


def one_row(what, r, whole_step=True):
    collision = f", of which collision {short(r['ms']['collision']['median'])} ms" if whole_step else ""
    total = r["ms"]["total"]["median"] if whole_step else r["solve_ms"]
    return (f"| {what} | {r['bodies']:,} | {short(r['contacts'])} | `{r['solver']}` | {r['applications']:.0f} | "
            f"{r['residual_relative']:.2g} v* | {short(total)} ms{collision} | {short(r['contact_iterations_per_s'])} |")


def place(d):
    """Sorts settled beds by size, then exact friction, the column and single solves."""
    r = d["results"][0] if d["results"] else {}
    return (d["benchmark"] != "step", r.get("scene") == "column", len(d.get("settings", [])), -r.get("bodies", 0))


def table(documents):
    """Rows of README.md, for whole steps and for single solves to tight residuals."""
    rows = ["| what | bodies | contacts | solver | applications | residual | time | contact-iterations/s |",
            "|---|---|---|---|---|---|---|---|"]
    for d in sorted(documents, key=place):
        exact = ", exact friction" if any("model=exact" in s for s in d.get("settings", [])) else ""
        for r in d["results"]:
            if d["benchmark"] == "step":
                bed = "column in mid-collapse" if r["scene"] == "column" else "settled bed of 20 layers"
                rows.append(one_row(f"{bed}, a step to `{r['stop']}`{exact}", r))
            elif d["benchmark"] == "solvers" and r["start"] == "warm" and r["reached"] and r["level"] <= 1e-3 \
                    and r["layers"] == 20 and r["solver"] in ("apgd", "schwarz"):
                rows.append(one_row(f"one solve on such a bed to {r['level']:g} v*, warm", r, whole_step=False))
    return rows


def write_table(path, documents, commit):
    text = path.read_text()
    begin, end = "<!-- measured: begin -->", "<!-- measured: end -->"
    if text.count(begin) != 1 or text.count(end) != 1:
        sys.exit(f'{path}: has no place for the table: expected the lines "{begin}" and "{end}" once each')
    devices = ", ".join(sorted({machine(d) for d in documents}))
    lines = [f"{devices}; medians of 20 steps; commit {commit}.", ""] + table(documents)
    before, after = text.split(begin)[0], text.split(end)[1]
    path.write_text(before + begin + "\n" + "\n".join(lines) + "\n" + end + after)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE.json")
    parser.add_argument("--out", type=Path, metavar="DIR", default=Path(__file__).resolve().parent.parent / "docs")
    parser.add_argument("--readme", type=Path, metavar="FILE")
    options = parser.parse_args()
    documents = [d for path in options.files for d in read(path)]
    commits = sorted({d["commit"] for d in documents})
    if len(commits) != 1:
        sys.exit(f"the results are of several commits ({', '.join(commits)}): expected one")
    options.out.mkdir(parents=True, exist_ok=True)
    written = 0
    for name, benchmarks, draw in PICTURES:
        mine = [d for d in documents if d["benchmark"] in benchmarks and d["results"]]
        if not mine:
            continue
        figure = draw(mine)
        for axes in figure.axes:
            if axes.get_legend_handles_labels()[0]:
                axes.legend(fontsize=7, handlelength=4)
        figure.text(0.99, 0.01, f"scree {commits[0]}", ha="right", fontsize=6)
        figure.tight_layout()
        figure.savefig(options.out / name, dpi=120)
        pyplot.close(figure)
        print(options.out / name)
        written += 1
    if written == 0:
        sys.exit("nothing to draw: expected results of iteration, collision, step, solvers, capacity or scaling")
    if options.readme:
        write_table(options.readme, documents, commits[0])
        print(options.readme)


if __name__ == "__main__":
    main()
