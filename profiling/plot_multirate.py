#!/usr/bin/env python3
"""Table and plot of what profile_multirate measured: plot_multirate.py FOLDER [--figures FOLDER ...]"""
import argparse
import collections
import pathlib

import plot_style as style
from plot_style import plt

ONE, MULTI = "one step", "multirate"
INTEGRATORS = ["symplectic_euler", "leapfrog"]
COLOR = {ONE: style.OURS[1], MULTI: style.OURS[0]}
TITLE = {"slivers": "1 % slivers, their stable step a sixteenth", "stiff on soft": "a stiff ball on a soft block"}


def time_to(rows, error):
    """CPU seconds of the cheapest run with at most this error; None if there is none."""
    return min((r["cpu_seconds"] for r in rows if r["error"] <= error), default=None)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--figures", action="append", default=[])
    options = parser.parse_args()
    series = collections.defaultdict(list)
    for row in style.read_csv(options.folder / "multirate.csv"):
        series[row["scene"], row["integrator"], row["mode"]].append(row)
    scenes = list(dict.fromkeys(key[0] for key in series))

    table = []
    for scene in scenes:
        for integrator in INTEGRATORS:
            one, multi = series[scene, integrator, ONE], series[scene, integrator, MULTI]
            for a, b in zip(one, multi):
                equal = time_to(one, b["error"])
                table.append([scene, integrator, f"{a['safety']:g}", f"{a['error']:.2g}", f"{b['error']:.2g}",
                              f"{100 * b['impulse_share']:.1f} %", f"{a['cpu_seconds'] / b['cpu_seconds']:.2f}",
                              f"{equal / b['cpu_seconds']:.2f}" if equal else "-"])
    style.print_table(["scene", "integrator", "safety", "error, m", "multirate", "forces", "faster, same step",
                       "to that error"], table)

    figure, axes = plt.subplots(1, len(scenes), figsize=(4.6 * len(scenes), 3.9), squeeze=False)
    for axis, scene in zip(axes[0], scenes):
        for integrator, dash in zip(INTEGRATORS, style.DASHES):
            for mode in (ONE, MULTI):
                rows = series[scene, integrator, mode]
                axis.loglog([r["cpu_seconds"] for r in rows], [r["error"] for r in rows], dash, marker="o",
                            color=COLOR[mode], label=f"{mode}, {integrator.replace('_', ' ')}")
        axis.set_title(TITLE[scene])
        axis.set_xlabel("CPU time, s")
        axis.set_ylabel("position error, m (root mean square)")
    style.legend_above(figure, axes[0][0], 2)
    style.save(figure, options.figures, "multirate.png")


main()
