"""The shared library, and the declarations of its functions."""

import os
from pathlib import Path

from . import _cdef, _tables
from ._ffi import ffi


class _Library:
    """The library's functions; those that all solvers share also under the name of one, as the headers have them: a
    solver's pointer is one of mps_solver."""

    def __init__(self, opened):
        self._opened = opened

    def __dir__(self):
        return [*dir(self._opened), *_cdef.SHARED]

    def __getattr__(self, name):
        if name in _cdef.SHARED:
            target, definition = _cdef.SHARED[name]
            made, kind = getattr(self._opened, target), f"shared_{name}"
            if definition:
                made = ffi.callback(kind, _of_kind(made, getattr(self._opened, definition)))
            else:
                made = ffi.cast(kind, made)
        else:
            made = getattr(self._opened, name)
        setattr(self, name, made)
        return made


def _of_kind(function, kind):
    """A function of mps_solver for one kind of definitions."""
    return lambda solver, *values: function(ffi.cast("mps_solver *", solver), kind, *values)


def _open():
    """The library that LIBMPS_LIBRARY names; else the one in the package (a wheel) or three folders above (as
    `cmake --install` has them); else where the system looks."""
    named = os.environ.get("LIBMPS_LIBRARY")
    if named:
        return ffi.dlopen(named)
    here = Path(__file__).resolve()
    for folder in (here.parent, here.parents[3] if len(here.parents) > 3 else here.parent):
        if (folder / _cdef.SONAME).exists():
            return ffi.dlopen(str(folder / _cdef.SONAME))
    return ffi.dlopen(_cdef.SONAME)


library = _Library(_open())


def tag(kind):
    """mps_mpm of the type `struct mps_mpm`."""
    return kind.cname.removeprefix("struct ").removeprefix("enum ")


def opaque(kind):
    """Whether the headers do not show what a struct has; cffi 2.1 ends the program where it is asked for its fields."""
    return tag(kind).removeprefix("mps_") in _tables.KINDS


def is_struct(kind):
    return kind.kind == "pointer" and kind.item.kind == "struct"


def is_object(kind):
    """A pointer to what the headers do not show."""
    return is_struct(kind) and opaque(kind.item)
