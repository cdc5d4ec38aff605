"""Fibres with active tension."""

import numpy as np
import pytest

import skerry as sk


def muscle() -> tuple[sk.World, sk.Body]:
    world = sk.World(gravity=(0.0, 0.0, 0.0))
    soft = world.add_material(young_modulus=3e4, poisson_ratio=0.3, damping=50.0)
    return world, world.add_body(sk.Mesh.box((0.05, 0.05, 0.1), (1, 1, 2)), material=soft, dynamics="explicit")


def test_a_muscle_contracts_while_it_is_active() -> None:
    world, body = muscle()
    fibres = world.add_fibres(body, (0, 0, 1), stiffness=1e4, exponent=2.0)
    fibres.set_tension([(0.0, 0.0), (0.1, 2e3)])
    world.advance(0.4)
    state = fibres.state
    assert state.body == body
    assert state.tension == 2e3
    assert state.energy == 0.0
    assert np.all(state.stretch < 0.97)
    np.testing.assert_allclose(state.stress, 2e3)
    assert world.fibres == [fibres]
    fibres.remove()
    assert world.fibres == []


def test_directions_and_tetrahedra_can_be_arrays() -> None:
    world, body = muscle()
    directions = np.tile([[1.0, 0.0, 0.0]], (3, 1))
    fibres = world.add_fibres(body, directions, tetrahedra=[4, 2, 7], tension=10.0)
    assert fibres.state.tetrahedra.tolist() == [4, 2, 7]
    with pytest.raises(sk.SceneError, match="direction: found 3 directions, expected one direction"):
        world.add_fibres(body, directions)
    with pytest.raises(sk.SceneError, match="tension: found -1"):
        world.add_fibres(body, (0, 0, 1), tension=-1.0)


def test_a_muscle_between_held_ends_keeps_the_balance_of_momentum() -> None:
    world = sk.World(gravity=(0.0, 0.0, 0.0), threads=1)
    size = (0.1, 0.1, 0.4)
    body = world.add_body(sk.Mesh.box(size, (2, 2, 6)), sk.Material(young_modulus=1e6), dynamics="explicit")
    body.attach(np.flatnonzero(np.abs(body.positions[:, 2]) > 0.199))
    world.add_fibres(body, (0, 0, 1), tension=3e4)
    world.advance(0.1)
    assert world.report().momentum_error_share < 1e-9
