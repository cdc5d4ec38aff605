#!/usr/bin/env python3
"""The table of docs/accuracy.md from what the accuracy tests recorded: accuracy_table.py FOLDER OUTPUT"""
import collections
import pathlib
import sys

from records import cells, rows_of

HEADER = """# Accuracy

Made by `scripts/accuracy`, which runs the tests tagged `[accuracy]`: every line is an assertion of one of them, in
`tests/scene/accuracy` or `tests/property`. *Error* is absolute, or relative to what is expected, as the tolerance is.
SI units unless said; `h` is the step, `n` a number of elements. {lines} lines, {items} items.

| item | what | formula | expected | found | error | tolerance |
|---:|---|---|---:|---:|---:|---:|
"""


def number(value):
    """At most five digits that say something; zero is 0."""
    return "0" if value == 0 else f"{value:.5g}"


def percent(value):
    return f"{100 * value:.3g} %" if value >= 1e-4 else f"{value:.1e}"


def line(row):
    error = abs(row["found"] - row["expected"])
    if row["kind"] == "relative":
        error, tolerance = percent(error / abs(row["expected"])), percent(row["tolerance"])
    else:
        error, tolerance = f"{error:.2g}", f"{row['tolerance']:.2g}"
    return cells([row["item"] or "-", row["name"], f"`{row['formula']}`", number(row["expected"]), number(row["found"]),
                  error, tolerance])


def main(folder, output):
    rows = rows_of(folder)
    notes = collections.defaultdict(list)
    for row in rows:
        if row["note"] and row["note"] not in notes[row["item"]]:
            notes[row["item"]].append(row["note"])
    text = HEADER.format(lines=len(rows), items=len({row["item"] for row in rows}))
    text += "\n".join(map(line, rows)) + "\n"
    if any(notes.values()):
        text += "\n## Notes\n\n"
        text += "".join(f"- **{item or 'without a number'}**: {' '.join(lines)}\n" for item, lines in notes.items()
                        if lines)
    pathlib.Path(output).write_text(text)
    print(f"{len(rows)} lines in {output}")


if __name__ == "__main__":
    main(*sys.argv[1:])
