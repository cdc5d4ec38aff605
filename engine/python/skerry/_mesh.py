"""Tetrahedral meshes."""

from __future__ import annotations

import math
import os
import sys
import warnings
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import (
    VectorLike,
    counted,
    index_array,
    path_text,
    read_only,
    real,
    real_array,
    require_attributes,
)
from ._cells import (
    GMSH_CURVED,
    GMSH_KINDS,
    HIGHER_ORDER,
    KINDS,
    LABEL_NAMES,
    VTK_NAMES,
    VTK_TETRAHEDRON,
    face_keys,
    first_labels,
    gmsh_cells,
    gmsh_groups,
    linear_cells,
    named_groups,
    require_low_order,
)
from ._errors import Doubt, import_package, scene_error
from ._mesh_report import MeshReport
from ._sets import MeshSet, Parts, SetsLike, set_of, sets_arrays, sets_of_numbers
from ._settings import SurfaceMesh

Path: TypeAlias = str | os.PathLike[str]


class Mesh:
    """A tetrahedral mesh in its own frame. It cannot be changed, and its arrays are read-only.

    nodes: positions of the nodes, shape (n, 3) [m].
    tetrahedra: numbers of the nodes of each tetrahedron, shape (m, 4).
    labels: label of each tetrahedron, shape (m,), such as the number of its material; None: no labels.
    sets: named parts, each a MeshSet or an array of node numbers.

    TypeError: an array has the wrong shape or type.
    SceneError: a tetrahedron names a node that does not exist, or the same node twice. Inverted tetrahedra are turned
        as by read(), with a warning Doubt."""

    __slots__ = ("_arrays", "_core")

    def __init__(
        self,
        nodes: ArrayLike,
        tetrahedra: ArrayLike,
        *,
        labels: ArrayLike | None = None,
        sets: SetsLike | None = None,
    ) -> None:
        points = real_array(nodes, "nodes", ("n", 3))
        rows = index_array(tetrahedra, "tetrahedra", ("m", 4))
        given = None if labels is None else index_array(labels, "labels", (len(rows),))
        core, notes = _core.new_mesh(points, rows, given, sets_arrays(sets))
        self._hold(core)
        _warn(notes)

    def _hold(self, core: Any) -> None:
        self._core = core
        self._arrays: dict[str, Any] = {}

    @classmethod
    def _of(cls, core: Any) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._hold(core)
        return mesh

    # Files.

    @staticmethod
    def read(path: Path, *, scale: float = 1) -> Mesh:
        """Reads a mesh from Gmsh .msh (1, 2.2, 4.1), VTK .vtk or .vtu, TetGen .node and .ele, Medit .mesh and .meshb,
        or Abaqus .inp.

        Tetrahedra of second order are divided into eight linear ones each. Other elements and unused nodes are dropped.
        Labels are physical groups (Gmsh), the cell data region, gmsh:physical, medit:ref or CellEntityIds (VTK), the
        last attribute (TetGen), references (Medit), or numbers of the materials of solid sections (Abaqus). Sets are
        physical groups by name, or surface_N and the like without one (Gmsh); arrays NAME of zeros and ones, and NAME_N
        for each number N of other arrays of whole numbers (VTK); node_marker_N and face_marker_N (TetGen); node_ref_N
        and face_ref_N (Medit); sets and surfaces by name, after INSTANCE and a dot (Abaqus). Inverted tetrahedra are
        turned. A warning Doubt reports what was divided, dropped or turned. scale: factor for all coordinates, 0.001
        for a file in millimetres. SceneError: the file cannot be read, or has no tetrahedra."""
        core, notes = _core.read_mesh(path_text(path, "path"), _scale(scale))
        _warn(notes)
        return Mesh._of(core)

    def write(self, path: Path) -> None:
        """Writes the mesh as Gmsh 2.2 text with all digits. read() returns an equal mesh, except that a mesh without
        labels gets the label 1 everywhere. The name must end in .msh. An existing file is replaced completely or not at
        all."""
        _core.write_mesh(path_text(path, "path"), self._core)

    # Surfaces.

    @staticmethod
    def fill(
        surface: SurfaceMesh | Path | Sequence[Path],
        *,
        scale: float = 1,
        edge: float | None = None,
        tolerance: float = 1e-3,
        cavities: bool = False,
        time_limit: float = 300,
        memory_limit: float = 8e9,
    ) -> Mesh:
        """Fills a triangle surface, or the surfaces of one or more files, with tetrahedra.

        scale: factor for all coordinates of the surfaces, 0.001 for millimetres. Other lengths are those after scaling.
        edge: edge length of the tetrahedra and of their surface [m]. Without it the triangles of a surface without
            faults are kept, and other surfaces get a twentieth of the diagonal of the bounding box.
        tolerance: largest distance between surface and mesh, as a fraction of this diagonal. With 0 all triangles are
            kept, and surfaces with faults are refused.
        cavities: True: the inside of inner shells is empty. False: only of shells whose triangles are clockwise as seen
            from outside. The other inner shells bound regions with labels of their own.
        time_limit: time limit of each run of a mesher [s].
        memory_limit: memory limit of a mesher [bytes].

        Surfaces without faults are filled by Netgen, which needs the program skerry-fill in PATH. Other surfaces, and
        all surfaces without this program, are filled by fTetWild, the package wildmeshing of this Python interpreter or
        of the one named in SKERRY_FILL_PYTHON. Of several meshes the one with the longest stable step is returned.
        Faults and corrections are warnings Doubt. SceneError: a file cannot be read, a mesher is not installed, or no
        mesher fills the surface within the limits."""
        if isinstance(surface, SurfaceMesh):
            given: Any = (surface.nodes, surface.triangles)
        else:
            files = [surface] if isinstance(surface, str | os.PathLike) else surface
            given = [path_text(file, "surface") for file in files]
        length = None if edge is None else real(edge, "edge")
        limits = real(time_limit, "time_limit"), real(memory_limit, "memory_limit")
        python = os.environ.get("SKERRY_FILL_PYTHON", sys.executable)
        factor, share = real(scale, "scale"), real(tolerance, "tolerance")
        core, notes = _core.fill(given, factor, length, share, bool(cavities), *limits, python)
        _warn(notes)
        return Mesh._of(core)

    # Shapes.

    @staticmethod
    def box(size: VectorLike, cells: int | Sequence[int] | NDArray[Any]) -> Mesh:
        """A box around the origin with edge lengths `size` (3,) [m], divided into `cells` cells along x, y and z (one
        number for each, or one for all) with six tetrahedra each."""
        numbers = index_array(np.broadcast_to(cells, (3,)) if np.ndim(cells) == 0 else cells, "cells", (3,))
        return Mesh._of(_core.box(real_array(size, "size", (3,)), numbers.tolist()))

    @staticmethod
    def ball(radius: float, resolution: int) -> Mesh:
        """A ball around the origin with `resolution` elements across the diameter; radius in [m]."""
        return Mesh._of(_core.ball(real(radius, "radius"), counted(resolution, "resolution")))

    @staticmethod
    def cylinder(radius: float, height: float, resolution: int) -> Mesh:
        """A cylinder around the origin, along z, with `resolution` elements across the diameter; lengths in [m]."""
        sizes = real(radius, "radius"), real(height, "height")
        return Mesh._of(_core.cylinder(*sizes, counted(resolution, "resolution")))

    @staticmethod
    def lathe(profile: ArrayLike, resolution: int) -> Mesh:
        """A solid of revolution about z. `profile`, shape (k, 2), lists radius and z [m] from bottom to top. There are
        `resolution` elements across the largest diameter."""
        outline = real_array(profile, "profile", ("k", 2))
        return Mesh._of(_core.lathe(outline, counted(resolution, "resolution")))

    @staticmethod
    def skittle(height: float, resolution: int) -> Mesh:
        """A ninepin that stands on z = 0; height in [m]."""
        return Mesh._of(_core.skittle(real(height, "height"), counted(resolution, "resolution")))

    @staticmethod
    def table(
        *,
        length: float = 0.5,
        width: float = 0.3,
        height: float = 0.3,
        thickness: float = 0.05,
        leg: float = 0.05,
        cells_per_leg: int = 1,
    ) -> Mesh:
        """A table that stands on z = 0: a top of length (x), width (y) and thickness (z) on four square legs with the
        edge length `leg`, divided into `cells_per_leg` cells. `height` includes the top. All lengths in [m]."""
        sizes = {"length": length, "width": width, "height": height, "thickness": thickness, "leg": leg}
        length, width, height, thickness, leg = (real(size, name) for name, size in sizes.items())
        return Mesh._of(_core.table(length, width, height, thickness, leg, counted(cells_per_leg, "cells_per_leg")))

    # Other packages.

    @staticmethod
    def from_meshio(mesh: Any) -> Mesh:
        """Mesh of a meshio.Mesh. Labels are the first cell data named region, gmsh:physical, medit:ref or
        CellEntityIds that hold whole numbers. Sets are point sets, cell sets, physical groups with a name, and data of
        whole numbers by the rules of read(). Tetrahedra of second order are divided as by read(). Cells that are not
        tetrahedra and unused nodes are dropped."""
        require_attributes(mesh, "mesh", "a meshio.Mesh", "cells", "cell_data", "points")
        blocks = [(block.type, np.asarray(block.data)) for block in mesh.cells]
        named = []
        for number, block in enumerate(mesh.cells):
            sets = {
                name: np.isin(np.arange(len(block.data)), of_block[number])
                for name, of_block in getattr(mesh, "cell_sets", {}).items()
                if of_block[number] is not None
            }
            named.append(sets | named_groups(mesh, number, block.dim if hasattr(block, "dim") else None))
        return _mesh_of_blocks(
            "meshio mesh",
            mesh.points,
            blocks,
            {name: [np.asarray(values) for values in data] for name, data in mesh.cell_data.items()},
            named,
            getattr(mesh, "point_data", {}),
            getattr(mesh, "point_sets", {}),
        )

    def to_meshio(self) -> Any:
        """The mesh as a meshio.Mesh. Labels become the cell data gmsh:physical. Needs the package meshio."""
        meshio = import_package("meshio")
        data = {} if self.labels is None else {"gmsh:physical": [self.labels], "gmsh:geometrical": [self.labels]}
        return meshio.Mesh(self.nodes, [("tetra", self.tetrahedra)], cell_data=data)

    @staticmethod
    def from_pyvista(grid: Any) -> Mesh:
        """Mesh of a pyvista.UnstructuredGrid. Labels and sets are found, and cells divided or dropped, as by
        from_meshio()."""
        require_attributes(grid, "grid", "a pyvista.UnstructuredGrid", "celltypes", "cells_dict", "cell_data", "points")
        kinds, cells = np.asarray(grid.celltypes), dict(grid.cells_dict)
        return _mesh_of_blocks(
            "PyVista grid",
            grid.points,
            [(VTK_NAMES.get(int(kind), str(kind)), np.asarray(of_kind)) for kind, of_kind in cells.items()],
            {name: [np.asarray(grid.cell_data[name])[kinds == kind] for kind in cells] for name in grid.cell_data},
            [{} for _ in cells],
            getattr(grid, "point_data", {}),
            {},
        )

    def to_pyvista(self) -> Any:
        """The mesh as a pyvista.UnstructuredGrid. Labels become the cell data region. Needs the package pyvista."""
        pyvista = import_package("pyvista")
        grid = pyvista.UnstructuredGrid({VTK_TETRAHEDRON: self.tetrahedra}, self.nodes)
        if self.labels is not None:
            grid.cell_data["region"] = self.labels
        return grid

    @staticmethod
    def from_gmsh(model: Any) -> Mesh:
        """Mesh of the current model of Gmsh: Mesh.from_gmsh(gmsh.model). The label of a tetrahedron is the number of
        its physical group (the first, if its volume is in several), and 0 outside of all groups; if no tetrahedron is
        in a group, it is the number of its volume. Sets are the physical groups, and tetrahedra of second order are
        divided, as by read()."""
        require_attributes(model, "model", "gmsh.model", "mesh", "getEntities", "getPhysicalGroupsForEntity")
        tags, positions, _ = model.mesh.getNodes()
        place = np.zeros(int(max(tags, default=0)) + 1, dtype=np.int64)
        place[np.asarray(tags, dtype=np.int64)] = np.arange(len(tags))
        points = np.reshape(positions, (-1, 3))
        rows, groups, volumes, curved = [], [], [], 0
        for _, volume in model.getEntities(3):
            kinds, _, nodes = model.mesh.getElements(3, volume)
            for kind, of_kind in zip(kinds, nodes, strict=True):
                curved += len(of_kind) if kind in GMSH_CURVED else 0
                if kind not in GMSH_KINDS:
                    continue
                rows.append(gmsh_cells(kind, place[np.asarray(of_kind, dtype=np.int64)], points))
                group = next(iter(model.getPhysicalGroupsForEntity(3, volume)), 0)
                groups.append(np.full(len(rows[-1]), group))
                volumes.append(np.full(len(rows[-1]), volume))
        require_low_order("Gmsh model", curved)
        labels = groups if any(np.any(group) for group in groups) else volumes
        return _mesh_of_used_nodes(
            "Gmsh model",
            points,
            rows,
            np.concatenate(labels) if labels else None,
            gmsh_groups(model, place, points, np.concatenate(volumes) if volumes else np.empty(0)),
        )

    # Contents.

    @property
    def nodes(self) -> NDArray[np.float64]:
        """Positions of the nodes, shape (n, 3), read-only [m]."""
        array: NDArray[np.float64] = self._array("nodes")
        return array

    @property
    def tetrahedra(self) -> NDArray[np.int32]:
        """Numbers of the nodes of each tetrahedron, shape (m, 4), read-only."""
        array: NDArray[np.int32] = self._array("tetrahedra")
        return array

    @property
    def labels(self) -> NDArray[np.int32] | None:
        """Label of each tetrahedron, shape (m,), read-only; None if the mesh has no labels."""
        array: NDArray[np.int32] | None = self._array("labels")
        return array

    @property
    def file_number(self) -> NDArray[np.int32] | None:
        """Number of each node in the file that was read, counted from 0, shape (n,), read-only; None if it is the
        number in `nodes`."""
        array: NDArray[np.int32] | None = self._array("file_number")
        return array

    @property
    def sets(self) -> Mapping[str, MeshSet]:
        """Named parts of the mesh."""
        if "sets" not in self._arrays:
            self._arrays["sets"] = {name: set_of(arrays) for name, arrays in self._core.sets().items()}
        return MappingProxyType(self._arrays["sets"])

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        corners = self.nodes[self.tetrahedra]
        return float(np.linalg.det(corners[:, 1:] - corners[:, :1]).sum() / 6)

    def boundary(self) -> SurfaceMesh:
        """The triangles of the boundary, counter-clockwise as seen from outside."""
        nodes, triangles = _core.boundary(self._core)
        return SurfaceMesh(nodes=nodes, triangles=triangles)

    def refine(self) -> Mesh:
        """The mesh with each tetrahedron divided into eight by new nodes at the midpoints of its edges. The shape of
        the surface stays the same, the new nodes follow the present ones, and parts have the labels and sets of the
        whole. A set of nodes gets the midpoints of edges of faces whose nodes are all in the set, and of edges between
        its nodes outside of such faces, as on a curve."""
        return Mesh._of(_core.refine(self._core))

    def inspect(self) -> MeshReport:
        """Statistics of size, quality and faults."""
        return MeshReport(**_core.inspect(self._core))

    def _array(self, name: str) -> Any:
        if name not in self._arrays:
            array = getattr(self._core, name)()
            self._arrays[name] = None if array is None else read_only(array)
        return self._arrays[name]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mesh):
            return NotImplemented
        arrays = zip(self._contents(), other._contents(), strict=True)
        return all(np.array_equal(a, b) for a, b in arrays) and dict(self.sets) == dict(other.sets)

    def __hash__(self) -> int:
        return hash((self.nodes.tobytes(), self.tetrahedra.tobytes()))

    def _contents(self) -> tuple[Any, ...]:
        return (self.nodes, self.tetrahedra, self.labels, self.file_number)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_same_mesh, (*self._contents(), dict(self.sets)))

    def __repr__(self) -> str:
        labels = "" if self.labels is None else f", {len(np.unique(self.labels)):,} labels"
        return f"<skerry.Mesh {len(self.nodes):,} nodes, {len(self.tetrahedra):,} tetrahedra{labels}>"


