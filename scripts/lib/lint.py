#!/usr/bin/env python3
"""Runs clang-tidy over the sources of the library.

    lint.py CLANG_TIDY BUILD_FOLDER          files that changed within six hours before the newest commit
    lint.py CLANG_TIDY BUILD_FOLDER --all    all files

Most of the time of clang-tidy goes into the headers of the packages, read anew for each source. Sources are therefore
read many at a time, as one unit. In a unit all share one unnamed namespace, and a name in it hides the same name
outside. A source that declares a private name and another that declares or calls it therefore go into different
units."""
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys

import sources

# Files without lint. clang 14 does not know the instruction sets that the table of kernels names, and lacks omp.h.
PASSED_OVER = re.compile(r"engine/program/.*|systems/kernels/kernel_sets\.cpp|jobs/backend_openmp\.cpp")
PRIVATE = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
NAME = re.compile(r"^(?:[A-Za-z_\[][^;={]*?\b(\w+)(?:\(|\{| =)|(?:struct|class|enum class|using) (\w+))", re.MULTILINE)
CALLED = re.compile(r"(?<![\w.:>])(\w+)(?:[<({]|>\()")  # also as a template argument: reduce<add>(...)


def private_names(text):
    return {a or b for block in PRIVATE.findall(text) for a, b in NAME.findall(block)}


def units_of(root, names):
    """Sources in units that can be read as one, one for each core and more where private names need them."""
    units = [{"private": set(), "called": set(), "sources": []} for _ in range(len(os.sched_getaffinity(0)))]
    for name in names:
        text = (root / name).read_text()
        own = private_names(text)
        called = own.union(CALLED.findall(text))
        free = [unit for unit in units if not own & unit["called"] and not called & unit["private"]]
        if not free:
            free = [{"private": set(), "called": set(), "sources": []}]
            units += free
        unit = min(free, key=lambda unit: len(unit["sources"]))
        unit["private"] |= own
        unit["called"] |= called
        unit["sources"].append(name)
    return [unit["sources"] for unit in units if unit["sources"]]


def main():
    tidy, build = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    all_commands = sources.commands(build)
    names = sources.without_absent_parts(sources.of_library("--all" in sys.argv), all_commands)
    names = [name for name in names if not PASSED_OVER.fullmatch(name)]
    flags = sources.common_flags(all_commands)
    folder = build / "lint"
    folder.mkdir(exist_ok=True)

    def lint(name, unit):
        """Text of the faults found. A unit that is no C++, since names of its sources collide, is read in halves."""
        file = folder / f"unit_{name}.cpp"
        file.write_text("".join(f'#include "{source}"  // NOLINT(bugprone-suspicious-include)\n' for source in unit))
        command = [tidy, "--quiet", f"--config-file={sources.ROOT / '.clang-tidy'}", str(file), "--", *flags]
        result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if "[clang-diagnostic-error]" in result.stdout and len(unit) > 1:
            half = len(unit) // 2
            return lint(f"{name}_0", unit[:half]) + lint(f"{name}_1", unit[half:])
        return "" if result.returncode == 0 else result.stdout or f"{tidy}: status {result.returncode} at {file}\n"

    units = units_of(sources.ROOT, names)
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as workers:
        faults = "".join(workers.map(lint, range(len(units)), units))
    print(faults + f"{len(names)} sources in {len(units)} units: {'FOUND' if faults else 'nothing found'}")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
