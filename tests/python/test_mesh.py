"""Meshes: shapes, files, other packages and errors."""

import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import skerry as sk

NODES = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
TETRAHEDRA = [[0, 1, 2, 3], [1, 2, 3, 4]]
"""Two positive tetrahedra that share a face."""


def test_a_mesh_has_the_arrays_that_it_was_made_from() -> None:
    mesh = sk.Mesh(NODES, TETRAHEDRA, labels=[7, 9])
    assert mesh.nodes.dtype == np.float64 and mesh.tetrahedra.dtype == np.int32
    assert mesh.nodes.tolist() == NODES
    assert mesh.tetrahedra.tolist() == TETRAHEDRA
    assert mesh.labels is not None and mesh.labels.tolist() == [7, 9]
    assert mesh.volume == pytest.approx(1 / 6 + 1 / 3)
    assert repr(mesh) == "<skerry.Mesh 5 nodes, 2 tetrahedra, 2 labels>"


def test_the_arrays_of_a_mesh_cannot_be_changed() -> None:
    given = np.array(NODES, dtype=np.float64)
    mesh = sk.Mesh(given, TETRAHEDRA)
    given[0] = 5
    assert mesh.nodes[0, 0] == 0
    for array in (mesh.nodes, mesh.tetrahedra):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_equal_meshes_are_equal_and_pickled_meshes_return() -> None:
    mesh = sk.Mesh(NODES, TETRAHEDRA, labels=[7, 9])
    assert mesh == sk.Mesh(NODES, TETRAHEDRA, labels=[7, 9])
    assert mesh != sk.Mesh(NODES, TETRAHEDRA)
    again = pickle.loads(pickle.dumps(mesh))
    assert again == mesh and hash(again) == hash(mesh)


def test_an_array_of_another_shape_or_type_is_refused_with_both() -> None:
    with pytest.raises(TypeError, match=r"nodes: found an array of the shape \(5, 2\), expected \(n, 3\)"):
        sk.Mesh(np.zeros((5, 2)), TETRAHEDRA)
    with pytest.raises(TypeError, match=r"tetrahedra: found an array of the shape \(8,\), expected \(m, 4\)"):
        sk.Mesh(NODES, np.ravel(TETRAHEDRA))
    with pytest.raises(TypeError, match=r"labels: found an array of the shape \(1,\), expected \(2,\)"):
        sk.Mesh(NODES, TETRAHEDRA, labels=[7])
    with pytest.raises(TypeError, match="tetrahedra: found numbers of the type float64, expected whole numbers"):
        sk.Mesh(NODES, [[0, 1, 2, 3.5]])


@pytest.mark.parametrize(
    ("nodes", "tetrahedra", "message"),
    [
        (NODES, [[0, 1, 2, 5]], "mesh: tetrahedron 0: node: found 5, expected a node index from 0 to 4"),
        (NODES, [[0, 1, 2, 2]], "tetrahedron 0"),
        ([*NODES[:4], [0, 0, np.nan]], TETRAHEDRA, "mesh: node 4: position: found a coordinate that is not finite"),
    ],
)
def test_a_wrong_tetrahedron_or_node_is_refused_with_its_number(nodes: Any, tetrahedra: Any, message: str) -> None:
    with pytest.raises(sk.SceneError, match=message):
        sk.Mesh(nodes, tetrahedra)


@pytest.mark.parametrize("turned", [[0], [0, 1]])
def test_inverted_tetrahedra_are_turned_with_a_warning(turned: list[int]) -> None:
    rows = np.array(TETRAHEDRA)
    rows[turned, :2] = rows[turned, 1::-1]
    with pytest.warns(sk.Doubt, match=f"mesh: {len(turned)} of 2 tetrahedra list their nodes in the opposite order"):
        mesh = sk.Mesh(NODES, rows)
    assert mesh.inspect().inverted == 0
    assert mesh.volume == pytest.approx(0.5)


