"""Joints of rigid bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .._arrays import Vector, checked, real
from .._settings import JointKind, JointPassive, Motor
from .objects import NamedObject

if TYPE_CHECKING:
    from .body import Body


@dataclass(frozen=True, slots=True, kw_only=True)
class JointState:
    """Present pose and motion of a joint. Force and moment are those of the last step; they act on the first body and
    are given in world axes.

    kind: kind of the joint.
    first: the first body.
    second: the second body; None if the first body is joined to the world.
    point: point of the joint on the first body [m].
    axis: axis of the joint on the second body.
    coordinate: angle of a hinge, counting full revolutions, or displacement of a slider [rad or m].
    speed: rate of `coordinate` [rad/s or m/s].
    force: force at `point` [N].
    moment: moment [N m].
    motor: moment or force along the axis that the motor exerts [N m or N].
    passive: moment or force along the axis of spring, damper and dry friction together [N m or N].
    limit: moment or force along the axis that the limits exert [N m or N].
    mimic: moment or force along the axis that makes the joint mimic another one, which gets -ratio times as much [N m
        or N].
    error: distance between the two points that the joint should keep together [m].
    """

    kind: JointKind
    first: Body
    second: Body | None
    point: Vector
    axis: Vector
    coordinate: float
    speed: float
    force: Vector
    moment: Vector
    motor: float
    passive: float
    limit: float
    mimic: float
    error: float


class Joint(NamedObject):
    """A joint between two rigid bodies, or between a rigid body and the world. Removing a body removes its joints."""

    __slots__ = ()

    @property
    def state(self) -> JointState:
        """Present pose, motion, force and moment."""
        return JointState(**self._with_bodies(self._core.joint_state(self._handle)))

    @property
    def settings(self) -> dict[str, Any]:
        """Arguments of World.add_joint() that add an equal joint in the present poses, without the mimic."""
        return self._with_bodies(self._core.joint_settings(self._handle))

    @property
    def coordinate(self) -> float:
        """Angle of a hinge or displacement of a slider [rad or m]."""
        return self.state.coordinate

    @property
    def speed(self) -> float:
        """Rate of `coordinate` [rad/s or m/s]."""
        return self.state.speed

    @property
    def motor(self) -> Motor | None:
        """The motor; None if the joint has none."""
        motor: Motor | None = self._core.motor(self._handle)
        return motor

    @property
    def limits(self) -> tuple[float | None, float | None]:
        """Lower and upper limit of the coordinate; None: no limit [rad or m]."""
        limits: tuple[float | None, float | None] = self._core.limits(self._handle)
        return limits

    @property
    def passive(self) -> JointPassive:
        """Spring, damper and dry friction along the axis."""
        passive: JointPassive = self._core.passive(self._handle)
        return passive

    @property
    def mimic(self) -> tuple[Joint, float, float] | None:
        """The joint that this joint mimics, the ratio and the offset; None if it mimics none."""
        values: tuple[Any, float, float] | None = self._core.mimic(self._handle)
        return None if values is None else (self._world._joint(values[0]), values[1], values[2])

    def set_mimic(self, leader: Joint | None, *, ratio: float = 1.0, offset: float = 0.0) -> None:
        """Couples the joint to another hinge or slider: coordinate = ratio * leader.coordinate + offset.

        Forces on one of the joints move the other one. None ends the coupling. SceneError: a joint has no axis, the
        ratio is 0, or the leader mimics this joint."""
        other = None if leader is None else self._world._own(leader, "leader", Joint)
        self._core.set_mimic(self._handle, other, real(ratio, "ratio"), real(offset, "offset"))

    def set_motor(self, motor: Motor | None) -> None:
        """Sets the motor of a hinge or a slider; None removes it."""
        self._core.set_motor(self._handle, None if motor is None else checked(motor, "motor", Motor))

    def set_limits(self, *, lower: float | None = None, upper: float | None = None) -> None:
        """Sets the limits of the coordinate; None means no limit [rad or m]."""
        limits = (None if value is None else real(value, name) for value, name in ((lower, "lower"), (upper, "upper")))
        self._core.set_limits(self._handle, *limits)

    def set_passive(self, passive: JointPassive) -> None:
        """Sets spring, damper and dry friction of a hinge or a slider."""
        self._core.set_passive(self._handle, checked(passive, "passive", JointPassive))

    def _with_bodies(self, values: dict[str, Any]) -> dict[str, Any]:
        """Values of the extension module with bodies in place of handles."""
        for name in ("first", "second"):
            if values[name] is not None:
                values[name] = self._world._body(values[name])
        return values


def joint_label(kind: str, first: str, second: str | None) -> str:
    """Text that names a joint in messages."""
    return f"{kind} joint of body '{first}' and {'the world' if second is None else f'body {second!r}'}"
