"""Named sets of nodes, faces and tetrahedra."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import checked, index_array, name_text, read_only

Indices: TypeAlias = NDArray[np.int32]
SetsLike: TypeAlias = "Mapping[str, MeshSet | ArrayLike]"


def _none() -> Indices:
    return np.empty(0, dtype=np.int32)


def _no_faces() -> Indices:
    return np.empty((0, 3), dtype=np.int32)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeshSet:
    """A named part of a mesh or a body. It can list nodes, faces, tetrahedra, or several of them.

    nodes: numbers of nodes, shape (j,).
    faces: node numbers of faces of tetrahedra, shape (k, 3).
    tetrahedra: numbers of tetrahedra, shape (m,)."""

    nodes: ArrayLike = field(default_factory=_none)
    faces: ArrayLike = field(default_factory=_no_faces)
    tetrahedra: ArrayLike = field(default_factory=_none)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MeshSet):
            return NotImplemented
        return all(np.array_equal(a, b) for a, b in zip(set_arrays(self), set_arrays(other), strict=True))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        nodes, faces, tetrahedra = map(len, set_arrays(self))
        return f"<skerry.MeshSet {nodes:,} nodes, {faces:,} faces, {tetrahedra:,} tetrahedra>"


def set_arrays(given: MeshSet | ArrayLike, name: str = "set") -> tuple[Indices, Indices, Indices]:
    """Nodes, faces and tetrahedra of a set; an array lists nodes."""
    if not isinstance(given, MeshSet):
        return index_array(given, name, ("j",)), _no_faces(), _none()
    return (
        index_array(given.nodes, f"{name}: nodes", ("j",)),
        index_array(given.faces, f"{name}: faces", ("k", 3)),
        index_array(given.tetrahedra, f"{name}: tetrahedra", ("m",)),
    )


def sets_arrays(given: SetsLike | None) -> dict[str, tuple[Indices, Indices, Indices]]:
    return {
        name_text(name, "name of a set"): set_arrays(of_name, f"sets[{name!r}]")
        for name, of_name in checked(given or {}, "sets", Mapping).items()
    }


def set_of(arrays: tuple[Any, Any, Any]) -> MeshSet:
    nodes, faces, tetrahedra = map(read_only, arrays)
    return MeshSet(nodes=nodes, faces=faces, tetrahedra=tetrahedra)


def sets_of_numbers(name: str, values: NDArray[Any]) -> dict[str, NDArray[np.bool_]]:
    """Rows of each set that an array of whole numbers or truth values describes, by the rules of Mesh.read()."""
    if values.ndim != 1 or not np.issubdtype(values.dtype, np.integer) and values.dtype != np.bool_:
        return {}
    found = np.unique(values)
    if np.all((found == 0) | (found == 1)):
        return {name: values == 1} if np.any(values) else {}
    if len(found) == len(values):
        return {}
    return {f"{name}_{number}": values == number for number in found if number != 0}


class Parts:
    """Collects sets from the cells of another package, in the numbers of its points."""

    def __init__(self) -> None:
        self.sets: dict[str, tuple[list[Any], list[Any], list[Any]]] = {}

    def add_nodes(self, name: str, nodes: ArrayLike) -> None:
        self._lists(name)[0].append(np.ravel(nodes))

    def add_cells(
        self, name: str, kind: Literal["node", "face", "tetrahedron"], cells: NDArray[Any], first: int
    ) -> None:
        """Adds cells. `cells`: numbers of tetrahedra, to which `first` is added, or nodes of other cells."""
        place = ("node", "face", "tetrahedron").index(kind)
        self._lists(name)[place].append(cells + first if kind == "tetrahedron" else cells.ravel())

    def add_block(
        self,
        kind: Literal["node", "face", "tetrahedron"],
        cells: NDArray[Any],
        first: int,
        data: Mapping[str, NDArray[Any]],
    ) -> None:
        """Adds the members of sets among cells of one kind. `data`: for each set a truth value for each cell."""
        for name, members in data.items():
            chosen = np.flatnonzero(members)
            if len(chosen):
                self.add_cells(name, kind, chosen if kind == "tetrahedron" else cells[chosen], first)

    def arrays(self) -> dict[str, list[NDArray[Any]]]:
        return {
            name: [np.concatenate(part).astype(np.int32) if part else _none() for part in lists]
            for name, lists in self.sets.items()
        }

    def _lists(self, name: str) -> tuple[list[Any], list[Any], list[Any]]:
        return self.sets.setdefault(name, ([], [], []))
