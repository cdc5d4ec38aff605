#!/usr/bin/env python3
"""Tables and plots of what profile_work_precision measured: plot_work_precision.py FOLDER [--figures FOLDER ...]
[--no-plots]"""
import argparse
import collections
import math
import pathlib
import statistics

import plot_style as style
from plot_style import plt

WORST = 2  # larger errors say no more than that the run is lost
ENGINES = ("Skerry", "Bullet", "MuJoCo")
LOOK = {"Skerry": "-", "Bullet": "--", "MuJoCo": "-."}


def good(value):
    return isinstance(value, float) and math.isfinite(value) and value > 0


def curves(rows):
    """Rows by (engine, variant), in the order of the file."""
    found = collections.OrderedDict()
    for row in rows:
        found.setdefault((row["engine"], row["variant"]), []).append(row)
    return found


def colours(keys):
    mark = {}
    for engine in ENGINES:
        golden = ["#b8860b", "#d9a520", "#8a6508"]
        palette = style.OURS if engine == "Skerry" else style.THEIRS if engine == "Bullet" else golden
        for place, key in enumerate(k for k in keys if k[0] == engine):
            mark[key] = palette[place % len(palette)]
    return mark


def front(rows, error):
    """The points (seconds, error) that no other one beats in both."""
    best, kept = math.inf, []
    for seconds, value in sorted((r["seconds"], r[error]) for r in rows if r["finished"] == 1 and good(r[error])
                                 and r[error] < WORST):
        if value < best:
            best = value
            kept.append((seconds, value))
    return kept


def seconds_at(points, error):
    """Time at which a front reaches an error: power laws between its points, the first point before it, none behind its
    end."""
    for (s0, e0), (s1, e1) in zip(points, points[1:]):
        if e0 >= error >= e1:
            share = math.log(e0 / error) / math.log(e0 / e1)
            return s0 * (s1 / s0) ** share
    return points[0][0] if points and points[0][1] <= error else math.inf


def order(points):
    """Slope of error over step in the last two halvings."""
    if len(points) < 3:
        return math.nan
    return math.log(points[-3][1] / points[-1][1]) / math.log(points[-3][0] / points[-1][0])


def print_time(rows):
    print("Time step: where each peer ends by its own reference (its shortest step), and ours at that error. `ratio`: "
          "its time over ours; "
          "`smaller`: its smallest error over ours; `apart`: how far its smallest step is from our reference.")
    table = []
    for scene in scenes_of(rows):
        here = [r for r in rows if r["scene"] == scene]
        own = front([r for r in here if r["engine"] == "Skerry"], "error")
        floor = here[0]["reference_error"]
        for engine in ENGINES[1:]:
            theirs = [r for r in here if r["engine"] == engine]
            points = front(theirs, "error_own")
            if not points or not own:
                continue
            seconds, error = points[-1]
            ours = seconds_at(own, error)
            coarse_seconds, coarse_error = points[0]
            apart = min((r["error"] for r in theirs if good(r["error"])), default=math.nan)
            table.append([scene, engine, f"{error:.1e}", style.seconds_text(seconds), style.seconds_text(ours),
                          f"{seconds / ours:.1f}" if ours < math.inf else "-", f"{coarse_error:.1e}",
                          f"{coarse_seconds / seconds_at(own, coarse_error):.1f}", f"{own[-1][1]:.1e}",
                          f"{error / own[-1][1]:.1f}", f"{floor:.1e}", f"{apart:.1e}"])
    style.print_table(["scene", "peer", "ends at", "its time", "ours", "ratio", "starts at", "ratio", "our smallest",
                       "smaller", "reference +-", "apart"], table)
    print("Order in the step (last two halvings), and microseconds a step")
    table = []
    for scene in scenes_of(rows):
        for (engine, variant), found in curves([r for r in rows if r["scene"] == scene]).items():
            error = "error" if engine == "Skerry" else "error_own"
            points = [(r["step"], r[error]) for r in found if r["finished"] == 1 and good(r[error])
                      and r[error] < WORST]
            steps = [r for r in found if r["finished"] == 1 and r["steps"] > 0]
            if len(points) >= 3:
                table.append([scene, engine, variant, f"{order(points):.2f}",
                              f"{1e6 * steps[-1]['seconds'] / steps[-1]['steps']:.1f}"])
    style.print_table(["scene", "engine", "variant", "order", "us/step"], table)


