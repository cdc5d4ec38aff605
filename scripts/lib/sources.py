"""Source files of the project, those that changed lately, and the flags that they are compiled with."""
import json
import pathlib
import re
import shlex
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIBRARY = ("components", "jobs", "systems", "engine")
# All text of a source; the group holds the text that is neither comment nor space.
CODE = re.compile(r"""//[^\n]*|/\*.*?\*/|\s+|("(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|.)""", re.DOTALL)
INCLUDE = re.compile(r'^#include "(.*)"', re.MULTILINE)
PACKAGE_INCLUDE = re.compile(r"^#include <(.*)>", re.MULTILINE)
# Sources that need packages, definitions or templates of their own, or belong to another project.
SPECIAL = re.compile(
    r"jobs/backend_.*\.cpp|engine/absent/.*|engine/fill/netgen/.*|profiling/siconos\.cpp|profiling/.*/bullet_peer\.cpp"
    r"|profiling/roofline/(peak_loops|roofline)\.cpp|tests/(host|consumer)/.*|tests/fuzz/fuzz_reader\.cpp")
# Age of a commit, measured from the newest one, up to which its files count as changed [s]. A change lands within hours
# of its first commit, so earlier commits were checked before.
LATELY = 6 * 3600


def git(*arguments):
    result = subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True)
    return result.stdout if result.returncode == 0 else None


def in_folders(folders, pattern="*.cpp"):
    """Paths from the root of all sources in the folders, sorted."""
    names = (path.relative_to(ROOT).as_posix() for folder in folders for path in (ROOT / folder).rglob(pattern))
    return sorted(name for name in names if not SPECIAL.fullmatch(name))


def code_of(text):
    """The text without comments and space."""
    return "".join(CODE.findall(text))


def changed_files():
    """Names of files touched since the last commit that is older than LATELY. Sources and headers are left out if their
    code is as in that commit. None without git."""
    newest = git("log", "-1", "--format=%ct")
    if not newest:
        return None
    since = int(newest) - LATELY
    log = git("log", f"--since={since}", "--name-only", "--format=")
    status = git("status", "--porcelain", "--untracked-files=all")
    names = set(log.split()) | {line[3:] for line in status.splitlines()}
    before = (git("rev-list", "-1", f"--before={since}", "HEAD") or "").strip()

    def same_code(name):
        old = git("show", f"{before}:{name}") if before else None
        return old is not None and (ROOT / name).exists() and code_of(old) == code_of((ROOT / name).read_text())

    return {name for name in names if not name.endswith((".h", ".cpp")) or not same_code(name)}


def of_library(everything):
    """Sources of the library and the program: all, or those that changed and, for each header that changed, one source
    that includes it."""
    names = in_folders(LIBRARY)
    changed = changed_files()
    if everything or changed is None:
        return names
    included = {name: set(INCLUDE.findall((ROOT / name).read_text())) for name in names}
    chosen = {name for name in names if name in changed}
    missing = {name.removeprefix("engine/include/") for name in changed if name.endswith(".h")}
    missing -= set().union(*(included[name] for name in chosen))
    for name in names:
        if missing & included[name]:
            chosen.add(name)
            missing -= included[name]
    return sorted(chosen)


def headers_of_library(everything):
    """Headers of the library and the program: all, or those that changed."""
    names = in_folders(LIBRARY, "*.h")
    changed = changed_files()
    return [name for name in names if everything or changed is None or name in changed]


def commands(build):
    """The compiler commands of a build folder, as lists of arguments without a compiler cache before them."""
    build = pathlib.Path(build)
    compiler = re.search(r"^CMAKE_CXX_COMPILER:\w+=(.*)$", (build / "CMakeCache.txt").read_text(), re.MULTILINE)[1]
    database = json.loads((build / "compile_commands.json").read_text())
    all_arguments = [shlex.split(entry["command"]) for entry in database]
    return [arguments[arguments.index(compiler):] for arguments in all_arguments if compiler in arguments]


def without_absent_parts(names, all_commands):
    """The names without the sources of the Python package if this build leaves it out: their headers may be missing."""
    if any("engine/python/" in argument for command in all_commands for argument in command):
        return names
    return [name for name in names if not name.startswith("engine/python/")]


def common_flags(all_commands):
    """Flags that a unit of several sources needs: include folders, definitions and language."""
    kept = {"-fopenmp-simd": None}
    for command in all_commands:
        if "/nanobind/src/" in command[-1]:
            continue  # another project, whose definitions change its headers
        arguments = iter(command)
        for argument in arguments:
            if argument == "-isystem":
                kept[argument + next(arguments)] = None
            elif argument.startswith(("-I", "-D", "-std=")):
                kept[argument] = None
    return list(kept)
