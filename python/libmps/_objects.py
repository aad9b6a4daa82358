"""Objects of the library: how they are made, what they own, their methods and properties."""

import difflib
import inspect
import os
import sys
import warnings

import numpy

from . import _callbacks, _enums, _history, _quantities, _show, _tables
from ._arrays import Edit, lend
from ._call import (SOLVERS, Call, Performance, Result, bind, class_name, components, functions, results, same, to_python,
                    unknown)
from ._errors import ArgumentError, StateError, Warning, failed, spoken
from ._library import ffi, library, opaque, tag


class Object:
    """An object of the C library. Its methods and properties are the functions of its header; close(), the end of a
    `with` block, or the last reference destroys it."""

    _pointer = None
    _lengths = {}
    _kind = ""

    def __init__(self, *_values, **_keywords):
        makers = sorted(f.word for f in functions.values() if f.form == "class" and f.made == self._kind)
        raise TypeError(f"a {type(self).__name__} is made by {', '.join(makers) or 'a method of another object'}")

    def _hold(self, pointer, context=None, alive=(), owned=True):
        self._pointer = pointer
        self.context = context or self
        self._alive = list(alive)  # callbacks, and what the object was made from
        self._held = {}  # what C has been given since
        # Garbage is collected anywhere, inside cffi too: nothing may have to be looked up then.
        self._destroy = getattr(library, f"mps_{self._kind}_destroy") if owned else _leave
        self._holder = ffi.new(f"mps_{self._kind} *[1]", [pointer])
        return self

    def _create(self, function, values, keywords, context):
        """Makes the object of this Python object by a function mps_..._create."""
        bound, members = bind(function, values, keywords)
        context = _context_of(context, bound)
        made, outputs = _perform(function, None, context, bound, members)
        self._hold(outputs[0], context, _kept(made.state.alive))
        self._lengths = {word: value for word, value in made.state.lengths.items() if isinstance(value, (int, float))}
        self._created(bound)

    def _created(self, bound):
        """What a class of its own notes of the arguments that it was made from."""

    def close(self):
        """Destroys the object; without effect the second time."""
        if self._pointer is None:
            return
        self._pointer = None
        if self.context._running:  # by garbage collection in a callback
            self.context._late.append((self._destroy, self._holder, self._alive))
        else:
            self._destroy(self._holder)
        self._alive, self._held, self._records = [], {}, ()

    def __del__(self):
        if self._pointer is not None:
            self.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __reduce_ex__(self, _protocol):
        raise TypeError(f"a {type(self).__name__} is neither copied nor pickled: a checkpoint (save, restore) keeps the state of "
                        "a solver, and numpy.array(set[name]) a field")

    def __repr__(self):
        return _show.text(self)

    def _repr_html_(self):
        return _show.html(self)

    def _near(self, name):
        near = [f"{function.word}.{name}" for function in functions.values() if function.form == "property" and
                function.word != "definition" and function.owner == self._kind and name in _members(function.type)]
        near += difflib.get_close_matches(name, [n for n in dir(type(self)) if n[0] != "_"], 1)
        return f"{type(self).__name__} of libmps has no {name!r}{f' (is it {near[0]!r}?)' if near else ''}"

    def __getattr__(self, name):
        raise AttributeError(self._near(name))

    def __setattr__(self, name, value):
        if name[0] != "_" and name != "context" and not hasattr(type(self), name) and type(self).__module__ == "libmps":  # a slip
            raise AttributeError(self._near(name))
        object.__setattr__(self, name, value)

    def _open(self):
        """The pointer, of an object that is not closed."""
        if self._pointer is None:
            raise StateError(f"the {class_name(self._kind)} is closed")
        if self.context._pointer is None:
            raise StateError(f"the Context of the {class_name(self._kind)} is closed")
        return self._pointer

    def _invoke(self, function, values, keywords):
        self._open()
        if function.selects and ("box" in keywords or "all" in keywords):
            keywords = self._selected(function, values, dict(keywords))
        bound, members = bind(function, values, keywords)
        made, outputs = _perform(function, self, self.context, bound, members)
        if not function.status and function.parameters[-1][0] != "out":
            return self._known(outputs, function, made.state)
        found = [self._made(output, made.state) for output in outputs]
        self._remember(function, made.state, found)
        return None if not found else found[0] if len(found) == 1 else function.several(found)

    def _selected(self, function, values, keywords):
        """A selection of particles by a box, or of all, as their ids."""
        box, every = keywords.pop("box", None), keywords.pop("all", False)
        if (box is not None) + bool(every) + ("ids" in keywords or len(values) > list(function.arguments).index("ids")) != 1:
            raise ArgumentError(f"{function.place}: one of 'ids', 'box' and 'all' selects the particles")
        particles = self if self._kind == "particles" else self.particles
        if box is None:
            return {**keywords, "ids": numpy.array(particles["id"])}
        if len(box) != 2:
            raise ArgumentError(f"{function.place}: 'box' is {box!r}, must be two corners: (lower, upper)")
        lower, upper = ([side if x is None else x for x in (corner if corner is not None else [None] * particles.dim)]
                        for corner, side in zip(box, (-numpy.inf, numpy.inf)))
        return {**keywords, "ids": particles.select_box(lower, upper)}

    def _checked(self, said, function, *values):
        """Calls a function of the library that is in no table; `said` is what Python calls it."""
        with _Running(self.context):
            status = function(self._open(), *values)
        if status:
            raise failed(said, status, library.mps_context_error(self.context._pointer))

    def _keep(self, function, bound, alive):
        """What C has stored: callbacks and objects that Python must not drop. Another setting takes the place of the last."""
        kept = [held for held in _kept(alive) if held is not self and (_is_callback(held) or held._kind in ("signal", "material"))]
        if function.word.startswith("add_") or function.word == "set_material":  # of some particles: the others keep theirs
            held = self._held.setdefault(function.word, [])
            held += [new for new in kept if not any(new is old for old in held)]
        else:
            which = next((bound[word] for word in ("number", "component", "equation", "column") if word in bound), None)
            self._held[function.word, which] = kept

    def _stepped(self):
        """Fields of the solver's set that were taken before may have other values now: they are stale."""
        if self._pointer is not None:
            place = int(ffi.cast("intptr_t", getattr(library, f"mps_{self._kind}_particles")(self._pointer)))
            self.context._steps[place] = self.context._steps.get(place, 0) + 1

    def _remember(self, function, state, made):
        """Contacts belong to their solver, until close(); lengths that only a definition has."""
        for result in made:
            if not isinstance(result, Object):
                continue
            if result._kind == "contact":
                result._alive = [held for held in result._alive if held is not self]
                self._alive.append(result)
            result._lengths = {word: value for word, value in state.lengths.items()
                               if isinstance(value, (int, float))}
        if function.name in ("fluid_add_boundary", "fluid_set_boundary"):
            number = made[0] if made else state.lengths["number"]
            self._lengths = {**self._lengths, number: state.lengths["node_count"]}

    def _made(self, value, state):
        if isinstance(value, ffi.CData) and ffi.typeof(value).kind == "pointer" and value:
            return wrap(value, self.context, state.alive)
        return to_python(value)

    def _known(self, result, function, state=None):
        """What a question returns. An object that is lent is the one that made this, or a part of
        this, which it keeps alive."""
        if isinstance(result, ffi.CData) and ffi.typeof(result).kind == "pointer":
            for held in [self.context, *self._alive, *(state.alive if state else ())]:
                if isinstance(held, Object) and same(held._pointer, result):
                    return held
            kind = ffi.typeof(result).item
            if result and kind.kind == "struct" and opaque(kind):
                made = classes[tag(kind).removeprefix("mps_")]
                return made.__new__(made)._hold(result, self.context, [self], owned=False)
        return _enums.named(function.enum, result) if function.enum else to_python(result)


