"""Time series of probes, and frames of a run: tables, pages and files for ParaView."""

from __future__ import annotations

import html
import math
import os
import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Vector, VectorLike, index_array, path_text, real_array
from ._settings import Field, held

if TYPE_CHECKING:
    from types import TracebackType

    from ._world import Body, Collider, Joint, World
    from ._world.objects import MovedObject, PosedObject

Path: TypeAlias = str | os.PathLike[str]
Reals: TypeAlias = NDArray[np.float64]

_SLACK = 1e-9  # rounding error of a time, as a fraction of the time between two frames


@dataclass(frozen=True, slots=True)
class PointProbe:
    """Position, displacement and velocity of a point of a body, which Body.probe() finds.

    body: body of the point.
    node: nodes between which the point lies; -1 where the weight is 0.
    weight: weight of each of these nodes.
    origin: position from which the displacement is measured [m]; None: the position when the recorder is made.
    """

    body: Body
    _: KW_ONLY
    node: tuple[int, int, int, int]
    weight: tuple[float, float, float, float]
    origin: Vector | None = None

    def __post_init__(self) -> None:
        nodes, weights = (
            index_array(self.node, "PointProbe.node", (4,)),
            real_array(self.weight, "PointProbe.weight", (4,)),
        )
        object.__setattr__(self, "node", tuple(nodes.tolist()))
        object.__setattr__(self, "weight", tuple(weights.tolist()))


@dataclass(frozen=True, slots=True)
class BodyProbe:
    """Position, displacement and velocity of the centre of mass of a body.

    body: the body.
    origin: position from which the displacement is measured [m]; None: the position when the recorder is made.
    """

    body: Body
    _: KW_ONLY
    origin: Vector | None = None


@dataclass(frozen=True, slots=True)
class ForceProbe:
    """Contact forces on a body or a collider.

    on: object on which the forces act.
    by: only forces of this object; None: the forces of all contacts.
    """

    on: Body | Collider
    by: Body | Collider | None = None


@dataclass(frozen=True, slots=True)
class ReactionProbe:
    """Force of an attachment on its body.

    attachment: the attachment.
    """

    attachment: MovedObject


@dataclass(frozen=True, slots=True)
class JointProbe:
    """Force and moment of a joint, and for a hinge or slider its coordinate and its speed.

    joint: the joint.
    """

    joint: Joint


@dataclass(frozen=True, slots=True)
class EnergyProbe:
    """Kinetic, elastic, potential and dissipated energy of the world."""


@dataclass(frozen=True, slots=True)
class StressProbe:
    """Largest von Mises stress at some nodes of a body.

    body: the body.
    nodes: numbers of the nodes; none: all nodes.
    """

    body: Body
    nodes: Field[ArrayLike, tuple[int, ...]] = held(())

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", tuple(index_array(self.nodes, "StressProbe.nodes", ("j",)).tolist()))


@dataclass(frozen=True, slots=True)
class VolumeProbe:
    """Smallest ratio of present volume to rest volume among the tetrahedra of a body.

    body: the body.
    """

    body: Body


@dataclass(frozen=True, slots=True)
class PoseProbe:
    """Pose of a body, a collider or an attachment.

    object: the object.
    """

    object: PosedObject


@dataclass(frozen=True, slots=True)
class VelocityProbe:
    """Velocity and angular velocity of a body, a collider or an attachment.

    object: the object.
    """

    object: PosedObject


@dataclass(frozen=True, slots=True)
class NodesProbe:
    """Positions of all nodes of a body.

    body: the body.
    """

    body: Body


Probe: TypeAlias = (
    PointProbe
    | BodyProbe
    | ForceProbe
    | ReactionProbe
    | JointProbe
    | EnergyProbe
    | StressProbe
    | VolumeProbe
    | PoseProbe
    | VelocityProbe
    | NodesProbe
)
"""A quantity that a recorder records."""


def recorded_probes(probes: Mapping[str, Probe]) -> list[Any]:
    """Probes by name for the extension module."""
    return [_recorded(name, probe) for name, probe in probes.items()]


def _recorded(name: str, probe: Probe) -> Any:
    match probe:
        case PointProbe():
            return _core.point_probe(name, probe.body._handle, probe.node, probe.weight, probe.origin)
        case BodyProbe():
            return _core.body_probe(name, probe.body._handle, probe.origin)
        case ForceProbe():
            return _core.force_probe(name, probe.on._handle, None if probe.by is None else probe.by._handle)
        case ReactionProbe():
            return _core.reaction_probe(name, probe.attachment._handle)
        case JointProbe():
            return _core.joint_probe(name, probe.joint._handle)
        case EnergyProbe():
            return _core.energy_probe(name)
        case StressProbe():
            return _core.stress_probe(name, probe.body._handle, list(probe.nodes))
        case VolumeProbe():
            return _core.volume_probe(name, probe.body._handle)
        case PoseProbe():
            return _core.pose_probe(name, probe.object._handle)
        case VelocityProbe():
            return _core.velocity_probe(name, probe.object._handle)
        case NodesProbe():
            return _core.nodes_probe(name, probe.body._handle)
    raise TypeError(f"probe '{name}': found {probe!r}, expected a probe such as Body.probe(point) or EnergyProbe()")


