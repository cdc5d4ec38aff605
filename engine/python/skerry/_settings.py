"""Settings as immutable records. Names and defaults are those of the C++ interface; all units are SI units.

Every record compares by value, can be hashed and pickled, and can be varied with dataclasses.replace().
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import (
    TimeTable,
    TimeTableLike,
    index_array,
    read_only,
    real_array,
    time_table,
)
from ._errors import scene_error
from ._fields import Field, RotationField, VectorField, held, make_keys, make_rotation, make_vectors

Integrator: TypeAlias = Literal["symplectic_euler", "leapfrog"]
Backend: TypeAlias = Literal["tbb", "openmp", "threads", "serial", "automatic"]
ContactRegions: TypeAlias = Literal["separate", "global"]
SolverMethod: TypeAlias = Literal["automatic", "ags", "pgs", "pcg_pgs", "newton", "pcg_fr", "pcg_pr"]
Friction: TypeAlias = Literal["cone", "pyramid"]
StartOverlaps: TypeAlias = Literal["resolve", "refuse", "ignore"]
MaterialModel: TypeAlias = Literal["linear", "corotational", "stable_neo_hookean", "ogden", "orthotropic", "hencky"]
ElementKind: TypeAlias = Literal["linear", "smoothed", "edge_smoothed", "edge_node_smoothed"]
FilmColor: TypeAlias = Literal["none", "stress", "speed", "contact"]
Dynamics: TypeAlias = Literal["explicit", "rigid", "implicit", "automatic"]
JointKind: TypeAlias = Literal["ball", "hinge", "slider", "fixed"]
TieKind: TypeAlias = Literal["weld", "slide", "ball"]
CavityLaw: TypeAlias = Literal["pressure", "gas", "liquid"]
SpringSide: TypeAlias = Literal["both", "tension", "compression"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Settings of a world and its step. The defaults suit most scenes.

    gravity: acceleration of all bodies, shape (3,) [m/s^2]. Change it when your vertical axis is not z.
    step_size: upper bound of the step length [s]; None: the stable step of the stiffest body, and at most 1/120 s if
        the world has a rigid or implicit body. Change it when you need smaller errors in time, or steps of equal
        length.
    theta: parameter of the theta method for implicit bodies, from 0.5 to 1. The value 1 is backward Euler, which damps
        vibrations. Change it when an implicit body must keep vibrating.
    implicit_step: upper bound of the step length of implicit bodies [s]; 0: the step length of the other bodies. Change
        it when implicit bodies take most of the computing time beside explicit ones.
    integrator: time integrator. Change it to "leapfrog" when smooth motion must be exact to second order.
    clusters: True: the few elements that would make all steps several times shorter are integrated implicitly. Change
        it when all elements of explicit bodies must be integrated explicitly.
    backend: thread library. Change it when your program already uses another library.
    threads: number of threads; 0: one for each processor. Change it when other work shares the processors.
    contact_regions: division of contacts into regions. Change it to "global" when you compare solvers on one large
        problem.
    method: contact solver. Change it when you compare solvers, or when contacts stay unconverged.
    friction: friction law: Coulomb's cone, or its four-sided approximation.
    tolerance: relative error of contact impulses that the solver accepts. Change it when contact forces must be more
        exact, or when larger errors are fine and speed matters.
    max_iterations: largest number of solver sweeps over the contacts of a region. Change it when regions stay
        unconverged.
    recovery_speed: largest speed at which overlapping surfaces are pushed apart [m/s]. Change it when bodies are so
        small or so slow that this speed disturbs them.
    start_overlaps: treatment of objects that overlap when they are added. Change it when no body may be moved at the
        start.
    sleep: True: bodies that have been still for sleep_time fall asleep. Change it when you study very small motion.
    sleep_time: time for which a body must be still before it falls asleep [s].
    continuous_collision: True: a step in which surfaces would pass through each other is repeated. Change it when
        surfaces may pass through each other and the tests cost too much time.
    """

    gravity: VectorField = held((0.0, 0.0, -9.81))
    step_size: float | None = None
    theta: float = 1.0
    implicit_step: float = 0.0
    integrator: Integrator = "symplectic_euler"
    clusters: bool = True
    backend: Backend = "automatic"
    threads: int = 0
    contact_regions: ContactRegions = "separate"
    method: SolverMethod = "automatic"
    friction: Friction = "cone"
    tolerance: float = 1e-3
    max_iterations: int = 200
    recovery_speed: float = 0.5
    start_overlaps: StartOverlaps = "resolve"
    sleep: bool = True
    sleep_time: float = 0.5
    continuous_collision: bool = True

    def __post_init__(self) -> None:
        make_vectors(self, "gravity")


