"""Objects of the library: what they own, their methods, fields of particles as arrays."""

import numpy

from . import _cdef
from ._call import (Call, Error, StaleError, call, ffi, functions, library, returns_status,
                    same, signature, to_python)


class Object:
    """An object of the C library (a mps_mpm, a mps_signal ...). Its methods are the functions of its
    header; close(), the end of a `with` block, or the last reference destroys it."""

    pointer = None

    def __init__(self, pointer, context=None, alive=(), owned=True):
        self.pointer = pointer
        self.kind = ffi.typeof(pointer).item.cname.removeprefix("mps_")
        self.context = context or self
        self._alive = list(alive)  # callbacks, and what the object was made from
        # Garbage is collected anywhere, inside cffi too: nothing may have to be looked up then.
        self._destroy = getattr(library, f"mps_{self.kind}_destroy") if owned else _leave
        self._holder = ffi.new(f"mps_{self.kind} *[1]", [pointer])
        if context is None:
            self._running, self._late = 0, []  # calls under way; what is destroyed after them

    def close(self):
        """Destroys the object; without effect the second time."""
        if self.pointer is None:
            return
        self.pointer = None
        if self.context._running:  # by garbage collection in a callback
            self.context._late.append((self._destroy, self._holder, self._alive))
        else:
            self._destroy(self._holder)
        self._alive = []

    def __del__(self):
        if self.pointer is not None:
            self.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __repr__(self):
        return f"<libmps {self.kind}{'' if self.pointer is not None else ', closed'}>"

    def __dir__(self):
        own = [f.removeprefix(self.kind + "_") for f in functions if f.startswith(self.kind + "_")]
        return sorted(set(object.__dir__(self)) | set(own) | {f for f in functions if self._takes(f)})

    def _takes(self, name):
        full = f"mps_{name}_sized" if f"mps_{name}_sized" in _cdef.PARAMETERS else f"mps_{name}"
        args = ffi.typeof(getattr(library, full)).args if full in _cdef.PARAMETERS else ()
        return bool(args) and args[0].cname == f"mps_{self.kind} *"

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        for full in (f"{self.kind}_{name}", name):
            if self._takes(full):
                break
        else:
            raise AttributeError(f"{self.kind} of libmps has no {name!r}")

        def method(*values, **members):
            return self._invoke(full, values, members)

        method.__name__, method.__doc__ = full, f"mps_{full}{signature(full)}"
        return method

    def _invoke(self, name, values, members):
        if self.pointer is None:
            raise ValueError(f"the {self.kind} is closed")
        context = self.context
        context._running += 1
        try:
            result, outputs, state = call(name, self, values, members)
        finally:
            context._running -= 1
            while not context._running and context._late:
                destroy, holder, _alive = context._late.pop()
                destroy(holder)
        if state.exception:
            raise state.exception
        if not returns_status(name):
            return self._known(result, state)
        if result != 0:
            raise Error("mps_" + name, result, library.mps_context_error(self.context.pointer))
        made = [self._made(output[0], state) for output in outputs]
        if name.startswith("context_set_"):
            self._alive += [held for held in state.alive if _is_callback(held)]  # a hook stays
        return None if not made else made[0] if len(made) == 1 else tuple(made)

    def _made(self, value, state):
        if isinstance(value, ffi.CData) and ffi.typeof(value).kind == "pointer":
            return wrap(value, self.context, state.alive)
        return to_python(value)

    def _known(self, result, state):
        """What a question returns. An object that is lent is the one that made this, or a part of
        this, which it keeps alive."""
        if isinstance(result, ffi.CData) and ffi.typeof(result).kind == "pointer":
            for held in [self.context, *self._alive, *state.alive]:
                if isinstance(held, Object) and same(held.pointer, result):
                    return held
            kind = ffi.typeof(result).item
            if result and kind.kind == "struct" and kind.fields is None:
                return Object(result, self.context, [self], owned=False)
        return to_python(result)


def _leave(_holder):
    """Destroys nothing: the object is its owner's."""


def _is_callback(held):
    return isinstance(held, ffi.CData) and ffi.typeof(held).kind == "function"


