#!/usr/bin/env python3
"""Compares the error bars of `skerry study`, and the estimates of every run, with true errors of scenes with known
solutions: error_bars.py PROGRAM OUT [ITEM ...] [--docs] [--threads N]. Writes the table OUT/error_bars.csv; --docs
writes docs/error_bars.md and the table beside it. OUT keeps the runs, so that a later call continues."""
import argparse
import csv
import json
import math
import pathlib
import shutil
import subprocess
import sys

import check_items
import motion_items
import static_items

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "error_bars"  # folder of the table, beside the page
EXACT = 1e-5  # errors relative to the known value below this one count as this one
SHARP = 3  # largest ratio of error bar and error that is wanted
COLUMNS = ["item", "quantity", "formula", "unit", "known", "doubt", "value", "error", "bar", "mesh", "step", "contact",
           "mesh_order", "step_order", "verdict", "bar_over_error", "inside", "estimate", "estimate_over_error",
           "sentence"]


def number(value):
    return math.nan if value is None else value


def estimated_error(item, body, scale):
    """Error of the item by the estimates of a body: of its stress, of a deflection at rest, of a force or a motion."""
    keys = "stress", "deflection", "interpolation", "deformation", "step", "contact", "gap"
    stress, deflection, interpolation, deformation, step, contact, gap = (number(body[key]) for key in keys)
    if item.probe.startswith("all."):
        return abs(stress * item.truth)
    if not item.at_rest and "force" in item.probe:
        return abs(contact * item.truth)
    offset = 0
    if ".displacement_" in item.probe:
        offset = sum(of for of in (gap, interpolation) if of > 0)
    if item.at_rest:
        return abs(deflection * item.truth) + offset
    # The deflection is that of the deformation, which is a part of the motion. Rigid bodies have none.
    return scale * (step + (0 if math.isnan(deflection) else abs(deflection) * deformation)) + offset


def study(program, item, folder, threads):
    """Runs an item and its study. Returns a row of the table."""
    scene, text = folder / "scene.json", json.dumps({"name": folder.name, **item.scene}, indent=1)
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
    quantities = json.loads((folder / "study" / "study.json").read_text())["quantities"]
    found = next(quantity for quantity in quantities if quantity["name"] == f"{item.probe}_{item.at}")
    value, bar = number(found["value"]), number(found["error"])
    error, doubt = abs(value - item.truth), item.doubt * abs(item.truth)
    rounding = EXACT * abs(item.truth)
    scale = number(found["scale"])
    estimate = max((estimated_error(item, body, scale) for body in statistics["errors"]), default=math.nan)
    inside = found["verdict"] == item.verdict if item.verdict else error <= bar + doubt + rounding
    return {"item": item.name, "quantity": found["name"], "formula": item.formula, "unit": found["unit"],
            "known": item.truth, "doubt": doubt, "value": value, "error": error, "bar": bar,
            **{key: number(found[key]) for key in ("mesh", "step", "contact", "mesh_order", "step_order")},
            "verdict": found["verdict"], "bar_over_error": bar / max(error, rounding), "inside": int(inside),
            "estimate": estimate, "estimate_over_error": max(estimate, rounding) / max(error, rounding),
            "sentence": found["sentence"].replace(f"{folder}/", "")}


def write_table(rows, file):
    with open(file, "w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: f"{value:.9g}" if isinstance(value, float) else value for key, value in row.items()}
                         for row in rows)


def line(row):
    return ("{item:22s} {value:.6g} {unit}, known {known:.6g}, error {error:.3g}, bar {bar:.3g} (mesh {mesh:.2g}, step "
            "{step:.2g}, contacts {contact:.2g}), bar/error {bar_over_error:.2f}, estimate/error "
            "{estimate_over_error:.2g}, {verdict} {sentence}").format(**row)


def is_judged(row):
    """Whether the known value is exact enough to judge the estimate of a run."""
    return row["error"] > row["doubt"]


def is_near(row):
    return 1 / SHARP <= row["estimate_over_error"] <= SHARP


# Reasons for which error bars miss a claim.
REASONS = {
    "hollow_sphere_stress": "stress grows at the edges of the polyhedron",
    "two_layers": "the mesh error is only estimated, by a run with other elements",
    "bar_step_implicit": "at this time the error of the steps passes through zero",
    "hertz_impact": "the true error is below the 7 % error of the formula",
    "incline_stick": "exact, because the block is at rest",
    "toppling": "errors of steps and of the contact distance cancel",
    "bar_caught": "the front of a wave oscillates",
}
# Reasons for which estimates of runs are not within a factor of SHARP of the error.
ESTIMATE_REASONS = {
    "bar_step_implicit": REASONS["bar_step_implicit"],
    "bar_caught": REASONS["bar_caught"],
    "cantilever_release": "the period converges from both sides: coarse meshes are too stiff, finer ones too soft",
    "elastica": "the estimate is for small deflections; large ones depend less on the stiffness",
    "toppling": REASONS["toppling"],
    "confined_column_stress": "the error of the recovered stress is proportional to the edge length at the held end",
    "bounce": "errors of three impacts cancel by accident",
    "pendulum": "at this time the pendulum moves perpendicular to the measured direction",
}

