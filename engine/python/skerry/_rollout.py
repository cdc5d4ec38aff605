"""Rollouts: many copies of a world that follow given controls, on all cores."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import shape_text
from ._errors import Doubt, scene_error
from ._recorder import NodesProbe, Probe, recorded_probes
from ._world import Attachment, Body, Collider, Joint, World

Reals: TypeAlias = NDArray[np.float64]
RolloutObject: TypeAlias = Body | Collider | Attachment | Joint | World | str
"""An object of the world, the name of a body or a collider, or the world itself."""


_CONTROLS: dict[type, dict[str, tuple[int, ...]]] = {
    Collider: {"pose": (6,), "velocity": (6,)},
    Attachment: {"pose": (6,), "velocity": (6,)},
    Body: {"force": (3,), "loads": (-1, 3)},
    Joint: {"coordinate": (), "speed": ()},
    World: {"gravity": (3,)},
}
"""Quantities that a rollout can control, by the class of the object, with the shape of one value; -1 stands for the
number of nodes. The first quantity is the default."""


class Rollout(dict[str, Reals]):
    """Recorded values by name: arrays whose first two axes are the world and the interval. Values of intervals that
    were not completed are NaN. rollout() makes it."""

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
    record: Mapping[str, Probe] | None = None,
    threads: int = 0,
    keep_worlds: bool = False,
) -> Rollout:
    """Advances copies of a world through T intervals of dt [s], several copies at once. The given worlds do not change.

        poses = np.zeros((64, 100, 6))  # 64 worlds, 100 intervals
        out = skerry.rollout(world, {finger: poses}, dt=0.01, record={"tip": ball.probe((0, 0, 0.1))})
        out["tip.position"]  # shape (64, 100, 3)

    worlds: one world, or a list of copies of one world, which may differ in materials, poses and so on.

    controls: arrays (B, T, ...), or (T, ...) for all worlds, where B is the number of worlds. A key is an object, or an
    object and a quantity. Quantities of colliders and attachments: "pose" (default), position and rotation vector at
    the end of the interval (6,) [m, rad]; "velocity" (6,) [m/s, rad/s]. Of bodies: "force" (3,) [N]; "loads" (n, 3)
    [N]. Of joints with a motor: "coordinate" or "speed", one number. Of the world: "gravity" (3,) [m/s^2].

    steps: number T of intervals; needed only without controls.

    record: probes by name, as for World.recorder(). Their values at the end of each interval have the names of
    Recorder.table(), but components and nodes are axes: out["tip.position"] has the shape (B, T, 3) for a PointProbe,
    out["ball.positions"] (B, T, n, 3) for a NodesProbe, out["energy.elastic"] (B, T). Forces are those of the interval.

    threads: number of threads; 0: all cores. keep_worlds: True: the result holds the worlds at the end.

    The values have the bits of a loop that copies each world, applies the controls of an interval, and calls
    advance(dt). A world whose step is refused stops, with a warning; the others continue. Ctrl-C ends all of them.

    TypeError: an array has the wrong shape. SceneError: an object, a quantity or a value is wrong; no world has run
    then. BusyError: another thread uses one of the worlds."""
    first = worlds if isinstance(worlds, World) else _first_of(worlds)
    given = {key: _Values(first, key, values) for key, values in (controls or {}).items()}
    common = _common(given, "number of worlds", 0, None if isinstance(worlds, World) else len(worlds))
    count = 1 if common is None else common
    intervals = _common(given, "number of intervals", 1, steps)
    if intervals is None:
        raise scene_error("rollout", "steps", "None", "the number of intervals, because there are no controls")
    copies = [worlds] * count if isinstance(worlds, World) else list(worlds)
    probes = record or {}
    values = _core.rollout(
        [world._core for world in copies],
        [(control.quantity, control.handle, control.array.ravel()) for control in given.values()],
        recorded_probes(probes),
        float(dt),
        intervals,
        threads,
        keep_worlds,
    )
    result = Rollout()
    for (name, probe), (columns, series) in zip(probes.items(), values["series"], strict=True):
        result.update(_arrays_of(name, probe, columns, series.reshape((count, intervals, -1))))
    result.time = values["time"].reshape((count, intervals))
    completed, messages, distrust = zip(*values["status"], strict=True)
    result.completed = np.array(completed, dtype=np.int32)
    result.messages, result.distrust = messages, distrust
    result.worlds = tuple(World._of(core) for core in values["worlds"])
    _warn(result, intervals)
    return result


def _first_of(worlds: Sequence[World]) -> World:
    if not worlds:
        raise scene_error("rollout", "worlds", "an empty list", "at least one world")
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


class _Values:
    """The values of a control."""

    def __init__(self, world: World, key: Any, values: ArrayLike) -> None:
        named, quantity = key if isinstance(key, tuple) else (key, None)
        place = f"controls[{named!r}]"
        target = _object_named(world, place, named) if isinstance(named, str) else named
        shapes = next((_CONTROLS[kind] for kind in _CONTROLS if isinstance(target, kind)), None)
        if shapes is None:
            classes = ", ".join(kind.__name__ for kind in _CONTROLS)
            raise TypeError(f"{place}: found {named!r}, expected a name or an object of one of {classes}")
        self.quantity = next(iter(shapes)) if quantity is None else quantity
        if self.quantity not in shapes:
            expected = "one of " + ", ".join(f"'{known}'" for known in shapes)
            raise scene_error(place, "quantity", repr(quantity), expected)
        self.name = f"{place} ({self.quantity})"
        self.handle = None if isinstance(target, World) else target._handle
        nodes = target.node_count if isinstance(target, Body) else 0
        shape = tuple(nodes if length < 0 else length for length in shapes[self.quantity])
        self.array = np.ascontiguousarray(values, dtype=np.float64)
        extra = self.array.ndim - len(shape)
        if extra not in (1, 2) or self.array.shape[extra:] != shape:
            raise TypeError(
                f"{self.name}: found an array of the shape {shape_text(self.array.shape)}, expected "
                f"{shape_text(('B', 'T', *shape))} or {shape_text(('T', *shape))}"
            )
        self.lengths = (self.array.shape[0] if extra == 2 else None, self.array.shape[extra - 1])


def _arrays_of(name: str, probe: Probe, columns: list[str], series: Reals) -> dict[str, Reals]:
    """The values of a probe by quantity. Columns whose names differ only in _x, _y and _z become one array."""
    if isinstance(probe, NodesProbe):
        return {f"{name}.positions": series.reshape((*series.shape[:2], -1, 3))}
    arrays, place = {}, 0
    while place < len(columns):
        quantity = columns[place].removesuffix("_x")
        if quantity == columns[place]:
            arrays[f"{name}.{quantity}"] = series[:, :, place]
            place += 1
        else:
            arrays[f"{name}.{quantity}"] = series[:, :, place : place + 3]
            place += 3
    return arrays


def _object_named(world: World, place: str, name: str) -> Body | Collider:
    if name in world.colliders and name in world.bodies:
        raise scene_error(place, "", f"a body and a collider of the name '{name}'", "the object itself")
    return world.colliders[name] if name in world.colliders else world.bodies[name]
