"""Points that are fixed to bodies, to colliders or to the world."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .._arrays import VectorLike

if TYPE_CHECKING:
    from .body import Body
    from .collider import Collider


@dataclass(frozen=True, slots=True, kw_only=True)
class Anchor:
    """A point that is fixed to a body, to a collider, or to the world if neither is given.

    body: the body.
    collider: the collider.
    point: present position in the world [m].
    """

    body: Body | None = None
    collider: Collider | None = None
    point: VectorLike = (0.0, 0.0, 0.0)
