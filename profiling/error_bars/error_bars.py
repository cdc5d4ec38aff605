#!/usr/bin/env python3
"""Compares the error bars of `skerry study`, and the estimates of every run, with true errors of scenes with known
solutions: error_bars.py PROGRAM OUT [ITEM ...] [--docs] [--threads N]. Writes the table OUT/error_bars.csv; --docs
copies it to docs/error_bars and updates the numbers of docs/error_bars.md."""
import argparse
import csv
import json
import math
import pathlib
import shutil
import subprocess
import sys

import motion_items
import static_items

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
EXACT = 1e-5  # errors relative to the known value below this one count as this one
SHARP = 3  # largest ratio of error bar and error that is wanted
COLUMNS = ["item", "quantity", "formula", "unit", "known", "doubt", "value", "error", "bar", "mesh", "step", "contact",
           "mesh_order", "step_order", "verdict", "bar_over_error", "inside", "estimate", "estimate_over_error", "sentence"]


def number(text):
    return float(text) if text else math.nan


def estimated_error(item, statistics):
    """Relative error by the estimates of a run: of the stress, of a deflection at rest, or of a motion."""
    keys = ["stress"] if item.probe.startswith("all.") else ["deflection"] if item.at_rest else ["deflection", "step"]
    errors = [sum(abs(body[key] or 0) for key in keys) for body in statistics.get("errors", [])]
    return max(errors, default=math.nan)


def study(program, item, folder, threads):
    """Runs an item and its study. Returns a row of the table."""
    scene, text = folder / "scene.json", json.dumps({"name": item.name, **item.scene}, indent=1)
    if scene.exists() and scene.read_text() != text:
        shutil.rmtree(folder)  # runs of another version of the item
    folder.mkdir(parents=True, exist_ok=True)
    scene.write_text(text)
    for name, content in item.meshes.items():
        (folder / name).write_text(content)
    subprocess.run([program, "run", scene, "--quiet", "--threads", "1", "--stats", folder / "stats.json"], check=True,
                   stderr=subprocess.DEVNULL)
    subprocess.run([program, "study", scene, "--quiet", "--threads", str(threads), "--out", folder / "study"],
                   check=True)
    return row_of(item, folder)


def row_of(item, folder):
    """Compares the results of a study with the known value."""
    statistics = json.loads((folder / "stats.json").read_text())
    with open(folder / "study" / "study.csv", newline="") as stream:
        quantities = {row["quantity"]: row for row in csv.DictReader(stream)}
    quantity = f"{item.probe}_{item.at}"
    found = quantities[quantity]
    value, bar = number(found["value"]), number(found["error"])
    error, doubt = abs(value - item.truth), item.doubt * abs(item.truth)
    rounding = EXACT * abs(item.truth)
    estimate = estimated_error(item, statistics) * abs(item.truth)
    inside = found["verdict"] == item.verdict if item.verdict else error <= bar + doubt + rounding
    return {"item": item.name, "quantity": quantity, "formula": item.formula, "unit": found["unit"],
            "known": item.truth, "doubt": doubt, "value": value, "error": error, "bar": bar,
            **{key: number(found[key]) for key in ("mesh", "step", "contact", "mesh_order", "step_order")},
            "verdict": found["verdict"], "bar_over_error": bar / max(error, rounding), "inside": int(inside),
            "estimate": estimate, "estimate_over_error": estimate / max(error, rounding), "sentence": found["sentence"]}


def write_table(rows, file):
    with open(file, "w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()}
                         for row in rows)


def line(row):
    return ("{item:22s} {value:.6g} {unit}, known {known:.6g}, error {error:.3g}, bar {bar:.3g} (mesh {mesh:.2g}, step "
            "{step:.2g}, contacts {contact:.2g}), bar/error {bar_over_error:.2f}, estimate/error "
            "{estimate_over_error:.2g}, {verdict} {sentence}").format(**row)


PAGE = """# Error bars against known solutions

This page shows how far you can trust the error bars of [`skerry study`](study.md) and the
[error estimates](methods/error_estimates.md) of every run. `scripts/error_bars` studies {count} scenes with known
solutions and writes this page. The scenes have coarse meshes and default settings: bars, cantilevers, plates, hollow
bodies, rubber, plasticity, Hertz contact, friction, impacts, rigid motion. They were chosen before the first study was
run. [error_bars.csv](error_bars/error_bars.csv) lists all values, formulas and orders.

| claim | items |
|---|---:|
| the true error lies inside the error bar | {inside} of {count} |
| the error bar is at most 3 times the true error | {sharp} of {count} |
| the estimate of the run is within a factor of 3 of the true error | {estimated} of {count} |

Errors below 0.001 % of the known value count as 0.001 %. Some known values have errors themselves, up to 5 % for an
impact after Hertz: the column `doubt`, which the first line adds to the error bar. An item without a finite value
counts as inside if the study names it as {verdicts}.

Errors and bars of the items that miss a claim of the first two lines are in % of the known value:

| item | true error | error bar | ratio | reason |
|---|---:|---:|---:|---|
{failures}
"""


def write_page(rows):
    """Writes docs/error_bars.md and the table."""
    known = [row for row in rows if math.isfinite(row["known"])]
    reasons = {item.name: item.reason for item in all_items()}
    missed = [row for row in known if not row["inside"] or row["bar_over_error"] > SHARP]
    failures = "\n".join(
        f"| `{row['item']}` | {100 * row['error'] / abs(row['known']):.2g} | {100 * row['bar'] / abs(row['known']):.2g} "
        f"| {row['bar_over_error']:.1f} | {reasons[row['item']]} |" for row in missed)
    (DOCS / "error_bars").mkdir(exist_ok=True)
    write_table(rows, DOCS / "error_bars" / "error_bars.csv")
    (DOCS / "error_bars.md").write_text(PAGE.format(
        count=len(rows), inside=sum(row["inside"] for row in rows),
        sharp=sum(not row["bar_over_error"] > SHARP for row in rows),
        estimated=sum(1 / SHARP <= row["estimate_over_error"] <= SHARP for row in rows),
        verdicts=" or ".join(sorted({f"`{item.verdict}`" for item in all_items() if item.verdict})), failures=failures))


def all_items():
    return static_items.items() + motion_items.items()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("items", nargs="*")
    parser.add_argument("--docs", action="store_true")
    parser.add_argument("--threads", type=int, default=0)
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for item in all_items():
        if arguments.items and item.name not in arguments.items:
            continue
        rows.append(study(arguments.program, item, arguments.out / item.name, arguments.threads))
        print(line(rows[-1]), flush=True)
        write_table(rows, arguments.out / "error_bars.csv")
    if arguments.docs:
        write_page(rows)


if __name__ == "__main__":
    sys.exit(main())
