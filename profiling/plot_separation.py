#!/usr/bin/env python3
"""Tables and plots of what profile_separation measured, beside the paper's figures: plot_separation.py FOLDER
[--figures FOLDER ...]"""
import argparse
import collections
import math
import pathlib
import statistics

import plot_style as style
from plot_style import plt

SEPARATE, GLOBAL = "separate", "global"
COLOR = {SEPARATE: style.OURS[0], GLOBAL: style.OURS[1]}


def growth_exponent(x, y):
    """Slope of the straight line through (log x, log y)."""
    x, y = [math.log(v) for v in x], [math.log(v) for v in y]
    mean_x, mean_y = statistics.fmean(x), statistics.fmean(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def contact_seconds(row):
    return row["seconds_separate"] + row["seconds_solve"]


def by_bin(rows):
    """Median contacts and seconds of rows in bins of contacts, a factor of 1.5 wide."""
    bins = collections.defaultdict(list)
    for row in rows:
        if row["contacts"] >= 1:
            bins[round(math.log(row["contacts"], 1.5))].append(row)
    return {b: (statistics.median(r["contacts"] for r in group), statistics.median(map(contact_seconds, group)))
            for b, group in sorted(bins.items())}


def speed_up(rows):
    """Global over separate time at the same number of contacts: geometric mean over the bins that both runs have.
    Frames are not paired: the two runs of a collision part after a while."""
    middle = {mode: by_bin([r for r in rows if r["mode"] == mode]) for mode in (SEPARATE, GLOBAL)}
    return style.geometric_mean([middle[GLOBAL][b][1] / middle[SEPARATE][b][1] for b in middle[SEPARATE]
                                 if b in middle[GLOBAL]])


def report_scenes(rows, table):
    paper = {"bucket": "7-8 x (static, 1 to 80 contacts)", "skittles": "2.5-3 x (dynamic)"}
    for scene in ("bucket", "skittles"):
        for handling in dict.fromkeys(r["handling"] for r in rows):
            chosen = [r for r in rows if r["scene"] == scene and r["handling"] == handling]
            small = [r for r in chosen if r["contacts"] <= 80]
            large = [r for r in chosen if r["contacts"] > 80]
            for part, what in ((small, "up to 80 contacts"), (large, "above 80 contacts")):
                if part:
                    table.append([f"{scene}, {handling}: global over separate time, {what}", f"{speed_up(part):.2f} x",
                                  paper[scene] if what.startswith("up") or scene == "skittles" else "-"])


def plot_scenes(rows, folders):
    handlings = list(dict.fromkeys(r["handling"] for r in rows))
    figure, axes = plt.subplots(len(handlings), 2, figsize=(11, 3.9 * len(handlings)), squeeze=False)
    for line, handling in zip(axes, handlings):
        for axis, scene, title in zip(line, ("bucket", "skittles"),
                                      ("balls at rest in a bucket", "a ball strikes skittles")):
            for mode in (GLOBAL, SEPARATE):
                chosen = [r for r in rows if r["scene"] == scene and r["handling"] == handling and r["mode"] == mode]
                axis.scatter([r["contacts"] for r in chosen], [1e6 * contact_seconds(r) for r in chosen], s=8,
                             alpha=0.3, color=COLOR[mode], linewidths=0)
                middle = by_bin(chosen)
                axis.plot([m[0] for m in middle.values()], [1e6 * m[1] for m in middle.values()], color=COLOR[mode],
                          marker="o",
                          markersize=4, label="all contacts together" if mode == GLOBAL else "region by region")
            axis.set(xscale="log", yscale="log", xlim=(0.8, None), title=f"{title}, {handling}",
                     xlabel="contacts in the step", ylabel="separation and solution (us a step)")
            style.plain_decades(axis)
            axis.legend(loc="upper left")
    style.save(figure, folders, "separation_scenes.png")


def report_dense(rows, table):
    for scene, paper in (("bucket", "7-8 x (static, 1 to 80 contacts)"), ("skittles", "2.5-3 x (dynamic)")):
        for low, high in ((2, 20), (21, 80), (81, 1000)):
            chosen = [r for r in rows if r["scene"] == scene and low <= r["contacts"] <= high]
            if chosen:
                ratio = style.geometric_mean([r["seconds_global"] / r["seconds_separate"] for r in chosen])
                table.append([f"{scene}, dense matrices: all together over by region, {low} to {high} contacts",
                              f"{ratio:.1f} x", paper])


def plot_dense(rows, folders):
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2), sharey=True)
    for axis, scene, title in zip(axes, ("bucket", "skittles"),
                                  ("balls at rest in a bucket", "a ball strikes skittles")):
        for key, label, color in (("seconds_global", "one dense matrix of all contacts", COLOR[GLOBAL]),
                                  ("seconds_separate", "one dense matrix a region", COLOR[SEPARATE]),
                                  ("seconds_sparse", "sparse, by region", style.OURS[2])):
            chosen = [r for r in rows if r["scene"] == scene]
            axis.scatter([r["contacts"] for r in chosen], [1e6 * r[key] for r in chosen], s=14, color=color,
                         label=label, linewidths=0)
        axis.set(xscale="log", yscale="log", title=f"{title}: dense matrices", xlabel="contacts in the step")
        style.plain_decades(axis)
        axis.legend(loc="upper left")
    axes[0].set_ylabel("solution of the step's contacts (us)")
    style.save(figure, folders, "separation_dense.png")


