"""One look for all plots of profiling."""
import csv
import math
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import matplotlib.ticker  # noqa: E402

OURS = ["#0b6e99", "#d1495b", "#2a9d5c", "#e08e1b", "#7b4fa3", "#00a6a6", "#8a5a2b", "#c2378a", "#8fb339", "#1f2f98",
        "#f28fb1", "#5c6b3c"]
THEIRS = ["#222222", "#6b6b6b", "#9a9a9a", "#bdbdbd"]
DASHES = ["-", "--", "-.", ":"]

plt.rcParams.update({
    "figure.dpi": 110, "savefig.dpi": 130, "figure.constrained_layout.use": True,
    "font.size": 10, "axes.titlesize": 10.5, "axes.labelsize": 10, "legend.fontsize": 9,
    "axes.grid": True, "axes.grid.which": "major", "grid.color": "#dddddd", "grid.linewidth": 0.7,
    "axes.axisbelow": True,
    "axes.spines.top": False, "axes.spines.right": False, "lines.linewidth": 1.8, "legend.frameon": False,
})


def read_csv(file):
    """Rows as dictionaries; what looks like a number is one."""
    def value(text):
        try:
            return float(text)
        except ValueError:
            return text
    with open(file, newline="") as stream:
        return [{key: value(text) for key, text in row.items()} for row in csv.DictReader(stream)]


def geometric_mean(values):
    values = [v for v in values if v > 0]
    return math.exp(sum(map(math.log, values)) / len(values)) if values else float("nan")


def seconds_text(seconds):
    if seconds is None or not math.isfinite(seconds):
        return "-"
    for unit, factor in (("s", 1), ("ms", 1e3), ("us", 1e6)):
        if seconds * factor >= 1:
            return f"{seconds * factor:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def print_table(head, rows):
    """Columns as wide as they need; all but the first are set to the right."""
    cells = [head] + [[str(c) for c in row] for row in rows]
    width = [max(len(row[i]) for row in cells) for i in range(len(head))]
    for row in cells:
        print("  ".join(c.ljust(w) if i == 0 else c.rjust(w) for i, (c, w) in enumerate(zip(row, width))).rstrip())
    print()


def legend_above(figure, axis, columns):
    """One legend for all axes, above them: the layout leaves its lines free."""
    handles, labels = axis.get_legend_handles_labels()
    height = 0.22 * math.ceil(len(labels) / columns) + 0.1  # inches
    share = height / figure.get_size_inches()[1]
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - share))
    figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, 1), ncols=columns)


def plain_decades(axis):
    """Labels at powers of ten alone, as numbers."""
    for one in (axis.xaxis, axis.yaxis):
        one.set_minor_formatter(matplotlib.ticker.NullFormatter())
        one.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:g}"))


def save(figure, folders, name):
    for folder in folders:
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(folder / name)
        print(folder / name)
    plt.close(figure)
