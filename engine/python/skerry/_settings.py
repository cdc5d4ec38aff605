"""Settings as immutable records. Names and defaults are those of the C++ interface; all units are SI units.

Every record compares by value, can be hashed and pickled, and can be varied with dataclasses.replace().
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import RotationLike, Vector, VectorLike, index_array, read_only, real_array, rotation, vector

Integrator: TypeAlias = Literal["symplectic_euler", "leapfrog"]
Backend: TypeAlias = Literal["tbb", "openmp", "threads", "serial", "automatic"]
ContactRegions: TypeAlias = Literal["separate", "global"]
SolverMethod: TypeAlias = Literal["automatic", "ags", "pgs", "pcg_pgs", "newton", "pcg_fr", "pcg_pr"]
Friction: TypeAlias = Literal["cone", "pyramid"]
StartOverlaps: TypeAlias = Literal["resolve", "refuse", "ignore"]
MaterialModel: TypeAlias = Literal["linear", "corotational", "stable_neo_hookean"]
ElementKind: TypeAlias = Literal["linear", "smoothed", "edge_smoothed", "edge_node_smoothed"]
Dynamics: TypeAlias = Literal["explicit", "rigid", "implicit", "automatic"]
JointKind: TypeAlias = Literal["ball", "hinge", "slider", "fixed"]

Given = TypeVar("Given", contravariant=True)
Held = TypeVar("Held", covariant=True)


class Field(Generic[Given, Held]):
    """Tells type checkers that a field is set to one type and holds another. No object of this class is made."""

    def __get__(self, instance: object, owner: object) -> Held:
        raise NotImplementedError

    def __set__(self, instance: object, value: Given) -> None:
        raise NotImplementedError


VectorField: TypeAlias = Field[VectorLike, Vector]
RotationField: TypeAlias = Field[RotationLike, Vector]


def held(default: Any) -> Any:
    """A default value of a Field."""
    return default


def _make_vectors(record: object, *names: str) -> None:
    """Replaces array-likes in the fields of a new record by tuples of three numbers."""
    for name in names:
        object.__setattr__(record, name, vector(getattr(record, name), f"{type(record).__name__}.{name}"))


def _make_rotation(record: object) -> None:
    given = getattr(record, "rotation")
    object.__setattr__(record, "rotation", rotation(given, f"{type(record).__name__}.rotation"))


def _make_keys(record: object, kind: type) -> None:
    """Replaces the sequence in the field `keys` of a new record by a tuple of records of the given class."""
    keys: Iterable[Any] = getattr(record, "keys")
    place = f"{type(record).__name__}.keys"
    if isinstance(keys, kind):
        raise TypeError(f"{place}: found one {kind.__name__}, expected a list of them")
    object.__setattr__(record, "keys", tuple(keys))
    for number, key in enumerate(getattr(record, "keys")):
        if not isinstance(key, kind):
            raise TypeError(f"{place}[{number}]: found {key!r}, expected a {kind.__name__}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Settings of a world and its step. The defaults suit most scenes."""

    gravity: VectorField = held((0.0, 0.0, -9.81))
    """Acceleration of all bodies, shape (3,) [m/s^2]. Change it when your vertical axis is not z."""
    step_size: float | None = None
    """Upper bound of the step length [s]; None: the stable step of the stiffest body, and at most 1/120 s if the world
    has a rigid or implicit body. Change it when you need smaller errors in time, or steps of equal length."""
    theta: float = 1.0
    """Parameter of the theta method for implicit bodies, from 0.5 to 1. The value 1 is backward Euler, which damps
    vibrations. Change it when an implicit body must keep vibrating."""
    implicit_step: float = 0.0
    """Upper bound of the step length of implicit bodies [s]; 0: the step length of the other bodies. Change it when
    implicit bodies take most of the computing time beside explicit ones."""
    integrator: Integrator = "symplectic_euler"
    """Time integrator. Change it to "leapfrog" when smooth motion must be exact to second order."""
    clusters: bool = True
    """True: the few elements that would make all steps several times shorter are integrated implicitly. Change it when
    all elements of explicit bodies must be integrated explicitly."""
    backend: Backend = "automatic"
    """Thread library. Change it when your program already uses another library."""
    threads: int = 0
    """Number of threads; 0: one for each processor. Change it when other work shares the processors."""
    contact_regions: ContactRegions = "separate"
    """Division of contacts into regions. Change it to "global" when you compare solvers on one large problem."""
    method: SolverMethod = "automatic"
    """Contact solver. Change it when you compare solvers, or when contacts stay unconverged."""
    friction: Friction = "cone"
    """Friction law: Coulomb's cone, or its four-sided approximation."""
    tolerance: float = 1e-3
    """Relative error of contact impulses that the solver accepts. Change it when contact forces must be more exact, or
    when larger errors are fine and speed matters."""
    max_iterations: int = 200
    """Largest number of solver sweeps over the contacts of a region. Change it when regions stay unconverged."""
    recovery_speed: float = 0.5
    """Largest speed at which overlapping surfaces are pushed apart [m/s]. Change it when bodies are so small or so slow
    that this speed disturbs them."""
    start_overlaps: StartOverlaps = "resolve"
    """Treatment of objects that overlap when they are added. Change it when no body may be moved at the start."""
    sleep: bool = True
    """True: bodies that have been still for sleep_time fall asleep. Change it when you study very small motion."""
    sleep_time: float = 0.5
    """Time for which a body must be still before it falls asleep [s]."""
    continuous_collision: bool = True
    """True: a step in which surfaces would pass through each other is repeated. Change it when surfaces may pass
    through each other and the tests cost too much time."""

    def __post_init__(self) -> None:
        _make_vectors(self, "gravity")


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """An elastic material with its friction and its losses."""

    young_modulus: float = 1e5
    """Young's modulus, > 0 [Pa]."""
    poisson_ratio: float = 0.4
    """Poisson's ratio, > -1 and < 0.5."""
    density: float = 1000.0
    """Density, > 0 [kg/m^3]."""
    friction: float = 0.5
    """Coulomb's friction coefficient, >= 0; default of static_friction and dynamic_friction."""
    static_friction: float | None = None
    """Friction coefficient of contacts that stick, >= dynamic_friction."""
    dynamic_friction: float | None = None
    """Friction coefficient of contacts that slide, >= 0."""
    restitution: float = 0.0
    """Rebound speed over impact speed of a surface point, from 0 to 1."""
    damping: float = 0.0
    """Decay rate of velocities relative to the rigid motion of the body, >= 0 [1/s]."""
    loss_factor: float | None = None
    """Tangent of the phase angle between stress and strain, from 0 to 0.3. Rubber has 0.05 to 0.2, soft tissue 0.1 to
    0.3. None: 0.05 for explicit bodies, and no such losses for implicit ones."""
    bulk_viscosity: float = 0.06
    """Damping ratio of volume changes of an element at its highest frequency, from 0 to 1; for explicit bodies."""
    model: MaterialModel = "stable_neo_hookean"
    """Law of elasticity."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Surface:
    """Friction and restitution of one body or collider. For a body, missing values are those of its material. For a
    collider, missing values are those of the body that touches it."""

    friction: float | None = None
    """Coulomb's friction coefficient, >= 0; default of static_friction and dynamic_friction."""
    static_friction: float | None = None
    """Friction coefficient of contacts that stick, >= dynamic_friction."""
    dynamic_friction: float | None = None
    """Friction coefficient of contacts that slide, >= 0."""
    restitution: float | None = None
    """Rebound speed over impact speed, from 0 to 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plane:
    """A half-space: the side that the normal points to is free."""

    normal: VectorField = held((0.0, 0.0, 1.0))
    """Normal vector, shape (3,), of any length except zero."""
    point: VectorField = held((0.0, 0.0, 0.0))
    """A point of the plane, shape (3,) [m]."""

    def __post_init__(self) -> None:
        _make_vectors(self, "normal", "point")


@dataclass(frozen=True, slots=True, kw_only=True)
class Sphere:
    """A sphere around the origin of its frame."""

    radius: float = 1.0
    """Radius [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A box around the origin of its frame."""

    size: VectorField = held((1.0, 1.0, 1.0))
    """Edge lengths, shape (3,) [m]."""

    def __post_init__(self) -> None:
        _make_vectors(self, "size")


@dataclass(frozen=True, slots=True, kw_only=True)
class Capsule:
    """A cylinder with hemispheres at its ends. Its axis is z."""

    radius: float = 0.5
    """Radius [m]."""
    length: float = 1.0
    """Length of the straight part [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cylinder:
    """A cylinder with flat ends. Its axis is z."""

    radius: float = 0.5
    """Radius [m]."""
    height: float = 1.0
    """Height, from z = -height / 2 to height / 2 [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bucket:
    """An open cylindrical container. The inner side of its floor is at z = 0."""

    radius: float = 0.5
    """Inner radius [m]."""
    height: float = 1.0
    """Inner height [m]."""
    thickness: float = 0.05
    """Thickness of wall and floor [m]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SurfaceMesh:
    """A triangle surface. A collider with this shape is solid inside it; triangles are counter-clockwise as seen from
    outside. Its arrays are copies of those given, and cannot be changed."""

    nodes: Field[ArrayLike, NDArray[np.float64]] = held(())
    """Positions of the nodes, shape (n, 3) [m]."""
    triangles: Field[ArrayLike, NDArray[np.int32]] = held(())
    """Numbers of the nodes of each triangle, shape (k, 3)."""

    def __post_init__(self) -> None:
        nodes = real_array(self.nodes, "SurfaceMesh.nodes", ("n", 3))
        triangles = index_array(self.triangles, "SurfaceMesh.triangles", ("k", 3))
        object.__setattr__(self, "nodes", read_only(nodes.copy()))
        object.__setattr__(self, "triangles", read_only(triangles.copy()))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, SurfaceMesh):
            return NotImplemented
        return np.array_equal(self.nodes, other.nodes) and np.array_equal(self.triangles, other.triangles)

    def __hash__(self) -> int:
        return hash((self.nodes.tobytes(), self.triangles.tobytes()))

    def __reduce__(self) -> tuple[Any, ...]:
        return (_surface_mesh, (self.nodes, self.triangles))

    def __repr__(self) -> str:
        return f"<skerry.SurfaceMesh {len(self.nodes):,} nodes, {len(self.triangles):,} triangles>"


def _surface_mesh(nodes: NDArray[np.float64], triangles: NDArray[np.int32]) -> SurfaceMesh:
    return SurfaceMesh(nodes=nodes, triangles=triangles)


Shape: TypeAlias = Plane | Sphere | Box | Capsule | Cylinder | Bucket | SurfaceMesh
"""Shape of a collider."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """Position and orientation."""

    position: VectorField = held((0.0, 0.0, 0.0))
    """Position, shape (3,) [m]."""
    rotation: RotationField = held((0.0, 0.0, 0.0))
    """Rotation axis times angle, shape (3,) [rad], or an object with the method as_rotvec()."""

    def __post_init__(self) -> None:
        _make_vectors(self, "position")
        _make_rotation(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionKey:
    """One keyframe of a scripted motion. Between keyframes the position moves linearly."""

    time: float = 0.0
    """Time, which must increase from key to key [s]."""
    position: VectorField = held((0.0, 0.0, 0.0))
    """Position, shape (3,) [m]."""
    rotation: RotationField = held((0.0, 0.0, 0.0))
    """Rotation axis times angle, shape (3,) [rad], or an object with the method as_rotvec()."""

    def __post_init__(self) -> None:
        _make_vectors(self, "position")
        _make_rotation(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """A scripted motion: constant velocities from now on, or keyframes at absolute times."""

    velocity: VectorField = held((0.0, 0.0, 0.0))
    """Velocity, shape (3,) [m/s]."""
    angular_velocity: VectorField = held((0.0, 0.0, 0.0))
    """Angular velocity, shape (3,) [rad/s]."""
    keys: Field[Iterable[MotionKey], tuple[MotionKey, ...]] = held(())
    """Keyframes; both velocities must then be zero."""

    def __post_init__(self) -> None:
        _make_vectors(self, "velocity", "angular_velocity")
        _make_keys(self, MotionKey)


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorKey:
    """Target of a motor at an absolute time: a speed or a position."""

    time: float = 0.0
    """Time [s]."""
    speed: float | None = None
    """Target speed [rad/s or m/s]."""
    position: float | None = None
    """Target coordinate of the joint [rad or m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor:
    """A motor on the axis of a hinge or a slider. Give one of `speed`, `position` and `keys`."""

    speed: float | None = None
    """Target speed [rad/s or m/s]."""
    position: float | None = None
    """Target coordinate of the joint, reached within one step if possible [rad or m]."""
    strength: float = 0.0
    """Largest moment (hinge) or force (slider), >= 0 [N m or N]."""
    fastest: float = math.inf
    """Largest speed at which the motor approaches `position`, > 0 [rad/s or m/s]."""
    keys: Field[Iterable[MotorKey], tuple[MotorKey, ...]] = held(())
    """Targets at ascending times, all of them speeds or all of them positions."""

    def __post_init__(self) -> None:
        _make_keys(self, MotorKey)


@dataclass(frozen=True, slots=True, kw_only=True)
class ProblemSettings:
    """Settings of solve()."""

    method: SolverMethod = "automatic"
    """Solver method."""
    friction: Friction = "cone"
    """Friction law: Coulomb's cone, or its four-sided approximation."""
    tolerance: float = 1e-6
    """Upper bound on the relative error of the solution."""
    max_iterations: int = 100_000
    """Largest number of iterations of a region."""
    relaxation: float = 1.0
    """Relaxation factor of methods that sweep, > 0 and < 2."""


__all__ = [
    "Backend",
    "Box",
    "Bucket",
    "Capsule",
    "ContactRegions",
    "Cylinder",
    "Dynamics",
    "ElementKind",
    "Friction",
    "Integrator",
    "JointKind",
    "Material",
    "MaterialModel",
    "Motion",
    "MotionKey",
    "Motor",
    "MotorKey",
    "Plane",
    "Pose",
    "ProblemSettings",
    "Settings",
    "Shape",
    "SolverMethod",
    "Sphere",
    "StartOverlaps",
    "Surface",
    "SurfaceMesh",
]
