"""Calls of C functions: arguments to C, results and errors back."""

import os
from pathlib import Path
from types import SimpleNamespace

import cffi
import numpy

from . import _cdef, _shapes

ffi = cffi.FFI()
ffi.cdef(_cdef.TEXT)


def _open():
    """The library beside the package, as installed; else where LIBMPS_LIBRARY or the system says."""
    named = os.environ.get("LIBMPS_LIBRARY")
    if named:
        return ffi.dlopen(named)
    beside = Path(__file__).resolve().parents[3] / _cdef.SONAME
    return ffi.dlopen(str(beside) if beside.exists() else _cdef.SONAME)


library = _open()
#: Names of the functions, without "mps_": those of the headers, results without "_sized".
functions = sorted({name[4:].removesuffix("_sized") for name in _cdef.PARAMETERS
                    if not name.endswith(("_destroy", "_init"))})


class Error(Exception):
    """A failed call. `status` is MPS_ERROR_...; `step`, `particle` and `object` are those of the
    error record, where the library knew them."""

    def __init__(self, function, status, record=None):
        self.status, self.function = status, function
        self.step = self.particle = -1
        self.object = ""
        text = ffi.string(library.mps_status_text(status)).decode()
        if record and record.status == status:
            text = ffi.string(record.message).decode() or text
            self.step, self.particle = record.step, record.particle
            self.object = ffi.string(record.object).decode()
        super().__init__(f"{function}: {text}")


class StaleError(Exception):
    """An array of a field whose particles were added, removed or sorted since."""


# ---- what C gives -------------------------------------------------------------------------------


def to_python(value):
    """A struct as a namespace, a C string as str, an array in a struct as a NumPy array; numbers stay.
    Pointers come as they are."""
    if not isinstance(value, ffi.CData):
        return value
    kind = ffi.typeof(value)
    if kind.kind == "pointer" and kind.item.kind == "struct" and kind.item.fields:
        return to_python(value[0]) if value else None
    if kind.kind == "struct":
        return SimpleNamespace(**{name: to_python(getattr(value, name)) for name, _ in kind.fields})
    if kind.kind == "array" and kind.item.cname == "char":
        return ffi.string(value).decode()
    if kind.kind == "array" and kind.item.kind == "pointer":
        return [to_python(item) for item in value]
    if kind.kind == "array":
        return numpy.array([to_python(item) for item in value])
    if kind.kind == "pointer" and kind.item.cname == "char":
        return ffi.string(value).decode() if value else None
    return value


def same(pointer, other):
    """Whether both are one object: a part may lie where its owner does."""
    return (isinstance(pointer, ffi.CData) and isinstance(other, ffi.CData) and
            ffi.typeof(pointer) is ffi.typeof(other) and pointer == other)


def column(pointer, count):
    """The `count` numbers (double or int64_t) behind a pointer that a callback was given, as an array:
    for the duration of the callback."""
    if not pointer:
        return None
    dtype = _DTYPES[ffi.typeof(pointer).item.cname]
    return numpy.frombuffer(ffi.buffer(pointer, 8 * count), dtype)


# ---- what C takes -------------------------------------------------------------------------------

_DTYPES = {"double": numpy.float64, "int64_t": numpy.int64, "int32_t": numpy.int32}


def _numbers(value, dtype):
    """The value, if all that it holds are numbers of that type: a mask is no array of numbers, and
    1.5 is no whole one."""
    given = numpy.asarray(value)
    whole = numpy.issubdtype(dtype, numpy.integer)
    if given.size and given.dtype.kind == "b":
        raise TypeError(f"a mask is no array of {dtype.__name__}: numpy.flatnonzero(mask) has the places")
    if given.size and (given.dtype.kind == "c" or (whole and given.dtype.kind == "f" and
                                                   not (given == numpy.floor(given)).all())):
        raise TypeError(f"{given.ravel()[:3]} ... are no numbers of {dtype.__name__}")
    return given