def read_surface(path: Path, *, scale: float = 1) -> SurfaceMesh:
    """Reads a triangle surface from a file in one of the formats of Mesh.read(), or from .obj, .ply or .stl. The
    surface of a tetrahedral mesh is its boundary. scale: factor for all coordinates, 0.001 for a file in
    millimetres."""
    (nodes, triangles), notes = _core.read_surface(path_text(path, "path"), _scale(scale))
    _warn(notes)
    return SurfaceMesh(nodes=nodes, triangles=triangles)


def _scale(given: float) -> float:
    """A factor for coordinates."""
    factor = real(given, "scale")
    if not (math.isfinite(factor) and factor > 0):
        raise scene_error("", "scale", str(factor), "a factor above 0")
    return factor


def _same_mesh(nodes: Any, tetrahedra: Any, labels: Any, file_number: Any, sets: SetsLike) -> Mesh:
    return Mesh._of(_core.same_mesh(nodes, tetrahedra, labels, file_number, sets_arrays(sets)))


def _warn(notes: list[str]) -> None:
    for note in notes:
        warnings.warn(note, Doubt, stacklevel=3)


def _mesh_of_blocks(
    object: str,
    points: ArrayLike,
    blocks: list[tuple[str, NDArray[Any]]],
    data: Mapping[str, list[NDArray[Any]]],
    named: list[dict[str, NDArray[np.bool_]]],
    point_data: Mapping[str, Any],
    point_sets: Mapping[str, Any],
) -> Mesh:
    """Mesh of the cells of another package. `blocks`: kind (as in meshio) and nodes of cells. `data`: for each name an
    array for each block. `named`: for each block the members of named sets."""
    require_low_order(object, sum(len(cells) for kind, cells in blocks if kind in HIGHER_ORDER))
    positions = real_array(points, f"{object}: points", ("n", 3))
    parts = Parts()
    for name, nodes in point_sets.items():
        parts.add_nodes(name, nodes)
    for name, values in point_data.items():
        for of_set, members in sets_of_numbers(name, np.asarray(values)).items():
            parts.add_nodes(of_set, np.flatnonzero(members))
    numbers: dict[str, NDArray[np.bool_]] = {}
    for name, values in data.items():
        if name not in LABEL_NAMES and values and all(np.ndim(of_block) == 1 for of_block in values):
            numbers |= sets_of_numbers(name, np.concatenate(values))
    rows: list[NDArray[Any]] = []
    of_rows: dict[str, list[NDArray[Any]]] = {}
    first = first_cell = 0
    for number, (kind, cells) in enumerate(blocks):
        linear, pieces = linear_cells(kind, cells, positions)
        count = len(pieces) // max(len(cells), 1)
        of_block = {name: of_all[first_cell : first_cell + len(cells)] for name, of_all in numbers.items()}
        of_parts = {name: np.repeat(chosen, count) for name, chosen in (of_block | named[number]).items()}
        parts.add_block(KINDS.get(linear, "node"), pieces, first, of_parts)
        first_cell += len(cells)
        if linear == "tetra":
            first += len(pieces)
            rows.append(pieces)
            for name, values in data.items():
                of_rows.setdefault(name, []).append(np.repeat(values[number], count, axis=0))
    labels = first_labels({name: np.concatenate(values) for name, values in of_rows.items()})
    return _mesh_of_used_nodes(object, positions, rows, labels, parts.arrays())