class _Running:
    """A call of the library is under way: what callbacks raise comes out, what is destroyed in it waits."""

    def __init__(self, context):
        self.context = context

    def __enter__(self):
        self.context._running += 1
        _callbacks.active.append(self.context)

    def __exit__(self, *_):
        context = self.context
        context._running -= 1
        _callbacks.active.remove(context)
        while not context._running and context._late:
            destroy, holder, _alive = context._late.pop()
            destroy(holder)
        if context._raised and not context._running:  # the first of them is the cause
            exception = context._raised[0]
            context._raised.clear()
            raise exception


def _perform(function, owner, context, bound, members):
    """(the call, its results); a failed one raises."""
    made = Performance(function, owner, context, bound, members)
    steps = owner is not None and _may_step(owner._kind, function)
    if context is None:
        result = made.perform()
    else:
        try:
            with _Running(context):
                result = made.perform()
        finally:
            if steps:
                owner._stepped()
            if owner is not None and function.keeps:
                owner._keep(function, bound, made.state.alive)
    if function.status and result != 0:
        raise failed(function.place, result, library.mps_context_error(context._pointer if context else ffi.NULL))
    return made, made.results() if function.status or made.made else result


#: Objects that change fields of a set of particles, and what they do without changing them.
_KEEP_FIELDS = ("add_", "remove_", "set_", "save", "snapshot", "grid", "dt", "find_limit", "get_")


