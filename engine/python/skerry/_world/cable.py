"""Cables that run through points of bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .._arrays import TimeTable, TimeTableLike, time_table
from .anchor import Anchor, anchor_of
from .objects import NamedObject


@dataclass(frozen=True, slots=True, kw_only=True)
class CableState:
    """Present shape and motion of a cable, and its tensions in the last step.

    points: the points, at their present positions.
    tension: tension of each segment [N].
    length: present length [m].
    rate: rate of `length` [m/s].
    released: greatest length; None if the tension is prescribed [m].
    work: work of the drive on the cable since the cable was added [J].
    dissipated: energy dissipated by friction at the points since the cable was added [J].
    """

    points: tuple[Anchor, ...]
    tension: tuple[float, ...]
    length: float
    rate: float
    released: float | None
    work: float
    dissipated: float


class Cable(NamedObject):
    """A cable that runs straight from point to point and never pushes. Removing a body removes its cables."""

    __slots__ = ()

    @property
    def state(self) -> CableState:
        """Present shape, motion and tensions."""
        values = self._core.cable_state(self._handle)
        values["points"] = tuple(anchor_of(self._world, point) for point in values["points"])
        return CableState(**values)

    @property
    def settings(self) -> dict[str, Any]:
        """Present arguments of World.add_cable()."""
        values: dict[str, Any] = self._core.cable_settings(self._handle)
        values["points"] = [anchor_of(self._world, point) for point in values["points"]]
        return values

    @property
    def length(self) -> float:
        """Present length [m]."""
        return self.state.length

    def set_drive(
        self,
        *,
        tension: TimeTableLike | None = None,
        length: TimeTableLike | None = None,
        rate: TimeTableLike | None = None,
    ) -> None:
        """Prescribes the tension of the first segment [N], the greatest length [m], or its rate [m/s]. Exactly one must
        be given, as a number or as a list of pairs (time, value)."""
        self._core.set_cable_drive(self._handle, *drive_tables(tension, length, rate))


def drive_tables(
    tension: TimeTableLike | None, length: TimeTableLike | None, rate: TimeTableLike | None
) -> list[TimeTable | None]:
    """The control of a cable for the extension module."""
    given = {"tension": tension, "length": length, "rate": rate}
    return [None if value is None else time_table(value, name) for name, value in given.items()]
