"""Calls of C functions by the table of functions: arguments to C, results and errors back."""

import collections
import difflib
import functools
import os
import reprlib
from collections.abc import Mapping
from types import SimpleNamespace

import numpy

from . import _cdef, _enums, _quantities, _shapes, _tables
from ._errors import ArgumentError, failed
from ._library import ffi, is_object, is_struct, library, opaque, tag

_DTYPES = {"double": numpy.float64, "int64_t": numpy.int64, "int32_t": numpy.int32}
SOLVERS = ("mpm", "dynamics", "elastic", "fluid", "solver")


class Result(SimpleNamespace):
    """A struct that C has filled: its members are attributes."""

    def __getattr__(self, name):
        if name.startswith("_"):  # what IPython, copy and pickle ask for
            raise AttributeError(name)
        near = difflib.get_close_matches(name, vars(self), 1)
        raise AttributeError(f"{type(self).__name__} has no {name!r}{f' (is it {near[0]!r}?)' if near else ''}: it has {', '.join(vars(self))}")

    def _repr_html_(self):
        from . import _show

        return _show.result(self)


def class_name(kind):
    """mps_mpm_totals: MpmTotals."""
    return "".join(part.capitalize() for part in kind.removeprefix("mps_").split("_"))


#: Classes of results by the name of the C struct.
results = {kind: type(name, (Result,), {"__doc__": text, "__module__": "libmps"})
           for kind, (name, text) in _tables.STRUCTS.items()}


class Function:
    """A row of the table: a function of C, and what it is in Python."""

    def __init__(self, name, row):
        (self.full, self.owner, self.form, self.word, self.made, result, self.parameters, arguments, self.definition,
         self.results, self.type, self.doc) = row
        self.name, self.status = name, result == "mps_status"
        self.arguments = {argument[0]: argument for argument in arguments}
        self.formulas = _shapes.FUNCTIONS.get(f"mps_{name}", {})
        self.takes_context = self.form in ("class", "function") and any(role == "context" for role, _, _ in self.parameters)
        #: Whether C stores objects or callbacks among the arguments: a callback without `release` is for the call alone.
        self.keeps = self.owner and (self.word.startswith(("add_", "set_", "drive")) and
                                     [role for role, _, _ in self.parameters].count("null") != 1)
        #: Whether particles may be selected by a box, or all, in place of their ids.
        self.selects = ("ids" in self.arguments and self.owner in ("particles", *SOLVERS) and
                        any(role == "count" for role, _, _ in self.parameters))
        self.enum = self.type if self.type in _tables.ENUMS else ""
        self._c = self._kinds = self._tuple = None
        self.place = f"{class_name(self.owner)}.{self.word}()" if self.owner else f"{self.word}()"

    def c(self):
        """(the function, types of its parameters, with those that are const)"""
        if self._c is None:
            found = getattr(library, self.full)
            const = [parameter.startswith("const ") for parameter in _cdef.PARAMETERS[self.full]]
            self._c = (found, ffi.typeof(found).args, const)
        return self._c

    def signature(self):
        """Its arguments as a call of Python has them."""
        shown = [name if row[2] is ... else f"{name}={row[2]!r}" for name, row in self.arguments.items()]
        return f"{self.word}({', '.join(shown + (['**definition'] if self.definition else []))})"

    def refuse(self, why):
        raise TypeError(f"{self.place} {why}: {self.signature()}")

    def several(self, made):
        """More than one result: a tuple with names."""
        names = [name or row.lower() for name, row in self.results]
        if len(names) != len(made):
            return tuple(made)
        if self._tuple is None:
            self._tuple = collections.namedtuple(class_name(self.word), names, rename=True, module="libmps")
        return self._tuple(*made)


functions = {name: Function(name, row) for name, row in _tables.FUNCTIONS.items()}


# ---- what C gives -------------------------------------------------------------------------------


class _Members:
    """What the names in a formula of a struct stand for."""

    def __init__(self, struct):
        self.struct = struct

    def __getitem__(self, word):
        return getattr(library, word) if word.startswith("MPS_") else getattr(self.struct, word)


