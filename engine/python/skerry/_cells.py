"""Cells of meshes of other packages: their kinds, their division into linear cells, labels and groups."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ._errors import scene_error
from ._sets import Parts

LABEL_NAMES = ("region", "gmsh:physical", "medit:ref", "CellEntityIds")
"""Names of cell data that hold labels, as in files."""
GMSH_KINDS = {4: "tetra", 11: "tetra10", 2: "triangle", 9: "triangle6"}
GMSH_CURVED = (29, 30, 31)
"""Element types of Gmsh of tetrahedra and triangles, and of tetrahedra of higher order."""
VTK_TETRAHEDRON = 10
VTK_NAMES = {5: "triangle", VTK_TETRAHEDRON: "tetra", 22: "triangle6", 24: "tetra10", 71: "VTK_LAGRANGE_TETRAHEDRON"}
KINDS: Mapping[str, Literal["face", "tetrahedron"]] = {"triangle": "face", "tetra": "tetrahedron"}
HIGHER_ORDER = ("tetra20", "tetra35", "VTK_LAGRANGE_TETRAHEDRON")
_NODES = {"tetra": 4, "tetra10": 10, "triangle": 3, "triangle6": 6}
_TRIANGLE_PARTS = np.array([[0, 3, 5], [1, 4, 3], [2, 5, 4], [3, 4, 5]])
"""Nodes of the four parts of a triangle of second order, as positions in the list of its nodes."""
_TETRAHEDRON_PARTS = np.array(
    [
        [(0, 4, 6, 7), (1, 5, 4, 8), (2, 6, 5, 9), (3, 7, 9, 8)] + [(a, b, ring[k - 1], ring[k]) for k in (1, 2, 3, 0)]
        for a, b, ring in ((4, 9, (5, 6, 7, 8)), (5, 7, (4, 8, 9, 6)), (6, 8, (4, 5, 9, 7)))
    ]
)
"""Nodes of the eight parts of a tetrahedron of second order, as positions in the list of its nodes, for each choice of
the diagonal a b."""


def require_low_order(object: str, curved: int) -> None:
    if curved:
        raise scene_error(
            object,
            "cells",
            f"{curved} tetrahedra of third or higher order",
            "tetrahedra of first or second order",
            "make a mesh of the first order",
        )


def linear_cells(kind: str, cells: NDArray[Any], points: NDArray[Any]) -> tuple[str, NDArray[Any]]:
    """Divides cells of second order (in the order of VTK) into linear ones, as read() does. Returns other cells as they
    are."""
    if kind == "triangle6":
        return "triangle", cells[:, _TRIANGLE_PARTS].reshape(-1, 3)
    if kind == "tetra10":
        diagonals = points[cells[:, _TETRAHEDRON_PARTS[:, 4, 0]]] - points[cells[:, _TETRAHEDRON_PARTS[:, 4, 1]]]
        parts = _TETRAHEDRON_PARTS[np.argmin((diagonals**2).sum(axis=2), axis=1)]
        return "tetra", cells[np.arange(len(cells))[:, None, None], parts].reshape(-1, 4)
    return kind, cells


def first_labels(data: Mapping[str, NDArray[Any]]) -> NDArray[np.int32] | None:
    """The first array of cell data that holds labels."""
    for name in LABEL_NAMES:
        values = data.get(name)
        if values is not None and values.ndim == 1 and np.array_equal(values, values.astype(np.int32)):
            return values.astype(np.int32)
    return None


def named_groups(mesh: Any, number: int, dimension: int | None) -> dict[str, NDArray[np.bool_]]:
    """Members of the named physical groups of Gmsh in a block of cells of a meshio.Mesh."""
    groups = mesh.cell_data.get("gmsh:physical")
    if groups is None:
        return {}
    return {
        name: np.asarray(groups[number]) == group[0]
        for name, group in getattr(mesh, "field_data", {}).items()
        if len(group) == 2 and group[1] == dimension
    }


def gmsh_cells(kind: int, nodes: NDArray[np.int64], points: NDArray[Any]) -> NDArray[Any]:
    """Linear cells of the elements of a type of Gmsh in GMSH_KINDS."""
    name = GMSH_KINDS[kind]
    cells = nodes.reshape(-1, _NODES[name])
    if name == "tetra10":
        cells = cells[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]]  # the middles of the last two edges change places
    return linear_cells(name, cells, points)[1]


def gmsh_groups(
    model: Any, place: NDArray[np.int64], points: NDArray[Any], volumes: NDArray[Any]
) -> dict[str, list[NDArray[Any]]]:
    """Physical groups of a Gmsh model. `place`: number of each node by tag. `volumes`: volume of each tetrahedron."""
    parts = Parts()
    for dimension, tag in model.getPhysicalGroups():
        name = model.getPhysicalName(dimension, tag)
        if not name and dimension == 3:
            continue
        name = name or f"{('point', 'curve', 'surface')[dimension]}_{tag}"
        entities = model.getEntitiesForPhysicalGroup(dimension, tag)
        if dimension == 3:
            parts.add_cells(name, "tetrahedron", np.flatnonzero(np.isin(volumes, entities)), 0)
            continue
        for entity in entities:
            kinds, _, nodes = model.mesh.getElements(dimension, entity)
            for kind, of_kind in zip(kinds, nodes, strict=True):
                cells = place[np.asarray(of_kind, dtype=np.int64)]
                if kind in GMSH_KINDS:
                    parts.add_cells(name, "face", gmsh_cells(kind, cells, points), 0)
                else:
                    parts.add_cells(name, "node", cells, 0)
    return parts.arrays()


def face_keys(nodes: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """A number for each face, equal for faces with equal nodes. `nodes`: ascending node numbers of the faces, with the
    shape (k, 3)."""
    keys: NDArray[np.int64] = (nodes[:, 0] * count + nodes[:, 1]) * count + nodes[:, 2]
    return keys
