"""Rollouts: many copies of a world that follow given controls, on all cores."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import shape_text
from ._errors import Doubt, SceneError
from ._world import Attachment, Body, Collider, Joint, World

Reals: TypeAlias = NDArray[np.float64]
RolloutObject: TypeAlias = Body | Collider | Attachment | Joint | World | str
"""An object of the world, the name of a body or a collider, or the world itself."""


class _Quantity(NamedTuple):
    """A quantity that a rollout controls or records."""

    kind: str
    """Kind of the control or the probe in the extension module."""
    columns: tuple[str, ...]
    """Names of the columns. A control needs their number only. Empty: three columns for each node."""


def _vector(name: str) -> tuple[str, ...]:
    return tuple(f"{name}_{axis}" for axis in "xyz")


_POSE = _Quantity("pose", (*_vector("position"), *_vector("rotation")))
_VELOCITY = _Quantity("velocity", (*_vector("velocity"), *_vector("angular_velocity")))
_FORCE = _Quantity("force", _vector("force"))
_NODES = ()

_CONTROLS: dict[type, dict[str, _Quantity]] = {
    Collider: {"pose": _POSE, "velocity": _VELOCITY},
    Attachment: {"pose": _POSE, "velocity": _VELOCITY},
    Body: {"force": _FORCE, "loads": _Quantity("loads", _NODES)},
    Joint: {"coordinate": _Quantity("coordinate", ("",)), "speed": _Quantity("speed", ("",))},
    World: {"gravity": _Quantity("gravity", _vector("gravity"))},
}
"""Quantities that a rollout can control, by the class of the object. The first one is the default."""

_RECORDS: dict[type, dict[str, _Quantity]] = {
    Body: {
        "positions": _Quantity("nodes", _NODES),
        "center_of_mass": _Quantity("body", _vector("position")),
        "pose": _POSE,
        "velocity": _VELOCITY,
        "force": _FORCE,
        "von_mises": _Quantity("stress", ("largest_von_mises",)),
        "volume_ratio": _Quantity("volume", ("smallest_volume_ratio",)),
    },
    Collider: {"force": _FORCE, "pose": _POSE, "velocity": _VELOCITY},
    Attachment: {"force": _FORCE, "pose": _POSE, "velocity": _VELOCITY},
    Joint: {
        "coordinate": _Quantity("joint", ("angle", "displacement")),
        "speed": _Quantity("joint", ("speed",)),
        "force": _Quantity("joint", _vector("force")),
        "moment": _Quantity("joint", _vector("moment")),
    },
    World: {"energy": _Quantity("energy", ("kinetic", "elastic", "potential", "dissipated"))},
}
"""Quantities that a rollout can record, by the class of the object. The first one is the default."""


class Rollout(dict[str, Reals]):
    """Recorded values by name: arrays whose first two axes are the world and the interval. Values of intervals that
    were not completed are NaN."""

    time: Reals
    """Time at the end of each interval, shape (B, T) [s]."""
    completed: NDArray[np.int32]
    """Number of completed intervals of each world, shape (B,)."""
    messages: tuple[str, ...]
    """For each world the reason why it stopped; empty if it completed all intervals."""
    distrust: tuple[str, ...]
    """For each world the reason why its values cannot be trusted; empty if there is none."""
    worlds: tuple[World, ...]
    """The worlds at the end, if they were kept."""

    def __repr__(self) -> str:
        arrays = ", ".join(f"{name!r} {shape_text(values.shape)}" for name, values in self.items())
        count, steps = self.time.shape
        return f"<skerry.Rollout of {count:,} worlds, {steps:,} intervals: {arrays or 'no records'}>"


def rollout(
    worlds: World | Sequence[World],
    controls: Mapping[RolloutObject | tuple[RolloutObject, str], ArrayLike] | None = None,
    *,
    dt: float,
    steps: int | None = None,
    record: Mapping[str, RolloutObject | tuple[RolloutObject, str]] | None = None,
    threads: int = 0,
    keep_worlds: bool = False,
) -> Rollout:
    """Advances copies of a world through T intervals of dt [s], several copies at once. The given worlds do not change.

        poses = np.zeros((64, 100, 6))  # 64 worlds, 100 intervals
        out = skerry.rollout(world, {finger: poses}, dt=0.01, record={"ball": ball, "force": (finger, "force")})
        out["ball"]  # positions of the nodes (64, 100, n, 3)

    worlds: one world, or a list of copies of one world, which may differ in materials, poses and so on.

    controls: arrays (B, T, ...), or (T, ...) for all worlds, where B is the number of worlds. A key is an object, or an
    object and a quantity. Quantities of colliders and attachments: "pose" (default), position and rotation vector at
    the end of the interval (6,) [m, rad]; "velocity" (6,) [m/s, rad/s]. Of bodies: "force" (3,) [N]; "loads" (n, 3)
    [N]. Of joints with a motor: "coordinate" or "speed", one number. Of the world: "gravity" (3,) [m/s^2].

    steps: number T of intervals; needed only without controls.

    record: names of the results, and what they are at the end of each interval: an object, or an object and a
    quantity. Of bodies: "positions" (default, (n, 3)), "center_of_mass" (3,), "pose" (6,), "velocity" (6,), "force"
    (3,), "von_mises" (largest stress of a node [Pa]), "volume_ratio" (smallest of a tetrahedron). Of colliders and
    attachments: "force" (default), "pose", "velocity". Of joints: "coordinate" (default), "speed", "force", "moment".
    Of the world: "energy" (kinetic, elastic, potential, dissipated [J]). Forces are means over the interval [N].

    threads: number of threads; 0: all cores. keep_worlds: True: the result holds the worlds at the end.

    The values have the bits of a loop that copies each world, applies the controls of an interval, and calls
    advance(dt). A world whose step is refused stops, with a warning; the others continue. Ctrl-C ends all of them.

    TypeError: an array has the wrong shape. SceneError: an object, a quantity or a value is wrong; no world has run
    then. BusyError: another thread uses one of the worlds."""
    first = worlds if isinstance(worlds, World) else _first_of(worlds)
    given = {key: _Values(first, key, values) for key, values in (controls or {}).items()}
    count = _common(given, "number of worlds", 0, None if isinstance(worlds, World) else len(worlds)) or 1
    intervals = _common(given, "number of intervals", 1, steps)
    if intervals is None:
        raise SceneError("rollout: steps: found nothing, expected the number of intervals, because no control has it")
    copies = [worlds] * count if isinstance(worlds, World) else list(worlds)
    probes = {name: _Probe(first, name, of) for name, of in (record or {}).items()}
    values = _core.rollout(
        [world._core for world in copies],
        [(control.quantity.kind, control.handle, control.array.ravel()) for control in given.values()],
        [(name, probe.quantity.kind, probe.handle) for name, probe in probes.items()],
        float(dt),
        intervals,
        threads,
        keep_worlds,
    )
    result = Rollout()
    for (name, probe), (columns, series) in zip(probes.items(), values["series"], strict=True):
        result[name] = probe.select(columns, series.reshape((count, intervals, -1)))
    result.time = values["time"].reshape((count, intervals))
    completed, messages, distrust = zip(*values["status"], strict=True)
    result.completed = np.array(completed, dtype=np.int32)
    result.messages, result.distrust = messages, distrust
    result.worlds = tuple(World._of(core) for core in values["worlds"])
    _warn(result, intervals)
    return result


def _first_of(worlds: Sequence[World]) -> World:
    if not worlds:
        raise SceneError("rollout: worlds: found an empty list, expected at least one world")
    return worlds[0]


def _warn(result: Rollout, intervals: int) -> None:
    """Warns of worlds that stopped, and of values that cannot be trusted."""
    stopped = [number for number, message in enumerate(result.messages) if message]
    if stopped:
        number = stopped[0]
        warnings.warn(
            f"rollout: {len(stopped)} of {len(result.messages)} worlds stopped; world {number} completed "
            f"{result.completed[number]} of {intervals} intervals: {result.messages[number]}",
            Doubt,
            stacklevel=3,
        )
    for number, reason in enumerate(result.distrust):
        if reason:
            warnings.warn(f"rollout: world {number}: {reason}", Doubt, stacklevel=3)
            break


def _common(controls: Mapping[Any, _Values], what: str, place: int, given: int | None) -> int | None:
    """Number of worlds or intervals on which all controls agree."""
    common = given
    for control in controls.values():
        length = control.lengths[place]
        if length is None:
            continue
        if common is not None and common != length:
            raise TypeError(
                f"{control.name}: found an array of the shape {shape_text(control.array.shape)} with the {what} "
                f"{length}, expected {common}"
            )
        common = length
    return common


class _Target:
    """An object of the world and one of its quantities."""

    def __init__(self, world: World, place: str, given: Any, known: dict[type, dict[str, _Quantity]]) -> None:
        named, quantity = given if isinstance(given, tuple) else (given, None)
        self.object = _object_named(world, place, named) if isinstance(named, str) else named
        quantities = next((known[kind] for kind in known if isinstance(self.object, kind)), None)
        if quantities is None:
            classes = ", ".join(kind.__name__ for kind in known)
            raise TypeError(f"{place}: found {named!r}, expected a name or one of {classes}")
        if quantity is None:
            quantity = next(iter(quantities))
        if quantity not in quantities:
            expected = ", ".join(f"'{name}'" for name in quantities)
            raise SceneError(
                f"{place}: quantity of {self.object!r}: found {quantity!r}, expected one of {expected}",
                object=place,
                field="quantity",
                found=repr(quantity),
                expected=f"one of {expected}",
            )
        self.name = f"{place} ({quantity})"
        self.quantity = quantities[quantity]
        self.handle = None if isinstance(self.object, World) else self.object._handle

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of one value."""
        columns = self.quantity.columns
        if not columns:
            return (self.object.node_count, 3)
        return () if len(columns) == 1 else (len(columns),)