PAGE = """# Error bars against known solutions

This page shows how far you can trust the error bars of [`skerry study`](study.md) and the
[error estimates](methods/error_estimates.md) of every run. `scripts/error_bars` studies {all} items (quantities with
known values) and writes this page. [error_bars.csv](error_bars/error_bars.csv) lists values, formulas and orders.

The scenes have coarse meshes and default settings. They were fixed before the first study, except some quantities, and
in `incline_slide` the stiffness of the block and the speed of the push. The rules by which a study computes error bars
were chosen without the last {checks} items ([check_items.py](../profiling/error_bars/check_items.py)). Three faults of
these {checks} were corrected after their first study: missing friction, an inexact formula, and a formula not valid for
finite strain.

| claim | all items | the last {checks} |
|---|---:|---:|
| the true error lies inside the error bar | {inside} | {check_inside} |
| the error bar is at most 3 times the true error | {sharp} | {check_sharp} |
| the error estimate of a single run is within a factor of 3 of the true error | {estimated} | {check_estimated} |

Errors below 0.001 % of the known value (rounding errors) count as 0.001 %. Some known values are inexact, for an impact
by the theory of Hertz by up to 7 %. Their possible error is the column `doubt` of `error_bars.csv`. The first claim
adds it to the error bar. Without this addition the error bars of these items would be too small: {doubted}.

An item with an infinite exact value meets the first two claims if the study calls it {verdicts}. The third claim leaves
out items whose error is below their doubt, because their true error is unknown.

Items that miss {missed}, in % of the known value:

| item | true error | error bar | ratio | reason |
|---|---:|---:|---:|---|
{failures}

Items that miss the third claim, in % of the known value:

| item | true error | estimate | ratio | reason |
|---|---:|---:|---:|---|
{estimates}
"""


def shares(rows):
    """For each claim the number of items that meet it, and the number of all."""
    judged = [row for row in rows if is_judged(row)]
    sharp = sum(row["bar_over_error"] <= SHARP or math.isnan(row["known"]) and row["inside"] for row in rows)
    return {"inside": f"{sum(row['inside'] for row in rows)} of {len(rows)}", "sharp": f"{sharp} of {len(rows)}",
            "estimated": f"{sum(is_near(row) for row in judged)} of {len(judged)}"}


def write_page(rows):
    """Writes docs/error_bars.md and the table."""
    known = [row for row in rows if math.isfinite(row["known"])]
    missed = [row for row in known if not (row["inside"] and row["bar_over_error"] <= SHARP)]
    all_inside = all(row["inside"] for row in known)
    failures = "\n".join(
        f"| `{row['item']}` | {100 * abs(row['error'] / row['known']):.2g} "
        f"| {100 * abs(row['bar'] / row['known']):.2g} | {row['bar_over_error']:.1f} "
        f"| {REASONS.get(row['item'], row['sentence'])} |" for row in missed)
    judged = [row for row in known if is_judged(row)]
    estimates = "\n".join(
        f"| `{row['item']}` | {100 * abs(row['error'] / row['known']):.2g} "
        f"| {100 * abs(row['estimate'] / row['known']):.2g} | {row['estimate_over_error']:.2g} "
        f"| {ESTIMATE_REASONS.get(row['item'], '')} |" for row in judged if not is_near(row))
    checks = {item.name for item in check_items.items()}
    check_rows = [row for row in rows if row["item"] in checks]
    DOCS.mkdir(exist_ok=True)
    write_table(rows, DOCS / "error_bars.csv")
    DOCS.with_suffix(".md").write_text(PAGE.format(
        all=len(rows), checks=len(checks), estimates=estimates, **shares(rows),
        missed="the second claim" if all_inside else "one of the first two claims",
        **{f"check_{name}": share for name, share in shares(check_rows).items()},
        doubted=", ".join(f"`{row['item']}` (doubt {100 * row['doubt'] / abs(row['known']):.2g} %)" for row in known
                          if row["error"] > row["bar"] + EXACT * abs(row["known"]) and row["inside"]),
        verdicts=" or ".join(sorted({f"`{item.verdict}`" for item in all_items() if item.verdict})), failures=failures))


def all_items():
    return static_items.items() + motion_items.items() + check_items.items()


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
        # Items of one scene share a study: its second one only reads the results of the first.
        folder = arguments.out / item.name.removesuffix("_stress")
        rows.append(study(arguments.program, item, folder, arguments.threads))
        print(line(rows[-1]), flush=True)
        write_table(rows, arguments.out / "error_bars.csv")
    if arguments.docs:
        write_page(rows)


if __name__ == "__main__":
    sys.exit(main())
