"""Commands of docs/gallery.md and docs/view.md with the state of the page that they show."""

import dataclasses
import re
import shlex

COMMAND = re.compile(r"^skerry (run|view) (.*\S) +# \S*#(\S+)$", re.MULTILINE)


@dataclasses.dataclass
class Command:
    """A command `skerry run` with --page at its end, or `skerry view`."""

    arguments: list[str]  # the first one is `run` or `view`; without --page
    page: str  # file of --page; empty for `view`
    state: str  # part of the address behind '#'


def commands_of(text: str) -> list[Command]:
    """Commands of a text, each on a line of its own with a comment FILE#STATE, or #STATE."""
    commands = []
    for name, rest, state in COMMAND.findall(text):
        arguments, _, page = rest.partition(" --page ")
        commands.append(Command([name, *shlex.split(arguments)], page, state))
    return commands