def _may_step(kind, function):
    """Whether a function of a solver may change fields of its particles."""
    return (kind in SOLVERS and not function.c()[2][0] and
            not function.name.removeprefix(function.owner + "_").startswith(_KEEP_FIELDS))


def _warn(level, message):
    """The hook `log` where the program has none: a warning of Python, at the line outside of the package."""
    if level != library.MPS_CONTEXT_LOG_WARNING:
        return
    depth, frame = 1, sys._getframe()
    while frame.f_back and frame.f_globals.get("__package__") == __package__:
        depth, frame = depth + 1, frame.f_back
    warnings.warn(spoken(message), Warning, stacklevel=depth)


def _leave(_holder):
    """Destroys nothing: the object is its owner's."""


def _is_callback(held):
    return isinstance(held, ffi.CData) and ffi.typeof(held).kind == "function"


def _kept(alive):
    return [held for held in alive if isinstance(held, Object) or _is_callback(held)]


def _go_on():
    """The cancel hook where the program has none. Python looks for signals when a function of its own
    begins: so Ctrl-C ends a run within a step, by KeyboardInterrupt."""
    return 0


class Context(Object):
    """Threads, memory, hooks and the last error of what is made from it. Without a
    hook `cancel` Ctrl-C ends the call under way, as `cancel=lambda: 0` does; without a hook `log` warnings of the
    library are Python's (libmps.Warning, by the module `warnings`)."""

    _kind = "context"

    def __init__(self, **members):
        raised = []
        self._progress = members.get("progress")
        members = {**members, "cancel": members.get("cancel") or _go_on, "log": members.get("log") or _warn}
        state, made, text = Call(raised), ffi.new("mps_context *[1]"), ffi.new("char[512]")
        definition = state.struct(ffi.typeof("mps_context_def"), members, "Context() has no keyword")
        status = library.mps_context_create(definition, made, text, 512)
        if status != 0:
            raise failed("Context()", status, text=f"Context(): {ffi.string(text).decode().removeprefix('mps_context_create: ')}")
        self._running, self._late = 0, []  # calls under way; what is destroyed after them
        self._steps = {}  # calls that may have changed fields, by the address of the set
        self._raised = raised  # by callbacks in the call under way
        self._hold(made[0], None, state.alive)

    def set_cancel(self, cancel=None):
        """Another hook `cancel`: a function without arguments, true to end the call; None: Ctrl-C alone ends it."""
        self._invoke(functions["context_set_cancel"], (cancel or _go_on,), {})

    def set_log(self, log=None):
        """Another hook `log`: log(level, message); None: warnings become Python's (libmps.Warning)."""
        self._invoke(functions["context_set_log"], (log or _warn,), {})

    def set_progress(self, progress=None):
        """Another hook `progress`: progress(state), whose members are task, step, time, time_end, fraction; None: none."""
        self._progress = progress
        self._invoke(functions["context_set_progress"], (progress,), {})


_default = None


def default_context(**members):
    """The context of all that is made without `context=`; with keywords, those of Context, a new one takes its place.
    What was made before keeps its own."""
    global _default
    if members or _default is None or _default._pointer is None:
        _default = Context(**members)
    return _default


def _context_of(given, bound):
    """The context that is given; else that of the first object among the arguments; else the default."""
    if given is not None:
        if not isinstance(given, Context):
            raise TypeError(f"'context' is {given!r}, must be a Context")
        given._open()
        return given
    for value in bound.values():
        if isinstance(value, Object):
            if value._pointer is None:
                raise StateError(f"the {class_name(value._kind)} is closed")
            return value.context
    return default_context()


