"""Cables that run through points of bodies."""

import numpy as np
import pytest

import skerry as sk


def hanging_cube():
    world = sk.World(sk.Settings(step_size=1e-3, sleep=False))
    cube = world.add_body(
        sk.Mesh.box(size=(0.1, 0.1, 0.1), cells=(1, 1, 1)),
        material=world.add_material(sk.Material(density=1000.0)),
        position=(0.0, 0.0, -1.0),
        dynamics="rigid",
    )
    return world, cube


def test_a_cable_of_given_length_carries_a_cube():
    world, cube = hanging_cube()
    cable = world.add_cable([sk.Anchor(point=(0, 0, 0)), sk.Anchor(body=cube, point=(0, 0, -1))], length=1.0)
    world.advance(0.1)
    state = cable.state
    assert state.tension[0] == pytest.approx(9.81, rel=1e-6)
    assert state.length == pytest.approx(1.0, abs=1e-6)
    assert state.released == 1.0
    cable.set_drive(rate=[(0.1, -0.1), (1.0, -0.1)])
    world.advance(0.5)
    assert cable.length == pytest.approx(0.95, abs=1e-3)
    assert cable.state.work == pytest.approx(9.81 * 0.05, rel=0.05)
    assert world.cables == [cable]
    cable.remove()
    assert not cable.alive
    assert world.cables == []


def test_a_recorder_follows_a_cable():
    world, cube = hanging_cube()
    cable = world.add_cable([sk.Anchor(point=(0, 0, 0)), sk.Anchor(body=cube, point=(0, 0, -1))], tension=20)
    with world.recorder({"tendon": sk.CableProbe(cable)}, every=0.01) as recorder:
        world.advance(0.05)
    series = recorder.result()
    assert np.all(series["tendon", "tension_0"][1:] == 20)


def test_errors_of_cables_name_the_field():
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
