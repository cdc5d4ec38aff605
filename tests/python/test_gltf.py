"""Single states (glTF), read back."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import skerry as sk
from worlds import LINEAR, PNG, RUBBER, ball_world, painted_world


def gltf_json(file: Path) -> Any:
    data = file.read_bytes()
    assert data[:4] == b"glTF" and struct.unpack("<I", data[8:12])[0] == len(data)
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20 : 20 + length])


def gltf_values(file: Path, attribute: str) -> Any:
    """Values of an attribute at the vertices of the first mesh."""
    data, found = file.read_bytes(), gltf_json(file)
    accessor = found["accessors"][found["meshes"][0]["primitives"][0]["attributes"][attribute]]
    start = 28 + struct.unpack("<I", data[12:16])[0] + found["bufferViews"][accessor["bufferView"]]["byteOffset"]
    width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
    return np.frombuffer(data, np.float32, accessor["count"] * width, start).reshape(-1, width).squeeze()


def test_speeds_on_the_visual_surface_of_a_round_body_are_those_of_its_points(tmp_path: Path) -> None:
    world = sk.World(threads=1)
    nodes = 0.3 * np.array([[1, 1, 1], [-1, 1, 1], [-1, -1, 1], [0.2, 0, 0]])
    visual = sk.VisualSurface(nodes, [[0, 1, 2], [0, 2, 3]])
    world.add_body(
        sk.Sphere(radius=0.3), RUBBER, dynamics="rigid", velocity=(1, 0, 0), angular_velocity=(0, 0, 10), visual=visual
    )
    world.gltf(tmp_path / "a.glb", color="speed")
    expected = np.linalg.norm(np.cross([0, 0, 10], nodes) + [1, 0, 0], axis=1)
    np.testing.assert_allclose(gltf_values(tmp_path / "a.glb", "_SPEED"), expected, rtol=1e-5)


@pytest.mark.parametrize("shape", [sk.Sphere(radius=0.1), sk.Capsule(radius=0.1, length=0.2)])
def test_contact_pressures_of_round_bodies_are_at_drawn_nodes(shape: Any, tmp_path: Path) -> None:
    world = sk.World(threads=1)
    world.add_collider(sk.Plane())
    world.add_body(shape, RUBBER, dynamics="rigid", position=(0, 0, 0.3))
    while not len(world.contacts) or not np.any(world.contacts["force"]):
        world.advance(0.01)
    world.gltf(tmp_path / "a.glb", color="contact")
    pressure = gltf_values(tmp_path / "a.glb", "_CONTACT_PRESSURE")
    height = gltf_values(tmp_path / "a.glb", "POSITION")[:, 2]
    assert pressure.min() == 0 and pressure.max() > 0
    assert height[pressure.argmax()] < height.min() + 0.02


def test_a_gltf_file_has_the_state_of_the_world(tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    world, ball, _ = ball_world()
    world.run(0.1)
    world.gltf(tmp_path / "a.glb", color="speed")
    found = pyvista.read(tmp_path / "a.glb")
    mesh = found[0][0].combine()
    triangles = mesh.cells.reshape(-1, 4)[:, 1:]
    # x, y and z of the world are x, -z and y of glTF
    points, normals = (rows[:, [0, 2, 1]] * (1, -1, 1) for rows in (mesh.points, mesh["NORMAL"]))
    np.testing.assert_allclose(points[triangles], np.asarray(ball.positions)[ball.surface], atol=1e-7)
    speed = np.linalg.norm(ball.velocities, axis=1)
    np.testing.assert_allclose(np.ravel(mesh["_SPEED"])[triangles], speed[ball.surface], rtol=1e-6)
    assert mesh["COLOR_0"].shape[0] == len(points)
    outward = points - points.mean(axis=0)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    assert ((normals * outward).sum(axis=1) > 0.9).all()


def test_a_gltf_file_has_the_materials_of_a_visual_surface(tmp_path: Path) -> None:
    painted_world(tmp_path).gltf(tmp_path / "a.glb")
    found = gltf_json(tmp_path / "a.glb")
    assert [material["name"] for material in found["materials"]] == ["red skin", "picture"]
    red, picture = (material["pbrMetallicRoughness"] for material in found["materials"])
    assert red["baseColorFactor"] == pytest.approx([*LINEAR, 0.5]) and found["materials"][0]["alphaMode"] == "BLEND"
    assert picture["baseColorTexture"]["index"] == 0
    view = found["bufferViews"][found["images"][0]["bufferView"]]
    start = (tmp_path / "a.glb").read_bytes().index(PNG)
    assert view["byteLength"] == len(PNG) and start > 0


def test_wrong_gltf_files_are_refused(tmp_path: Path) -> None:
    world, _, _ = ball_world()
    with pytest.raises(sk.SceneError, match=r"found the extension \.gltf, expected \.glb"):
        world.gltf(tmp_path / "a.gltf")
    with pytest.raises(sk.SceneError, match="color_max: found -1.000000, expected a number above 0"):
        world.gltf(tmp_path / "a.glb", color="speed", color_max=-1)
    assert list(tmp_path.iterdir()) == []
