#!/usr/bin/env python3
"""The page and the picture of the variational collision integrator, from what its tests and scree_energy_curves measured.

    bench/variational.py run --out DIR [--bin DIR] [--steps N]
    bench/variational.py show --out DIR --page docs/results/variational.md

`run` starts scree_tests_physics and scree_energy_curves, which are in --bin (that of the newest build), and writes tests.json and
curves.json. `show` puts their figures into the tables of the page, beside the reference values and gates of the cases, and draws
the curves beside it. `show` needs matplotlib for the picture.
"""

import argparse
import json
import pathlib
import subprocess
import sys

import programs
from markdown import number, put_tables, table

SUITES = "*Collision*:-Impact/*:GranularGas.*:ImpactChain.*"
METHODS = {"variational": "C0", "time steps": "C2", "clamped leapfrog": "C3"}
CHARTS = [("ball", "energy_intervals", "Energy of a ball let go 1 m above a floor", "|dE / E|"),
          ("rod", "energy_intervals", "Energy of a rod that falls on a floor", "|dE / E|"),
          ("ball", "place_intervals_m", "Place of the ball", "off the closed form, m")]

# Case, setting, figure, reference value, gate, and where the figure is: suite, test, key.
BALL, BILLIARD = "Steps/CollisionBall.B01_EnergyOverAMillionSteps", "CollisionBilliard"
BOWL, ROD, STAR = "CollisionBowl", "CollisionRod", "CollisionStar"
RODS = f"{ROD}.B08_EnergyAndMomentumOverAMillionSteps"
CASES = [
    ("B01", "ball on a floor, 1e6 steps of 10 ms", "largest change of energy", "1.22e-3", "3.7e-3", f"{BALL}/0", "largest"),
    ("B01", "", "at the end", "1.6e-4", "4.8e-4", f"{BALL}/0", "last"),
    ("B01", "", "impacts", "11075", "", f"{BALL}/0", "impacts"),
    ("B01", "5 ms", "largest change of energy", "7.1e-5", "2.1e-4", f"{BALL}/1", "largest"),
    ("B01", "2.5 ms", "largest change of energy", "1.2e-5", "3.6e-5", f"{BALL}/2", "largest"),
    ("B01", "10 ms", "jump of an impact off its formula, J", "1e-12", "1e-10", "CollisionBall.B01_JumpOfAnImpact",
     "jump_error"),
    ("B02", "the same by clamped leapfrog", "largest change of energy", "0.23", "shows", "CollisionContrast."
     "B02_ClampedEndPointsDoNotKeepTheEnergy", "largest"),
    ("B03", "the same by time steps of a World, e = 1", "largest change of energy", "2e-12", "",
     "CollisionContrast.B03_TimeStepsTurnTheBallOffTheFloor", "largest"),
    ("B03", "", "turned off the floor by, m", "up to 0.044", "", "CollisionContrast."
     "B03_TimeStepsTurnTheBallOffTheFloor", "turned_off"),
    ("B04", "point in a parabolic bowl, mean of 5 starts, 5e4 steps of 10 ms", "largest change of energy", "1.6e-3",
     "1.1e-2", f"{BOWL}.B04_EnergyOfFiveStarts", "mean_100e-4"),
    ("B04", "5 ms", "largest change of energy", "3.7e-4", "half", f"{BOWL}.B04_EnergyOfFiveStarts", "mean_50e-4"),
    ("B04", "2.5 ms", "largest change of energy", "", "half", f"{BOWL}.B04_EnergyOfFiveStarts", "mean_25e-4"),
    ("B04", "first start, 10 ms", "second invariant", "3.0e-2", "9e-2", f"{BOWL}.B04_SecondInvariant", "largest_100e-4"),
    ("B04", "5 ms", "second invariant", "5.8e-3", "1.7e-2", f"{BOWL}.B04_SecondInvariant", "largest_50e-4"),
    ("B04", "1e6 steps of 10 ms", "largest change of energy", "1.3e-2", "4.7e-2",
     f"{BOWL}.B04_EnergyOverAMillionSteps", "largest_100e-4"),
    ("B04", "5 ms", "largest change of energy", "2.0e-3", "8.4e-3", f"{BOWL}.B04_EnergyOverAMillionSteps",
     "largest_50e-4"),
    ("B05", "elliptic billiard, 1e6 steps", "speed", "3e-13", "1e-10", f"{BILLIARD}.B05_InvariantsOfTheEllipse",
     "speed_error"),
    ("B05", "", "L1 L2", "1.4e-12", "1e-10", f"{BILLIARD}.B05_InvariantsOfTheEllipse", "invariant_error"),
    ("B06", "re-entrant corner, three shots", "place, m", "0", "1e-12", f"{BILLIARD}.B06_ReentrantCorner", "error"),
    ("B06", "2000 random hits", "closest-point identity, m", "0", "1e-12",
     f"{BILLIARD}.B06_ClosestPointOnRandomShots", "closest_point_error"),
    ("B06", "", "hits that a test of end points misses", "", "", f"{BILLIARD}.B06_ClosestPointOnRandomShots", "cuts"),
    ("B07", "convex corner of a box", "velocity, m/s", "0", "1e-12", f"{BILLIARD}.B07_ConvexCornerTurnsBack", "error"),
    ("B08", "rod on a floor, mean of 5 starts, 2e4 steps of 10 ms", "largest change of energy", "1.7e-3", "5.5e-3",
     f"{ROD}.B08_EnergyOfFiveStarts", "mean_100e-4"),
    ("B08", "5 ms", "largest change of energy", "1.8e-4", "half", f"{ROD}.B08_EnergyOfFiveStarts", "mean_50e-4"),
    ("B08", "2.5 ms", "largest change of energy", "2.9e-5", "half", f"{ROD}.B08_EnergyOfFiveStarts", "mean_25e-4"),
    ("B08", "1e6 steps of 10 ms", "largest change of energy", "6.0e-3", "4.1e-2", RODS, "largest_100e-4"),
    ("B08", "5 ms", "largest change of energy", "1.4e-3", "7.1e-3", RODS, "largest_50e-4"),
    ("B08", "2.5 ms", "largest change of energy", "1.7e-4", "1.3e-3", RODS, "largest_25e-4"),
    ("B08", "10 ms", "horizontal momentum, kg m/s", "0", "1e-13", RODS, "momentum_error_100e-4"),
    ("B08", "", "grazing impacts", "0 to 3", "20", RODS, "grazing_100e-4"),
    ("B09", "star of five arms in a box with a peg, no forces, 2e5 steps", "largest change of energy", "", "1e-10",
     f"{STAR}.B09_EnergyAndMomentaWithoutForces", "largest"),
    ("B09", "under gravity, mean of 5 starts, 2e4 steps of 10 ms", "largest change of energy", "", "as B04",
     f"{STAR}.B09_EnergyUnderGravity", "mean_100e-4"),
    ("B09", "5 ms", "largest change of energy", "", "half", f"{STAR}.B09_EnergyUnderGravity", "mean_50e-4"),
    ("B10", "ball with e = 0.9, 10 ms", "heights of 8 bounces off e^(2n), m", "", "O(h^2)",
     "CollisionBall.B10_RestitutionScalesHeights", "height_error_100e-4"),
    ("B10", "5 ms", "heights", "", "O(h^2)", "CollisionBall.B10_RestitutionScalesHeights", "height_error_50e-4"),
    ("B10", "2.5 ms", "heights", "", "O(h^2)", "CollisionBall.B10_RestitutionScalesHeights", "height_error_25e-4"),
]

