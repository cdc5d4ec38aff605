"""Sweeps over the values of a scene."""

import signal
import threading
from typing import Any

import numpy as np
import pytest

import skerry as sk
from scenes import SCENE, changed

HEIGHTS = [[0, 0, 0.06], [0, 0, 0.08], [0, 0, 0.1]]


def test_a_sweep_gives_the_numbers_of_single_runs() -> None:
    grid: dict[str, Any] = {"bodies[0].position": HEIGHTS, "materials.rubber.young_modulus": np.array([1e5, 4e5])}
    found = sk.sweep(SCENE, grid, jobs=3)
    assert found["status"].tolist() == ["ok"] * 6 and found["message"].tolist() == [""] * 6
    assert found["bodies[0].position"].shape == (6, 3) and found["time"].shape == (6, 11)
    assert found["materials.rubber.young_modulus"].tolist() == [1e5, 4e5] * 3
    for case in range(6):
        overrides = {place: found[place][case] for place in grid}
        scene = sk.load_scene(SCENE, overrides=overrides)
        table = scene.run().table()
        assert scene.world.state_hash == found["state_hash"][case]
        for name, column in table.items():
            np.testing.assert_array_equal(found[name][case], column)


def test_cases_may_be_listed_and_differ_in_length() -> None:
    found = sk.sweep(SCENE, [{"seconds": 0.1}, {"seconds": 0.05, "settings.gravity": [0, 0, 0]}], jobs=1)
    assert found["seconds"].tolist() == [0.1, 0.05]
    assert found["settings.gravity"].tolist() == [None, [0, 0, 0]]
    assert np.isfinite(found["ball.position_z"]).sum(axis=1).tolist() == [11, 6]
    np.testing.assert_array_equal(found["ball.position_z"][1, :6], found["ball.position_z"][1, 0])


def test_refused_and_failed_cases_leave_the_others_alone() -> None:
    with pytest.warns(sk.Doubt, match="sweep: 1 of 2 cases refused; case 1: .*poisson_ratio"):
        found = sk.sweep(SCENE, {"materials.rubber.poisson_ratio": [0.3, 0.7]}, seconds=0.02)
    assert found["status"].tolist() == ["ok", "refused"]
    assert "poisson_ratio" in found["message"][1]
    assert np.isnan(found["ball.position_z"][1]).all() and np.isfinite(found["ball.position_z"][0]).all()


def test_a_sweep_without_a_valid_case_raises_the_first_error() -> None:
    with pytest.raises(sk.SceneError, match="positon"):
        sk.sweep(SCENE, {"bodies[0].positon": HEIGHTS})


def test_a_single_value_is_not_a_list_of_values() -> None:
    with pytest.raises(TypeError, match="seconds: found 1.0, expected a list of values"):
        sk.sweep(SCENE, {"seconds": 1.0})  # type: ignore[dict-item]
    with pytest.raises(TypeError, match=r"grid\[0\]: found 'seconds', expected a mapping from places to values"):
        sk.sweep(SCENE, ["seconds"])  # type: ignore[list-item]


def test_a_scene_without_probes_has_its_end() -> None:
    found = sk.sweep(changed(probes=[]), {"seconds": [0.02, 0.04]})
    assert found["status"].tolist() == ["ok", "ok"]
    assert found["state_hash"][0] != found["state_hash"][1]


def test_an_interrupt_ends_a_sweep() -> None:
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt):
        # This takes an hour.
        sk.sweep(changed(settings={"sleep": False}, probes=[]), {"name": list("abcd")}, seconds=1e6, jobs=2)


def test_a_wrong_argument_is_named() -> None:
    with pytest.raises(sk.SceneError, match="^sweep: jobs: found -1, expected a whole number"):
        sk.sweep(SCENE, {"seconds": [0.1]}, jobs=-1)
    with pytest.raises(sk.SceneError, match="^sweep: seconds: found nan, expected a finite time"):
        sk.sweep(SCENE, {"seconds": [0.1]}, seconds=float("nan"))
    with pytest.raises(TypeError, match="^grid: found 3"):
        sk.sweep(SCENE, 3)  # type: ignore[arg-type]


def test_a_place_in_an_unknown_material_is_refused() -> None:
    with pytest.raises(sk.SceneError, match='the unknown material "rubbr"'):
        sk.sweep(SCENE, {"materials.rubbr.friction": [0.1, 0.2]})