def view(value):
    """What an mps_view lends, as a copy."""
    dtype = numpy.dtype(numpy.float64 if value.dtype.code == 2 else numpy.int64)
    count, components = value.shape[0], value.shape[1]
    if count == 0:
        return numpy.zeros((0,) if components == 1 else (0, components), dtype)
    strides = [8 * value.stride[0], 8 * value.stride[1]]
    buffer = ffi.buffer(value.data, (count - 1) * strides[0] + (components - 1) * strides[1] + 8)
    one = components == 1
    return numpy.ndarray((count,) if one else (count, components), dtype, buffer, 0, strides[:1] if one else strides).copy()


def hidden(member):
    return member == "struct_size" or member.startswith("reserved") or member.endswith(("user", "release"))


@functools.cache
def shown(kind):
    """The members of a struct that Python has."""
    return [(member, field) for member, field in kind.fields if not hidden(member)]


def struct_to_python(value, kind):
    name = tag(kind)
    if name == "mps_view":
        return view(value)
    formulas, chosen, found = _shapes.STRUCTS.get(name, {}), _tables.CHOSEN.get(name, {}), {}
    for member, field in shown(kind):
        made = getattr(value, member)
        if member in formulas and field.type.kind == "pointer" and field.type.item.cname in _DTYPES:
            made = numbers(made, _shapes.length(formulas[member], _Members(value))) if made else None
        elif member in chosen:
            made = _enums.named(chosen[member], made)
        else:
            made = to_python(made)
        found[member] = made
    return results.get(name, Result)(**found)


def numbers(pointer, count):
    """A copy of the numbers behind a pointer."""
    dtype = numpy.dtype(_DTYPES[ffi.typeof(pointer).item.cname])
    return numpy.frombuffer(ffi.buffer(pointer, dtype.itemsize * count), dtype).copy() if count else numpy.zeros(0, dtype)


def to_python(value):
    """A struct as a Result, a C string as str, an array in a struct as a NumPy array; numbers stay.
    Pointers come as they are."""
    if not isinstance(value, ffi.CData):
        return value
    kind = ffi.typeof(value)
    if kind.kind == "pointer" and kind.item.kind == "struct" and not opaque(kind.item):
        return to_python(value[0]) if value else None
    if kind.kind == "struct":
        return struct_to_python(value, kind)
    if kind.kind == "array" and kind.item.cname == "char":
        return ffi.string(value).decode()
    if kind.kind == "array" and kind.item.kind == "pointer":
        return [to_python(item) for item in value]
    if kind.kind == "array" and kind.item.cname in _DTYPES:
        return numpy.frombuffer(ffi.buffer(value), _DTYPES[kind.item.cname]).copy()
    if kind.kind == "array":
        return numpy.array([to_python(item) for item in value])
    if kind.kind == "pointer" and kind.item.cname == "char":
        return ffi.string(value).decode() if value else None
    if kind.kind == "pointer" and not value:
        return None
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


def unknown(where, name, known):
    """TypeError of a keyword that there is not: the nearest one, and all."""
    known = list(known)
    near = difflib.get_close_matches(name, known, 1)
    return TypeError(f"{where} {name!r}{f' (is it {near[0]!r}?)' if near else ''}: it has {', '.join(known)}")


#: A member that no table has.
_PLAIN = ("", None, "", "", ())


