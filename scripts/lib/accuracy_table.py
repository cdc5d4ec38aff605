#!/usr/bin/env python3
"""Writes docs/accuracy.md from the records of the accuracy tests: accuracy_table.py FOLDER OUTPUT. The page has one
row for each item, FOLDER/accuracy.csv has all of them."""
import collections
import pathlib
import sys

from records import by_item, cells, rows_of, write_csv

HEADER = """# Accuracy

On this page you see how near the engine comes to closed forms. `scripts/accuracy` runs the tests tagged `[accuracy]` in
`tests/scene/accuracy` and `tests/property`, writes this page, and lists all {rows} checks in
`build/accuracy/accuracy.csv`. A row of the table shows the check of an item that comes nearest to its tolerance. The
error is absolute or relative, like its tolerance. Units are SI; `h` is the step and `n` a number of elements. The
formulas are derived in [the methods](methods/accuracy.md). {items} items.

| item | checks | nearest to its tolerance | formula | expected | found | error | tolerance |
|---:|---:|---|---|---:|---:|---:|---:|
"""
COLUMNS = ["item", "quantity", "formula", "expected", "found", "error", "tolerance", "kind"]


def number(value):
    """At most five digits that say something; zero is 0."""
    return "0" if value == 0 else f"{value:.5g}"


def percent(value):
    return f"{100 * value:.3g} %" if value >= 1e-4 else f"{value:.1e}"


def error_of(row):
    """Error in the sense of the tolerance: relative or absolute."""
    error = abs(row["found"] - row["expected"])
    return error / abs(row["expected"]) if row["kind"] == "relative" else error


def line(rows):
    """The row of an item."""
    row = max(rows, key=lambda row: error_of(row) / row["tolerance"] if row["tolerance"] > 0 else error_of(row))
    shown = percent if row["kind"] == "relative" else "{:.2g}".format
    return cells([row["item"] or "-", len(rows), row["name"], f"`{row['formula']}`", number(row["expected"]),
                  number(row["found"]), shown(error_of(row)), shown(row["tolerance"])])


def main(folder, output):
    rows = rows_of(folder)
    write_csv(pathlib.Path(folder) / "accuracy.csv", COLUMNS,
              ([row["item"], row["name"], row["formula"], row["expected"], row["found"], error_of(row),
                row["tolerance"], row["kind"]] for row in rows))
    notes = collections.defaultdict(list)
    for row in rows:
        if row["note"] and row["note"] not in notes[row["item"]]:
            notes[row["item"]].append(row["note"])
    items = by_item(rows)
    text = HEADER.format(rows=len(rows), items=len(items)) + "".join(map(line, items.values()))
    if any(notes.values()):
        text += "\n## Notes\n\n"
        text += "".join(f"- **{item or 'without a number'}**: {' '.join(lines)}\n" for item, lines in notes.items()
                        if lines)
    pathlib.Path(output).write_text(text)
    print(f"{len(rows)} checks of {len(items)} items in {output}")


if __name__ == "__main__":
    main(*sys.argv[1:])
