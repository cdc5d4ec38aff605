#!/usr/bin/env python3
"""Tables (Markdown) and a plot of what profile_stiff_peers measured: plot_stiff_peers.py FOLDER
[--figures FOLDER ...]"""
import argparse
import math
import pathlib

import plot_style as style
from plot_style import plt

ENGINES = {"Skerry": style.OURS[0], "MuJoCo": style.OURS[3], "Drake": "#555555"}
MARKERS = "osD^vP*X"


def known(value):
    return isinstance(value, float) and math.isfinite(value)


def number(value, form, factor=1):
    return format(factor * value, form) if known(value) else "-"


def cost(row):
    """Median, and the span of the repeats."""
    if row["finished"] != 1:
        return f"> {row['cpu_seconds']:.3g}"
    text = f"{row['cpu_seconds']:.3g}"
    return text if row["runs"] < 2 else f"{text} ({row['cpu_lowest']:.2g}-{row['cpu_highest']:.2g})"


def step_text(row):
    return f"{1e3 * row['step']:.3g}"


def print_rows(title, head, rows):
    print(f"\n{title}\n")
    print("| " + " | ".join(head) + " |")
    print("|---" * len(head) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |")


def groups(rows):
    """Rows by who ran them, in the order of the file."""
    found = {}
    for row in rows:
        found.setdefault((row["engine"], row["setting"], row["step"]), []).append(row)
    return found.values()


def print_incline(rows):
    table = []
    moduli = (1e6, 1e8, 1e10)
    for group in groups([r for r in rows if r["scene"] in ("holds", "slides")]):
        by_place = {(r["scene"], r["modulus"]): r for r in group}

        def line(scene, column, form, factor=1):
            return " / ".join(number(by_place.get((scene, e), {}).get(column), form, factor) for e in moduli)
        middle = by_place.get(("slides", 1e8))
        table.append([group[0]["engine"], group[0]["setting"], step_text(group[0]), line("holds", "creep", ".1e"),
                      line("slides", "acceleration_error", ".2g", 100), cost(middle) if middle else "-"])
    if table:
        print_rows("Incline", ["engine", "setting", "step (ms)", "creep (m/s), E = 1e6 / 1e8 / 1e10",
                               "error of acceleration (%)", "CPU s a simulated s"], table)


def print_cantilever(rows):
    table = [[f"{r['modulus']:.0e}", r["engine"], r["setting"], step_text(r), number(r["period"], ".4g"),
              number(r["peak"], ".4g", 1e3), number(r["left"], ".3f"), cost(r)]
             for r in rows if r["scene"] == "cantilever"]
    if table:
        print_rows("Cantilever", ["E (Pa)", "engine", "setting", "step (ms)", "T1 (s)", "peak (mm)", "left",
                                  "CPU s a simulated s"], table)


def print_rest(rows, scene):
    table = [[r["engine"], r["setting"], step_text(r), number(r["speed"], ".1e"),
              f"{number(r['overlap'], '.2g', 1e3)} / {number(r['overlap_at_end'], '.2g', 1e3)}",
              number(r["below_planes"], ".2g", 1e3), cost(r)] for r in rows if r["scene"] == scene]
    if table:
        print_rows(scene.capitalize(), ["engine", "setting", "step (ms)", "speed left (m/s)",
                                        "in other bodies, worst / at the end (mm)", "in floor and walls (mm)",
                                        "CPU s a simulated s"], table)


def print_ball(rows):
    table = [[r["engine"], r["setting"], step_text(r), number(r["peak"], ".1f", 1e3), number(r["peak_time"], ".3f"),
              number(r["overlap"], ".1f", 1e3), cost(r)] for r in rows if r["scene"] == "ball on block"]
    if table:
        print_rows("Ball on block", ["engine", "setting", "step (ms)", "deepest (mm)", "at (s)", "in the block (mm)",
                                     "CPU s a simulated s"], table)


def draw(axis, rows, error, floor=0.0):
    """CPU time against an error; what is below `floor` is drawn there."""
    kinds = {}
    for row in rows:
        value = error(row)
        if row["finished"] != 1 or not known(value) or row["setting"] == "reference":
            continue
        key = (row["engine"], row["setting"])
        kinds.setdefault(key, []).append((row["cpu_seconds"], max(abs(value), floor)))
    count = {engine: 0 for engine in ENGINES}
    for (engine, setting), points in kinds.items():
        axis.loglog(*zip(*points), MARKERS[count[engine] % len(MARKERS)], color=ENGINES[engine], markersize=5.5,
                    markerfacecolor=ENGINES[engine] if count[engine] % 2 == 0 else "none", label=f"{engine} {setting}")
        count[engine] += 1
    axis.set_xlabel("CPU s a simulated s")
    low, high = axis.get_ylim()
    axis.set_ylim(low, high * (high / low) ** 0.6)  # what is above the points is for the legend
    axis.legend(fontsize=6.5, loc="upper left")


def plot(rows, folders):
    def of(scene):
        return [r for r in rows if r["scene"] == scene]
    reference = [r["peak"] for r in of("ball on block") if r["setting"] == "reference"]
    panels = [
        ("creep on an incline (m/s)", of("holds"), lambda r: r["creep"], 1e-12),
        ("error of acceleration", of("slides"), lambda r: r["acceleration_error"], 1e-9),
        ("cantilever: amplitude lost in five periods", of("cantilever"), lambda r: 1 - r["left"], 1e-3),
        ("ball on block: error of the deepest place", of("ball on block"),
         lambda r: r["peak"] / reference[0] - 1 if reference else math.nan, 1e-5),
        ("stack: speed left (m/s)", of("stack"), lambda r: r["speed"], 1e-12),
        ("stack: worst overlap (mm; 0 at the edge)", of("stack"), lambda r: 1e3 * r["overlap"], 1e-2),
        ("pile: speed left (m/s)", of("pile"), lambda r: r["speed"], 1e-12),
        ("pile: worst overlap (mm; 0 at the edge)", of("pile"), lambda r: 1e3 * r["overlap"], 1e-2),
    ]
    figure, axes = plt.subplots(2, 4, figsize=(18, 8.5))
    for axis, (title, found, error, floor) in zip(axes.flat, panels):
        axis.set_title(title)
        axis.set_visible(bool(found))
        if found:
            draw(axis, found, error, floor)
    style.save(figure, folders, "stiff_peers.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", type=pathlib.Path)
    parser.add_argument("--figures", action="append", default=[])
    arguments = parser.parse_args()
    rows = style.read_csv(arguments.table / "stiff_peers.csv")
    print_incline(rows)
    print_cantilever(rows)
    print_rest(rows, "stack")
    print_ball(rows)
    print_rest(rows, "pile")
    print()
    if arguments.figures:
        plot(rows, arguments.figures)


if __name__ == "__main__":
    main()
