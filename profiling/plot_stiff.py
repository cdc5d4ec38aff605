"""Draws what profile_stiff has measured: CPU time against the speed that is left, a panel a scene.

    plot_stiff.py FOLDER_OF_THE_TABLE --figures FOLDER [--figures FOLDER]
"""

import argparse
import csv
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

MARKERS = {"1e+06": "o", "1e+08": "s", "1e+10": "^"}
COLOURS = {"explicit": "tab:gray", "implicit": "tab:blue", "rigid": "tab:orange"}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", type=pathlib.Path)
    parser.add_argument("--figures", type=pathlib.Path, action="append", default=[])
    arguments = parser.parse_args()
    with open(arguments.table / "stiff.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    figure, axes = plt.subplots(1, len(scenes), figsize=(4 * len(scenes), 4), sharey=True, squeeze=False)
    for axis, scene in zip(axes[0], scenes):
        for row in rows:
            if row["scene"] != scene:
                continue
            modulus = f"{float(row['modulus']):.0e}"
            axis.loglog(
                max(float(row["speed"]), 1e-12),
                float(row["cpu_seconds"]),
                MARKERS[modulus],
                color=COLOURS[row["dynamics"]],
                fillstyle="full" if float(row["tolerance"]) < 1e-4 else "none",
                label=f"{row['dynamics']}, E = {modulus}" if float(row["tolerance"]) < 1e-4 else None,
            )
        axis.set_title(scene)
        axis.set_xlabel("speed at the end (m/s)")
    axes[0][0].set_ylabel("CPU seconds a simulated second")
    axes[0][0].legend(fontsize=7, title="full: tolerance 1e-6, else 1e-3", title_fontsize=7)
    figure.tight_layout()
    for folder in arguments.figures:
        folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(folder / "stiff.svg")


if __name__ == "__main__":
    main()