class Call:
    """One call: keeps alive what C sees by pointer, and knows how long arrays are. What callbacks raise
    goes into `raised`, in this call or a later one that asks them."""

    def __init__(self, raised=None, owner=None):
        self.alive, self.owner = [], owner
        self.raised = [] if raised is None else raised
        self.lengths = {}  # numbers by name, of arguments and members
        self._arrays = []  # (owner of the formula, name, length, shape, whether C only reads it), to be compared

    def array(self, value, item):
        """A pointer to the numbers of a list or an array, which C only reads."""
        dtype = _DTYPES.get(item.cname)
        if dtype is None:
            raise TypeError(f"{item.cname} * is no array of numbers")
        if numpy.ndim(value) == 0:
            raise TypeError(f"a list or an array is wanted, of one number [{value}]")
        held = numpy.ascontiguousarray(_numbers(value, dtype), dtype)
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

    def words(self, found):
        """What the names in a formula stand for, in a callback that was given these numbers."""
        return Words(self.owner, {**self.lengths, **found})

    def wrap(self, value):
        """An argument of a callback; the pointer of an object that the call knows as that object."""
        solver = isinstance(value, ffi.CData) and ffi.typeof(value) is ffi.typeof("mps_solver *")
        for held in [*self.alive, *(part for held in self.alive for part in getattr(held, "_alive", ()))]:
            pointer = getattr(held, "_pointer", None)
            if pointer is not None and (same(pointer, value) or
                                        (solver and held._kind in SOLVERS and ffi.cast("mps_solver *", pointer) == value)):
                return held
        return to_python(value)

    def struct(self, kind, members, where=""):
        """A definition: its defaults, then the members given. `where` begins the error of an unknown one."""
        made, name = ffi.new(f"{kind.cname} *"), tag(kind)
        _set_defaults(made, kind)
        fields = dict(kind.fields)
        rows = _tables.DEFINITIONS.get(name) or {field: _PLAIN for field in fields if not hidden(field)}
        for field in fields:  # bytes of one struct of an array: layer_size of layers
            of = fields.get(field[:-5] + "s") if field.endswith("_size") else None
            if of and of.type.kind == "pointer" and of.type.item.kind == "struct":
                setattr(made, field, ffi.sizeof(of.type.item))
        for word, value in members.items():
            if word not in rows:
                raise unknown(where or f"{name} has no member", word, rows)
            if value is None:  # the default
                continue
            if word == "box":
                self.box(made, fields, value)
                continue
            field = word.removesuffix("_") if word not in fields else word
            self.assign(made, field, fields[field].type, value, rows[word])
            self.measure(name, field, fields[field].type, value)
        self.count(made, name, fields)
        for field, described in fields.items():
            if described.type.kind == "primitive":
                self.lengths[field] = getattr(made, field)
        self.alive.append(made)
        return made

    def count(self, made, name, fields):
        """The members that say how long arrays are, from the arrays."""
        formulas = _shapes.STRUCTS.get(name, {})
        words, done = Words(self.owner, _Fields(made)), set()
        for owner, array, size, _, _ in self._arrays:
            formula = formulas.get(array) if owner == name else None
            for word in _shapes.counts(formula) & set(fields) - done if formula else ():
                found = _shapes.solve(formula, word, size, words)
                if found is not None:
                    setattr(made, word, found)
                    done.add(word)
        if "field_count" in fields and made.fields:  # texts, of a recorder
            made.field_count = next(size for owner, array, size, _, _ in self._arrays if (owner, array) == (name, "fields"))

    def box(self, made, fields, value):
        """The corners of a selection, which C has as two members."""
        corners = [list(corner) if corner is not None else [] for corner in value]
        if len(corners) != 2:
            raise ArgumentError(f"'box' is {value!r}, must be two corners: (lower, upper)")
        for name, corner in zip(("lower", "upper"), corners):
            self.fits("box", fields[name].type, corner)
            for k, number in enumerate(corner):
                getattr(made, name)[k] = float("nan") if number is None else _quantities.number(number, "m", "box")

    def measure(self, owner, name, kind, value, constant=True):
        """Notes how long an array is that C reads or writes."""
        plain = not isinstance(value, (ffi.CData, str, bytes, Mapping, Result)) and not hasattr(type(value), "_pointer")
        if kind.kind == "pointer" and plain and hasattr(value, "__len__"):
            shape = numpy.shape(value) if kind.item.kind == "primitive" else (len(value),)
            self._arrays.append((owner, name, int(numpy.prod(shape)), shape, constant))

    def compare(self, words, place):
        """Refuses arrays of another length than C takes them to be, and tables whose rows are not those that C reads."""
        for owner, name, given, shape, constant in self._arrays:
            formula = (_shapes.FUNCTIONS.get(owner) or _shapes.STRUCTS.get(owner) or {}).get(name)
            if formula is None:
                continue
            wanted = _shapes.length(formula, words)
            shown = "" if formula.isdigit() else f" ({formula})"
            columns = _shapes.width(formula, words)
            if len(shape) > 1 and given and wanted and shape[-1] != (columns or given):
                raise ArgumentError(f"{place}: {name!r} has the shape {tuple(shape)}, and must be "
                                    f"{f'rows of {columns}' if columns else 'a list of numbers'}{shown}")
            if given < wanted or (constant and given > wanted):
                raise ArgumentError(f"{place}: {name!r} has {given} values, and must have {wanted}{shown}")

    def assign(self, made, name, kind, value, row):
        owner = tag(ffi.typeof(made).item)
        _, _, unit, enum, allowed = row
        if enum:
            value = _enums.number(enum, name, value, allowed)
        elif name == "sides" and type(value) is not int:  # bits by the names or members of Side; a plain number has the bits
            try:
                sides = [value] if isinstance(value, (str, _enums.enumeration("Side"))) else list(value)
            except TypeError:
                raise TypeError(f"{name!r} is {value!r}: names of sides are wanted, such as 'y_upper' or ['x_lower', 'x_upper']") from None
            value = _shapes.bits(_enums.number("Side", name, side) for side in sides)
        if kind.kind == "array" and kind.item.kind == "pointer":
            self.fits(name, kind, value)
            for k, item in enumerate(value):
                getattr(made, name)[k] = self.to_c(item, kind.item)
        elif kind.kind == "array" and kind.item.cname == "char":
            text = os.fsencode(value)
            if b"\0" in text or len(text) >= kind.length:
                raise ArgumentError(f"{name!r} is {value!r}: a text of less than {kind.length} bytes without a NUL is wanted")
            setattr(made, name, text)
        elif kind.kind == "array":
            try:
                found = [float(_quantities.number(x, unit, name)) for x in value]
            except ArgumentError:
                raise
            except (TypeError, ValueError) as error:
                raise type(error)(f"{name!r} is {value!r}: up to {kind.length} numbers are wanted") from error
            self.fits(name, kind, found)
            getattr(made, name)[0:len(found)] = found
        else:
            if kind.cname == "double" or (kind.kind == "pointer" and kind.item.cname == "double"):
                value = _quantities.number(value, unit, name)
            try:
                setattr(made, name, self.to_c(value, kind, owner, name))
            except (TypeError, OverflowError) as error:
                raise type(error)(f"{name!r} is {value!r}: {error}") from error

    @staticmethod
    def fits(name, kind, value):
        if len(value) > kind.length:
            raise ArgumentError(f"{name!r} has {len(value)} values, and takes at most {kind.length}")

    def to_c(self, value, kind, owner=None, word=None):
        """A value for C: of the parameter or member `word` of `owner`, where it is one."""
        if value is None:
            return ffi.NULL
        if hasattr(type(value), "_pointer"):
            return self.object(value, kind)
        if kind.kind == "function" and not isinstance(value, ffi.CData):
            return self.callback(kind, value, owner, word)
        if isinstance(value, ffi.CData) or kind.kind != "pointer":
            return value
        if kind.item.cname == "char":
            text = os.fsencode(value)
            if b"\0" in text:
                raise ArgumentError(f"{value!r} has a null character, where C would end it")
            made = ffi.new("char[]", text)
            self.alive.append(made)
            return made
        if kind.item.kind == "pointer":
            if isinstance(value, (str, bytes)):
                raise TypeError("a list is wanted")
            made = ffi.new(f"{kind.item.cname}[]", [self.to_c(v, kind.item) for v in value])
            self.alive.append(made)
            return made
        if kind.item.kind == "struct":
            return self.of_structs(value, kind)
        return self.array(value, kind.item)

    def of_structs(self, value, kind):
        """A pointer to a struct, or to an array of them."""
        if tag(kind.item) == "mps_view":
            return self.view(value)
        if isinstance(value, (Mapping, Result)):
            return self.struct(kind.item, vars(value) if isinstance(value, Result) else value)
        if isinstance(value, (list, tuple)) and not opaque(kind.item):
            return self.structs(kind.item, value)
        raise TypeError(f"{value!r} is no {class_name(tag(kind.item))}")

    def view(self, value):
        """An array as an mps_view."""
        held, made = numpy.ascontiguousarray(value, numpy.float64), ffi.new("mps_view *")
        rows = held.reshape(len(held), -1)
        made.data = ffi.cast("void *", held.ctypes.data)
        made.shape, made.stride = [*rows.shape, 1], [rows.shape[1], 1, 1]
        made.dtype.code, made.dtype.bits, made.dtype.lanes = 2, 64, 1
        self.alive += [held, made]
        return made

    def object(self, value, kind):
        """The pointer of an object of the library, which is kept alive."""
        if value._pointer is None:
            raise StateError("it is closed")
        wanted = class_name(tag(kind.item)) if is_object(kind) else "number or array"
        self.alive.append(value)
        if ffi.typeof(value._pointer) is kind or kind.cname == "void *":
            return value._pointer
        if wanted == "Solver" and value._kind in SOLVERS:  # the same object
            return ffi.cast(kind, value._pointer)
        raise TypeError(f"a {type(value).__name__} is no {wanted}")

    def structs(self, kind, rows):
        """An array of structs from a list of dictionaries."""
        made = ffi.new(f"{kind.cname}[]", len(rows))
        fields, known = dict(kind.fields), _tables.DEFINITIONS.get(tag(kind), {})
        for k, row in enumerate(rows):
            for name, field in kind.fields:  # a real number that is not given is unset
                if field.type.cname == "double" and name not in row:
                    setattr(made[k], name, float("nan"))
            for name, value in row.items():
                if name not in fields:
                    raise unknown(f"row {k} has no member", name, fields)
                self.assign(ffi.addressof(made[k]), name, fields[name].type, value, known.get(name) or _PLAIN)
        self.alive.append(made)
        return made


