#!/usr/bin/env python3
"""Measures a pile of balls on several ranks of this machine, and predicts it on many (scripts/profile_ranks):
study_ranks.py PROGRAM MESSAGES [--plain PROGRAM] [--balls N] [--ranks N ...] [--figures FOLDER ...]"""
import argparse
import csv
import dataclasses
import io
import json
import math
import os
import pathlib
import random
import re
import resource
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import plot_style as style  # noqa: E402
from plot_style import plt  # noqa: E402
from predict_ranks import ETHERNET, INFINIBAND, Costs, Network, block_of, step_time, volume  # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parents[2]
RADIUS = 0.05  # of the balls of drop_ball.msh [m]
WEAK = 1000    # balls of each rank
STRONG = 10000  # balls of all ranks
COUNTED = 125   # balls of the runs in which --instructions counts instructions


def write_pile(file, balls):
    """A block of soft balls that touch each other, the floor and four walls. Each has its own rotation."""
    edges = block_of(balls)
    draw = random.Random(1)
    spacing = 2.002 * RADIUS

    def ball(cell):
        axis = [draw.gauss(0, 1) for _ in range(3)]
        return {"name": "ball_" + "_".join(map(str, cell)),
                "mesh": {"file": str(SOURCE / "scenes/meshes/drop_ball.msh")}, "material": "rubber",
                "position": [spacing * (c + 0.5) for c in cell],
                "rotation": {"axis": axis, "radians": draw.uniform(0, math.pi)}}

    cells = [(x, y, z) for z in range(edges[2]) for y in range(edges[1]) for x in range(edges[0])]
    walls = [{"name": f"wall_{axis}_{side}", "shape": {"plane": {
        "normal": [(1 - 2 * side) * (i == axis) for i in range(3)],
        "point": [side * spacing * edges[i] * (i == axis) for i in range(3)]}}}
        for axis, sides in ((2, [0]), (0, [0, 1]), (1, [0, 1])) for side in sides]
    scene = {"name": "pile", "seconds": 1, "settings": {"start_overlaps": "ignore", "sleep": False},
             "materials": {"rubber": {"E": 5e5, "nu": 0.4, "rho": 1000, "mu": 0.5}},
             "bodies": [ball(cell) for cell in cells], "colliders": walls}
    file.write_text(json.dumps(scene))


def launched(ranks, command):
    """The command as mpirun starts it on this machine, which may have fewer cores than ranks."""
    return ["mpirun", "-n", str(ranks), "--oversubscribe", "--bind-to", "none", *command]