def test_tetrahedra_that_would_overlap_when_turned_stay_inverted() -> None:
    nodes = np.array([*NODES[:4], [0, 0, 0.5]])
    mesh = sk.Mesh(nodes, [[0, 1, 2, 3], [0, 2, 1, 4]])
    assert mesh.inspect().inverted == 1


SHAPES = [
    (sk.Mesh.box((1, 2, 3), (1, 2, 3)), 6.0),
    (sk.Mesh.box([1, 1, 1], 2), 1.0),
    (sk.Mesh.ball(1.0, 12), 4 / 3 * np.pi),
    (sk.Mesh.cylinder(1.0, 2.0, 12), 2 * np.pi),
    (sk.Mesh.lathe([(1, 0), (1, 2)], 12), 2 * np.pi),
    (sk.Mesh.table(height=0.3), 0.5 * 0.3 * 0.05 + 4 * 0.05**2 * 0.25),
]


@pytest.mark.parametrize(("mesh", "volume"), SHAPES)
def test_a_shape_has_its_volume(mesh: sk.Mesh, volume: float) -> None:
    # Flat triangles cut up to 5 % off a round shape with twelve elements across.
    assert mesh.volume == pytest.approx(volume, rel=0.05)
    report = mesh.inspect()
    assert report.volume == pytest.approx(mesh.volume)
    assert report.closed_manifold and report.inverted == 0


def test_a_skittle_stands_on_the_ground() -> None:
    report = sk.Mesh.skittle(0.4, 6).inspect()
    assert report.lower[2] == pytest.approx(0)
    assert report.upper[2] == pytest.approx(0.4)


def test_a_size_of_a_shape_must_be_positive() -> None:
    with pytest.raises(ValueError, match="radius"):
        sk.Mesh.ball(-1.0, 4)
    with pytest.raises(TypeError, match=r"cells: found an array of the shape \(2,\), expected \(3,\)"):
        sk.Mesh.box((1, 1, 1), (2, 2))


def test_a_written_mesh_is_read_back_equal(tmp_path: Path) -> None:
    mesh = sk.Mesh(np.array(NODES) / 3, TETRAHEDRA, labels=[7, 9])
    mesh.write(tmp_path / "a.msh")
    assert sk.Mesh.read(tmp_path / "a.msh") == mesh
    assert sk.read_surface(str(tmp_path / "a.msh")) == mesh.boundary()


def test_a_file_in_millimetres_is_read_in_metres(tmp_path: Path) -> None:
    mesh = sk.Mesh(np.array(NODES) * 1000, TETRAHEDRA, labels=[7, 9])
    mesh.write(tmp_path / "a.msh")
    read = sk.Mesh.read(tmp_path / "a.msh", scale=0.001)
    assert read.nodes == pytest.approx(np.array(NODES), rel=1e-15)
    assert np.array_equal(read.labels, mesh.labels)
    assert sk.read_surface(tmp_path / "a.msh", scale=0.001) == read.boundary()
    for scale in (0, -1, np.nan, np.inf):
        with pytest.raises(sk.SceneError, match="scale: found .*, expected a factor above 0"):
            sk.Mesh.read(tmp_path / "a.msh", scale=scale)


def test_a_file_that_cannot_be_read_is_named_in_the_error(tmp_path: Path) -> None:
    with pytest.raises(sk.SceneError, match=r"none\.msh") as caught:
        sk.Mesh.read(tmp_path / "none.msh")
    assert caught.value.file.endswith("none.msh")
    with pytest.raises(sk.SceneError, match=r"file name: found the extension \.step, expected"):
        sk.Mesh.read("a.step")