class Particles(Object):
    """A set of particles: p["velocity"] reads a field, p["velocity"] = values sets it, p["velocity", 0] is a component,
    p.edit("velocity") opens it for writing, "velocity" in p asks for it, del p["user.dose"] removes it. len(p) is the
    number of particles, and `for name in p` goes over the names of the fields."""

    _kind = "particles"

    def __len__(self):
        return library.mps_particles_count(self._open())

    def __getitem__(self, name):
        name, component = name if isinstance(name, tuple) else (name, None)
        seen = ffi.new("mps_view *")
        self._checked("Particles[]", library.mps_particles_view, _text(name), seen)
        field = lend(self, seen[0], False)
        return field if component is None else field[:, component] if field.ndim > 1 else field[:].reshape(-1, 1)[:, component]

    def __setitem__(self, name, values):
        name, component = name if isinstance(name, tuple) else (name, -1)
        text, count = _text(name), len(self)
        if isinstance(values, (str, list, tuple)):
            values = self._numbers(name, values)
        width = components(self.context, self._pointer, name) or 1  # 0: C says that there is none
        shape = (count,) if component >= 0 or width == 1 else (count, width)
        try:
            held = numpy.ascontiguousarray(numpy.broadcast_to(numpy.asarray(values, numpy.float64), shape))
        except ValueError as error:
            raise ArgumentError(f"the values of {name!r} have the shape {numpy.shape(values)}, must have {shape}, or one that "
                                "broadcasts to it") from error
        self._checked("Particles[]", library.mps_particles_set_array, text, component, ffi.cast("double *", held.ctypes.data), count)

    def _numbers(self, name, values):
        """Texts with units as numbers."""
        if isinstance(values, str) or any(isinstance(v, str) for v in values):
            if name not in self:
                self.add_field(name)
            unit = self.fields[name].unit
            values = _quantities.number(values, "" if unit in ("", "-", "1") else unit, name)
        return values

    def __delitem__(self, name):
        self._checked("Particles[]", library.mps_particles_remove_field, _text(name))

    def __contains__(self, name):
        return library.mps_particles_has_field(self._open(), _text(name)) == 1

    def __iter__(self):
        return iter([name for name, _, _ in _show.fields(self)])

    def _ipython_key_completions_(self):
        return list(self)

    @property
    def fields(self):
        """The fields by name: their unit, meaning, components, whether they have whole numbers, or are only read."""
        self._open()
        count = library.mps_particles_field_count(self._pointer)
        return {info.name: info for info in (FieldInfo(k, self) for k in range(count))}

    def edit(self, name):
        """Opens a field for writing: `with p.edit("velocity") as v: v[:, 0] = 1.0` commits at the end of the
        block. FieldError: no such field, or one that only the library writes; StateError: it is open
        already, or a callback of a solver is running."""
        return Edit(self, name)

    def _columns(self, names):
        """(name, labels of the components, a copy) of the fields named, or of all."""
        for name in names or self:
            values = numpy.array(self[name])
            many = 1 if values.ndim == 1 else values.shape[1]
            labels = {1: [""], self.dim: list("xyz")[:self.dim]}.get(many) or (
                ["xx", "yy", "zz", "xy", "zx", "yz"][:many] if name == "stress" else [str(k) for k in range(many)])
            yield name, labels, values

    def to_pandas(self, *names):
        """The fields of these names, or all, as a pandas.DataFrame: a row for each particle by its id, a column for each
        component (velocity_x). A copy."""
        pandas = _history.wanted("pandas", "to_pandas")
        columns = {}
        for name, labels, values in self._columns([n for n in names if n != "id"] or [n for n in self if n != "id"]):
            for k, label in enumerate(labels):
                columns[f"{name}_{label}" if label else name] = values if values.ndim == 1 else values[:, k]
        return pandas.DataFrame(columns, index=pandas.Index(numpy.array(self["id"]), name="id"))

    def to_xarray(self, *names):
        """The fields of these names, or all, as an xarray.Dataset over particles, with units and meanings. A copy."""
        xarray = _history.wanted("xarray", "to_xarray")
        found, known = {}, self.fields
        for name, labels, values in self._columns([n for n in names if n != "id"] or [n for n in self if n != "id"]):
            attributes = {"units": known[name].unit, "long_name": known[name].meaning}
            if values.ndim == 1:
                found[name] = ("particle", values, attributes)
            else:
                axis = "axis" if labels == list("xyz")[:self.dim] else f"{name}_component"
                found[name] = (("particle", axis), values, attributes)
        made = xarray.Dataset(found, coords={"id": ("particle", numpy.array(self["id"]))}, attrs={"spacing": self.spacing})
        return made.assign_coords(axis=list("xyz")[:self.dim]) if "axis" in made.dims else made


