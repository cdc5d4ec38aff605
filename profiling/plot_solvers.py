#!/usr/bin/env python3
"""Tables and plots of what profile_solvers measured: plot_solvers.py FILE.csv [--figures FOLDER ...] [--no-plots]"""
import argparse
import collections
import math

import plot_style as style
from plot_style import plt

TOLERANCES = (1e-3, 1e-6, 1e-9)
SMALLEST = 10  # contacts: smaller problems are over in microseconds and say more about calls than about solvers


class Runs:
    """The rows by (problem, method, tolerance); a row that missed its tolerance has infinite seconds."""

    def __init__(self, rows):
        self.rows = rows
        self.contacts = {r["problem"]: int(r["contacts"]) for r in rows}
        self.problems = sorted(self.contacts, key=lambda p: (self.contacts[p], p))
        self.owner = {r["method"]: r["owner"] for r in rows}
        self.ours = [m for m in self.owner if self.owner[m] == "skerry"]
        self.lumped = [m for m in self.owner if self.owner[m] == "skerry lumped"]
        self.theirs = [m for m in self.owner if self.owner[m] == "siconos"]
        default = [r["method"] for r in rows if r["is_default"] == 1]
        self.default = default[0] if default else self.ours[0]
        self.seconds = collections.defaultdict(lambda: math.inf)
        self.error = {}
        for r in rows:
            if r["converged"] == 1:
                self.seconds[r["problem"], r["method"], r["tolerance"]] = r["seconds"]
                self.error[r["problem"], r["method"], r["tolerance"]] = r["error"]

    def best(self, methods, problem, tolerance):
        return min(((self.seconds[problem, m, tolerance], m) for m in methods), default=(math.inf, "-"))

    def solved(self, method, tolerance):
        return [p for p in self.problems if self.seconds[p, method, tolerance] < math.inf]

    def large(self):
        return [p for p in self.problems if self.contacts[p] >= SMALLEST]


def print_problems(runs, tolerance):
    print(f"Tolerance {tolerance:g}: {runs.default} (default) beside the variant of Siconos that is fastest on that "
          f"very problem")
    table = []
    for problem in runs.problems:
        own = runs.seconds[problem, runs.default, tolerance]
        best, best_name = runs.best(runs.ours, problem, tolerance)
        their, their_name = runs.best(runs.theirs, problem, tolerance)
        table.append([problem, runs.contacts[problem], style.seconds_text(own), style.seconds_text(best),
                      best_name if best < math.inf else "-", style.seconds_text(their),
                      their_name if their < math.inf else "-",
                      f"{their / own:.2f}" if own < math.inf and their < math.inf else "-"])
    style.print_table(["problem", "contacts", runs.default, "our best", "method", "best Siconos", "variant",
                       "Siconos/default"], table)


def print_against_best(runs):
    """The default against the virtual best of Siconos, which no fixed choice of a variant reaches."""
    table = []
    for tolerance in TOLERANCES:
        both = []
        for p in runs.large():
            own, their = runs.seconds[p, runs.default, tolerance], runs.best(runs.theirs, p, tolerance)[0]
            if own < math.inf and their < math.inf:
                both.append((their / own, p))
        ratios = [r for r, _ in both]
        worst = min(both, default=(float("nan"), "-"))
        by_siconos = sum(runs.best(runs.theirs, p, tolerance)[0] < math.inf for p in runs.problems)
        table.append([f"{tolerance:g}", f"{len(runs.solved(runs.default, tolerance))}/{len(runs.problems)}",
                      f"{by_siconos}/{len(runs.problems)}", len(both), f"{style.geometric_mean(ratios):.2f}",
                      f"{worst[0]:.2f}", worst[1], sum(r > 1 for r in ratios)])
    print(f"{runs.default} against the best of Siconos on each problem of {SMALLEST} contacts or more (ratio above 1: "
          f"ours is faster)")
    style.print_table(["tolerance", "solved by us", "by some Siconos", "compared", "mean ratio", "worst ratio", "on",
                       "faster on"], table)


