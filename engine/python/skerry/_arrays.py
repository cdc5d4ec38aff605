"""Conversion of arguments to the arrays and tuples that the engine takes."""

from __future__ import annotations

import math
import operator
import os
import unicodedata
from collections.abc import Sequence
from typing import Any, Protocol, SupportsFloat, SupportsIndex, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import scene_error

Checked = TypeVar("Checked")

Reals: TypeAlias = NDArray[np.float64]

Vector: TypeAlias = tuple[float, float, float]
"""A point or a vector as the dataclasses of the package store it."""


VectorLike: TypeAlias = Sequence[float] | NDArray[Any]
"""Three numbers, as an argument."""


class HasRotvec(Protocol):
    """A rotation object, such as scipy.spatial.transform.Rotation."""

    def as_rotvec(self) -> Any: ...


RotationLike: TypeAlias = VectorLike | HasRotvec
"""A rotation: the axis times the angle, shape (3,) [rad], or an object with the method as_rotvec()."""


def shape_text(shape: Sequence[int | str]) -> str:
    """Text of a shape, such as "(n, 3)"; a text in `shape` means any length."""
    return "(" + ", ".join(str(length) for length in shape) + ("," if len(shape) == 1 else "") + ")"


def numbers(value: ArrayLike, name: str, shape: Sequence[int | str]) -> NDArray[np.float64]:
    """Array of float64 of any shape. The error names the shape that the caller expects. Texts, complex numbers, other
    objects and masked arrays are refused, because the conversion would lose data."""
    if isinstance(value, np.ma.MaskedArray):
        raise TypeError(f"{name}: found a masked array, expected an array without a mask")
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as error:
        raise TypeError(
            f"{name}: found {_shortened(value)}, expected numbers of the shape {shape_text(shape)}"
        ) from error
    if array.dtype.kind not in "biuf":
        raise TypeError(f"{name}: found {_shortened(value)}, expected numbers of the shape {shape_text(shape)}")
    return array.astype(np.float64, copy=False)


def require_shape(array: NDArray[Any], name: str, shape: Sequence[int | str]) -> None:
    """Raises TypeError that names both shapes, unless the array has the given shape."""
    fits = array.ndim == len(shape) and all(
        isinstance(expected, str) or expected == found for expected, found in zip(shape, array.shape, strict=True)
    )
    if not fits:
        raise TypeError(f"{name}: found an array of the shape {shape_text(array.shape)}, expected {shape_text(shape)}")


def real_array(value: ArrayLike, name: str, shape: Sequence[int | str]) -> NDArray[np.float64]:
    """C-contiguous array of float64 with the given shape. An empty list counts as an array without rows."""
    array = _without_rows(numbers(value, name, shape), value, shape)
    require_shape(array, name, shape)
    return np.ascontiguousarray(array)


def real_rows(value: ArrayLike, name: str, count: int) -> NDArray[np.float64]:
    """C-contiguous array of float64 of the shape (count, 3), or one row of three numbers for all of them."""
    given = numbers(value, name, (count, 3))
    if given.shape == (3,):
        given = np.broadcast_to(given, (count, 3))
    return real_array(given, name, (count, 3))


def index_array(value: ArrayLike, name: str, shape: Sequence[int | str]) -> NDArray[np.int32]:
    """C-contiguous array of int32 with the given shape. Numbers that are not whole are refused."""
    if isinstance(value, np.ma.MaskedArray):
        raise TypeError(f"{name}: found a masked array, expected an array without a mask")
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
    expected = "a whole number from 0 to 4294967295"
    if not hasattr(value, "__index__"):
        raise TypeError(f"{name}: found {_shortened(value)}, expected {expected}")
    number = operator.index(value)
    if not 0 <= number < 2**32:
        raise scene_error("", name, str(number), expected)
    return number


TimeTable: TypeAlias = tuple[tuple[float, float], ...]
"""A value that changes over time: pairs (time [s], value) with ascending times. Between two times the value changes
linearly. It is constant before the first time and after the last."""


TimeTableLike: TypeAlias = SupportsFloat | ArrayLike
"""A value that changes over time, as an argument: a number, or pairs (time [s], value)."""


def time_table(value: TimeTableLike, name: str) -> TimeTable:
    """Pairs (time, value). A number means a constant value."""
    given = numbers(value, name, ("n", 2))  # type: ignore[arg-type]
    if given.ndim == 0:
        return ((0.0, float(given)),)
    pairs = real_array(given, name, ("n", 2))
    return tuple((time, value) for time, value in pairs.tolist())


def flag(value: object, name: str) -> bool:
    """A truth value of Python or NumPy."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name}: found {_shortened(value)}, expected True or False")
    return bool(value)


def is_false(value: object) -> bool:
    """True for False of Python or NumPy, by which a callback ends a run. None and 0 do not end it."""
    return isinstance(value, (bool, np.bool_)) and not value


def name_text(value: object, name: str) -> str:
    """A text that can name something. Empty texts, control characters and halves of surrogate pairs are refused."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: found {_shortened(value)}, expected a text")
    if not value or any(unicodedata.category(letter) in ("Cc", "Cs") for letter in value):
        raise scene_error("", name, ascii(value), "a text of at least one character, without control characters")
    return value


def optional_name(value: object) -> str | None:
    """A text that can name something, or None."""
    return None if value is None else name_text(value, "name")


def seconds(value: SupportsFloat, object: str, name: str, *, zero: bool = True) -> float:
    """A finite time [s]: >= 0, or > 0 if `zero` is False."""
    number = float(value) if isinstance(value, float) else real(value, f"{object}: {name}")
    if not (math.isfinite(number) and (number > 0 or (zero and number == 0))):
        raise scene_error(object, name, str(number), f"a finite time {'>=' if zero else '>'} 0 [s]")
    return number


def checked(value: Checked, name: str, *kinds: type) -> Checked:
    """Returns the object. Raises TypeError unless its class is one of the given ones."""
    if not isinstance(value, kinds):
        expected = " or ".join(f"{'an' if kind.__name__[0] in 'AEIOU' else 'a'} {kind.__name__}" for kind in kinds)
        raise TypeError(f"{name}: found {_shortened(value)}, expected {expected}")
    return value


def counted(value: SupportsIndex, name: str) -> int:
    """A whole number that fits into 32 bits. The extension module checks its range."""
    if not hasattr(value, "__index__"):
        raise TypeError(f"{name}: found {_shortened(value)}, expected a whole number")
    number = operator.index(value)
    if not -(2**31) <= number < 2**31:
        raise scene_error("", name, str(number), "a number of 32 bits")
    return number


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
    """Returns the array, which from now on refuses changes."""
    array.flags.writeable = False
    return array


def _without_rows(array: NDArray[Any], value: ArrayLike, shape: Sequence[int | str]) -> NDArray[Any]:
    if array.size == 0 and array.ndim == 1 and isinstance(shape[0], str) and not isinstance(value, np.ndarray):
        return array.reshape((0, *(length if isinstance(length, int) else 0 for length in shape[1:])))
    return array


def _shortened(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
