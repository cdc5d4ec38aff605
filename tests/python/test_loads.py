"""Loads, force fields and static equilibrium."""

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER


def cube_world(**settings: object) -> tuple[sk.World, sk.Body]:
    world = sk.World(threads=1, **settings)  # type: ignore[arg-type]
    return world, world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), (2, 2, 2)), RUBBER, dynamics="rigid", name="cube")


def test_a_force_over_time_gives_its_impulse() -> None:
    world, cube = cube_world(gravity=(0, 0, 0))
    load = world.add_force(cube, range(27), (2, 0, 0), scale=[(0.1, 0), (0.2, 1), (0.3, 0)])
    assert world.loads == [load]
    assert repr(load) == "<skerry.Load: force on body 'cube'>"
    world.advance(0.5)
    assert cube.velocity == pytest.approx((0.2 / cube.mass, 0, 0), rel=1e-12)
    load.set_scale(1)
    state = load.state
    assert state.kind == "force" and state.body == cube and state.scale == 1
    assert state.force == pytest.approx((2, 0, 0))
    load.set_vector((0, 0, 3))
    assert load.state.vector == (0, 0, 3)
    load.remove()
    assert not load.alive and world.loads == []


def test_fields_act_on_all_bodies_or_on_one() -> None:
    world, cube = cube_world()
    factor = world.add_gravity_scale(0)
    world.add_acceleration((1, 0, 0), body=cube)
    world.add_drag(10, wind=(0, 1, 0))
    assert factor.state.force == pytest.approx((0, 0, 9.81 * cube.mass))
    assert factor.state.body is None
    world.advance(5)
    assert cube.velocity == pytest.approx((0.1, 1, 0), abs=1e-6)
    world.remove(factor)
    assert len(world.loads) == 2


def test_a_traction_acts_on_faces() -> None:
    world = sk.World(threads=1, gravity=(0, 0, 0))
    bar = world.add_body(sk.Mesh.box((0.2, 0.1, 0.1), (4, 2, 2)), RUBBER, dynamics="explicit")
    right = bar.faces(bar.select(where=lambda x: x[:, 0] > 0.0999))
    assert len(right) == 8
    load = world.add_traction(bar, right, (100, 0, 0))
    present = world.add_traction(bar, right, (100, 0, 0), present_area=True)
    bar.positions = 2 * bar.positions
    assert load.state.force == pytest.approx((1, 0, 0))
    assert present.state.force == pytest.approx((4, 0, 0))


def test_a_hanging_bar_relaxes() -> None:
    world = sk.World(threads=1)
    rubber = sk.Material(young_modulus=1e6, poisson_ratio=0.0)
    bar = world.add_body(sk.Mesh.box((0.1, 0.1, 0.5), (2, 2, 10)), rubber, dynamics="explicit", name="bar")
    bar.attach(np.flatnonzero(bar.positions[:, 2] > 0.249))
    report = world.relax(tolerance=1e-5, load_steps=2)
    assert report.converged and report.worst == bar and report.residual < 1e-5 and report.message == ""
    assert report.load == 1
    assert world.time == 0
    stretch = -0.25 - bar.positions[:, 2].min()
    assert stretch == pytest.approx(1000 * 9.81 * 0.25 / 2e6, rel=0.01)


def test_a_falling_body_has_no_equilibrium() -> None:
    world, cube = cube_world()
    report = world.relax(max_steps=50)
    assert not report.converged and report.steps == 50 and report.worst == cube and report.residual > 0.9
    assert np.all(cube.velocity == 0)
    assert report.load == 0


def test_wrong_values_are_refused() -> None:
    world, cube = cube_world()
    with pytest.raises(sk.SceneError, match="node 27"):
        world.add_force(cube, [27], (0, 0, 1))
    with pytest.raises(TypeError, match="scale"):
        world.add_gravity_scale([1, 2, 3])
    with pytest.raises(sk.SceneError, match="tolerance"):
        world.relax(tolerance=2)
    with pytest.raises(sk.SceneError, match="load_steps"):
        world.relax(load_steps=0)
