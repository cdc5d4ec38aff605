"""Cables that run through points of bodies."""

import numpy as np
import pytest

import skerry as sk


def hanging_cube() -> tuple[sk.World, sk.Body]:
    """A rigid cube of 1 kg, whose centre is 1 m below the origin."""
    world = sk.World(threads=1, step_size=1e-3, sleep=False)
    mesh = sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1))
    return world, world.add_body(mesh, sk.Material(density=1000.0), position=(0, 0, -1), dynamics="rigid")


def test_a_cable_of_given_length_carries_a_cube() -> None:
    world, cube = hanging_cube()
    cable = world.add_cable([sk.Anchor(point=(0, 0, 0)), sk.Anchor(body=cube, point=(0, 0, -1))], length=1.0)
    world.advance(0.1)
    state = cable.state
    assert state.tension[0] == pytest.approx(9.81, rel=1e-6)
    assert state.length == pytest.approx(1.0, abs=1e-6)
    assert state.released == 1.0
    assert [point.body for point in state.points] == [None, cube]
    np.testing.assert_allclose(state.points[1].point, (0, 0, -1), atol=1e-6)
    cable.set_drive(rate=[(0.1, -0.1), (1.0, -0.1)])
    world.advance(0.5)
    assert cable.length == pytest.approx(0.95, abs=1e-3)
    assert cable.state.work == pytest.approx(9.81 * 0.05, rel=0.05)
    assert world.cables == [cable]
    cable.remove()
    assert not cable.alive
    assert world.cables == []


def test_a_recorder_follows_a_cable() -> None:
    world, cube = hanging_cube()
    cable = world.add_cable([sk.Anchor(point=(0, 0, 0)), sk.Anchor(body=cube, point=(0, 0, -1))], tension=20)
    with world.recorder({"tendon": sk.CableProbe(cable)}, every=0.01) as recorder:
        world.run(0.05, dt=0.01)
    table = recorder.table()
    np.testing.assert_array_equal(table["tendon.tension_0"][1:], 20)
    assert recorder.units["tendon.length"] == "m"


def test_errors_of_cables_name_the_field() -> None:
    world, cube = hanging_cube()
    points = [sk.Anchor(point=(0, 0, 0)), sk.Anchor(body=cube, point=(0, 0, -1))]
    with pytest.raises(sk.SceneError, match="exactly one of tension, length and rate"):
        world.add_cable(points)
    with pytest.raises(sk.SceneError, match="does not push"):
        world.add_cable(points, tension=-1)
    with pytest.raises(sk.SceneError, match="at least 2 points"):
        world.add_cable(points[:1], tension=1)
    with pytest.raises(TypeError, match=r"points\[0\]"):
        world.add_cable([(0, 0, 0)], tension=1)  # type: ignore[list-item]