class _Fields:
    """Members of a struct that is being filled, as a mapping."""

    def __init__(self, made):
        self.made = made

    def __contains__(self, word):
        return hasattr(self.made, word)

    def __getitem__(self, word):
        return getattr(self.made, word)

    def get(self, word, other=None):
        return getattr(self.made, word, other)


# ---- the call -----------------------------------------------------------------------------------


def _set_defaults(made, kind):
    """The defaults of a struct that has some: not those of mps_goda_def for the result mps_goda."""
    number = getattr(library, "MPS_DEF_" + tag(kind).removeprefix("mps_").removesuffix("_def").upper(), None)
    if number is not None and tag(kind) in _tables.DEFINITIONS:
        status = library.mps_def_init(number, made, ffi.sizeof(kind))
        if status != 0:
            raise failed("def_init()", status)


def _output(kind):
    """What a trailing pointer points to."""
    made = ffi.new(f"{kind.item.cname}[1]")
    if is_struct(kind) and not opaque(kind.item):
        _set_defaults(made, kind.item)  # C reads some first, as mps_checkpoint
    return made


def bind(function, values, keywords):
    """(arguments by name, members of the definition) of a call."""
    bound, members = dict(zip(function.arguments, values)), {}
    for more in values[len(function.arguments):]:
        if not function.definition or not isinstance(more, (Mapping, Result)):
            function.refuse(f"has too many arguments, {more!r} is one")
        members.update(_as_keywords(more, function.definition))
    for word, value in keywords.items():
        if word in function.arguments:
            if word in bound:
                function.refuse(f"has two values for {word!r}")
            bound[word] = value
        elif function.definition:
            members[word] = value
        elif function.arguments:
            raise unknown(f"{function.place} has no keyword", word, function.arguments)
        else:
            function.refuse(f"takes no keyword, and was given {word}")
    for word, row in function.arguments.items():
        if word not in bound:
            if row[2] is ...:
                function.refuse(f"lacks {word!r}")
            bound[word] = row[2]
    return bound, members


