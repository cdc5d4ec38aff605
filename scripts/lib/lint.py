#!/usr/bin/env python3
"""clang-tidy over the sources of the library: lint.py CLANG_TIDY BUILD_FOLDER, which holds
compile_commands.json.

Most of what clang-tidy does with a source is reading the packages' headers, over and over. Sources are therefore read
many at a time, as one unit, those apart that give the same name to things of their own."""
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

FOLDERS = ("components", "jobs", "systems", "engine")
# Each of the threading libraries has flags of its own, and clang may not have them.
LEFT_OUT = re.compile(r"jobs/backend_.*\.cpp|engine/program/.*")
PRIVATE = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
NAME = re.compile(r"^(?:[A-Za-z_\[][^;={]*?\b(\w+)(?:\(|\{| =)|(?:struct|class|enum class|using) (\w+))", re.MULTILINE)


def sources_of(database, root):
    """Path from the root, and flags, of each source of the library."""
    for entry in database:
        path = pathlib.Path(entry["directory"], entry["file"]).resolve()
        if not path.is_relative_to(root):
            continue
        name = path.relative_to(root).as_posix()
        if name.startswith(FOLDERS) and not LEFT_OUT.fullmatch(name):
            yield name, shlex.split(entry["command"])


def flags_of(commands):
    """What one unit needs of all commands: where headers are, definitions, kind of machine."""
    kept = {"-fopenmp-simd": None}
    for command in commands:
        arguments = iter(command)
        for argument in arguments:
            if argument == "-isystem":
                kept[argument + next(arguments)] = None
            elif argument.startswith(("-I", "-D", "-std=", "-march=")):
                kept[argument] = None
    return list(kept)


def private_names(text):
    return {a or b for block in PRIVATE.findall(text) for a, b in NAME.findall(block)}


def units_of(root, names):
    """Sources in units that can be read as one, one for each core and more where private names need them."""
    units = [{"private": set(), "sources": []} for _ in range(len(os.sched_getaffinity(0)))]
    for name in names:
        own = private_names((root / name).read_text())
        free = [unit for unit in units if not own & unit["private"]]
        if not free:
            free = [{"private": set(), "sources": []}]
            units += free
        unit = min(free, key=lambda unit: len(unit["sources"]))
        unit["private"] |= own
        unit["sources"].append(name)
    return [unit["sources"] for unit in units if unit["sources"]]


def main():
    tidy, build = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    root = pathlib.Path(__file__).resolve().parents[2]
    sources = dict(sorted(sources_of(json.loads((build / "compile_commands.json").read_text()), root)))
    flags = flags_of(sources.values())
    folder = build / "lint"
    folder.mkdir(exist_ok=True)

    def lint(numbered):
        number, unit = numbered
        file = folder / f"unit_{number}.cpp"
        file.write_text("".join(f'#include "{name}"  // NOLINT(bugprone-suspicious-include)\n' for name in unit))
        command = [tidy, "--quiet", f"--config-file={root / '.clang-tidy'}", str(file), "--", *flags]
        return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    failed = False
    units = units_of(root, sources)
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as workers:
        for result in workers.map(lint, enumerate(units)):
            if result.returncode != 0:
                failed = True
                print(result.stdout)
    print(f"{len(sources)} sources in {len(units)} units: {'FOUND' if failed else 'nothing found'}")
    sys.exit(failed)


if __name__ == "__main__":
    main()