def run(command, stats, **environment):
    """Runs the program. Returns its statistics, with its CPU time and that of its children."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([*command, "--quiet", "--stats", str(stats)], check=True,
                   env=os.environ | {"OMP_NUM_THREADS": "1"} | environment)
    return json.loads(stats.read_text()) | {"cpu": resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before}


def settled(arguments, balls):
    """Runs a pile until its lowest balls carry load. Returns the file with its state."""
    scene, start = arguments.out / f"pile_{balls}.json", arguments.out / f"pile_{balls}.skerry"
    write_pile(scene, balls)
    run([arguments.program, "run", str(scene), "--seconds", str(arguments.settle), "--checkpoint", str(start)],
        arguments.out / "start.json")
    return start


def instructions_of(program, profile):
    """Instructions that a profile of callgrind counts in the program itself. Waiting is in the libraries of MPI."""
    table = subprocess.run(["callgrind_annotate", "--threshold=100", str(profile)], check=True, capture_output=True,
                           text=True).stdout
    own = re.compile(rf"^ *([\d,]+) .*\[\S*/{re.escape(pathlib.Path(program).name)}\]$", re.MULTILINE)
    return sum(int(count.replace(",", "")) for count in own.findall(table))


def count_instructions(arguments):
    """Counts the instructions of the steps of a small pile on one rank and on two. Returns those of a copy of a ball,
    as a share of those of a ball."""
    start = settled(arguments, COUNTED)
    counts = []
    for ranks in (1, 2):
        for old in arguments.out.glob("callgrind.*"):
            old.unlink()
        command = ["valgrind", "-q", "--tool=callgrind", "--collect-atstart=no",
                   "--toggle-collect=skerry::World::advance(double,*",
                   f"--callgrind-out-file={arguments.out}/callgrind.%p", arguments.program, "run", "--restart",
                   str(start), "--threads", "1", "--seconds", str(arguments.settle + arguments.seconds)]
        run(launched(ranks, command) if ranks > 1 else command, arguments.out / "counted.json",
            SKERRY_INSTRUCTION_SET="x86-64-v3")  # valgrind does not know wider registers
        counts.append([instructions_of(arguments.program, file) for file in arguments.out.glob("callgrind.*")])
    (one,), two = counts
    print(f"instructions of {COUNTED} balls: {one / 1e6:.0f} million on one rank, "
          f"{' and '.join(f'{n / 1e6:.0f}' for n in sorted(two))} million on two; one rank has "
          f"{one / max(two):.2f} times those of the busier one of two\n")
    copies = 2 * volume(COUNTED, 2, Costs(body=0)).ghosts
    return (sum(two) - one) / (copies * one / COUNTED)


def measure(arguments):
    """Runs the pile on each number of ranks, several times in turns. Returns one row for each number."""
    out = arguments.out
    start, begin = settled(arguments, arguments.balls), arguments.settle + 1e-5
    runs = {ranks: [] for ranks in arguments.ranks}
    if arguments.plain:
        runs[0] = []  # the build without MPI
    for _ in range(arguments.repeats):
        for ranks, done in runs.items():
            def advance(end, name):
                command = [arguments.program if ranks else arguments.plain, "run", "--restart", str(start),
                           "--threads", "1", "--seconds", str(end)]
                return run(launched(ranks, command) if ranks else command, out / name)
            empty = advance(begin, "empty.json")
            full = advance(arguments.settle + arguments.seconds, f"ranks_{ranks}.json")
            steps = full["steps"] - empty["steps"]
            done.append({"ranks": ranks, "hash": full["state_hash"], "steps": steps,
                         "wall": (full["seconds_wall"] - empty["seconds_wall"]) / steps,
                         "cpu": (full["cpu"] - empty["cpu"]) / steps,
                         "contacts": full["contacts"]["mean"], "of_ranks": full.get("ranks", {})})
    hashes = {row["hash"] for done in runs.values() for row in done}
    if len(hashes) != 1:
        raise SystemExit(f"study_ranks: found the state hashes {sorted(hashes)}, expected one on all numbers of ranks")
    # Other programs only make a run slower, so the fastest one counts.
    return [min(done, key=lambda row: row["wall"]) | {"cpu": min(row["cpu"] for row in done)} for done in runs.values()]


def measure_network(arguments):
    """Costs of messages on this machine, in the form of predict_ranks.Network."""
    answer = subprocess.run(launched(2, [arguments.messages]), check=True, capture_output=True, text=True).stdout
    rows = list(csv.DictReader(io.StringIO(answer)))
    seconds = {int(r["bytes"]): float(r["seconds"]) for r in rows if r["call"] == "exchange"}
    large = 100000
    return Network("this machine", seconds[0], seconds[0] / 2, large / (seconds[large] - seconds[0]))


def print_measured(rows, costs, balls):
    one = next(row for row in rows if row["ranks"] == 1)
    table = []
    for row in rows:
        counted = row["of_ranks"]
        cells = [row["ranks"] or "no MPI", f"{1e6 * row['wall']:.0f}", f"{one['wall'] / row['wall']:.2f}"]
        if row["ranks"] > 1:
            v = volume(balls, row["ranks"], costs)
            messages, size = (counted[key] / row["ranks"] for key in ("messages_per_step", "bytes_per_step"))
            cells += [f"{messages:.1f}", f"{v.messages:.1f}", f"{size / 1e3:.0f}", f"{v.bytes / 1e3:.0f}",
                      f"{counted['imbalance']:.2f}", f"{counted['waiting']:.2f}"]
        table.append(cells + ["-"] * (9 - len(cells)))
    style.print_table(["ranks", "us a step", "times as fast", "messages a rank", "predicted", "kB a rank", "predicted",
                       "imbalance", "waiting"], table)


def costs_of(measured, balls):
    """Time of a ball, which is CPU time because other programs disturb it less, and of a copy of a ball of another
    rank: the time that two ranks compute beyond that of one. For the latter the machine must have two idle cores."""
    row = {r["ranks"]: r for r in measured}
    x, y, z = block_of(balls)
    touching = (x - 1) * y * z + x * (y - 1) * z + x * y * (z - 1) + x * y + 2 * x * z + 2 * y * z  # with the walls
    costs = Costs(body=row[1]["cpu"] / balls, contacts=row[1]["contacts"] / touching)
    if 2 not in row:
        return costs
    computing = 2 * row[2]["wall"] * (1 - row[2]["of_ranks"]["waiting"])
    copies = 2 * volume(balls, 2, costs).ghosts
    return dataclasses.replace(costs, ghost=max(0, (computing - row[1]["wall"]) / (copies * costs.body)))


def predictions(costs):
    """For each kind of scaling, network and number of ranks: time of a step and efficiency."""
    rows = []
    for kind in ("weak", "strong"):
        for ranks in (16, 64, 256, 1024):
            balls = WEAK * ranks if kind == "weak" else STRONG
            v = volume(balls, ranks, costs)
            row = {"kind": kind, "ranks": ranks, "balls": balls, "ghosts": v.ghosts, "bytes": v.bytes,
                   "messages": v.messages}
            for network in (INFINIBAND, ETHERNET):
                row[network.name] = step_time(balls, ranks, costs, network)
            row["ideal"] = step_time(balls, 1, costs, INFINIBAND) / ranks
            rows.append(row)
    return rows


def print_predicted(rows):
    style.print_table(
        ["pile", "ranks", "balls", "copies a rank", "kB a rank", "us a step", "efficiency", "with Ethernet"],
        [[row["kind"], row["ranks"], row["balls"], f"{row['ghosts']:.0f}", f"{row['bytes'] / 1e3:.0f}",
          f"{1e6 * row[INFINIBAND.name]:.0f}", f"{row['ideal'] / row[INFINIBAND.name]:.2f}",
          f"{row['ideal'] / row[ETHERNET.name]:.2f}"] for row in rows])


def plot(rows, figures):
    figure, axis = plt.subplots(figsize=(6.5, 4.2))
    for i, kind in enumerate(("weak", "strong")):
        of_kind = [row for row in rows if row["kind"] == kind]
        label = f"{WEAK:,} balls a rank" if kind == "weak" else f"{STRONG:,} balls in all"
        for dash, network in zip(style.DASHES, (INFINIBAND, ETHERNET)):
            axis.plot([row["ranks"] for row in of_kind], [row["ideal"] / row[network.name] for row in of_kind],
                      linestyle=dash, color=style.OURS[i], marker="o", label=f"{label}, {network.name}")
    axis.set(xscale="log", xlabel="ranks of 8 cores", ylabel="predicted efficiency", ylim=(0, 1))
    ticks = sorted({row["ranks"] for row in rows})
    axis.set_xticks(ticks, [str(t) for t in ticks])
    axis.minorticks_off()
    axis.legend()
    style.save(figure, figures, "ranks.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="skerry, built with SKERRY_MPI=ON")
    parser.add_argument("messages", help="profile_messages")
    parser.add_argument("--plain", help="skerry, built without MPI, for comparison")
    parser.add_argument("--balls", type=int, default=1000)
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4, 8])
    parser.add_argument("--settle", type=float, default=0.05, help="simulated time before the measured steps [s]")
    parser.add_argument("--seconds", type=float, default=0.02, help="simulated time of the measured steps [s]")
    parser.add_argument("--instructions", action="store_true",
                        help="measure the cost of a copy by counting instructions, for a busy machine; needs valgrind")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/profiling/ranks"))
    parser.add_argument("--figures", action="append", default=[], help="folder for the plot; may be given repeatedly")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    here = measure_network(arguments)
    print(f"messages: {1e6 * here.latency:.1f} us, {here.bandwidth / 1e9:.1f} GB/s\n")
    measured = measure(arguments)
    costs = costs_of(measured, arguments.balls)
    if arguments.instructions:
        costs = dataclasses.replace(costs, ghost=count_instructions(arguments))
    print(f"a ball takes {1e6 * costs.body:.1f} us of a step, a copy {costs.ghost:.2f} of it\n")
    print_measured(measured, costs, arguments.balls)
    # In the measured steps the pile has not settled yet, so the prediction keeps the contacts of a settled pile.
    rows = predictions(dataclasses.replace(costs, contacts=Costs.contacts))
    print_predicted(rows)
    (arguments.out / "ranks.json").write_text(json.dumps({"measured": measured, "predicted": rows}, indent=1))
    plot(rows, arguments.figures or [arguments.out])


if __name__ == "__main__":
    main()
