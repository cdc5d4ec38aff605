"""Surfaces that are drawn in place of bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Vector, index_array, path_text, real, real_array, vector
from ._mesh import Path, _warn
from ._settings import SurfaceMesh


@dataclass(frozen=True, slots=True)
class VisualMaterial:
    """Material of a visual surface.

    name: name of the material.
    color: red, green and blue of sRGB, each from 0 to 1.
    opacity: from 0 to 1.
    texture: path of the image that replaces the colour; empty: none.
    """

    name: str = ""
    color: Vector = (0.8, 0.8, 0.8)
    opacity: float = 1.0
    texture: str = ""


class VisualSurface:
    """A triangle surface that is drawn in place of a body and follows it. It cannot be changed.

    nodes: positions in the frame of the mesh of the body, shape (n, 3) [m].
    triangles: numbers of the nodes of each triangle, shape (k, 3).
    texture_points: texture coordinates, shape (p, 2).
    texture_corners: numbers of the texture points of each triangle, shape (k, 3), or -1; empty: no texture.
    materials: materials of the triangles.
    material: number of the material of each triangle, shape (k,), or -1; empty: no materials."""

    __slots__ = ("_core",)

    def __init__(
        self,
        nodes: ArrayLike,
        triangles: ArrayLike,
        *,
        texture_points: ArrayLike = (),
        texture_corners: ArrayLike = (),
        materials: Sequence[VisualMaterial] = (),
        material: ArrayLike = (),
    ) -> None:
        rows = [
            (item.name, vector(item.color, "color"), real(item.opacity, "opacity"), str(item.texture))
            for item in materials
        ]
        self._core = _core.new_visual(
            real_array(nodes, "nodes", ("n", 3)),
            index_array(triangles, "triangles", ("k", 3)),
            real_array(texture_points, "texture_points", ("p", 2)),
            index_array(texture_corners, "texture_corners", ("k", 3)),
            rows,
            index_array(material, "material", ("k",)),
            "",
        )

    @classmethod
    def _of(cls, core: Any) -> VisualSurface:
        surface = cls.__new__(cls)
        surface._core = core
        return surface

    @staticmethod
    def read(path: Path, *, scale: float = 1.0) -> VisualSurface:
        """Reads a surface from a file in one of the formats of read_surface(); from .obj files also texture coordinates
        and the materials of their .mtl files. Coordinates are multiplied by `scale`. A missing file of materials gives
        a warning Doubt. SceneError: the file cannot be read."""
        core, notes = _core.read_visual(path_text(path, "path"), real(scale, "scale"))
        _warn(notes)
        return VisualSurface._of(core)

    @property
    def nodes(self) -> NDArray[np.float64]:
        """Positions in the frame of the mesh, shape (n, 3) [m]."""
        return np.asarray(self._core.nodes())

    @property
    def triangles(self) -> NDArray[np.int32]:
        """Numbers of the nodes of each triangle, shape (k, 3)."""
        return np.asarray(self._core.triangles())

    @property
    def texture_points(self) -> NDArray[np.float64]:
        """Texture coordinates, shape (p, 2)."""
        return np.asarray(self._core.texture_points())

    @property
    def texture_corners(self) -> NDArray[np.int32]:
        """Numbers of the texture points of each triangle, shape (k, 3), or -1; empty: no texture."""
        return np.asarray(self._core.texture_corners())

    @property
    def materials(self) -> tuple[VisualMaterial, ...]:
        """Materials of the triangles."""
        return tuple(
            VisualMaterial(name, vector(color, "color"), opacity, texture)
            for name, color, opacity, texture in self._core.materials()
        )

    @property
    def material(self) -> NDArray[np.int32]:
        """Number of the material of each triangle, shape (k,), or -1; empty: no materials."""
        return np.asarray(self._core.material())

    @property
    def file(self) -> str:
        """File from which the surface was read; empty: none."""
        return str(self._core.file())

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, VisualSurface):
            return NotImplemented
        return bool(self._core.equals(other._core))

    def __hash__(self) -> int:
        return hash((self.nodes.tobytes(), self.triangles.tobytes()))

    def __reduce__(self) -> tuple[Any, ...]:
        rows = [(item.name, item.color, item.opacity, item.texture) for item in self.materials]
        arrays = self.nodes, self.triangles, self.texture_points, self.texture_corners, rows, self.material
        return (_restored, (*arrays, self.file))

    def __repr__(self) -> str:
        return f"<skerry.VisualSurface {len(self.nodes):,} nodes, {len(self.triangles):,} triangles>"


def _restored(*parts: Any) -> VisualSurface:
    """The surface of a pickle."""
    return VisualSurface._of(_core.new_visual(*parts))


VisualLike: TypeAlias = VisualSurface | SurfaceMesh | Path
"""A visual surface: an object, or the path of a file for VisualSurface.read()."""


def visual_of(value: VisualLike) -> VisualSurface:
    """The visual surface that an argument describes."""
    if isinstance(value, VisualSurface):
        return value
    if isinstance(value, SurfaceMesh):
        return VisualSurface(value.nodes, value.triangles)
    return VisualSurface.read(value)
