"""Scenes: JSON files, or mappings of the same form, that describe a world and a run."""

from __future__ import annotations

import json
import math
import os
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from tempfile import NamedTemporaryFile
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import counted, path_text, real, seconds
from ._errors import Doubt, scene_error
from ._recorder import Recorder
from ._world import Body, World
from ._world.probes import Probe, probe_of

Path: TypeAlias = str | os.PathLike[str]
Json: TypeAlias = Any
"""A value of JSON: None, bool, int, float, str, a list or a mapping; NumPy arrays and numbers count as lists and
numbers."""

_SLACK = 1e-9  # rounding error when a run is divided into frames, as a fraction of a frame


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContactProbe:
    """Nodes of a body whose contacts the program `skerry run` reports, such as the feet of a table.

    name: name.
    body: body.
    nodes: numbers of the nodes, shape (j,).
    """

    name: str
    body: Body
    nodes: NDArray[np.int32]


class Slider:
    """A value of a scene that can be changed while the scene runs, as the scene key "sliders" describes it.
    Scene.sliders has them by name."""

    __slots__ = ("_core", "_world", "fastest", "high", "low", "name", "unit")

    def __init__(self, world: World, core: Any) -> None:
        self._world = world
        self._core = core
        self.name: str = core.name
        """Name."""
        self.unit: str = core.unit
        """SI unit of the value; 1 for factors."""
        self.low: float = core.low
        """Least value."""
        self.high: float = core.high
        """Greatest value."""
        self.fastest: float = core.fastest
        """Greatest change of the value in a second."""

    @property
    def value(self) -> float:
        """Present value."""
        value: float = _core.slider_value(self._world._core, self._core)
        return value

    def set(self, value: float) -> None:
        """Lets the value change to `value` steadily, at the rate `fastest`, during the next steps.

        value: from `low` to `high`.
        """
        _core.set_slider(self._world._core, self._core, real(value, "value"))


class Scene:
    """The content of a scene, with its world. load_scene() makes it."""

    __slots__ = (
        "_sliders",
        "contact_probes",
        "description",
        "frame_step",
        "materials",
        "name",
        "probe_step",
        "probes",
        "seconds",
        "sliders",
        "world",
    )

    def __init__(self, values: dict[str, Any]) -> None:
        self.world: World = World._of(values["world"])
        """World with all objects of the scene."""
        self.name: str = values["name"]
        """Name."""
        self.description: str = values["description"]
        """Description."""
        self.materials: tuple[str, ...] = tuple(values["materials"])
        """Names of the materials, in the order added."""
        self.seconds: float = values["seconds"]
        """Time at which a run ends [s]."""
        self.frame_step: float = values["frame_step"]
        """Time between two frames of output [s]."""
        self.probe_step: float = values["probe_step"]
        """Time between two rows of the probes [s]."""
        self.probes: dict[str, Probe] = {probe.name: probe_of(self.world, probe) for probe in values["recorded"]}
        """Probes that run() records, by name."""
        self.contact_probes: tuple[ContactProbe, ...] = tuple(
            ContactProbe(name=name, body=self.world._body(body), nodes=np.array(nodes, dtype=np.int32))
            for name, body, nodes in values["contact_probes"]
        )
        """Nodes whose contacts `skerry run` reports."""
        self._sliders: list[Any] = values["sliders"]
        self.sliders: dict[str, Slider] = {slider.name: Slider(self.world, slider) for slider in self._sliders}
        """Values that can be changed while the scene runs, by name."""

    def run(
        self,
        until: float | None = None,
        *,
        csv: Path | None = None,
        page: Path | None = None,
        usd: Path | None = None,
        vtk: Path | None = None,
        progress: bool = False,
    ) -> Recorder:
        """Runs the scene and returns the recorder of its probes. The world takes the steps of `skerry run`, and
        continues from its present time.

        until: time at which the run ends, as with `skerry run --seconds`, default: `seconds` of the scene [s].
            World.run() takes a duration instead.
        csv: file of the time series, written row by row.
        page: file of a page that plays the run.
        usd: film of World.usd().
        vtk: folder of frames for ParaView.
        progress: writes the time to the standard error output.

        StepError: a step could not be completed; all outputs then end there."""
        world, end = self.world, self.seconds if until is None else seconds(until, "Scene.run", "until")
        with ExitStack() as outputs:
            if page is not None:
                film = outputs.enter_context(world.record(title=self.name, every=self.frame_step))
                outputs.callback(film.save, page)
            if usd is not None:
                outputs.enter_context(world.usd(usd, every=self.frame_step))
            if vtk is not None:
                name = os.path.basename(os.path.normpath(vtk))
                outputs.enter_context(
                    world.vtk(vtk, name=self.name or name, every=self.frame_step, materials=self.materials)
                )
            recorder = Recorder(world, self.probes, self.probe_step)
            if csv is not None:
                recorder.stream_csv(csv)
            outputs.enter_context(recorder)
            for duration in self.calls(end):
                world.run(duration, dt=duration, progress=progress)
        return recorder

    def calls(self, end: float) -> Iterator[float]:
        """Durations of the calls of World.advance() with which run() reaches the time `end` [s]. Each call ends at a
        frame or at a row of the probes."""
        frame_step, row_step = self.frame_step, self.probe_step if self.probes or self.contact_probes else math.inf
        ratio = frame_step / row_step
        even = ratio == 0 or (round(ratio) > 0 and abs(ratio - round(ratio)) <= _SLACK * ratio)
        frame = math.floor(self.world.time / frame_step + _SLACK)
        while self.world.time < end - _SLACK * frame_step:
            left = end - frame * frame_step
            length = frame_step if left > (1 - _SLACK) * frame_step else left
            begin = frame * frame_step
            at_begin = abs(self.world.time - begin) <= _SLACK * frame_step
            if even and at_begin and (length == frame_step or ratio == 0):
                calls = max(1, round(ratio))
                for _ in range(calls):
                    yield length / calls
            else:
                rows = [] if ratio == 0 else _multiples(row_step, self.world.time, begin + length)
                for stop in [*rows, begin + length]:
                    if stop > self.world.time + _SLACK * frame_step:
                        yield stop - self.world.time
            frame += 1

    def __repr__(self) -> str:
        return f"<skerry.Scene '{self.name}', {len(self.world.bodies):,} bodies, {self.seconds:g} s>"


