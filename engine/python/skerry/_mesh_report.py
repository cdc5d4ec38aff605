"""Statistics of tetrahedral meshes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from ._arrays import Vector


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshReport:
    """Statistics of a mesh, as `skerry inspect` prints them.

    nodes: number of nodes.
    tetrahedra: number of tetrahedra.
    boundary_triangles: number of triangles of the boundary.
    components: number of connected parts.
    lower: lower corner of the bounding box [m].
    upper: upper corner of the bounding box [m].
    volume: volume [m^3].
    mean_edge: mean edge length [m].
    min_edge: smallest edge length [m].
    max_edge: largest edge length [m].
    min_altitude: smallest altitude of a tetrahedron, which limits the step length [m].
    min_quality: smallest quality of a tetrahedron: 1 for a regular one, below 0 for an inverted one.
    mean_quality: mean quality of the tetrahedra.
    inverted: number of tetrahedra of negative volume.
    flat: number of tetrahedra of zero volume.
    slivers: number of tetrahedra of positive volume with a quality below 0.1.
    closed_manifold: True if every boundary edge has two triangles, and the triangles at every node form one ring.
    boundary_fault: first fault of the boundary, and number of faults; empty if there are none.
    labels: number of tetrahedra with each label; empty if the mesh has no labels.
    sets: numbers of listed nodes, faces and tetrahedra of each set.
    """

    nodes: int
    tetrahedra: int
    boundary_triangles: int
    components: int
    lower: Vector
    upper: Vector
    volume: float
    mean_edge: float
    min_edge: float
    max_edge: float
    min_altitude: float
    min_quality: float
    mean_quality: float
    inverted: int
    flat: int
    slivers: int
    closed_manifold: bool
    boundary_fault: str
    labels: Mapping[int, int]
    sets: Mapping[str, tuple[int, int, int]]

    def __repr__(self) -> str:
        lines = [f"{field.name}: {_value_text(getattr(self, field.name))}" for field in fields(self)]
        return "\n".join(["MeshReport", *(f"  {line}" for line in lines)])


def _value_text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, tuple):
        return "(" + ", ".join(map(_value_text, value)) + ")"
    if isinstance(value, Mapping):
        return ", ".join(f"{key}: {_value_text(count)}" for key, count in value.items()) or "none"
    return f"{value:,}" if isinstance(value, int) and not isinstance(value, bool) else str(value) or "none"
