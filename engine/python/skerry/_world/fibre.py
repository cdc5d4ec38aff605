"""Fibres in bodies, which resist stretch and contract like muscle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._arrays import Reals, TimeTableLike, index_array, optional_name, real, real_array, time_table
from .objects import NamedObject, ObjectList

if TYPE_CHECKING:
    from .body import Body
    from .world import World


@dataclass(frozen=True, slots=True, kw_only=True)
class FibreState:
    """Present state of a family of fibres.

    body: the body that contains the fibres.
    tension: present active tension [Pa].
    energy: energy of the stretch [J].
    tetrahedra: numbers of the tetrahedra with fibres, (n,).
    stretch: present length of the fibres over their length at rest, by tetrahedron, (n,).
    stress: nominal stress along the fibres with the active tension, by tetrahedron, (n,) [Pa].
    """

    body: Body
    tension: float
    energy: float
    tetrahedra: NDArray[np.int32]
    stretch: Reals
    stress: Reals


class FibreFamily(NamedObject):
    """A family of fibres in a body. Removing the body removes its fibres."""

    __slots__ = ()

    @property
    def state(self) -> FibreState:
        """Present stretch, stress and energy."""
        values = self._core.fibre_state(self._handle)
        values["body"] = self._world._body(values["body"])
        return FibreState(**values)

    @property
    def settings(self) -> dict[str, Any]:
        """Present arguments of World.add_fibres()."""
        values: dict[str, Any] = self._core.fibre_settings(self._handle)
        values["body"] = self._world._body(values["body"])
        return values

    def set_tension(self, tension: TimeTableLike) -> None:
        """Replaces the active tension [Pa], >= 0: a number, or pairs (time [s], tension)."""
        self._core.set_tension(self._handle, time_table(tension, "tension"))


class WorldFibres:
    """The part of World that adds and finds fibres."""

    __slots__ = ()

    if TYPE_CHECKING:
        _core: Any
        _own: Any

    def add_fibres(
        self,
        body: Body,
        direction: ArrayLike,
        *,
        tetrahedra: ArrayLike | None = None,
        stiffness: float = 0.0,
        exponent: float = 0.0,
        tension: TimeTableLike = 0.0,
        name: str | None = None,
    ) -> FibreFamily:
        """Adds a family of fibres with the energy W = k_1/(2 k_2) (exp(k_2 E^2) - 1), E = max(stretch^2 - 1, 0).

        direction: direction in the mesh, (3,) for all tetrahedra or (n, 3).
        tetrahedra: numbers, (n,); None: all.
        stiffness: k_1, >= 0 [Pa].
        exponent: k_2, >= 0.
        tension: active tension, >= 0, as force along the fibres per area at rest [Pa]: a number, or pairs (time [s],
            tension).
        name: see FibreFamily.name."""
        from .body import Body

        name = optional_name(name)
        family = self._new_fibres(
            self._core.add_fibres(
                self._own(body, "body", Body),
                index_array(() if tetrahedra is None else tetrahedra, "tetrahedra", ("n",)),
                real_array(np.atleast_2d(np.asarray(direction, dtype=float)), "direction", ("n", 3)),
                (real(stiffness, "stiffness"), real(exponent, "exponent")),
                time_table(tension, "tension"),
            )
        )
        return family._named(name)

    @property
    def fibres(self) -> ObjectList[FibreFamily]:
        """The families of fibres in the order added."""
        return ObjectList(self._new_fibres(handle) for handle in self._core.fibres_of_world())

    def _new_fibres(self, handle: Any) -> FibreFamily:
        body = self._core.name(self._core.fibre_body(handle))
        return FibreFamily(cast("World", self), handle, f"fibres in body '{body}'")
