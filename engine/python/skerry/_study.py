"""Studies: error bars of the results of a scene."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import checked, counted, flag, path_text, real
from ._scene import Json, Path, assignments_of, scene_file


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyQuantity:
    """A number with its error bar. Values that were not measured are NaN.

    name: name.
    unit: SI unit.
    value: value of the scene as it is.
    error: half width of its error bar, infinite for a singular stress.
    mesh: part of the error from the mesh.
    step: part of the error from the step length.
    contact: part of the error from the contact solver.
    noise: difference of runs whose start differs by 1e-12 m.
    best: extrapolated value.
    best_error: error of the extrapolated value.
    scale: size to which relative errors refer.
    mesh_order: observed order of convergence of the mesh.
    expected_mesh_order: its order in theory.
    step_order: observed order of convergence of the steps.
    expected_step_order: its order in theory.
    agree_until: time until which runs with a start 1e-12 m apart agree, infinite if they agree to the end [s].
    run_values: value of each run, in the order of Study.runs.
    run_errors: half width of the error bar of each run.
    verdict: "known", "irregular", "singular", "chaotic", "zero" or "not_measured".
    sentence: the verdict in words.
    """

    name: str
    unit: str
    value: float
    error: float
    mesh: float
    step: float
    contact: float
    noise: float
    best: float
    best_error: float
    scale: float
    mesh_order: float
    expected_mesh_order: float
    step_order: float
    expected_step_order: float
    agree_until: float
    run_values: tuple[float, ...]
    run_errors: tuple[float, ...]
    verdict: str
    sentence: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StudyRun:
    """A run of a study.

    name: "scene" for the scene as it is, or names such as "refine_1" and "step_0.5".
    overrides: assignments PLACE=VALUE of `skerry run --set`.
    status: "ok", "failed" (a step was refused), "refused" (the scene cannot be changed like this) or "left_out".
    message: the reason.
    warnings: reasons not to rely on the run.
    cpu_seconds: CPU time, predicted if the run was left out [s].
    steps: number of steps.
    tetrahedra: number of tetrahedra.
    state_hash: hash of the world at the end.
    time: times of the rows, shape (T,) [s].
    columns: time series by "PROBE.QUANTITY", shape (T,).
    """

    name: str
    overrides: tuple[str, ...]
    status: str
    message: str
    warnings: tuple[str, ...]
    cpu_seconds: float
    steps: int
    tetrahedra: int
    state_hash: int
    time: NDArray[np.float64]
    columns: dict[str, NDArray[np.float64]]


@dataclass(frozen=True, slots=True, kw_only=True)
class CheapestSettings:
    """The cheapest settings for the wanted error.

    overrides: assignments PLACE=VALUE of `skerry run --set`.
    reaches: False if no settings reach the wanted error, and these come nearest.
    error: predicted largest relative error.
    cpu_seconds: predicted CPU time [s].
    sentence: the reason in words.
    """

    overrides: tuple[str, ...]
    reaches: bool
    error: float
    cpu_seconds: float
    sentence: str


class Study:
    """The results of study()."""

    __slots__ = ("_core", "_scene", "agree_until", "cheapest", "growth_rate", "quantities", "runs", "sentences")

    def __init__(self, core: Any, scene: Path | Mapping[str, Json]) -> None:
        self._core = core
        self._scene = scene
        values = json.loads(core.json())
        self.quantities: dict[str, StudyQuantity] = {
            quantity["name"]: _quantity(quantity) for quantity in values["quantities"]
        }
        """Numbers with their error bars, by name."""
        self.runs: tuple[StudyRun, ...] = tuple(
            _run(run, core.series(number)) for number, run in enumerate(values["runs"])
        )
        """Runs; the first is the scene as it is."""
        cheapest = values["cheapest"]
        self.cheapest: CheapestSettings | None = cheapest and CheapestSettings(
            overrides=tuple(cheapest["set"]),
            **{key: cheapest[key] for key in ("reaches", "error", "cpu_seconds", "sentence")},
        )
        """Cheapest settings for the wanted error; None if no error is known."""
        self.agree_until: float = math.inf if values["agree_until"] is None else values["agree_until"]
        """Time until which runs with a start 1e-12 m apart agree; infinite if they agree to the end [s]."""
        self.growth_rate: float = values["growth_rate"]
        """Rate at which small differences of the start grow; 0 if they do not [1/s]."""
        self.sentences: tuple[str, ...] = tuple(values["sentences"])
        """Remarks on the study as a whole."""

    def to_html(self, file: Path) -> None:
        """Writes a page with the error bars and their plots."""
        with open(path_text(file, "file"), "w", encoding="utf-8") as page:
            page.write(self._core.page())

    def write_cheapest_scene(self, file: Path) -> None:
        """Writes a scene file with the cheapest settings.

        SceneError: there are none."""
        with scene_file(self._scene) as path:
            self._core.write_cheapest_scene(path, path_text(file, "file"))

    def __str__(self) -> str:
        text: str = self._core.text()
        return text

    def __repr__(self) -> str:
        return f"<skerry.Study of {len(self.quantities):,} quantities and {len(self.runs):,} runs>"


def study(
    scene: Path | Mapping[str, Json],
    *,
    error: float = 0.01,
    probes: Iterable[str] = (),
    seconds: float | None = None,
    overrides: Mapping[str, Json] | None = None,
    threads: int = 0,
    budget: float | None = None,
    folder: Path | None = None,
    redo: bool = False,
    progress: bool | Callable[[float, int, int], object] = False,
) -> Study:
    """Determines the errors of the results of a scene from runs with other meshes, steps and tolerances:

        found = skerry.study("gripper.json", error=0.05)
        print(found)
        found.quantities["cube.displacement_z_end"].error

    scene: path of a JSON file, or a mapping with the content of one, which is kept in a temporary file in the present
        folder meanwhile.
    error: wanted relative error, for which the cheapest settings are searched.
    probes: names NAME or NAME.QUANTITY of probes and bodies, default: all.
    seconds: time at which the runs end, default: that of the scene [s].
    overrides: as for load_scene().
    threads: number of threads, 0: all cores.
    budget: largest time of the study, divided by that of one run with one thread; finer meshes and other runs that do
        not fit are left out, default: 15, or more as long as the study takes less than 5 s.
    folder: keeps the runs; a later study of the same scene continues with them.
    redo: True makes all runs again and replaces those in the folder.
    progress: True writes the share that is done to the standard error output; a function is called with this share and
        the numbers of the runs that are done and of all runs.

    The numbers do not depend on the number of threads, except through the budget. A run that fails is a result. Ctrl-C
    ends the study; runs that have ended stay in the folder. SceneError: the scene or a setting is wrong."""
    names = list(checked(probes, "study: probes", Iterable))
    if isinstance(probes, str) or not all(isinstance(name, str) for name in names):
        raise TypeError(f"study: probes: found {probes!r}, expected a list of names")
    called: Callable[[float, int, int], object] | None
    called = progress if callable(progress) else _show if flag(progress, "study: progress") else None
    with scene_file(scene) as file:
        core = _core.study(
            file,
            real(error, "study: error"),
            names,
            None if seconds is None else real(seconds, "study: seconds"),
            assignments_of(overrides),
            counted(threads, "study: threads"),
            None if budget is None else real(budget, "study: budget"),
            "" if folder is None else path_text(folder, "folder"),
            flag(redo, "study: redo"),
            os.environ.get("SKERRY_FILL_PYTHON", sys.executable),
            called,
        )
    if called is _show:
        print("\r\033[K100 %", file=sys.stderr)
    return Study(core, deepcopy(scene))


def _show(share: float, done: int, total: int) -> None:
    print(f"\r\033[K{100 * share:.0f} %, {done} of {total} runs", end="", file=sys.stderr, flush=True)


def _quantity(values: dict[str, Any]) -> StudyQuantity:
    """Makes a quantity of its JSON values. A number that is not finite is None there: infinity for the keys in
    `infinite`, NaN for others."""
    infinite = ("agree_until", "error", "mesh") if values["verdict"] == "singular" else ("agree_until",)
    absent = {key: math.inf if key in infinite else math.nan for key, value in values.items() if value is None}
    runs = {
        key: tuple(math.nan if number is None else number for number in values[key])
        for key in ("run_values", "run_errors")
    }
    return StudyQuantity(**{**values, **absent, **runs})


def _run(values: dict[str, Any], series: tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]) -> StudyRun:
    kept = ("name", "status", "message", "cpu_seconds", "steps", "tetrahedra")
    time, columns = series
    return StudyRun(
        overrides=tuple(values["set"]),
        warnings=tuple(values["warnings"]),
        state_hash=int(values["state_hash"], 16),
        time=time,
        columns=columns,
        **{key: values[key] for key in kept},
    )