def load_scene(
    scene: Path | Mapping[str, Json],
    *,
    overrides: Mapping[str, Json] | None = None,
    threads: int | None = None,
    folder: Path | None = None,
) -> Scene:
    """Reads a scene and builds its world.

    scene: path of a JSON file, or a mapping with the content of one.
    overrides: values that replace others, by their places: {"bodies[0].position": [0, 0, 1]}.
    threads: number of threads of the world.
    folder: folder of the mesh files that a mapping names, default: the present one.

    Corrections and doubts are warnings Doubt, for example of a filled surface. SceneError: names the place, the value
    found and the value expected; for an unknown key the nearest known one."""
    assignments = assignments_of(overrides)
    count = None if threads is None else counted(threads, "threads")
    python = os.environ.get("SKERRY_FILL_PYTHON", sys.executable)
    if isinstance(scene, Mapping):
        base = os.getcwd() if folder is None else path_text(folder, "folder")
        return _with_doubts(_core.load_scene_text(json.dumps(_plain(scene, "")), base, assignments, count, python))
    if folder is not None:
        raise TypeError("folder: found a folder together with a file, whose folder is used; expected none")
    file = path_text(scene, "scene", "a path of a JSON file or a mapping")
    if file.lstrip().startswith("{"):
        raise TypeError(
            "scene: found a text in JSON, expected a path of a JSON file or a mapping, such as json.loads(text)"
        )
    return _with_doubts(_core.load_scene(file, assignments, count, python))


@contextmanager
def scene_file(scene: Path | Mapping[str, Json]) -> Iterator[str]:
    """Path of a JSON file with a scene. For a mapping the file is temporary, and lies in the present folder, where the
    paths of mesh files start."""
    if not isinstance(scene, Mapping):
        yield path_text(scene, "scene", "a path of a JSON file or a mapping")
        return
    with NamedTemporaryFile("w", encoding="utf-8", prefix="scene_", suffix=".json", dir=os.getcwd()) as file:
        json.dump({"name": "scene", **_plain(scene, "")}, file)
        file.flush()
        yield file.name


def assignments_of(overrides: Mapping[str, Json] | None) -> list[str]:
    """Assignments PLACE=VALUE with the values that replace others of a scene."""
    if not isinstance(overrides, Mapping | None):
        raise TypeError(f"overrides: found {overrides!r}, expected a mapping from places to values")
    return [f"{place}={json.dumps(_plain(value, str(place)))}" for place, value in (overrides or {}).items()]


def _with_doubts(values: dict[str, Any]) -> Scene:
    for note in values["notes"]:
        warnings.warn(note, Doubt, stacklevel=3)
    return Scene(values)


def scene_schema() -> dict[str, Any]:
    """JSON schema of scenes."""
    schema: dict[str, Any] = json.loads(_core.scene_schema())
    return schema


def _plain(value: Json, place: str) -> Json:
    """The value of a place with the types of the module json. A path becomes a text."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, float):
        if not math.isfinite(value):
            raise scene_error("scene", place, f"{value}", "a finite number")
        return value
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise TypeError(f"scene: found the key {key!r} in {place or 'the scene'}, expected a text")
        return {key: _plain(inner, f"{place}.{key}" if place else key) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner, f"{place}[{number}]") for number, inner in enumerate(value)]
    return path_text(value, f"scene: {place}", "a value of JSON")


def _multiples(step: float, after: float, before: float) -> list[float]:
    """Multiples of `step` between two times."""
    first = math.floor(after / step + _SLACK) + 1
    count = max(0, math.ceil(before / step - _SLACK) - first)
    return [(first + number) * step for number in range(count)]
