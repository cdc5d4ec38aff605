#!/usr/bin/env python3
"""Writes docs/stress.md from the records of the stress tests: stress_table.py FOLDER OUTPUT. The page has one row for
each item, FOLDER/stress.csv has all checks."""
import pathlib
import sys

from records import by_item, cells, rows_of, write_csv

HEADER = """# Stress

On this page you see which extreme inputs the engine withstands. `scripts/stress` runs the tests tagged `[stress]` in
`tests/scene/stress`, writes this page, and lists all {checks} checks in `build/stress/stress.csv`. Every item also
requires that each step is taken, or refused with a message, and that the state stays finite. An item without a number
is a problem that users of other engines reported. {items} numbered items, {failed} checks failed.

| item | checks | passed | scenes | tests |
|---:|---:|---:|---|---|
"""
COLUMNS = ["item", "scene", "criterion", "found", "passed", "file", "test"]

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
- **10, 12, 15, 16, 17, 22, 23**: contact problems on their own; `tests/unit/solver` has more tests of them.
- **14**: the energy that does not rise is that of methods where kinetic and elastic energy are half a step apart; what
  is added up here wavers about it. `tests/property/elastic_motion_test.cpp` has it to rounding.
- **18**: `tests/unit/engine` has the same for scene and mesh files.
- **20**: contacts are solved to a relative error of 1e-3 by default, and a heap creeps by that part of what weight does
  in a step. A heap that has to lie still for an hour falls asleep (`sleep`, on by default) or needs `tolerance` 1e-8.
"""


def line(rows):
    """The row of an item: its scenes and tests, each once."""
    scenes = list(dict.fromkeys(row["what"] for row in rows))
    more = f"; and {len(scenes) - 3} more" if len(scenes) > 4 else ""
    shown = scenes[:3] if more else scenes
    files = dict.fromkeys(f"{row['file']}: {row['test']}" for row in rows)
    return cells([rows[0]["item"] or "-", len(rows), sum(row["held"] for row in rows), "; ".join(shown) + more,
                  "; ".join(files)])


def main(folder, output):
    rows = rows_of(folder)
    write_csv(pathlib.Path(folder) / "stress.csv", COLUMNS,
              ([row["item"], row["what"], row["criterion"], row["found"], row["held"], row["file"], row["test"]]
               for row in rows))
    failed = sum(not row["held"] for row in rows)
    items = by_item(rows)
    text = HEADER.format(checks=len(rows), items=sum(item > 0 for item in items), failed=failed)
    pathlib.Path(output).write_text(text + "".join(map(line, items.values())) + NOTES)
    print(f"{len(rows)} checks in {output}, {failed} failed")


if __name__ == "__main__":
    main(*sys.argv[1:])