class Call:
    """One call: keeps alive what C sees by pointer, and knows how long arrays are. What callbacks raise
    goes into `raised`, in this call or a later one that asks them."""

    def __init__(self, raised=None):
        self.alive = []
        self.raised = [] if raised is None else raised
        self.lengths = {}  # numbers by name, of arguments and members
        self._arrays = []  # (owner of the formula, its shapes, name, length), to be compared

    def array(self, value, item, constant):
        """A pointer to the numbers of a list (which C only reads) or NumPy array."""
        dtype = _DTYPES.get(item.cname)
        if dtype is None:
            raise TypeError(f"{item.cname} * is no array of numbers")
        if not constant and not isinstance(value, numpy.ndarray):
            raise TypeError("the function writes this array: give a NumPy array")
        held = numpy.ascontiguousarray(_numbers(value, dtype), dtype)
        if not constant and held is not value:
            raise TypeError(f"the function writes this array: it must be contiguous, of {dtype.__name__}")
        self.alive.append(held)
        return ffi.cast(f"{item.cname} *", held.ctypes.data)

    def callback(self, kind, function):
        """A C function that calls `function` without the first argument, C's `user`."""

        def called(_user, *values):
            # The same error for all: the first exception is the one that is raised.
            answer = function(*[self.wrap(value) for value in values])
            if kind.result.kind == "void":
                return None
            return 0 if answer is None else answer

        def failed(_type, exception, _trace):
            self.raised.append(exception)

        stop = library.MPS_ERROR_CANCELLED
        error = None if kind.result.kind == "void" else stop if kind.result.kind == "enum" else 1
        made = ffi.callback(kind, called, error=error, onerror=failed)
        self.alive.append(made)
        return made

    def wrap(self, value):
        """An argument of a callback; the pointer of an object that the call knows as that object."""
        for held in self.alive:
            if getattr(held, "pointer", None) is not None and same(held.pointer, value):
                return held
        return to_python(value)

    def struct(self, kind, members):
        """A definition: its defaults, then the members given."""
        made = ffi.new(f"{kind.cname} *")
        init = getattr(library, kind.cname + "_init", None)
        if init and len(ffi.typeof(init).args) == 2:
            status = init(made, ffi.sizeof(kind))
            if status != 0:
                raise Error(kind.cname + "_init", status)
        fields = dict(kind.fields)
        for name in fields:  # bytes of one struct of an array: layer_size of layers
            rows = fields.get(name[:-5] + "s") if name.endswith("_size") else None
            if rows and rows.type.kind == "pointer" and rows.type.item.kind == "struct":
                setattr(made, name, ffi.sizeof(rows.type.item))
        for name, value in members.items():
            if name not in fields:
                known = ", ".join(f for f in fields if f not in ("struct_size", "reserved"))
                raise TypeError(f"{kind.cname} has no member {name!r}: it has {known}")
            self.assign(made, name, fields[name].type, value)
            self.measure(kind.cname, name, fields[name].type, value)
        for name, field in fields.items():
            if field.type.kind == "primitive":
                self.lengths[name] = getattr(made, name)
        self.alive.append(made)
        return made

    def measure(self, owner, name, kind, value):
        """Notes how long an array is that C reads or writes."""
        plain = not isinstance(value, (ffi.CData, str, bytes, dict)) and not hasattr(type(value), "pointer")
        if kind.kind == "pointer" and plain and hasattr(value, "__len__"):
            self._arrays.append((owner, name, numpy.size(value) if kind.item.kind == "primitive"
                                 else len(value)))

    def compare(self, words):
        """Refuses arrays that are shorter than C takes them to be."""
        for owner, name, given in self._arrays:
            formula = (_shapes.FUNCTIONS.get(owner) or _shapes.STRUCTS.get(owner) or {}).get(name, "1")
            wanted = _shapes.length(formula, words)
            if given < wanted:
                raise ValueError(f"{owner}: {name!r} has {given} values, and must have {wanted}"
                                 f"{'' if formula.isdigit() else f' ({formula})'}")

    def assign(self, made, name, kind, value):
        if kind.kind == "array" and kind.item.kind == "pointer":
            self.fits(name, kind, value)
            for k, item in enumerate(value):
                getattr(made, name)[k] = self.to_c(item, kind.item, True)
        elif kind.kind == "array":
            self.fits(name, kind, value)
            getattr(made, name)[0:len(value)] = [float(x) for x in value]
        else:
            try:
                setattr(made, name, self.to_c(value, kind, True))
            except (TypeError, OverflowError) as error:
                raise type(error)(f"{name!r} is {value!r}: {error}") from error

    @staticmethod
    def fits(name, kind, value):
        if len(value) > kind.length:
            raise ValueError(f"{name!r} has {len(value)} values, and takes at most {kind.length}")

    def to_c(self, value, kind, constant):
        if value is None:
            return ffi.NULL
        if getattr(value, "pointer", None) is not None:
            self.alive.append(value)
            return value.pointer
        if kind.kind == "function" and not isinstance(value, ffi.CData):
            return self.callback(kind, value)
        if kind.kind == "pointer" and kind.item.cname == "char":
            text = os.fsencode(value)
            if b"\0" in text:
                raise ValueError(f"{value!r} has a null character, where C would end it")
            made = ffi.new("char[]", text)
            self.alive.append(made)
            return made
        if kind.kind == "pointer" and kind.item.kind == "pointer" and not isinstance(value, ffi.CData):
            made = ffi.new(f"{kind.item.cname}[]", [self.to_c(v, kind.item, True) for v in value])
            self.alive.append(made)
            return made
        if kind.kind == "pointer" and kind.item.kind == "struct":
            if isinstance(value, dict):
                return self.struct(kind.item, value)
            if isinstance(value, (list, tuple)) and kind.item.fields:
                return self.structs(kind.item, value)
            if not isinstance(value, ffi.CData):
                raise TypeError(f"{value!r} is no {kind.item.cname}")
            return value
        if kind.kind == "pointer" and not isinstance(value, ffi.CData):
            return self.array(value, kind.item, constant)
        return value

    def structs(self, kind, rows):
        """An array of structs from a list of dictionaries."""
        made = ffi.new(f"{kind.cname}[]", len(rows))
        for k, row in enumerate(rows):
            for name, field in kind.fields:  # a real number that is not given is unset
                if field.type.cname == "double" and name not in row:
                    setattr(made[k], name, float("nan"))
            for name, value in row.items():
                self.assign(made[k], name, dict(kind.fields)[name].type, value)
        self.alive.append(made)
        return made


