"""The world."""

from __future__ import annotations

import atexit
import dataclasses
import functools
import math
import os
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from html import escape
from typing import Any, Self, Unpack

import numpy as np

from .. import _core
from .._arrays import RotationLike, VectorLike, checked, flag, is_false, name_text, real, real_array, vector, whole
from .._arrays import rotation as rotation_vector
from .._arrays import seconds as checked_seconds
from .._errors import BusyError, Doubt, StepError, scene_error
from .._recorder import WorldOutput
from .._results import WorldResults
from .._robot import Frame, PlacedRobot, Robot, load_robot, plan_robot
from .._robot import add_robot as add_planned_robot
from .._robot.description import turn
from .._settings import Backend, Material, Settings
from .body import Body
from .building import Arguments
from .changes import SettingsChanges
from .collider import Collider
from .fibre import WorldFibres
from .load import WorldLoads
from .material import MaterialHandle
from .objects import WorldObject
from .page import world_table
from .relax import RelaxReport
from .reports import Energy, StepReport, WorldReport, step_report, world_report
from .surface import SurfaceRules

if hasattr(os, "register_at_fork"):
    # A fork copies no threads. Worlds in the new process would wait for ever for their threads.
    os.register_at_fork(after_in_child=_core.note_fork)


@atexit.register
def _end_calls() -> None:
    """Ends calls of the extension module in daemon threads, which would abort the process after the end of Python."""
    latest = time.monotonic() + 10  # waits at most 10 s, because a callback may never return
    while _core.end_calls() and time.monotonic() < latest:
        time.sleep(1e-3)
    if threading.active_count() > 1:  # objects of a thread that still runs are no leaks
        _core.hide_leaks()


_LARGEST_TRUSTED_ERROR = 0.5
"""Solver error of a region above which World.advance() warns, as WorldReport.distrust does."""


_MOST_CALLS = 2**53
"""Largest number of calls of advance() in a run. Beyond it, numbers of type float cannot count the calls exactly."""