def probe_of(world: World, recorded: Any) -> Probe:
    """The Python object of a probe of the extension module."""
    kind, values = recorded.values
    given = {field: _object_of(world, value) for field, value in values.items()}
    for field in ("node", "weight", "nodes"):
        if field in given:
            given[field] = tuple(given[field])
    probe: Probe = globals()[kind](**given)
    return probe


def _object_of(world: World, value: Any) -> Any:
    """The object of a handle; other values as they are."""
    from ._world.objects import MovedObject

    if isinstance(value, _core.BodyHandle):
        return world._body(value)
    if isinstance(value, _core.ColliderHandle):
        return world._collider(value)
    if isinstance(value, _core.JointHandle):
        return world._joint(value)
    return MovedObject(world, value, "attachment") if isinstance(value, _core.AttachmentHandle) else value


def point_probe(body: Body, point: VectorLike) -> PointProbe:
    """Probe for the material point that is now at `point` (3,) [m]."""
    _, values = _core.probe_point(body.world._core, body._handle, real_array(point, "point", (3,)))
    return PointProbe(body, node=tuple(values["node"]), weight=tuple(values["weight"]))


class Recorder:
    """Records time series of a world. World.recorder() makes it. In a `with` block it samples by itself after every
    call of advance(); otherwise call sample()."""

    __slots__ = ("_core", "_world")

    def __init__(self, world: World, probes: Mapping[str, Probe] | Sequence[Any], every: float) -> None:
        given = recorded_probes(probes) if isinstance(probes, Mapping) else list(probes)
        self._world = world
        self._core = _core.Recorder(world._core, given, every)

    def sample(self) -> None:
        """Takes a sample, which becomes a row if it is due. Must be called after every call of advance(), so that no
        impulse is missed. A call before the first step records the initial state, with NaN as forces."""
        self._core.sample(self._world._core)

    def __enter__(self) -> Recorder:
        self.sample()
        self._world._followers.append(self.sample)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._world._followers.remove(self.sample)

    def table(self) -> dict[str, Reals]:
        """The rows recorded so far by column: "time" and "PROBE.QUANTITY", such as "tip.position_z". Forces in a row
        cover the time since the previous row. pandas.DataFrame(recorder.table()) is a data frame."""
        rows = self._rows()
        return {name: np.ascontiguousarray(rows[:, number]) for number, name in enumerate(self.units)}

    def array(self) -> NDArray[np.void]:
        """The rows as a structured array (k,), whose fields have the names of table()."""
        rows: NDArray[np.void] = self._rows().view([(name, np.float64) for name in self.units]).reshape(-1)
        return rows

    @property
    def units(self) -> dict[str, str]:
        """SI unit of each column; "1" for counts and ratios."""
        return {f"{probe}.{quantity}" if probe else quantity: unit for probe, quantity, unit, _ in self._core.columns()}

    def to_csv(self, path: Path) -> None:
        """Writes a CSV file with headings and units, and all digits. A file is replaced completely or not at all."""
        self._core.write_csv(path_text(path, "path"))

    def to_hdf5(self, path: Path) -> None:
        """Writes an HDF5 file with a data set PROBE/QUANTITY for each column. SceneError: the package has no HDF5."""
        self._core.write_hdf5(path_text(path, "path"))

    def stream_csv(self, path: Path) -> None:
        """Writes the rows so far to a CSV file, and from now on each new row at once."""
        self._core.stream_csv(path_text(path, "path"))

    def _rows(self) -> Reals:
        rows: Reals = self._core.table().reshape(-1, len(self._core.columns()))
        return rows

    def __len__(self) -> int:
        return int(self._core.row_count())

    def __repr__(self) -> str:
        return f"<skerry.Recorder {len(self):,} rows of {len(self._core.columns()):,} columns>"