class _Values(_Target):
    """The values of a control."""

    def __init__(self, world: World, key: Any, values: ArrayLike) -> None:
        super().__init__(world, f"controls[{_text_of(key)}]", key, _CONTROLS)
        self.array = np.ascontiguousarray(values, dtype=np.float64)
        extra = self.array.ndim - len(self.shape)
        if extra not in (1, 2) or self.array.shape[extra:] != self.shape:
            raise TypeError(
                f"{self.name}: found an array of the shape {shape_text(self.array.shape)}, expected "
                f"{shape_text(('B', 'T', *self.shape))} or {shape_text(('T', *self.shape))}"
            )
        self.lengths = (self.array.shape[0] if extra == 2 else None, self.array.shape[extra - 1])


class _Probe(_Target):
    """A recorded quantity."""

    def __init__(self, world: World, name: str, given: Any) -> None:
        super().__init__(world, f"record['{name}']", given, _RECORDS)
        if self.quantity is _RECORDS[Joint]["coordinate"]:
            self.quantity = _Quantity("joint", ("angle",) if self.object.state.kind == "hinge" else ("displacement",))

    def select(self, columns: list[str], series: Reals) -> Reals:
        """The values of the quantity among all columns that the engine records for its probe."""
        if self.quantity.columns:
            series = series[:, :, [columns.index(column) for column in self.quantity.columns]]
        return np.ascontiguousarray(series.reshape((*series.shape[:2], *self.shape)))


def _object_named(world: World, place: str, name: str) -> Body | Collider:
    if name in world.colliders and name in world.bodies:
        raise SceneError(f"{place}: found a body and a collider of the name '{name}', expected the object itself")
    return world.colliders[name] if name in world.colliders else world.bodies[name]


def _text_of(key: object) -> str:
    return repr(key[0] if isinstance(key, tuple) else key)
