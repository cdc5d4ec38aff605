"""Pressure on faces, cavities with a gas or a liquid, and pipes."""

import pickle

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER


def piston_world(**settings: object) -> tuple[sk.World, sk.Body, np.ndarray]:
    """A rigid cube of 0.1 m without gravity, and the faces of its end at the largest x."""
    world = sk.World(threads=1, gravity=(0, 0, 0), **settings)  # type: ignore[arg-type]
    body = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1)), RUBBER, dynamics="rigid", name="piston")
    faces = body.surface[np.all(body.positions[body.surface][:, :, 0] > 0.049, axis=1)]
    return world, body, faces


def test_a_pressure_pushes_against_the_normal_of_the_body() -> None:
    world, body, faces = piston_world()
    cavity = world.add_cavity(body, faces=faces, pressure=[(0, 1000), (1, 1000)])
    assert world.cavities == [cavity] and cavity.alive
    assert repr(cavity) == "<skerry.Cavity: cavity of body 'piston'>"
    assert cavity.state.force == pytest.approx((-10, 0, 0))
    assert cavity.state.law == "pressure" and not cavity.state.closed and cavity.state.body == body
    world.advance(0.1)
    assert world.report().momentum == pytest.approx((-1, 0, 0), rel=0.1)
    cavity.set_pressure(-1000)
    assert cavity.pressure == -1000
    assert pickle.loads(pickle.dumps(sk.Gas(inflow=[(0, 1), (2, 3)]))).inflow == ((0, 1), (2, 3))
    cavity.remove()
    assert not cavity.alive and world.cavities == []


def test_gas_flows_between_cavities_and_is_recorded() -> None:
    world, body, faces = piston_world()
    gas = sk.Gas(pressure=1000, inflow=[(0, 0), (1, 1e-4)])
    first = world.add_cavity(body, faces=faces, gas=gas, volume=2e-3)
    other = body.surface[np.all(body.positions[body.surface][:, :, 0] < -0.049, axis=1)]
    second = world.add_cavity(body, faces=other, gas=sk.Gas(), volume=2e-3)
    pipe = world.add_pipe(first, second, conductance=1e-7)
    vent = world.add_pipe(second, conductance=0.0, pressure=500)
    assert world.pipes == [pipe, vent]
    assert pipe.state.first == first and pipe.state.second == second and vent.state.second is None
    mass = first.state.mass + second.state.mass
    with world.recorder({"air": sk.CavityProbe(first)}) as recorder:
        world.advance(0.5)
    assert pipe.state.flow > 0
    assert first.state.mass + second.state.mass == pytest.approx(mass + 1e-4 * 0.125, rel=1e-12)
    assert recorder.table()["air.pressure"][-1] == pytest.approx(first.pressure)
    vent.set_conductance(1e-6)
    vent.set_reservoir([(0, 0), (1, 0)])
    first.set_inflow(0)
    world.advance(5)
    assert second.pressure == pytest.approx(0, abs=1)


def test_a_liquid_has_its_volume() -> None:
    world, body, faces = piston_world()
    cavity = world.add_cavity(body, faces=faces, liquid=sk.Liquid(bulk_modulus=1e6), volume=2e-3)
    assert cavity.pressure == pytest.approx(0, abs=1e-6)
    cavity.set_liquid_volume(2.002e-3)
    assert cavity.pressure == pytest.approx(1e6 * np.log(1.001))


def test_what_cannot_be_is_refused() -> None:
    world, body, faces = piston_world()
    with pytest.raises(TypeError, match="exactly one of pressure, gas and liquid"):
        world.add_cavity(body)
    with pytest.raises(sk.SceneError, match="an open edge between the nodes"):
        world.add_cavity(body, faces=faces, gas=sk.Gas())
    with pytest.raises(sk.SceneError, match="exponent"):
        world.add_cavity(body, faces=faces, gas=sk.Gas(exponent=0.5), volume=1)
    with pytest.raises(TypeError, match="faces"):
        world.add_cavity(body, faces=[1, 2], pressure=1)
    for empty in ([], faces[:0]):
        with pytest.raises(sk.SceneError, match="cavity of body 'piston': faces: found no faces"):
            world.add_cavity(body, faces=empty, pressure=1)
    assert world.cavities == []
    cavity = world.add_cavity(body, faces=faces, pressure=1)
    with pytest.raises(sk.SceneError, match="law pressure"):
        cavity.set_inflow(1)
