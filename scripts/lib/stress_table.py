#!/usr/bin/env python3
"""Writes docs/stress.md from the records of the stress tests: stress_table.py FOLDER OUTPUT. The page has one row for
each item, FOLDER/stress.csv has all checks."""
import pathlib
import sys

from records import by_item, cells, rows_of, write_csv

HEADER = """# Stress

On this page you see which extreme inputs the engine withstands. `scripts/stress` runs the tests tagged `[stress]` in
`tests/scene/stress`, writes this page, and lists all {checks} checks with their tests in `build/stress/stress.csv`.
An item is a group of checks of one kind of input. The table names the first scene of each item. In all items
the engine must take each step or refuse it with a message, and the state must stay finite. The item `-` contains
problems that users of other engines reported. {items} numbered items, {failed} checks failed.

| item | checks | passed | first scene |
|---:|---:|---:|---|
"""
COLUMNS = ["item", "scene", "criterion", "found", "passed", "file", "test"]

NOTES = """
## Notes

- **2**: The stiffest body sets the time step of all bodies. To avoid short steps, make stiff bodies
  [implicit](methods/implicit_bodies.md).
- **6**: If all nodes of a body lie exactly on a line, all elastic forces point along the line, so the body stays on
  this line until it is disturbed. A body pressed into a random heap of nodes may end twisted, without inverted
  tetrahedra.
- **9**: The push-out moves overlapping nodes apart at no more than 0.5 m/s. The rest of the body follows by its
  elasticity, so the body can leave at up to twice this speed.
- **10, 12, 16, 17, 22, 23**: contact problems without a simulation; `tests/unit/solver` contains more of them.
- **20**: By default contacts are solved to a relative error of 1e-3. So in each step a heap can creep by 1e-3 of the
  distance that gravity would move it. To keep a heap still for an hour, let it sleep or set `tolerance` to 1e-8.
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