def test_the_notes_of_a_file_become_warnings(tmp_path: Path) -> None:
    mesh = sk.Mesh(NODES, TETRAHEDRA)
    mesh.write(tmp_path / "a.msh")
    text = (tmp_path / "a.msh").read_text()
    place = text.index("$Elements")
    lines = text[place:].splitlines()
    turned = [
        " ".join([*line.split()[:-2], *line.split()[:-3:-1]]) if len(line.split()) > 8 else line for line in lines
    ]
    (tmp_path / "b.msh").write_text(text[:place] + "\n".join(turned) + "\n")
    with pytest.warns(sk.Doubt, match="b.msh: 2 of 2 tetrahedra"):
        sk.Mesh.read(tmp_path / "b.msh")


def test_a_refined_mesh_has_eight_times_the_tetrahedra_and_the_same_sets() -> None:
    mesh = sk.Mesh(NODES, TETRAHEDRA, labels=[7, 9], sets={"base": sk.MeshSet(nodes=[0, 1, 2])})
    fine = mesh.refine()
    assert fine.labels is not None and fine.labels.tolist() == [7] * 8 + [9] * 8
    assert fine.nodes[:5].tolist() == NODES and fine.volume == pytest.approx(mesh.volume)
    base = fine.nodes[fine.sets["base"].nodes]
    assert len(base) == 6 and np.all(base[:, 2] == 0)


def test_the_boundary_has_outward_triangles() -> None:
    surface = sk.Mesh.box((1, 1, 1), 2).boundary()
    corners = surface.nodes[surface.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.all(np.einsum("ij,ij->i", normal, corners.mean(axis=1)) > 0)
    assert len(surface.triangles) == 6 * 2 * 2 * 2


def test_a_mesh_report_reads_well() -> None:
    lines = repr(sk.Mesh(NODES, TETRAHEDRA, labels=[7, 9]).inspect()).splitlines()
    assert lines[0] == "MeshReport"
    assert "  nodes: 5" in lines and "  labels: 7: 1, 9: 1" in lines and "  upper: (1, 1, 1)" in lines


def test_a_meshio_mesh_comes_and_goes(tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    mesh = sk.Mesh(NODES, TETRAHEDRA, labels=[7, 9])
    given = mesh.to_meshio()
    assert sk.Mesh.from_meshio(given) == mesh
    given.write(tmp_path / "a.vtu")
    given.write(tmp_path / "a.msh", file_format="gmsh22")
    assert sk.Mesh.from_meshio(meshio.read(tmp_path / "a.vtu")) == mesh
    assert sk.Mesh.read(tmp_path / "a.vtu") == mesh
    assert sk.Mesh.read(tmp_path / "a.msh") == mesh


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("a.msh", {"file_format": "gmsh22", "binary": False}),
        ("b.msh", {"file_format": "gmsh22", "binary": True}),
        ("a.vtk", {"file_format": "vtk42"}),
        ("b.vtk", {"file_format": "vtk51"}),
        ("a.vtu", {}),
        ("a.mesh", {}),
        ("a.meshb", {}),
        ("a.inp", {}),
    ],
)
def test_files_that_meshio_writes_are_read(tmp_path: Path, name: str, options: dict[str, Any]) -> None:
    meshio = pytest.importorskip("meshio")
    box = sk.Mesh.box((1.0, 1.1, 1.2), (1, 2, 2))
    skin = box.boundary().triangles  # in the numbers of the mesh, because all nodes are on the boundary
    labels = np.arange(len(box.tetrahedra)) % 3 + 1
    names = ("gmsh:physical", "gmsh:geometrical") if name.endswith(".msh") else ("medit:ref",)
    data = {of: [labels, np.full(len(skin), 5)] for of in names}
    given = meshio.Mesh(box.nodes, [("tetra", box.tetrahedra), ("triangle", skin)], cell_data=data)
    meshio.write(tmp_path / name, given, **options)
    mesh = sk.Mesh.read(tmp_path / name)
    np.testing.assert_array_equal(mesh.nodes, box.nodes)
    np.testing.assert_array_equal(mesh.tetrahedra, box.tetrahedra)
    if name != "a.inp":  # meshio writes no materials
        np.testing.assert_array_equal(mesh.labels, labels)
    if ".mesh" in name:
        np.testing.assert_array_equal(np.sort(mesh.sets["face_ref_5"].faces), np.sort(skin))


