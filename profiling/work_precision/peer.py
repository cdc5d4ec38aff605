"""Functions that the runners of other engines share: command line, repeated runs, and the file of the result."""
import json
import os


def add_arguments(parser):
    parser.add_argument("scene")
    parser.add_argument("result")
    parser.add_argument("--step", type=float, required=True)
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--cap", type=float, default=60, help="CPU seconds after which a run is given up")


def run_repeatedly(run, options):
    """The result of the first of `options.repeat` runs of `run(scene, options)`, with the median of their times. What
    did not finish is not repeated."""
    with open(options.scene) as file:
        scene = json.load(file)
    options.result = os.path.abspath(options.result)
    os.chdir(os.path.dirname(options.result))  # MuJoCo writes a log where it runs
    runs = [run(scene, options)]
    while len(runs) < options.repeat and runs[0]["finished"]:
        runs.append(run(scene, options))
    runs[0]["seconds"] = sorted(r["seconds"] for r in runs)[len(runs) // 2]
    with open(options.result, "w") as file:
        json.dump(runs[0], file)
