"""The table of a world that notebooks show."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .objects import NamedObject
    from .world import World

_MOST_ROWS = 50


def world_table(world: World) -> str:
    """HTML text with the time of the world and its objects."""
    rows: list[tuple[str, str, str]] = [
        (body.name, body.dynamics, f"{body.node_count:,} nodes, {body.mass:.3g} kg{', asleep' if body.asleep else ''}")
        for body in world.bodies.values()
    ]
    rows += [(collider.name, "collider", type(collider.shape).__name__) for collider in world.colliders.values()]
    rows += [("", "attachment", attachment._label) for attachment in world.attachments]
    named: dict[str, Sequence[NamedObject]] = {
        "joint": world.joints,
        "tie": world.ties,
        "cable": world.cables,
        "spring": world.springs,
        "cavity": world.cavities,
        "pipe": world.pipes,
        "fibres": world.fibres,
        "load": world.loads,
        "surface set": world.surface_sets,
    }
    rows += [(item.name, kind, item._label) for kind, items in named.items() for item in items]
    left = len(rows) - _MOST_ROWS
    lines = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows[:_MOST_ROWS]]
    if left > 0:
        lines.append(f'<td colspan="3">and {left:,} more</td>')
    head = f"skerry.World at {world.time:.6g} s"
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table><caption>{escape(head)}</caption><tr><th>name</th><th>kind</th><th></th></tr>{body}</table>"