def _as_keywords(given, struct):
    """A struct of the library, such as solver.get_boundary() gives, as keywords of its definition."""
    if isinstance(given, Mapping):
        return given
    known, found = _tables.DEFINITIONS[struct], dict(vars(given))
    fields = dict(ffi.typeof(struct).fields)
    for word in found:
        if word not in fields:
            raise unknown(f"{struct} has no member", word, known)
    if "box" in known and "lower" in found:
        corners = [found.pop("lower"), found.pop("upper")]
        if found.get("ids") is None and not found.get("all"):
            found["box"] = corners
    if found.get("ids") is not None and "all" in known:
        found["all"] = False  # they are listed now
    return {word: value for word, value in found.items() if word in known}


class Performance:
    """The arguments of one call in C's order; what C writes is made here, and returned."""

    def __init__(self, function, owner, context, bound, members):
        self.function, self.owner, self.context, self.bound, self.members = function, owner, context, bound, members
        self.state = Call(None if context is None else context._raised, owner)
        self.call, self.kinds, self.const = function.c()
        self.values, self.made = [], {}  # what C writes, by place
        self.waiting, self.counts = [], []  # (place, name, type) of arrays; (place, name) of numbers
        self.capacity = self.many = self.words = None

    def prepare(self):
        for kind, const, (role, word, more) in zip(self.kinds, self.const, self.function.parameters):
            self.values.append(getattr(self, "_" + role)(kind, const, word, more))
        self.words = Words(self.owner, self.state.lengths)
        self.count()
        self.state.compare(self.words, self.function.place)

    def _self(self, kind, _const, _word, _more):
        pointer = self.owner._pointer
        self.state.alive.append(self.owner)
        return pointer if ffi.typeof(pointer) is kind else ffi.cast(kind, pointer)  # a solver of any kind

    def _context(self, *_):
        return self.context._pointer

    def _null(self, *_):
        return ffi.NULL

    def _size(self, *_):
        last = self.made[len(self.values) - 1]
        return ffi.sizeof(last[0]) if isinstance(last, ffi.CData) else ffi.sizeof(last[1][0])

    def _capacity(self, *_):
        self.capacity, self.state.lengths["capacity"] = len(self.values), 0
        return 0

    def _count(self, _kind, _const, word, _more):
        self.counts.append((len(self.values), word))
        return 0

    def _def(self, kind, *_):
        place = self.function.place
        try:
            return self.state.struct(kind.item, self.members, f"{place} has no keyword")
        except (TypeError, ValueError) as error:
            raise (error if str(error).startswith(place) else type(error)(f"{place}: {error}")) from error.__cause__

    def _info(self, kind, *_):
        return self._def(kind) if self.members else ffi.NULL

    def _many(self, kind, *_):
        self.many = len(self.values)
        return ffi.new(f"{kind.item.cname}[1]")

    def _out(self, kind, *_):
        self.made[len(self.values)] = made = _output(kind)
        return made

    _borrow = _out

    def _fill(self, kind, _const, word, _more):
        self.waiting.append((len(self.values), word, kind))
        self.made[len(self.values)] = None
        return ffi.NULL

    def _arrays(self, kind, *_):
        self.made[len(self.values)] = ({}, _output(kind))
        return self.made[len(self.values)][1]

    def _change(self, kind, _const, word, _more):
        held = numpy.array(self.bound[word], _DTYPES[kind.item.cname])
        self.made[len(self.values)] = held
        self.state.measure(f"mps_{self.function.name}", word, kind, held, False)
        return ffi.cast(kind, held.ctypes.data)

    def _update(self, kind, _const, word, _more):
        return self._argument(kind, False, word, "")

    def _argument(self, kind, _const, word, _more):
        function, state = self.function, self.state
        name = word if word in function.arguments else word + "_"
        value, (_, _, _, unit, enum) = self.bound[name], function.arguments[name]
        try:
            if enum:
                value = _enums.number(enum, name, value)
            if kind.cname == "double" or (kind.kind == "pointer" and kind.item.cname == "double"):
                value = _quantities.number(value, unit, name)
            if value is None and kind.cname == "double" and function.arguments[name][1].endswith("None"):
                value = float("nan")
            made = state.to_c(value, kind, function.full, word)
            if kind.kind in ("primitive", "enum") and type(made) not in (int, float):
                ffi.new(f"{kind.cname} *", [] if made is None else made)  # None would be no initial value
        except (TypeError, ValueError, OverflowError) as error:
            if str(error).startswith(f"{name!r} is "):
                raise type(error)(f"{function.place}: {error}") from error
            raise type(error)(f"{function.place}: {name!r} is {reprlib.repr(value)}: {error}") from error
        state.measure(f"mps_{function.name}", word, kind, value)
        state.lengths[word] = value
        return made

    def count(self):
        """Numbers that arrays say, into their places."""
        words, open_ = self.words, list(self.counts)
        for place, word in open_ + open_:  # one may need another
            if word in self.state.lengths:
                continue
            for owner, array, size, _, _ in self.state._arrays:
                formula = self.function.formulas.get(array)
                if owner == f"mps_{self.function.name}" and formula and word in _shapes.counts(formula):
                    found = _shapes.solve(formula, word, size, words)
                    if found is not None:
                        self.state.lengths[word] = self.values[place] = found
                        break
        for place, word in open_:
            if word not in self.state.lengths:
                of = _shapes.WITHOUT.get((f"mps_{self.function.name}", word))
                self.state.lengths[word] = self.values[place] = getattr(self.owner, of) if of else 0

    def arrays(self):
        """Arrays that C fills, as long as it does; asks first how many there are, where it says so."""
        if self.capacity is not None:
            room = None
            if self.many is not None:
                status = self.call(*self.values)
                if status:
                    return status
                room = self.values[self.many][0]
            else:
                room = _shapes.length(_shapes.WITHOUT[f"mps_{self.function.name}", "capacity"], self.words)
            self.values[self.capacity] = self.state.lengths["capacity"] = room
        words = self.words
        for place, word, kind in self.waiting:
            array = numpy.zeros(_shapes.shape(self.function.formulas[word], words), _DTYPES[kind.item.cname])
            self.made[place], self.values[place] = array, ffi.cast(kind, array.ctypes.data)
        for place, made in self.made.items():
            if isinstance(made, tuple):
                self.inside(made, self.kinds[place].item)
        return 0

    def inside(self, made, kind):
        """Arrays of a struct of arrays."""
        arrays, struct = made
        formulas = _shapes.STRUCTS[tag(kind)]
        for name, field in kind.fields:
            if name in formulas:
                arrays[name] = array = numpy.zeros(_shapes.shape(formulas[name], self.words), _DTYPES[field.type.item.cname])
                setattr(struct[0], name, ffi.cast(field.type, array.ctypes.data))

    def perform(self):
        self.prepare()
        return self.arrays() or self.call(*self.values)

    def results(self):
        """What C has written, in its order."""
        found = []
        for place in sorted(self.made):
            made, role, word = self.made[place], *self.function.parameters[place][:2]
            if role == "borrow":
                count = _shapes.length(self.function.formulas[word], Words(self.owner, {"count": found[0], "offsets": found[-1]}))
                found.append(numbers(made[0], count))
            elif isinstance(made, tuple):
                found.append(results.get(tag(self.kinds[place].item), Result)(**made[0]))
            elif isinstance(made, ffi.CData):
                found.append(made[0])
            else:
                found.append(made)
        for place, (role, word, _) in enumerate(self.function.parameters):
            if role == "update" and isinstance(self.bound[word], Result):
                vars(self.bound[word]).update(vars(to_python(self.values[place])))
        return found


