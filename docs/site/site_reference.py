"""Directives that generate the reference of scenes and of the command line, and the layout of Python docstrings."""

import json
import os
import pathlib
import re
import subprocess
from typing import Any
from xml.etree import ElementTree

from docutils import nodes
from scene_keys import ROOT, examples_of
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

# Meaning, default and unit of a key, as in "density; default: 1000 [kg/m^3]".
DESCRIPTION = re.compile(r"(?P<meaning>.*?)(?:; default: (?P<default>.*?))?(?: \[(?P<unit>[^\[\]]+)\])?", re.DOTALL)
ITEM = re.compile(r"((?:\w+, )*\w+): (.*)")
SPECIAL = re.compile(r"`[^`]*`|\|")

Schema = dict[str, Any]


def type_of(schema: Schema, prefix: str) -> str:
    """The values that a schema allows, in words."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return f"[{name}](#{prefix}-{name})"
    if "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    if choices := schema.get("oneOf", schema.get("anyOf")):
        return " or ".join(dict.fromkeys(type_of(choice, prefix) for choice in choices))
    kind = schema.get("type", "any value")
    if kind == "array":
        low, high = schema.get("minItems", 0), schema.get("maxItems")
        count = f"{low} " if low == high else f"at least {low} " if low and high is None else ""
        items = schema.get("prefixItems", [schema.get("items", {})])
        return f"list of {count}({', '.join(type_of(item, prefix) for item in items)})"
    if kind == "object" and isinstance(schema.get("additionalProperties"), dict):
        return f"object: name to {type_of(schema['additionalProperties'], prefix)}"
    limits = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
    bounds = [f"{sign} {schema[name]:g}" for name, sign in limits.items() if name in schema]
    return " ".join([kind, " and ".join(bounds)]).strip()


class SchemaKeys(SphinxDirective):
    """Lists all keys of a JSON schema: meaning, type, default, unit and an example of a shipped scene."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The sections of all objects of the schema."""
        path = os.path.join(self.env.srcdir, self.arguments[0])
        self.env.note_dependency(path)
        with open(path, encoding="utf-8") as file:
            schema = json.load(file)
        prefix = self.arguments[0].rpartition("/")[2].split(".")[0]
        examples = examples_of(schema) if prefix == "scene" else {}
        text: list[str] = []
        for name, part in {prefix: schema, **schema["$defs"]}.items():
            text += [f"({prefix}-{name})=", f"## {name}", "", part.get("description", ""), ""]
            for key, value in part.get("properties", {}).items():
                text += self.key(prefix, name, key, value, key in part.get("required", []), examples)
        return self.parse_text_to_nodes("\n".join(text), allow_section_headings=True)

    def key(self, prefix: str, name: str, key: str, schema: Schema, required: bool, examples: Any) -> list[str]:
        """The Markdown text of one key."""
        found = DESCRIPTION.fullmatch(schema.get("description", ""))
        assert found is not None
        lines = [f"::::{{confval}} {name}.{key}", "", f"{found['meaning']}.", "", f"- Value: {type_of(schema, prefix)}"]
        if found["unit"]:
            lines.append(f"- Unit: {found['unit']}")
        if found["default"] or required:
            lines.append(f"- Default: {found['default'] or 'none, the key is required'}")
        if (name, key) in examples:
            file, value = examples[name, key]
            lines += [f"- Example, from [{file}](/{file}):", f"  ```json\n  {json.dumps({key: value})[1:-1]}\n  ```"]
        return [*lines, "::::", ""]


class CommandHelp(SphinxDirective):
    """Shows the help texts of the program and of its commands."""

    def run(self) -> list[nodes.Node]:
        """A section for the program and for each command."""
        program = os.environ["SKERRY_PROGRAM"]

        def help_of(*command: str) -> str:
            return subprocess.run([program, *command, "--help"], check=True, capture_output=True, text=True).stdout

        general = help_of()
        commands = re.search(r"\nSubcommands:\n(.*?)\n\n", general, re.DOTALL)
        assert commands is not None
        text = ["```text", general, "```", ""]
        for name in re.findall(r"^  (\w+)", commands[1], re.MULTILINE):
            shown = help_of(name).split("\nExamples:")[0]
            text += [f"(command-{name})=", f"## skerry {name}", "", "```text", shown, "```", ""]
        return self.parse_text_to_nodes("\n".join(text), allow_section_headings=True)


class ProgramListing(SphinxDirective):
    """Shows the programs of a folder."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """A section for each program."""
        text: list[str] = []
        for path in sorted((pathlib.Path(self.env.srcdir) / self.arguments[0]).rglob("*.*")):
            if path.suffix in (".py", ".cpp"):
                name = path.relative_to(self.env.srcdir)
                text += [f"## {name}", "", f"```{{literalinclude}} /{name}", "```", ""]
        return self.parse_text_to_nodes("\n".join(text), allow_section_headings=True)


def write_header_pages(app: Sphinx) -> None:
    """Writes a page for each public header, as source of the site."""
    folder = pathlib.Path(app.srcdir) / "reference/cpp"
    folder.mkdir(exist_ok=True)
    index = ElementTree.parse(pathlib.Path(app.config.breathe_projects["skerry"]) / "index.xml")
    for compound in index.iterfind("compound[@kind='file']"):
        name = compound.findtext("name", "")
        path = f"skerry/{name}" if (ROOT / "engine/include/skerry" / name).exists() else f"components/{name}"
        page = f"# {path}\n\n```{{doxygenfile}} {name}\n```\n"
        (folder / name).with_suffix(".md").write_text(page, "utf-8")


def lay_out_docstring(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Makes reStructuredText of a docstring: items such as `rate: decay rate [1/s].`, `lower, upper: limits.` and
    `- rate` become lists, and indented lines after a blank line become code."""
    result: list[str] = []
    item = code = False  # inside an item `name: text`, inside code
    for line in lines:
        after_blank = bool(result) and not result[-1].strip()
        if line.startswith("    ") and (code or after_blank):
            result += [] if code else [".. code-block:: python", ""]
            code = True
        elif line.strip():
            code = False
            line = SPECIAL.sub(lambda text: text[0] if text[0] != "|" else r"\|", line)
            found = ITEM.fullmatch(line)
            if found and (item or after_blank):
                line = f"- ``{found[1]}``: {found[2]}"
                item = True
            else:
                item = item and not after_blank
                if line.startswith("- ") and re.match(r" *[^- ]", result[-1] if result else ""):
                    result.append("")  # between a paragraph and a list
                line = f"  {line.removeprefix('    ')}" if item else line
        result.append(line)
    lines[:] = result


def setup(app: Sphinx) -> dict[str, bool]:
    """Adds the parts of this file to Sphinx."""
    app.add_directive("schema-keys", SchemaKeys)
    app.add_directive("command-help", CommandHelp)
    app.add_directive("program-listing", ProgramListing)
    app.connect("builder-inited", write_header_pages)
    app.connect("autodoc-process-docstring", lay_out_docstring)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