@pytest.mark.parametrize("binary", [False, True])
def test_a_surface_that_meshio_writes_as_ply_is_read(tmp_path: Path, binary: bool) -> None:
    meshio = pytest.importorskip("meshio")
    skin = sk.Mesh.ball(0.1, 4).boundary()
    meshio.write(tmp_path / "a.ply", meshio.Mesh(skin.nodes, [("triangle", skin.triangles)]), binary=binary)
    read = sk.read_surface(tmp_path / "a.ply")
    np.testing.assert_array_equal(read.nodes, skin.nodes)
    np.testing.assert_array_equal(read.triangles, skin.triangles)


def test_a_meshio_mesh_loses_what_is_not_a_tetrahedron() -> None:
    meshio = pytest.importorskip("meshio")
    points = [[9, 9, 9], *NODES]
    cells = [
        ("triangle", [[0, 1, 2]]),
        ("tetra", np.array(TETRAHEDRA[:1]) + 1),
        ("tetra", np.array(TETRAHEDRA[1:]) + 1),
    ]
    data = {"size": [[0.5], [0.5], [0.5]], "region": [[3], [7], [9]]}
    assert sk.Mesh.from_meshio(meshio.Mesh(points, cells, cell_data=data)) == sk.Mesh(NODES, TETRAHEDRA, labels=[7, 9])
    with pytest.raises(sk.SceneError, match="meshio mesh: cells: found no tetrahedra"):
        sk.Mesh.from_meshio(meshio.Mesh(points, cells[:1]))
    with pytest.raises(sk.SceneError, match="found 1 tetrahedra of third or higher order, expected"):
        sk.Mesh.from_meshio(meshio.Mesh(np.zeros((20, 3)), [("tetra20", [range(20)])]))


def _second_order(mesh: sk.Mesh) -> tuple[Any, Any, Any]:
    """Nodes, tetrahedra and boundary triangles of second order of a mesh whose nodes are all on the boundary."""
    nodes = [*mesh.nodes]
    number: dict[tuple[int, int], int] = {}

    def middle(a: int, b: int) -> int:
        if (min(a, b), max(a, b)) not in number:
            number[min(a, b), max(a, b)] = len(nodes)
            nodes.append((mesh.nodes[a] + mesh.nodes[b]) / 2 + 0.003)
        return number[min(a, b), max(a, b)]

    edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    cells = [[*t, *(middle(t[a], t[b]) for a, b in edges)] for t in mesh.tetrahedra]
    faces = [[*t, *(middle(t[a], t[b]) for a, b in edges[:3])] for t in mesh.boundary().triangles]
    return np.array(nodes), np.array(cells), np.array(faces)


@pytest.mark.parametrize("name", ["a.msh", "a.vtk", "a.vtu", "a.inp"])
def test_cells_of_second_order_are_divided_alike_in_files_and_meshio_meshes(tmp_path: Path, name: str) -> None:
    meshio = pytest.importorskip("meshio")
    nodes, cells, faces = _second_order(sk.Mesh.box((1.0, 1.1, 1.2), (1, 2, 2)))
    labels = np.arange(len(cells)) % 3 + 1
    part = np.arange(len(cells)) % 2
    data = {"gmsh:physical": [labels, np.full(len(faces), 5)], "gmsh:geometrical": [labels, np.full(len(faces), 5)]}
    if name != "a.msh":
        data |= {"part": [part, np.ones(len(faces), dtype=int)]}
    given = meshio.Mesh(nodes, [("tetra10", cells), ("triangle6", faces)], cell_data=data)
    meshio.write(tmp_path / name, given, **({"file_format": "gmsh22", "binary": False} if name == "a.msh" else {}))
    with pytest.warns(sk.Doubt, match=f"{len(cells)} tetrahedra of second order were divided"):
        mesh = sk.Mesh.read(tmp_path / name)
    converted = sk.Mesh.from_meshio(given)
    np.testing.assert_array_equal(mesh.nodes, nodes)
    np.testing.assert_array_equal(mesh.tetrahedra, converted.tetrahedra)
    np.testing.assert_array_equal(converted.labels, np.repeat(labels, 8))
    report = converted.inspect()
    assert report.inverted == 0 and report.closed_manifold and report.boundary_triangles == 4 * len(faces)
    if name != "a.inp":  # meshio writes no cell data
        np.testing.assert_array_equal(mesh.labels, converted.labels)
    if name in ("a.vtk", "a.vtu"):
        assert dict(mesh.sets) == dict(converted.sets)
        assert np.shape(mesh.sets["part"].faces) == (4 * len(faces), 3)


