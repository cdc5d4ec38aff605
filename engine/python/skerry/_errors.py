"""Exceptions and warnings of the package."""

from __future__ import annotations

import dataclasses
import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._world import Body, StepReport


class SceneError(ValueError):
    """Bad input. The message names the file, the object, the field, the value found and the value expected, as far as
    they are known. The hint, if there is one, is a note of the exception."""

    def __init__(
        self,
        message: str,
        *,
        file: str = "",
        object: str = "",
        field: str = "",
        found: str = "",
        expected: str = "",
        hint: str = "",
    ) -> None:
        super().__init__(message)
        self.file = file
        self.object = object
        self.field = field
        self.found = found
        self.expected = expected
        self.hint = hint
        if hint:
            self.add_note(hint)


def scene_error(object: str, field: str, found: str, expected: str, hint: str = "", *, file: str = "") -> SceneError:
    """A SceneError whose message has the given parts."""
    place = ": ".join(part for part in (file, object, field) if part)
    message = f"{place}: found {found}, expected {expected}"
    return SceneError(message, file=file, object=object, field=field, found=found, expected=expected, hint=hint)


def import_package(name: str) -> Any:
    """An optional package. ImportError explains how to install it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"found no package {name}, expected one; run: pip install {name}", name=name) from error


class StepError(RuntimeError):
    """A step could not be completed. The world is as it was before this step and can be advanced further."""

    def __init__(self, report: StepReport) -> None:
        super().__init__(report.message)
        self.report = report

    @property
    def body(self) -> Body | None:
        """Body that caused the failure; None in an error that was pickled."""
        return self.report.body

    @property
    def element(self) -> int | None:
        """Number of the element that caused the failure, within the body."""
        return self.report.element

    @property
    def node(self) -> int | None:
        """Number of the node that caused the failure, within the body."""
        return self.report.node

    def __reduce__(self) -> tuple[Any, ...]:
        """A pickled error has no body, because a body holds its whole world; the report keeps the names."""
        return (StepError, (dataclasses.replace(self.report, body=None, inverted_body=None),))


class BusyError(RuntimeError):
    """A world was used while another thread was using it."""


class Doubt(UserWarning):
    """Results may be less exact than they seem, for example because surfaces passed through each other."""
