#!/usr/bin/env python3
"""Table and plot of what profile_scaling predicted and measured: plot_scaling.py FOLDER [--figures FOLDER ...]"""
import argparse
import collections
import json
import pathlib

import plot_style as style
from plot_style import plt


QUIET = 0.2  # cores that other programs may take; more, and what was measured is no test


def by_scene(rows):
    scenes = collections.defaultdict(list)
    for row in rows:
        scenes[row["scene"]].append(row)
    return scenes


def report(scenes):
    cores = [int(r["cores"]) for r in next(iter(scenes.values())) if r["cores"] > 1]
    measured = [c for c in cores if any(r["cores"] == c and r["measured"] > 0 for rows in scenes.values()
                                        for r in rows)]
    head = ["scene", "tetrahedra", "contacts", "us a step", "serial", "at most", *(str(c) for c in cores),
            *(f"measured, {c}" for c in measured), *(f"off by, {c}" for c in measured), "others, cores"]
    table = []
    for scene, rows in scenes.items():
        row = {int(r["cores"]): r for r in rows}
        first = rows[0]
        table.append([scene, f"{first['tetrahedra']:.0f}", f"{first['contacts']:.0f}", f"{first['us_per_step']:.0f}",
                      f"{100 * first['serial_share']:.1f} %", f"{1 / first['critical_path_share']:.1f}",
                      *(f"{row[c]['predicted']:.2f}" for c in cores), *(f"{row[c]['measured']:.2f}" for c in measured),
                      *(f"{100 * (row[c]['predicted'] / row[c]['measured'] - 1):+.0f} %" for c in measured),
                      f"{max(r['others'] for r in rows):.2f}"])
    style.print_table(head, table)


def report_memory(folder):
    file = folder / "scaling.json"
    memory = json.loads(file.read_text()).get("memory") if file.exists() else None
    if memory:
        style.print_table(["memory", "bytes"], [[key.replace("_", " "), f"{value:.0f}"]
                                                for key, value in memory.items()])


def plot_speed_up(axis, scenes):
    most = max(r["cores"] for rows in scenes.values() for r in rows)
    axis.plot([1, most], [1, most], color="#999999", linewidth=1, linestyle=":", label="as many as cores")
    for i, (scene, rows) in enumerate(scenes.items()):
        color = style.OURS[i % len(style.OURS)]
        axis.plot([r["cores"] for r in rows], [r["predicted"] for r in rows], color=color, label=scene)
        seen = [r for r in rows if r["cores"] > 1 and r["measured"] > 0]
        for r in seen:
            face = color if r["others"] < QUIET else "none"
            axis.plot([r["cores"]], [r["measured"]], "o", color=color, markerfacecolor=face)
    axis.set(xscale="log", yscale="log", xlabel="cores",
             ylabel="times as fast as one core\n(dots: measured; hollow: disturbed)")
    ticks = sorted({r["cores"] for rows in scenes.values() for r in rows})
    axis.set_xticks(ticks, [f"{t:.0f}" for t in ticks])
    axis.set_yticks([t for t in ticks if t <= most], [f"{t:.0f}" for t in ticks if t <= most])
    axis.minorticks_off()


def plot_serial(axis, scenes, stages, most=8):
    """Serial microseconds of each stage, as a share of the work: the stages that have most somewhere."""
    work = {scene: rows[0]["us_per_step"] for scene, rows in scenes.items()}
    share = collections.defaultdict(dict)
    for row in stages:
        share[row["stage"]][row["scene"]] = 100 * row["serial_us_per_step"] / work[row["scene"]]
    largest = sorted(share, key=lambda stage: -max(share[stage].values()))
    names = list(scenes)
    left = [0.0] * len(names)
    for i, stage in enumerate([*largest[:most], "others"]):
        parts = largest[most:] if stage == "others" else [stage]
        values = [sum(share[p].get(scene, 0) for p in parts) for scene in names]
        color = "#bbbbbb" if stage == "others" else style.OURS[(i + 3) % len(style.OURS)]
        axis.barh(range(len(names)), values, left=left, color=color, label=stage.split("/")[-1])
        left = [a + b for a, b in zip(left, values)]
    axis.set_yticks(range(len(names)), names)
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)
    axis.set(xlabel="serial share of a step (%)")
    axis.legend(fontsize=8, loc="lower right")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--figures", action="append", default=[],
                        help="folder for the plots; may be given more than once")
    arguments = parser.parse_args()
    scenes = by_scene(style.read_csv(arguments.folder / "scaling.csv"))
    print()
    report(scenes)
    report_memory(arguments.folder)
    figure, (speed_up, serial) = plt.subplots(1, 2, figsize=(11, 4.6))
    plot_speed_up(speed_up, scenes)
    speed_up.legend(loc="upper left")
    plot_serial(serial, scenes, style.read_csv(arguments.folder / "stages.csv"))
    style.save(figure, arguments.figures or [arguments.folder], "scaling.png")


if __name__ == "__main__":
    main()
