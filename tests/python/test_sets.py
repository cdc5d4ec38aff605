"""Named sets of meshes and bodies, and attachments that hold single directions."""

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest

import skerry as sk

NODES = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]
TETRAHEDRA = [(0, 1, 2, 3), (1, 2, 3, 4)]


def cube(**changes: object) -> tuple[sk.World, sk.Body]:
    world = sk.World(gravity=(0, 0, 0))
    box = sk.Mesh.box((1, 1, 1), 2)
    labels = np.where(np.arange(len(box.tetrahedra)) < 6, 3, 4)
    mesh = sk.Mesh(box.nodes, box.tetrahedra, labels=labels, sets={"ends": [26, 0, 0]})
    return world, world.add_body(mesh, sk.Material(), dynamics="explicit", name="cube")


def test_a_mesh_has_sets() -> None:
    mesh = sk.Mesh(
        NODES,
        TETRAHEDRA,
        sets={"tip": [4, 4], "skin": sk.MeshSet(faces=[(0, 1, 2)]), "all": sk.MeshSet(tetrahedra=[1, 0])},
    )
    assert list(mesh.sets) == ["all", "skin", "tip"]
    assert np.array_equal(mesh.sets["tip"].nodes, [4])
    assert np.array_equal(mesh.sets["skin"].faces, [(0, 2, 1)])
    assert mesh.sets["all"] == sk.MeshSet(tetrahedra=[0, 1])
    assert mesh.inspect().sets == {"all": (0, 0, 2), "skin": (0, 1, 0), "tip": (1, 0, 0)}
    assert pickle.loads(pickle.dumps(mesh)) == mesh != sk.Mesh(NODES, TETRAHEDRA)
    assert repr(mesh.sets["all"]) == "<skerry.MeshSet 0 nodes, 0 faces, 2 tetrahedra>"
    with pytest.raises(sk.SceneError, match="node 5"):
        sk.Mesh(NODES, TETRAHEDRA, sets={"far": [5]})
    with pytest.raises(sk.SceneError, match="a face of a tetrahedron"):
        sk.Mesh(NODES, TETRAHEDRA, sets={"far": sk.MeshSet(faces=[(0, 1, 4)])})


def test_files_keep_sets(tmp_path: Path) -> None:
    mesh = sk.Mesh(NODES, TETRAHEDRA, labels=[1, 1], sets={"a b": [0, 3], "in": sk.MeshSet(tetrahedra=[1])})
    mesh.write(tmp_path / "m.msh")
    assert sk.Mesh.read(tmp_path / "m.msh").sets == mesh.sets


def test_parts_of_a_body_are_selected_by_name_and_label() -> None:
    world, body = cube()
    assert np.array_equal(body.select(set="ends"), [0, 26])
    assert np.array_equal(np.unique(body.tetrahedra[:6]), body.select(label=3))
    body.add_set("top", body.select(above=0.4))
    assert list(body.sets) == ["ends", "top"] and len(body.faces("top")) == 8
    assert np.array_equal(np.sort(body.faces(body.select(above=0.4)), axis=0), np.sort(body.faces("top"), axis=0))
    with pytest.raises(sk.SceneError, match="part: found 2 nodes, which are not all nodes of a face"):
        body.faces([0, 26])
    assert np.array_equal(
        body.select(set="top", where=lambda x: x[:, 0] > 0.4), body.select(above=0.4, where=lambda x: x[:, 0] > 0.4)
    )
    body.add_set("half", sk.MeshSet(tetrahedra=np.flatnonzero(body.labels == 3)))
    assert np.array_equal(body.tetrahedra_of("half"), range(6))
    twin = body.in_copy(copy.copy(world))
    assert list(twin.sets) == ["ends", "half", "top"]
    body.remove_set("top")
    with pytest.raises(sk.SceneError, match=r'"top", expected one of the sets "ends", "half"'):
        body.select(set="top")
    with pytest.raises(sk.SceneError, match=r"label: found 5, expected one of the labels \[3, 4\]"):
        body.select(label=5)


def test_the_tetrahedra_of_a_set_have_its_material() -> None:
    world = sk.World()
    mesh = sk.Mesh(NODES, TETRAHEDRA, sets={"heavy": sk.MeshSet(tetrahedra=[1])})
    body = world.add_body(mesh, sk.Material(density=1000), materials={"heavy": sk.Material(density=4000)})
    assert body.mass == pytest.approx(1000 / 6 + 4000 / 3)