class FieldInfo(Result):
    """What a field of particles is: name, unit, meaning, components, integer, readonly."""

    def __init__(self, index, particles):
        info = ffi.new("mps_particles_field_info *")
        particles._checked("Particles.fields", library.mps_particles_get_field_info_sized, index, info, ffi.sizeof(info[0]))
        said = {word: ffi.string(text).decode() if text else "" for word, text in
                (("name", info.name), ("unit", info.unit), ("meaning", info.meaning))}
        super().__init__(**said, components=info.components, integer=info.dtype.code != 2,
                         readonly=bool(info.flags & library.MPS_VIEW_READONLY))


def _text(name):
    text = os.fsencode(name)
    if b"\0" in text:
        raise ArgumentError(f"{name!r} has a null character, where C would end it")
    return text


# ---- the progress of a run --------------------------------------------------------------------------


class _Progress:
    """The hook `progress` of run(progress=True): tqdm's bar where that is installed, else a line."""

    def __init__(self):
        self.bar, self.begun = None, False
        try:
            from tqdm.auto import tqdm
        except ImportError:
            return
        self.bar = tqdm(total=100, unit="%", bar_format="{l_bar}{bar}| {elapsed}<{remaining}{postfix}")

    def __call__(self, state):
        if self.bar is not None:
            self.bar.set_postfix_str(f"t = {state.time:.4g} s", refresh=False)
            self.bar.update(round(100 * state.fraction) - self.bar.n)
            return
        self.begun = True
        line = f"{state.task}: {100 * state.fraction:3.0f} %, t = {state.time:.4g} s"
        print(f"\r{line:<48}", end="", file=sys.stderr, flush=True)

    def end(self):
        if self.bar is not None:
            self.bar.close()
        elif self.begun:
            print(file=sys.stderr)


def _run(solver, function, values, keywords):
    """A run with the histories that it adds to, if any."""
    if solver._records:
        return solver._recorded(solver._invoke, function, values, keywords)
    return solver._invoke(function, values, keywords)


def _run_with_progress(solver, function, values, keywords):
    shown, before = _Progress(), solver.context._progress
    solver.context.set_progress(shown)
    try:
        return _run(solver, function, values, keywords)
    finally:
        solver.context.set_progress(before)
        shown.end()


# ---- the functions of the headers as methods -------------------------------------------------------


class _Shown:
    """Stands in a signature, where it is shown as its text."""

    def __init__(self, text):
        self.text = text

    def __repr__(self):
        return self.text


def described(made, function, first=""):
    """Gives a function of the package docstring and signature of its row."""
    parameters = [inspect.Parameter(first, inspect.Parameter.POSITIONAL_OR_KEYWORD)] if first else []
    for word, kind, default, _, _ in function.arguments.values():
        parameters.append(inspect.Parameter(word, inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=_Shown(kind),
                                            default=inspect.Parameter.empty if default is ... else default))
    if function.definition:
        parameters += [inspect.Parameter(word, inspect.Parameter.KEYWORD_ONLY, annotation=_Shown(row[0]), default=row[1])
                       for word, row in _tables.DEFINITIONS[function.definition].items()]
    if function.selects:
        parameters += [inspect.Parameter("box", inspect.Parameter.KEYWORD_ONLY, annotation=_Shown("Sequence[Any] | None"), default=None),
                       inspect.Parameter("all", inspect.Parameter.KEYWORD_ONLY, annotation=_Shown("bool"), default=False)]
    if function.word == "run":
        parameters.append(inspect.Parameter("progress", inspect.Parameter.KEYWORD_ONLY, annotation=_Shown("bool"), default=False))
    if function.takes_context:
        parameters.append(inspect.Parameter("context", inspect.Parameter.KEYWORD_ONLY, annotation=_Shown("Context | None"), default=None))
    made.__doc__ = function.doc
    made.__signature__ = inspect.Signature(parameters, return_annotation=_Shown(function.type))
    return made


