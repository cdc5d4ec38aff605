#!/usr/bin/env python3
"""Compiles sources for syntax only, each of them alone.

Without the precompiled headers a source that does not include what it uses fails:
    check_syntax.py BUILD_FOLDER           sources of the library that changed within six hours before the newest commit
    check_syntax.py BUILD_FOLDER --all     all sources of the library
    check_syntax.py BUILD_FOLDER FILE...   these files
With them the check is faster, and finds calls that no longer fit the library:
    check_syntax.py BUILD_FOLDER --precompiled FOLDER   all sources of a folder
"""
import concurrent.futures
import os
import pathlib
import subprocess
import sys

import sources


def precompiled(build, all_commands):
    """The command that compiled a source of the library with the precompiled headers, without that source."""
    header = pathlib.Path(build).resolve() / "CMakeFiles/skerry_precompiled.dir/cmake_pch.hxx"
    if not header.with_suffix(".hxx.gch").exists():
        sys.exit(f"{build}: precompiled headers: none, expected a finished build with SKERRY_PRECOMPILE=ON")
    command = next(c for c in all_commands if str(header) in c and "-c" in c and c[-1].endswith(".cxx"))
    output = command.index("-o")
    return command[:output]


def main():
    build, *chosen = sys.argv[1:]
    all_commands = sources.commands(build)
    flags = [*sources.common_flags(all_commands), "-w", "-fsyntax-only"]  # the build reports warnings
    if chosen[:1] == ["--precompiled"]:
        # Builds without profiling programs lack this definition.
        command = [*precompiled(build, all_commands), *flags, '-DSKERRY_PROFILING_FOLDER="profiling"']
        names = sources.in_folders(chosen[1:])
    else:
        command = [all_commands[0][0], *flags]
        names = sources.without_absent_parts(sources.of_library(chosen == ["--all"]), all_commands)
        if chosen and chosen != ["--all"]:
            names = chosen

    def check(name):
        return name, subprocess.run([*command, name], cwd=sources.ROOT, capture_output=True, text=True)

    failed = 0
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as workers:
        for done, (name, result) in enumerate(workers.map(check, names), 1):
            print(f"[{done}/{len(names)}] {name}", flush=True)
            if result.returncode != 0:
                failed += 1
                print(f"FAILED: {name} does not compile alone:\n{result.stderr}")
    print(f"{len(names)} files compile alone" if not failed else f"{failed} of {len(names)} files do not compile alone")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
