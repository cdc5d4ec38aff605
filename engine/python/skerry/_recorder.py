"""Time series of probes, and frames of a run: tables, pages and files for ParaView."""

from __future__ import annotations

import html
import math
import os
import pathlib
import shutil
import tempfile
import weakref
import webbrowser
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Protocol, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import Reals, name_text, path_text, real, seconds
from ._errors import scene_error

if TYPE_CHECKING:
    from types import TracebackType

    from ._settings import FilmColor
    from ._world import World
    from ._world.probes import Probe

Path: TypeAlias = str | os.PathLike[str]

_SLACK = 1e-9  # rounding error of a time, as a fraction of the time between two frames


class Follower(Protocol):
    """An object that follows the run of a world: the world calls its methods within a `with` block."""

    def require_ready(self) -> None:
        """Called before each call of advance(). Raises SceneError if follow() would fail after that call."""

    def follow(self) -> None:
        """Called after each call of advance(), also after one that ends with an exception."""

    def require_no_jump(self) -> None:
        """Called before the world continues from another state. Raises SceneError if it must not."""


class _Block(Follower):
    """A follower that the world calls in the `with` block of the follower itself."""

    __slots__ = ("_world",)
    _world: World

    def __enter__(self) -> Self:
        self._begin()
        self._world._followers.append(self)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._world._followers.remove(self)
        self._end()

    def _begin(self) -> None:
        """Called at the start of the block."""

    def _end(self) -> None:
        """Called at the end of the block."""


class Recorder(_Block):
    """Records time series of a world. World.recorder() makes it. In a `with` block it samples by itself after every
    call of advance(); otherwise call sample()."""

    __slots__ = ("_core", "_handles", "_measures")

    def __init__(self, world: World, probes: Mapping[str, Probe], every: float) -> None:
        from ._world.probes import ForceProbe, ReactionProbe, recorded_probes

        given = recorded_probes(probes, world)
        self._world = world
        self._core = _core.Recorder(world._core, given, seconds(every, "recorder", "every"))
        kinds = (
            _core.BodyHandle,
            _core.ColliderHandle,
            _core.AttachmentHandle,
            _core.JointHandle,
            _core.CableHandle,
            _core.CavityHandle,
            _core.SpringHandle,
        )
        self._handles = [
            (name, value)
            for name, probe in zip(probes, given, strict=True)
            for value in probe.values[1].values()
            if isinstance(value, kinds)
        ]
        self._measures = any(isinstance(probe, (ForceProbe, ReactionProbe)) for probe in probes.values())

    def require_ready(self) -> None:
        """Raises SceneError if the next sample would fail."""
        for name, handle in self._handles:
            if not self._world._core.alive(handle):
                raise scene_error(
                    f"recorder: probe '{name}'",
                    "",
                    "an object that was removed",
                    "an object of the world",
                    "leave the `with` block before you remove a recorded object",
                )
        if self._measures and not self._world.measures_forces:
            raise scene_error("recorder", "measures_forces", "False", "True, because a probe records forces")

    def _names(self) -> list[str]:
        return list(dict.fromkeys(probe for probe, *_ in self._core.columns() if probe))

    def follow(self) -> None:
        """Takes a sample. The world calls it in the `with` block."""
        self.sample()

    def require_no_jump(self) -> None:
        """Raises SceneError, because the rows are in the order of time."""
        raise scene_error(
            "reset",
            "saved",
            f"a recorder of {', '.join(repr(name) for name in self._names())} in its `with` block",
            "no active recorder",
            "leave the `with` block before reset(saved), and make another recorder after it",
        )

    def sample(self) -> None:
        """Takes a sample, which becomes a row if it is due. Must be called after every call of advance(), so that no
        impulse is missed. A call before the first step records the initial state, with NaN as forces."""
        self._core.sample(self._world._core)

    def _begin(self) -> None:
        self.sample()

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


