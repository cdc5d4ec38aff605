#!/usr/bin/env python3
"""Writes docs/stress.md from the records of the stress tests: stress_table.py FOLDER OUTPUT. The page has one row for
each item, FOLDER/stress.csv has all checks."""
import pathlib
import sys

from records import by_item, cells, rows_of, write_csv

HEADER = """# Stress

This page shows which extreme inputs the engine withstands. `scripts/stress` runs the tests tagged `[stress]` in
`tests/scene/stress`, writes this page, and lists all {checks} checks in `build/stress/stress.csv`. An item is a
group of checks of one kind of input. The table names the first scene of each item; "and 3 more" counts its
other scenes. In all items the engine must take each step or refuse the step with a message, and the state must
stay finite. The item `-` contains problems that users of other engines reported. {items} numbered items,
{failed} checks failed.

| item | checks | passed | first scene |
|---:|---:|---:|---|
"""
COLUMNS = ["item", "scene", "criterion", "found", "passed", "file", "test"]

NOTES = """
## Notes

- **2**: All explicit bodies take time steps of the same length, which the stiffest of them limits. To avoid short
  steps, make stiff bodies [implicit](methods/implicit_bodies.md).
- **6**: If all nodes of a body lie exactly on a line, all elastic forces point along the line, so the nodes stay
  on the line until a disturbance.
- **9**: The push-out moves overlapping nodes apart at up to 0.5 m/s. The rest of the body follows like a mass on a
  spring whose end moves at this speed. The elastic rebound lets the body leave at up to twice this speed.
- **20**: By default the relative error of contact impulses is at most 1e-3. So in each step a heap can creep by 1e-3
  of the distance that it would fall without contacts. To keep a heap still for an hour, leave the setting `sleep` on,
  or set `tolerance` to 1e-8.
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
