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
import time

import motion_items
import static_items

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
EXACT = 1e-5  # smaller errors, relative to the scale of the quantity, count as this error
COLUMNS = ["item", "quantity", "formula", "unit", "known", "doubt", "value", "error", "bar", "mesh", "step", "contact",
           "mesh_order", "step_order", "verdict", "bar_over_error", "inside", "estimate", "estimate_over_error",
           "wall_ratio", "sentence"]


def number(text):
    return float(text) if text else math.nan


def estimated_error(item, statistics):
    """Relative error of the value by the estimates of a run: that of its stress, or of its mesh and its steps."""
    def worst(*keys):
        errors = statistics["trust"].get("errors", [])
        values = [sum(abs(body[key] or 0) for key in keys) for body in errors if any(body[key] for key in keys)]
        return max(values, default=math.nan)
    return worst("stress") if item.probe.startswith("all.") else worst("deflection", "step")


def study(program, item, folder, threads):
    """Runs an item and its study. Returns a row of the table."""
    scene, text = folder / "scene.json", json.dumps({"name": item.name, **item.scene}, indent=1)
    if scene.exists() and scene.read_text() != text:
        shutil.rmtree(folder)  # runs of another version of the item
    folder.mkdir(parents=True, exist_ok=True)
    scene.write_text(text)
    for name, text in item.meshes.items():
        (folder / name).write_text(text)
    subprocess.run([program, "run", scene, "--quiet", "--threads", "1", "--stats", folder / "stats.json"], check=True,
                   stderr=subprocess.DEVNULL)
    statistics = json.loads((folder / "stats.json").read_text())
    start = time.monotonic()
    subprocess.run([program, "study", scene, "--quiet", "--threads", str(threads), "--out",
                    folder / "study"], check=True)
    took = time.monotonic() - start
    with open(folder / "study" / "study.csv", newline="") as stream:
        quantities = {row["quantity"]: row for row in csv.DictReader(stream)}
    quantity = f"{item.probe}_{item.at}"
    found = quantities[quantity]
    value, bar = number(found["value"]), number(found["error"])
    error = abs(value - item.truth)
    doubt = item.doubt * abs(item.truth)
    least = max(error, EXACT * abs(item.truth))
    estimate = estimated_error(item, statistics) * abs(value)
    return {"item": item.name, "quantity": quantity, "formula": item.formula, "unit": found["unit"],
            "known": item.truth, "doubt": doubt, "value": value, "error": error, "bar": bar,
            **{key: number(found[key]) for key in ("mesh", "step", "contact", "mesh_order", "step_order")},
            "verdict": found["verdict"], "bar_over_error": bar / least,
            "inside": int(error <= bar + doubt + EXACT * abs(item.truth)), "estimate": estimate,
            "estimate_over_error": estimate / least, "wall_ratio": took / statistics["seconds_wall"],
            "sentence": found["sentence"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("items", nargs="*")
    parser.add_argument("--docs", action="store_true")
    parser.add_argument("--threads", type=int, default=0)
    arguments = parser.parse_args()
    items = static_items.items() + motion_items.items()
    rows = []
    for item in items:
        if arguments.items and item.name not in arguments.items:
            continue
        row = study(arguments.program, item, arguments.out / item.name, arguments.threads)
        rows.append(row)
        print("{item:22s} error {error:9.3g} of {known:9.3g} {unit:5s} bar {bar:9.3g} (mesh {mesh:.2g}, step {step:.2g}, "
              "contact {contact:.2g}) bar/error {bar_over_error:6.2f} orders {mesh_order:.2f} {step_order:.2f} estimate/error "
              "{estimate_over_error:.2f} {verdict} {sentence}".format(**row)[:400], flush=True)
    arguments.out.mkdir(parents=True, exist_ok=True)
    with open(arguments.out / "error_bars.csv", "w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS)
        writer.writeheader()
        writer.writerows({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()}
                         for row in rows)


if __name__ == "__main__":
    sys.exit(main())
