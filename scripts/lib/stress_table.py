#!/usr/bin/env python3
"""Writes docs/stress.md from the records of the stress tests: stress_table.py FOLDER OUTPUT. The page has one row for
each item, FOLDER/stress.csv has all checks."""
import pathlib
import sys

from records import by_item, cells, rows_of, write_csv

HEADER = """# Stress

On this page you see which extreme inputs the engine withstands. `scripts/stress` runs the tests tagged `[stress]` in
`tests/scene/stress`, writes this page, and lists all {checks} checks with their tests in `build/stress/stress.csv`.
Every item also requires that each step is taken, or refused with a message, and that the state stays finite. An item
without a number is a problem that users of other engines reported. {items} numbered items, {failed} checks failed.

| item | checks | passed | first scene |
|---:|---:|---:|---|
"""
COLUMNS = ["item", "scene", "criterion", "found", "passed", "file", "test"]

NOTES = """
## Notes

- **2**: One step serves all bodies here. A stiff body can be [implicit](methods/implicit_bodies.md).
- **6**: Where all nodes lie on an exact line, no force points off it, so the body stays there. Any disturbance opens
  it again. A body thrown into a heap may end twisted, with every tetrahedron the right way round.
- **9**: The push moves overlapping nodes at 0.5 m/s at most. The body follows by its elasticity, and can leave at up to
  twice this speed.
- **10, 12, 15, 16, 17, 22, 23**: contact problems by themselves; `tests/unit/solver` has more of them.
- **20**: Contacts are solved to a relative error of 1e-3 by default, and a heap creeps by that part of its motion under
  weight in a step. A heap that has to lie still for an hour falls asleep (`sleep`) or needs `tolerance` 1e-8.
"""


def line(rows):
    """The row of an item."""
    scenes = list(dict.fromkeys(row["what"] for row in rows))
    more = f" and {len(scenes) - 1} more" if len(scenes) > 1 else ""
    return cells([rows[0]["item"] or "-", len(rows), sum(row["held"] for row in rows), scenes[0] + more])


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
