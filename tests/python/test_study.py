"""Studies: error bars of the results of a scene."""

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import skerry as sk
from scenes import SCENE, changed
from skerry._study import _quantity

SMALL = {"box": {"size": [0.1, 0.1, 0.1], "cells": [2, 2, 2]}}
BODY = {**SCENE["bodies"][0], "mesh": SMALL, "element": "linear"}


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    file = tmp_path / "drop.json"
    file.write_text(json.dumps(changed(bodies=[BODY])))
    return file


def test_a_study_has_error_bars_runs_and_a_cheapest_scene(scene: Path, tmp_path: Path) -> None:
    found = sk.study(scene, error=0.5, threads=1, budget=15, overrides={"seconds": 0.04})
    height = found.quantities["ball.displacement_z_end"]
    assert height.unit == "m" and height.error > 0 and height.mesh >= 0
    assert height.verdict in ("known", "irregular")
    assert [run.name for run in found.runs[:4]] == ["scene", "draw_1", "element_smoothed", "step_0.5"]
    first = found.runs[0]
    np.testing.assert_allclose(first.time, [0, 0.01, 0.02, 0.03, 0.04])
    assert first.overrides == ("seconds=0.04",)
    assert first.columns["ball.displacement_z"][-1] == height.value
    single = sk.load_scene(scene, overrides={"seconds": 0.04})
    single.run()
    assert single.world.state_hash == first.state_hash
    left_out = [run for run in found.runs if run.status == "left_out"]
    assert left_out and all("budget" in run.message for run in left_out)
    assert found.cheapest is not None and found.cheapest.cpu_seconds > 0
    found.write_cheapest_scene(tmp_path / "cheapest.json")
    sk.load_scene(tmp_path / "cheapest.json").run()
    found.to_html(tmp_path / "study.html")
    assert (tmp_path / "study.html").read_text().lstrip().lower().startswith("<!doctype html>")
    assert "ball.displacement_z_end" in str(found) and math.isinf(found.agree_until)


def test_probes_choose_quantities(scene: Path) -> None:
    found = sk.study(scene, probes=["ball.displacement_z"], threads=1, budget=4, seconds=0.02)
    assert {name.rpartition("_")[0] for name in found.quantities} == {"ball.displacement_z"}
    with pytest.raises(sk.SceneError, match='"bll".*"ball"'):
        sk.study(scene, probes=["bll"])
    with pytest.raises(TypeError, match="probes: found 'ball', expected a list of names"):
        sk.study(scene, probes="ball")


def test_an_interrupted_study_continues(scene: Path, tmp_path: Path) -> None:
    def stop(share: float, done: int, total: int) -> None:
        if done > 0:
            raise KeyboardInterrupt

    folder = tmp_path / "runs"
    settings: dict[str, Any] = {"threads": 1, "budget": 10, "seconds": 3}  # long enough to be interrupted
    with pytest.raises(KeyboardInterrupt):
        sk.study(scene, folder=folder, progress=stop, **settings)
    kept = {file.name: file.stat().st_mtime_ns for file in folder.iterdir()}
    assert "run_scene.json" in kept
    found = sk.study(scene, folder=folder, **settings)
    assert {name: (folder / name).stat().st_mtime_ns for name in kept} == kept
    whole = sk.study(scene, **settings)
    for name, quantity in whole.quantities.items():
        np.testing.assert_equal(found.quantities[name].error, quantity.error)
    with pytest.raises(sk.SceneError, match="another scene"):
        sk.study(scene, folder=folder, **{**settings, "seconds": 0.05})


def test_a_mapping_is_studied_like_its_file(scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    files = sorted(tmp_path.iterdir())
    settings: dict[str, Any] = {"error": 0.5, "threads": 1, "budget": 15, "seconds": 0.04}
    mapping = json.loads(scene.read_text(encoding="utf-8"))
    found, of_file = sk.study(mapping, **settings), sk.study(scene, **settings)
    assert sorted(tmp_path.iterdir()) == files
    assert [run.state_hash for run in found.runs] == [run.state_hash for run in of_file.runs]
    assert found.cheapest
    found.write_cheapest_scene("cheapest.json")
    assert sk.load_scene("cheapest.json").world.bodies


def test_wrong_settings_are_refused(scene: Path) -> None:
    with pytest.raises(sk.SceneError, match="error"):
        sk.study(scene, error=0)
    with pytest.raises(sk.SceneError, match="budget"):
        sk.study(scene, budget=0)
    with pytest.raises(TypeError, match="progress"):
        sk.study(scene, progress=1)  # type: ignore[arg-type]
    with pytest.raises(sk.SceneError, match="missing.json"):
        sk.study("missing.json")


def test_the_error_of_a_singular_quantity_is_infinite() -> None:
    def quantity(verdict: str) -> sk.StudyQuantity:
        numbers = dict.fromkeys(field.name for field in dataclasses.fields(sk.StudyQuantity))
        runs: dict[str, list[float]] = {"run_values": [], "run_errors": []}
        return _quantity({**numbers, **runs, "name": "stress", "unit": "Pa", "verdict": verdict, "sentence": ""})

    assert math.isinf(quantity("singular").error) and math.isinf(quantity("singular").mesh)
    assert math.isnan(quantity("singular").best) and math.isnan(quantity("not_measured").error)