ORDERS = [
    ("ball, against the closed form after 4 s, 200 heights", "CollisionBall.ErrorFallsWithTheSquareOfTheStep",
     ["error_40e-3", "error_20e-3", "error_10e-3", "error_5e-3"]),
    ("bowl, against steps 16 times as fine after 2.56 s, 100 starts", f"{BOWL}.ErrorFallsWithTheSquareOfTheStep",
     [None, "error_20e-3", "error_10e-3", "error_5e-3"]),
]


def run(options):
    folder = programs.folder_of(("scree_tests_physics", "scree_energy_curves"), options.bin)
    options.out.mkdir(parents=True, exist_ok=True)
    tests = options.out / "tests.json"
    subprocess.run([folder / "scree_tests_physics", f"--gtest_filter={SUITES}", f"--gtest_output=json:{tests}"],
                   check=True)
    subprocess.run([folder / "scree_energy_curves", "--steps", str(options.steps), "--json",
                    options.out / "curves.json"], check=True)


def figures_of(path):
    """What tests recorded: by suite.test, then by key."""
    report = json.loads(path.read_text())
    if report["failures"]:
        sys.exit(f"{path}: {report['failures']} tests failed, expected none")
    return {f"{suite['name']}.{test['name']}": test for suite in report["testsuites"] for test in suite["testsuite"]}


