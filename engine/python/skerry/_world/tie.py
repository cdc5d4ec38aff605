"""Ties of deformable bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._arrays import Vector, real
from .._settings import TieKind
from .objects import NamedObject

if TYPE_CHECKING:
    from .body import Body
    from .collider import Collider


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TieState:
    """Present state of a tie. Forces and moment are those of the last step; they act on the body whose nodes are tied.

    kind: kind of the tie.
    body: the body whose nodes are tied.
    to: the other body, or the collider; None if the nodes are tied to the world.
    break_force: force at which a node breaks off [N].
    point: mean position of the tied nodes [m].
    force: sum of the forces on the nodes [N].
    moment: moment of these forces about `point` [N m].
    largest_force: largest magnitude of `force` in a step since the tie was added [N].
    error: largest distance of a tied node from the position that the tie prescribes [m].
    nodes: numbers of the nodes, shape (n,).
    node_forces: force on each node, shape (n, 3) [N].
    node_errors: distance of each node from this position, shape (n,) [m].
    broken: time at which each node broke off, inf if it is tied, shape (n,) [s].
    """

    kind: TieKind
    body: Body
    to: Body | Collider | None
    break_force: float
    point: Vector
    force: Vector
    moment: Vector
    largest_force: float
    error: float
    nodes: NDArray[np.int32]
    node_forces: NDArray[np.float64]
    node_errors: NDArray[np.float64]
    broken: NDArray[np.float64]


class Tie(NamedObject):
    """A tie between nodes of a deformable body and another object. Removing one of the two removes the tie."""

    __slots__ = ()

    @property
    def state(self) -> TieState:
        """Present forces, errors and broken nodes."""
        return TieState(**self._with_objects(self._core.tie_state(self._handle)))

    @property
    def settings(self) -> dict[str, Any]:
        """Arguments of World.add_tie()."""
        return self._with_objects(self._core.tie_settings(self._handle))

    def set_break_force(self, force: float) -> None:
        """Sets the force at which a node breaks off [N]. Nodes that have broken off are not tied again."""
        self._core.set_break_force(self._handle, real(force, "force"))

    def _with_objects(self, values: dict[str, Any]) -> dict[str, Any]:
        """Values of the extension module with objects in place of handles."""
        body, collider = values.pop("to_body"), values.pop("to_collider")
        to = self._world._body(body) if body is not None else None
        values["to"] = self._world._collider(collider) if collider is not None else to
        values["body"] = self._world._body(values["body"])
        return values
