"""Contacts, forces and queries of a world."""

from __future__ import annotations

import math
from collections.abc import Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import Reals, VectorLike, flag, numbers, real, real_array, real_rows, whole
from ._problem import StepProblem, contact_problems

if TYPE_CHECKING:
    from ._world import Attachment, Body, Collider, World

OPEN, STICK, SLIDE = 0, 1, 2
"""Values of the field `motion` of a contact."""

contact_dtype = np.dtype(
    [
        ("first", np.int32),  # number of the body whose point or edge touches; -1: a mesh collider
        ("second", np.int32),  # number of the other body; -1: the partner is a collider
        ("collider", np.int32),  # number of the collider; -1: both partners are bodies
        ("node", np.int32, (4,)),  # numbers of the nodes within their bodies; -1 where the weight is 0
        ("weight", np.float64, (4,)),  # > 0: the node belongs to `first`; < 0: it belongs to `second`
        ("point", np.float64, (3,)),  # contact point on the second body or the collider [m]
        ("normal", np.float64, (3,)),  # unit normal, pointing towards `first`
        ("slip", np.float64, (3,)),  # tangential relative velocity after the step [m/s]
        ("impulse", np.float64, (3,)),  # impulse on `first` [N s]
        ("force", np.float64, (3,)),  # mean force on `first` during the step [N]
        ("friction_direction", np.float64, (3,)),  # direction of the friction coefficients; 0: the same in all
        ("static_friction", np.float64),  # friction coefficient of sticking along friction_direction
        ("dynamic_friction", np.float64),  # friction coefficient of sliding along friction_direction
        ("friction_across", np.float64),  # friction coefficient of sliding across friction_direction
        ("distance", np.float64),  # distance of the surfaces; negative if they overlap [m]
        ("gap", np.float64),  # distance by which the surfaces may still approach [m]
        ("seconds", np.float64),  # duration of the forces [s]
        ("motion", np.uint8),  # OPEN, STICK or SLIDE
        ("region", np.int32),  # number of the contact region; -1: no node can move, or the bodies sleep
    ],
    align=True,
)
"""Fields of World.contacts. Bodies and colliders are numbers for world.bodies and world.colliders."""