class World(SurfaceRules, WorldFibres, WorldLoads, WorldResults, WorldOutput):
    """A simulation of deformable and rigid bodies in frictional contact. All units are SI units.

    World() has the default settings, World(settings) the given ones; keywords change single settings:
    World(gravity=(0, 0, 0), threads=1).

    One thread at a time may use a world; a call from another thread raises BusyError. Different worlds are independent.
    copy.copy(), copy.deepcopy() and pickle copy the whole state: the copy continues bitwise like the world. Functions
    of watch_steps() are not copied. A copy has the class of the world; its __init__() is not called, and attributes
    that a subclass adds are not copied."""

    __slots__ = ()

    def __init__(self, settings: Settings | None = None, /, **changes: Unpack[SettingsChanges]) -> None:
        given = checked(settings or Settings(), "settings", Settings)
        self._hold(_core.World(dataclasses.replace(given, **changes)))

    def __init_subclass__(cls) -> None:
        """Makes the __init__() of a subclass raise AttributeError if it did not call World.__init__()."""
        super().__init_subclass__()
        made: Callable[..., None] | None = cls.__dict__.get("__init__")
        if made is None:
            return

        @functools.wraps(made)
        def make(self: World, *given: Any, **named: Any) -> None:
            made(self, *given, **named)
            if not hasattr(self, "_core"):
                raise AttributeError(f"{cls.__name__}: __init__() did not call super().__init__()")

        cls.__init__ = make  # type: ignore[method-assign]

    @classmethod
    def _of(cls, core: Any) -> Self:
        world = cls.__new__(cls)
        world._hold(core)
        return world

    # Copies and files.

    def copy(self, *, threads: int | None = None, backend: Backend | None = None) -> Self:
        """A copy that continues bitwise like this world, with any number of threads; default: the threads and backend
        of this world. body.in_copy(copy) is the body in the copy that corresponds to `body`."""
        return self._of(self._core.clone(Arguments(of="copy", threads=threads, backend=backend)))

    def to_bytes(self) -> bytes:
        """The bytes that save() writes."""
        data: bytes = self._core.to_bytes()
        return data

    @classmethod
    def from_bytes(
        cls, data: bytes | bytearray | memoryview, *, threads: int | None = None, backend: Backend | None = None
    ) -> Self:
        """Makes a world from the result of to_bytes()."""
        given = bytes(checked(data, "data", bytes, bytearray, memoryview))
        return cls._of(_core.World.from_bytes(given, Arguments(of="from_bytes", threads=threads, backend=backend)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Saves the world. An existing file is replaced completely or not at all."""
        self._core.save(os.fspath(path))

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, threads: int | None = None, backend: Backend | None = None) -> Self:
        """Reads a world that save() wrote. It continues bitwise like the saved world, with any number of threads."""
        return cls._of(_core.World.load(os.fspath(path), Arguments(of="load", threads=threads, backend=backend)))

    def __copy__(self) -> Self:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self).from_bytes, (self.to_bytes(),))

    # Robots.

    def add_robot(
        self,
        robot: Robot | str | os.PathLike[str],
        *,
        material: Material | MaterialHandle | None = None,
        position: VectorLike = (0.0, 0.0, 0.0),
        rotation: RotationLike = (0.0, 0.0, 0.0),
        coordinates: Mapping[str, float] | None = None,
        fixed: bool | None = None,
        motors: bool = True,
        self_collision: bool = True,
        name: str | None = None,
    ) -> PlacedRobot:
        """Adds the rigid bodies and joints of a robot. If one of them is refused, none is added.

        robot: result of load_robot(), or path of a file that load_robot() reads.
        material: material of the surfaces.
        position, rotation: pose of the robot (3,) [m, rad].
        coordinates: coordinates of joints by name; default: RobotJoint.rest, or the nearest value within the limits
            [rad or m].
        fixed: True: the base does not move; False: it is free; None: as in the file.
        motors: True: motors start with their joint's coordinate, or with the speed or force 0, as target. False: no
            motors.
        self_collision: False: links do not collide with each other. True: they do, except links that a joint connects
            and pairs that the file excludes.
        name: NAME in the names NAME/LINK of bodies and NAME/JOINT of joints; default: the name of the robot.

        SceneError: the file has an error, a value is out of range, or another body already has one of the names."""
        given = robot if isinstance(robot, Robot) else load_robot(robot)
        place = Frame(np.array(vector(position, "position")), turn(rotation_vector(rotation, "rotation")))
        return add_planned_robot(
            self,
            given,
            plan_robot(given, place, coordinates, fixed=fixed, motors=flag(motors, "motors")),
            material=Material() if material is None else material,
            self_collision=flag(self_collision, "self_collision"),
            name=given.name if name is None else name_text(name, "name"),
        )

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
        dt = checked_seconds(dt, "advance", "dt")
        followers = () if self._advancing else tuple(self._followers)  # a nested call is refused and takes no step
        for follower in followers:
            follower.require_ready()
        nested, self._advancing = self._advancing, True
        try:
            values = self._core.advance(dt, self._with_report(check), self._watch, self._take, self._take_every)
        finally:
            self._advancing = nested
            for follower in followers:
                follower.follow()
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
        """Advances by `seconds` in calls of advance(dt), the last of which may be shorter. At the end, warns of
        self-crossings of bodies.

        each: called with the world after each call of advance(); if it returns False, the run ends.
        progress: True: writes the time and the completed share of the run to the standard error output."""
        seconds = checked_seconds(seconds, "run", "seconds")
        dt = checked_seconds(dt, "run", "dt", zero=False)
        if seconds / dt > _MOST_CALLS:
            raise scene_error("run", "dt", str(dt), f"a time >= {seconds / _MOST_CALLS:.3g} [s]")
        calls = max(1, math.ceil(seconds / dt * (1 - 1e-9)))
        for call in range(calls):
            self.advance(dt if call < calls - 1 else seconds - (calls - 1) * dt)
            if progress:
                end = "\n" if call == calls - 1 else ""
                line = f"{self.time:.6g} s, {100 * (call + 1) / calls:.0f} %"
                print(f"\r{line:<20}", end=end, file=sys.stderr, flush=True)
            if each is not None and is_false(each(self)):
                break
        self._warn_of_run()

    def relax(self, *, tolerance: float = 1e-3, max_steps: int = 100_000, load_steps: int = 1) -> RelaxReport:
        """Moves the bodies to a static equilibrium, in which no body has a velocity, by steps with kinetic damping.
        Time does not advance: loads and motions stay at their present values. If there is no equilibrium, for example
        because a body slides, the world does not change.

        tolerance: largest out-of-balance force of a body, relative to the sum of the forces that act on it.
        max_steps: largest number of steps for each load step.
        load_steps: if > 1, loads, pressures and tensions grow from zero in this number of steps, which are halved where
            no equilibrium is found.
        BufferError: arrays of views() are in use."""
        values = self._core.relax(
            real(tolerance, "tolerance"), whole(max_steps, "max_steps"), whole(load_steps, "load_steps")
        )
        if values["worst"] is not None:
            values["worst"] = self._body(values["worst"])
        return RelaxReport(**values)

    def watch_steps(self, observe: Callable[[StepReport], object] | None) -> None:
        """From now on calls `observe` after every completed step, with the report so far, on the thread that advances.
        `observe` may read the world, but must not change it. If it raises an exception, advance() ends between two
        steps and raises it again. None ends the calls."""
        self._core.require_between_steps()
        if observe is not None and not callable(observe):
            raise TypeError(f"observe: found {observe!r}, expected a function")
        self._watch = self._with_report(observe)

    @contextmanager
    def trace(self, path: str | os.PathLike[str]) -> Iterator[None]:
        """Records the activity of every worker in the `with` block as a Trace Event file, which Perfetto opens:

        with world.trace("trace.json"):
            world.advance(0.1)
        """
        with open(path, "w", encoding="utf-8") as file:
            self._core.set_tracing(True)
            try:
                yield
            finally:
                self._core.set_tracing(False)
                file.write(self._core.trace_text())

    def step_graph(self) -> str:
        """The stages of the step and their dependencies, in the dot language of Graphviz."""
        return str(self._core.step_graph())

    # State.

    @property
    def time(self) -> float:
        """Simulated time since the world was made [s]."""
        return float(self._core.time())

    @property
    def settings(self) -> Settings:
        """Settings of the world."""
        return Settings(**self._core.settings())

    @property
    def stable_step(self) -> float:
        """Stable step of the stiffest body, the longest step that advance() takes [s]. If all bodies are rigid or
        implicit: the step that advance() uses."""
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
        """Sets the acceleration by gravity, shape (3,) [m/s^2]."""
        self._core.set_gravity(real_array(gravity, "gravity", (3,)))

    def set_collision(self, first: Body | Collider, second: Body | Collider, on: bool) -> None:
        """Switches the collision of two bodies, or of a body and a collider, on or off. For a body with itself it sets
        its self-contact."""
        self._core.set_collision(*self._body_first(first, second), flag(on, "on"))

    def may_collide(self, first: Body | Collider, second: Body | Collider) -> bool:
        """True if the collision groups and set_collision() let the two objects collide."""
        return bool(self._core.may_collide(*self._body_first(first, second)))

    def reset(self, saved: World | None = None) -> None:
        """Puts all bodies back into their rest shapes at their first poses. Time, colliders, attachments and loads do
        not change. If `saved`, a copy of this world, is given, the world returns to the state of the copy; objects that
        were added after copying are removed. BufferError: arrays of views() are in use. SceneError: a recorder is in
        its `with` block, and `saved` is given: the recorder could not continue at another time."""
        if saved is None:
            self._core.reset()
            return
        checked(saved, "saved", World)
        for follower in self._followers:
            follower.require_no_jump()
        self._core.reset_to(saved._core)
        self._forget_objects()

    # Helpers.

    def _forget_objects(self) -> None:
        """Empties the caches after the world went back to an earlier state, in which other objects may exist."""
        self._mesh_arrays.clear()
        self._materials.clear()

    def _body_first(self, first: WorldObject, second: WorldObject) -> tuple[Any, Any]:
        """Handles of two objects, at least one of them a body, in an order with a body first."""
        if isinstance(first, Collider):
            first, second = second, first
        return self._own(first, "one of two objects", Body), self._own(second, "second", Body, Collider)

    def _with_report(self, observe: Callable[[StepReport], object] | None) -> Callable[[dict[str, Any]], bool] | None:
        """Function for the extension module that converts a dictionary to a StepReport and calls `observe` with it."""
        if observe is None:
            return None
        return lambda values: not is_false(observe(step_report(self, values)))

    def _warn_of(self, report: StepReport) -> None:
        """Warns if the steps of a call of advance() give reason to doubt the results."""
        if report.warning:
            self._warn(report.warning, "step", report.limited_by, report.inverted_name)
        if report.crossed or report.worst_error > _LARGEST_TRUSTED_ERROR:
            crossed = "crossed" if report.crossed else ""
            wrong = "error" if report.worst_error > _LARGEST_TRUSTED_ERROR else ""
            if ("distrust", crossed, wrong) not in self._doubts:
                self._warn(self.report().distrust, "distrust", crossed, wrong)

    def _warn_of_run(self) -> None:
        """Warns of self-crossings, which reports of steps do not contain."""
        for crossing in self.report().self_crossings:
            self._warn(crossing.message, "self_crossing", crossing.name)

    def _warn(self, text: str, *cause: str) -> None:
        """Warns with `text`, but only once for each cause."""
        if cause in self._doubts:
            return
        self._doubts.add(cause)
        if text:
            warnings.warn(text, Doubt, stacklevel=_frames_of_package())

    def __repr__(self) -> str:
        try:
            return (
                f"<skerry.World at {self.time:.6g} s, {len(self.bodies):,} bodies, {len(self.colliders):,} colliders, "
                f"{len(self._core.joints()):,} joints>"
            )
        except BusyError:
            return "<skerry.World in use by another thread>"

    def _repr_html_(self) -> str:
        try:
            return world_table(self)
        except BusyError:
            return escape(repr(self))


_SETTINGS_TEXT = (Settings.__doc__ or "").partition("\n\n")[2]
World.__init__.__doc__ = f"Makes an empty world. The keywords are the fields of Settings.\n\n{_SETTINGS_TEXT}"


def _frames_of_package() -> int:
    """Argument `stacklevel` of warnings.warn() in _warn(): the warning then names the line that called the package."""
    folder = os.path.dirname(os.path.dirname(__file__)) + os.sep
    frame, count = sys._getframe(1), 1
    while frame.f_back is not None and os.path.abspath(frame.f_code.co_filename).startswith(folder):
        frame, count = frame.f_back, count + 1
    return count
