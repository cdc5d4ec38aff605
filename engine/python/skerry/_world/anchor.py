"""Points on bodies and colliders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .. import _core
from .._arrays import checked, vector
from .._fields import VectorField, held

if TYPE_CHECKING:
    from .body import Body
    from .collider import Collider
    from .world import World


@dataclass(frozen=True, slots=True, kw_only=True)
class Anchor:
    """A point that is fixed to a body, to a collider, or to the world if neither is given. The point of a deformable
    body must be inside the body, or at most one mean edge length of its surface outside.

    body: body to which the point is fixed.
    collider: collider to which the point is fixed.
    point: position in the world at the time when the anchor is used, shape (3,) [m].
    """

    body: Body | None = None
    collider: Collider | None = None
    point: VectorField = held((0.0, 0.0, 0.0))

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", vector(getattr(self, "point"), "Anchor.point"))


def core_anchor(world: World, anchor: Anchor, name: str) -> Any:
    """The anchor for the extension module. Its objects must be objects of `world`."""
    from .body import Body
    from .collider import Collider

    given = checked(anchor, name, Anchor)
    body = None if given.body is None else world._own(given.body, f"{name}.body", Body)
    collider = None if given.collider is None else world._own(given.collider, f"{name}.collider", Collider)
    return _core.anchor(body, collider, given.point)


def anchor_label(world: World, core: Any) -> str:
    """Text that names the object of an anchor of the extension module."""
    body, collider, _ = core.values
    if body is not None:
        return f"body '{world._core.name(body)}'"
    return "the world" if collider is None else f"collider '{world._core.name(collider)}'"


def anchor_of(world: World, core: Any) -> Anchor:
    """The Python object of an anchor of the extension module."""
    body, collider, point = core.values
    return Anchor(
        body=None if body is None else world._body(body),
        collider=None if collider is None else world._collider(collider),
        point=point,
    )