hit_dtype = np.dtype(
    [
        ("body", np.int32),  # number of the body; -1: the point is on a collider, or there is none
        ("collider", np.int32),  # number of the collider; -1: the point is on a body, or there is none
        ("triangle", np.int32),  # number in Body.surface or in the mesh of a collider; -1: an exact shape
        ("barycentric", np.float64, (3,)),  # weights of the corners of the triangle
        ("point", np.float64, (3,)),  # position [m]
        ("normal", np.float64, (3,)),  # outward unit normal
        ("distance", np.float64),  # distance from the origin of the ray or from the point; inf: there is none [m]
    ],
    align=True,
)
"""Fields of the results of World.cast_rays() and World.nearest_points()."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceHit:
    """A point of the surface of a body or a collider.

    body: body, or None if the point is on a collider.
    collider: collider, or None if the point is on a body.
    triangle: number of the triangle in Body.surface, or in the mesh of a collider; -1 for exact shapes.
    barycentric: weights of the corners of the triangle at the point.
    point: position [m].
    normal: outward unit normal.
    distance: distance from the origin of the ray, or from the given point [m].
    """

    body: Body | None
    collider: Collider | None
    triangle: int
    barycentric: tuple[float, float, float]
    point: tuple[float, float, float]
    normal: tuple[float, float, float]
    distance: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForceReport:
    """Forces on a body or a collider, summed over all steps of the last call of advance().

    impulse: sum of the impulses, shape (3,) [N s].
    moment_impulse: sum of the moments of the impulses about `moment_point`, shape (3,) [N m s].
    friction_impulse: tangential part of `impulse`, shape (3,); zero for attachments [N s].
    pressing_impulse: sum of the magnitudes of the normal impulses [N s].
    largest_force: largest force of a single step [N].
    contact_count: number of contacts with an impulse in the last step.
    most_contacts: largest number of contacts with an impulse in any step.
    seconds: time for which loads acted [s].
    moment_point: reference point of moments, as given to measure_forces(), shape (3,) [m].
    measured: False if the call was too short for the force to be measured, or took no step. Mean values are then NaN.
    """

    impulse: Reals
    moment_impulse: Reals
    friction_impulse: Reals
    pressing_impulse: float
    largest_force: float
    contact_count: int
    most_contacts: int
    seconds: float
    moment_point: Reals
    measured: bool

    @property
    def force(self) -> Reals:
        """Mean force, shape (3,) [N]."""
        return self._mean(self.impulse)

    @property
    def moment(self) -> Reals:
        """Mean moment about `moment_point`, shape (3,) [N m]."""
        return self._mean(self.moment_impulse)

    @property
    def friction(self) -> Reals:
        """Mean of the tangential part of the force, shape (3,) [N]."""
        return self._mean(self.friction_impulse)

    @property
    def pressing(self) -> float:
        """Mean of the sum of the magnitudes of the normal forces [N]."""
        return float(self._mean(np.array(self.pressing_impulse)))

    def moment_about(self, point: VectorLike) -> Reals:
        """Mean moment about another fixed point (3,) [m], shape (3,) [N m]."""
        arm = self.moment_point - real_array(point, "point", (3,))
        return self._mean(self.moment_impulse + np.cross(arm, self.impulse))

    def _mean(self, total: Reals) -> Reals:
        return total / self.seconds if self.measured and self.seconds > 0 else np.full_like(total, np.nan)

    def __repr__(self) -> str:
        force = ", ".join(f"{component:.6g}" for component in self.force)
        return f"<skerry.ForceReport force ({force}) N, {self.contact_count:,} contacts>"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PairForces:
    """Forces between two objects that touched.

    first: body.
    second: other body, which is `first` for contacts of a body with itself, or a collider.
    on_first: forces of `second` on `first`; those on `second` are opposite.
    """

    first: Body
    second: Body | Collider
    on_first: ForceReport


class Forces:
    """Forces over the last call of advance(). SceneError: World.measure_forces() was not called before."""

    __slots__ = ("_world",)

    def __init__(self, world: World) -> None:
        self._world = world

    def __repr__(self) -> str:
        return f"<skerry.Forces of {self._world!r}>"

    def on(self, on: Body | Collider, by: Body | Collider | None = None) -> ForceReport:
        """Contact forces on a body or a collider, summed over all contacts, or over those with the object `by`."""
        from ._world import Body, Collider

        own = self._world._own
        handles = [own(on, "on", Body, Collider)]
        if by is not None:
            kinds = (Body, Collider) if isinstance(on, Body) else (Body,)
            handles.append(own(by, "by", *kinds))
        return ForceReport(**self._world._core.forces_on(*handles))

    def by(self, attachment: Attachment) -> ForceReport:
        """Forces of an attachment on its body, which keep the attached nodes on their prescribed motion."""
        from ._world import Attachment

        return ForceReport(**self._world._core.forces_by(self._world._own(attachment, "attachment", Attachment)))

    def pairs(self) -> list[PairForces]:
        """All pairs of objects that touched: first bodies with colliders, then bodies with bodies."""
        world = self._world
        return [
            PairForces(
                first=world._body(first),
                second=world._body(second) if collider is None else world._collider(collider),
                on_first=ForceReport(**values),
            )
            for first, second, collider, values in world._core.force_pairs()
        ]


class WorldResults:
    """Results and queries of class World."""

    __slots__ = ()

    if TYPE_CHECKING:
        _core: Any
        _own: Any
        bodies: Any
        colliders: Any

    @property
    def contacts(self) -> NDArray[np.void]:
        """Contacts of the last step and contacts between sleeping bodies: a structured array with the fields of
        contact_dtype, in a fixed order. Numbers of bodies and colliders shift when an object before them is removed.
        Every use makes a new array, so keep it:

            contacts = world.contacts
            sliding = contacts[contacts["motion"] == skerry.SLIDE]["force"]  # shape (k, 3) [N]
        """
        rows: NDArray[np.void] = self._core.contacts().view(contact_dtype)
        return rows

    @property
    def regions(self) -> list[NDArray[np.int64]]:
        """Contact regions of the last step: for each region the numbers of its contacts in `contacts`. Contacts of
        different regions do not influence each other within a step."""
        region = self.contacts["region"]
        order = np.argsort(region, kind="stable")
        counts = np.bincount(region[region >= 0])
        return np.split(order[np.count_nonzero(region < 0) :], np.cumsum(counts)[:-1]) if len(counts) else []

    def contact_problems(self, *, every: int = 1) -> AbstractContextManager[list[StepProblem]]:
        """Collects the contact problems of steps whose number is a multiple of `every`:

            with world.contact_problems() as problems:
                world.advance(0.1)
            solution = skerry.solve(problems[0].problem)

        Only one such block may be active at a time."""
        return contact_problems(self, whole(every, "every"))

    def measure_forces(self, point: VectorLike = (0.0, 0.0, 0.0), *, on: bool = True) -> None:
        """From now on each call of advance() sums the forces of contacts and attachments, with moments about `point`,
        shape (3,) [m]. on=False ends this. Steps do not change. A loaded world does not measure."""
        self._core.measure_forces(flag(on, "on"), real_array(point, "point", (3,)))

    @property
    def measures_forces(self) -> bool:
        """True if forces are measured."""
        return bool(self._core.measures_forces())

    @property
    def forces(self) -> Forces:
        """Forces over the last call of advance(): world.forces.on(ball, by=floor).force."""
        return Forces(self)  # type: ignore[arg-type]

    def cast_ray(
        self,
        origin: VectorLike,
        direction: VectorLike,
        max_distance: float = math.inf,
        *,
        bodies: bool = True,
        colliders: bool = True,
        groups: int = 0xFFFFFFFF,
        but: Iterable[Body | Collider] = (),
    ) -> SurfaceHit | None:
        """Finds the first surface that a ray hits, from either side, or None.

        origin: start of the ray (3,) [m].
        direction: any length except zero (3,).
        max_distance: length of the ray [m].
        bodies, colliders: which surfaces are tested; groups: only objects in one of these collision groups; but: all
            objects except these."""
        rows = self.cast_rays(
            real_array(origin, "origin", (3,))[np.newaxis],
            real_array(direction, "direction", (3,)),
            max_distance,
            bodies=bodies,
            colliders=colliders,
            groups=groups,
            but=but,
        )
        return self._hit(rows[0])

    def cast_rays(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        max_distance: float = math.inf,
        *,
        bodies: bool = True,
        colliders: bool = True,
        groups: int = 0xFFFFFFFF,
        but: Iterable[Body | Collider] = (),
    ) -> NDArray[np.void]:
        """Casts many rays like cast_ray(). origins, directions: shape (n, 3), or (3,) for all rays. The result is a
        structured array (n,) with the fields of hit_dtype."""
        starts, ways = _rows_of_both(origins, "origins", directions, "directions")
        filters = self._filters(max_distance, bodies, colliders, groups, but)
        rows: NDArray[np.void] = self._core.cast_rays(starts, ways, *filters).view(hit_dtype)
        return rows

    def nearest_point(
        self,
        point: VectorLike,
        max_distance: float = math.inf,
        *,
        bodies: bool = True,
        colliders: bool = True,
        groups: int = 0xFFFFFFFF,
        but: Iterable[Body | Collider] = (),
    ) -> SurfaceHit | None:
        """Finds the nearest point of any surface within `max_distance` [m] of `point` (3,) [m], or None. The other
        arguments are those of cast_ray()."""
        rows = self.nearest_points(
            real_array(point, "point", (3,))[np.newaxis],
            max_distance,
            bodies=bodies,
            colliders=colliders,
            groups=groups,
            but=but,
        )
        return self._hit(rows[0])

    def nearest_points(
        self,
        points: ArrayLike,
        max_distance: float = math.inf,
        *,
        bodies: bool = True,
        colliders: bool = True,
        groups: int = 0xFFFFFFFF,
        but: Iterable[Body | Collider] = (),
    ) -> NDArray[np.void]:
        """Finds the nearest points of surfaces for many points, shape (n, 3). The result is a structured array (n,)
        with the fields of hit_dtype."""
        given = real_array(points, "points", ("n", 3))
        filters = self._filters(max_distance, bodies, colliders, groups, but)
        rows: NDArray[np.void] = self._core.nearest_points(given, *filters).view(hit_dtype)
        return rows

    def _filters(
        self, max_distance: float, bodies: bool, colliders: bool, groups: int, but: Iterable[Body | Collider]
    ) -> tuple[Any, ...]:
        """Arguments of a query after its points, for the extension module."""
        from ._world import Body, Collider

        if not isinstance(but, Iterable):
            raise TypeError(f"but: found {but!r}, expected a list of bodies and colliders")
        return (
            real(max_distance, "max_distance"),
            flag(bodies, "bodies"),
            flag(colliders, "colliders"),
            whole(groups, "groups"),
            [self._own(left_out, "but", Body, Collider) for left_out in but],
        )

    def _hit(self, row: np.void) -> SurfaceHit | None:
        if math.isinf(row["distance"]):
            return None
        return SurfaceHit(
            body=self.bodies[int(row["body"])] if row["body"] >= 0 else None,
            collider=self.colliders[int(row["collider"])] if row["collider"] >= 0 else None,
            triangle=int(row["triangle"]),
            barycentric=tuple(row["barycentric"].tolist()),
            point=tuple(row["point"].tolist()),
            normal=tuple(row["normal"].tolist()),
            distance=float(row["distance"]),
        )


def _rows_of_both(first: ArrayLike, name: str, second: ArrayLike, other: str) -> tuple[Reals, Reals]:
    """Two arrays of the shape (n, 3), of which one may be given as one row for all."""
    one, two = numbers(first, name, ("n", 3)), numbers(second, other, ("n", 3))
    many = max(one.shape, two.shape, key=len)
    count = many[0] if len(many) == 2 else 1
    return real_rows(one, name, count), real_rows(two, other, count)