# ---- the call -----------------------------------------------------------------------------------


def _is_struct(kind):
    return kind.kind == "pointer" and kind.item.kind == "struct"


def _is_object(kind):
    """A pointer to what the headers do not show."""
    return _is_struct(kind) and kind.item.fields is None


def _output(kind):
    """What a trailing pointer points to, for the caller who gave none; None where that is no result."""
    if kind.kind != "pointer":
        return None
    if kind.item.kind == "pointer" and _is_object(kind.item):
        return ffi.new(f"{kind.item.cname}[1]")
    if _is_struct(kind) and kind.item.fields:
        return ffi.new(f"{kind.item.cname}[1]")
    if kind.item.kind == "primitive":
        return ffi.new(f"{kind.item.cname}[1]")
    return None


def call(name, owner, values, members):
    """Calls mps_`name`: `owner` (None: no object) and `values` are its arguments, `members` those of its
    definition. Returns (results, the call)."""
    sized = f"mps_{name}_sized"
    full = sized if sized in _cdef.PARAMETERS else f"mps_{name}"
    function = getattr(library, full)
    kinds, names = ffi.typeof(function).args, _cdef.PARAMETERS[full]
    state = Call(None if owner is None else owner.context._raised)
    given = list(([owner] if owner is not None else []) + list(values))
    arguments, outputs = [], []
    members_used = not members
    for kind, parameter in zip(kinds, names):
        constant = parameter.startswith("const ")
        word = parameter.removeprefix("const ")
        if word == "user" and kind.cname == "void *":
            arguments.append(ffi.NULL)
        elif full == sized and word == "size":
            arguments.append(ffi.sizeof(outputs[-1]))
        elif constant and _is_struct(kind) and word == "def" and not (given and isinstance(given[0], dict)):
            arguments.append(state.struct(kind.item, members))
            members_used = True
        elif word == "count" and "capacity" in state.lengths and kind.cname == "int64_t *":
            outputs.append(_output(kind))  # how many there are stands before the arrays
            arguments.append(outputs[-1])
        elif given:
            value = given.pop(0)
            arguments.append(state.to_c(value, kind, constant))
            state.measure(f"mps_{name}", word, kind, value)
            state.lengths[word] = value
        else:
            made = None if constant else _output(kind)
            if made is None:
                raise TypeError(f"{name}() lacks {word!r}: its arguments are {signature(name)}")
            outputs.append(made)
            arguments.append(made)
    if given or not members_used:
        extra = "too many arguments" if given else f"no definition that has {', '.join(members)}"
        raise TypeError(f"{name}(): {extra}: its arguments are {signature(name)}")
    state.compare(_Words(owner, state.lengths))
    result = function(*arguments)
    return result, outputs, state


