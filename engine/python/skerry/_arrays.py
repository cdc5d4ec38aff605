"""Conversion of arguments to the arrays and tuples that the engine takes."""

from __future__ import annotations

import operator
import os
from collections.abc import Sequence
from typing import Any, Protocol, SupportsFloat, SupportsIndex, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Checked = TypeVar("Checked")

Vector: TypeAlias = tuple[float, float, float]
"""A point or a vector as the dataclasses of the package hold it."""


VectorLike: TypeAlias = Sequence[float] | NDArray[Any]
"""Three numbers, as an argument."""


class HasRotvec(Protocol):
    """A rotation object, such as scipy.spatial.transform.Rotation."""

    def as_rotvec(self) -> Any: ...


RotationLike: TypeAlias = VectorLike | HasRotvec
"""A rotation: the axis times the angle, shape (3,) [rad], or an object with the method as_rotvec()."""


def shape_text(shape: Sequence[int | str]) -> str:
    """Text of a shape, such as "(n, 3)"; a text in `shape` stands for any length."""
    return "(" + ", ".join(str(length) for length in shape) + ("," if len(shape) == 1 else "") + ")"


def require_shape(array: NDArray[Any], name: str, shape: Sequence[int | str]) -> None:
    """Raises TypeError that names both shapes, unless the array has the given shape."""
    fits = array.ndim == len(shape) and all(
        isinstance(expected, str) or expected == found for expected, found in zip(shape, array.shape, strict=True)
    )
    if not fits:
        raise TypeError(f"{name}: found an array of the shape {shape_text(array.shape)}, expected {shape_text(shape)}")


def real_array(value: ArrayLike, name: str, shape: Sequence[int | str]) -> NDArray[np.float64]:
    """C-contiguous array of float64 with the given shape. An empty list counts as an array without rows."""
    try:
        array = np.ascontiguousarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(
            f"{name}: found {_shortened(value)}, expected numbers of the shape {shape_text(shape)}"
        ) from error
    array = _without_rows(array, value, shape)
    require_shape(array, name, shape)
    return array


def index_array(value: ArrayLike, name: str, shape: Sequence[int | str]) -> NDArray[np.int32]:
    """C-contiguous array of int32 with the given shape. Numbers that are not whole are refused."""
    try:
        given = np.asarray(value)
    except ValueError as error:
        raise TypeError(
            f"{name}: found {_shortened(value)}, expected numbers of the shape {shape_text(shape)}"
        ) from error
    given = _without_rows(given, value, shape)
    if given.size > 0 and given.dtype.kind not in "iu":
        raise TypeError(f"{name}: found numbers of the type {given.dtype}, expected whole numbers")
    require_shape(given, name, shape)
    limits = np.iinfo(np.int32)
    if given.size > 0 and (given.min() < limits.min or given.max() > limits.max):
        raise TypeError(f"{name}: found {given.min()} to {given.max()}, expected numbers of 32 bits")
    return np.ascontiguousarray(given, dtype=np.int32)


def vector(value: ArrayLike, name: str) -> Vector:
    """Tuple of three numbers."""
    x, y, z = real_array(value, name, (3,)).tolist()
    return (x, y, z)


def rotation(value: RotationLike, name: str) -> Vector:
    """Rotation as axis times angle [rad]."""
    as_rotvec = getattr(value, "as_rotvec", None)
    return vector(value if as_rotvec is None else as_rotvec(), name)  # type: ignore[arg-type]


def real(value: SupportsFloat, name: str) -> float:
    """A number. Texts are refused."""
    if isinstance(value, (float, int)):
        return float(value)
    if not hasattr(value, "__float__"):
        raise TypeError(f"{name}: found {_shortened(value)}, expected a number")
    return float(value)


def whole(value: SupportsIndex, name: str) -> int:
    """A whole number from 0 to 4294967295."""
    if not hasattr(value, "__index__") or not 0 <= operator.index(value) < 2**32:
        raise TypeError(f"{name}: found {_shortened(value)}, expected a whole number from 0 to 4294967295")
    return operator.index(value)


def checked(value: Checked, name: str, *kinds: type) -> Checked:
    """The same object. Raises TypeError unless its class is one of the given ones."""
    if not isinstance(value, kinds):
        expected = " or ".join(f"{'an' if kind.__name__[0] in 'AEIOU' else 'a'} {kind.__name__}" for kind in kinds)
        raise TypeError(f"{name}: found {_shortened(value)}, expected {expected}")
    return value


def counted(value: SupportsIndex, name: str) -> int:
    """A whole number of 32 bits. The extension module checks its range."""
    if not hasattr(value, "__index__") or not -(2**31) <= operator.index(value) < 2**31:
        raise TypeError(f"{name}: found {_shortened(value)}, expected a whole number of 32 bits")
    return operator.index(value)


def path_text(value: str | os.PathLike[str], name: str, expected: str = "a path") -> str:
    """Text of a path."""
    text = os.fspath(value) if isinstance(value, (str, os.PathLike)) else None
    if not isinstance(text, str):
        raise TypeError(f"{name}: found {_shortened(value)}, expected {expected}")
    return text


def require_attributes(value: object, name: str, expected: str, *attributes: str) -> None:
    """Raises TypeError unless an object of another package has the given attributes."""
    if not all(hasattr(value, attribute) for attribute in attributes):
        raise TypeError(f"{name}: found {_shortened(value)}, expected {expected}")


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """The same array, which from now on refuses changes."""
    array.flags.writeable = False
    return array


def _without_rows(array: NDArray[Any], value: ArrayLike, shape: Sequence[int | str]) -> NDArray[Any]:
    if array.size == 0 and array.ndim == 1 and isinstance(shape[0], str) and not isinstance(value, np.ndarray):
        return array.reshape((0, *(length if isinstance(length, int) else 0 for length in shape[1:])))
    return array


def _shortened(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
