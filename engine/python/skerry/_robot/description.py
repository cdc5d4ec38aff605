"""The description of a robot: rigid links and joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._arrays import real
from .._errors import scene_error
from .._settings import JointKind, JointPassive, Motor, SurfaceMesh

Reals: TypeAlias = NDArray[np.float64]
Drive: TypeAlias = Literal["position", "speed", "force"]


@dataclass(frozen=True, slots=True)
class Frame:
    """A coordinate frame: the point `x` in the frame is `rotation @ x + position` in outer coordinates."""

    position: Reals = field(default_factory=lambda: np.zeros(3))
    rotation: Reals = field(default_factory=lambda: np.eye(3))

    def __matmul__(self, other: Frame) -> Frame:
        return Frame(self.rotation @ other.position + self.position, self.rotation @ other.rotation)

    def points(self, points: Reals) -> Reals:
        """Converts points of the frame, shape (n, 3), to coordinates outside of the frame."""
        result: Reals = points @ self.rotation.T + self.position
        return result

    @property
    def rotation_vector(self) -> Reals:
        """Axis times angle [rad]."""
        # With the unit quaternion q = (x, y, z, w) of the rotation, `product` is 4 q q^T. Its rows are multiples of q;
        # the longest row has the smallest relative rounding error.
        matrix = self.rotation
        sums = matrix + matrix.T - np.trace(matrix) * np.eye(3)
        turns = np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]])
        product = np.zeros((4, 4))
        product[:3, :3] = sums + np.eye(3)
        product[:3, 3] = product[3, :3] = turns
        product[3, 3] = 1 + np.trace(matrix)
        row = product[np.argmax(np.diag(product))]
        quaternion = row / np.linalg.norm(row) * (1 if row[3] >= 0 else -1)
        sine = np.linalg.norm(quaternion[:3])
        if sine == 0:
            return np.zeros(3)
        vector: Reals = 2 * np.arctan2(sine, quaternion[3]) / sine * quaternion[:3]
        return vector


def turn(vector: ArrayLike) -> Reals:
    """The rotation matrix of a rotation vector, by the formula of Rodrigues."""
    x, y, z = vector = np.asarray(vector, float)
    angle = np.linalg.norm(vector)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    # R = I + sin(a) / a K + (1 - cos(a)) / a^2 K^2 with the angle a and K = `cross`; numpy.sinc(x) = sin(pi x) / (pi x)
    result: Reals = np.eye(3) + np.sinc(angle / np.pi) * cross + np.sinc(angle / 2 / np.pi) ** 2 / 2 * (cross @ cross)
    return result


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RobotLink:
    """A rigid body: links of the file that no joint lets move relative to each other. Vectors are in the frame of the
    first link.

    name: name of the first link.
    members: names of all links.
    parent: name of the link at the other end of its joint; None: the world.
    place: frame relative to the parent (to the robot if the parent is None), while the joint has the coordinate
        `RobotJoint.rest`.
    moves: False if the file fixes the link to the world.
    mass: mass [kg].
    center_of_mass: centre of mass [m].
    inertia: inertia tensor about the centre of mass [kg m^2].
    surface: closed shells of its collision shapes; None if it has none.
    """

    name: str
    members: tuple[str, ...]
    parent: str | None
    place: Frame
    moves: bool
    mass: float
    center_of_mass: Reals
    inertia: Reals
    surface: SurfaceMesh | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RobotJoint:
    """A joint between a link and its parent. Point and axis are in the frame of the link.

    name: name of the joint.
    kind: "hinge", "slider" or "ball".
    link: name of the link.
    point: point on the axis, or centre of a ball joint [m].
    axis: unit vector of the axis.
    rest: coordinate at which the link has the pose `RobotLink.place` [rad or m].
    lower: lower limit of the coordinate; None: no limit [rad or m].
    upper: upper limit [rad or m].
    passive: spring, damper and dry friction.
    drive: quantity that a motor prescribes: "position", "speed" or "force"; None: no motor.
    strength: largest moment or force of the motor [N m or N].
    fastest: largest speed of the motor [rad/s or m/s].
    mimic: tuple (name of another joint, ratio, offset) for coordinate = ratio * other coordinate + offset, or None.
    """

    name: str
    kind: JointKind
    link: str
    point: Reals
    axis: Reals
    rest: float = 0.0
    lower: float | None = None
    upper: float | None = None
    passive: JointPassive = JointPassive()
    drive: Drive | None = None
    strength: float = 0.0
    fastest: float = np.inf
    mimic: tuple[str, float, float] | None = None

    @property
    def has_coordinate(self) -> bool:
        """True for hinges and sliders."""
        return self.kind != "ball"

    def motion(self, coordinate: float) -> Frame:
        """Motion of the link from its pose at the coordinate `rest` to its pose at `coordinate` [rad or m]."""
        if self.kind == "slider":
            return Frame((coordinate - self.rest) * self.axis)
        rotation = turn((coordinate - self.rest) * self.axis if self.kind == "hinge" else np.zeros(3))
        return Frame(self.point - rotation @ self.point, rotation)

    def motor(self, target: float) -> Motor:
        """The motor that drives the joint to a target: a coordinate [rad or m], a speed [rad/s or m/s], or with the
        drive "force" a moment or force [N m or N]."""
        if self.drive == "force":
            # A motor that cannot reach its target speed exerts its whole strength.
            unreachable = 1e9
            return Motor(speed=float(np.copysign(unreachable, target)), strength=min(abs(target), self.strength))
        if self.drive == "speed":
            return Motor(speed=target, strength=self.strength)
        return Motor(position=target, strength=self.strength, fastest=self.fastest)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Robot:
    """A robot that load_robot() has read from a file.

    name: name of the robot.
    links: the links by name, parents first.
    joints: the joints by name, in the order of the links.
    apart: pairs of names of links that do not collide, in addition to links that a joint connects.
    warnings: parts of the file that are not simulated, each with its element and name.
    """

    name: str
    links: Mapping[str, RobotLink]
    joints: Mapping[str, RobotJoint]
    apart: tuple[tuple[str, str], ...]
    warnings: tuple[str, ...]

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """Names of the hinges and sliders."""
        return tuple(name for name, joint in self.joints.items() if joint.has_coordinate)

    @property
    def motor_names(self) -> tuple[str, ...]:
        """Names of the joints with a motor."""
        return tuple(name for name, joint in self.joints.items() if joint.drive is not None)

    def complete(self, coordinates: Mapping[str, float] | None) -> dict[str, float]:
        """Coordinates of all hinges and sliders, from given coordinates of some of them [rad or m]. Without a given
        coordinate a joint has the value within its limits that is nearest to `rest`. A joint that mimics another one
        follows it and must not be given."""
        found: dict[str, float] = {}
        for name, value in (coordinates or {}).items():
            if name not in self.coordinate_names:
                expected = f"one of {', '.join(self.coordinate_names)}"
                raise scene_error(f"robot '{self.name}'", "coordinates", repr(name), expected)
            if (leader := self.joints[name].mimic) is not None:
                expected = f"the coordinate of '{leader[0]}', which '{name}' mimics"
                raise scene_error(f"robot '{self.name}'", "coordinates", repr(name), expected)
            found[name] = real(value, f"coordinates[{name!r}]")
        for name in self.coordinate_names:
            joint = self.joints[name]
            if joint.mimic is None:
                low = -np.inf if joint.lower is None else joint.lower
                high = np.inf if joint.upper is None else joint.upper
                found.setdefault(name, float(np.clip(joint.rest, low, high)))
        waiting = [name for name in self.coordinate_names if name not in found]
        while waiting:
            for name in waiting:
                other, ratio, offset = self.joints[name].mimic or ("", 0.0, 0.0)
                if other in found:
                    found[name] = ratio * found[other] + offset
            known = [name for name in waiting if name in found]
            if not known:
                raise scene_error(
                    f"robot '{self.name}'", "mimic", f"a cycle of mimics with '{waiting[0]}'", "joints without cycles"
                )
            waiting = [name for name in waiting if name not in found]
        return found

    def frames(self, coordinates: Mapping[str, float] | None = None) -> dict[str, Frame]:
        """Frames of all links relative to the robot at the given coordinates, see add_robot()."""
        values = self.complete(coordinates)
        frames: dict[str, Frame] = {}
        for link, joint in self.with_joints():
            frame = link.place if link.parent is None else frames[link.parent] @ link.place
            frames[link.name] = frame if joint is None else frame @ joint.motion(values.get(joint.name, 0.0))
        return frames

    def with_joints(self) -> Iterator[tuple[RobotLink, RobotJoint | None]]:
        """All links, each with the joint to its parent, or None if it has no joint."""
        of_link = {joint.link: joint for joint in self.joints.values()}
        return ((link, of_link.get(link.name)) for link in self.links.values())


def mass_of(parts: list[tuple[float, Reals, Reals]]) -> tuple[float, Reals, Reals]:
    """Mass [kg], centre of mass [m], and inertia about this centre [kg m^2] of a body made of parts. parts: these three
    values of each part."""
    mass = sum(part[0] for part in parts)
    center = sum((part[0] * part[1] for part in parts), np.zeros(3)) / (mass if mass > 0 else 1)
    inertia = np.zeros((3, 3))
    for of_part, place, about in parts:
        arm = place - center
        inertia += about + of_part * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return mass, center, inertia
