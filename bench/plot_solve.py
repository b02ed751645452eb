#!/usr/bin/env python3
"""Draws what scree solve --out DIR wrote as PNG files, into the same folder.

    bench/plot_solve.py DIR

    curves_PROBLEM.png          residual over applications and over seconds, contacts that change state
    profile_seconds.png,
    profile_applications.png    share of problems solved within a ratio of the best solver (folders of problems)

Needs matplotlib, and nothing else beside Python 3.8.
"""
import csv
import json
import sys
from pathlib import Path

try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
except ImportError:
    sys.exit("plot_solve.py needs matplotlib, which is not installed: pip install matplotlib, "
             "or on Debian and Ubuntu apt install python3-matplotlib")


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, dpi=120)
    pyplot.close(figure)
    print(path)


def draw_curves(folder, problem):
    figure, (by_work, by_time, states) = pyplot.subplots(1, 3, figsize=(15, 4.5))
    for k, run in enumerate(problem["runs"]):
        points = rows(folder / "curves" / f"{problem['problem']}_{run['solver']}.csv")
        residual = [float(p["residual"]) for p in points]
        style = {"label": run["solver"], "color": f"C{k % 10}", "linestyle": ("-", "--", ":")[k // 10 % 3]}
        by_work.plot([max(1, int(p["applications"])) for p in points], residual, **style)
        by_time.plot([max(1e-6, float(p["seconds"])) for p in points], residual, **style)
        states.plot([max(1, int(p["applications"])) for p in points], [int(p["state_changes"]) for p in points], **style)
    for axes, label in ((by_work, "applications of W"), (by_time, "seconds"), (states, "applications of W")):
        axes.set_xscale("log")
        axes.set_xlabel(label)
        axes.grid(alpha=0.3)
    by_work.set_yscale("log")
    by_time.set_yscale("log")
    by_work.set_ylabel("residual |r - P(r - v)| / |q|")
    states.set_yscale("symlog")
    states.set_ylim(bottom=0)
    states.set_ylabel("contacts that changed state since the last look")
    by_work.legend(fontsize=8)
    figure.suptitle(f"{problem['problem']}: {problem['contacts']} contacts")
    save(figure, folder / f"curves_{problem['problem']}.png")


def draw_profile(folder, what):
    path = folder / f"profile_{what}.csv"
    if not path.exists():
        return
    steps = rows(path)
    figure, axes = pyplot.subplots(figsize=(7, 4.5))
    ratio = [float(s["ratio"]) for s in steps]
    for k, solver in enumerate(name for name in steps[0] if name != "ratio"):
        axes.step(ratio, [float(s[solver]) for s in steps], where="post", label=solver, color=f"C{k % 10}",
                  linestyle=("-", "--", ":")[k // 10 % 3])
    axes.set_xscale("log")
    axes.set_ylim(0, 1.02)
    axes.set_xlabel(f"{what} over {what} of the best solver")
    axes.set_ylabel("share of problems solved")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    save(figure, folder / f"profile_{what}.png")


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    try:
        document = json.loads((folder / "results.json").read_text())
        for problem in document["problems"]:
            draw_curves(folder, problem)
        for what in ("seconds", "applications"):
            draw_profile(folder, what)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"{folder}: does not hold what scree solve --out writes: {error}")


main()