@dataclass(frozen=True, slots=True, kw_only=True)
class OrthotropicModuli:
    """Elastic constants along the three orthogonal axes of an orthotropic material.

    young_modulus: E_1, E_2, E_3, > 0 [Pa].
    poisson_ratio: nu_12, nu_23, nu_13: under a stress along axis i alone, the strain along axis j is -nu_ij times that
        along axis i.
    shear_modulus: G_12, G_23, G_13, > 0 [Pa].
    first_axis: direction of axis 1 in the mesh.
    second_axis: direction of axis 2 in the mesh; it is made orthogonal to the first.
    """

    young_modulus: VectorField = held((1e5, 1e5, 1e5))
    poisson_ratio: VectorField = held((0.3, 0.3, 0.3))
    shear_modulus: VectorField = held((4e4, 4e4, 4e4))
    first_axis: VectorField = held((1.0, 0.0, 0.0))
    second_axis: VectorField = held((0.0, 1.0, 0.0))

    def __post_init__(self) -> None:
        make_vectors(self, "young_modulus", "poisson_ratio", "shear_modulus", "first_axis", "second_axis")


_no_moduli = OrthotropicModuli()  # default of Material.orthotropic


@dataclass(frozen=True, slots=True, kw_only=True)
class Plasticity:
    """Plasticity of von Mises with isotropic hardening.

    yield_stress: von Mises stress at which the material yields first, above 0 [Pa].
    hardening: slope of the yield stress by the equivalent plastic strain, at least 0 [Pa].
    """

    yield_stress: float
    hardening: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """An elastic material with its friction and its losses.

    young_modulus: Young's modulus, > 0 [Pa].
    poisson_ratio: Poisson's ratio, > -1 and < 0.5.
    density: density, > 0 [kg/m^3].
    friction: Coulomb's friction coefficient, >= 0; default of static_friction and dynamic_friction.
    static_friction: friction coefficient of contacts that stick, >= dynamic_friction.
    dynamic_friction: friction coefficient of contacts that slide, >= 0.
    restitution: rebound speed over impact speed of a surface point, from 0 to 1.
    damping: decay rate of velocities relative to the rigid motion of the body, >= 0 [1/s].
    loss_factor: tangent of the phase angle between stress and strain, from 0 to 0.3. Rubber has 0.05 to 0.2, soft
        tissue 0.1 to 0.3. None: 0.05 for explicit bodies, and no such losses for implicit ones.
    bulk_viscosity: damping ratio of volume changes of an element at its highest frequency, from 0 to 1; for explicit
        bodies.
    model: law of elasticity.
    terms: up to three terms of the law "ogden", each (share of the shear modulus, exponent of the stretches). The
        shares sum to 1. ogden() and mooney_rivlin() set them from moduli.
    orthotropic: constants of the law "orthotropic", which replaces young_modulus and poisson_ratio by those of an
        isotropic material that is nowhere stiffer.
    plasticity: yield of the law "hencky"; for explicit bodies.
    """

    young_modulus: float = 1e5
    poisson_ratio: float = 0.4
    density: float = 1000.0
    friction: float = 0.5
    static_friction: float | None = None
    dynamic_friction: float | None = None
    restitution: float = 0.0
    damping: float = 0.0
    loss_factor: float | None = None
    bulk_viscosity: float = 0.06
    model: MaterialModel = "stable_neo_hookean"
    terms: tuple[tuple[float, float], ...] = ((1.0, 2.0),)
    orthotropic: OrthotropicModuli = _no_moduli
    plasticity: Plasticity | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "terms", tuple((share, exponent) for share, exponent in self.terms))
        if self.model == "orthotropic" and self.orthotropic is _no_moduli:
            raise scene_error(
                "material", "orthotropic", "no elastic constants", 'those of the law "orthotropic"', "use orthotropic()"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class Surface:
    """Friction and restitution of one body or collider. For a body, missing values are those of its material. For a
    collider, missing values are those of the body that touches it.

    friction: Coulomb's friction coefficient, >= 0; default of static_friction and dynamic_friction.
    static_friction: friction coefficient of contacts that stick, >= dynamic_friction.
    dynamic_friction: friction coefficient of contacts that slide, >= 0.
    restitution: rebound speed over impact speed, from 0 to 1.
    """

    friction: float | None = None
    static_friction: float | None = None
    dynamic_friction: float | None = None
    restitution: float | None = None


@dataclass(frozen=True, slots=True)
class Plane:
    """A half-space: the side that the normal points to is free.

    normal: normal vector, shape (3,), of any length except zero.
    point: a point of the plane, shape (3,) [m].
    """

    normal: VectorField = held((0.0, 0.0, 1.0))
    point: VectorField = held((0.0, 0.0, 0.0))

    def __post_init__(self) -> None:
        make_vectors(self, "normal", "point")


@dataclass(frozen=True, slots=True)
class Sphere:
    """A sphere around the origin of its frame.

    radius: radius [m].
    """

    radius: float = 1.0


@dataclass(frozen=True, slots=True)
class Box:
    """A box around the origin of its frame.

    size: edge lengths, shape (3,) [m].
    """

    size: VectorField = held((1.0, 1.0, 1.0))

    def __post_init__(self) -> None:
        make_vectors(self, "size")


@dataclass(frozen=True, slots=True)
class Capsule:
    """A cylinder with hemispheres at its ends. Its axis is z.

    radius: radius [m].
    length: length of the straight part [m].
    """

    radius: float = 0.5
    length: float = 1.0


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder with flat ends. Its axis is z.

    radius: radius [m].
    height: height, from z = -height / 2 to height / 2 [m].
    """

    radius: float = 0.5
    height: float = 1.0


@dataclass(frozen=True, slots=True)
class Bucket:
    """An open cylindrical container. The inner side of its floor is at z = 0.

    radius: inner radius [m].
    height: inner height [m].
    thickness: thickness of wall and floor [m].
    """

    radius: float = 0.5
    height: float = 1.0
    thickness: float = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceMesh:
    """A triangle surface. Triangles are counter-clockwise as seen from outside. A collider with this shape is solid
    inside of a closed surface; a surface with a boundary, even a single triangle, stops bodies from both sides. The
    arrays are copies of those given, and cannot be changed.

    nodes: positions of the nodes, shape (n, 3) [m].
    triangles: numbers of the nodes of each triangle, shape (k, 3).
    """

    nodes: Field[ArrayLike, NDArray[np.float64]] = held(())
    triangles: Field[ArrayLike, NDArray[np.int32]] = held(())

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
        return (SurfaceMesh, (self.nodes, self.triangles))

    def __repr__(self) -> str:
        return f"<skerry.SurfaceMesh {len(self.nodes):,} nodes, {len(self.triangles):,} triangles>"


Shape: TypeAlias = Plane | Sphere | Box | Capsule | Cylinder | Bucket | SurfaceMesh
"""Shape of a collider."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """Position and orientation.

    position: position, shape (3,) [m].
    rotation: rotation axis times angle, shape (3,) [rad], or an object with the method as_rotvec().
    """

    position: VectorField = held((0.0, 0.0, 0.0))
    rotation: RotationField = held((0.0, 0.0, 0.0))

    def __post_init__(self) -> None:
        make_vectors(self, "position")
        make_rotation(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionKey:
    """One keyframe of a scripted motion. Between keyframes the position moves linearly.

    time: time, which must increase from key to key [s].
    position: position, shape (3,) [m].
    rotation: rotation axis times angle, shape (3,) [rad], or an object with the method as_rotvec().
    """

    time: float = 0.0
    position: VectorField = held((0.0, 0.0, 0.0))
    rotation: RotationField = held((0.0, 0.0, 0.0))

    def __post_init__(self) -> None:
        make_vectors(self, "position")
        make_rotation(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """A scripted motion: constant velocities from now on, or keyframes at absolute times.

    velocity: velocity, shape (3,) [m/s].
    angular_velocity: angular velocity, shape (3,) [rad/s].
    keys: keyframes; both velocities must then be zero.
    """

    velocity: VectorField = held((0.0, 0.0, 0.0))
    angular_velocity: VectorField = held((0.0, 0.0, 0.0))
    keys: Field[Iterable[MotionKey], tuple[MotionKey, ...]] = held(())

    def __post_init__(self) -> None:
        make_vectors(self, "velocity", "angular_velocity")
        make_keys(self, MotionKey)


@dataclass(frozen=True, slots=True, kw_only=True)
class JointPassive:
    """Spring, damper and dry friction along the axis of a hinge (angles, moments) or a slider (displacements, forces).

    stiffness: stiffness of the spring, >= 0 [N m/rad or N/m].
    rest: coordinate of the joint at which the spring exerts no force [rad or m].
    damping: moment or force per speed, >= 0 [N m s/rad or N s/m].
    friction: greatest moment or force of dry friction, >= 0 [N m or N].
    """

    stiffness: float = 0.0
    rest: float = 0.0
    damping: float = 0.0
    friction: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorKey:
    """Target of a motor at an absolute time: a speed or a position.

    time: time [s].
    speed: target speed [rad/s or m/s].
    position: target coordinate of the joint [rad or m].
    """

    time: float = 0.0
    speed: float | None = None
    position: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor:
    """A motor on the axis of a hinge or a slider. Give one of `speed`, `position` and `keys`.

    speed: target speed [rad/s or m/s].
    position: target coordinate of the joint, reached within one step if possible [rad or m].
    strength: largest moment (hinge) or force (slider), >= 0 [N m or N].
    fastest: largest speed at which the motor approaches `position`, > 0 [rad/s or m/s].
    keys: targets at ascending times, all of them speeds or all of them positions.
    """

    speed: float | None = None
    position: float | None = None
    strength: float = 0.0
    fastest: float = math.inf
    keys: Field[Iterable[MotorKey], tuple[MotorKey, ...]] = held(())

    def __post_init__(self) -> None:
        make_keys(self, MotorKey)


@dataclass(frozen=True, slots=True, kw_only=True)
class Gas:
    """A gas in a cavity, with p V^exponent = const while its mass is constant.

    pressure: pressure above ambient at the start, > -ambient [Pa].
    exponent: polytropic exponent, >= 1; 1: isothermal, 1.4: adiabatic air.
    ambient: absolute pressure outside of the body, > 0 [Pa].
    density: density at ambient pressure, > 0; default: air at 20 degrees Celsius [kg/m^3].
    inflow: flow of gas into the cavity, a number or pairs (time, value); negative to draw gas out [kg/s].
    """

    pressure: float = 0.0
    exponent: float = 1.4
    ambient: float = 101325.0
    density: float = 1.204
    inflow: Field[TimeTableLike, TimeTable] = held(((0.0, 0.0),))

    def __post_init__(self) -> None:
        object.__setattr__(self, "inflow", time_table(self.inflow, "Gas.inflow"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Liquid:
    """A liquid in a cavity, whose volume is prescribed, as by a syringe. A smaller bulk modulus allows longer steps.

    bulk_modulus: bulk modulus, > 0; default: water [Pa].
    volume: volume of the liquid at ambient pressure, a number or pairs (time, value), > 0; None: the volume of the
        cavity when it is added [m^3].
    ambient: absolute pressure outside of the body, >= 0 [Pa].
    """

    bulk_modulus: float = 2.2e9
    volume: Field[TimeTableLike | None, TimeTable | None] = held(None)
    ambient: float = 101325.0

    def __post_init__(self) -> None:
        if self.volume is not None:
            object.__setattr__(self, "volume", time_table(self.volume, "Liquid.volume"))


@dataclass(frozen=True, slots=True, kw_only=True)
class ProblemSettings:
    """Settings of solve().

    method: solver method.
    friction: friction law: Coulomb's cone, or its four-sided approximation.
    tolerance: upper bound on the relative error of the solution.
    max_iterations: largest number of iterations of a region.
    relaxation: relaxation factor of methods that sweep, > 0 and < 2.
    """

    method: SolverMethod = "automatic"
    friction: Friction = "cone"
    tolerance: float = 1e-6
    max_iterations: int = 100_000
    relaxation: float = 1.0