def print_lumped(runs):
    """Contacts of lumped masses as a step of the engine solves them, beside the same as general blocks."""
    lumped = f"{runs.default}, lumped"
    for tolerance in TOLERANCES:
        table = []
        for problem in runs.large():
            own, blocks = runs.seconds[problem, lumped, tolerance], runs.seconds[problem, runs.default, tolerance]
            their, their_name = runs.best(runs.theirs, problem, tolerance)
            if own < math.inf:
                table.append([problem, runs.contacts[problem], style.seconds_text(own), style.seconds_text(blocks),
                              style.seconds_text(their), their_name if their < math.inf else "-",
                              f"{their / own:.1f}" if their < math.inf else "-"])
        if table:
            print(f"Tolerance {tolerance:g}: contacts of lumped masses, as a step solves them")
            style.print_table(["problem", "contacts", "lumped", "blocks", "best Siconos", "variant", "Siconos/lumped"],
                              table)


def print_methods(runs):
    """Each fixed choice: how many it solves, and how its time compares with that of the default where both arrive."""
    for names, title in ((runs.ours, "Our methods"), (runs.theirs, "Fixed variants of Siconos")):
        table = []
        for name in names:
            row = [name]
            for tolerance in TOLERANCES:
                both = [p for p in runs.large() if runs.seconds[p, name, tolerance] < math.inf and
                        runs.seconds[p, runs.default, tolerance] < math.inf]
                ratios = [runs.seconds[p, name, tolerance] / runs.seconds[p, runs.default, tolerance] for p in both]
                row += [len(runs.solved(name, tolerance)), f"{style.geometric_mean(ratios):.2f}",
                        f"{min(ratios, default=float('nan')):.2f}"]
            table.append(row)
        if not table:
            continue
        print(f"{title}: problems solved of {len(runs.problems)}; time over that of {runs.default}, geometric mean and "
              f"smallest, "
              f"{SMALLEST} contacts or more")
        style.print_table(["method"] + [f"{t:g} {what}" for t in TOLERANCES for what in ("solved", "mean", "least")],
                          table)


def looks(runs, theirs):
    look = {name: {"color": style.OURS[i % len(style.OURS)], "linestyle": "-"} for i, name in enumerate(runs.ours)}
    for i, name in enumerate(theirs):
        look[name] = {"color": style.THEIRS[i % len(style.THEIRS)], "linestyle": style.DASHES[i % 4], "linewidth": 1.4}
    look[runs.default]["linewidth"] = 2.8
    return look


def strongest(runs, count):
    """The fixed variants of Siconos that are slower than the best of them by the least, a problem missed counted as a
    thousand times."""
    def slower(name):
        factors = [min(runs.seconds[p, name, t] / runs.best(runs.theirs, p, t)[0], 1e3) for t in TOLERANCES
                   for p in runs.large()
                   if runs.best(runs.theirs, p, t)[0] < math.inf]
        return style.geometric_mean(factors)
    return sorted(runs.theirs, key=slower)[:count]


def plot_error_against_time(runs, folders):
    problems = runs.large()
    columns = 4
    lines = math.ceil(len(problems) / columns)
    figure, axes = plt.subplots(lines, columns, figsize=(14, 2.9 * lines + 0.8), squeeze=False)
    fixed = strongest(runs, 2)
    look = looks(runs, fixed)
    for axis, problem in zip(axes.flat, problems):
        for name in runs.ours + fixed:
            points = sorted((-r["tolerance"], r["seconds"], r["error"]) for r in runs.rows
                            if r["problem"] == problem and r["method"] == name and r["converged"] == 1)
            # an error below 1e-12 is shown there: an exact hit would stretch the axis
            axis.plot([p[1] for p in points], [max(p[2], 1e-12) for p in points], marker="o", markersize=3,
                      label=name if runs.owner[name] == "skerry" else f"Siconos {name}", **look[name])
        best = [(*runs.best(runs.theirs, problem, t), t)
                for t in sorted({r["tolerance"] for r in runs.rows}, reverse=True)]
        best = [b for b in best if b[0] < math.inf]
        if best:
            axis.plot([b[0] for b in best], [max(runs.error[problem, b[1], b[2]], 1e-12) for b in best], color="black",
                      linestyle=(0, (1, 1)), linewidth=1.6, label="best Siconos at each tolerance")
        axis.set(xscale="log", yscale="log", title=f"{problem} ({runs.contacts[problem]})")
    for axis in axes.flat[len(problems):]:
        axis.set_visible(False)
    for axis in axes[:, 0]:
        axis.set_ylabel("error reached")
    for axis in axes[-1]:
        axis.set_xlabel("CPU time of the solve (s)")
    style.legend_above(figure, axes.flat[0], 6)
    style.save(figure, folders, "error_against_time.png")


