"""Many runs of one scene with other values."""

from __future__ import annotations

import itertools
import os
import threading
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import _arrays
from ._arrays import checked, whole
from ._errors import SceneError, StepError
from ._recorder import Recorder
from ._rollout import warn_of
from ._scene import Json, Path, load_scene

Case: TypeAlias = Mapping[str, Json]
"""Values of a scene by their places."""


@dataclass(slots=True)
class _Result:
    """Result of a case."""

    status: str = "ok"
    message: str = ""
    distrust: str = ""
    state_hash: int = 0
    table: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    error: SceneError | None = None


def sweep(
    scene: Path | Mapping[str, Json],
    grid: Mapping[str, Sequence[Json]] | Sequence[Case],
    *,
    jobs: int | None = None,
    seconds: float | None = None,
    folder: Path | None = None,
) -> dict[str, NDArray[Any]]:
    """Runs a scene with many values and returns arrays whose first axis is the case:

        found = skerry.sweep("incline.json", {"materials.block.friction": [0.2, 0.3, 0.4]})
        found["block.displacement_x"][:, -1]  # at the end of each run

    scene, folder: as for load_scene().
    grid: values by place, of which all combinations are run, the last place varying fastest; or a list of cases, each
        with values by place.
    jobs: number of cases that run at once, with one thread each, default: the number of processors.
    seconds: time at which the runs end, default: that of the scene [s].

    The result has:
    - each place: its values, shape (B,) or (B, ...)
    - "status": "ok", "refused" (the scene is wrong) or "failed" (a step could not be completed); "message": the reason
    - "distrust": why the results of the case cannot be trusted, or ""
    - "state_hash": hash of the world at the end
    - "time" and each column of the probes: shape (B, T); NaN after the end of a case, and everywhere if it was refused

    Cases that are refused, fail or cannot be trusted become warnings. The numbers are those of one run after the other.
    SceneError: all cases are refused; it is the error of the first.
    """
    cases = _cases(grid)
    end = None if seconds is None else _arrays.seconds(seconds, "sweep", "seconds")
    stop = threading.Event()
    with ThreadPoolExecutor((0 if jobs is None else whole(jobs, "sweep: jobs")) or os.cpu_count() or 1) as pool:
        futures = [pool.submit(_run_case, scene, case, end, folder, stop) for case in cases]
        try:
            while wait(futures, timeout=0.1).not_done:
                pass  # Python raises KeyboardInterrupt here
            results = [future.result() for future in futures]
        except BaseException:
            stop.set()
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    if results and all(result.error is not None for result in results):
        raise next(result.error for result in results if result.error is not None)
    for status in ("refused", "failed"):
        warn_of("sweep", "case", status, [result.message if result.status == status else "" for result in results])
    warn_of("sweep", "case", "cannot be trusted", [result.distrust for result in results])
    return {**_values(cases), **_columns(results)}


def _cases(grid: Mapping[str, Sequence[Json]] | Sequence[Case]) -> list[Case]:
    if not isinstance(grid, Mapping):
        cases = list(checked(grid, "grid", Mapping, Iterable))
        for number, case in enumerate(cases):
            if not isinstance(case, Mapping):
                raise TypeError(f"grid[{number}]: found {case!r}, expected a mapping from places to values")
        return cases
    for place, values in grid.items():
        if isinstance(values, str) or not hasattr(values, "__len__"):
            raise TypeError(f"{place}: found {values!r}, expected a list of values")
    return [dict(zip(grid, values, strict=True)) for values in itertools.product(*grid.values())]


def _run_case(
    scene: Path | Mapping[str, Json], case: Case, seconds: float | None, folder: Path | None, stop: threading.Event
) -> _Result:
    result = _Result()
    try:
        loaded = load_scene(scene, overrides=case, threads=1, folder=folder)
    except SceneError as error:
        return _Result("refused", str(error), error=error)
    world = loaded.world
    recorder = Recorder(world, loaded.probes, loaded.probe_step)
    try:
        with recorder:
            for duration in loaded.calls(loaded.seconds if seconds is None else seconds):
                if stop.is_set():
                    break
                world.advance(duration)
    except (SceneError, StepError) as error:
        result.status, result.message = "failed", str(error)
    result.distrust = world.report().distrust
    result.state_hash = world.state_hash
    result.table = recorder.table()
    return result


def _values(cases: list[Case]) -> dict[str, NDArray[Any]]:
    """Values of the cases by place; None where a case leaves the value of the scene."""
    places = dict.fromkeys(place for case in cases for place in case)
    columns = {}
    for place in places:
        values = [case.get(place) for case in cases]
        try:
            columns[place] = np.array(values)
        except ValueError:  # values of several shapes
            columns[place] = np.empty(len(values), dtype=object)
            columns[place][:] = values
    return columns


def _columns(results: list[_Result]) -> dict[str, NDArray[Any]]:
    columns: dict[str, NDArray[Any]] = {
        "status": np.array([result.status for result in results], dtype=np.str_),
        "message": np.array([result.message for result in results], dtype=np.str_),
        "distrust": np.array([result.distrust for result in results], dtype=np.str_),
        "state_hash": np.array([result.state_hash for result in results], dtype=np.uint64),
    }
    for name in dict.fromkeys(name for result in results for name in result.table):
        series = [result.table.get(name, np.empty(0)) for result in results]
        columns[name] = np.full((len(series), max(map(len, series))), np.nan)
        for row, values in zip(columns[name], series, strict=True):
            row[: len(values)] = values
    return columns