def report_growth(rows, table):
    for method in dict.fromkeys(r["method"] for r in rows):
        for mode in (SEPARATE, GLOBAL):
            chosen = [r for r in rows if r["method"] == method and r["mode"] == mode]
            exponent = growth_exponent([r["contacts"] for r in chosen], [contact_seconds(r) for r in chosen])
            table.append([f"regions of 8 contacts, {method}, {mode}: time grows as contacts to the power",
                          f"{exponent:.2f}", "1 (linear, separate)" if mode == SEPARATE else "-"])


def plot_growth(rows, sweeps, folders):
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2))
    for method, line in (("pcg_pgs", "-"), ("pgs", "--")):
        for mode in (GLOBAL, SEPARATE):
            chosen = [r for r in rows if r["method"] == method and r["mode"] == mode]
            left.plot([r["contacts"] for r in chosen], [1e3 * contact_seconds(r) for r in chosen], line,
                      color=COLOR[mode], marker="o",
                      markersize=4, label=f"{'all together' if mode == GLOBAL else 'by region'}, {method}")
    ends = [min(r["contacts"] for r in rows), max(r["contacts"] for r in rows)]
    first = min(contact_seconds(r) for r in rows if r["mode"] == SEPARATE and r["contacts"] == ends[0])
    left.plot(ends, [1e3 * first * e / ends[0] / 1.6 for e in ends], color="#888888", linestyle=":",
              label="linear growth")
    left.set(xscale="log", yscale="log", xlabel="contacts, in regions of 8", ylabel="separation and solution (ms)",
             title="time against contacts, regions of one size")
    left.legend()
    contacts = [r["contacts"] for r in sweeps]
    right.plot(contacts, [1e9 * r["seconds_separate"] / r["contacts"] for r in sweeps], color=style.OURS[0], marker="o",
               label="separation (union-find)")
    right.plot(contacts, [1e9 * r["seconds_sweep"] / r["contacts"] for r in sweeps], color=style.OURS[3], marker="o",
               label="one Gauss-Seidel sweep")
    right.set(xscale="log", ylim=(0, None), xlabel="contacts", ylabel="time (ns a contact)",
              title="what separation costs")
    right.legend()
    style.save(figure, folders, "separation_growth.png")


def report_cone(rows, table):
    for method in dict.fromkeys(r["method"] for r in rows):
        for tolerance in sorted({r["tolerance"] for r in rows}, reverse=True):
            chosen = [r for r in rows if r["method"] == method and r["tolerance"] == tolerance]
            iterations = 1 - style.geometric_mean([r["cone_iterations"] / r["pyramid_iterations"] for r in chosen])
            seconds = 1 - style.geometric_mean([r["cone_seconds"] / r["pyramid_seconds"] for r in chosen])
            table.append([f"cone instead of pyramid, {method} to {tolerance:g}: iterations saved (time saved)",
                          f"{100 * iterations:.0f} % ({100 * seconds:.0f} %)", "20-40 %"])