def test_a_node_on_a_roller_moves_in_the_other_directions() -> None:
    world, body = cube()
    world.set_gravity((1, 0, -1))
    roller = body.attach(np.arange(body.node_count), axes="z")
    assert np.array_equal(roller.directions, [(0, 0, 1)])
    world.advance(0.1)
    assert np.allclose(body.velocities, (world.time, 0, 0), rtol=1e-9, atol=1e-12)
    with pytest.raises(sk.SceneError, match="oblique"):
        body.attach([0], directions=[(0, 1, 1)])
    for wrong in ("", "w", "xx"):
        with pytest.raises(ValueError, match="axes: found"):
            body.attach([0], axes=wrong)
    with pytest.raises(TypeError, match="at most one"):
        body.attach([0], axes="x", directions=[(1, 0, 0)])


def test_meshio_keeps_names() -> None:
    meshio = pytest.importorskip("meshio")
    cells = [("triangle", [(0, 1, 2), (1, 2, 4)]), ("tetra", TETRAHEDRA)]
    mesh = sk.Mesh.from_meshio(
        meshio.Mesh(
            NODES,
            cells,
            point_data={"held": np.array([1, 0, 0, 1, 0])},
            cell_data={
                "gmsh:physical": [np.array([7, 8]), np.array([1, 2])],
                "zone": [np.array([0, 5]), np.array([5, 0])],
            },
            point_sets={"tip": np.array([4])},
            cell_sets={"last": [None, np.array([1])]},
            field_data={"skin": np.array([7, 2]), "core": np.array([2, 3])},
        )
    )
    assert set(mesh.sets) == {"held", "zone_5", "tip", "last", "skin", "core"}
    assert mesh.sets["held"] == sk.MeshSet(nodes=[0, 3])
    assert np.array_equal(mesh.sets["zone_5"].tetrahedra, [0]) and len(mesh.sets["zone_5"].faces) == 1
    assert mesh.sets["tip"] == sk.MeshSet(nodes=[4])
    assert mesh.sets["last"] == mesh.sets["core"] == sk.MeshSet(tetrahedra=[1])
    assert len(mesh.sets["skin"].faces) == 1


def test_pyvista_keeps_names() -> None:
    pyvista = pytest.importorskip("pyvista")
    grid = pyvista.UnstructuredGrid({10: np.array(TETRAHEDRA), 5: np.array([(0, 1, 2)])}, np.array(NODES, dtype=float))
    kinds = np.asarray(grid.celltypes)
    grid.point_data["held"] = np.array([True, False, False, True, False])
    grid.cell_data["zone"] = np.where(kinds == 5, 2, 3)
    mesh = sk.Mesh.from_pyvista(grid)
    assert mesh.sets["held"] == sk.MeshSet(nodes=[0, 3])
    assert mesh.sets["zone_3"] == sk.MeshSet(tetrahedra=[0, 1]) and len(mesh.sets["zone_2"].faces) == 1


def test_gmsh_keeps_names(tmp_path: Path) -> None:
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 1)
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        gmsh.model.occ.addBox(1, 0, 0, 1, 1, 1)
        gmsh.model.occ.fragment([(3, 1)], [(3, 2)])
        gmsh.model.occ.synchronize()
        left = [tag for _, tag in gmsh.model.getEntities(2) if gmsh.model.occ.getCenterOfMass(2, tag)[0] < 1e-9]
        gmsh.model.addPhysicalGroup(2, left, name="left face")
        gmsh.model.addPhysicalGroup(3, [1], name="soft")
        gmsh.model.addPhysicalGroup(3, [1, 2], name="both")
        gmsh.model.addPhysicalGroup(0, [1], tag=9)
        gmsh.model.mesh.generate(3)
        files = []
        for version, binary in ((2.2, 0), (2.2, 1), (4.1, 0), (4.1, 1)):
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            files.append(tmp_path / f"m_{version}_{binary}.msh")
            gmsh.write(str(files[-1]))
        model = sk.Mesh.from_gmsh(gmsh.model)
    finally:
        gmsh.finalize()
    for mesh in (model, *map(sk.Mesh.read, files)):
        assert set(mesh.sets) == {"left face", "soft", "both", "point_9"}
        faces = np.asarray(mesh.sets["left face"].faces)
        assert len(faces) and np.all(mesh.nodes[faces][:, :, 0] == 0)
        corners = mesh.nodes[faces]
        assert np.all(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 0] < 0)  # outward
        assert len(mesh.sets["both"].tetrahedra) == len(mesh.tetrahedra)
        soft = mesh.tetrahedra[mesh.sets["soft"].tetrahedra]
        assert np.all(mesh.nodes[soft].mean(axis=1)[:, 0] < 1) and 0 < len(soft) < len(mesh.tetrahedra)
        assert len(mesh.sets["point_9"].nodes) == 1
