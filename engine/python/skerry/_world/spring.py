"""Springs and dampers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .._arrays import TimeTableLike, real, time_table
from .anchor import Anchor, anchor_of, core_anchor
from .objects import NamedObject


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringState:
    """Present state of a spring.

    first: first anchor, at its present position.
    second: second anchor, at its present position.
    length: distance of the two anchors [m].
    rate: rate of `length` [m/s].
    rest_length: length without elastic force [m].
    force: force in the last step; positive if it pulls the anchors together [N].
    energy: elastic energy [J].
    """

    first: Anchor
    second: Anchor
    length: float
    rate: float
    rest_length: float
    force: float
    energy: float


class Spring(NamedObject):
    """A spring, a damper, or both in parallel, between two anchors. Removing a body or a collider of an anchor removes
    the spring."""

    __slots__ = ()

    @property
    def state(self) -> SpringState:
        """Present anchors, length, force and energy."""
        values = self._core.spring_state(self._handle)
        for name in ("first", "second"):
            values[name] = anchor_of(self._world, values[name])
        return SpringState(**values)

    @property
    def settings(self) -> dict[str, Any]:
        """Present arguments of World.add_spring()."""
        values: dict[str, Any] = self._core.spring_settings(self._handle)
        for name in ("first", "second"):
            values[name] = anchor_of(self._world, values[name])
        return values

    def set_second(self, anchor: Anchor) -> None:
        """Moves the second anchor. The rest length does not change. With `strength`, this drags a body to a moving
        point."""
        self._core.set_second(self._handle, core_anchor(self._world, anchor, "anchor"))

    def set_rest_length(self, rest_length: TimeTableLike) -> None:
        """Sets the rest length: a number, or pairs (time [s], length) [m]."""
        self._core.set_rest_length(self._handle, time_table(rest_length, "rest_length"))

    def set_stiffness(self, stiffness: float) -> None:
        """Sets the stiffness [N/m]."""
        self._core.set_stiffness(self._handle, real(stiffness, "stiffness"))

    def set_damping(self, damping: float) -> None:
        """Sets the damping [N s/m]."""
        self._core.set_damping(self._handle, real(damping, "damping"))