def _mesh_of_used_nodes(
    object: str,
    points: ArrayLike,
    rows: list[NDArray[Any]],
    labels: ArrayLike | None,
    sets: Mapping[str, Sequence[NDArray[Any]]],
) -> Mesh:
    """Mesh without the nodes that no tetrahedron uses. `sets`: nodes, faces and tetrahedra of each set. Triangles that
    are not faces of a tetrahedron are dropped from the sets."""
    if not any(len(block) for block in rows):
        raise scene_error(object, "cells", "no tetrahedra", "at least one tetrahedron")
    nodes = real_array(points, f"{object}: points", ("n", 3))
    tetrahedra = index_array(np.concatenate(rows), f"{object}: cells", ("m", 4))
    if tetrahedra.min() < 0 or tetrahedra.max() >= len(nodes):
        raise scene_error(object, "cells", f"node {tetrahedra.max()}", f"nodes from 0 to {len(nodes) - 1}")
    used, place = np.unique(tetrahedra, return_inverse=True)
    tetrahedra = place.reshape(-1, 4).astype(np.int32)
    number = np.full(len(nodes), -1, dtype=np.int32)
    number[used] = np.arange(len(used))
    corners = np.sort(tetrahedra, axis=1).astype(np.int64)
    known = np.unique(np.concatenate([face_keys(np.delete(corners, k, axis=1), len(used)) for k in range(4)]))
    kept = {}
    for name, (of_nodes, faces, of_tetrahedra) in sets.items():
        numbered = number[np.asarray(of_nodes, dtype=np.int64)]
        triangles = number[np.asarray(faces, dtype=np.int64).reshape(-1, 3)]
        triangles = triangles[np.all(triangles >= 0, axis=1)]
        triangles = triangles[np.isin(face_keys(np.sort(triangles, axis=1).astype(np.int64), len(used)), known)]
        part = MeshSet(nodes=numbered[numbered >= 0], faces=triangles, tetrahedra=of_tetrahedra)
        if len(numbered[numbered >= 0]) + len(triangles) + len(of_tetrahedra):
            kept[name] = part
    return Mesh(nodes[used], tetrahedra, labels=labels, sets=kept)
