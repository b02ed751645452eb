#!/usr/bin/env python3
"""Every supported pair of solver and friction law on the packing of 1702 contacts, mu = 0.8.

    bench/packing_1702.py --out DIR [--page FILE.md] [--scree PROGRAM] [--problem FILE] [--seconds S]

Runs the solvers on bench/problems/packing_1702.hdf5 (bench/packing_problem.py makes such files): the convex cone against
the interior point method, exact Coulomb friction against long runs of `nlgs`, and each solver of another law against a run
of itself that went on for twice as long. Tables go to the page, pictures and curves to DIR. Needs h5py and numpy.
"""

import argparse
import pathlib

import programs
from curves import reached, solve
from markdown import number, put_tables, table

CONE = [
    "jacobi",
    "gauss_seidel",
    "nlgs",
    "sor",
    "extragradient",
    "newton",
    "newton_krylov",
    "hybrid",
    "hybrid_krylov",
    "proximal",
    "proximal_krylov",
    "proximal_gauss_seidel",
    "apgd",
    "apgd_plain",
    "spg",
    "cpg",
    "admm",
]
MODELS = {
    "convex": ("Convex cone", "interior_point", CONE + ["interior_point"]),
    "exact": ("Exact Coulomb friction", "nlgs", CONE + ["de_saxce", "auto"]),
}
OTHER_LAWS = [  # solver, model, name of the law
    ("pgs_box", "exact", "box, bounds coupled"),
    ("pgs_box_lagged", "exact", "box, bounds lagged"),
    ("cpg_box", "exact", "box, bounds by fixed point"),
    ("newton_minmax", "exact", "box, bounds coupled"),
    ("newton_minmax_krylov", "exact", "box, bounds coupled"),
    ("pgs_pyramid4", "convex", "4-sided pyramid, convex"),
    ("pgs_pyramid8", "convex", "8-sided pyramid, convex"),
    ("cpg_pyramid4", "convex", "4-sided pyramid, convex"),
    ("cpg_pyramid8", "convex", "8-sided pyramid, convex"),
    ("pgs_pyramid4", "exact", "4-sided pyramid, exact"),
    ("pgs_pyramid8", "exact", "8-sided pyramid, exact"),
    ("cpg_pyramid4", "exact", "4-sided pyramid, exact"),
    ("cpg_pyramid8", "exact", "8-sided pyramid, exact"),
]
LEVELS = [1e-2, 1e-3, 1e-6]


def arrival(curve, level):
    point = reached(curve, "e", level)
    return (
        "-" if point is None else f"{point['iteration']:.0f} / {point['applications']:.0f} / {number(point['seconds'])}"
    )


def quiet_since(curve):
    """Iteration of the last check at which a contact changed its state."""
    changed = [point["iteration"] for point in curve if point["state_changes"] > 0]
    return f"{changed[-1]:.0f}" if changed else "0"


def law_table(runs):
    rows = []
    for run in runs:
        last = run["curve"][-1]
        rows.append(
            [f"`{run['solver']}`" + (f", {run['law']}" if "law" in run else "")]
            + [arrival(run["curve"], level) for level in LEVELS]
            + [
                number(last["e"]),
                number(run["residual"]),
                f"{run['iterations']}",
                quiet_since(run["curve"]),
                run["status"],
            ]
        )
    header = ["iterations / products / seconds to e ="] + [number(level) for level in LEVELS]
    return table(header + ["e at the end", "best residual", "iterations", "last change of a state at", "status"], rows)


def gates(results):
    runs = {(model, run["solver"]): run for model in results for run in results[model]}
    rows = []
    for solver, level, limit in [
        ("apgd", 1e-3, 500),
        ("apgd", 1e-6, 5000),
        ("apgd_plain", 1e-3, 500),
        ("apgd_plain", 1e-6, 5000),
    ]:
        point = reached(runs["convex", solver]["curve"], "e", level)
        verdict = "reached" if point is not None and point["iteration"] <= limit else "missed"
        rows.append(
            [
                f"`{solver}`, convex",
                f"e = {number(level)} within {limit} iterations",
                "never" if point is None else f"{point['iteration']:.0f}",
                verdict,
            ]
        )
    for model in results:
        for solver, count, unit in (
            ("hybrid", "factorizations", "Newton steps"),
            ("proximal", "iterations", "outer iterations"),
            ("proximal_krylov", "iterations", "outer iterations"),
        ):
            run = runs[model, solver]
            verdict = "reached" if run["residual"] <= 1e-10 and run[count] < 60 else "missed"
            work = f"{run['iterations']} iterations, {run['factorizations']} factorizations"
            found = f"residual {number(run['residual'])}, {work}, {run['status']}"
            rows.append([f"`{solver}`, {model}", f"residual 1e-10 in under 60 {unit}", found, verdict])
    return table(["solver", "gate", "found", ""], rows)


def supported():
    laws = ["convex cone", "exact Coulomb", "box", "pyramid, convex", "pyramid, exact"]
    loops = ("gauss_seidel", "apgd", "apgd_plain", "spg", "cpg", "admm", "interior_point", "de_saxce")
    rows = []
    for solver in CONE + ["interior_point", "de_saxce", "auto"]:
        rows.append(
            [
                f"`{solver}`",
                "-" if solver == "de_saxce" else "yes",
                "De Saxce loop" if solver in loops else "yes",
                "-",
                "-",
                "-",
            ]
        )
    rows += [
        [
            "`pgs_box`, `pgs_box_lagged`, `cpg_box`, `newton_minmax`, `newton_minmax_krylov`",
            "-",
            "-",
            "yes",
            "-",
            "-",
        ],
        ["`pgs_pyramid4`, `pgs_pyramid8`, `cpg_pyramid4`, `cpg_pyramid8`", "-", "-", "-", "yes", "yes"],
    ]
    return table(["solver"] + laws, rows)


def main():
    here = pathlib.Path(__file__).parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--page", type=pathlib.Path, help="page that gets the tables (default: DIR/packing_1702.md)")
    parser.add_argument("--problem", type=pathlib.Path, default=here / "problems" / "packing_1702.hdf5")
    parser.add_argument("--scree", metavar="PROGRAM", help="default: that of the newest build")
    parser.add_argument("--seconds", type=float, default=10, help="limit per solver")
    options = parser.parse_args()
    options.scree = programs.scree(options.scree)
    limits = ["--tolerance", "1e-12", "--max-seconds", options.seconds]
    results, text = {}, ""
    for model, (title, reference, solvers) in MODELS.items():
        results[model] = solve(
            options.scree,
            options.problem,
            solvers,
            options.out / model,
            "--model",
            model,
            "--reference",
            reference,
            *limits,
        )
        found = results[model][0]["reference"]
        text += f"## {title}\n\nv* by `{reference}`, residual {found['residual']:.1e}, {found['status']}.\n\n{law_table(results[model])}\n"
    other = []
    for solver, model, law in OTHER_LAWS:
        out = options.out / f"{solver}_{model}"
        run = solve(
            options.scree,
            options.problem,
            [solver],
            out,
            "--model",
            model,
            "--reference",
            solver,
            "--max-iterations",
            10000,
            *limits,
        )[0]
        other.append({**run, "law": law})
    text += f"## Other laws\n\nEach against a run of itself of 20,000 iterations; the residual is that of the cone, another law.\n\n{law_table(other)}\n"
    text = f"## Gates\n\n{gates(results)}\n## Supported pairs\n\n{supported()}\n" + text
    put_tables(options.page or options.out / "packing_1702.md", text)


if __name__ == "__main__":
    main()
