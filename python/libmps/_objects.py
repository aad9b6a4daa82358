"""Objects of the library: what they own and their methods."""

import inspect
import sys
import warnings

import numpy

from . import _cdef, _docs, _show
from ._arrays import Edit, lend
from ._call import (Call, Error, MpsWarning, call, class_name, ffi, functions, library, returns_status, same,
                    to_python)


class Object:
    """An object of the C library. Its methods are the functions of its header; close(), the end of a `with`
    block, or the last reference destroys it."""

    pointer = None
    lengths = {}

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
            self._steps = {}  # calls that may have changed fields, by the address of the set
            self._raised = []  # by callbacks in the call under way

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

    def __reduce_ex__(self, _protocol):
        raise TypeError(f"a {class_name(self.kind)} is neither copied nor pickled: a checkpoint (save, restore) keeps the state of "
                        "a solver, and numpy.array(set[name]) a field")

    def __repr__(self):
        return _show.text(self)

    def _repr_html_(self):
        return _show.html(self)

    def __getattr__(self, name):
        raise AttributeError(f"{self.kind if 'kind' in self.__dict__ else 'object'} of libmps has no {name!r}")

    def _invoke(self, name, values, members):
        if self.pointer is None:
            raise ValueError(f"the {self.kind} is closed")
        context = self.context
        if context.pointer is None:
            raise ValueError(f"the context of the {self.kind} is closed")
        context._running += 1
        try:
            result, outputs, state = call(name, self, values, members)
        finally:
            context._running -= 1
            if _may_step(self.kind, name):
                self._stepped()
            while not context._running and context._late:
                destroy, holder, _alive = context._late.pop()
                destroy(holder)
        if name.startswith("context_set_"):  # a hook stays: before anything may raise
            self._alive += [held for held in state.alive if _is_callback(held)]
        if context._raised and not context._running:  # the first of them is the cause
            exception = context._raised[0]
            context._raised.clear()
            raise exception
        if not returns_status(name):
            return self._known(result, state)
        if result != 0:
            raise Error("mps_" + name, result, library.mps_context_error(context.pointer))
        made = [output if isinstance(output, numpy.ndarray) else self._made(output[0], state)
                for output in outputs]
        self._remember(name, state, made)
        return None if not made else made[0] if len(made) == 1 else tuple(made)

    def _stepped(self):
        """Fields of the solver's set that were taken before may have other values now: they are stale."""
        if self.pointer is not None:
            place = int(ffi.cast("intptr_t", getattr(library, f"mps_{self.kind}_particles")(self.pointer)))
            self.context._steps[place] = self.context._steps.get(place, 0) + 1

    def _remember(self, name, state, made):
        """Contacts belong to their solver, until close(); lengths that only a definition has."""
        for result in made:
            if not isinstance(result, Object):
                continue
            if result.kind == "contact":
                result._alive = [held for held in result._alive if held is not self]
                self._alive.append(result)
            result.lengths = {word: value for word, value in state.lengths.items()
                              if isinstance(value, (int, float))}
        if name in ("fluid_add_boundary", "fluid_set_boundary"):
            number = made[0] if made else state.lengths["number"]
            self.lengths[number] = state.lengths["node_count"]

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
                return classes[kind.cname.removeprefix("mps_")](result, self.context, [self], owned=False)
        return to_python(result)


#: Objects that change fields of a set of particles, and what they do without changing them.
_SOLVERS = ("mpm", "dynamics", "elastic", "fluid", "solver")
_KEEP_FIELDS = ("add_", "remove_", "set_", "save", "snapshot", "grid", "dt", "find_limit")


def _may_step(kind, name):
    """Whether mps_`name` of a solver may change fields of its particles."""
    if kind not in _SOLVERS or name.removeprefix(kind + "_").startswith(_KEEP_FIELDS):
        return False
    full = f"mps_{name}_sized" if f"mps_{name}_sized" in _cdef.PARAMETERS else f"mps_{name}"
    return not _cdef.PARAMETERS[full][0].startswith("const ")


def _warn(level, message):
    """The hook `log` where the program has none: a warning of Python, at the line outside of the package."""
    if level != library.MPS_CONTEXT_LOG_WARNING:
        return
    depth, frame = 1, sys._getframe()
    while frame.f_back and frame.f_globals.get("__package__") == __package__:
        depth, frame = depth + 1, frame.f_back
    warnings.warn(message, MpsWarning, stacklevel=depth)


def _leave(_holder):
    """Destroys nothing: the object is its owner's."""


def _is_callback(held):
    return isinstance(held, ffi.CData) and ffi.typeof(held).kind == "function"


def _go_on():
    """The cancel hook where the program has none. Python looks for signals when a function of its own
    begins: so Ctrl-C ends a run within a step, by KeyboardInterrupt."""
    return 0