class ErrorEstimator(_Block):
    """Estimates errors of the bodies of a world. World.error_estimator() makes it. It samples in a `with` block, which
    takes about 1.5 % of the computing time of the steps, and never changes the world."""

    __slots__ = ("_core",)

    def __init__(self, world: World) -> None:
        self._world = world
        self._core = _core.ErrorEstimator(world._core)

    def require_ready(self) -> None:
        """Does nothing, because a sample can be taken at any time."""

    def require_no_jump(self) -> None:
        """Raises SceneError, because errors are those since the start of the `with` block."""
        raise scene_error(
            "reset",
            "saved",
            "an error estimator in its `with` block",
            "no active error estimator",
            "leave the `with` block before reset(saved), and make another estimator after it",
        )

    def follow(self) -> None:
        """Takes a sample if it is due. The world calls it in the `with` block."""
        self._core.sample(self._world._core)

    def _end(self) -> None:
        self._core.finish(self._world._core)

    def table(self) -> dict[str, list[str] | NDArray[np.generic]]:
        """Estimates at the end of the `with` block by column, with one row for each body; NaN if not estimated.
        pandas.DataFrame(errors.table()) is a data frame.

        body: its name. mesh: relative error of the stress of the tetrahedra in the energy norm, due to the mesh.
        deflection: relative error of a displacement under given loads, due to the mesh; positive if the mesh is too
        stiff. interpolation: error of single nodes besides deflection [m]. stress: relative error of the largest von
        Mises stress at the nodes. step: relative error of the motion, due to the length of the steps. deformation:
        displacement by deformation over displacement. contact: relative error of the contact forces, due to the solver.
        overlap: largest overlap [m]. gap: largest distance of a contact that carried a force [m]. contact_radius,
        contact_edge: radius of the most loaded contact area by the theory of Hertz, and mean edge there [m]. time: of
        the sample with the largest elastic energy [s]. worst_tetrahedron: the one with the largest error of the stress,
        or -1."""
        table: dict[str, list[str] | NDArray[np.generic]] = self._core.table()
        return table


class _Frames:
    """Calls `add` at the start, at multiples of `every` [s], and at the end if the last call was earlier."""

    def __init__(self, world: World, every: float, add: Callable[[], None]) -> None:
        self._world, self._every, self._add = world, every, add
        self._last = -math.inf
        self._failed = False
        self._take()
        world._followers.append(self)

    def end(self) -> bool:
        """Adds the last frame. False: an earlier frame raised an error, so no frame can be added."""
        self._world._followers.remove(self)
        if self._world.time > self._last and not self._failed:
            self._take()
        return not self._failed

    def _take(self) -> None:
        self._failed = True
        self._add()
        self._failed = False
        self._last = self._world.time

    def require_ready(self) -> None:
        """Does nothing, because a frame can be added at any time."""

    def require_no_jump(self) -> None:
        """Frames may go back in time."""

    def follow(self) -> None:
        if self._every == 0 or self._number(self._world.time) > self._number(self._last):
            self._take()

    def _number(self, time: float) -> int:
        return math.floor(time / self._every + _SLACK)


class Page:
    """A page that plays a run in a browser, without a network. Notebooks show it as the last line of a cell; a program
    calls open()."""

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

    def open(self, path: Path | None = None) -> None:
        """Writes the page to a file and opens it in the default browser. path: default: a new file in the folder for
        temporary files, which stays there. RuntimeError: the system has no browser."""
        if path is None:
            number, path = tempfile.mkstemp(prefix="skerry", suffix=".html")
            os.close(number)
        self.save(path)
        if not webbrowser.open(pathlib.Path(path).absolute().as_uri()):
            raise RuntimeError(f"page: found no browser to open it, expected one; the page is in {os.fspath(path)}")

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html.escape(self._html)}" width="100%" height="{self._height}" '
            'style="border: 0" allow="fullscreen" allowfullscreen></iframe>'
        )

    def __repr__(self) -> str:
        return f"<skerry.Page, {len(self._html) / 1e6:.1f} MB; open() shows it, save(path) writes it>"