def figure(figures, test, key):
    try:
        value = float(figures[test][key])
        return str(int(value)) if value >= 1 and value == int(value) else number(value)
    except KeyError:
        sys.exit(f"tests.json: no figure {key} of {test}; expected what scree_tests_physics of this commit writes")


def case_table(figures):
    rows = [(case, setting, what, reference or "-", gate or "-", figure(figures, test, key))
            for case, setting, what, reference, gate, test, key in CASES]
    return table(["case", "setting", "figure", "reference", "gate", "scree"], rows)


def order_table(figures):
    rows = [(what, *(figure(figures, test, key) if key else "-" for key in keys)) for what, test, keys in ORDERS]
    return table(["mean error of the place, m", "40 ms", "20 ms", "10 ms", "5 ms"], rows)


def method_table(curves):
    rows = [(r["system"], r["method"], number(r["largest_energy_change"]), r["impacts"],
             number(r["largest_turn_error_m"])) for r in curves["results"]]
    return table(["system", "method", "largest change of energy", "impacts", "turned off the floor by at most, m"], rows)


def draw(curves, path):
    try:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        sys.exit("show needs matplotlib, which is not installed: pip install matplotlib, "
                 "or on Debian and Ubuntu apt install python3-matplotlib")
    picture, axes = pyplot.subplots(1, 3, figsize=(14, 4.2))
    for axis, (system, key, title, label) in zip(axes, CHARTS):
        for r in curves["results"]:
            if r["system"] != system:
                continue
            width = curves["steps"] * curves["step_s"] / len(r[key])
            times = [width * (k + 0.5) for k in range(len(r[key]))]
            axis.plot(times, [max(value, 1e-16) for value in r[key]], color=METHODS[r["method"]], linewidth=1,
                      label=r["method"])
        axis.set(title=title, xlabel="time, s", ylabel=f"{label}, largest of an interval", yscale="log")
        axis.grid(True, linewidth=0.3)
    axes[2].set_xscale("log")
    axes[1].legend(fontsize=8)
    picture.tight_layout()
    picture.savefig(path, dpi=110)


def show(options):
    curves = json.loads((options.out / "curves.json").read_text())
    figures = figures_of(options.out / "tests.json")
    title = f"{curves['steps']} steps of {1000 * curves['step_s']:g} ms:"
    put_tables(options.page, "\n".join(["### Cases", "", case_table(figures), "### Order", "", order_table(figures),
                                        "### Methods", "", title, "", method_table(curves)]))
    draw(curves, options.page.with_suffix(".png"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    modes = parser.add_subparsers(required=True)
    make = modes.add_parser("run")
    make.add_argument("--out", type=pathlib.Path, required=True)
    make.add_argument("--bin", type=pathlib.Path, metavar="DIR", help="default: that of the newest build")
    make.add_argument("--steps", type=int, default=100000)
    make.set_defaults(work=run)
    page = modes.add_parser("show")
    page.add_argument("--out", type=pathlib.Path, required=True)
    page.add_argument("--page", type=pathlib.Path, required=True)
    page.set_defaults(work=show)
    options = parser.parse_args()
    options.work(options)


if __name__ == "__main__":
    main()