def _method(function, owner):
    if function.word == "run":
        def method(self, *values, progress=False, **keywords):
            if progress:
                return _run_with_progress(self, function, values, keywords)
            return _run(self, function, values, keywords)
    elif function.owner in SOLVERS and function.word == "step":
        def method(self, *values, **keywords):
            self._invoke(function, values, keywords)
            self._look()
    else:
        def method(self, *values, **keywords):
            return self._invoke(function, values, keywords)

    method.__name__, method.__qualname__, method.__module__ = function.word, f"{owner}.{function.word}", "libmps"
    return described(method, function, "self")


def _members(name):
    """The members of the class `name` of results; none of what is no such class."""
    return [member for kind, made in results.items() if made.__name__ == name for member, _ in ffi.typeof(kind).fields]


def _property(function, setter):
    """A question without arguments; set_... of one argument sets it."""
    direct = not function.status and function.parameters[-1][0] == "self"

    def get(self):
        if not direct:
            return self._invoke(function, (), {})
        call, kinds, _ = function.c()
        pointer = self._open()
        return self._known(call(pointer if ffi.typeof(pointer) is kinds[0] else ffi.cast(kinds[0], pointer)), function)

    def put(self, value):
        self._invoke(setter, (value,), {})

    get.__module__ = "libmps"
    return property(get, put if setter else None, None, function.doc + (f"\n\nSetting it: {setter.doc}" if setter else ""))


def _maker(function, name):
    def __init__(self, *values, context=None, **keywords):
        self._create(function, values, keywords, context)

    __init__.__qualname__, __init__.__module__ = f"{name}.__init__", "libmps"
    return described(__init__, function, "self")


#: What classes have besides the functions of their headers.
_MORE = {"solver": (_history.Recording,), "history": (_history.HistoryRows,)}


def _classes():
    """A class for each kind of object, with its methods and properties; classes of the ways to make one."""
    made, ways = {"context": Context, "particles": Particles}, {}
    for kind in sorted(_tables.KINDS, key=lambda kind: kind != "solver"):  # the others are solvers
        name = class_name(kind)
        parents = (made["solver"],) if kind in SOLVERS and kind != "solver" else (*_MORE.get(kind, ()), Object)
        made.setdefault(kind, type(name, parents, {"__module__": "libmps", "__doc__": Object.__doc__, "_kind": kind}))
    for function in functions.values():
        if function.form == "method" and function.word not in made[function.owner].__dict__:
            setattr(made[function.owner], function.word, _method(function, class_name(function.owner)))
        elif function.form == "property":
            setter = functions.get(f"{function.owner}_set_{function.word}")
            setter = setter if setter is not None and setter.form == "setter" else None
            setattr(made[function.owner], function.word, _property(function, setter))
        elif function.form == "class":
            kind = made[function.made]
            if function.word != kind.__name__:
                kind = ways[function.word] = type(function.word, (kind,), {"__module__": "libmps", "__doc__": function.doc})
            elif kind.__doc__ == Object.__doc__:
                kind.__doc__ = function.doc
            kind.__init__ = _maker(function, function.word)
            kind.__signature__ = _without_self(kind.__init__)
    return made, ways


def _without_self(function):
    found = function.__signature__
    return found.replace(parameters=list(found.parameters.values())[1:], return_annotation=inspect.Signature.empty)


classes, ways = _classes()
for _made in (Object, Context, Particles, FieldInfo):
    _made.__module__ = "libmps"


def wrap(pointer, context, alive):
    """The Python object of what a function has made."""
    made = classes[tag(ffi.typeof(pointer).item).removeprefix("mps_")]
    return made.__new__(made)._hold(pointer, context, _kept(alive))


def free(function):
    """A function of the module."""
    def called(*values, context=None, **keywords):
        if context is not None and not function.takes_context:
            raise unknown(f"{function.place} has no keyword", "context", function.arguments)
        bound, members = bind(function, values, keywords)
        context = _context_of(context, bound) if function.takes_context else None
        made, outputs = _perform(function, None, context, bound, members)
        if not function.status:
            return to_python(outputs)
        found = [wrap(o, context, made.state.alive) if isinstance(o, ffi.CData) and ffi.typeof(o).kind == "pointer" else to_python(o)
                 for o in outputs]
        return None if not found else found[0] if len(found) == 1 else function.several(found)

    called.__name__ = called.__qualname__ = function.word
    called.__module__ = "libmps"
    return described(called, function)
