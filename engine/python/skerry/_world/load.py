"""Loads on nodes and faces, and force fields, with values that change over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, cast

from numpy.typing import ArrayLike

from .._arrays import TimeTableLike, Vector, VectorLike, flag, index_array, optional_name, real, real_array, time_table
from .objects import NamedObject, ObjectList

if TYPE_CHECKING:
    from .body import Body
    from .world import World

LoadKind: TypeAlias = Literal["force", "traction", "acceleration", "gravity", "drag"]


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadState:
    """State of a load at the present time.

    kind: kind of the load.
    body: the body that it acts on; None if it acts on all bodies.
    vector: value without the scale: force [N], traction [Pa], acceleration [m/s^2] or velocity of the wind [m/s]; zero
        for a factor of the weight.
    rate: rate of a drag [1/s].
    scale: present scale.
    force: sum of the present forces on all nodes [N]; for a factor of the weight, the difference from the full weight.
    """

    kind: LoadKind
    body: Body | None
    vector: Vector
    rate: float
    scale: float
    force: Vector


class Load(NamedObject):
    """A load on nodes or faces, or a force field. Removing a body removes its loads."""

    __slots__ = ()

    @property
    def state(self) -> LoadState:
        """Present values and force."""
        return LoadState(**self._with_body(self._core.load_state(self._handle)))

    @property
    def settings(self) -> dict[str, Any]:
        """Arguments of the method of World that adds such a load: add_force(), add_traction() and so on."""
        return self._with_body(self._core.load_settings(self._handle))

    def set_scale(self, scale: TimeTableLike) -> None:
        """Replaces the scale: a number, or pairs (time [s], value)."""
        self._core.set_load_scale(self._handle, time_table(scale, "scale"))

    def set_vector(self, vector: VectorLike) -> None:
        """Replaces the force [N], traction [Pa], acceleration [m/s^2] or velocity of the wind [m/s], shape (3,)."""
        self._core.set_load_vector(self._handle, real_array(vector, "vector", (3,)))

    def _with_body(self, values: dict[str, Any]) -> dict[str, Any]:
        """Values of the extension module with a body in place of its handle."""
        if values["body"] is not None:
            values["body"] = self._world._body(values["body"])
        return values


class WorldLoads:
    """The part of World that adds and finds loads. Every load has a `scale`: a number, or pairs (time [s], value). A
    step uses the exact mean of the scale, so that the impulses add up to the integral of the force over time. `name`:
    see Load.name."""

    __slots__ = ()

    if TYPE_CHECKING:
        _core: Any
        _own: Any

    def add_force(
        self,
        body: Body,
        nodes: ArrayLike,
        force: VectorLike,
        *,
        scale: TimeTableLike = 1.0,
        name: str | None = None,
    ) -> Load:
        """Adds a total force (3,) [N] on some nodes of a body, which share it in proportion to their masses. nodes:
        numbers within the body (j,), or a truth value for each node (n,)."""
        name = optional_name(name)
        load = self._new_load(
            self._core.add_force(
                self._loaded(body),
                body._node_numbers(nodes),
                real_array(force, "force", (3,)),
                time_table(scale, "scale"),
            )
        )
        return load._named(name)

    def add_traction(
        self,
        body: Body,
        faces: ArrayLike,
        traction: VectorLike,
        *,
        scale: TimeTableLike = 1.0,
        present_area: bool = False,
        name: str | None = None,
    ) -> Load:
        """Adds a force per area (3,) [Pa] on some faces of a body, which are rows of body.surface, shape (n, 3). The
        direction is fixed in the world. present_area: True: per area of the deformed faces; False: per area of the
        faces in the rest shape."""
        name = optional_name(name)
        load = self._new_load(
            self._core.add_traction(
                self._loaded(body),
                index_array(faces, "faces", ("n", 3)),
                real_array(traction, "traction", (3,)),
                time_table(scale, "scale"),
                flag(present_area, "present_area"),
            )
        )
        return load._named(name)

    def add_acceleration(
        self,
        acceleration: VectorLike,
        *,
        body: Body | None = None,
        scale: TimeTableLike = 1.0,
        name: str | None = None,
    ) -> Load:
        """Adds an acceleration (3,) [m/s^2] of a body, or of all bodies, to the gravity of the settings."""
        name = optional_name(name)
        load = self._new_load(
            self._core.add_acceleration(
                self._body_or_all(body),
                real_array(acceleration, "acceleration", (3,)),
                time_table(scale, "scale"),
            )
        )
        return load._named(name)

    def add_gravity_scale(self, scale: TimeTableLike, *, body: Body | None = None, name: str | None = None) -> Load:
        """Multiplies the weight of a body, or of all bodies. A factor of one body replaces that of all bodies."""
        name = optional_name(name)
        handle = self._core.add_gravity_scale(self._body_or_all(body), time_table(scale, "scale"))
        return self._new_load(handle)._named(name)

    def add_drag(
        self,
        rate: float,
        *,
        wind: VectorLike = (0.0, 0.0, 0.0),
        body: Body | None = None,
        scale: TimeTableLike = 1.0,
        name: str | None = None,
    ) -> Load:
        """Adds a drag on a body, or on all bodies: the force on a node of mass m and velocity v is m rate (wind - v).

        rate: > 0 [1/s]; steps are not longer than 1/rate.
        wind: velocity of the wind (3,) [m/s].
        scale: factor of `wind`."""
        name = optional_name(name)
        load = self._new_load(
            self._core.add_drag(
                self._body_or_all(body),
                real(rate, "rate"),
                real_array(wind, "wind", (3,)),
                time_table(scale, "scale"),
            )
        )
        return load._named(name)

    @property
    def loads(self) -> ObjectList[Load]:
        """The loads in the order added. Forces of Body.set_loads() are not listed."""
        return ObjectList(self._new_load(handle) for handle in self._core.loads_of_world())

    def _new_load(self, handle: Any) -> Load:
        state = self._core.load_state(handle)
        body = state["body"]
        on = "all bodies" if body is None else f"body '{self._core.name(body)}'"
        return Load(cast("World", self), handle, f"{state['kind']} on {on}")

    def _body_or_all(self, body: Body | None) -> Any:
        """Handle of a body; None means all bodies."""
        return None if body is None else self._loaded(body)

    def _loaded(self, body: Body) -> Any:
        from .body import Body

        return self._own(body, "body", Body)
