"""Bodies and attachments."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._arrays import (
    VectorLike,
    checked,
    flag,
    index_array,
    name_text,
    real,
    real_array,
    real_rows,
    require_shape,
    whole,
)
from .._errors import Doubt, scene_error
from .._sets import MeshSet, set_arrays, set_of
from .._settings import Dynamics, ElementKind, Motion, Pose
from .._visual import VisualLike, VisualSurface, visual_of
from .material import MaterialHandle
from .objects import MovedObject, TouchingObject
from .probes import PointProbe, point_probe
from .reports import DynamicsEstimate

if TYPE_CHECKING:
    from .world import World

Reals: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.int32]
Place: TypeAlias = Literal["tetrahedra", "nodes"]


class Body(TouchingObject):
    """A body of a world. Arrays are copies, unless views() is used; assignment to `positions` and `velocities` changes
    the world. All units are SI units.

    Every use of a removed body raises SceneError, except `alive`, `name` and comparison."""

    __slots__ = ()

    def __init__(self, world: World, handle: Any, name: str) -> None:
        super().__init__(world, handle, f"body '{name}'", name)

    # State.

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return int(self._core.node_count(self._handle))

    @property
    def positions(self) -> Reals:
        """Positions of the nodes, a copy of shape (n, 3) [m]. Assignment sets the positions of all nodes, or of none if
        an element would be inverted (SceneError). Velocities do not change, and attached nodes are held at their new
        positions. A rigid body accepts only positions that are a pose of the body."""
        array: Reals = self._core.positions(self._handle)
        return array

    @positions.setter
    def positions(self, positions: ArrayLike) -> None:
        self._core.set_positions(self._handle, self._rows(positions, "positions"))

    @property
    def velocities(self) -> Reals:
        """Velocities of the nodes, a copy of shape (n, 3) [m/s]. Assignment sets the velocities of all nodes; a rigid
        body takes the nearest rigid motion."""
        array: Reals = self._core.velocities(self._handle)
        return array

    @velocities.setter
    def velocities(self, velocities: ArrayLike) -> None:
        self._core.set_velocities(self._handle, self._rows(velocities, "velocities"))

    @contextmanager
    def views(self) -> Iterator[tuple[Reals, Reals]]:
        """Positions and velocities without a copy: two read-only arrays of shape (n, 3) that advance() changes.

            with body.views() as (x, v):
                ...
            del x, v

        While one of the arrays or a part of it exists, calls that could move its memory raise BufferError: adding and
        removing objects, attach(), set_dynamics() and World.reset() to a copy. Do not read the arrays while another
        thread advances the world."""
        yield self._core.views(self._handle)

    @property
    def surface(self) -> Indices:
        """Node numbers of the boundary triangles, shape (k, 3), read-only."""
        return self._world._mesh_of(self._handle)[0]

    @property
    def tetrahedra(self) -> Indices:
        """Node numbers of the tetrahedra, shape (m, 4), read-only."""
        return self._world._mesh_of(self._handle)[1]

    def stress(self, at: Place = "tetrahedra", *, nodes: ArrayLike | None = None) -> Reals:
        """Cauchy stress without the relaxing part of the viscous stress, shape (m, 3, 3) [Pa]: a mean over each
        tetrahedron, or values recovered at the nodes. With `nodes`, only the values of these nodes are computed."""
        if nodes is not None:
            return self._field(self._core.node_stress_at(self._handle, self._node_numbers(nodes)))
        return self._field(self._core.node_stress(self._handle) if _nodes(at) else self._core.stress(self._handle))

    def strain(self, at: Place = "tetrahedra") -> Reals:
        """Green strain, shape (m, 3, 3): a mean over each tetrahedron, or values recovered at the nodes."""
        return self._field(self._core.node_strain(self._handle) if _nodes(at) else self._core.strain(self._handle))

    def plastic_strain(self) -> Reals:
        """Equivalent plastic strain, shape (m,): a mean over each tetrahedron. Then strain() is the elastic strain."""
        return self._field(self._core.plastic_strain(self._handle))

    def von_mises(self, at: Place = "tetrahedra") -> Reals:
        """Von Mises stress, shape (m,) [Pa]: of each tetrahedron or of each node."""
        if _nodes(at):
            return self._field(self._core.node_von_mises_stress(self._handle))
        return self._field(self._core.von_mises_stress(self._handle))

    def principal_stresses(self) -> Reals:
        """Principal stresses of the nodes, the largest first, shape (n, 3) [Pa]."""
        return self._field(self._core.node_principal_stresses(self._handle))

    def mesh_error(self) -> Reals:
        """Estimated error of the present stress of each tetrahedron, shape (m,), as a fraction of the mean stress of
        the body (energy norm). Refine the mesh where it is large. Empty for a rigid body."""
        return self._field(self._core.mesh_error(self._handle))

    @property
    def tetrahedron_steps(self) -> Reals:
        """Step that each tetrahedron allows in the present shape of the body, shape (m,) [s]."""
        return self._field(self._core.tetrahedron_steps(self._handle))

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return float(self._core.mass(self._handle))

    @property
    def center_of_mass(self) -> Reals:
        """Centre of mass, shape (3,) [m]."""
        return self._field(self._core.center_of_mass(self._handle))

    @property
    def element(self) -> ElementKind:
        """Kind of the elements; for a body added as "smoothed" the kind that was chosen."""
        kind: ElementKind = self._core.element(self._handle)
        return kind

    @property
    def dynamics(self) -> Dynamics:
        """Kind of motion: "explicit", "implicit" or "rigid"."""
        kind: Dynamics = self._core.dynamics(self._handle)
        return kind

    @property
    def dynamics_choice(self) -> DynamicsEstimate:
        """For a body added with the dynamics "automatic": the cost estimate behind the choice."""
        return DynamicsEstimate(**self._core.dynamics_choice(self._handle))

    @property
    def contact_distance(self) -> float:
        """Contact distance [m]."""
        return float(self._core.contact_distance(self._handle))

    @property
    def mean_edge(self) -> float:
        """Mean edge length of the surface in the rest shape [m]."""
        return float(self._core.mean_edge(self._handle))

    @property
    def asleep(self) -> bool:
        """True if the body is asleep (Settings.sleep)."""
        return bool(self._core.asleep(self._handle))

    @property
    def sets(self) -> Mapping[str, MeshSet]:
        """Named parts of the body: the sets of its mesh, and those of add_set()."""
        names: list[str] = self._core.set_names(self._handle)
        return MappingProxyType({name: set_of(self._core.get_set(self._handle, name)) for name in names})

    def add_set(self, name: str, part: MeshSet | ArrayLike) -> None:
        """Names a part of the body: a MeshSet, or numbers of nodes (j,). Steps do not depend on sets, which are saved
        and copied with the world. SceneError: the name is used, the part is empty, or a number is out of range."""
        self._core.add_set(self._handle, name_text(name, "name"), *set_arrays(part, "part"))

    def remove_set(self, name: str) -> None:
        """Removes a set. SceneError: the body has no such set; the message lists the sets that it has."""
        self._core.remove_set(self._handle, name_text(name, "name"))

    def faces(self, part: str | ArrayLike) -> Indices:
        """Node numbers of faces of the surface, shape (k, 3). part: the name of a set, for its listed faces, and those
        that belong to listed tetrahedra or whose nodes are all listed; or numbers of nodes (j,), or a truth value for
        each node (n,), for the faces whose nodes are all chosen. SceneError: there are none, or no such set."""
        if isinstance(part, str):
            faces: Indices = self._core.set_faces(self._handle, name_text(part, "part"))
            return faces
        chosen = self._node_numbers(part)
        faces = self.surface[np.isin(self.surface, chosen).all(axis=1)]
        if not len(faces):
            found = f"{len(chosen)} nodes, which are not all nodes of a face"
            raise scene_error(self._label, "part", found, "all three nodes of at least one face of the surface")
        return faces

    @property
    def visual(self) -> VisualSurface | None:
        """Surface that is drawn in place of the body; None if there is none. Assignment takes a VisualSurface, a
        SurfaceMesh, the path of a file, or None. Steps do not depend on it; it is saved and copied with the world. A
        warning Doubt is issued if its size or position does not fit the body."""
        core = self._core.visual(self._handle)
        return None if core is None else VisualSurface._of(core)

    @visual.setter
    def visual(self, surface: VisualLike | None) -> None:
        if surface is None:
            self._core.remove_visual(self._handle)
            return
        if warning := self._core.set_visual(self._handle, visual_of(surface)._core):
            warnings.warn(f"{self._label}: {warning}", Doubt, stacklevel=2)

    @property
    def visual_positions(self) -> Reals:
        """Present positions of the nodes of the visual surface, shape (n, 3) [m]; no rows without one."""
        positions: Reals = self._core.visual_positions(self._handle)
        return positions

    def tetrahedra_of(self, name: str) -> Indices:
        """Numbers of the tetrahedra of a set, shape (m,): the listed ones, or those whose nodes are all in the set.
        SceneError: there are none, or no such set."""
        tetrahedra: Indices = self._core.set_tetrahedra(self._handle, name_text(name, "name"))
        return tetrahedra

    @property
    def labels(self) -> Indices | None:
        """Label of each tetrahedron, shape (m,); None if the mesh has no labels."""
        labels: Indices = self._core.labels(self._handle)
        return labels if len(labels) else None

    def select(
        self,
        *,
        set: str | None = None,
        label: int | None = None,
        box: tuple[VectorLike, VectorLike] | None = None,
        sphere: tuple[VectorLike, float] | None = None,
        below: float | None = None,
        above: float | None = None,
        surface: bool = False,
        where: Callable[[Reals], ArrayLike] | ArrayLike | None = None,
    ) -> Indices:
        """Numbers of the nodes that meet all given conditions at their present positions, shape (j,).

        set: name of a set.
        label: nodes of the tetrahedra with a label.
        box: lower and upper corner [m].
        sphere: centre and radius [m].
        below, above: height z, inclusive [m].
        surface: only nodes of the surface.
        where: a condition for each node, shape (n,), or a function of the positions (n, 3) that returns it."""
        x = self.positions
        chosen = np.ones(len(x), dtype=np.bool_)
        if set is not None:
            chosen &= np.isin(np.arange(len(x)), self._core.set_nodes(self._handle, name_text(set, "set")))
        if label is not None:
            chosen &= np.isin(np.arange(len(x)), self.tetrahedra[self._with_label(whole(label, "label"))])
        if box is not None:
            lower, upper = real_array(box, "box", (2, 3))  # type: ignore[arg-type]
            chosen &= np.all((x >= lower) & (x <= upper), axis=1)
        if sphere is not None:
            if not isinstance(sphere, Sequence) or len(sphere) != 2:
                raise TypeError(f"sphere: found {sphere!r}, expected a centre and a radius")
            center, radius = real_array(sphere[0], "sphere: centre", (3,)), real(sphere[1], "sphere: radius")
            chosen &= np.linalg.norm(x - center, axis=1) <= radius
        if below is not None:
            chosen &= x[:, 2] <= real(below, "below")
        if above is not None:
            chosen &= x[:, 2] >= real(above, "above")
        if flag(surface, "surface"):
            on_surface = np.zeros(len(x), dtype=np.bool_)
            on_surface[self.surface.ravel()] = True
            chosen &= on_surface
        if where is not None:
            condition = np.asarray(where(x) if callable(where) else where)
            if condition.dtype != np.bool_:
                raise TypeError(f"where: found values of the type {condition.dtype}, expected truth values")
            require_shape(condition, "where", (len(x),))
            chosen &= condition
        return np.flatnonzero(chosen).astype(np.int32)

    def _with_label(self, label: int) -> NDArray[np.bool_]:
        labels = self.labels
        known = [] if labels is None else np.unique(labels).tolist()
        if label not in known:
            expected = f"one of the labels {known}" if known else "no label, because the mesh has no labels"
            raise scene_error(self._label, "label", str(label), expected)
        return np.asarray(labels == label)

    def probe(self, point: VectorLike) -> PointProbe:
        """Probe for a recorder: the material point that is now at `point` (3,) [m]. SceneError: the point is outside of
        the body, farther from its nearest node than the mean edge."""
        return point_probe(self, point)

    # Control.

    def attach(
        self,
        nodes: ArrayLike,
        *,
        motion: Motion | None = None,
        pivot: VectorLike | None = None,
        axes: str | None = None,
        directions: ArrayLike | None = None,
    ) -> Attachment:
        """Prescribes the motion of some nodes. From now on they stay in place or follow `motion`.

        nodes: numbers within the body (j,), or a truth value for each node (n,).
        motion: velocities, or keys at absolute times; the nodes are attached to the pose that the keys have now.
        pivot: point about which constant angular velocities rotate the nodes, default: the origin (3,) [m].
        axes: world axes along which the nodes are held, such as "z" or "xy"; they are free along the others, as on
            rollers.
        directions: the same by perpendicular vectors, shape (d, 3). Default: all directions.

        SceneError: there is no such node; the body is not explicit and only some directions are held; or fewer than
            three nodes that are not on one line for a rigid or implicit body.
        BufferError: arrays of views() are in use."""
        chosen = self._node_numbers(nodes)
        point = real_array((0.0, 0.0, 0.0) if pivot is None else pivot, "pivot", (3,))
        moved = checked(motion or Motion(), "motion", Motion)
        handle = self._core.attach(self._handle, chosen, moved, point, _directions(axes, directions))
        return Attachment(self._world, handle, self, len(chosen))

    def set_loads(self, loads: ArrayLike) -> None:
        """Sets the external forces on the nodes, shape (n, 3) or (3,) for the same force on each [N]. They act until
        they are set again."""
        self._core.set_loads(self._handle, real_rows(loads, "loads", self.node_count))

    @property
    def loads(self) -> Reals:
        """External forces that were set on the nodes, a copy of shape (n, 3) [N]."""
        loads: Reals = self._core.loads(self._handle)
        return loads

    @property
    def material(self) -> MaterialHandle:
        """Material of the body, without those of tetrahedra with a label."""
        return MaterialHandle(self._world, self._core.material_of(self._handle))

    @property
    def attachments(self) -> list[Attachment]:
        """The attachments of the body in the order added."""
        handle = self._handle
        return [attachment for attachment in self._world.attachments if attachment._body_handle == handle]

    def reset(self, pose: Pose | None = None) -> None:
        """Puts the body back into its rest shape, without velocity, at its first pose or at the given one. Plastic
        flow, viscous strains, sleep and stored impulses are reset. Attached nodes are held at their new positions;
        loads stay."""
        if pose is None:
            self._core.reset(self._handle)
        else:
            self._core.reset(self._handle, checked(pose, "pose", Pose))

    def set_dynamics(self, dynamics: Literal["explicit", "implicit", "rigid"]) -> None:
        """Changes the kind of motion. Name, settings, shape, momentum and angular momentum stay; the body counts as
        added last. A body that becomes rigid is frozen in its present shape.

        SceneError: the body is attached, has a joint or a given mass, has no tetrahedra, is a sphere, capsule or
            cylinder, or has deformed plastically; or the kind does not fit its self-contact, losses, plasticity or
            inverted tetrahedra.
        BufferError: arrays of views() are in use."""
        self._core.set_dynamics(self._handle, checked(dynamics, "dynamics", str))

    def wake(self) -> None:
        """Wakes the body if it is asleep."""
        self._core.wake(self._handle)

    def _rows(self, value: ArrayLike, name: str) -> Reals:
        return real_array(value, name, (self.node_count, 3))

    def _node_numbers(self, nodes: ArrayLike) -> Indices:
        chosen = np.asarray(nodes)
        if chosen.dtype == np.bool_:
            require_shape(chosen, "nodes", (self.node_count,))
            return np.flatnonzero(chosen).astype(np.int32)
        return index_array(nodes, "nodes", ("j",))

    @staticmethod
    def _field(array: Any) -> Reals:
        values: Reals = array
        return values

    def _description(self) -> str:
        kind = "rigid" if self.dynamics == "rigid" else "deformable"
        return (
            f" '{self.name}' {kind}, {self.node_count:,} nodes, {len(self.tetrahedra):,} tetrahedra, {self.mass:.3g} kg"
        )


class Attachment(MovedObject):
    """Nodes of a body whose motion is prescribed. `pose` is the pose of the moving frame to which the nodes are
    attached. When they were attached, this frame was at the pivot without rotation, or at the pose of the keys."""

    __slots__ = ("_body_handle", "_body_name", "_node_count")

    def __init__(self, world: World, handle: Any, body: Body, node_count: int) -> None:
        super().__init__(world, handle, f"attachment of body '{body.name}'")
        self._body_handle = body._given_handle
        self._body_name = body.name
        self._node_count = node_count

    @property
    def body(self) -> Body:
        """The body."""
        return Body(self._world, self._body_handle, self._body_name)

    @property
    def directions(self) -> Reals:
        """Unit vectors along which the nodes are held, shape (d, 3); empty if they are held completely."""
        directions: Reals = self._core.directions(self._handle)
        return directions

    @property
    def nodes(self) -> Indices:
        """Numbers of the attached nodes within the body, shape (j,)."""
        nodes: Indices = self._core.nodes_of(self._handle)
        return nodes

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (self._world, self._given_handle, self.body, self._node_count))

    def _description(self) -> str:
        return f" of body '{self._body_name}', {self._node_count:,} nodes"


def _directions(axes: str | None, directions: ArrayLike | None) -> list[Any]:
    if axes is None:
        return [] if directions is None else list(real_array(directions, "directions", ("d", 3)))
    if directions is not None:
        raise TypeError("axes, directions: found both, expected at most one of them")
    if not isinstance(axes, str) or not axes or len({*axes}) < len(axes) or not {*axes} <= {*"xyz"}:
        raise ValueError(f"axes: found {axes!r}, expected different letters of 'xyz'")
    return [np.eye(3)["xyz".index(axis)] for axis in axes]


def _nodes(at: str) -> bool:
    """True for "nodes", False for "tetrahedra"."""
    if at not in ("tetrahedra", "nodes"):
        raise ValueError(f"at: found {at!r}, expected 'tetrahedra' or 'nodes'")
    return at == "nodes"
