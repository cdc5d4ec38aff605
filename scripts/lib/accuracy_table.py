#!/usr/bin/env python3
"""Writes docs/accuracy.md and a table from the records of the accuracy tests: accuracy_table.py FOLDER PAGE TABLE. The
page shows the items that come nearest to their tolerances, the table has all checks with their notes."""
import pathlib
import statistics
import sys

from records import by_item, cells, rows_of, write_csv

HEADER = """# Accuracy

This page shows how closely the engine agrees with known solutions (*items*). `scripts/accuracy` runs the tests tagged
`[accuracy]` and writes this page. [accuracy.csv](accuracy/accuracy.csv) lists all {rows} checks of {items} items, with
formulas. Half of the errors are below {median:.1g} of their tolerance. The table shows the worst check of the {shown}
items that come nearest to a tolerance. Errors and tolerances in % are relative, others absolute.

Symbols: `n` number of elements, `h` time step or length, `a` angle or radius, `b` outer radius, `R` radius, `t`
thickness, `m` mass, `v` speed, `F` force, `p` pressure, `theta_0` start angle. Bars have the length `L`, cross-section
`A`, second moment of area `I` and wave speed `c`. `E*` is `E/(1 - nu^2)`. Items without a formula use a fine mesh of
quadratic tetrahedra.

| item | checks | quantity | formula | expected | found | error | tolerance |
|---:|---:|---|---|---:|---:|---:|---:|
"""
COLUMNS = ["item", "quantity", "formula", "expected", "found", "error", "tolerance", "kind", "note"]
SHOWN = 8  # rows of the table in the page


def number(value):
    """At most five significant digits; zero is 0."""
    return "0" if value == 0 else f"{value:.5g}"


def percent(value):
    return f"{100 * value:.3g} %" if value >= 1e-4 else f"{value:.1e}"


def error_of(row):
    """Error in the sense of the tolerance: relative or absolute."""
    error = abs(row["found"] - row["expected"])
    return error / abs(row["expected"]) if row["kind"] == "relative" else error


def used(row):
    """The part of its tolerance that a check uses."""
    return error_of(row) / row["tolerance"] if row["tolerance"] > 0 else error_of(row)


def named(rows):
    """Replaces "the same" at the start of a name by the last full name above, up to its first comma."""
    thing = ""
    for row in rows:
        if row["name"].startswith("the same"):
            row["name"] = row["name"].replace("the same", thing, 1)
        else:
            thing = row["name"].split(",")[0]
    return rows


def line(rows):
    """The row of an item."""
    row = max(rows, key=used)
    shown = percent if row["kind"] == "relative" else "{:.2g}".format
    return cells([row["item"] or "-", len(rows), row["name"], f"`{row['formula']}`", number(row["expected"]),
                  number(row["found"]), shown(error_of(row)), shown(row["tolerance"])])


def main(folder, page, table):
    rows = named(rows_of(folder))
    write_csv(table, COLUMNS,
              ([row["item"], row["name"], row["formula"], number(row["expected"]), number(row["found"]),
                f"{error_of(row):.3g}", number(row["tolerance"]), row["kind"], row["note"]] for row in rows))
    items = by_item(rows)
    nearest = sorted(items.values(), key=lambda of_item: -max(map(used, of_item)))[:SHOWN]
    shown = [of_item for of_item in items.values() if of_item in nearest]
    text = HEADER.format(rows=len(rows), items=len(items), shown=len(shown),
                         median=statistics.median(map(used, rows))) + "".join(map(line, shown))
    pathlib.Path(page).write_text(text)
    print(f"{len(rows)} checks of {len(items)} items in {table}")


if __name__ == "__main__":
    main(*sys.argv[1:])
