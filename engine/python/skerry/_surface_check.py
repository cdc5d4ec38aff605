"""Checks of triangle surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import Vector, read_only, real
from ._mesh import Path, read_surface
from ._settings import SurfaceMesh

SurfaceFaultKind: TypeAlias = Literal[
    "flat_triangles",
    "duplicate_triangles",
    "turned_triangles",
    "inside_out_shells",
    "duplicate_shells",
    "holes",
    "branching_edges",
    "pinched_nodes",
    "one_sided_shells",
    "crossings",
    "shell_crossings",
    "overlaps",
    "flat_shells",
    "doubled_volumes",
    "slivers",
    "thin_walls",
    "unlikely_size",
]
"""Kinds of faults of a surface."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceFault:
    """All faults of one kind. Triangles have their number in the checked surface, counted from 0.

    kind: kind of the faults.
    count: number of triangles, edges, nodes, pairs of triangles, holes, shells or places.
    triangle: first triangle with the fault; for holes a triangle at the longest one.
    other: second triangle of the first pair, or first triangle of the other shell; None if there is none.
    place: place of the first fault; for holes the centre of the longest one [m].
    length: length of the edges around the longest hole, smallest thickness of a thin wall, largest distance of repeated
        shells, or unlikely size [m].
    text: number and first place of the faults, as `skerry inspect` prints them.
    """

    kind: SurfaceFaultKind
    count: int
    triangle: int
    other: int | None
    place: Vector
    length: float
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceShell:
    """Part of a surface that common edges connect.

    triangles: number of triangles.
    triangle: number of its first triangle in the checked surface.
    closed: True if it encloses a volume.
    volume: enclosed volume; negative for a void in another shell, 0 if the shell is not closed [m^3].
    around: index of the smallest shell around it; None if there is none.
    """

    triangles: int
    triangle: int
    closed: bool
    volume: float
    around: int | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SurfaceReport:
    """Result of check_surface().

    faults: the faults, at most one entry of each kind.
    shells: shells in the order of their first triangles.
    can_be_filled: True if `cleaned` bounds volumes, and its triangles neither cross nor overlap.
    tolerance: largest distance of merged nodes [m].
    merged: number of nodes that were merged into another node.
    lower: lower corner of the bounding box [m].
    upper: upper corner of the bounding box [m].
    area: area of `cleaned` [m^2].
    volume: volume of its closed shells [m^3].
    min_edge: smallest edge length of `cleaned` [m].
    mean_edge: mean edge length [m].
    max_edge: largest edge length [m].
    cleaned: the surface with merged nodes and consistent orientation, without flat and repeated triangles and shells.
        Holes and crossings remain.
    number: number in the checked surface of each triangle of `cleaned`, shape (k,), read-only.
    shell: index in `shells` of each triangle of `cleaned`, shape (k,), read-only.
    """

    faults: tuple[SurfaceFault, ...]
    shells: tuple[SurfaceShell, ...]
    can_be_filled: bool
    tolerance: float
    merged: int
    lower: Vector
    upper: Vector
    area: float
    volume: float
    min_edge: float
    mean_edge: float
    max_edge: float
    cleaned: SurfaceMesh
    number: NDArray[np.int32]
    shell: NDArray[np.int32]


def check_surface(surface: SurfaceMesh | Path, *, tolerance: float = 1e-6) -> SurfaceReport:
    """Finds the faults and shells of a surface, such as holes, crossings and repeated triangles, and cleans it.

    surface: a surface, or the path of a file for read_surface().
    tolerance: nodes up to this fraction of the diagonal of the bounding box apart are merged; 0 merges equal nodes
        only.
    SceneError: a node is not finite, a triangle has a node that does not exist, or there are no triangles."""
    if not isinstance(surface, SurfaceMesh):
        surface = read_surface(surface)
    values = _core.check_surface(surface.nodes, surface.triangles, real(tolerance, "tolerance"))
    nodes, triangles = values.pop("cleaned")
    return SurfaceReport(
        faults=tuple(SurfaceFault(**fault) for fault in values.pop("faults")),
        shells=tuple(SurfaceShell(**shell) for shell in values.pop("shells")),
        cleaned=SurfaceMesh(nodes=nodes, triangles=triangles),
        number=read_only(values.pop("number")),
        shell=read_only(values.pop("shell")),
        **values,
    )
