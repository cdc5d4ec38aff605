"""Surfaces that are drawn in place of bodies."""

from __future__ import annotations

import copy
import json
import pickle
import re
from pathlib import Path

import numpy as np
import pytest

import skerry as sk

SQUARE = "mtllib a.mtl\nv 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl red\nf 1/1 2/2 3/3\n"


def square(folder: Path) -> Path:
    (folder / "a.obj").write_text(SQUARE)
    (folder / "a.mtl").write_text("newmtl red\nKd 1 0 0\nmap_Kd gone.png\n")
    return folder / "a.obj"


def test_a_visual_surface_is_read_and_given_to_a_body(tmp_path: Path) -> None:
    surface = sk.VisualSurface.read(square(tmp_path), scale=2.0)
    assert surface.nodes.tolist() == [[0, 0, 0], [0.2, 0, 0], [0.2, 0.2, 0]]
    assert surface.texture_corners.tolist() == [[0, 1, 2]]
    assert surface.materials == (sk.VisualMaterial("red", (1.0, 0.0, 0.0), 1.0, str(tmp_path / "gone.png")),)
    world = sk.World()
    body = world.add_body(sk.Mesh.box((0.4, 0.4, 0.4), 1), sk.Material(), position=(1, 2, 3), visual=surface)
    assert np.allclose(body.visual_positions, surface.nodes + [1, 2, 3], atol=1e-15)
    assert body.visual is not None
    assert body.visual.file == str(tmp_path / "a.obj")
    assert copy.copy(world).bodies[0].visual is not None
    body.visual = None
    assert body.visual is None
    assert body.visual_positions.shape == (0, 3)


def test_a_surface_of_arrays_and_a_path_do_too(tmp_path: Path) -> None:
    world = sk.World()
    body = world.add_body(sk.Sphere(0.1), sk.Material(), visual=square(tmp_path))
    assert body.visual is not None and len(body.visual.triangles) == 1
    body.visual = sk.VisualSurface(
        [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]], [[0, 1, 2]], materials=[sk.VisualMaterial(opacity=0.5)], material=[0]
    )
    assert body.visual.materials[0].opacity == 0.5
    body.visual = sk.SurfaceMesh(np.eye(3) * 0.1, [[0, 1, 2]])
    assert body.visual.material.shape == (0,)


def test_bad_surfaces_are_refused_and_doubtful_ones_named(tmp_path: Path) -> None:
    world = sk.World()
    bad = sk.VisualSurface(np.eye(3), [[0, 1, 3]])
    with pytest.raises(sk.SceneError, match="triangles: found 3, expected an index below 3"):
        world.add_body(sk.Sphere(1), sk.Material(), visual=bad)
    assert len(world.bodies) == 0
    with pytest.raises(TypeError, match="material: found numbers of the type float64, expected whole numbers"):
        sk.VisualSurface(np.eye(3), [[0, 1, 2]], materials=[sk.VisualMaterial()], material=[0.7])
    with pytest.warns(sk.Doubt, match="times as large as the body; check the units"):
        world.add_body(sk.Sphere(1), sk.Material(), visual=sk.VisualSurface(1000 * np.eye(3), [[0, 1, 2]]))
    (tmp_path / "a.mtl").unlink(missing_ok=True)
    (tmp_path / "a.obj").write_text(SQUARE)
    with pytest.warns(sk.Doubt, match="material"):
        sk.VisualSurface.read(tmp_path / "a.obj")


def test_a_page_has_the_materials_and_names_missing_textures(tmp_path: Path) -> None:
    world = sk.World()
    world.add_body(sk.Sphere(0.1), sk.Material(), visual=square(tmp_path))
    with world.record(every=0.1) as film:
        world.advance(0.01)
    run = re.search(r'id="run">(.*?)</script>', film.show().html)
    assert run is not None
    values = json.loads(run[1])
    assert values["visual_of_body"] == [0]
    assert values["visuals"][0][0]["left_out"].endswith("gone.png")


def test_a_visual_surface_can_be_copied_pickled_and_compared(tmp_path: Path) -> None:
    (tmp_path / "a.mtl").write_text("newmtl red\nKd 1 0 0\nmap_Kd red.png\n")
    (tmp_path / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nusemtl red\nf 1/1 2/1 3/1\n")
    surface = sk.VisualSurface.read(tmp_path / "a.obj")
    for same in (copy.copy(surface), copy.deepcopy(surface), pickle.loads(pickle.dumps(surface))):
        assert same == surface and hash(same) == hash(surface) and same.file == surface.file
        assert same.materials == surface.materials
    assert surface != sk.VisualSurface(surface.nodes, surface.triangles)
    assert surface != 1


def test_paths_of_textures_are_absolute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.mtl").write_text("newmtl red\nmap_Kd red.png\n")
    Path("a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    assert sk.VisualSurface.read("a.obj").materials[0].texture == str(tmp_path / "red.png")