class Context(Object):
    """mps_context: the members of mps_context_def by keyword (threads, executor, log ...)."""

    def __init__(self, **members):
        state, made, text = Call(), ffi.new("mps_context *[1]"), ffi.new("char[512]")
        definition = state.struct(ffi.typeof("mps_context_def"), members)
        status = library.mps_context_create(definition, made, text, 512)
        if status != 0:
            error = Error("mps_context_create", status)
            error.args = (f"mps_context_create: {ffi.string(text).decode()}",)
            raise error
        super().__init__(made[0], None, state.alive)


class Field(numpy.ndarray):
    """A field of particles, without a copy: (particles, components), or (particles,) for one
    component. Using it after particles have come, gone or been sorted raises StaleError."""

    _owner = _epoch = None

    def __array_finalize__(self, base):
        self._owner, self._epoch = getattr(base, "_owner", None), getattr(base, "_epoch", None)

    @property
    def stale(self):
        """Whether the array must be taken again."""
        owner = self._owner
        return owner is not None and (owner.pointer is None or
                                      library.mps_particles_epoch(owner.pointer) != self._epoch)

    def _plain(self):
        if self.stale:
            raise StaleError("particles have come, gone or been sorted: take the field again")
        return self.view(numpy.ndarray)

    def __getitem__(self, key):
        self._plain()
        return super().__getitem__(key)

    def __setitem__(self, key, value):
        self._plain()
        super().__setitem__(key, value)

    def __array_ufunc__(self, ufunc, method, *inputs, out=None, **keywords):
        plain = [x._plain() if isinstance(x, Field) else x for x in inputs]
        if out is not None:
            keywords["out"] = tuple(x._plain() if isinstance(x, Field) else x for x in out)
        return getattr(ufunc, method)(*plain, **keywords)

    def __array_function__(self, function, _types, args, keywords):
        def plain(x):
            if isinstance(x, Field):
                return x._plain()
            return type(x)(map(plain, x)) if isinstance(x, (list, tuple)) else x

        return function(*plain(args), **{k: plain(v) for k, v in keywords.items()})

    def __repr__(self):
        return "Field(stale)" if self.stale else repr(self._plain()).replace("array", "Field", 1)

    __str__ = __repr__


def _array(owner, view):
    """The memory that a view lends as an array that knows when it is stale."""
    dtype = numpy.dtype(numpy.float64 if view.dtype.code == 2 else numpy.int64)
    count, components = view.shape[0], view.shape[1]
    strides = [8 * view.stride[0], 8 * view.stride[1]]
    size = (count - 1) * strides[0] + (components - 1) * strides[1] + 8 if count > 0 else 0
    buffer = ffi.buffer(view.data, size) if size else b""
    one = components == 1
    made = numpy.ndarray((count,) if one else (count, components), dtype, buffer, 0,
                         strides[:1] if one else strides).view(Field)
    made._owner, made._epoch = owner, view.epoch
    return made


class Edit:
    """A field open for writing: `array`, or the value of a `with` block, whose end commits; left by
    an exception it abandons, and the values are those from before. Where a value is out of range
    commit() raises and the field stays open: mend it and commit again, or abandon()."""

    def __init__(self, owner, name):
        self._owner, self._edit = owner, ffi.new("mps_edit *")
        owner._invoke("particles_edit", (name, self._edit), {})
        self.array = _array(owner, self._edit.view)

    def commit(self):
        self._owner._invoke("particles_commit", (self._edit,), {})
        self.array.flags.writeable = False

    def abandon(self):
        self._owner._invoke("particles_abandon", (self._edit,), {})
        self.array.flags.writeable = False

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


class Particles(Object):
    """mps_particles: set["velocity"] reads a field, set.edit("velocity") writes it."""

    def __len__(self):
        return self.count()

    def __getitem__(self, name):
        view = ffi.new("mps_view *")
        self._invoke("particles_view", (name, view), {})
        made = _array(self, view[0])
        made.flags.writeable = False
        return made

    def edit(self, name):
        return Edit(self, name)


def wrap(pointer, context, alive):
    """The Python object of what a function has made."""
    kept = [held for held in alive if isinstance(held, Object) or _is_callback(held)]
    made = Particles if ffi.typeof(pointer).item.cname == "mps_particles" else Object
    return made(pointer, context, kept)
