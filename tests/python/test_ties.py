"""Ties from Python."""

import math

import numpy as np
import pytest

import skerry as sk


def hanging_cube() -> tuple[sk.World, sk.Body, sk.Tie]:
    # The error of a tie is the displacement that the tolerance of the solver allows in a step.
    world = sk.World(sk.Settings(sleep=False, tolerance=1e-9))
    mesh = sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1))
    body = world.add_body(mesh, sk.Material(young_modulus=1e8), dynamics="implicit")
    top = np.flatnonzero(np.asarray(mesh.nodes)[:, 2] > 0)
    return world, body, world.add_tie(body, top)


def test_a_tie_to_the_world_carries_the_weight_of_a_body() -> None:
    world, body, tie = hanging_cube()
    world.advance(1.0)
    state = tie.state
    assert state.kind == "weld" and state.body == body and state.to is None
    assert state.force == pytest.approx((0, 0, 9.81), abs=0.01)
    assert state.node_forces.sum(axis=0) == pytest.approx(state.force)
    assert state.error < 1e-9 and np.isinf(state.broken).all()
    assert state.largest_force >= np.linalg.norm(state.force) > 0
    assert world.ties == [tie]


def test_a_ball_ties_the_mean_point_of_its_nodes() -> None:
    world, body, weld = hanging_cube()
    weld.remove()
    tie = world.add_tie(body, range(8), kind="ball")
    world.advance(0.1)
    state = tie.state
    assert state.kind == "ball" and state.error < 1e-9
    assert state.point == pytest.approx((0, 0, 0), abs=1e-9)
    assert state.node_forces.sum(axis=0) == pytest.approx((0, 0, 9.81), abs=0.01)


def test_the_nodes_of_a_tie_break_off_when_their_force_is_lowered() -> None:
    world, _, tie = hanging_cube()
    world.advance(1.0)
    tie.set_break_force(1.0)
    world.advance(0.1)
    assert (tie.state.broken <= world.time).all()
    tie.remove()
    assert not tie.alive and world.ties == []


def test_ties_refuse_wrong_arguments() -> None:
    world, body, _ = hanging_cube()
    with pytest.raises(sk.SceneError, match="break_force"):
        world.add_tie(body, [0], break_force=-1)
    with pytest.raises(sk.SceneError, match="kind"):
        world.add_tie(body, [0], kind="glue")  # type: ignore[arg-type]
    with pytest.raises(sk.SceneError, match="itself"):
        world.add_tie(body, [0], body)
    assert math.isinf(world.add_tie(body, [1]).state.break_force)
