"""What tests recorded for the tables of docs/ (tests/support/record.h)."""
import json
import pathlib
import sys


def rows_of(folder):
    """All lines, sorted by item: within an item in the order of the tests, those without a number last."""
    rows = [json.loads(text) for file in sorted(pathlib.Path(folder).glob("*.jsonl"))
            for text in file.read_text().splitlines()]
    if not rows:
        sys.exit(f"{folder} holds no record of a test")
    return sorted(rows, key=lambda row: row["item"] or 1000)


def cells(values):
    """One line of a table."""
    return "| " + " | ".join(str(value).replace("|", "\\|") for value in values) + " |"
