#!/usr/bin/env python3
"""Objectives of the convex model that `scree solve` reached on FCLIB's problems, against stored minima.

    bench/fclib_objectives.py DEFAULT.csv MORE.csv --reference FILE.csv --page FILE.md

DEFAULT.csv is results.csv of a run in which each solver had its own limit of iterations, MORE.csv of one with more; rows of the latter
count where the former did not converge. The reference has the columns problem and ccp_f_star, the minimum of 1/2 r.W r + q.r over the
friction cones with the symmetric part of W. Puts tables into the page and all differences into a CSV file beside it, with its name.
"""

import argparse
import csv
import pathlib

from markdown import number, put_tables, table

GATE = 1e-8  # relative difference that was asked for
ORACLE = "interior_point"


def read(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def by_run(rows):
    return {(row["solver"], row["problem"]): row for row in rows}


def converged(row):
    return row["status"] == "converged"


def relative(value, reference):
    return abs(value - reference) / abs(reference)


def merged(default, more, minima):
    """One record per solver and problem: the rows' figures and the differences of their objectives."""
    more, records = by_run(more), []
    for key, first in by_run(default).items():
        row = first if converged(first) or key not in more else more[key]
        minimum = minima[row["problem"]]
        records.append(
            {
                **{name: row[name] for name in ("problem", "contacts", "solver", "status", "iterations", "seconds", "residual")},
                "objective": row["objective"],
                "reference": repr(minimum),
                "difference": relative(float(row["objective"]), minimum),
                "needed_more": not converged(first),
                "default_iterations": first["iterations"],
                "default_difference": relative(float(first["objective"]), minimum),
            }
        )
    oracle = {r["problem"]: float(r["objective"]) for r in records if r["solver"] == ORACLE}
    for record in records:
        record["difference_to_oracle"] = relative(float(record["objective"]), oracle[record["problem"]])
    return records


def worst(records, key):
    return max(records, key=lambda record: record[key])


def solver_table(records):
    rows = []
    for solver in dict.fromkeys(record["solver"] for record in records):
        mine = [record for record in records if record["solver"] == solver]
        own = [record for record in mine if not record["needed_more"]]
        last, apart = worst(mine, "difference"), worst(mine, "difference_to_oracle")
        of_own = number(worst(own, "difference")["difference"])
        rows.append(
            [f"`{solver}`", f"{len(own)} of {len(mine)}", of_own, sum(map(converged, mine))]
            + [f"{number(last['difference'])}, {last['problem']}", number(apart["difference_to_oracle"])]
            + ["reached" if last["difference"] <= GATE else "missed"]
        )
    header = ["solver", "converged within its own limit", "largest difference of these", "converged with more"]
    return table(header + ["largest difference of all", f"to `{ORACLE}`", f"{number(GATE)}"], rows)


def more_table(records):
    rows = [
        [f"`{r['solver']}`", r["problem"], r["contacts"], f"{r['default_iterations']}", number(r["default_difference"])]
        + [f"{int(r['iterations']):,}", number(float(r["seconds"])), r["status"]]
        + [number(float(r["residual"])), number(r["difference"])]
        for r in records
        if r["needed_more"]
    ]
    header = ["solver", "problem", "contacts", "own limit", "difference there", "iterations", "seconds", "status"]
    return table(header + ["residual", "difference"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("default", type=pathlib.Path)
    parser.add_argument("more", type=pathlib.Path)
    parser.add_argument("--reference", type=pathlib.Path, required=True)
    parser.add_argument("--page", type=pathlib.Path, required=True)
    options = parser.parse_args()
    minima = {row["problem"]: float(row["ccp_f_star"]) for row in read(options.reference)}
    records = merged(read(options.default), read(options.more), minima)
    with options.page.with_suffix(".csv").open("w", newline="") as file:
        columns = [name for name in records[0] if not name.startswith("default_")]
        writer = csv.DictWriter(file, columns, lineterminator="\n", extrasaction="ignore")
        writer.writeheader()
        for record in records:
            differences = {name: f"{record[name]:.2e}" for name in ("difference", "difference_to_oracle")}
            writer.writerow({**record, **differences})
    put_tables(options.page, solver_table(records) + "\n## Given more iterations\n\n" + more_table(records))


if __name__ == "__main__":
    main()