def print_mesh(rows):
    print("Mesh: the smallest error that linear elements and Bullet reach with the finest mesh compared, and the time "
          "in which smoothed elements reach it (<: their coarsest mesh is better)")
    table = []
    for scene in scenes_of(rows):
        here = [r for r in rows if r["scene"] == scene]
        own = front([r for r in here if r["variant"] == "smoothed"], "error")
        floor = here[0]["reference_error"]
        for (engine, variant), found in curves(here).items():
            points = front(found, "error")
            if variant == "smoothed" or not points:
                continue
            seconds, error = points[-1]
            ours = seconds_at(own, error)
            bound = "<" if own[0][1] < error else ""
            table.append([scene, f"{engine} {variant}", f"{error:.1e}", style.seconds_text(seconds),
                          bound + style.seconds_text(ours) if ours < math.inf else "-",
                          f"{seconds / ours:.1f}" if ours < math.inf else "-", f"{own[-1][1]:.1e}", f"{floor:.1e}"])
    style.print_table(["scene", "elements", "ends at", "its time", "smoothed", "ratio", "smoothed end at",
                       "reference +-"], table)


def scenes_of(rows):
    return list(dict.fromkeys(r["scene"] for r in rows))


def draw(axis, rows, mark, both):
    for key, found in curves(rows).items():
        engine, variant = key
        kept = [r for r in found if r["finished"] == 1 and good(r["error"]) and r["error"] < WORST]
        points = sorted((r["seconds"], r["error"]) for r in kept)
        single = len(points) == 1
        axis.plot([p[0] for p in points], [p[1] for p in points], LOOK[engine] if not single else "",
                  marker="*" if single else "o",
                  markersize=11 if single else 3.5, color=mark[key], label=f"{engine} {variant}")
        if both and engine != "Skerry":
            own = sorted((r["seconds"], r["error_own"]) for r in kept if good(r["error_own"])
                         and r["error_own"] < WORST)
            axis.plot([p[0] for p in own], [p[1] for p in own], ":", marker="o", markersize=3.5, markerfacecolor="none",
                      color=mark[key])
    axis.set(xscale="log", yscale="log")
    floor = rows[0]["reference_error"]
    if good(floor):
        low = max(axis.get_ylim()[0], floor / 5)  # nothing below the error of the reference says anything
        axis.set_ylim(bottom=low)
        axis.axhspan(low, floor, color="#eeeeee", zorder=0)


def plot_axis(rows, axis_name, title, folders, file, both=False):
    rows = [r for r in rows if r["axis"] == axis_name]
    scenes = scenes_of(rows)
    if not scenes:
        return
    columns = min(3, len(scenes))
    lines = math.ceil(len(scenes) / columns)
    figure, axes = plt.subplots(lines, columns, figsize=(4.7 * columns, 3.8 * lines + 1), squeeze=False)
    mark = colours(list(curves(rows)))
    for axis, scene in zip(axes.flat, scenes):
        here = [r for r in rows if r["scene"] == scene]
        draw(axis, here, mark, both)
        axis.set_title(f"{scene}, {here[0]['simulated']:.3g} s"
                       + (f", {int(here[0]['tetrahedra'])} tetrahedra" if axis_name != "mesh" else ""))
    for axis in axes.flat[len(scenes):]:
        axis.set_visible(False)
    for axis in axes[:, 0]:
        axis.set_ylabel("error, part of the body's size")
    for axis in axes[-1]:
        axis.set_xlabel("CPU time of the run (s)")
    figure.supxlabel(title, fontsize=9)
    style.legend_above(figure, axes.flat[0], 4)
    style.save(figure, folders, file)


def print_creep(rows):
    print("Creep (mean m/s in the second after settling) below the cone; `-`: the run was lost")
    fractions = sorted({r["fraction"] for r in rows})
    table = []
    keys = list(dict.fromkeys((r["engine"], r["variant"], r["step"]) for r in rows))
    for key in keys:
        mine = {r["fraction"]: r for r in rows if (r["engine"], r["variant"], r["step"]) == key}
        if any(f not in mine for f in fractions):
            continue
        table.append([key[0], key[1], f"1/{1 / key[2]:.0f}"]
                     + [f"{mine[f]['creep']:.1e}" if mine[f]["finished"] == 1 else "-" for f in fractions] +
                     [style.seconds_text(mine[fractions[0]]["seconds"])])
    style.print_table(["engine", "variant", "step (s)"] + [f"{100 * f:.0f} % of mu N" for f in fractions]
                      + ["CPU time"], table)


