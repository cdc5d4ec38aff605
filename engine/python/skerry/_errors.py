"""Exceptions of the package."""


class SceneError(ValueError):
    """Bad input. The message names the object, the field, the value found and the value expected."""


class BusyError(RuntimeError):
    """A world was used while another thread was using it."""
