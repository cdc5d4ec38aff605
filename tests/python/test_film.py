"""Films (USD), read back with the library of their format."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import skerry as sk
from worlds import LINEAR, PNG, RUBBER, ball_world, painted_world

pxr = pytest.importorskip("pxr")
from pxr import Usd, UsdGeom, UsdShade  # noqa: E402

FAR = np.array([3e4, -2e4, 1e3])  # where the spacing of floats is 2 mm


def far_world(**settings: Any) -> sk.World:
    """A spinning rigid box and a rubber ball, far from the origin, between a floor and a paddle that moves."""
    world = sk.World(**{"threads": 1, **settings})
    world.add_collider(sk.Plane(point=FAR), name="floor")
    motion = sk.Motion(velocity=(0, 0.5, 0))
    world.add_collider(sk.Box((0.1, 0.1, 0.1)), position=FAR + (1, 0, 1), motion=motion, name="paddle")
    world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=FAR + (0, 0, 0.06), name="ball")
    world.add_body(
        sk.Mesh.box((0.1, 0.2, 0.3), (2, 2, 2)),
        RUBBER,
        position=FAR + (0, 1, 1),
        angular_velocity=(3, 5, -2),
        dynamics="rigid",
        name="box",
    )
    return world


def vertices(body: sk.Body) -> Any:
    """Positions of the nodes of the surface, in the order of the vertices of the film."""
    return np.asarray(body.positions)[np.unique(body.surface)]


def world_points(stage: Any, name: str, time: float) -> Any:
    """Vertices of a mesh in world coordinates."""
    prim = stage.GetPrimAtPath(f"/World/{name}")
    points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(time), dtype=float)
    to_world = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(time))
    return points @ to_world[:3, :3] + to_world[3, :3]


def value(stage: Any, attribute: str, time: float) -> Any:
    return np.array(stage.GetAttributeAtPath(f"/World/{attribute}").Get(time))


def test_a_film_has_the_positions_of_the_world_far_from_the_origin(tmp_path: Path) -> None:
    world = far_world()
    ball, box, paddle = world.bodies["ball"], world.bodies["box"], world.colliders["paddle"]
    expected = []
    with world.usd(tmp_path / "far.usd", every=0.01):
        for _ in range(8):
            expected.append((vertices(ball), vertices(box), np.array(paddle.pose.position)))
            world.advance(0.01)
    stage = Usd.Stage.Open(str(tmp_path / "far.usd"))
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, 8)
    assert stage.GetTimeCodesPerSecond() == stage.GetFramesPerSecond() == pytest.approx(100)
    assert UsdGeom.GetStageUpAxis(stage) == "Z" and UsdGeom.GetStageMetersPerUnit(stage) == 1
    assert [prim.GetName() for prim in stage.GetDefaultPrim().GetChildren()] == [
        "Looks",
        *world.bodies,
        "floor",
        "paddle",
    ]
    for frame, (of_ball, of_box, of_paddle) in enumerate(expected):
        # 1e-6 of the size of the body; a double at this distance is exact to 7e-12 m
        np.testing.assert_allclose(world_points(stage, "ball", frame), of_ball, rtol=0, atol=1e-6 * 0.1)
        np.testing.assert_allclose(world_points(stage, "box", frame), of_box, rtol=0, atol=1e-6 * 0.3)
        np.testing.assert_allclose(world_points(stage, "paddle", frame).mean(axis=0), of_paddle, rtol=0, atol=1e-7)
    extent = value(stage, "ball.extent", 5)
    points = value(stage, "ball.points", 5)
    np.testing.assert_array_equal(extent, [points.min(axis=0), points.max(axis=0)])
    triangles = value(stage, "ball.faceVertexIndices", 0).reshape(-1, 3)
    np.testing.assert_array_equal(np.unique(ball.surface)[triangles], ball.surface)
    assert set(value(stage, "ball.faceVertexCounts", 0)) == {3}


def test_a_rigid_body_moves_by_its_transform_alone(tmp_path: Path) -> None:
    sizes = []
    for frames in (10, 20):
        world = far_world()
        world.bodies["ball"].remove()
        with world.usd(tmp_path / "a.usd", every=0.01):
            world.run(0.01 * frames, dt=0.01)
        sizes.append((tmp_path / "a.usd").stat().st_size)
    stage = Usd.Stage.Open(str(tmp_path / "a.usd"))
    for attribute in ("points", "velocities", "extent"):
        assert stage.GetAttributeAtPath(f"/World/box.{attribute}").GetNumTimeSamples() == 0
    assert (sizes[1] - sizes[0]) / 10 < 200  # bytes per frame of the box and the paddle, and for the time


def test_velocities_and_the_motion_of_the_transform_are_those_of_the_nodes(tmp_path: Path) -> None:
    world = far_world()
    ball = world.bodies["ball"]
    ball.set_velocity((1, 2, 3), angular_velocity=(5, 0, 0))
    velocity = np.asarray(ball.velocities)[np.unique(ball.surface)]
    with world.usd(tmp_path / "a.usd", every=1e-4):
        world.advance(1e-4)
    stage = Usd.Stage.Open(str(tmp_path / "a.usd"))
    moved = value(stage, "ball.xformOp:translate", 1) - value(stage, "ball.xformOp:translate", 0)
    # the weight changes the mean velocity by 9.81 m/s^2 within half a frame
    np.testing.assert_allclose(value(stage, "ball.velocities", 0) + moved / 1e-4, velocity, atol=1e-3)


@pytest.mark.parametrize("color", ["stress", "speed", "contact"])
def test_colors_show_the_quantity_that_the_vertices_also_have_as_numbers(color: Any, tmp_path: Path) -> None:
    world, ball, floor = ball_world()
    world.run(0.06)
    with world.usd(tmp_path / "a.usdc", every=0.01, color=color):
        pass
    stage = Usd.Stage.Open(str(tmp_path / "a.usdc"))
    name = {"stress": "von_mises", "speed": "speed", "contact": "contact_pressure"}[color]
    found, surface = value(stage, f"ball.primvars:{name}", 6), np.unique(ball.surface)
    if color == "speed":
        np.testing.assert_allclose(found, np.linalg.norm(ball.velocities, axis=1)[surface], rtol=1e-6)
    if color == "stress":
        stress = ball.stress("nodes")
        deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] * np.eye(3) / 3
        np.testing.assert_allclose(found, np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))[surface], rtol=1e-6)
    if color == "contact":
        corners = np.asarray(ball.positions)[ball.surface]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        of_node = np.zeros(ball.node_count)
        of_node[surface] = found
        force = (of_node[ball.surface].mean(axis=1) * areas).sum()
        normal_forces = np.abs((world.contacts["force"] * world.contacts["normal"]).sum(axis=1))
        assert force == pytest.approx(normal_forces.sum(), rel=1e-5) and force > 0
    low, high = stage.GetDefaultPrim().GetAttribute("userProperties:color_range").Get()
    assert low == 0 and 0.5 * found.max() < high <= found.max() * (1 + 1e-6)
    colors = value(stage, "ball.primvars:displayColor", 6)
    np.testing.assert_allclose(colors[found >= high], [[0.9301, 0.7230, 0.0865]] * (found >= high).sum(), atol=1e-3)


def test_bodies_that_come_and_go_are_hidden_in_other_frames(tmp_path: Path) -> None:
    world, ball, _ = ball_world()
    with world.usd(tmp_path / "a.usd", every=0.01):
        world.run(0.02, dt=0.01)
        world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(1, 0, 1), name="later")
        world.run(0.03, dt=0.01)
        ball.remove()
        world.run(0.02, dt=0.01)
    stage = Usd.Stage.Open(str(tmp_path / "a.usd"))
    for name, frames in (("ball", range(6)), ("later", range(3, 8))):
        shown = UsdGeom.Imageable(stage.GetPrimAtPath(f"/World/{name}"))
        assert [frame for frame in range(8) if shown.ComputeVisibility(frame) == "inherited"] == list(frames)
        sizes = [np.ptp(world_points(stage, name, frame), axis=0).max() for frame in range(8)]
        np.testing.assert_allclose(sizes, [0.1 if frame in frames else 0 for frame in range(8)], atol=1e-2)


def test_names_become_valid_and_unique(tmp_path: Path) -> None:
    world = sk.World(threads=1)
    for number, name in enumerate(["2 balls", "a.b", "a/b", "Kugel ü", "Looks"]):
        world.add_body(sk.Mesh.ball(0.05, 2), RUBBER, position=(number, 0, 0), name=name)
    with world.usd(tmp_path / "a.usd"):
        pass
    stage = Usd.Stage.Open(str(tmp_path / "a.usd"))
    names = [prim.GetName() for prim in stage.GetDefaultPrim().GetChildren()]
    assert names == ["Looks", "_2_balls", "a_b", "a_b_1", "Kugel___", "Looks_1"]


def test_a_film_has_the_same_bytes_for_any_number_of_threads(tmp_path: Path) -> None:
    for threads in (1, 3):
        world = far_world(threads=threads)
        with world.usd(tmp_path / f"{threads}.usd", every=0.01, color="stress"):
            world.run(0.05, dt=0.01)
    assert (tmp_path / "1.usd").read_bytes() == (tmp_path / "3.usd").read_bytes()


def test_a_film_of_a_failed_run_shows_it_up_to_the_failure(tmp_path: Path) -> None:
    world, _, _ = ball_world()
    with pytest.raises(ZeroDivisionError), world.usd(tmp_path / "a.usd", every=0.01):
        world.run(0.03, dt=0.01)
        raise ZeroDivisionError
    assert Usd.Stage.Open(str(tmp_path / "a.usd")).GetEndTimeCode() == 3
    assert [file.name for file in tmp_path.iterdir()] == ["a.usd"]


def test_wrong_films_are_refused_and_leave_no_file(tmp_path: Path) -> None:
    world, _, _ = ball_world()
    (tmp_path / "file").write_text("")
    for path, options, message in (
        ("a.abc", {}, r"a\.abc: output: found the extension \.abc, expected \.usd or \.usdc"),
        ("file/a.usd", {}, "expected a folder"),
        ("a.usd", {"every": 0}, "every: found 0.0, expected a finite time > 0"),
        ("a.usd", {"color": "heat"}, "color: found 'heat', expected 'none', 'stress', 'speed' or 'contact'"),
        ("a.usd", {"color_max": -1}, "color_max: found -1.000000, expected a number above 0"),
    ):
        film = world.usd(tmp_path / path, **options)  # type: ignore[arg-type]
        with pytest.raises(sk.SceneError, match=message), film:
            pass
    assert [file.name for file in tmp_path.iterdir()] == ["file"]


def test_a_visual_surface_is_filmed_with_texture_and_materials(tmp_path: Path) -> None:
    world = painted_world(tmp_path)
    ball = world.bodies["ball"]
    start = np.asarray(ball.positions).mean(axis=0)
    (tmp_path / "films").mkdir()
    with world.usd(tmp_path / "films" / "a.usd", every=0.01):
        world.run(0.05, dt=0.01)
    stage = Usd.Stage.Open(str(tmp_path / "films" / "a.usd"))
    square = np.array([[-0.04, -0.04, 1], [0.04, -0.04, 1], [0.04, 0.04, 1], [-0.04, 0.04, 1]])
    moved = np.asarray(ball.positions).mean(axis=0) - start
    np.testing.assert_allclose(world_points(stage, "ball", 0), square, atol=1e-8)
    np.testing.assert_allclose(world_points(stage, "ball", 5), square + moved, atol=1e-7)
    texture = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/World/ball")).GetPrimvar("st")
    assert texture.GetInterpolation() == "faceVarying"
    np.testing.assert_array_equal(texture.ComputeFlattened(0)[3:], [(0, 0), (1, 1), (1, 0)])
    materials = {}
    for subset in UsdGeom.Subset.GetAllGeomSubsets(UsdGeom.Imageable(stage.GetPrimAtPath("/World/ball"))):
        material = UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()[0]
        materials[material.GetPrim().GetName()] = (list(subset.GetIndicesAttr().Get()), material)
    assert {name: faces for name, (faces, _) in materials.items()} == {"red_skin": [0], "picture": [1]}
    surface = materials["red_skin"][1].ComputeSurfaceSource()[0]
    assert tuple(surface.GetInput("diffuseColor").Get()) == pytest.approx(LINEAR)
    assert surface.GetInput("opacity").Get() == 0.5
    reader = materials["picture"][1].ComputeSurfaceSource()[0].GetInput("diffuseColor").GetConnectedSource()[0]
    image = UsdShade.Shader(reader).GetInput("file").Get()
    assert image.path == "../picture.png" and Path(image.resolvedPath).read_bytes() == PNG