def largest_gap(a, b):
    """Two-sample Kolmogorov-Smirnov statistic, and the value that it exceeds by chance in 1 % of the cases."""
    values = sorted(a + b)
    gap = max(abs(sum(x <= v for x in a) / len(a) - sum(x <= v for x in b) / len(b)) for v in values)
    return gap, 1.628 * math.sqrt((len(a) + len(b)) / (len(a) * len(b)))


def pile_groups(rows):
    groups = collections.OrderedDict()
    for r in rows:
        step = "" if r["engine"] == "Skerry" else f", 1/{1 / r['step']:.0f} s"
        groups.setdefault((r["engine"], f"{r['variant']}{step}"), []).append(r)
    return groups


def print_pile(rows):
    print("Pile: mean and standard deviation over the runs; KS against the reference ensemble (centre of mass), and "
          "its 1 % limit")
    groups = pile_groups(rows)
    reference = [r["height"] for r in rows if r["variant"] == "reference"]
    table = []
    for (engine, name), found in groups.items():
        kept = [r for r in found if r["finished"] == 1]
        if len(kept) < 2:
            table.append([engine, name, f"{len(kept)}/{len(found)}"] + ["-"] * 6)
            continue
        def text(key, factor):
            values = [factor * r[key] for r in kept]
            return f"{statistics.mean(values):.2f} +- {statistics.stdev(values):.2f}"
        gap, limit = largest_gap([r["height"] for r in kept], reference)
        table.append([engine, name, f"{len(kept)}/{len(found)}", text("height", 1e3), text("top", 1e3),
                      text("kinetic", 1e3),
                      f"{gap:.2f}", f"{limit:.2f}", style.seconds_text(statistics.median(r["seconds"] for r in kept))])
    style.print_table(["engine", "variant", "runs", "centre (mm)", "top (mm)", "kinetic (mJ)", "KS", "limit",
                       "CPU time"], table)


def plot_pile(rows, folders):
    groups = {k: [r for r in found if r["finished"] == 1] for k, found in pile_groups(rows).items()}
    groups = {k: found for k, found in groups.items() if found}
    figure, axes = plt.subplots(1, 3, figsize=(14, 4.2))
    mark = colours(list(groups))
    for axis, (key, label, factor) in zip(axes, (("height", "centre of mass (mm)", 1e3), ("top", "top (mm)", 1e3),
                                                 ("kinetic", "kinetic energy (mJ)", 1e3))):
        for group, found in groups.items():
            values = [factor * r[key] for r in found]
            seconds = statistics.median(r["seconds"] for r in found)
            axis.errorbar(seconds, statistics.mean(values), yerr=statistics.stdev(values) if len(values) > 1 else 0,
                          fmt="o", capsize=3, color=mark[group], label=f"{group[0]} {group[1]}")
        axis.set(xscale="log", xlabel="CPU time of a run (s)", ylabel=label)
    axes[2].set_yscale("log")
    style.legend_above(figure, axes[0], 4)
    style.save(figure, folders, "work_precision_pile.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--figures", action="append", default=[],
                        help="folder for the plots; may be given more than once")
    parser.add_argument("--no-plots", action="store_true")
    arguments = parser.parse_args()
    rows = style.read_csv(arguments.folder / "work_precision.csv")
    files = {name: arguments.folder / f"{name}.csv" for name in ("pile", "creep")}
    read = {name: style.read_csv(file) if file.exists() else [] for name, file in files.items()}
    steps = [r for r in rows if r["axis"] == "time"]
    if steps:
        print_time(steps)
    meshes = [r for r in rows if r["axis"] == "mesh"]
    if meshes:
        print_mesh(meshes)
    if read["pile"]:
        print_pile(read["pile"])
    if read["creep"]:
        print_creep(read["creep"])
    if {r["engine"] for r in rows} == {"Skerry"}:
        print("No peer is part of this build. On Debian: apt-get install libbullet-dev; for MuJoCo: pip install "
              "mujoco. Then run this again.\n")
    if arguments.no_plots:
        return
    folders = arguments.figures or [str(arguments.folder)]
    plot_axis(rows, "time", "star: settings as delivered; dotted: the peer against its own shortest step; grey: error "
                            "of our reference", folders,
              "work_precision_time.png", both=True)
    plot_axis(rows, "solver", "one step, tolerances 1e-1 to 1e-10; grey: two methods at 1e-12 differ by this", folders,
              "work_precision_solver.png")
    plot_axis(rows, "mesh", "meshes from coarse to fine; grey: the two finest differ by this", folders,
              "work_precision_mesh.png")
    if read["pile"]:
        plot_pile(read["pile"], folders)


if __name__ == "__main__":
    main()
