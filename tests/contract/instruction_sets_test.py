"""Whatever instruction set runs the kernels, the state is the same to the last bit.

instruction_sets_test.py PROGRAM ROOT. Exit code 77: this build or this machine has one set only."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

PROGRAM, ROOT = sys.argv[1], pathlib.Path(sys.argv[2])

# Runs that use every kernel: laws and kinds of elements, losses, clusters, methods of the solver, sleep.
RUNS = [
    ("scenes/skittles.json", "0.3", []),
    ("scenes/skittles.json", "0.2", ["materials.ball.model=corotational", "materials.skittle.model=linear"]),
    ("scenes/skittles.json", "0.2", ["settings.integrator=leapfrog", "settings.method=pcg_pgs"]),
    ("scenes/skittles.json", "0.2", ["settings.contact_regions=global"]),
    ("scenes/drop/drop_8.json", "0.2", ["settings.sleep_time=0.02"]),
    ("scenes/drop/drop_8.json", "0.15", ["settings.method=newton"]),
    ("scenes/bucket.json", "0.15", []),
    ("scenes/table.json", "0.2", []),
    ("scenes/incline.json", "0.3", []),
    ("scenes/mesh_drop.json", "0.2", []),
]


def run(arguments, wanted=None):
    environment = {k: v for k, v in os.environ.items() if k != "SKERRY_INSTRUCTION_SET"}
    if wanted is not None:
        environment["SKERRY_INSTRUCTION_SET"] = wanted
    return subprocess.run([PROGRAM, *arguments], env=environment, text=True, capture_output=True)


def state_of(scene, seconds, settings, wanted):
    with tempfile.TemporaryDirectory() as folder:
        stats = pathlib.Path(folder) / "stats.json"
        changes = [argument for setting in settings for argument in ("--set", setting)]
        arguments = ["run", str(ROOT / scene), "--seconds", seconds, "--quiet", "--stats", str(stats), *changes]
        result = run(arguments, wanted)
        assert result.returncode == 0, f"{scene} {settings} {wanted}: {result.stderr}"
        figures = json.loads(stats.read_text())
        assert figures["instruction_set"] == wanted, f"{wanted} was asked for, {figures['instruction_set']} ran"
        return figures["state_hash"]


def main():
    sets = re.search(r"\(this machine supports: (.*);", run(["--version"]).stdout).group(1).split(", ")
    unknown = run(["run", str(ROOT / "scenes/table.json"), "--quiet"], "abacus")
    assert unknown.returncode == 2, unknown
    assert f'found "abacus", expected one of {", ".join(sets)}' in unknown.stderr, unknown.stderr
    if len(sets) == 1:
        print("one instruction set:", sets[0])
        return 77
    failures = 0
    for scene, seconds, settings in RUNS:
        states = {one: state_of(scene, seconds, settings, one) for one in sets}
        same = len(set(states.values())) == 1
        failures += not same
        print("same" if same else "DIFFER", scene, settings, states)
    return 1 if failures else 0


sys.exit(main())
