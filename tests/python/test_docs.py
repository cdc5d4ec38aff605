"""The code blocks of all Markdown pages work. A block that cannot run says so: ```sh no-run.

Python: the blocks of a page are one program. JSON: scenes load, and parts of scenes follow the schema. With SKERRY_FULL
in the environment also C++, which compiles, and shell commands, which run beside the folders scenes and examples.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
from typing import Any, NamedTuple

import pytest

import skerry as sk

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = sorted([ROOT / "README.md", ROOT / "scenes/README.md", *(ROOT / "docs").rglob("*.md")])
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
CONTEXT = re.compile(r"<!-- declares: ([^\n]*) -->\n$")  # declarations for the next block of C++
only_full = pytest.mark.skipif("SKERRY_FULL" not in os.environ, reason="SKERRY_FULL is not set")


class Block(NamedTuple):
    """A code block: number of its first line, its text, and the text of the page before it."""

    line: int
    text: str
    before: str


def blocks_of(page: pathlib.Path, language: str) -> list[Block]:
    """The blocks of a language, without those that cannot run."""
    text = page.read_text(encoding="utf-8")
    found = (match for match in FENCE.finditer(text) if match[1] == language)
    return [Block(text.count("\n", 0, m.start(2)) + 1, m[2], text[: m.start()]) for m in found]


def pages_with(language: str) -> Any:
    """Runs a test for each page that has blocks of a language."""
    # The commands of the gallery make the films of the site and take minutes.
    pages = [page for page in PAGES if page.stem != "gallery" and blocks_of(page, language)]
    return pytest.mark.parametrize("page", pages, ids=lambda page: str(page.relative_to(ROOT)))


def run(command: list[str], folder: pathlib.Path, **environment: str) -> None:
    """Runs a command, which must succeed and can import the package."""
    environment["PYTHONPATH"] = str(pathlib.Path(sk.__file__).parents[1])
    done = subprocess.run(
        command, cwd=folder, env=os.environ | environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pages_with("python")
def test_the_python_code_of_a_page_runs(page: pathlib.Path, tmp_path: pathlib.Path) -> None:
    program = ""
    for block in blocks_of(page, "python"):  # at their lines, so that messages name the lines of the page
        program += "\n" * (block.line - 1 - program.count("\n")) + block.text
    file = tmp_path / (page.stem + ".py")
    file.write_text(program, encoding="utf-8")
    run([sys.executable, "-W", "error", str(file)], tmp_path)


@pages_with("json")
def test_the_json_of_a_page_is_a_scene_or_a_part_of_one(page: pathlib.Path, tmp_path: pathlib.Path) -> None:
    schema = sk.scene_schema()
    shutil.copytree(ROOT / "scenes", tmp_path / "scenes")
    file = (tmp_path / "scenes" if page.parent.name == "scenes" else tmp_path) / "block.json"
    for block in blocks_of(page, "json"):
        whole = block.text.startswith("{")
        value = json.loads(block.text if whole else f"{{{block.text}}}")
        if whole and value.keys() & {"bodies", "include"} and value.keys() <= schema["properties"].keys():
            file.write_text(block.text, encoding="utf-8")
            sk.load_scene(file)
            continue
        validator = pytest.importorskip("jsonschema").Draft202012Validator
        sweep = json.loads((ROOT / "docs/sweep.schema.json").read_text(encoding="utf-8"))
        parts = [schema, sweep, *({**part, "$defs": schema["$defs"]} for part in schema["$defs"].values())]
        # A part may leave out members that the whole object needs.
        errors = [
            [e for e in validator(part).iter_errors(value) if e.path or e.validator == "additionalProperties"]
            for part in parts
        ]
        nearest = min(errors, key=lambda found: len(str(found)))
        assert not nearest, f"{page}:{block.line}: {nearest[0].message}"


@only_full
@pages_with("cpp")
def test_the_cpp_code_of_a_page_compiles(page: pathlib.Path, tmp_path: pathlib.Path) -> None:
    headers = sorted((ROOT / "engine/include/skerry").glob("*.h"))
    program = "#include <cstdio>\n#include <stdexcept>\n"
    program += "".join(f"#include <skerry/{header.name}>\n" for header in headers) + "using namespace skerry;\n"
    for number, block in enumerate(blocks_of(page, "cpp")):
        context = CONTEXT.search(block.before)
        code = re.sub(r"^#include .*$", "", block.text, flags=re.MULTILINE)
        declared = context[1] if context else ""
        program += f'void block_{number}() {{ {declared}\n#line {block.line} "{page}"\n{code}}}\n'
    file = tmp_path / "page.cpp"
    file.write_text(program, encoding="utf-8")
    folders = [f"-I{folder}" for folder in (ROOT / "engine/include", ROOT, "/usr/include/eigen3")]
    run(["c++", "-std=c++20", "-fsyntax-only", *folders, str(file)], tmp_path)


@only_full
@pages_with("sh")
def test_the_shell_commands_of_a_page_run(page: pathlib.Path, tmp_path: pathlib.Path) -> None:
    program = pathlib.Path(os.environ.get("SKERRY_PROGRAM", ROOT / "build/dev/skerry"))
    for folder in ("scenes", "examples"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    (tmp_path / "build/release").mkdir(parents=True)
    (tmp_path / "build/release/skerry").symlink_to(program)
    commands = "\n".join(block.text for block in blocks_of(page, "sh"))
    run(["bash", "-euxo", "pipefail", "-c", commands], tmp_path, PATH=f"{program.parent}:{os.environ['PATH']}")


def test_the_examples_named_in_the_guide_exist() -> None:
    text = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    for name in re.findall(r"\]\(\.\./(examples/[\w/.]+)", text):
        assert os.path.exists(ROOT / name), name


def test_the_first_scene_of_the_guide_is_a_file() -> None:
    text = (ROOT / "docs/first_scene.md").read_text(encoding="utf-8")
    shown = re.search(r"```json\n(.*?)```", text, re.DOTALL)
    assert shown and shown[1] == (ROOT / "examples/drop.json").read_text(encoding="utf-8")