class Context(Object):
    """mps_context: the members of mps_context_def by keyword (threads, executor, log ...). Without a
    hook `cancel` Ctrl-C ends the call under way, as `cancel=lambda: 0` does; without a hook `log` warnings of the
    library are Python's (MpsWarning, by the module `warnings`)."""

    def __init__(self, **members):
        raised = []
        members = {**members, "cancel": members.get("cancel") or _go_on, "log": members.get("log") or _warn}
        state, made, text = Call(raised), ffi.new("mps_context *[1]"), ffi.new("char[512]")
        definition = state.struct(ffi.typeof("mps_context_def"), members, "Context() has no keyword")
        status = library.mps_context_create(definition, made, text, 512)
        if status != 0:
            error = Error("mps_context_create", status)
            error.args = (ffi.string(text).decode(),)
            raise error
        super().__init__(made[0], None, state.alive)
        self._raised = raised

    def set_cancel(self, cancel):
        """mps_context_set_cancel; None: Ctrl-C alone ends a call."""
        self._invoke("context_set_cancel", (cancel or _go_on,), {})

    def set_log(self, log):
        """mps_context_set_log: log(level, message); None: warnings become Python's (MpsWarning)."""
        self._invoke("context_set_log", (log or _warn,), {})


class Particles(Object):
    """mps_particles: set["velocity"] reads a field, set.edit("velocity") writes it, set["velocity"] = values sets all of it,
    "velocity" in set asks for it, del set["user.dose"] removes it."""

    def __len__(self):
        return self.count()

    def __getitem__(self, name):
        view = ffi.new("mps_view *")
        self._invoke("particles_view", (name, view), {})
        return lend(self, view[0], False)

    def __setitem__(self, name, values):
        """mps_particles_set_array of all components, from (particles, components) values, of one component (particles,)."""
        self.set_array(name, -1, values, len(values))

    def __delitem__(self, name):
        self.remove_field(name)

    def __contains__(self, name):
        return self.has_field(name) == 1

    def __iter__(self):
        raise TypeError("a set of particles is not iterated: set['position'] has a row for each of them")

    def edit(self, name):
        """Opens a field for writing: `with set.edit("velocity") as v: v[:, 0] = 1.0` commits at the end of the
        block. Error with ERROR_FIELD: no such field, or one that only the library writes; ERROR_STATE: it is open
        already, or a callback of a solver is running."""
        return Edit(self, name)


# ---- the functions of the headers as methods -------------------------------------------------------


def takes(kind, name):
    """Whether mps_`name` is a function of an object of that kind."""
    full = f"mps_{name}_sized" if f"mps_{name}_sized" in _cdef.PARAMETERS else f"mps_{name}"
    args = ffi.typeof(getattr(library, full)).args
    return bool(args) and args[0].cname == f"mps_{kind} *"


class _Shown:
    """Stands in a signature, where it is shown as its text."""

    def __init__(self, text):
        self.text = text

    def __repr__(self):
        return self.text


_DEFAULT = _Shown("...")  # the member's, as the docstring says


def _word(name):
    return name + "_" if name in ("from", "lambda", "in", "is") else name


def described(function, name, itself=True):
    """Gives a function of the package name, docstring and signature of mps_`name`."""
    text, arguments, optional, keywords, result = _docs.FUNCTIONS[name]
    parameters = [inspect.Parameter("self", inspect.Parameter.POSITIONAL_ONLY)] if itself else []
    for k, (word, kind) in enumerate(arguments):
        default = None if k >= len(arguments) - optional else inspect.Parameter.empty
        parameters.append(inspect.Parameter(_word(word), inspect.Parameter.POSITIONAL_ONLY, annotation=_Shown(kind),
                                            default=default))
    parameters += [inspect.Parameter(_word(word), inspect.Parameter.KEYWORD_ONLY, annotation=_Shown(kind), default=_DEFAULT)
                   for word, kind in keywords]
    function.__doc__ = text
    function.__signature__ = inspect.Signature(parameters, return_annotation=_Shown(result))
    return function


def _method(name, word, owner):
    def method(self, *values, **members):
        return self._invoke(name, values, members)

    method.__name__, method.__qualname__, method.__module__ = word, f"{owner}.{word}", "libmps"
    return described(method, name)


def _classes():
    """A class for each kind of object; functions that C's header has of that object are its methods."""
    made = {"context": Context, "particles": Particles}
    kinds = {name[4:-8] for name in _cdef.PARAMETERS if name.endswith("_destroy")} | {"grid"}
    for kind in sorted(kinds):
        name = class_name(kind)
        own = made.setdefault(kind, type(name, (Object,), {"__module__": "libmps", "__doc__": Object.__doc__}))
        for function in functions:
            word = function.removeprefix(kind + "_")
            hidden = ("context", "kind", *(("view", "commit", "abandon") if kind == "particles" else ()))
            if takes(kind, function) and word not in hidden and word not in own.__dict__:
                setattr(own, word, _method(function, word, name))
    return made


classes = _classes()


def wrap(pointer, context, alive):
    """The Python object of what a function has made."""
    kept = [held for held in alive if isinstance(held, Object) or _is_callback(held)]
    return classes[ffi.typeof(pointer).item.cname.removeprefix("mps_")](pointer, context, kept)
