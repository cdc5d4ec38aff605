"""The world."""

from __future__ import annotations

import dataclasses
import math
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any, Unpack

from .. import _core
from .._arrays import RotationLike, VectorLike, read_only, real_array, rotation, vector
from .._errors import Doubt, SceneError, StepError
from .._settings import (
    Capsule,
    Cylinder,
    Dynamics,
    ElementKind,
    JointKind,
    Material,
    Motion,
    Motor,
    Settings,
    Shape,
    Sphere,
)
from .body import Attachment, Body, Indices
from .changes import MaterialChanges, SettingsChanges
from .collider import Collider
from .joint import Joint, joint_label
from .material import MaterialHandle
from .objects import Objects, PosedObject, WorldObject
from .page import world_table
from .reports import Energy, StepReport, WorldReport, step_report, world_report

_LARGEST_TRUSTED_ERROR = 0.5
"""Solver error of a region above which World.advance() warns, as WorldReport.distrust does."""


class BodySettings(SimpleNamespace):
    """Arguments of add_body() for the extension module."""


class ColliderSettings(SimpleNamespace):
    """Arguments of add_collider() for the extension module."""


class JointSettings(SimpleNamespace):
    """Arguments of add_joint() for the extension module."""


class World:
    """A simulation of deformable and rigid bodies in frictional contact. All units are SI units.

    World() has the default settings, World(settings) the given ones; keywords change single settings:
    World(gravity=(0, 0, 0), threads=1).

    One thread at a time may use a world; a call from another thread raises BusyError. Different worlds are independent.
    copy.copy(), copy.deepcopy() and pickle copy the whole state: the copy continues with the same bits. Functions of
    watch_steps() are not copied."""

    __slots__ = ("__weakref__", "_core", "_doubts", "_materials", "_mesh_arrays", "_watch")

    def __init__(self, settings: Settings | None = None, /, **changes: Unpack[SettingsChanges]) -> None:
        self._hold(_core.World(dataclasses.replace(settings or Settings(), **changes)))

    def _hold(self, core: Any) -> None:
        self._core = core
        self._watch: Callable[[StepReport], object] | None = None
        self._doubts: set[tuple[str, ...]] = set()
        self._materials: dict[Material, Any] = {}
        self._mesh_arrays: dict[Any, tuple[Indices, Indices]] = {}

    @classmethod
    def _of(cls, core: Any) -> World:
        world = cls.__new__(cls)
        world._hold(core)
        return world

    # Copies and files.

    def copy(self, *, threads: int | None = None) -> World:
        """A copy that continues with the same bits, by default with as many threads. copy.bodies[body] is the copy of a
        body."""
        return World._of(self._core.clone(threads))

    def to_bytes(self) -> bytes:
        """The bytes that save() writes."""
        data: bytes = self._core.to_bytes()
        return data

    @staticmethod
    def from_bytes(data: bytes, *, threads: int | None = None) -> World:
        """Makes a world of the bytes of to_bytes()."""
        return World._of(_core.World.from_bytes(data, threads))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Saves the world. An existing file is replaced completely or not at all."""
        self._core.save(os.fspath(path))

    @staticmethod
    def load(path: str | os.PathLike[str], *, threads: int | None = None) -> World:
        """Reads a world that save() wrote. It continues with the same bits on any number of threads."""
        return World._of(_core.World.load(os.fspath(path), threads))

    def __copy__(self) -> World:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> World:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return (World.from_bytes, (self.to_bytes(),))

    # Building.

    def add_material(self, material: Material | None = None, /, **changes: Unpack[MaterialChanges]) -> MaterialHandle:
        """Adds a material: add_material(Material(density=900)) or add_material(density=900). SceneError: a value is out
        of range."""
        return MaterialHandle(self, self._core.add_material(dataclasses.replace(material or Material(), **changes)))

    def add_body(
        self,
        mesh: Any,
        material: Material | MaterialHandle,
        *,
        materials: Mapping[int, Material | MaterialHandle] | None = None,
        position: VectorLike = (0.0, 0.0, 0.0),
        rotation: RotationLike = (0.0, 0.0, 0.0),
        velocity: VectorLike = (0.0, 0.0, 0.0),
        angular_velocity: VectorLike = (0.0, 0.0, 0.0),
        dynamics: Dynamics = "automatic",
        element: ElementKind = "smoothed",
        self_contact: bool = False,
        contact_distance: float | None = None,
        collision_group: int = 1,
        collision_mask: int = 0xFFFFFFFF,
        name: str | None = None,
    ) -> Body:
        """Adds a body and returns it.

        mesh: a Mesh; or a Sphere, a Capsule or a Cylinder, which are rigid and touch others with their exact shape.
        material: a handle, or a record; equal records become one material. materials: materials of the tetrahedra with
        a label. position, rotation: pose of the mesh (3,) [m, rad]. velocity, angular_velocity: of the body about its
        centre of mass (3,) [m/s, rad/s]. dynamics: "explicit", "implicit", "rigid" or "automatic", which chooses
        explicit or implicit by their costs. element: kind of the elements. self_contact: True: the body can touch
        itself. contact_distance: default 2 % of the mean edge length of the surface [m]. collision_group,
        collision_mask: see Body.set_collision_groups(). name: unique in the world, default "body N".

        SceneError: a value is out of range, or a body has this name. BufferError: arrays of views() are in use."""
        given = BodySettings(
            position=vector(position, "position"),
            rotation=_rotation(rotation),
            velocity=vector(velocity, "velocity"),
            angular_velocity=vector(angular_velocity, "angular_velocity"),
            dynamics=dynamics,
            element=element,
            self_contact=self_contact,
            contact_distance=contact_distance,
            collision_group=collision_group,
            collision_mask=collision_mask,
            name=self._new_name(name, "body", self.bodies),
        )
        if isinstance(mesh, (Sphere, Capsule, Cylinder)):
            if dynamics == "automatic":
                given.dynamics = "rigid"
            handle = self._core.add_round_body(mesh, self._material(material), given)
        else:
            by_label = {label: self._material(of_label) for label, of_label in (materials or {}).items()}
            handle = self._core.add_body(_core_mesh(mesh), self._material(material), by_label, given)
        return Body(self, handle, given.name)

    def add_collider(
        self,
        shape: Shape,
        *,
        position: VectorLike = (0.0, 0.0, 0.0),
        rotation: RotationLike = (0.0, 0.0, 0.0),
        motion: Motion | None = None,
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

        shape: a Plane, Sphere, Box, Capsule, Cylinder, Bucket or SurfaceMesh. position, rotation: pose (3,) [m, rad].
        motion: velocities, or keys, which are poses at absolute times. friction, static_friction, dynamic_friction: a
        contact uses the geometric mean of this value and that of the body, or that of the body if not given.
        restitution: a contact uses the larger value. contact_distance: thickness of the contact shell of a SurfaceMesh
        [m]. collision_group, collision_mask: see Collider.set_collision_groups(). name: unique in the world, default
        "collider N".

        SceneError: a value is out of range, or a collider has this name. BufferError: arrays of views() are in use."""
        given = ColliderSettings(
            position=vector(position, "position"),
            rotation=_rotation(rotation),
            motion=motion or Motion(),
            friction=friction,
            static_friction=static_friction,
            dynamic_friction=dynamic_friction,
            restitution=restitution,
            contact_distance=contact_distance,
            collision_group=collision_group,
            collision_mask=collision_mask,
            name=self._new_name(name, "collider", self.colliders),
        )
        return Collider(self, self._core.add_collider(shape, given), given.name)

    def add_joint(
        self,
        kind: JointKind,
        first: Body,
        second: Body | None = None,
        *,
        point: VectorLike = (0.0, 0.0, 0.0),
        axis: VectorLike = (0.0, 0.0, 1.0),
        lower: float | None = None,
        upper: float | None = None,
        motor: Motor | None = None,
        bodies_touch: bool = False,
    ) -> Joint:
        """Joins two rigid bodies, or a rigid body and the world, in their present poses, and returns the joint.

        kind: "ball", "hinge", "slider" or "fixed". point: position of the joint (3,) [m]. axis: axis of a hinge or a
        slider (3,). lower, upper: limits of its coordinate, which is 0 now [rad or m]. motor: motor on the axis.
        bodies_touch: True: the two bodies may collide. SceneError: a body is not rigid, or a value is out of range."""
        given = JointSettings(
            kind=kind,
            point=vector(point, "point"),
            axis=vector(axis, "axis"),
            lower=lower,
            upper=upper,
            motor=motor,
            bodies_touch=bodies_touch,
        )
        handle = self._core.add_joint(first._handle, None if second is None else second._handle, given)
        return self._joint(handle)

    def remove(self, removed: PosedObject | Joint) -> None:
        """Removes a body, a collider, an attachment or a joint. BufferError: arrays of views() are in use."""
        handle = removed._handle
        self._core.remove(handle)
        self._mesh_arrays.pop(handle, None)

    @property
    def bodies(self) -> Objects[Body]:
        """The bodies by name or number, in the order added."""
        return Objects(self._core, "bodies", self._body)

    @property
    def colliders(self) -> Objects[Collider]:
        """The colliders by name or number, in the order added."""
        return Objects(self._core, "colliders", self._collider)

    @property
    def joints(self) -> list[Joint]:
        """The joints in the order added."""
        return [self._joint(handle) for handle in self._core.joints()]

    # Running.

    def settle_start(self) -> None:
        """Finds overlaps of bodies and colliders that were added or moved since the last check, and treats them
        according to Settings.start_overlaps. advance() begins with this check."""
        self._core.settle_start()

    def advance(self, dt: float, *, check: Callable[[StepReport], object] | None = None) -> StepReport:
        """Advances time by dt [s], in equal steps no longer than the stable step, without the GIL.

        check: called with the report so far before each attempt at a step; if it returns False, the call ends between
        two steps with the status "stopped". Like functions of watch_steps() it may read the world, but must not change
        or advance it; an exception ends the call between two steps. So does Ctrl-C.

        StepError: a step could not be completed. SceneError: bodies overlap at the start and this is refused."""
        report = self.try_advance(dt, check=check)
        if report.status not in ("ok", "stopped"):
            raise StepError(report)
        return report

    def try_advance(self, dt: float, *, check: Callable[[StepReport], object] | None = None) -> StepReport:
        """Advances like advance(), but returns the report of a step that could not be completed."""
        values = self._core.advance(dt, self._told(check), self._told(self._watch))
        report = step_report(self, values)
        if report.warning or report.crossed or report.worst_error > _LARGEST_TRUSTED_ERROR:
            self._warn_of(report)
        return report

    def run(
        self,
        seconds: float,
        *,
        dt: float = 1 / 60,
        each: Callable[[World], object] | None = None,
        progress: bool = False,
    ) -> None:
        """Advances by `seconds` in calls of advance(dt), of which the last may be shorter.

        each: called with the world after each call; if it returns False, the run ends. progress: writes the time and
        the share of the run to the standard error output. At the end, doubts about the results become warnings."""
        if not (seconds >= 0 and math.isfinite(seconds)):
            raise SceneError(f"run: seconds: found {seconds}, expected a time >= 0 (s)", object="run", field="seconds")
        if not (dt > 0 and math.isfinite(dt)):
            raise SceneError(f"run: dt: found {dt}, expected a time > 0 (s)", object="run", field="dt")
        calls = max(1, math.ceil(seconds / dt * (1 - 1e-9)))
        for call in range(calls):
            self.advance(dt if call < calls - 1 else seconds - (calls - 1) * dt)
            if progress:
                end = "\n" if call == calls - 1 else ""
                print(f"\r{self.time:.6g} s, {100 * (call + 1) / calls:.0f} %", end=end, file=sys.stderr, flush=True)
            if each is not None and each(self) is False:
                break
        self._warn_of_run()

    def watch_steps(self, look: Callable[[StepReport], object] | None) -> None:
        """From now on calls `look` after every completed step, with the report so far, on the thread that advances.
        `look` may read the world, but must not change it. An exception ends advance() between two steps and comes out
        of it. None ends the calls."""
        self._core.require_between_steps()
        self._watch = look

    @contextmanager
    def trace(self, path: str | os.PathLike[str]) -> Iterator[None]:
        """Records the activity of every worker, and writes it in the Trace Event Format, which Perfetto opens:

            with world.trace("trace.json"):
                world.advance(0.1)
        """
        self._core.set_tracing(True)
        try:
            yield
        finally:
            self._core.set_tracing(False)
            with open(path, "w", encoding="utf-8") as file:
                file.write(self._core.trace_text())

    def step_graph(self) -> str:
        """The stages of the step and their dependencies, in the dot language of Graphviz."""
        return str(self._core.step_graph())

    # State.

    @property
    def time(self) -> float:
        """Time [s]."""
        return float(self._core.time())

    @property
    def settings(self) -> Settings:
        """Settings of the world."""
        return Settings(**self._core.settings())

    @property
    def stable_step(self) -> float:
        """Stable step of the stiffest body, which is the longest step that advance() takes [s]."""
        return float(self._core.stable_step())

    @property
    def energy(self) -> Energy:
        """Energies of the world."""
        return Energy(**self._core.energy())

    @property
    def state_hash(self) -> int:
        """Hash of all data on which the next step depends, equal for any number of threads."""
        return int(self._core.state_hash())

    def report(self) -> WorldReport:
        """Sums and maxima of the run, and measures of the present state."""
        return world_report(self, self._core.report())

    # Control.

    def set_gravity(self, gravity: VectorLike) -> None:
        """Sets the acceleration of all bodies, shape (3,) [m/s^2]."""
        self._core.set_gravity(real_array(gravity, "gravity", (3,)))

    def set_collision(self, first: Body | Collider, second: Body | Collider, on: bool) -> None:
        """Switches the collision of two bodies, or of a body and a collider, on or off. For a body with itself it sets
        its self-contact."""
        self._core.set_collision(*_body_first(first, second), on)

    def may_collide(self, first: Body | Collider, second: Body | Collider) -> bool:
        """True if the collision groups and set_collision() let the two objects collide."""
        return bool(self._core.may_collide(*_body_first(first, second)))

    def reset(self, saved: World | None = None) -> None:
        """Puts all bodies back into their rest shapes at their first poses. Time, colliders, attachments and loads do
        not change. With `saved`, a copy of this world: continues from the state of the copy; objects that were added
        after copying are removed. BufferError: arrays of views() are in use."""
        if saved is None:
            self._core.reset()
            return
        self._core.reset_to(saved._core)
        self._mesh_arrays.clear()
        self._materials.clear()

    # Helpers.

    def _body(self, handle: Any, name: str | None = None) -> Body:
        return Body(self, handle, self._core.name(handle) if name is None else name)

    def _collider(self, handle: Any, name: str | None = None) -> Collider:
        return Collider(self, handle, self._core.name(handle) if name is None else name)

    def _joint(self, handle: Any) -> Joint:
        state = self._core.joint_state(handle)
        second = state["second"]
        label = joint_label(
            state["kind"], self._core.name(state["first"]), None if second is None else self._core.name(second)
        )
        return Joint(self, handle, label)

    def _mesh_of(self, body: Any) -> tuple[Indices, Indices]:
        """Surface and tetrahedra of a body, which never change."""
        arrays = self._mesh_arrays.get(body)
        if arrays is None:
            arrays = (read_only(self._core.surface(body)), read_only(self._core.tetrahedra(body)))
            self._mesh_arrays[body] = arrays
        return arrays

    def _material(self, material: Material | MaterialHandle) -> Any:
        if isinstance(material, MaterialHandle):
            return material._handle
        if not isinstance(material, Material):
            raise TypeError(f"material: found {material!r}, expected a Material or a MaterialHandle")
        if material not in self._materials:
            self._materials[material] = self.add_material(material)._handle
        return self._materials[material]

    def _forget_material(self, changed: Any) -> None:
        """Must be called after a material was changed: its record no longer stands for it."""
        self._materials = {record: handle for record, handle in self._materials.items() if handle != changed}

    def _new_name(self, name: str | None, kind: str, objects: Objects[Any]) -> str:
        if name is None:
            number = len(objects)
            while (free := f"{kind} {number}") in objects:
                number += 1
            return free
        if name in objects:
            raise SceneError(
                f"{kind} '{name}': name: found the name of another {kind}, expected a new name",
                object=f"{kind} '{name}'",
                field="name",
                found=f"the name of another {kind}",
                expected="a new name",
            )
        return name

    def _told(self, look: Callable[[StepReport], object] | None) -> Callable[[dict[str, Any]], bool] | None:
        """A function for the extension module that calls `look` with a report."""
        if look is None:
            return None
        return lambda values: look(step_report(self, values)) is not False

    def _warn_of(self, report: StepReport) -> None:
        """Warns of doubts about the steps of a call."""
        if report.warning:
            self._warn(report.warning, "step", report.limited_by, report.inverted_name)
        if report.crossed or report.worst_error > _LARGEST_TRUSTED_ERROR:
            crossed = "crossed" if report.crossed else ""
            wrong = "error" if report.worst_error > _LARGEST_TRUSTED_ERROR else ""
            if ("distrust", crossed, wrong) not in self._doubts:
                self._warn(self.report().distrust, "distrust", crossed, wrong)

    def _warn_of_run(self) -> None:
        """Warns of doubts that only a report of the world shows."""
        for crossing in self.report().self_crossings:
            self._warn(crossing.message, "self_crossing", crossing.name)

    def _warn(self, text: str, *cause: str) -> None:
        """Warns once for each cause."""
        if text and cause not in self._doubts:
            self._doubts.add(cause)
            warnings.warn(text, Doubt, stacklevel=_frames_of_package())

    def __repr__(self) -> str:
        return (
            f"<skerry.World at {self.time:.6g} s, {len(self.bodies):,} bodies, {len(self.colliders):,} colliders, "
            f"{len(self._core.joints()):,} joints>"
        )

    def _repr_html_(self) -> str:
        return world_table(self)


def _rotation(given: RotationLike) -> tuple[float, float, float]:
    return rotation(given, "rotation")


def _core_mesh(mesh: Any) -> Any:
    """Mesh of the extension module."""
    return getattr(mesh, "_core", mesh)


def _body_first(first: WorldObject, second: WorldObject) -> tuple[Any, Any]:
    """Handles of a body and of a body or a collider, in this order."""
    if isinstance(first, Collider):
        first, second = second, first
    if not isinstance(first, Body):
        raise TypeError("set_collision: found two colliders, expected at least one body")
    return first._handle, second._handle


def _frames_of_package() -> int:
    """Number of frames from _warn() up to the caller of the package, as warnings.warn() counts them."""
    folder = os.path.dirname(os.path.dirname(__file__)) + os.sep
    frame, count = sys._getframe(1), 1
    while frame.f_back is not None and os.path.abspath(frame.f_code.co_filename).startswith(folder):
        frame, count = frame.f_back, count + 1
    return count
