#!/usr/bin/env python3
"""The table of docs/stress.md from what the stress tests recorded: stress_table.py FOLDER OUTPUT"""
import pathlib
import sys

from records import cells, rows_of

HEADER = """# Stress

Made by `scripts/stress`, which runs the tests tagged `[stress]` of `tests/scene/stress`: every line is a check of one
of them. *Every step taken* means that no step was refused; a region that is not converged is flagged in the report of
the step. Lines without a number are what users report of other engines. SI units unless said; `h` is the step. {lines}
lines, {items} items, {failed} failed.

| item | what | criterion | found | verdict | test |
|---:|---|---|---|---|---|
"""

NOTES = """
## Notes

- **2**: one step serves all bodies here; a stiff body can be [implicit](methods/implicit_bodies.md).
- **6**: no force has a direction where F = 0, and none points off an exact line: the stable neo-Hookean law, which is
  smooth, leaves a body there. It is no minimum (the logarithmic term of the paper sees to that): pressed to a hundredth
  of its size it comes back. A body thrown into a heap, or off a line by rounding, opens this way here and that way
  there and may end wound or twisted, each tetrahedron the right way round. Below a Poisson ratio of -0.85 the law as
  published has a second minimum, at about half the length. The corotational law recovers from an exact point with seven
  of nine lengths of step: rounding decides how elements unfold, and some can stay twisted against each other.
- **9**: the push moves the nodes that are inside, at 0.5 m/s at most, and the body follows by its elasticity. The end
  of a bar that is moved at v sends a wave that brings the bar to v and comes back at 2 v: a body leaves at up to twice
  the push speed, where a rigid one would not exceed it.
- **10, 12, 15, 16, 17, 22, 23**: contact problems on their own; `tests/unit/solver` looks at the same from nearer by.
- **14**: the energy that does not rise is that of methods where kinetic and elastic energy are half a step apart; what
  is added up here wavers about it. `tests/property/elastic_motion_test.cpp` has it to rounding.
- **18**: `tests/unit/engine` has the same for scene and mesh files.
- **20**: contacts are solved to a relative error of 1e-3 by default, and a heap creeps by that part of what weight does
  in a step. A heap that has to lie still for an hour falls asleep (`sleep_speed`) or needs `tolerance` 1e-8.
"""


def main(folder, output):
    rows = rows_of(folder)
    failed = sum(not row["held"] for row in rows)
    text = HEADER.format(lines=len(rows), items=len({row["item"] for row in rows if row["item"]}), failed=failed)
    for row in rows:
        test = f"{row['file']}: {row['test']}"
        verdict = "pass" if row["held"] else "**fail**"
        text += cells([row["item"] or "-", row["what"], row["criterion"], row["found"], verdict, test]) + "\n"
    pathlib.Path(output).write_text(text + NOTES)
    print(f"{len(rows)} lines in {output}, {failed} failed")


if __name__ == "__main__":
    main(*sys.argv[1:])
