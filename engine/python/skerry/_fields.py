"""Fields of records that accept more types than they store, such as any array-like of three numbers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Generic, TypeAlias, TypeVar

from ._arrays import RotationLike, Vector, VectorLike, rotation, vector

Given = TypeVar("Given", contravariant=True)
Held = TypeVar("Held", covariant=True)


class Field(Generic[Given, Held]):
    """Declares to type checkers that a field is assigned one type and stores another. No object of this class is
    made."""

    def __get__(self, instance: object, owner: object) -> Held:
        raise NotImplementedError

    def __set__(self, instance: object, value: Given) -> None:
        raise NotImplementedError


VectorField: TypeAlias = Field[VectorLike, Vector]
RotationField: TypeAlias = Field[RotationLike, Vector]


def held(default: Any) -> Any:
    """A default value of a Field."""
    return default


def make_vectors(record: object, *names: str) -> None:
    """Replaces array-likes in the fields of a new record by tuples of three numbers."""
    for name in names:
        object.__setattr__(record, name, vector(getattr(record, name), f"{type(record).__name__}.{name}"))


def make_rotation(record: object) -> None:
    given = getattr(record, "rotation")
    object.__setattr__(record, "rotation", rotation(given, f"{type(record).__name__}.rotation"))


def make_keys(record: object, kind: type) -> None:
    """Replaces the sequence in the field `keys` of a new record by a tuple of records of the given class."""
    keys: Iterable[Any] = getattr(record, "keys")
    place = f"{type(record).__name__}.keys"
    if isinstance(keys, kind):
        raise TypeError(f"{place}: found one {kind.__name__}, expected a list of them")
    object.__setattr__(record, "keys", tuple(keys))
    for number, key in enumerate(getattr(record, "keys")):
        if not isinstance(key, kind):
            raise TypeError(f"{place}[{number}]: found {key!r}, expected a {kind.__name__}")
