"""Python functions as C callbacks: what C passes by pointer and length are arrays, what C wants written is returned."""

import inspect
import reprlib

import numpy

from . import _cdef, _enums, _shapes
from ._library import ffi, library, tag

_DTYPES = {"double": numpy.float64, "int64_t": numpy.int64, "int32_t": numpy.int32}
#: Contexts with a call under way, the last one begun at the end.
active = []
_STATUSES = frozenset(ffi.typeof("mps_status").elements)


def array(pointer, count):
    """The numbers behind a pointer that C gave, read only: for the duration of the callback. None of NULL."""
    if not pointer:
        return None
    dtype = numpy.dtype(_DTYPES[ffi.typeof(pointer).item.cname])
    made = numpy.frombuffer(ffi.buffer(pointer, dtype.itemsize * count), dtype)
    made.flags.writeable = False
    return made


def received(pointer):
    """A struct that C passes for the duration of the callback, as a dictionary of numbers and arrays."""
    kind = ffi.typeof(pointer).item
    numbers = {name: getattr(pointer, name) for name, field in kind.fields if field.type.kind == "primitive"}
    numbers["entries"] = int(pointer.start[pointer.rows]) if pointer.start else 0
    arrays = {name: array(getattr(pointer, name), _shapes.length(formula, numbers))
              for name, formula in _shapes.RECEIVED[tag(kind)].items()}
    if "change" in numbers:
        numbers["change"] = _enums.named("LinearChange", numbers["change"])
    return {**numbers, **arrays}


class Callback:
    """One Python function as the C callback `word` of the call `state` (of a parameter or member of `owner`)."""

    def __init__(self, state, kind, function, owner, word):
        self.state, self.kind, self.function, self.word = state, kind, function, word
        self.named = named = _cdef.PLACES.get((owner, word))
        names = _cdef.CALLBACKS.get(named, ("user",))
        if names[0] != "user":
            raise TypeError(f"{word!r} must be a compiled function: numba.cfunc, or a pointer of cffi")
        self.names = names[1:] if named else None
        self.reads, self.returns = _shapes.CALLBACKS.get(named, ({}, {}))
        self.passes = None
        if self.names:
            self.passes = _shapes.passed(named, self.names)
            self.check_arity()

    def check_arity(self):
        """Refuses at once a function that does not take what it will be called with."""
        try:
            takes = inspect.signature(self.function)
        except (TypeError, ValueError):  # built in: it says so when it is called
            return
        try:
            takes.bind(*self.passes)
        except TypeError as error:
            raise TypeError(f"it is called as {self.form()}: {error}") from None

    def form(self):
        """How it is called, for errors."""
        return f"{self.word}({', '.join(self.passes)}){_shapes.answer(self.named)}"

    def __call__(self, *values):
        """The arguments of C without `user`; returns what C gets."""
        if self.passes is None or not (self.reads or self.returns):
            made = [self.state.wrap(value) for value in values[:len(self.passes or values)]]
            answer = self.function(*made)
            for held in made:
                if hasattr(type(held), "_pointer"):  # a solver, which steps on: fields taken here are stale then
                    held._stepped()
            return None if self.kind.result.kind == "void" else self.status(answer)
        given = dict(zip(self.names, values))
        words = self.words(given)
        arguments = [self.argument(given[name], name, words) for name in self.passes]
        answer = self.function(*arguments)
        if not self.returns:
            return self.status(answer)
        self.write(answer, given, words)
        return 0

    def words(self, given):
        """What the names in a formula stand for; the rows of a matrix are kept for the solutions that follow."""
        numbers = {name: value for name, value in given.items() if isinstance(value, int)}
        if "matrix" in given:
            self.state.lengths["equation"] = given["matrix"].rows
        return self.state.words(numbers)

    def argument(self, value, name, words):
        if name == "matrix":
            return received(value)
        return array(value, _shapes.length(self.reads[name], words)) if name in self.reads else self.state.wrap(value)

    def write(self, answer, given, words):
        """What the function has returned, to where C wants it."""
        name, formula = next(iter(self.returns.items()))
        if "result" in given and isinstance(answer, tuple) and len(answer) == 2:
            answer, given["result"].iterations = answer
        pointer, count = given[name], _shapes.length(formula, words)
        integer = ffi.typeof(pointer).item.cname != "double"
        if integer and not isinstance(answer, (bool, numpy.bool_)):
            raise TypeError(f"{self.form()} returned {answer!r}: must return True or False")
        try:
            numbers = numpy.asarray(answer, numpy.float64)
        except (TypeError, ValueError):
            numbers = None
        if answer is None or numbers is None or numbers.shape not in ({(count,), ()} if count == 1 else {(count,)}):
            raise TypeError(f"{self.form()} returned {answer!r}: must return "
                            f"{'a number' if count == 1 else f'{count} numbers'}")
        for k, number in enumerate(numbers.ravel()):
            pointer[k] = int(number) if integer else number

    def status(self, answer):
        """The status for C: of None, success."""
        if self.kind.result.kind != "enum":  # the hook `cancel`
            return 0 if answer is None else int(bool(answer))
        if answer is None:
            return 0
        if isinstance(answer, (bool, numpy.bool_)) or answer not in _STATUSES:
            raise TypeError(f"{self.word!r} returned {answer!r}: must return None, or a Status (Status.CANCELLED ends the call); "
                            "an exception ends the call, too")
        return int(answer)


class Law(Callback):
    """The callbacks of a law, which receive a block of particles; `moduli` returns one number a particle."""

    def __call__(self, *values):
        from . import _block

        block = _block.Block(values[0])
        try:
            answer = self.function(block)
            if len(values) > 1:
                self.moduli(values[1], answer, block.count)
                return None
            block._write()
        finally:
            block._end()
        return self.status(answer)

    @staticmethod
    def moduli(pointer, answer, count):
        """One number a particle, to where C wants them."""
        try:
            numbers = None if answer is None else numpy.broadcast_to(numpy.asarray(answer, numpy.float64), (count,))
        except (TypeError, ValueError):
            numbers = None
        if numbers is None:
            raise TypeError(f"'moduli' of a law returned {reprlib.repr(answer)}: must return K + 4G/3 of each of the {count} particles of "
                            "the block, or one number for all")
        numpy.frombuffer(ffi.buffer(pointer, 8 * count))[:] = numbers


def make(state, kind, function, owner, word):
    """The C function that calls a Python function; what that raises goes into state.raised."""
    laws = any(argument.cname == "struct mps_material_block *" for argument in kind.args)
    calls = (Law if laws else Callback)(state, kind, function, owner, word)
    stops = kind.cname == "int32_t(*)(void *)"  # the hook `cancel`

    def called(_user, *values):
        # The same error for all: the first exception is the one that is raised.
        if stops and state.raised:  # by a hook whose answer C does not look at: log, progress
            return 1
        return calls(*values)

    def failed(_type, exception, trace):
        # A law or a signal of another context is asked by a solver: what it raises comes out of the solver's call.
        raised = state.raised
        if active and not any(context._raised is raised for context in active):
            raised = active[-1]._raised
        raised.append(exception.with_traceback(trace))  # the user's own lines are in it

    error = None if kind.result.kind == "void" else library.MPS_ERROR_CANCELLED if kind.result.kind == "enum" else 1
    return ffi.callback(kind, called, error=error, onerror=failed)