def test_a_pyvista_grid_comes_and_goes() -> None:
    pyvista = pytest.importorskip("pyvista")
    mesh = sk.Mesh(NODES, TETRAHEDRA, labels=[7, 9])
    grid = mesh.to_pyvista()
    assert grid.compute_cell_sizes()["Volume"].sum() == pytest.approx(mesh.volume)
    assert sk.Mesh.from_pyvista(grid) == mesh
    nodes, cells, _ = _second_order(mesh)
    curved = pyvista.UnstructuredGrid({24: cells}, nodes)
    assert sk.Mesh.from_pyvista(curved) == sk.Mesh.from_meshio(pyvista.to_meshio(curved))
    with pytest.raises(sk.SceneError, match="PyVista grid: cells: found no tetrahedra"):
        sk.Mesh.from_pyvista(pyvista.ImageData(dimensions=(2, 2, 2)).cast_to_unstructured_grid())


def test_a_gmsh_model_gives_its_physical_groups_as_labels() -> None:
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        first, second = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1), gmsh.model.occ.addBox(1, 0, 0, 1, 1, 1)
        gmsh.model.occ.fragment([(3, first)], [(3, second)])
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
        gmsh.model.mesh.generate(3)
        mesh = sk.Mesh.from_gmsh(gmsh.model)
        assert mesh.volume == pytest.approx(2)
        assert mesh.labels is not None and set(mesh.labels) == {first, second}
        gmsh.model.addPhysicalGroup(3, [second], 17)
        mesh = sk.Mesh.from_gmsh(gmsh.model)
        assert mesh.labels is not None and set(mesh.labels) == {0, 17}
        middle = mesh.nodes[mesh.tetrahedra[mesh.labels == 17]].mean(axis=(0, 1))
        assert middle[0] > 1
    finally:
        gmsh.finalize()


DATA = os.environ.get("SKERRY_TEST_DATA")


@pytest.mark.skipif(not DATA, reason="SKERRY_TEST_DATA names no folder with meshes in it")
def test_malformed_files_of_other_programs_are_refused_by_name() -> None:
    for path in (Path(DATA or "") / "meshes" / "malformed").iterdir():
        with pytest.raises(sk.SceneError, match=path.name):
            sk.Mesh.read(path)