class Words:
    """What the names in a formula of _shapes stand for."""

    def __init__(self, owner, found):
        self.owner, self.numbers = owner, found

    def __getitem__(self, word):
        found = getattr(self, "_" + word, None)
        if found:
            return found()
        if word.startswith("MPS_"):
            return getattr(library, word)
        if word in self.numbers:
            return self.numbers[word]
        return self.owner._lengths[word]

    def _set(self):
        """The set of particles that the call is about."""
        given = self.numbers.get("particles")
        if getattr(given, "_kind", None) == "particles":
            return given._pointer
        owner = self.owner._alive[0] if self.owner._kind == "grid" else self.owner
        if owner._kind == "particles":
            return owner._pointer
        return getattr(library, f"mps_{owner._kind}_particles")(owner._pointer)

    def _dim(self):
        if self.owner._kind == "body":
            return library.mps_body_dim(self.owner._pointer)
        return library.mps_particles_dim(self._set())

    def _particles(self):
        return library.mps_particles_count(self._set())

    def _components(self):
        if "components" in self.numbers:  # where the call has a number of that name
            return self.numbers["components"]
        return lambda name: components(self.owner.context, self._set(), name)

    def _nodes(self):
        return lambda number: self.owner._lengths.get(number, 1)

    def _last(self):
        return lambda array: array[-1]


def components(context, pointer, name):
    """How many numbers a field of the set has for each particle; 0: there is none of that name."""
    seen, text = ffi.new("mps_view *"), os.fsencode(name)
    if library.mps_particles_view(pointer, text, seen):
        # One that the call would add: an empty set has its shape.
        made, definition = ffi.new("mps_particles *[1]"), ffi.new("mps_particles_def *")
        _set_defaults(definition, ffi.typeof("mps_particles_def"))
        definition.dim, definition.spacing = library.mps_particles_dim(pointer), 1.0
        if library.mps_particles_create(context._pointer, definition, made) == 0:
            if library.mps_particles_add_field(made[0], text, 0) == 0:
                library.mps_particles_view(made[0], text, seen)
            library.mps_particles_destroy(made)
    return seen.shape[1]


from . import _callbacks  # noqa: E402 (it uses ffi)
from ._errors import StateError  # noqa: E402
