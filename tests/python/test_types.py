"""The type hints of the package, checked by mypy as users run it."""

import pathlib
import re
import sys

import pytest

api = pytest.importorskip("mypy.api")

ROOT = pathlib.Path(__file__).resolve().parents[2]
OPTIONS = ["--strict", "--no-error-summary", "--python-executable", sys.executable]


def test_the_package_passes_strict_checks() -> None:
    report, errors, _ = api.run([*OPTIONS, "-p", "skerry"])
    assert (report, errors) == ("", "")


def test_the_examples_pass_strict_checks() -> None:
    for example in sorted((ROOT / "examples/python").glob("*.py")):
        report, errors, _ = api.run([*OPTIONS, str(example)])
        assert (report, errors) == ("", "")


def test_mypy_finds_the_mistakes_of_a_program() -> None:
    program = ROOT / "tests/python/misuse.py"
    report, errors, _ = api.run([*OPTIONS, str(program)])
    assert errors == ""
    found = set(re.findall(r"misuse\.py:(\d+): error: .*\[([\w-]+)\]", report))
    lines = program.read_text().splitlines()
    expected = {
        (str(number), match[1])
        for number, line in enumerate(lines, 1)
        if (match := re.search(r"# expect: ([\w-]+)$", line))
    }
    assert found == expected
