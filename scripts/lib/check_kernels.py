#!/usr/bin/env python3
"""Checks the machine code of kernels: calls and accesses to the stack in hot kernels, and fused multiply-adds.

check_kernels.py BUILD_FOLDER disassembles the kernels of a finished build, and the peak loops of profiling/roofline
compiled with the options of each instruction set. Ends with an error if a function is above a limit of LIMITS, if no
function has the given word in its name, if a function has a fused multiply-add, whose rounding differs from that of
other instruction sets, or if a peak loop has other instructions than it should.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

import sources

# Limits for all functions whose demangled name contains a word, by instruction set. The four numbers are the counts of
# KINDS; each limit is for the function with the highest count. The limits are the counts of the present code with GCC
# 12 in the preset dev, which this script prints; another SKERRY_UNITY changes them a little. After a change that lowers
# a count, write the lower number here. An unrolled loop has more accesses to the stack in its code, not in its run. The
# copies in compute_run are arguments of the rare viscous stress. Its calls are those of the law of Ogden, which is not
# inlined.
KINDS = ("copies", "other calls", "stack accesses", "scalar comparisons")
LIMITS = {
    "compute_run": {"x86-64": (3, 7, 3273, 119), "x86-64-v3": (3, 7, 745, 7), "x86-64-v4": (0, 4, 230, 3)},
    "skerry::distances(": {"x86-64": (0, 0, 468, 100), "x86-64-v3": (0, 0, 79, 0), "x86-64-v4": (0, 0, 2, 0)},
    "sort_by_counting(": {"x86-64": (1, 0, 11, 4), "x86-64-v3": (1, 0, 3, 0), "x86-64-v4": (1, 0, 3, 0)},
    "BodySearch<false>::compare_": {"x86-64": (0, 5, 58, 44), "x86-64-v3": (0, 5, 13, 1), "x86-64-v4": (0, 5, 14, 1)},
    "BodySearch<true>::compare_": {"x86-64": (0, 5, 58, 44), "x86-64-v3": (0, 8, 10, 0), "x86-64-v4": (0, 5, 10, 0)},
}
# Calls of memcpy, memmove or memset, and the instructions that replace them.
MEMORY_FUNCTION = re.compile(r"\bmem(cpy|move|set)\b")
STRING_INSTRUCTION = re.compile(r"(movs|stos)[bwlq]\b")
# Calls of functions that end the program, or that are in a part of a function that is rarely reached.
COLD = re.compile(r"\.cold\b|fail|terminate|throw|_Unwind_Resume|__cxa_")
VECTOR = re.compile(r"%[xyz]mm\d+")
FUSED = re.compile(r"vfn?m(add|sub)\w*")
SCALAR_COMPARISON = re.compile(r"v?u?comis[sd]|v?cmp\w*s[sd]|set\w+")

# Instructions of the peak loops: a pattern and its count in one round. `chains` is the number of independent chains,
# which depends on the number of registers.
PEAK_LOOPS = {
    "separate_rounds<double": [(r"v?mulpd", "chains"), (r"v?addpd", "chains")],
    "separate_rounds<float": [(r"v?mulps", "chains"), (r"v?addps", "chains")],
    "fused_rounds<double": [(r"vfmadd\d+pd", "chains")],
    "fused_rounds<float": [(r"vfmadd\d+ps", "chains")],
    "::read(": [(r"v?pxorq?|v?xorp[sd]", 8)],
    "::triad(": [(r"v?mulpd", 4), (r"v?addpd", 4), (r"v?movap[sd]", 4)],
}


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def functions_of(object_file):
    """Demangled name and instructions of each function. An instruction is [address, name, operands]."""
    functions, current = {}, None
    for line in run("objdump", "-drC", "--no-show-raw-insn", object_file).splitlines():
        if found := re.fullmatch(r"[0-9a-f]+ <(.*)>:", line):
            current = functions.setdefault(found[1], [])
        elif found := re.fullmatch(r"\s*([0-9a-f]+):\t(?:(?:data16|cs|notrack|bnd) )*(\S+)\s*(.*)", line):
            current.append([int(found[1], 16), found[2], found[3]])
        elif found := re.match(r"\s+[0-9a-f]+: R_\S+\s+(.*)", line):
            current[-1][2] += " " + found[1]  # name of the function that is called
    return functions


def counts_of(instructions):
    """The count of each of KINDS in a function."""
    has_frame = any(name == "mov" and operands == "%rsp,%rbp" for _, name, operands in instructions)
    stack = re.compile(r"\(%r[sb]p" if has_frame else r"\(%rsp")
    calls = [operands for _, name, operands in instructions if name.startswith("call") and not COLD.search(operands)]
    memory = sum(bool(MEMORY_FUNCTION.search(operands)) for operands in calls)
    strings = sum(name == "rep" and bool(STRING_INSTRUCTION.match(operands)) for _, name, operands in instructions)
    accesses = sum(bool(stack.search(operands) and VECTOR.search(operands)) for _, _, operands in instructions)
    scalar = sum(bool(SCALAR_COMPARISON.fullmatch(name)) for _, name, _ in instructions)
    return memory + strings, len(calls) - memory, accesses, scalar


def instruction_set_of(command):
    return next((a.removeprefix("-march=") for a in command if a.startswith("-march=")), "x86-64")


def check_limits(build, commands):
    """Compares all functions of LIMITS with their limits, and rejects fused multiply-adds. Returns the number of
    errors."""
    objects = {}
    for command in commands:
        if "-o" in command and command[command.index("-o") + 1].startswith("systems/"):
            path = pathlib.Path(build) / command[command.index("-o") + 1]
            if not path.exists():
                sys.exit(f"{path}: object file: found none, expected a finished build")
            objects.setdefault(instruction_set_of(command), []).append(path)
    errors = 0
    for instruction_set, paths in sorted(objects.items()):
        found = {word: [] for word in LIMITS}
        for path in paths:
            for name, instructions in functions_of(path).items():
                for word in LIMITS:
                    if word in name and not COLD.search(name):
                        found[word].append((counts_of(instructions), name))
                fused = sorted({one for _, one, _ in instructions if FUSED.fullmatch(one)})
                if fused:
                    print(f"FAILED: {instruction_set}: {name}: found {', '.join(fused)}, expected no fused "
                          "multiply-add, because results must not depend on the instruction set")
                    errors += 1
        for word, functions in found.items():
            limits = LIMITS[word].get(instruction_set)
            if not functions:
                print(f"FAILED: {instruction_set}: functions with \"{word}\" in their name: found none, expected one")
                errors += 1
                continue
            most = tuple(max(counts) for counts in zip(*(counts for counts, _ in functions)))
            print(f"{instruction_set:10} {word:24}" + ", ".join(f"{n} {kind}" for n, kind in zip(most, KINDS)))
            for counts, name in functions if limits else []:
                for kind, count, limit in zip(KINDS, counts, limits):
                    if count > limit:
                        print(f"FAILED: {instruction_set}: {name}: {kind}: found {count}, expected at most {limit}")
                        errors += 1
    return errors


def loop_of(instructions):
    """The longest loop without a jump inside: instructions from the target of a backward jump to the jump."""
    loops = []
    for i, (address, name, operands) in enumerate(instructions):
        target = re.match(r"[0-9a-f]+", operands)
        if not name.startswith("j") or not target or int(target[0], 16) > address:
            continue
        body = [one for one in instructions[:i] if one[0] >= int(target[0], 16)]
        if not any(one[1].startswith("j") for one in body):
            loops.append(body)
    return max(loops, key=len, default=[])


def check_peak_loops(commands):
    """Compiles the peak loops as the build does and checks their instructions. Returns the number of errors."""
    errors = 0
    options = {instruction_set_of(c): [a for a in c if re.match(r"-m|-O|-std=", a)] for c in commands if "-c" in c}
    for instruction_set, of_set in sorted(options.items()):
        compiler = [commands[0][0], *of_set, "-ffp-contract=off", f"-I{sources.ROOT}"]
        macros = run(*compiler, "-x", "c++", "-dM", "-E", "/dev/null")
        register, chains = ("zmm", 24) if "__AVX512F__" in macros else ("ymm" if "__AVX__" in macros else "xmm", 14)
        with tempfile.TemporaryDirectory() as folder:
            run(*compiler, "-DSKERRY_LOOPS=loops", '-DSKERRY_LOOPS_FOR=""', "-o", f"{folder}/loops.o",
                "-c", sources.ROOT / "profiling/roofline/peak_loops.cpp")
            functions = functions_of(f"{folder}/loops.o")
        for word, expected in PEAK_LOOPS.items():
            if word.startswith("fused") and "__FMA__" not in macros:
                continue
            name = next((name for name in functions if word in name), None)
            loop = [(one, operands) for _, one, operands in loop_of(functions.get(name, []))]
            # A load of its own is equivalent to a memory operand of the instruction that uses the value.
            vector = [(one, operands) for one, operands in loop if VECTOR.search(operands)
                      and not (re.fullmatch(r"v?movap[sd]", one) and re.match(r"[-\w]*\(", operands))]
            wanted = {pattern: chains if count == "chains" else count for pattern, count in expected}
            counts = {pattern: sum(bool(re.fullmatch(pattern, one)) for one, _ in vector) for pattern in wanted}
            narrow = [one for one, operands in vector if set(re.findall("([xyz]mm)", operands)) != {register}]
            if counts != wanted or len(vector) != sum(wanted.values()) or narrow or "(%rsp" in str(loop):
                errors += 1
                print(f"FAILED: profiling/roofline/peak_loops.cpp: {instruction_set}: loop of {word}: found {counts} "
                      f"among {len(vector)} vector instructions, {len(narrow)} of them narrower than {register}, "
                      f"expected {wanted} and no others, without accesses to the stack")
    return errors


def main():
    build = sys.argv[1]
    commands = [c for c in sources.commands(build) if "/systems/" in c[-1]]
    if not commands:
        sys.exit(f"{build}/compile_commands.json: sources of systems/: found none, expected a configured build")
    errors = check_limits(build, commands) + check_peak_loops(commands)
    print(f"{errors} errors" if errors else "kernels and peak loops are within their limits")
    sys.exit(errors > 0)


if __name__ == "__main__":
    main()
