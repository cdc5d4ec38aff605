"""Rollouts: many worlds that follow given controls, on all cores."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import real_array
from ._errors import SceneError
from ._recorder import Probe, recorded_probes
from ._world import Attachment, Body, Collider, Joint, World

if TYPE_CHECKING:
    from ._world.objects import MovedObject


@dataclass(frozen=True, slots=True)
class PoseControl:
    """Moves a collider or an attachment, so that it reaches a pose at the end of the interval. Values: position [m] and
    rotation vector [rad], shape (..., 6)."""

    object: MovedObject
    """The collider or attachment."""


@dataclass(frozen=True, slots=True)
class VelocityControl:
    """Moves a collider or an attachment at constant velocities. Values: velocity [m/s] and angular velocity [rad/s],
    shape (..., 6)."""

    object: MovedObject
    """The collider or attachment."""


@dataclass(frozen=True, slots=True)
class MotorSpeedControl:
    """Sets the target speed of the motor of a hinge or a slider. Values: speed [rad/s or m/s], shape (...)."""

    joint: Joint
    """The joint, which must have a motor."""


@dataclass(frozen=True, slots=True)
class MotorPositionControl:
    """Sets the target coordinate of the motor of a hinge or a slider. Values: coordinate [rad or m], shape (...)."""

    joint: Joint
    """The joint, which must have a motor."""


@dataclass(frozen=True, slots=True)
class NodeForceControl:
    """Sets the external forces on all nodes of a body. Values: shape (..., n, 3) [N]."""

    body: Body
    """The body."""


@dataclass(frozen=True, slots=True)
class BodyForceControl:
    """Sets an external force at the centre of mass of a body. Values: shape (..., 3) [N]."""

    body: Body
    """The body."""


@dataclass(frozen=True, slots=True)
class GravityControl:
    """Sets the acceleration of all bodies. Values: shape (..., 3) [m/s^2]."""


Control: TypeAlias = (
    PoseControl
    | VelocityControl
    | MotorSpeedControl
    | MotorPositionControl
    | NodeForceControl
    | BodyForceControl
    | GravityControl
)
"""A quantity that a rollout sets at the start of each interval."""

Key = TypeVar("Key", bound=Control | str)


class RolloutResult(dict[str, NDArray[Any]]):
    """Arrays of a rollout by name, see rollout()."""

    worlds: list[World]
    """Worlds at the end, if keep_worlds was set."""


def rollout(
    worlds: World | Sequence[World],
    controls: Mapping[Key, ArrayLike],
    *,
    dt: float,
    steps: int | None = None,
    count: int | None = None,
    record: Mapping[str, Probe] | None = None,
    threads: int = 0,
    keep_worlds: bool = False,
    progress: bool = False,
) -> RolloutResult:
    """Advances copies of worlds through T intervals of `dt` [s], several worlds at once. The worlds do not change.

        out = skerry.rollout(world, {"finger": poses}, dt=0.01, record={"tip": ball.probe((0, 0, 0.1))})
        out["tip.position"]  # shape (B, T, 3)

    worlds: one world, or B copies of one world, which may have other materials, poses and so on. controls: values of
    each control, shape (B, T, ...) or (T, ...) for all worlds; the name of a collider stands for its PoseControl.
    steps, count: T and B, needed if no array tells them. record: probes by name, whose values are taken at the end of
    each interval. threads: number of threads, 0: the number of cores. keep_worlds: True: `worlds` of the result holds
    the worlds at the end. progress: writes the number of worlds that are done to the standard error output.

    The result has:
    - "PROBE.QUANTITY": shape (B, T), (B, T, 3) for vectors, (B, T, n, 3) for all nodes of a body
    - "time": at the end of each interval, shape (B, T) [s]
    - "ok": True for a world that took all steps, shape (B,); "message": why a world stopped; "distrust": why its values
      cannot be trusted. Values are NaN in intervals that were not completed.

    The values are those of a loop over the worlds, bit by bit, on any number of threads. The GIL is released; Ctrl-C
    ends the rollout. SceneError: a setting or a control is wrong. TypeError: an array has the wrong shape."""
    given = [worlds] if isinstance(worlds, World) else list(worlds)
    if not given:
        raise SceneError("rollout: worlds: found none, expected at least one", object="rollout", field="worlds")
    named = {_control_of(given[0], key): values for key, values in controls.items()}
    arrays = {control: np.asarray(values, dtype=np.float64) for control, values in named.items()}
    many = len(given) if len(given) > 1 or not isinstance(worlds, World) else count
    size, length = _lengths(arrays, many, steps)
    core_controls = [_core_control(control, values, size, length) for control, values in arrays.items()]
    found = _core.rollout(
        [world._core for world in given],
        size,
        length,
        dt,
        core_controls,
        recorded_probes(record or {}),
        threads,
        keep_worlds,
        _show if progress else None,
    )
    result = RolloutResult(time=found["time"].reshape(size, length))
    for series in found["series"]:
        result.update(_grouped(series["name"], series["columns"], series["values"].reshape(size, length, -1)))
    result["message"] = np.array(found["message"], dtype=np.str_)
    result["ok"] = result["message"] == ""
    result["distrust"] = np.array(found["distrust"], dtype=np.str_)
    result.worlds = [World._of(world) for world in found["worlds"]]
    return result


def _control_of(world: World, key: Control | str | Collider | Attachment) -> Control:
    if isinstance(key, str):
        return PoseControl(world.colliders[key])
    if isinstance(key, (Collider, Attachment)):
        return PoseControl(key)
    if not isinstance(key, Control):
        raise TypeError(f"controls: found {key!r}, expected the name of a collider, or a control such as PoseControl")
    return key


def _tail(control: Control) -> tuple[int, ...]:
    """Shape of the values of one world in one interval."""
    match control:
        case PoseControl() | VelocityControl():
            return (6,)
        case MotorSpeedControl() | MotorPositionControl():
            return ()
        case NodeForceControl():
            return (control.body.node_count, 3)
    return (3,)


def _lengths(arrays: Mapping[Control, NDArray[np.float64]], count: int | None, steps: int | None) -> tuple[int, int]:
    """Numbers of worlds and of intervals."""
    for control, values in arrays.items():
        leading = values.shape[: values.ndim - len(_tail(control))]
        if len(leading) == 2 and count is None:
            count = leading[0]
        if len(leading) in (1, 2) and steps is None:
            steps = leading[-1]
    if steps is None:
        raise TypeError("steps: found neither a number nor an array of controls, expected one of them")
    return 1 if count is None else count, steps


def _core_control(control: Control, values: NDArray[np.float64], count: int, steps: int) -> Any:
    tail = _tail(control)
    leading = (steps,) if values.ndim == len(tail) + 1 else (count, steps)
    array = real_array(values, f"controls: {control!r}", (*leading, *tail))
    match control:
        case PoseControl():
            return _core.pose_control(control.object._handle, array)
        case VelocityControl():
            return _core.velocity_control(control.object._handle, array)
        case MotorSpeedControl():
            return _core.motor_speed_control(control.joint._handle, array)
        case MotorPositionControl():
            return _core.motor_position_control(control.joint._handle, array)
        case NodeForceControl():
            return _core.node_force_control(control.body._handle, array)
        case BodyForceControl():
            return _core.body_force_control(control.body._handle, array)
    return _core.gravity_control(array)


def _grouped(name: str, columns: list[str], values: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Columns of a probe, where the components _x, _y and _z become one array, and so do the nodes of a body."""
    groups: dict[str, list[int]] = {}
    for number, column in enumerate(columns):
        parts = column.split("_")
        if parts[-1].isdigit():
            quantity = "_".join(parts[:-2])
        else:
            quantity = "_".join(parts[:-1]) if parts[-1] in ("x", "y", "z") else column
        groups.setdefault(quantity, []).append(number)
    arrays = {}
    for quantity, numbers in groups.items():
        array = values[:, :, numbers]
        if columns[numbers[0]] == quantity:
            array = array[:, :, 0]
        elif columns[numbers[0]].split("_")[-1].isdigit():
            array = array.reshape(*array.shape[:2], -1, 3)
        arrays[f"{name}.{quantity}"] = np.ascontiguousarray(array)
    return arrays


def _show(done: int, worlds: int) -> None:
    print(f"\r{done:,} of {worlds:,} worlds", end="", file=sys.stderr, flush=True)