def plot_cone(rows, folders):
    kinds = list(dict.fromkeys(r["kind"] for r in rows))
    cases = [(m, t) for m in ("pcg_pgs", "pgs") for t in (1e-3, 1e-6)]
    figure, axis = plt.subplots(figsize=(9, 0.55 * len(kinds) + 1.8))
    for i, (method, tolerance) in enumerate(cases):
        places, saved = [], []
        for k, kind in enumerate(kinds):
            chosen = [r["cone_iterations"] / r["pyramid_iterations"] for r in rows
                      if r["kind"] == kind and r["method"] == method and r["tolerance"] == tolerance]
            if chosen:
                places.append(k + (i - 1.5) * 0.2)
                saved.append(100 * (1 - style.geometric_mean(chosen)))
        axis.barh(places, saved, height=0.18, color=style.OURS[i], label=f"{method}, tolerance {tolerance:g}")
    axis.axvspan(20, 40, color="#000000", alpha=0.08, label="the paper")
    axis.set_yticks(range(len(kinds)), kinds)
    axis.set(xlabel="iterations saved by the cone instead of the pyramid (%)")
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)
    style.legend_above(figure, axis, 3)
    style.save(figure, folders, "separation_cone.png")


POOR = 1e-3  # an error above this, the default tolerance of a step, is a badly converged case


def poor_share(rows, method, limit):
    chosen = [r["error"] for r in rows if r["method"] == method and r["limit"] == limit]
    return sum(not e <= POOR for e in chosen) / len(chosen)


def report_poor(rows, table):
    paper = {"pgs": "3 %", "pcg_pgs": "0 to some tenths of a per cent"}
    for limit in sorted({r["limit"] for r in rows}):
        for method in dict.fromkeys(r["method"] for r in rows):
            table.append([f"error above {POOR:g} after {limit:g} iterations, cold, {method}",
                          f"{100 * poor_share(rows, method, limit):.2f} % of {len(set(r['problem'] for r in rows))}",
                          paper.get(method, "-")])


def plot_poor(rows, folders):
    limits = sorted({r["limit"] for r in rows})
    figure, axes = plt.subplots(1, len(limits), figsize=(11, 4), sharey=True)
    for axis, limit in zip(axes, limits):
        for i, method in enumerate(dict.fromkeys(r["method"] for r in rows)):
            errors = sorted(max(r["error"], 1e-9) if math.isfinite(r["error"]) else 1e3 for r in rows
                            if r["method"] == method and r["limit"] == limit)
            share = [100 * (1 - k / len(errors)) for k in range(len(errors))]
            axis.step(errors, share, where="post", color=style.OURS[i], label=method)
        axis.axvline(POOR, color="black", linewidth=1, linestyle=":")
        axis.set(xscale="log", yscale="log", xlim=(1e-6, 1), ylim=(0.1, 110), xlabel="error left",
                 title=f"after {limit:g} iterations, from zero")
    axes[0].set_ylabel("problems with more error (%)")
    axes[-1].legend()
    style.save(figure, folders, "separation_poor_cases.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--figures", action="append", default=[],
                        help="folder for the plots; may be given more than once")
    arguments = parser.parse_args()
    folders = arguments.figures or [arguments.folder]
    tables = {name: style.read_csv(arguments.folder / f"{name}.csv")
              for name in ("scenes", "dense", "growth", "sweep", "cone", "poor")
              if (arguments.folder / f"{name}.csv").exists()}
    table = []
    if "scenes" in tables:
        report_scenes(tables["scenes"], table)
        plot_scenes(tables["scenes"], folders)
    if "dense" in tables and tables["dense"]:
        report_dense(tables["dense"], table)
        plot_dense(tables["dense"], folders)
    if "growth" in tables and "sweep" in tables:
        report_growth(tables["growth"], table)
        for row in tables["sweep"]:
            table.append([f"separation over one sweep, {row['contacts']:g} contacts "
                          f"({1e9 * row['seconds_separate'] / row['contacts']:.0f} "
                          f"ns a contact)", f"{row['seconds_separate'] / row['seconds_sweep']:.2f}", "-"])
        plot_growth(tables["growth"], tables["sweep"], folders)
    if "cone" in tables and tables["cone"]:
        report_cone(tables["cone"], table)
        plot_cone(tables["cone"], folders)
    if "poor" in tables and tables["poor"]:
        report_poor(tables["poor"], table)
        plot_poor(tables["poor"], folders)
    print()
    style.print_table(["measured", "here", "the paper"], table)


if __name__ == "__main__":
    main()
