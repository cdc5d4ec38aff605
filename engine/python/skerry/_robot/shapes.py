"""Closed triangle surfaces of collision shapes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .._settings import SurfaceMesh
from .description import Frame, Reals

_SECTORS = 24  # of round shapes


def box_surface(half: ArrayLike) -> SurfaceMesh:
    """A box with the given half edges (3,) [m]."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.asarray(half)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return SurfaceMesh(nodes=corners, triangles=[t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))])


def round_surface(profile: Reals) -> SurfaceMesh:
    """A surface of revolution about z. `profile`: radius and height of its circles from below, shape (n, 2) [m]. The
    ends of the profile are on the axis."""
    angle = np.arange(_SECTORS) * 2 * np.pi / _SECTORS
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    rings = [np.column_stack([radius * circle, np.full(_SECTORS, z)]) for radius, z in profile[1:-1]]
    nodes = np.vstack([[[0, 0, profile[0, 1]]], *rings, [[0, 0, profile[-1, 1]]]])
    last = len(nodes) - 1
    triangles = []
    for k in range(_SECTORS):
        here, there = 1 + k, 1 + (k + 1) % _SECTORS
        triangles.append((0, there, here))
        for ring in range(0, (len(rings) - 1) * _SECTORS, _SECTORS):
            a, b = ring + here, ring + there
            triangles += [(a, b, b + _SECTORS), (a, b + _SECTORS, a + _SECTORS)]
        triangles.append((last, last - _SECTORS - 1 + here, last - _SECTORS - 1 + there))
    return SurfaceMesh(nodes=nodes, triangles=triangles)


def cylinder_surface(radius: float, half: float) -> SurfaceMesh:
    """A cylinder along z. `half`: half of its length [m]."""
    return round_surface(np.array([[0, -half], [radius, -half], [radius, half], [0, half]]))


def capsule_surface(radius: float, half: float) -> SurfaceMesh:
    """A capsule along z. `half`: half of the length of its axis [m]; 0: a sphere."""
    polar = np.linspace(-np.pi / 2, np.pi / 2, _SECTORS // 2 + 1)
    if half > 0:
        polar = np.sort(np.append(polar, 0))
    shift = np.where(np.arange(len(polar)) < len(polar) / 2, -half, half)
    return round_surface(np.column_stack([radius * np.cos(polar), radius * np.sin(polar) + shift]))


def hull_surface(nodes: Reals, triangles: ArrayLike) -> SurfaceMesh:
    """The surface of a convex body. Triangles are turned so that they are counter-clockwise as seen from outside."""
    used, numbers = np.unique(np.asarray(triangles), return_inverse=True)
    corners, faces = nodes[used], numbers.reshape(-1, 3)
    a, b, c = (corners[faces[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - corners.mean(axis=0)) < 0
    faces[inward] = faces[inward][:, ::-1]
    return SurfaceMesh(nodes=corners, triangles=faces)


def shells(parts: list[tuple[SurfaceMesh, Frame]]) -> SurfaceMesh | None:
    """One surface with the given closed shells, each in its frame."""
    if not parts:
        return None
    starts = np.cumsum([0, *(len(surface.nodes) for surface, _ in parts)])
    return SurfaceMesh(
        nodes=np.vstack([frame.points(surface.nodes) for surface, frame in parts]),
        triangles=np.vstack([surface.triangles + start for (surface, _), start in zip(parts, starts, strict=False)]),
    )
