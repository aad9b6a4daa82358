"""Calls of C functions: arguments to C, results and errors back."""

import difflib
import os
import reprlib
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace

import cffi
import numpy

from . import _cdef, _docs, _shapes

ffi = cffi.FFI()
ffi.cdef(_cdef.TEXT)


class _Library:
    """The library's functions; those that all solvers share also under the name of one, as the headers have them: a
    solver's pointer is one of mps_solver."""

    def __init__(self, opened):
        self._opened = opened

    def __dir__(self):
        return [*dir(self._opened), *_cdef.SHARED]

    def __getattr__(self, name):
        if name not in _cdef.SHARED:
            return getattr(self._opened, name)
        kind, target, definition = _cdef.SHARED[name]
        made = getattr(self._opened, target)
        if definition:
            made = ffi.callback(kind, _of_kind(made, getattr(self._opened, definition)))
        else:
            made = ffi.cast(kind, made)
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
#: These have a name for each kind of definition: mpm_add_boundary.
_OF_ANY_KIND = {"solver_add", "solver_set", "solver_get", "solver_get_def", "contact_get_def"}
#: Names of the functions, without "mps_": those of the headers, results without "_sized".
functions = sorted({name[4:].removesuffix("_sized") for name in _cdef.PARAMETERS
                    if not name.endswith(("_destroy", "_init"))} - _OF_ANY_KIND)


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
    """An array of a field taken before a solver stepped, or before particles were added, removed or sorted; a block
    whose law has returned."""


class MpsWarning(UserWarning):
    """A warning of the library, where the context has no hook `log`."""


class Result(SimpleNamespace):
    """A struct that C has filled: its members are attributes."""

    def _repr_html_(self):
        from . import _show

        return _show.result(self)


def class_name(kind):
    """mps_mpm_totals: MpmTotals."""
    return "".join(part.capitalize() for part in kind.removeprefix("mps_").split("_"))


#: Classes of results by the name of the C struct.
results = {kind: type(class_name(kind), (Result,), {"__doc__": text, "__module__": "libmps"})
           for kind, text in _docs.STRUCTS.items() if kind not in ("mps_error", "mps_edit")}


# ---- what C gives -------------------------------------------------------------------------------