class _Words:
    """What the names in a formula of _shapes stand for."""

    def __init__(self, owner, numbers):
        self.owner, self.numbers = owner, numbers

    def __getitem__(self, word):
        found = getattr(self, "_" + word, None)
        if found:
            return found()
        if word.startswith("MPS_"):
            return getattr(library, word)
        if word in self.numbers:
            return self.numbers[word]
        return self.owner.lengths[word]

    def _set(self):
        """The set of particles that the call is about."""
        given = self.numbers.get("particles")
        if getattr(given, "kind", None) == "particles":
            return given.pointer
        owner = self.owner._alive[0] if self.owner.kind == "grid" else self.owner
        if owner.kind == "particles":
            return owner.pointer
        return getattr(library, f"mps_{owner.kind}_particles")(owner.pointer)

    def _dim(self):
        if self.owner.kind == "body":
            return library.mps_body_dim(self.owner.pointer)
        return library.mps_particles_dim(self._set())

    def _particles(self):
        return library.mps_particles_count(self._set())

    def _components(self):
        def components(name):
            view = ffi.new("mps_view *")
            status = library.mps_particles_view(self._set(), os.fspath(name).encode(), view)
            return 0 if status else view.shape[1]  # the call itself says that there is none

        return components

    def _nodes(self):
        return lambda number: self.owner.lengths.get(number, 1)


def signature(name):
    """The arguments of mps_`name` as the C header has them."""
    full = f"mps_{name}_sized" if f"mps_{name}_sized" in _cdef.PARAMETERS else f"mps_{name}"
    kinds = ffi.typeof(getattr(library, full)).args
    pairs = zip(kinds, _cdef.PARAMETERS[full])
    return "(" + ", ".join(("const " if p.startswith("const ") else "") +
                           f"{k.cname} {p.removeprefix('const ')}"
                           for k, p in pairs if p != "size") + ")"


def returns_status(name):
    full = f"mps_{name}_sized" if f"mps_{name}_sized" in _cdef.PARAMETERS else f"mps_{name}"
    return ffi.typeof(getattr(library, full)).result.cname == "mps_status"


def function_or_constant(name):
    for full in (f"MPS_{name}", f"mps_{name}"):
        try:
            found = getattr(library, full)
        except AttributeError:
            continue
        if not callable(found):
            return found
        return lambda *values: to_python(found(*values))
    raise AttributeError(f"libmps has no {name!r}")
