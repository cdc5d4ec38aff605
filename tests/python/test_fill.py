"""Filling of surfaces with tetrahedra by the package wildmeshing (fTetWild), without the program skerry-fill."""

import os
from pathlib import Path

import numpy as np
import pytest

import skerry as sk

pytest.importorskip("wildmeshing")


@pytest.fixture(autouse=True)
def no_netgen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SKERRY_FILL", "/nowhere/skerry-fill")


def ball(radius: float, resolution: int = 6) -> sk.SurfaceMesh:
    return sk.Mesh.ball(radius, resolution).boundary()


def joined(*surfaces: sk.SurfaceMesh) -> sk.SurfaceMesh:
    starts = np.cumsum([0, *(len(surface.nodes) for surface in surfaces)])
    triangles = [surface.triangles + start for surface, start in zip(surfaces, starts, strict=False)]
    return sk.SurfaceMesh(
        nodes=np.concatenate([surface.nodes for surface in surfaces]), triangles=np.concatenate(triangles)
    )


def test_a_hole_is_closed_and_the_rest_stays_within_the_tolerance(tmp_path: Path) -> None:
    whole = ball(0.5)
    above = (whole.nodes[whole.triangles][:, :, 2] > 0.45).any(axis=1)
    lines = [f"v {x} {y} {z}" for x, y, z in whole.nodes]
    lines += [f"f {a} {b} {c}" for a, b, c in whole.triangles[~above] + 1]
    (tmp_path / "open.obj").write_text("\n".join(lines) + "\n")
    with pytest.warns(sk.Doubt) as doubts:
        mesh = sk.Mesh.fill(tmp_path / "open.obj", edge=0.15, tolerance=5e-3)
    assert any("hole" in str(doubt.message) for doubt in doubts)
    report = mesh.inspect()
    assert report.closed_manifold and report.inverted == 0
    below = mesh.boundary().nodes
    below = below[below[:, 2] < 0.2]
    flat = 0.5 - np.linalg.norm(whole.nodes[whole.triangles].mean(axis=1), axis=1).min()  # triangles lie inside
    radii = np.linalg.norm(below, axis=1)
    assert radii.max() < 0.5 + 5e-3 * 3**0.5 and radii.min() > 0.5 - flat - 5e-3 * 3**0.5
    assert os.listdir(tmp_path) == ["open.obj"]


def test_overlapping_shells_become_one_body_with_the_volume_of_their_union() -> None:
    box = sk.Mesh.box((1, 1, 1), 1).boundary()
    shifted = sk.SurfaceMesh(nodes=box.nodes + (0.6, 0.2, 0.1), triangles=box.triangles)
    with pytest.warns(sk.Doubt) as doubts:
        mesh = sk.Mesh.fill(joined(box, shifted), edge=0.5, tolerance=1e-2)
    assert any("united" in str(doubt.message) for doubt in doubts)
    assert mesh.volume == pytest.approx(2 - 0.4 * 0.8 * 0.9, rel=0.02)
    assert mesh.inspect().components == 1


def test_regions_are_labelled_after_the_surface_was_remeshed() -> None:
    with pytest.warns(sk.Doubt) as doubts:
        mesh = sk.Mesh.fill(joined(ball(0.5, 4), ball(0.25, 4)), edge=0.25, tolerance=2e-3)
    assert any("region" in str(doubt.message) for doubt in doubts)
    assert mesh.labels is not None
    corners = mesh.nodes[mesh.tetrahedra]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    inner = sk.Mesh.ball(0.25, 4).volume
    assert volumes[mesh.labels == 2].sum() == pytest.approx(inner, rel=0.05)
    assert volumes[mesh.labels == 1].sum() == pytest.approx(sk.Mesh.ball(0.5, 4).volume - inner, rel=0.02)
    assert set(mesh.sets) == {"shell_1", "shell_2"}


def test_errors_name_the_argument_and_the_package_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(sk.SceneError, match="edge: found -1"):
        sk.Mesh.fill(ball(0.5), edge=-1)
    with pytest.raises(sk.SceneError, match="scale: found 0, expected a factor above 0"):
        sk.Mesh.fill(ball(0.5), scale=0)
    with pytest.raises(sk.SceneError, match="time limit"):
        sk.Mesh.fill(ball(0.5), time_limit=0.01)
    with pytest.raises(TypeError):
        sk.Mesh.fill(3)  # type: ignore[arg-type]
    monkeypatch.setenv("SKERRY_FILL_PYTHON", "/nowhere/python")
    with pytest.raises(sk.SceneError, match="pip install wildmeshing"):
        sk.Mesh.fill(ball(0.5))
