"""Fields of particles as arrays: the set's own memory, looked at only while it is valid."""

import os
import warnings

import numpy
from numpy.lib.mixins import NDArrayOperatorsMixin

from ._errors import StaleError
from ._library import ffi, library

#: Ways to the memory itself, which would outlive the check, or around a commit.
_RAW = frozenset(("base", "ctypes", "data", "flat", "getbuffer", "setflags"))


class _Loan:
    """Until when a set lends memory: a field and all its parts have the same one. An edit may be written through
    until it ends; what is read is stale after a step, whether or not that has sorted the particles."""

    def __init__(self, owner, epoch, edit):
        self.owner, self.epoch, self.ended = owner, epoch, None
        self.steps = None if edit else self._steps()

    def _steps(self):
        """How many calls may have changed fields of the set."""
        return self.owner.context._steps.get(int(ffi.cast("intptr_t", self.owner._pointer)), 0)

    def reason(self):
        """Why the memory may not be looked at any more; None where it may."""
        if self.ended is None:
            if (self.owner._pointer is None or
                    library.mps_particles_epoch(self.owner._pointer) != self.epoch):
                self.ended = "particles were added, removed or sorted, or a field was removed: take the field again"
            elif self.steps is not None and self.steps != self._steps():
                self.ended = "a solver has stepped since: take the field again; numpy.array(field) is a copy that stays"
        return self.ended


class Field(NDArrayOperatorsMixin):
    """A field of particles, without a copy: (particles, components), or (particles,) for one
    component. It computes and answers as a NumPy array does; parts and turned views of it are fields
    too. Using it after a solver has stepped, or after particles were added, removed or sorted raises StaleError.
    numpy.array(field) is a copy that stays; numpy.asarray(field) a copy that cannot be written, as writes would be
    lost."""

    __slots__ = ("_loan", "_memory")

    def __init__(self, loan, memory):
        self._loan, self._memory = loan, memory

    @property
    def stale(self):
        """Whether the array must be taken again."""
        return self._loan.reason() is not None

    def _plain(self):
        """The array for one operation: nothing keeps it."""
        reason = self._loan.reason()
        if reason:
            raise StaleError(reason)
        return self._memory

    def __reduce__(self):  # copies and pickles are arrays of their own
        return numpy.array, (numpy.array(self._plain()),)

    def _lend(self, result):
        """A result that shares the set's memory is a field again."""
        if isinstance(result, (tuple, list)):
            return type(result)(map(self._lend, result))
        if isinstance(result, numpy.ndarray) and numpy.may_share_memory(result, self._memory):
            return Field(self._loan, result)
        return result

    def __array__(self, dtype=None, copy=None):
        made = numpy.array(self._plain(), dtype)
        made.flags.writeable = copy is True
        return made

    def __array_ufunc__(self, ufunc, method, *inputs, out=None, **keywords):
        if out is not None:
            keywords["out"] = tuple(map(_plain, out))
        keywords = {name: _plain(value) for name, value in keywords.items()}
        result = getattr(ufunc, method)(*map(_plain, inputs), **keywords)
        if out is not None and len(out) == 1 and isinstance(out[0], Field):
            return out[0]
        return self._lend(result)

    def __array_function__(self, function, _types, args, keywords):
        result = function(*_plain(args), **{name: _plain(value) for name, value in keywords.items()})
        return self._lend(result)

    def __getattr__(self, name):
        if name in _RAW or name.startswith("__"):
            raise AttributeError(f"a field has no {name!r}: copy it, numpy.array(field)")
        found = getattr(self._plain(), name)
        if name == "flags":  # to be read: those of the memory stay as they are
            return self._plain().view().flags
        if not callable(found):
            return self._lend(found)

        def method(*values, **keywords):
            inside = getattr(self._plain(), name)
            return self._lend(inside(*_plain(values),
                                     **{k: _plain(v) for k, v in keywords.items()}))

        method.__name__, method.__doc__ = name, found.__doc__
        return method

    def __dir__(self):
        return sorted((set(dir(numpy.ndarray)) - _RAW) | {"stale"})

    def __getitem__(self, key):
        return self._lend(self._plain()[_plain(key)])

    def __setitem__(self, key, value):
        self._plain()[_plain(key)] = _plain(value)

    def __iter__(self):
        return (self[k] for k in range(len(self)))

    def __len__(self):
        return len(self._plain())

    def __contains__(self, value):
        return _plain(value) in self._plain()

    def __bool__(self):
        return bool(self._plain())

    def __float__(self):
        return float(self._plain())

    def __int__(self):
        return int(self._plain())

    def __repr__(self):
        return "Field(stale)" if self.stale else repr(self._plain()).replace("array", "Field", 1)


def _plain(value):
    """An argument with the memory in place of every field in it."""
    if isinstance(value, Field):
        return value._plain()
    if type(value) in (list, tuple):
        return type(value)(map(_plain, value))
    return value


def lend(owner, view, writeable):
    """The memory that a view lends, as a field."""
    dtype = numpy.dtype(numpy.float64 if view.dtype.code == 2 else numpy.int64)
    count, components = view.shape[0], view.shape[1]
    strides = [8 * view.stride[0], 8 * view.stride[1]]
    size = (count - 1) * strides[0] + (components - 1) * strides[1] + 8 if count > 0 else 0
    buffer = ffi.buffer(view.data, size) if size else b""
    one = components == 1
    memory = numpy.ndarray((count,) if one else (count, components), dtype, buffer, 0,
                           strides[:1] if one else strides)
    memory.flags.writeable = writeable and size > 0
    return Field(_Loan(owner, view.epoch, writeable), memory)


class Edit:
    """A field open for writing: `array`, or the value of a `with` block, whose end commits; left by
    an exception it abandons, and the values are those from before. Where a value is out of range
    commit() raises and the field stays open: mend it and commit again, or abandon(). After that the
    array is stale, and so are all parts of it. An edit that is dropped is abandoned, with a warning."""

    def __init__(self, owner, name):
        self._owner, self._edit = owner, ffi.new("mps_edit *")
        text = os.fsencode(name)
        owner._checked("Particles.edit()", library.mps_particles_edit, text, self._edit)
        self.array = lend(owner, self._edit.view, True)
        self._name = name

    def __repr__(self):
        return f"<libmps Edit of {self._name!r}: {self.array._loan.reason() or 'open'}>"

    def __del__(self):
        array = getattr(self, "array", None)
        if array is None or array.stale or self._owner.context._pointer is None:
            return
        warnings.warn(f"the edit of {self._name!r} was dropped without commit(), and is abandoned",
                      RuntimeWarning, stacklevel=2)
        self.abandon()

    def commit(self):
        self._owner._checked("Edit.commit()", library.mps_particles_commit, self._edit)
        self.array._loan.ended = "the edit has been committed: take the field to read it"

    def abandon(self):
        self._owner._checked("Edit.abandon()", library.mps_particles_abandon, self._edit)
        self.array._loan.ended = "the edit has been abandoned: take the field to read it"

    def __enter__(self):
        return self.array

    def __exit__(self, kind, *_):
        if kind is not None:
            self.abandon()
            return
        try:
            self.commit()
        except BaseException:
            self.abandon()
            raise
