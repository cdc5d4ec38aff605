"""Springs and anchors."""

from __future__ import annotations

import math

import numpy as np
import pytest

import skerry as sk


def hanging(**given: float) -> tuple[sk.World, sk.Body, sk.Spring]:
    world = sk.World(gravity=(0, 0, -10), sleep=False)
    ball = world.add_body(sk.Sphere(radius=0.1), sk.Material(), name="ball")
    settings = {"stiffness": 500.0, "damping": 60.0} | given
    spring = world.add_spring(sk.Anchor(body=ball), sk.Anchor(point=(0, 0, 1)), **settings)
    return world, ball, spring


def test_a_weight_stretches_a_spring() -> None:
    world, ball, spring = hanging()
    world.advance(5)
    state = spring.state
    assert state.force == pytest.approx(10 * ball.mass, rel=1e-4)
    assert state.length == pytest.approx(1 + 10 * ball.mass / 500, rel=1e-4)
    assert state.energy == pytest.approx((10 * ball.mass) ** 2 / 1000, rel=1e-3)
    assert state.first.body == ball and state.second.body is None
    np.testing.assert_allclose(state.second.point, (0, 0, 1))
    assert world.springs == [spring]


def test_a_spring_can_be_changed_and_removed() -> None:
    world, ball, spring = hanging(strength=1000.0)
    spring.set_second(sk.Anchor(point=(0, 0, 2)))
    spring.set_rest_length([(0, 1), (1, 1.5)])
    spring.set_stiffness(1000)
    spring.set_damping(80)
    world.advance(5)
    assert spring.state.rest_length == 1.5
    assert ball.center_of_mass[2] == pytest.approx(0.5 - 10 * ball.mass / 1000, abs=1e-3)
    spring.remove()
    assert not spring.alive and world.springs == []


def test_an_anchor_on_a_collider_and_a_probe() -> None:
    world, ball, _ = hanging()
    hook = world.add_collider(sk.Sphere(radius=0.1), position=(0, 3, 0), name="hook")
    cord = world.add_spring(
        sk.Anchor(body=ball), sk.Anchor(collider=hook, point=(0, 3, 0)), stiffness=1, rest_length=0, only="tension"
    )
    with world.recorder({"cord": sk.SpringProbe(cord)}) as recorder:
        world.run(0.02, dt=0.01)
    assert recorder.units["cord.length"] == "m"
    assert recorder.array()[-1]["cord.force"] == pytest.approx(cord.state.force)
    world.remove(hook)
    assert not cord.alive


def test_wrong_arguments_are_refused() -> None:
    world, ball, _ = hanging()
    with pytest.raises(sk.SceneError, match="stiffness"):
        world.add_spring(sk.Anchor(body=ball), sk.Anchor(), stiffness=-1)
    with pytest.raises(sk.SceneError, match="only"):
        world.add_spring(sk.Anchor(body=ball), sk.Anchor(), only="pull")  # type: ignore[arg-type]
    with pytest.raises(sk.SceneError, match="no body"):
        world.add_spring(sk.Anchor(), sk.Anchor())
    with pytest.raises(TypeError, match="Anchor"):
        world.add_spring(ball, sk.Anchor())  # type: ignore[arg-type]
    with pytest.raises(sk.SceneError, match="strength"):
        world.add_spring(sk.Anchor(body=ball), sk.Anchor(), strength=-math.inf)
