"""The type hints of the package, checked by mypy as users run it."""

import pathlib
import re
import subprocess
import sys

import pytest

import skerry as sk

api = pytest.importorskip("mypy.api")

ROOT = pathlib.Path(__file__).resolve().parents[2]


def report_of(*arguments: str) -> str:
    """The errors that mypy reports."""
    report, trouble, _ = api.run(["--strict", "--no-error-summary", "--python-executable", sys.executable, *arguments])
    assert not trouble, trouble
    return str(report)


def test_the_package_passes_strict_checks() -> None:
    report = report_of("-p", "skerry")
    assert not report, report


def test_the_examples_pass_strict_checks() -> None:
    pytest.importorskip("gymnasium")
    report = report_of(*map(str, (ROOT / "examples/python").glob("*.py")))
    assert not report, report


def test_a_program_that_uses_every_name_passes_strict_checks(tmp_path: pathlib.Path) -> None:
    program = ROOT / "tests/python/uses.py"
    used = set(re.findall(r"\bsk\.(\w+)", program.read_text()))
    assert not set(sk.__all__) - used
    report = report_of(str(program))
    assert not report, report
    subprocess.run([sys.executable, "-W", "error", str(program), str(tmp_path)], check=True, timeout=120)


def test_mypy_finds_the_mistakes_of_a_program() -> None:
    program = ROOT / "tests/python/misuse.py"
    found = set(re.findall(r"misuse\.py:(\d+): error: .*\[([\w-]+)\]", report_of(str(program))))
    expected = {
        (str(number), match[1])
        for number, line in enumerate(program.read_text().splitlines(), 1)
        if (match := re.search(r"# expect: ([\w-]+)$", line))
    }
    assert found == expected