@pytest.mark.parametrize(
    ("make", "object", "field", "found"),
    [
        (lambda: sk.Mesh.ball(1, 0), "ball", "resolution", "0"),
        (lambda: sk.Mesh.box((1, 0, 1), 2), "box", "size", "0"),
        (lambda: sk.Mesh.box((1, 1, 1), 2**20), "box", "cells", "a mesh of about 6.91753e+18 elements"),
        (lambda: sk.Mesh.cylinder(1, np.inf, 4), "cylinder", "height", "inf"),
        (lambda: sk.Mesh.lathe([(1, 0), (1, -1)], 4), "lathe", "profile", "z = -1 at point 1"),
        (lambda: sk.Mesh.table(leg=0.2), "table", "leg", "0.2"),
    ],
)
def test_a_wrong_size_of_a_shape_is_named(make: Any, object: str, field: str, found: str) -> None:
    with pytest.raises(sk.SceneError, match=f"^{object}: {field}: found ") as caught:
        make()
    assert (caught.value.object, caught.value.field, caught.value.found) == (object, field, found)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sk.Mesh.ball(1, 4.0), "resolution: found 4.0, expected a whole number"),  # type: ignore[arg-type]
        (lambda: sk.Mesh.ball("1", 4), "radius: found '1', expected a number"),  # type: ignore[arg-type]
        (lambda: sk.Mesh.table(cells_per_leg=1.5), "cells_per_leg: found 1.5"),  # type: ignore[arg-type]
        (lambda: sk.Mesh.read(b"a.msh"), "path: found b'a.msh', expected a path"),  # type: ignore[arg-type]
        (lambda: sk.read_surface(3), "path: found 3, expected a path"),  # type: ignore[arg-type]
        (lambda: sk.Mesh.from_meshio("x"), "mesh: found 'x', expected a meshio.Mesh"),
        (lambda: sk.Mesh.from_pyvista("x"), "grid: found 'x', expected a pyvista.UnstructuredGrid"),
        (lambda: sk.Mesh.from_gmsh("x"), "model: found 'x', expected gmsh.model"),
    ],
)
def test_an_argument_of_a_wrong_type_is_named(make: Any, message: str) -> None:
    with pytest.raises(TypeError, match=f"^{message}"):
        make()


def test_numbers_of_numpy_are_numbers_of_cells() -> None:
    assert sk.Mesh.box((1, 1, 1), np.int64(2)) == sk.Mesh.box((1, 1, 1), (2, 2, 2))  # type: ignore[arg-type]
    assert sk.Mesh.ball(np.float64(1), np.int32(4)) == sk.Mesh.ball(1, 4)  # type: ignore[arg-type]


def test_a_written_mesh_without_labels_returns_with_the_label_1(tmp_path: Path) -> None:
    for labels in ([7, 9], None):
        mesh = sk.Mesh(NODES, TETRAHEDRA, labels=labels)
        mesh.write(tmp_path / "two.msh")
        assert sk.Mesh.read(tmp_path / "two.msh") == sk.Mesh(NODES, TETRAHEDRA, labels=labels or [1, 1])


def test_a_surface_check_finds_faults_and_shells() -> None:
    ball = sk.Mesh.ball(0.5, 6).boundary()
    count = len(ball.triangles)
    report = sk.check_surface(ball)
    assert report.faults == () and report.can_be_filled and len(report.shells) == 1
    assert report.shells[0] == sk.SurfaceShell(
        triangles=count, triangle=0, closed=True, volume=report.volume, around=None
    )
    # An inner shell, and a repeated triangle.
    nested = sk.SurfaceMesh(
        nodes=np.vstack([ball.nodes, 0.5 * ball.nodes]),
        triangles=np.vstack([ball.triangles, ball.triangles[:, ::-1] + len(ball.nodes), ball.triangles[:1]]),
    )
    report = sk.check_surface(nested)
    assert [fault.kind for fault in report.faults] == ["duplicate_triangles"]
    assert report.faults[0].triangle == 2 * count and "1 repeated triangle at (" in report.faults[0].text
    assert [shell.around for shell in report.shells] == [None, 0]
    assert report.volume == pytest.approx(7 / 8 * report.shells[0].volume)
    assert len(report.cleaned.triangles) == len(report.number) == len(report.shell) == 2 * count
    with pytest.raises(sk.SceneError, match="triangle 0: node: found 7"):
        sk.check_surface(sk.SurfaceMesh(nodes=np.zeros((3, 3)), triangles=[[0, 1, 7]]))


def test_a_surface_check_reads_a_file(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    report = sk.check_surface(tmp_path / "a.obj")
    assert report.area == 0.5
    assert report.faults == sk.check_surface(str(tmp_path / "a.obj")).faults != ()
