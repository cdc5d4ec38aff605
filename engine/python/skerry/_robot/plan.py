"""The bodies and joints by which a world or a scene represents a robot."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._settings import Motor, SurfaceMesh
from .description import Frame, Reals, Robot, RobotJoint, RobotLink
from .shapes import box_surface, shells


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlannedBody:
    """The rigid body that represents a link.

    link: description of the link.
    surface: its surface, in the frame of the link. A link without collision shapes gets a cube that does not collide.
    frame: frame of the link in the world.
    held: True if the body does not move.
    """

    link: RobotLink
    surface: SurfaceMesh
    frame: Frame
    held: bool

    @property
    def collides(self) -> bool:
        """True if the link has collision shapes."""
        return self.link.surface is not None

    @property
    def mass_properties(self) -> dict[str, Any]:
        """Mass and inertia for World.add_body(). A held body without mass gets the density of its material instead."""
        if self.link.mass == 0 and self.held:
            return {}
        link = self.link
        return {"mass": link.mass, "center_of_mass": link.center_of_mass, "inertia": link.inertia}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlannedJoint:
    """A joint between the body of the link `joint.link` and a second body or the world.

    joint: description of the joint.
    second: name of the link of the second body; None: the world.
    point: position in the world [m].
    axis: direction in the world.
    coordinate: coordinate at the start [rad or m].
    motor: motor with the target `coordinate`, or with the target speed or force 0; None: no motor.
    """

    joint: RobotJoint
    second: str | None
    point: Reals
    axis: Reals
    coordinate: float
    motor: Motor | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RobotPlan:
    """Bodies and joints, in the order of the links."""

    bodies: list[PlannedBody]
    joints: list[PlannedJoint]

    def pairs_apart(self, robot: Robot, *, self_collision: bool) -> list[tuple[str, str]]:
        """Pairs of names of links whose bodies do not collide with each other, see World.add_robot()."""
        names = [of.link.name for of in self.bodies]
        pairs = robot.apart if self_collision else itertools.combinations(names, 2)
        return [(first, second) for first, second in pairs if first in names and second in names and first != second]


def plan_robot(
    robot: Robot, place: Frame, coordinates: Mapping[str, float] | None, *, fixed: bool | None, motors: bool
) -> RobotPlan:
    """Plans a robot, see World.add_robot()."""
    values = robot.complete(coordinates)
    frames = {name: place @ frame for name, frame in robot.frames(coordinates).items()}
    plan = RobotPlan(bodies=[], joints=[])
    with_body = set()
    for link, joint in robot.with_joints():
        frame = frames[link.name]
        is_base = link.parent is None and joint is None
        held = is_base and (not link.moves if fixed is None else fixed)
        if held and link.surface is None:
            continue  # no body is needed: joints of its children connect them to the world
        with_body.add(link.name)
        plan.bodies.append(PlannedBody(link=link, surface=link.surface or _cube(link), frame=frame, held=held))
        if joint is None:
            continue
        value = values.get(joint.name, 0.0)
        # Motors with the drive "speed" or "force" start with the target 0.
        target = value if joint.drive == "position" else 0.0
        plan.joints.append(
            PlannedJoint(
                joint=joint,
                second=link.parent if link.parent in with_body else None,
                point=frame.points(joint.point[None])[0],
                axis=frame.rotation @ joint.axis,
                coordinate=value,
                motor=joint.motor(target) if motors and joint.drive is not None else None,
            )
        )
    return plan


def _cube(link: RobotLink) -> SurfaceMesh:
    """A cube at the centre of mass with the mean moment of inertia of the link: trace / 3 = m edge^2 / 6."""
    edge = np.sqrt(2 * np.trace(link.inertia) / link.mass) if link.mass > 0 else 0.01  # edge without mass [m]
    cube = shells([(box_surface(np.full(3, edge / 2)), Frame(link.center_of_mass))])
    assert cube is not None
    return cube
