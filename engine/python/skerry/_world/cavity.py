"""Cavities, which are faces of a body under one pressure, and pipes between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

from numpy.typing import ArrayLike

from .._arrays import TimeTableLike, Vector, checked, index_array, optional_name, real, time_table
from .._settings import CavityLaw, Gas, Liquid
from .body import Body
from .objects import NamedObject, ObjectList

if TYPE_CHECKING:
    from .world import World


@dataclass(frozen=True, slots=True, kw_only=True)
class CavityState:
    """Present state of a cavity.

    body: the body.
    law: law of the pressure.
    faces: number of faces.
    closed: whether the faces enclose a volume.
    pressure: pressure above ambient [Pa].
    volume: volume; 0 if neither faces nor settings define one [m^3].
    mass: mass of the gas; 0 for other fillings [kg].
    energy: work that the filling would do if it expanded to ambient pressure [J].
    force: sum of the pressure forces on the body; zero for closed faces [N].
    """

    body: Body
    law: CavityLaw
    faces: int
    closed: bool
    pressure: float
    volume: float
    mass: float
    energy: float
    force: Vector


class Cavity(NamedObject):
    """Faces of a body under one pressure. Removing the body removes the cavity."""

    __slots__ = ()

    @property
    def state(self) -> CavityState:
        """Present pressure, volume, mass, energy and force."""
        values = self._core.cavity_state(self._handle)
        return CavityState(**{**values, "body": self._world._body(values["body"])})

    @property
    def settings(self) -> dict[str, Any]:
        """Present arguments of World.add_cavity(): pressure and volume of a filling have their present values."""
        values: dict[str, Any] = self._core.cavity_settings(self._handle)
        return {**values, "body": self._world._body(values["body"])}

    @property
    def pressure(self) -> float:
        """Pressure above ambient [Pa]."""
        return self.state.pressure

    @property
    def volume(self) -> float:
        """Volume; 0 if neither faces nor settings define one [m^3]."""
        return self.state.volume

    def set_pressure(self, pressure: TimeTableLike) -> None:
        """Sets a prescribed pressure above ambient: a number or pairs (time, value) [Pa]."""
        self._core.set_pressure(self._handle, time_table(pressure, "pressure"))

    def set_inflow(self, inflow: TimeTableLike) -> None:
        """Sets the flow of gas into the cavity: a number or pairs (time, value) [kg/s]."""
        self._core.set_inflow(self._handle, time_table(inflow, "inflow"))

    def set_liquid_volume(self, volume: TimeTableLike) -> None:
        """Sets the volume of a liquid at ambient pressure: a number or pairs (time, value) [m^3]."""
        self._core.set_liquid_volume(self._handle, time_table(volume, "volume"))


@dataclass(frozen=True, slots=True, kw_only=True)
class PipeState:
    """State of a pipe.

    first: the first cavity.
    second: the second cavity; None if the pipe ends at a reservoir.
    conductance: mass flow divided by the pressure difference [kg/(s Pa)].
    flow: mean mass flow out of the first cavity in the last step [kg/s].
    """

    first: Cavity
    second: Cavity | None
    conductance: float
    flow: float


class Pipe(NamedObject):
    """A pipe between two cavities with the same gas, or between a cavity and a reservoir."""

    __slots__ = ()

    @property
    def state(self) -> PipeState:
        """Ends, conductance and flow."""
        return PipeState(**self._with_cavities(self._core.pipe_state(self._handle)))

    @property
    def settings(self) -> dict[str, Any]:
        """Arguments of World.add_pipe()."""
        return self._with_cavities(self._core.pipe_settings(self._handle))

    def set_conductance(self, conductance: float) -> None:
        """Sets the mass flow divided by the pressure difference, >= 0 [kg/(s Pa)]."""
        self._core.set_conductance(self._handle, real(conductance, "conductance"))

    def set_reservoir(self, pressure: TimeTableLike) -> None:
        """Sets the pressure of the reservoir above ambient: a number or pairs (time, value) [Pa]."""
        self._core.set_reservoir(self._handle, time_table(pressure, "pressure"))

    def _with_cavities(self, values: dict[str, Any]) -> dict[str, Any]:
        """Values of the extension module with cavities in place of handles."""
        for name in ("first", "second"):
            if values[name] is not None:
                values[name] = self._world._cavity(values[name])
        return values


class CavityBuilding:
    """The part of World that adds and finds cavities and pipes."""

    __slots__ = ()

    if TYPE_CHECKING:
        _core: Any

        def _own(self, given: Any, name: str, *kinds: type) -> Any: ...

    def add_cavity(
        self,
        body: Body,
        *,
        faces: ArrayLike | None = None,
        pressure: TimeTableLike | None = None,
        gas: Gas | None = None,
        liquid: Liquid | None = None,
        volume: float | None = None,
        name: str | None = None,
    ) -> Cavity:
        """Puts faces of a body under a pressure and returns the cavity. Give one of `pressure`, `gas` and `liquid`.

        faces: rows of Body.surface, shape (n, 3); None: the walls of all hollows inside of the body, or the whole
            surface of a body without hollows.
        pressure: pressure above ambient, a number or pairs (time, value) [Pa].
        gas, liquid: filling of the cavity.
        volume: volume of the filling at the start, only for faces that do not enclose a volume, as those of a piston
            [m^3].
        name: see Cavity.name.
        SceneError: a face does not exist, or a value is out of range."""
        name = optional_name(name)
        given = [pressure, gas, liquid]
        if given.count(None) != 2:
            raise TypeError("add_cavity: expected exactly one of pressure, gas and liquid")
        handle = self._core.add_cavity(
            self._own(body, "body", Body),
            None if faces is None else index_array(faces, "faces", ("n", 3)),
            None if pressure is None else time_table(pressure, "pressure"),
            None if gas is None else checked(gas, "gas", Gas),
            None if liquid is None else checked(liquid, "liquid", Liquid),
            None if volume is None else real(volume, "volume"),
        )
        return self._cavity(handle)._named(name)

    def add_pipe(
        self,
        first: Cavity,
        second: Cavity | None = None,
        *,
        conductance: float,
        pressure: TimeTableLike = 0.0,
        name: str | None = None,
    ) -> Pipe:
        """Connects two cavities with the same gas, or a cavity and a reservoir of this gas, and returns the pipe.

        second: None: a reservoir.
        conductance: mass flow divided by the pressure difference, >= 0 [kg/(s Pa)].
        pressure: pressure of the reservoir above ambient, a number or pairs (time, value) [Pa].
        name: see Pipe.name.
        SceneError: a cavity has no gas or another one, or a value is out of range."""
        name = optional_name(name)
        handle = self._core.add_pipe(
            self._own(first, "first", Cavity),
            None if second is None else self._own(second, "second", Cavity),
            real(conductance, "conductance"),
            time_table(pressure, "pressure"),
        )
        return self._pipe(handle)._named(name)

    @property
    def cavities(self) -> ObjectList[Cavity]:
        """The cavities in the order added."""
        return ObjectList(self._cavity(handle) for handle in self._core.cavities())

    @property
    def pipes(self) -> ObjectList[Pipe]:
        """The pipes in the order added."""
        return ObjectList(self._pipe(handle) for handle in self._core.pipes())

    def _cavity(self, handle: Any) -> Cavity:
        name = self._core.name(self._core.cavity_state(handle)["body"])
        return Cavity(cast("World", self), handle, f"cavity of body '{name}'")

    def _pipe(self, handle: Any) -> Pipe:
        state = self._core.pipe_state(handle)
        label = f"pipe from the {self._cavity(state['first'])._label}"
        return Pipe(cast("World", self), handle, label)