def plot_performance_profiles(runs, folders):
    """Dolan and More 2002: the share of problems that a method solves within tau times the time of the fastest
    method."""
    figure, axes = plt.subplots(1, len(TOLERANCES), figsize=(14, 4.6), sharey=True)
    fixed = strongest(runs, 4)
    look = looks(runs, fixed)
    for axis, tolerance in zip(axes, TOLERANCES):
        problems = [p for p in runs.large() if runs.best(runs.ours + runs.theirs, p, tolerance)[0] < math.inf]
        for name in runs.ours + fixed:
            ratios = sorted(runs.seconds[p, name, tolerance] / runs.best(runs.ours + runs.theirs, p, tolerance)[0]
                            for p in problems)
            ratios = [r for r in ratios if r < math.inf]
            steps = [(r, (i + 1) / len(problems)) for i, r in enumerate(ratios)]
            start = sum(r <= 1 for r in ratios) / max(1, len(problems))
            axis.step([1] + [s[0] for s in steps] + [1e4], [start] + [s[1] for s in steps]
                      + [steps[-1][1] if steps else 0],
                      where="post", label=name if runs.owner[name] == "skerry" else f"Siconos {name}", **look[name])
        axis.set(xscale="log", xlim=(1, 1e3), ylim=(0, 1.02),
                 title=f"tolerance {tolerance:g}, {len(problems)} problems",
                 xlabel="time over that of the fastest method")
    axes[0].set_ylabel("share of problems solved")
    style.legend_above(figure, axes[0], 6)
    style.save(figure, folders, "performance_profiles.png")


def plot_ratios(runs, folders):
    if not runs.theirs:
        return
    problems = list(reversed(runs.large()))
    figure, axes = plt.subplots(1, len(TOLERANCES), figsize=(14, 0.3 * len(problems) + 1.6), sharey=True)
    for axis, tolerance in zip(axes, TOLERANCES):
        for place, problem in enumerate(problems):
            own = runs.seconds[problem, runs.default, tolerance]
            their, name = runs.best(runs.theirs, problem, tolerance)
            if own == math.inf or their == math.inf:
                missed_by = "either" if own == their else "us" if own == math.inf else "Siconos"
                axis.text(1, place, " not solved by " + missed_by,
                          va="center", fontsize=8, color="#555555")
                continue
            axis.barh(place, their / own - 1, left=1, color=style.OURS[0] if their > own else style.OURS[1], height=0.7)
            axis.text(max(their / own, 1), place, f" {their / own:{'.0f' if their >= 10 * own else '.2g'}}  {name}",
                      va="center", fontsize=8)
        axis.axvline(1, color="black", linewidth=1)
        axis.set(xscale="log", title=f"tolerance {tolerance:g}", xlabel="time of the best Siconos variant over ours")
        low, high = axis.get_xlim()
        axis.set_xlim(min(low, 0.5), high * (high / low) ** 0.6)  # room for the names
        axis.grid(axis="y", visible=False)
    axes[0].set_yticks(range(len(problems)), [f"{p} ({runs.contacts[p]})" for p in problems])
    figure.suptitle(f"{runs.default} beside the variant of Siconos that is fastest on that very problem: above 1 ours "
                    f"is faster", fontsize=11)
    style.save(figure, folders, "against_siconos.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("csv")
    parser.add_argument("--figures", action="append", default=[],
                        help="folder for the plots; may be given more than once")
    parser.add_argument("--no-plots", action="store_true")
    arguments = parser.parse_args()
    runs = Runs(style.read_csv(arguments.csv))
    for tolerance in TOLERANCES:
        print_problems(runs, tolerance)
    print_methods(runs)
    if runs.theirs:
        print_against_best(runs)
        print_lumped(runs)
    else:
        print("Siconos is not part of this build. On Debian: apt-get install libsiconos-numerics-dev, then run this "
              "again.\n")
    if not arguments.no_plots:
        folders = arguments.figures or [str(style.pathlib.Path(arguments.csv).parent)]
        plot_error_against_time(runs, folders)
        plot_performance_profiles(runs, folders)
        plot_ratios(runs, folders)


if __name__ == "__main__":
    main()
