#!/usr/bin/env python3
"""Compiles sources and headers for syntax only, each of them alone, so that a missing include is found.

    check_syntax.py BUILD_FOLDER           sources and headers of the library that changed within six hours before the
                                           newest commit
    check_syntax.py BUILD_FOLDER --all     all of the library
    check_syntax.py BUILD_FOLDER PATH...   these files, and all sources of these folders

The headers of BASES take most of the time, so they are precompiled. A file is compiled with those that it includes
itself, directly or through other headers. Precompiled headers thus hide a missing include of a header only if that
header does not include all of them. Such a header is compiled alone, with the precompiled headers of its own.
"""
import collections
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys

import sources

# Headers that take long to compile, and the includes of packages that reach them. Headers of ours: no pattern.
BASES = {
    "Eigen/Core": r"Eigen/.*|nanobind/eigen/.*",
    "Eigen/Geometry": r"Eigen/(Geometry|Dense|Eigenvalues)",
    "nlohmann/json.hpp": r"nlohmann/json\.hpp",
    "skerry/world.h": None,
    "engine/world/state/model.h": None,
    "engine/python/bind.h": None,
}
# Fewest files that share a set of precompiled headers.
SHARED = 5
# clang 14 does not know the instruction sets that the first source names, and lacks the header omp.h of the second.
COMPILER_OF_THE_BUILD = re.compile(r"systems/kernels/kernel_sets\.cpp|jobs/backend_openmp\.cpp")
FOLDERS = ("", "engine/include/")  # of includes


class Includes:
    """The headers that a file includes, directly or through other headers."""

    def __init__(self):
        self.direct = {}
        self.reached = {}

    def of(self, name):
        """Paths of our headers from the root, and names of the headers of packages."""
        if name not in self.direct:
            text = (sources.ROOT / name).read_text()
            own = set()
            for include in sources.INCLUDE.findall(text):
                places = [folder + include for folder in FOLDERS] + [os.path.join(os.path.dirname(name), include)]
                own |= {place for place in places if (sources.ROOT / place).exists()}
            self.direct[name] = own, set(sources.PACKAGE_INCLUDE.findall(text))
        return self.direct[name]

    def bases(self, name):
        """The headers of BASES that a file includes, in their order."""
        if name not in self.reached:
            own, packages, left = set(), set(), [name]
            while left:
                headers, others = self.of(left.pop())
                packages |= others
                left += headers - own
                own |= headers
            own.discard(name)
            self.reached[name] = tuple(
                base for base, pattern in BASES.items()
                if (any(re.fullmatch(pattern, package) for package in packages) if pattern
                    else any(folder + base in own for folder in FOLDERS)))
        return self.reached[name]


def precompiled_sets(includes, names):
    """For each file the headers that are precompiled for it: a set that SHARED files or more have, or none."""
    count = collections.Counter(includes.bases(name) for name in names)
    shared = [bases for bases in count if bases and count[bases] >= SHARED]

    def largest(bases):
        return max((some for some in shared if set(some) <= set(bases)), key=len, default=())

    return {name: largest(includes.bases(name)) for name in names}


def files_to_check(includes, names, headers):
    """The files to compile, with the headers that are precompiled for each. A header needs no compilation of its own if
    a source that includes it has no precompiled header that it lacks."""
    chosen = precompiled_sets(includes, [*names, *headers])
    covered = {header for name in names for header in includes.of(name)[0]
               if set(chosen[name]) <= set(includes.bases(header))}
    return {name: bases for name, bases in chosen.items() if name in names or name not in covered}


def main():
    build, *chosen = sys.argv[1:]
    all_commands = sources.commands(build)
    own_compiler = all_commands[0][0]
    compiler = shutil.which("clang++-14") or shutil.which("clang++") or own_compiler  # clang is faster
    # The build reports warnings. Builds without profiling programs lack the definition.
    flags = [*sources.common_flags(all_commands), "-w", '-DSKERRY_PROFILING_FOLDER="profiling"']
    if chosen in ([], ["--all"]):
        names, headers = sources.of_library(bool(chosen)), sources.headers_of_library(bool(chosen))
    else:
        names = sources.in_folders(name for name in chosen if (sources.ROOT / name).is_dir())
        names += [name for name in chosen if not (sources.ROOT / name).is_dir()]
        headers = []
    names = sources.without_absent_parts(names, all_commands)
    headers = sources.without_absent_parts(headers, all_commands)
    files = files_to_check(Includes(), names, headers)
    folder = pathlib.Path(build).resolve() / "includes"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()

    def run(command):
        return subprocess.run(command, cwd=sources.ROOT, capture_output=True, text=True)

    def precompile(number, bases):
        header = folder / f"bases_{number}.h"
        header.write_text("".join(f"#include <{base}>\n" for base in bases))
        instantiate = ["-fpch-instantiate-templates"] if compiler != own_compiler else []
        return header, run([compiler, *flags, *instantiate, "-x", "c++-header", header, "-o", f"{header}.gch"])

    def check(name, header):
        if COMPILER_OF_THE_BUILD.fullmatch(name):
            return run([own_compiler, *flags, "-fsyntax-only", name])
        return run([compiler, *flags, *(["-include", header] if header else []), "-fsyntax-only", "-x", "c++", name])

    failed = 0
    sets = sorted(set(files.values()) - {()}, key=len, reverse=True)
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as workers:
        header_of = {(): None}
        for bases, (header, result) in zip(sets, workers.map(precompile, range(len(sets)), sets)):
            header_of[bases] = header
            if result.returncode != 0:
                sys.exit(f"FAILED: {', '.join(bases)} do not compile:\n{result.stderr}")
        results = workers.map(check, files, [header_of[bases] for bases in files.values()])
        for done, (name, result) in enumerate(zip(files, results), 1):
            print(f"[{done}/{len(files)}] {name}", flush=True)
            if result.returncode != 0:
                failed += 1
                print(f"FAILED: {name} does not compile alone:\n{result.stderr}")
    print(f"{len(files)} files compile alone" if not failed else f"{failed} of {len(files)} files do not compile alone")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
