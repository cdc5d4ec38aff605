"""Records of tests for the tables of docs/ (tests/support/record.h)."""
import csv
import json
import pathlib
import sys


def rows_of(folder):
    """All rows, sorted by item: within an item in the order of the tests, those without a number last."""
    rows = [json.loads(text) for file in sorted(pathlib.Path(folder).glob("*.jsonl"))
            for text in file.read_text().splitlines()]
    if not rows:
        sys.exit(f"{folder} holds no record of a test")
    return sorted(rows, key=lambda row: row["item"] or 1000)


def by_item(rows):
    """Rows of each item, as a dictionary in the order of the items."""
    items = {}
    for row in rows:
        items.setdefault(row["item"] or 0, []).append(row)
    return items


def cells(values):
    """One row of a table."""
    return "| " + " | ".join(str(value).replace("|", "\\|") for value in values) + " |\n"


def write_csv(file, header, rows):
    with open(file, "w", newline="") as out:
        csv.writer(out).writerows([header, *rows])