def to_python(value):
    """A struct as a Result, a C string as str, an array in a struct as a NumPy array; numbers stay.
    Pointers come as they are."""
    if not isinstance(value, ffi.CData):
        return value
    kind = ffi.typeof(value)
    if kind.kind == "pointer" and kind.item.kind == "struct" and kind.item.fields:
        return to_python(value[0]) if value else None
    if kind.kind == "struct":
        made = results.get(kind.cname, Result)
        return made(**{name: to_python(getattr(value, name)) for name, _ in kind.fields})
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
    for the duration of the callback. An array stays as it is."""
    if isinstance(pointer, numpy.ndarray):
        return pointer[:count]
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


def unknown(where, name, fields):
    """TypeError of a member that no struct has: the nearest one, and all."""
    known = [f for f in fields if f not in ("struct_size", "reserved")]
    near = difflib.get_close_matches(name, known, 1)
    return TypeError(f"{where} {name!r}{f' (is it {near[0]!r}?)' if near else ''}: it has {', '.join(known)}")


class Call:
    """One call: keeps alive what C sees by pointer, and knows how long arrays are. What callbacks raise
    goes into `raised`, in this call or a later one that asks them."""

    def __init__(self, raised=None, owner=None):
        self.alive, self.owner = [], owner
        self.raised = [] if raised is None else raised
        self.lengths = {}  # numbers by name, of arguments and members
        self._arrays = []  # (owner of the formula, name, length, shape, whether C only reads it), to be compared

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

    def callback(self, kind, function, owner, word):
        """A C function that calls `function` without the first argument, C's `user`: the parameter or member `word`
        of `owner`."""
        if isinstance(getattr(function, "address", None), int):  # compiled, by numba's cfunc
            self.alive.append(function)
            return ffi.cast(kind, function.address)
        made = _callbacks.make(self, kind, function, owner, word)
        self.alive.append(made)
        return made

    def words(self, numbers):
        """What the names in a formula stand for, in a callback that was given these numbers."""
        return _Words(self.owner, {**self.lengths, **numbers})

    def wrap(self, value):
        """An argument of a callback; the pointer of an object that the call knows as that object."""
        for held in self.alive:
            if getattr(held, "pointer", None) is not None and same(held.pointer, value):
                return held
        return to_python(value)

    def struct(self, kind, members, where=""):
        """A definition: its defaults, then the members given. `where` begins the error of an unknown one."""
        made = ffi.new(f"{kind.cname} *")
        _set_defaults(made, kind)
        fields = dict(kind.fields)
        for name in fields:  # bytes of one struct of an array: layer_size of layers
            rows = fields.get(name[:-5] + "s") if name.endswith("_size") else None
            if rows and rows.type.kind == "pointer" and rows.type.item.kind == "struct":
                setattr(made, name, ffi.sizeof(rows.type.item))
        for name, value in members.items():
            if name not in fields:
                raise unknown(where or f"{kind.cname} has no member", name, fields)
            self.assign(made, name, fields[name].type, value)
            self.measure(kind.cname, name, fields[name].type, value)
        for name, formula in _shapes.STRUCTS.get(kind.cname, {}).items():  # ids alone say how many they are
            if formula in fields and formula not in members and members.get(name) is not None:
                setattr(made, formula, len(members[name]))
        for name, field in fields.items():
            if field.type.kind == "primitive":
                self.lengths[name] = getattr(made, name)
        self.alive.append(made)
        return made

    def measure(self, owner, name, kind, value, constant=True):
        """Notes how long an array is that C reads or writes."""
        plain = not isinstance(value, (ffi.CData, str, bytes, Mapping, Result)) and not hasattr(type(value), "pointer")
        if kind.kind == "pointer" and plain and hasattr(value, "__len__"):
            shape = numpy.shape(value) if kind.item.kind == "primitive" else (len(value),)
            self._arrays.append((owner, name, int(numpy.prod(shape)), shape, constant))

    def compare(self, words):
        """Refuses arrays that are shorter than C takes them to be, points with a number more, and tables whose rows
        are not those that C reads."""
        for owner, name, given, shape, constant in self._arrays:
            formula = (_shapes.FUNCTIONS.get(owner) or _shapes.STRUCTS.get(owner) or {}).get(name, "1")
            wanted = _shapes.length(formula, words)
            shown = "" if formula.isdigit() else f" ({formula})"
            if given < wanted or (constant and given > wanted and (formula.isdigit() or formula == "dim")):
                raise ValueError(f"{owner}: {name!r} has {given} values, and must have {wanted}{shown}")
            if len(shape) < 2 or given == 0 or wanted == 0:  # 0: C says why
                continue
            columns = _shapes.width(formula, words)
            if shape[-1] != (columns or given):
                raise ValueError(f"{owner}: {name!r} has the shape {tuple(shape)}, and must be "
                                 f"{f'rows of {columns}' if columns else 'a list of numbers'}{shown}")

    def assign(self, made, name, kind, value):
        owner = ffi.typeof(made).cname.removesuffix(" *").removesuffix(" &")
        if kind.kind == "array" and kind.item.kind == "pointer":
            self.fits(name, kind, value)
            for k, item in enumerate(value):
                getattr(made, name)[k] = self.to_c(item, kind.item, True)
        elif kind.kind == "array" and kind.item.cname == "char":
            text = os.fsencode(value)
            if b"\0" in text or len(text) >= kind.length:
                raise ValueError(f"{name!r} is {value!r}: a text of less than {kind.length} bytes without a NUL is wanted")
            setattr(made, name, text)
        elif kind.kind == "array":
            try:
                numbers = [float(x) for x in value]
            except (TypeError, ValueError) as error:
                raise type(error)(f"{name!r} is {value!r}: up to {kind.length} numbers are wanted") from error
            self.fits(name, kind, numbers)
            getattr(made, name)[0:len(numbers)] = numbers
        else:
            try:
                setattr(made, name, self.to_c(value, kind, True, owner, name))
            except (TypeError, OverflowError) as error:
                raise type(error)(f"{name!r} is {value!r}: {error}") from error

    @staticmethod
    def fits(name, kind, value):
        if len(value) > kind.length:
            raise ValueError(f"{name!r} has {len(value)} values, and takes at most {kind.length}")

    def to_c(self, value, kind, constant, owner=None, word=None):
        """A value for C: of the parameter or member `word` of `owner`, where it is one."""
        if value is None:
            return ffi.NULL
        if hasattr(type(value), "pointer"):
            return self.object(value, kind)
        if kind.kind == "function" and not isinstance(value, ffi.CData):
            return self.callback(kind, value, owner, word)
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
            if isinstance(value, (Mapping, Result)):
                return self.struct(kind.item, vars(value) if isinstance(value, Result) else value)
            if isinstance(value, (list, tuple)) and kind.item.fields:
                return self.structs(kind.item, value)
            if not isinstance(value, ffi.CData):
                raise TypeError(f"{value!r} is no {class_name(kind.item.cname)}")
            return value
        if kind.kind == "pointer" and not isinstance(value, ffi.CData):
            return self.array(value, kind.item, constant)
        return value

    def object(self, value, kind):
        """The pointer of an object of the library, which is kept alive."""
        if value.pointer is None:
            raise ValueError("it is closed")
        wanted = class_name(kind.item.cname) if _is_object(kind) else "number or array"
        if ffi.typeof(value.pointer) is not kind and kind.cname != "void *":
            raise TypeError(f"a {class_name(value.kind)} is no {wanted}")
        self.alive.append(value)
        return value.pointer

    def structs(self, kind, rows):
        """An array of structs from a list of dictionaries."""
        made = ffi.new(f"{kind.cname}[]", len(rows))
        for k, row in enumerate(rows):
            for name, field in kind.fields:  # a real number that is not given is unset
                if field.type.cname == "double" and name not in row:
                    setattr(made[k], name, float("nan"))
            fields = dict(kind.fields)
            for name, value in row.items():
                if name not in fields:
                    raise unknown(f"row {k} has no member", name, fields)
                self.assign(made[k], name, fields[name].type, value)
        self.alive.append(made)
        return made


# ---- the call -----------------------------------------------------------------------------------


def _is_struct(kind):
    return kind.kind == "pointer" and kind.item.kind == "struct"


def _is_object(kind):
    """A pointer to what the headers do not show."""
    return _is_struct(kind) and kind.item.fields is None


def _set_defaults(made, kind):
    """The defaults of a struct that has some."""
    number = getattr(library, "MPS_DEF_" + kind.cname.removeprefix("mps_").removesuffix("_def").upper(), None)
    if number is not None:
        status = library.mps_def_init(number, made, ffi.sizeof(kind))
        if status != 0:
            raise Error("mps_def_init", status)


def _output(kind):
    """What a trailing pointer points to, for the caller who gave none; None where that is no result."""
    if kind.kind != "pointer":
        return None
    if kind.item.kind == "pointer" and _is_object(kind.item):
        return ffi.new(f"{kind.item.cname}[1]")
    if _is_struct(kind) and kind.item.fields:
        made = ffi.new(f"{kind.item.cname}[1]")
        _set_defaults(made, kind.item)  # C reads some first, as mps_checkpoint
        return made
    if kind.item.kind == "primitive":
        return ffi.new(f"{kind.item.cname}[1]")
    return None


class _Arguments:
    """The arguments of one call in C's order, from those that Python was given; what C writes and the caller left
    out is made here, and returned."""

    def __init__(self, name, owner, state):
        self.name, self.owner, self.state = name, owner, state
        self.full = f"mps_{name}_sized" if f"mps_{name}_sized" in _cdef.PARAMETERS else f"mps_{name}"
        self.formulas = _shapes.FUNCTIONS.get(f"mps_{name}", {})
        self.values, self.outputs = [], []
        self.left_out = []  # (place, name, type) of arrays
        self.capacity = self.count = None  # places of `capacity` where it was left out, of the count that goes with it

    def take(self, given, members):
        kinds = ffi.typeof(getattr(library, self.full)).args
        for kind, parameter in zip(kinds, _cdef.PARAMETERS[self.full]):
            self.one(kind, parameter.removeprefix("const "), parameter.startswith("const "), given, members)
        if given:
            self.refuse(f"has too many arguments, {given[0]!r} is one")
        if members:
            self.refuse(f"takes no keyword, and was given {', '.join(members)}")

    def refuse(self, why):
        """Raises TypeError with the call as Python has it."""
        raise TypeError(f"{self.place()} {why}: {signature(self.name, self.word())}")

    def word(self):
        """What the function is called in Python."""
        return self.name.removeprefix(f"{getattr(self.owner, 'kind', None)}_")

    def place(self):
        kind = getattr(self.owner, "kind", None)
        return f"{class_name(kind)}.{self.word()}()" if kind else f"{self.word()}()"

    def returns(self, value, kind, word, constant):
        """Whether C writes a number there, for which `value` is no place: the call returns it."""
        return (not constant and word not in self.formulas and kind.kind == "pointer" and kind.item.kind == "primitive" and
                kind.item.cname != "char" and value is not None and not isinstance(value, (numpy.ndarray, ffi.CData)))

    def convert(self, value, kind, word, constant):
        """An argument for C; what is wrong with it names it."""
        try:
            return self.state.to_c(value, kind, constant, self.full, word)
        except (TypeError, ValueError, OverflowError) as error:
            raise type(error)(f"{self.place()}: {word!r} is {reprlib.repr(value)}: {error}") from error

    def number(self, value, kind, word):
        """Refuses what is no number where C wants one, which cffi would say without the argument's name."""
        try:
            ffi.new(f"{kind.cname} *", [] if value is None else value)  # None would be no initial value
        except (TypeError, OverflowError) as error:
            raise type(error)(f"{self.place()}: {word!r} is {reprlib.repr(value)}: {error}") from error

    def one(self, kind, word, constant, given, members):
        state = self.state
        if (word == "user" and kind.cname == "void *") or word == "release":  # Python keeps callbacks with their objects
            self.values.append(ffi.NULL)
        elif word == "size" and self.full.endswith("_sized"):
            self.values.append(ffi.sizeof(self.outputs[-1]))
        elif constant and _is_struct(kind) and word == "def" and not (given and isinstance(given[0], dict)):
            self.values.append(state.struct(kind.item, dict(members), f"{self.place()} has no keyword"))
            members.clear()
        elif word == "count" and kind.cname == "int64_t *" and ("capacity" in state.lengths):
            self.count = len(self.values)  # how many there are stands before the arrays
            self.output(_output(kind))
        elif given and not self.returns(given[0], kind, word, constant):
            value = given.pop(0)
            self.values.append(self.convert(value, kind, word, constant))
            if kind.kind == "primitive":
                self.number(value, kind, word)
            state.measure(f"mps_{self.name}", word, kind, value, constant)
            state.lengths[word] = value
        elif word == "capacity":
            self.capacity = len(self.values)
            state.lengths[word] = 0
            self.values.append(0)
        elif kind.kind == "function":
            self.values.append(ffi.NULL)
        elif word in self.formulas and not constant:
            self.left_out.append((len(self.values), word, kind))
            self.values.append(ffi.NULL)
        else:
            made = None if constant else _output(kind)
            if made is None:
                self.refuse(f"takes {word!r} by its place, not by its name" if word in members else f"lacks {word!r}")
            self.output(made)

    def output(self, made):
        self.outputs.append(made)
        self.values.append(made)

    def make_arrays(self, function):
        """Arrays that were left out, as long as C fills them: asks first how many there are, where it says so."""
        if self.capacity is not None:
            status = function(*self.values)
            if status:
                return status
            self.values[self.capacity] = self.state.lengths["capacity"] = self.values[self.count][0]
        if self.left_out and self.count is not None:
            self.outputs.remove(self.values[self.count])
        words = _Words(self.owner, self.state.lengths)
        written = {place: value for place, value in enumerate(self.values) if any(value is o for o in self.outputs)}
        for place, word, kind in self.left_out:
            array = numpy.zeros(_shapes.length(self.formulas[word], words), _DTYPES[kind.item.cname])
            written[place] = array
            self.values[place] = ffi.cast(kind, array.ctypes.data)
        self.outputs = [written[place] for place in sorted(written)]  # in C's order
        return 0

    def results(self):
        """What C has written; of arrays of a given capacity those rows that are."""
        if not self.left_out or self.count is None:
            return self.outputs
        count, room = self.values[self.count][0], self.state.lengths["capacity"]
        return [o[:len(o) // room * min(count, room)] if isinstance(o, numpy.ndarray) and room else o
                for o in self.outputs]


def call(name, owner, values, members):
    """Calls mps_`name`: `owner` (None: no object) and `values` are its arguments, `members` those of its
    definition. Returns (results, the call)."""
    state = Call(None if owner is None else owner.context._raised, owner)
    arguments = _Arguments(name, owner, state)
    arguments.take(list(([owner] if owner is not None else []) + list(values)), dict(members))
    function = getattr(library, arguments.full)
    state.compare(_Words(owner, state.lengths))
    result = arguments.make_arrays(function) or function(*arguments.values)
    return result, arguments.results(), state


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
            view, text = ffi.new("mps_view *"), os.fspath(name).encode()
            if library.mps_particles_view(self._set(), text, view):
                self._look_up(text, view)
            return view.shape[1]  # 0: the call itself says that there is none

        return self.numbers.get("components", components)  # a number where the call has one of that name

    def _look_up(self, name, view):
        """The view of a field that the call would add: an empty set has its shape."""
        made, definition = ffi.new("mps_particles *[1]"), ffi.new("mps_particles_def *")
        _set_defaults(definition, ffi.typeof("mps_particles_def"))
        definition.dim, definition.spacing = self._dim(), 1.0
        if library.mps_particles_create(self.owner.context.pointer, definition, made) == 0:
            if library.mps_particles_add_field(made[0], name, 0) == 0:
                library.mps_particles_view(made[0], name, view)
            library.mps_particles_destroy(made)

    def _nodes(self):
        return lambda number: self.owner.lengths.get(number, 1)


def signature(name, word):
    """The arguments of mps_`name` as a call of Python has them, with their types; `word` is what it is called there."""
    _, arguments, optional, keywords, _ = _docs.FUNCTIONS[name]
    shown = [f"{argument}: {kind}{' = None' if k >= len(arguments) - optional else ''}"
             for k, (argument, kind) in enumerate(arguments)]
    if keywords:
        shown.append("**definition")
    return f"{word}({', '.join(shown)})"


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

        def called(*values):
            kinds = ffi.typeof(found).args
            if len(values) != len(kinds):
                raise TypeError(f"{name}() takes {len(kinds)} arguments, and was given {len(values)}: "
                                f"{signature(name, name)}")
            return to_python(found(*values))

        return called
    raise AttributeError(f"libmps has no {name!r}")


from . import _callbacks  # noqa: E402 (it uses ffi)