class _Frames:
    """Calls `add` at the start, at multiples of `every` [s], and at the end if the last call was earlier."""

    def __init__(self, world: World, every: float, add: Callable[[], None]) -> None:
        if not (every >= 0 and math.isfinite(every)):
            raise ValueError(f"every: found {every}, expected a time >= 0 (s)")
        self._world, self._every, self._add = world, every, add
        self._last = -math.inf
        self._take()
        world._followers.append(self._follow)

    def end(self) -> None:
        self._world._followers.remove(self._follow)
        if self._world.time > self._last:
            self._take()

    def _take(self) -> None:
        self._add()
        self._last = self._world.time

    def _follow(self) -> None:
        if self._every == 0 or self._number(self._world.time) > self._number(self._last):
            self._take()

    def _number(self, time: float) -> int:
        return math.floor(time / self._every + _SLACK)


class Page:
    """A page that plays a run in a browser, without a network. Notebooks show it."""

    __slots__ = ("_height", "_html")

    def __init__(self, text: str, height: int) -> None:
        self._html = text
        self._height = height

    @property
    def html(self) -> str:
        """Text of the page."""
        return self._html

    def save(self, path: Path) -> None:
        """Writes the page to a file."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self._html)

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html.escape(self._html)}" width="100%" height="{self._height}" '
            'style="border: 0" allow="fullscreen" allowfullscreen></iframe>'
        )

    def __repr__(self) -> str:
        return f"<skerry.Page, {len(self._html) / 1e6:.1f} MB; save(path) writes it, and notebooks show it>"


class Film:
    """Collects frames of a run for a page. World.record() makes it:

        with world.record() as film:
            world.run(2)
        film.show()  # in a notebook
        film.save("run.html")

    Frames are kept in the compressed form of the page."""

    __slots__ = ("__weakref__", "_count", "_file", "_frames", "_page", "_remove_folder", "_world", "_writer")

    def __init__(self, world: World, title: str, every: float) -> None:
        self._world = world
        self._page: str | None = None
        self._count = 0
        folder = tempfile.mkdtemp(prefix="skerry")
        self._remove_folder = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self._file = os.path.join(folder, "page.html")
        try:
            self._writer: Any = _core.PageWriter(self._file, title)
            self._frames = _Frames(world, every, self._add)
        except BaseException:
            self._remove_folder()
            raise

    def _add(self) -> None:
        self._writer.add_frame(self._world._core)
        self._count += 1

    def close(self) -> None:
        """Ends the film. The end of the `with` block does this."""
        if self._page is not None:
            return
        try:
            self._frames.end()
            self._writer.close(self._world._core)
            with open(self._file, encoding="utf-8") as file:
                self._page = file.read()
        finally:
            self._remove_folder()
            self._writer = None

    def show(self, *, height: int = 560) -> Page:
        """The page, for notebooks; `height` in pixels. Ends the film."""
        self.close()
        return Page(self._page or "", height)

    def save(self, path: Path) -> None:
        """Writes the page to a file. Ends the film."""
        self.show().save(path)

    def __len__(self) -> int:
        return self._count

    def __enter__(self) -> Film:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<skerry.Film {len(self):,} frames>"


class WorldOutput:
    """Recorders and films of class World."""

    __slots__ = ()

    def recorder(self, probes: Mapping[str, Probe], *, every: float = 0.0) -> Recorder:
        """Records time series:

            with world.recorder({"tip": body.probe((0, 0, 0.1)), "energy": skerry.EnergyProbe()}) as recorder:
                world.run(2)
            recorder.table()["tip.position_z"]

        probes: probes by the name that heads their columns. every: time between rows; 0: one row for each call of
        advance() [s]. Probes of forces switch on World.measure_forces(). SceneError: a probe or a name is wrong."""
        return Recorder(self, probes, every)  # type: ignore[arg-type]

    def record(self, *, every: float = 1 / 60, title: str = "skerry") -> Film:
        """Records a film in a `with` block, see class Film. every: time between frames; 0: one frame for each call of
        advance() [s]."""
        return Film(self, title, every)  # type: ignore[arg-type]

    def show(self, *, title: str = "skerry", height: int = 560) -> Page:
        """The present state as a page, for notebooks; `height` in pixels."""
        return self.record(title=title).show(height=height)

    @contextmanager
    def vtk(
        self, folder: Path, *, name: str = "world", every: float = 1 / 60, materials: Sequence[str] = ()
    ) -> Iterator[None]:
        """Writes frames for ParaView in a `with` block: folder/NAME.pvd lists the files of bodies, contacts and
        colliders. every: time between frames; 0: one for each call of advance() [s]. materials: names of the materials,
        in the order added."""
        world: World = self  # type: ignore[assignment]
        writer = _core.VtkWriter(path_text(folder, "folder"), name)
        if materials:
            writer.name_materials(list(materials))
        frames = _Frames(world, every, lambda: writer.add_frame(world._core))
        try:
            yield
        finally:
            frames.end()
            writer.close()