class Film:
    """Collects frames of a run for a page, in a `with` block. World.record() makes it:

        with world.record() as film:
            world.run(2)
        film.show()  # in a notebook
        film.save("run.html")

    Frames are kept in the compressed form of the page."""

    __slots__ = (
        "__weakref__",
        "_count",
        "_every",
        "_file",
        "_frames",
        "_page",
        "_remove_folder",
        "_title",
        "_world",
        "_writer",
    )

    def __init__(self, world: World, title: str, every: float) -> None:
        self._world, self._title, self._every = world, title, seconds(every, "record", "every")
        self._page: str | None = None
        self._frames: _Frames | None = None
        self._count = 0

    def _begin(self) -> None:
        if self._frames is not None:
            raise RuntimeError("film: found a film that was already recorded, expected a new one of World.record()")
        folder = tempfile.mkdtemp(prefix="skerry")
        self._remove_folder = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self._file = os.path.join(folder, "page.html")
        try:
            self._writer: Any = _core.PageWriter(self._file, self._title)
            self._frames = _Frames(self._world, self._every, self._add)
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
        if self._frames is None:
            raise RuntimeError("film: found no frames, expected a `with` block: with world.record() as film: ...")
        try:
            self._frames.end()
            self._writer.close(self._world._core)
            with open(self._file, encoding="utf-8") as file:
                self._page = file.read()
        finally:
            self._remove_folder()
            self._writer = None

    def show(self, *, height: int = 560) -> Page:
        """The page, which a notebook shows and Page.open() opens. Ends the film.

        height: height in a notebook [pixels]."""
        self.close()
        return Page(self._page or "", height)

    def save(self, path: Path) -> None:
        """Writes the page to a file. Ends the film."""
        self.show().save(path)

    def __len__(self) -> int:
        return self._count

    def __enter__(self) -> Film:
        self._begin()
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

        probes: probes by the name that heads their columns.
        every: time between rows; 0: one row for each call of advance() [s]. Probes of forces switch on
            World.measure_forces().
        SceneError: a probe or a name is wrong."""
        return Recorder(self, probes, every)  # type: ignore[arg-type]

    def error_estimator(self) -> ErrorEstimator:
        """Estimates the errors due to mesh, steps and contacts:

            with world.error_estimator() as errors:
                world.run(2)
            errors.table()["deflection"]

        ErrorEstimator.table() describes the columns."""
        return ErrorEstimator(self)  # type: ignore[arg-type]

    def record(self, *, every: float = 1 / 60, title: str = "skerry") -> Film:
        """Records a film, which starts and ends with a `with` block, see class Film. every: time between frames; 0: one
        frame for each call of advance() [s]."""
        return Film(self, title, every)  # type: ignore[arg-type]

    def show(self, *, title: str = "skerry", height: int = 560) -> Page:
        """The present state as a page: a notebook shows it, and `world.show().open()` opens it in a browser. See view()
        for a page that follows the world. title: heading. height: height in a notebook [pixels]."""
        with self.record(title=title) as film:
            pass
        return film.show(height=height)

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
        frames = _Frames(world, seconds(every, "vtk", "every"), lambda: writer.add_frame(world._core))
        try:
            yield
        finally:
            frames.end()
            writer.close()

    @contextmanager
    def usd(
        self, path: Path, *, every: float = 1 / 60, color: FilmColor = "none", color_max: float | None = None
    ) -> Iterator[None]:
        """Writes a film in a `with` block, which Blender, Houdini and other programs open: a USD file (.usd or .usdc)
        with a mesh for each body and each collider. every: time between frames [s]. color: quantity that the vertices
        show, von Mises stress [Pa], speed [m/s] or contact pressure [Pa]; it is also a number at each vertex.
        color_max: value at the upper end of the colours, which begin at zero; default: 99 % of the values are below it.

        SceneError: the file cannot be written, or the world went back in time."""
        world: World = self  # type: ignore[assignment]
        step = seconds(every, "usd", "every", zero=False)
        top = None if color_max is None else real(color_max, "color_max")
        writer = _core.FilmWriter(path_text(path, "path"), step, name_text(color, "color"), top)
        frames = _Frames(world, step, lambda: writer.add_frame(world._core))
        try:
            yield
        finally:
            if frames.end():
                writer.close()

    def gltf(self, path: Path, *, color: FilmColor = "none", color_max: float | None = None) -> None:
        """Writes the present state to a binary glTF file (.glb), with the colours of usd()."""
        world: World = self  # type: ignore[assignment]
        top = None if color_max is None else real(color_max, "color_max")
        _core.write_gltf(world._core, path_text(path, "path"), name_text(color, "color"), top)
