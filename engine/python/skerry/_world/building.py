"""Adding and removing the objects of a world."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Unpack

from numpy.typing import ArrayLike

from .._arrays import (
    RotationLike,
    TimeTableLike,
    VectorLike,
    checked,
    flag,
    index_array,
    name_text,
    optional_name,
    read_only,
    real,
    real_array,
    time_table,
    vector,
    whole,
)
from .._arrays import rotation as rotation_vector
from .._errors import scene_error
from .._mesh import Mesh
from .._settings import (
    Box,
    Bucket,
    Capsule,
    Cylinder,
    Dynamics,
    ElementKind,
    JointKind,
    JointPassive,
    Material,
    Motion,
    Motor,
    Plane,
    Shape,
    Sphere,
    SpringSide,
    SurfaceMesh,
    TieKind,
)
from .._visual import VisualLike, visual_of
from .anchor import Anchor, core_anchor
from .body import Attachment, Body, Indices
from .cable import Cable, drive_tables
from .cavity import Cavity, CavityBuilding, Pipe
from .changes import MaterialChanges
from .collider import Collider
from .fibre import FibreFamily
from .finding import Finding
from .joint import Joint
from .load import Load
from .material import MaterialHandle
from .objects import NamedObject, Objects, PosedObject
from .spring import Spring
from .tie import Tie

if TYPE_CHECKING:
    from .._recorder import Follower


_SHAPES = (Plane, Sphere, Box, Capsule, Cylinder, Bucket, SurfaceMesh)


class Arguments(SimpleNamespace):
    """Arguments of a call for the extension module. Its messages name the object by the attribute `of`."""


class Building(Finding, CavityBuilding):
    """The part of World that adds and removes objects."""

    __slots__ = (
        "__weakref__",
        "_advancing",
        "_core",
        "_doubts",
        "_followers",
        "_materials",
        "_mesh_arrays",
        "_take",
        "_take_every",
        "_watch",
    )

    def _hold(self, core: Any) -> None:
        self._core: Any = core
        self._advancing = False
        self._watch: Callable[[dict[str, Any]], bool] | None = None  # from _with_report()
        self._take: Callable[[dict[str, Any]], None] | None = None  # of contact_problems()
        self._take_every = 1
        self._followers: list[Follower] = []
        self._doubts: set[tuple[str, ...]] = set()
        self._materials: dict[Material, Any] = {}
        self._mesh_arrays: dict[Any, tuple[Indices, Indices]] = {}

    def _own(self, given: Any, name: str, *kinds: type) -> Any:
        """Handle of an argument that must be an object of this world, of one of the given classes. The handle of an
        object of a copy would name an object of this world, too, so it is refused."""
        if checked(given, name, *kinds)._world is not self:
            raise scene_error(
                "",
                name,
                f"{given._label}, which belongs to another world",
                "an object of this world",
                "object.in_copy(world) is the object in a copy of its world",
            )
        return given._handle

    def add_material(self, material: Material | None = None, /, **changes: Unpack[MaterialChanges]) -> MaterialHandle:
        """Adds a material: add_material(Material(density=900)) or add_material(density=900). SceneError: a value is out
        of range."""
        given = checked(material or Material(), "material", Material)
        return MaterialHandle(self._self, self._core.add_material(dataclasses.replace(given, **changes)))

    def add_body(
        self,
        mesh: Mesh | SurfaceMesh | Sphere | Capsule | Cylinder,
        material: Material | MaterialHandle,
        *,
        materials: Mapping[int | str, Material | MaterialHandle] | None = None,
        position: VectorLike = (0.0, 0.0, 0.0),
        rotation: RotationLike = (0.0, 0.0, 0.0),
        velocity: VectorLike = (0.0, 0.0, 0.0),
        angular_velocity: VectorLike = (0.0, 0.0, 0.0),
        dynamics: Dynamics = "automatic",
        element: ElementKind = "smoothed",
        self_contact: bool = False,
        contact_distance: float | None = None,
        mass: float | None = None,
        center_of_mass: VectorLike | None = None,
        inertia: ArrayLike | None = None,
        collision_group: int = 1,
        collision_mask: int = 0xFFFFFFFF,
        visual: VisualLike | None = None,
        name: str | None = None,
    ) -> Body:
        """Adds a body and returns it.

        mesh: a Mesh; a Sphere, a Capsule or a Cylinder, which are rigid and touch others with their exact shape; or a
            SurfaceMesh of closed shells with dynamics="rigid".
        material: a handle, or a record; equal records become one material.
        materials: materials of the tetrahedra with a label, or of a set by its name; sets take precedence.
        position, rotation: pose of the mesh (3,) [m, rad].
        velocity, angular_velocity: initial rigid motion about the centre of mass (3,) [m/s, rad/s].
        dynamics: "explicit", "implicit", "rigid" or "automatic", which chooses explicit or implicit by their costs.
        element: kind of the elements.
        self_contact: True: the body can touch itself.
        contact_distance: contact distance, default 2 % of the mean edge length of the surface [m].
        mass: mass of a rigid body [kg], instead of that by density. It alone scales the inertia of the shape.
        center_of_mass, inertia: centre of mass (3,) [m] and inertia about it (3, 3) [kg m^2], both in the frame of the
            mesh. They require the mass.
        collision_group, collision_mask: see Body.set_collision_groups().
        visual: see Body.visual.
        name: unique in the world, default "body N".

        SceneError: a value is out of range, or a body has this name.
        BufferError: arrays of views() are in use. Ctrl-C raises KeyboardInterrupt at the end of the call, when the body
            is already added."""
        name = self._new_name(name, "body", self.bodies)
        surface = None if visual is None else visual_of(visual)
        given = Arguments(
            of=f"body '{name}'",
            position=vector(position, "position"),
            rotation=rotation_vector(rotation, "rotation"),
            velocity=vector(velocity, "velocity"),
            angular_velocity=vector(angular_velocity, "angular_velocity"),
            dynamics=dynamics,
            element=element,
            self_contact=flag(self_contact, "self_contact"),
            contact_distance=None if contact_distance is None else real(contact_distance, "contact_distance"),
            mass=None if mass is None else real(mass, "mass"),
            center_of_mass=None if center_of_mass is None else vector(center_of_mass, "center_of_mass"),
            inertia=None if inertia is None else real_array(inertia, "inertia", (3, 3)).tolist(),
            collision_group=whole(collision_group, "collision_group"),
            collision_mask=whole(collision_mask, "collision_mask"),
            name=name,
        )
        if isinstance(mesh, (SurfaceMesh, Sphere, Capsule, Cylinder)):
            handle = self._core.add_rigid_body(mesh, self._material(material), given)
        elif isinstance(mesh, Mesh):
            given_materials = checked(materials or {}, "materials", Mapping)
            by_label, by_set = {}, {}
            for key, item in given_materials.items():
                if isinstance(key, str):
                    by_set[key] = self._material(item)
                else:
                    by_label[index_array(key, "label", ()).item()] = self._material(item)
            handle = self._core.add_body(mesh._core, self._material(material), by_label, by_set, given)
        else:
            raise TypeError(f"mesh: found {mesh!r}, expected a Mesh, SurfaceMesh, Sphere, Capsule or Cylinder")
        body = Body(self._self, handle, given.name)
        if surface is not None:
            try:
                body.visual = surface
            except Exception:
                body.remove()
                raise
        return body

    def add_collider(
        self,
        shape: Shape,
        *,
        position: VectorLike = (0.0, 0.0, 0.0),
        rotation: RotationLike = (0.0, 0.0, 0.0),
        motion: Motion | None = None,
        material: Material | MaterialHandle | None = None,
        friction: float | None = None,
        static_friction: float | None = None,
        dynamic_friction: float | None = None,
        restitution: float | None = None,
        contact_distance: float = 0.0,
        collision_group: int = 1,
        collision_mask: int = 0xFFFFFFFF,
        name: str | None = None,
    ) -> Collider:
        """Adds a collider and returns it.

        shape: a Plane, Sphere, Box, Capsule, Cylinder, Bucket or SurfaceMesh.
        position, rotation: pose (3,) [m, rad].
        motion: velocities, or keys, which are poses at absolute times.
        material: a handle or a record, see Collider.material.
        friction, static_friction, dynamic_friction: a contact uses the geometric mean of this value and that of the
            body, or that of the material or the body if not given.
        restitution: a contact uses the larger value.
        contact_distance: thickness of the contact shell of a SurfaceMesh [m].
        collision_group, collision_mask: see Collider.set_collision_groups().
        name: unique in the world, default "collider N".

        SceneError: a value is out of range, or a collider has this name.
        BufferError: arrays of views() are in use."""
        name = self._new_name(name, "collider", self.colliders)
        given = Arguments(
            of=f"collider '{name}'",
            position=vector(position, "position"),
            rotation=rotation_vector(rotation, "rotation"),
            motion=checked(motion or Motion(), "motion", Motion),
            friction=friction,
            static_friction=static_friction,
            dynamic_friction=dynamic_friction,
            restitution=restitution,
            contact_distance=real(contact_distance, "contact_distance"),
            collision_group=whole(collision_group, "collision_group"),
            collision_mask=whole(collision_mask, "collision_mask"),
            name=name,
        )
        given_shape = checked(shape, "shape", *_SHAPES)
        of_surface = None if material is None else self._material(material)
        handle = self._core.add_collider(given_shape, given)
        self._core.set_material_of_collider(handle, of_surface)
        return Collider(self._self, handle, name)

    def add_joint(
        self,
        kind: JointKind,
        first: Body,
        second: Body | None = None,
        *,
        point: VectorLike = (0.0, 0.0, 0.0),
        axis: VectorLike = (0.0, 0.0, 1.0),
        coordinate: float = 0.0,
        lower: float | None = None,
        upper: float | None = None,
        motor: Motor | None = None,
        passive: JointPassive | None = None,
        bodies_touch: bool = False,
        name: str | None = None,
    ) -> Joint:
        """Joins two rigid bodies, or a rigid body and the world, in their present poses, and returns the joint.

        kind: "ball", "hinge", "slider" or "fixed".
        point: position of the joint (3,) [m].
        axis: axis of a hinge or a slider (3,).
        coordinate, lower, upper: present coordinate and its limits [rad or m].
        motor: motor on the axis.
        passive: spring, damper and dry friction on the axis.
        bodies_touch: True: the two bodies may collide.
        name: see Joint.name.
        SceneError: a body is not rigid, or a value is out of range."""
        name = optional_name(name)
        given = Arguments(
            of="joint",
            kind=kind,
            point=vector(point, "point"),
            axis=vector(axis, "axis"),
            coordinate=real(coordinate, "coordinate"),
            lower=lower,
            upper=upper,
            motor=motor,
            passive=JointPassive() if passive is None else passive,
            bodies_touch=flag(bodies_touch, "bodies_touch"),
        )
        one = self._own(first, "first", Body)
        other = None if second is None else self._own(second, "second", Body)
        return self._joint(self._core.add_joint(one, other, given))._named(name)

    def add_tie(
        self,
        body: Body,
        nodes: ArrayLike,
        to: Body | Collider | None = None,
        *,
        kind: TieKind = "weld",
        break_force: float = math.inf,
        close_gap: bool = False,
        bodies_touch: bool = False,
        name: str | None = None,
    ) -> Tie:
        """Ties nodes of a deformable body in their present places to the nearest points of another body or a collider,
        or to the world, and returns the tie.

        nodes: numbers within the body (j,), or a truth value for each node (n,).
        kind: "weld", or "slide" for nodes that may move in the plane of the surface, or "ball": only the mean point of
            all nodes, weighted by their masses, is tied.
        break_force: force at which a node, or the ball, breaks off [N].
        close_gap: True: the nodes move to the surface.
        bodies_touch: True: the two objects may collide while nodes are tied.
        name: see Tie.name.
        SceneError: the body is rigid, or a value is out of range.
        BufferError: arrays of views() are in use."""
        name = optional_name(name)
        given = Arguments(
            of="tie",
            kind=kind,
            break_force=real(break_force, "break_force"),
            close_gap=flag(close_gap, "close_gap"),
            bodies_touch=flag(bodies_touch, "bodies_touch"),
        )
        tied = self._own(body, "body", Body)
        other = None if to is None else self._own(to, "to", Body, Collider)
        to_body, to_collider = (None, other) if isinstance(to, Collider) else (other, None)
        tie = self._tie(self._core.add_tie(tied, body._node_numbers(nodes), to_body, to_collider, given))
        return tie._named(name)

    def add_cable(
        self,
        points: Sequence[Anchor],
        *,
        tension: TimeTableLike | None = None,
        length: TimeTableLike | None = None,
        rate: TimeTableLike | None = None,
        friction: float = 0.0,
        name: str | None = None,
    ) -> Cable:
        """Adds a cable that runs straight from point to point and never pushes, and returns it.

        points: at least two points, at least one on a body. Exactly one of the next three is given, as a number or as
            pairs (time, value).
        tension: tension of the first segment [N].
        length: greatest length [m].
        rate: rate of the greatest length, which is the length now [m/s].
        friction: friction coefficient mu at the points between the first and the last; tensions differ there by at most
            exp(mu theta) for a bend by the angle theta.
        name: see Cable.name."""
        name = optional_name(name)
        given = [core_anchor(self._self, point, f"points[{number}]") for number, point in enumerate(points)]
        drive = drive_tables(tension, length, rate)
        return self._cable(self._core.add_cable(given, *drive, real(friction, "friction")))._named(name)

    def add_spring(
        self,
        first: Anchor,
        second: Anchor,
        *,
        stiffness: float = 0.0,
        damping: float = 0.0,
        rest_length: TimeTableLike | None = None,
        only: SpringSide = "both",
        strength: float = math.inf,
        name: str | None = None,
    ) -> Spring:
        """Adds a spring, a damper, or both in parallel, between two anchors, and returns the spring.

        stiffness: [N/m].
        damping: force per rate of the length [N s/m].
        rest_length: a number, or pairs (time [s], length); None: the present length [m].
        only: "both", "tension" (acts only while longer than the rest length) or "compression".
        strength: largest force [N].
        name: see Spring.name.
        SceneError: no anchor is on a body, or a value is out of range."""
        name = optional_name(name)
        given = Arguments(
            of="spring",
            stiffness=real(stiffness, "stiffness"),
            damping=real(damping, "damping"),
            rest_length=None if rest_length is None else time_table(rest_length, "rest_length"),
            only=only,
            strength=real(strength, "strength"),
        )
        one, other = core_anchor(self._self, first, "first"), core_anchor(self._self, second, "second")
        return self._spring(self._core.add_spring(one, other, given))._named(name)

    def remove(self, removed: PosedObject | NamedObject) -> None:
        """Removes an object of any kind except a material. BufferError: arrays of views() are in use."""
        from .surface import SurfaceSet

        kinds = (Body, Collider, Attachment, Joint, Tie, Cable, Spring, Load, Cavity, Pipe, FibreFamily, SurfaceSet)
        handle = self._own(removed, "removed", *kinds)
        self._core.remove(handle)
        self._mesh_arrays.pop(handle, None)

    def _mesh_of(self, body: Any) -> tuple[Indices, Indices]:
        """Surface and tetrahedra of a body, which never change."""
        arrays = self._mesh_arrays.get(body)
        if arrays is None:
            arrays = (read_only(self._core.surface(body)), read_only(self._core.tetrahedra(body)))
            self._mesh_arrays[body] = arrays
        return arrays

    def _material(self, material: Material | MaterialHandle) -> Any:
        if isinstance(material, MaterialHandle):
            return self._own(material, "material", MaterialHandle)
        if not isinstance(material, Material):
            raise TypeError(f"material: found {material!r}, expected a Material or a MaterialHandle")
        if material not in self._materials:
            self._materials[material] = self.add_material(material)._handle
        return self._materials[material]

    def _forget_material(self, changed: Any) -> None:
        """Must be called after a material was changed, because its record is then outdated."""
        self._materials = {record: handle for record, handle in self._materials.items() if handle != changed}

    def _new_name(self, name: str | None, kind: str, objects: Objects[Any]) -> str:
        if name is None:
            number = len(objects)
            while (free := f"{kind} {number}") in objects:
                number += 1
            return free
        if name_text(name, "name") in objects:
            raise scene_error(f"{kind} '{name}'", "name", f"the name of another {kind}", "a new name")
        return name
