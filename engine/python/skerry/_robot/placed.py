"""Robots in a world."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike

from .._arrays import real_array
from .._errors import scene_error
from .._settings import Material, Motor, MotorKey
from .description import Reals, Robot
from .plan import RobotPlan

if TYPE_CHECKING:
    from .._world import Body, Joint, MaterialHandle, World


class PlacedRobot:
    """A robot of a world, see World.add_robot(). Arrays of coordinates are in the order of `coordinate_names`, targets
    in that of `motor_names`.

    robot: the description.
    links: bodies by name of the link. Links that move together have the same body. A link that neither moves nor
        collides has none.
    joints: joints by name.
    """

    def __init__(self, robot: Robot, links: Mapping[str, Body], joints: Mapping[str, Joint]) -> None:
        self.robot = robot
        self.links = MappingProxyType(dict(links))
        self.joints = MappingProxyType(dict(joints))
        self.coordinate_names = robot.coordinate_names
        self.motor_names = robot.motor_names

    def in_copy(self, world: World) -> Self:
        """Returns this robot in a copy of its world."""
        return type(self)(
            self.robot,
            {name: body.in_copy(world) for name, body in self.links.items()},
            {name: joint.in_copy(world) for name, joint in self.joints.items()},
        )

    def _states(self, quantity: str) -> Reals:
        return np.array([getattr(self.joints[name].state, quantity) for name in self.coordinate_names])

    @property
    def positions(self) -> Reals:
        """Coordinates of the joints, shape (n,) [rad or m]."""
        return self._states("coordinate")

    @property
    def velocities(self) -> Reals:
        """Rates of the coordinates, shape (n,) [rad/s or m/s]."""
        return self._states("speed")

    @property
    def forces(self) -> Reals:
        """Moments or forces of the motors in the last step, shape (n,) [N m or N]."""
        return self._states("motor")

    def set_targets(self, targets: ArrayLike) -> None:
        """Sets the targets of all motors, shape (m,): a coordinate, a speed or a force, depending on
        `RobotJoint.drive`."""
        values = real_array(targets, "targets", (len(self.motor_names),))
        motors = [
            self.robot.joints[name].motor(float(value)) for name, value in zip(self.motor_names, values, strict=True)
        ]
        for name, motor in zip(self.motor_names, motors, strict=True):
            self.joints[name].set_motor(motor)

    def follow(self, times: ArrayLike, targets: ArrayLike) -> None:
        """Moves the motors along a table. times: shape (k,), ascending [s]. targets: shape (k, m); between two times
        they change linearly. Motors with the drive "force" are refused."""
        at = real_array(times, "times", ("k",))
        values = real_array(targets, "targets", (len(at), len(self.motor_names)))
        motors = []
        for name, column in zip(self.motor_names, values.T, strict=True):
            joint = self.robot.joints[name]
            if joint.drive == "force":
                raise scene_error(f"joint '{name}'", "drive", "force", "position or speed")
            keys = [
                MotorKey(**{"time": float(t), str(joint.drive): float(value)})
                for t, value in zip(at, column, strict=True)
            ]
            motors.append(Motor(keys=keys, strength=joint.strength, fastest=joint.fastest))
        for name, motor in zip(self.motor_names, motors, strict=True):
            self.joints[name].set_motor(motor)


def add_robot(
    world: World,
    robot: Robot,
    plan: RobotPlan,
    *,
    material: Material | MaterialHandle,
    self_collision: bool,
    name: str,
) -> PlacedRobot:
    """Adds the planned bodies and joints of a robot to a world, all or none. Their names start with `name`."""
    bodies: dict[str, Body] = {}
    joints: dict[str, Joint] = {}
    try:
        for of in plan.bodies:
            groups: dict[str, Any] = {} if of.collides else {"collision_group": 0, "collision_mask": 0}
            body = bodies[of.link.name] = world.add_body(
                of.surface,
                material,
                position=of.frame.position,
                rotation=of.frame.rotation_vector,
                dynamics="rigid",
                name=f"{name}/{of.link.name}",
                **of.mass_properties,
                **groups,
            )
            if of.held:
                body.attach(np.arange(body.node_count))
        for joint in plan.joints:
            joints[joint.joint.name] = world.add_joint(
                joint.joint.kind,
                bodies[joint.joint.link],
                None if joint.second is None else bodies[joint.second],
                point=joint.point,
                axis=joint.axis,
                coordinate=joint.coordinate,
                lower=joint.joint.lower,
                upper=joint.joint.upper,
                motor=joint.motor,
                passive=joint.joint.passive,
            )
            joints[joint.joint.name].name = f"{name}/{joint.joint.name}"
        for joint in plan.joints:
            if joint.joint.mimic is not None:
                leader, ratio, offset = joint.joint.mimic
                joints[joint.joint.name].set_mimic(joints[leader], ratio=ratio, offset=offset)
        for first, second in plan.pairs_apart(robot, self_collision=self_collision):
            world.set_collision(bodies[first], bodies[second], False)
    except BaseException:
        for body in bodies.values():
            world.remove(body)
        raise
    of_member = {
        member: bodies[link.name] for link in robot.links.values() if link.name in bodies for member in link.members
    }
    return PlacedRobot(robot, of_member, joints)
