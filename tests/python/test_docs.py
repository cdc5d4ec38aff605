"""The Python code of README.md and docs/python.md runs, each page in one program, in the order of its blocks."""

import os
import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def program_of(page: str) -> str:
    """The Python blocks of a page, at their lines, so that messages name the lines of the page."""
    lines = (ROOT / page).read_text(encoding="utf-8").splitlines()
    program, inside = [], False
    for line in lines:
        if line.startswith("```"):
            inside = line == "```python"
            program.append("")
        else:
            program.append(line if inside else "")
    return "\n".join(program)


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_the_code_of_a_page_runs(page: str, tmp_path: pathlib.Path) -> None:
    program = program_of(page)
    assert program.strip(), page
    file = tmp_path / (pathlib.PurePath(page).stem + ".py")
    file.write_text(program, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-W", "error", str(file)], cwd=tmp_path, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_examples_named_in_the_guide_exist() -> None:
    text = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    for name in re.findall(r"\]\(\.\./(examples/[\w/.]+)", text):
        assert os.path.exists(ROOT / name), name


def test_the_first_scene_of_the_guide_is_a_file() -> None:
    text = (ROOT / "docs/first_scene.md").read_text(encoding="utf-8")
    shown = re.search(r"```json\n(.*?)```", text, re.DOTALL)
    assert shown and shown[1] == (ROOT / "examples/drop.json").read_text(encoding="utf-8")
