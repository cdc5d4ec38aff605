"""Rollouts: many copies of a world that follow given controls, on all cores."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import checked, counted, flag, real, real_array, shape_text
from ._errors import Doubt, scene_error
from ._world import Attachment, Body, Cable, Cavity, Collider, FibreFamily, Joint, Load, Pipe, Spring, World
from ._world.probes import NodesProbe, Probe, recorded_probes

Reals: TypeAlias = NDArray[np.float64]

_CONTROLS: dict[type, dict[str, tuple[int, ...]]] = {
    Collider: {"pose": (6,), "velocity": (6,)},
    Attachment: {"pose": (6,), "velocity": (6,)},
    Body: {"force": (3,), "loads": (-1, 3)},
    Joint: {"coordinate": (), "speed": ()},
    World: {"gravity": (3,)},
    **{kind: {"value": ()} for kind in (Cable, Cavity, Pipe, Spring, Load, FibreFamily)},
}
"""Quantities that a rollout can control, by the class of the object, with the shape of one value; -1 means the number
of nodes. The first quantity is the default."""


class RolloutResult(dict[str, NDArray[Any]]):
    """Arrays of a rollout by name, see rollout()."""

    worlds: tuple[World, ...]
    """The worlds at the end, if keep_worlds was set."""

    def __repr__(self) -> str:
        count, steps = self["time"].shape
        arrays = ", ".join(f"{name!r} {shape_text(values.shape)}" for name, values in self.items())
        return f"<skerry.RolloutResult of {count:,} worlds and {steps:,} intervals: {arrays}>"


def rollout(
    worlds: World | Sequence[World],
    controls: Mapping[Any, ArrayLike] | None = None,
    *,
    dt: float,
    steps: int | None = None,
    record: Mapping[str, Probe] | None = None,
    threads: int = 0,
    keep_worlds: bool = False,
    progress: bool = False,
) -> RolloutResult:
    """Advances copies of a world through T intervals of dt [s], several copies at once. The given worlds do not change.

        poses = np.zeros((64, 100, 6))  # 64 worlds, 100 intervals
        out = skerry.rollout(world, {finger: poses}, dt=0.01, record={"tip": ball.probe((0, 0, 0.1))})
        out["tip.position"]  # shape (64, 100, 3)

    worlds: one world, or a list of copies of one world, which may differ in materials, poses and so on.

    controls: arrays (B, T, ...), or (T, ...) for all worlds, where B is the number of worlds. A key is an object, the
    name of a collider or a body, or a pair of an object and a quantity:
    - colliders and attachments: "pose" (default), position and rotation vector at the end of the interval (6,)
      [m, rad]; "velocity" (6,) [m/s, rad/s]
    - bodies: "force" (default), a force at the centre of mass (3,) [N], which set_loads() distributes over the nodes in
      proportion to their masses; "loads", the forces of set_loads() (n, 3) [N]
    - joints with a motor: "coordinate" (default) or "speed", one number
    - the world: "gravity" (3,) [m/s^2]
    - cables: the "value" of tension [N], length [m] or rate [m/s], whichever is prescribed; cavities: pressure [Pa],
      inflow [kg/s] or liquid volume [m^3]; pipes: pressure of the reservoir [Pa]; springs: rest length [m]; loads:
      scale; fibres: active tension [Pa]

    steps: number T of intervals; needed only without controls.

    record: probes by name, as for World.recorder(). Their values are those at the end of each interval; mean forces are
    those of the interval.

    threads: number of threads; 0: all cores.
    keep_worlds: True: `worlds` of the result holds the worlds at the end.
    progress: writes the share that is done to the standard error output.

    The result has:
    - "PROBE.QUANTITY", as in Recorder.table(): shape (B, T), (B, T, 3) for vectors, (B, T, n, 3) for the "position" of
      all nodes of a body
    - "time" at the end of each interval, shape (B, T) [s]
    - "ok", shape (B,): False for a world whose step was refused. It stops, and its further values are NaN; the other
      worlds continue. "message": why it stopped. "distrust": why its values cannot be trusted. Both become warnings.

    The values have the bits of a loop that copies each world, applies the controls of an interval, and calls
    advance(dt), for any number of threads. Ctrl-C ends the rollout.

    TypeError: an array has the wrong shape.
    SceneError: an object, a quantity or a value is wrong; no world has run then.
    BusyError: another thread uses one of the worlds."""
    copies = [worlds] if isinstance(worlds, World) else list(checked(worlds, "rollout: worlds", World, Iterable))
    if not copies:
        raise scene_error("rollout", "worlds", "an empty list", "at least one world")
    for world in copies:
        checked(world, "rollout: worlds", World)
    wanted = checked({} if controls is None else controls, "rollout: controls", Mapping)
    given = [_Values(copies, key, values) for key, values in wanted.items()]
    count = _common(given, "number of worlds", 0, None if isinstance(worlds, World) else len(copies))
    intervals = _common(given, "number of intervals", 1, None if steps is None else counted(steps, "rollout: steps"))
    if intervals is None or intervals < 1:
        expected = "a number of intervals >= 1, or a control array that defines it"
        raise scene_error("rollout", "steps", str(intervals), expected)
    if isinstance(worlds, World):
        copies *= 1 if count is None else count
    probes = record or {}
    values = _core.rollout(
        [world._core for world in copies],
        [(control.quantity, control.handle, control.array.ravel()) for control in given],
        recorded_probes(probes),
        real(dt, "dt"),
        intervals,
        counted(threads, "rollout: threads"),
        flag(keep_worlds, "rollout: keep_worlds"),
        _show if progress else None,
    )
    if progress:
        print("\r100 %", file=sys.stderr)
    shape = (len(copies), intervals)
    result = RolloutResult(time=values["time"].reshape(shape))
    for (name, probe), (columns, series) in zip(probes.items(), values["series"], strict=True):
        result.update(_arrays_of(name, probe, columns, series.reshape((*shape, -1))))
    messages, distrust = zip(*values["status"], strict=True)
    result["message"], result["distrust"] = np.array(messages, dtype=np.str_), np.array(distrust, dtype=np.str_)
    result["ok"] = result["message"] == ""
    result.worlds = tuple(World._of(core) for core in values["worlds"])
    warn_of("rollout", "world", "stopped", messages)
    warn_of("rollout", "world", "cannot be trusted", distrust)
    return result


def warn_of(call: str, kind: str, state: str, reasons: Sequence[str]) -> None:
    """Warns of the worlds or cases that have a reason."""
    found = [number for number, reason in enumerate(reasons) if reason]
    if found:
        text = f"{call}: {len(found)} of {len(reasons)} {kind}s {state}; {kind} {found[0]}: {reasons[found[0]]}"
        warnings.warn(text, Doubt, stacklevel=3)


def _show(done: int, total: int) -> None:
    print(f"\r{100 * done / total:.0f} %", end="", file=sys.stderr, flush=True)


def _common(controls: Sequence[_Values], what: str, place: int, given: int | None) -> int | None:
    """Number of worlds or intervals on which all controls agree."""
    common = given
    for control in controls:
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

    def __init__(self, worlds: Sequence[World], key: Any, values: ArrayLike) -> None:
        named, quantity = key if isinstance(key, tuple) and len(key) == 2 else (key, None)
        target = _object_named(worlds[0], named) if isinstance(named, str) else named
        shapes = next((_CONTROLS[kind] for kind in _CONTROLS if isinstance(target, kind)), None)
        if shapes is None:
            classes = ", ".join(kind.__name__ for kind in _CONTROLS)
            raise TypeError(f"controls: found {named!r}, expected a name or an object of one of {classes}")
        label = "world" if isinstance(target, World) else target._label
        if isinstance(target, World) and all(target is not world for world in worlds):
            raise scene_error("controls", "gravity", "another world", "one of the given worlds")
        self.quantity = next(iter(shapes)) if quantity is None else quantity
        if self.quantity not in shapes:
            expected = "one of " + ", ".join(f"'{known}'" for known in shapes)
            raise scene_error(f"controls: {label}", "quantity", repr(quantity), expected)
        self.name = f"controls: {self.quantity} of {label}"
        self.handle = None if isinstance(target, World) else target._handle
        nodes = target.node_count if isinstance(target, Body) else 0
        shape = tuple(nodes if length < 0 else length for length in shapes[self.quantity])
        leading = ("B", "T") if _depth(values) == len(shape) + 2 else ("T",)
        self.array = real_array(values, self.name, (*leading, *shape))
        self.lengths = (self.array.shape[0] if len(leading) == 2 else None, self.array.shape[len(leading) - 1])


def _depth(values: ArrayLike) -> int:
    """Number of dimensions of an array; 0 for rows of different lengths."""
    try:
        return np.ndim(values)
    except ValueError:
        return 0


def _arrays_of(name: str, probe: Probe, columns: list[str], series: Reals) -> dict[str, Reals]:
    """The values of a probe by quantity. Columns whose names differ only in _x, _y and _z become one array."""
    if isinstance(probe, NodesProbe):
        return {f"{name}.position": series.reshape((*series.shape[:2], -1, 3))}
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


def _object_named(world: World, name: str) -> Body | Collider:
    """The collider or the body of this name."""
    found = [objects[name] for objects in (world.colliders, world.bodies) if name in objects]
    if len(found) == 1:
        return found[0]
    if found:
        raise scene_error(
            "controls", "", f"a body and a collider of the name '{name}'", "the object itself instead of the name"
        )
    names = ", ".join(f"'{known}'" for known in [*world.colliders, *world.bodies])
    raise KeyError(f"controls: no collider or body has the name '{name}'; the names are {names}")
