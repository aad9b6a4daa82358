"""Failed calls as exceptions, by their kind."""

import builtins
import re

from . import _tables
from ._library import ffi, library


class Error(Exception):
    """A failed call. `status` is a Status; `step`, `particle` and `object` are those of the error record, where
    the library knew them (-1, -1, "")."""

    status = 0
    function = object = ""
    step = particle = -1

    def __str__(self):  # a KeyError would quote it
        return str(self.args[0]) if self.args else ""


class ArgumentError(Error, ValueError):
    """A value outside its allowed range."""


class StateError(Error, RuntimeError):
    """A call that the object's present state does not allow."""


class OutOfMemoryError(Error, builtins.MemoryError):
    """Memory could not be allocated."""


class FieldError(Error, KeyError):
    """An unknown or wrongly shaped field of particles."""


class FileError(Error, OSError):
    """A file that could not be opened, read or written."""


class FormatError(Error, ValueError):
    """A file whose content is malformed."""


class DivergedError(Error, ArithmeticError):
    """The computation diverged."""


class CancelledError(Error):
    """The hook `cancel`, or a callback, has ended the call."""


class UnsupportedError(Error, NotImplementedError):
    """Not available in this build or for this input."""


class NumericError(Error, ArithmeticError):
    """A numerical method failed to converge or met a singular system."""


class InternalError(Error, RuntimeError):
    """An internal invariant is broken: please report it."""


class StaleError(StateError):
    """An array of a field taken before a solver stepped, or before particles were added, removed or sorted; a block
    whose law has returned."""


class Warning(UserWarning):
    """A warning of the library, where the context has no hook `log`."""


KINDS = {made.__name__: made for made in (ArgumentError, StateError, OutOfMemoryError, FieldError, FileError, FormatError,
                                          DivergedError, CancelledError, UnsupportedError, NumericError, InternalError)}


def spoken(text):
    """A message of the library with the names that Python has of constants and functions. NaN is what a keyword is that was left out."""
    text = re.sub(r"^(\w+(?:\[\d+\])? is )nan(?: [^,]*)?, must be", r"\1not given (or NaN), must be", text)
    return re.sub(r"\b(?:mps|MPS)_\w+", lambda m: _tables.SPOKEN.get(m[0], m[0]), text)


def failed(function, status, record=None, text=""):
    """The exception of a failed call; `function` is what Python calls it."""
    from ._enums import enumeration

    status = enumeration("Status")(status)
    name = next(said for c, said in _tables.SPOKEN.items() if c == f"MPS_ERROR_{status.name}")
    said, found = ffi.string(library.mps_status_text(status)).decode(), {}
    if record and record.status == status:
        said = ffi.string(record.message).decode() or said
        found = {"step": record.step, "particle": record.particle, "object": ffi.string(record.object).decode()}
    error = KINDS[name](text or f"{function}: {spoken(said)}")
    error.status, error.function = status, function
    for member, value in found.items():
        setattr(error, member, value)
    return error
