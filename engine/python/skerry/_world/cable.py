"""Cables that run through points of bodies."""

from __future__ import annotations

from dataclasses import dataclass

from .._arrays import TimeTable, TimeTableLike, Vector, time_table
from .objects import WorldObject


@dataclass(frozen=True, slots=True, kw_only=True)
class CableState:
    """Present shape and motion of a cable, and its tensions in the last step.

    points: present positions of the points [m].
    tension: tension of each segment [N].
    length: present length [m].
    rate: rate of `length` [m/s].
    released: greatest length; None if the tension is prescribed [m].
    work: work of the drive on the cable since the cable was added [J].
    dissipated: energy dissipated by friction at the points since the cable was added [J].
    """

    points: tuple[Vector, ...]
    tension: tuple[float, ...]
    length: float
    rate: float
    released: float | None
    work: float
    dissipated: float


class Cable(WorldObject):
    """A cable that runs straight from point to point and never pushes. Removing a body removes its cables."""

    __slots__ = ()

    @property
    def state(self) -> CableState:
        """Present shape, motion and tensions."""
        return CableState(**self._core.cable_state(self._handle))

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

    def remove(self) -> None:
        """Removes the cable."""
        self._world.remove(self)


def drive_tables(
    tension: TimeTableLike | None, length: TimeTableLike | None, rate: TimeTableLike | None
) -> list[TimeTable | None]:
    """The control of a cable for the extension module."""
    given = {"tension": tension, "length": length, "rate": rate}
    return [None if value is None else time_table(value, name) for name, value in given.items()]
