"""Histories of a solver: rows that solver.record() adds as it runs, and how a History gives them as arrays. The rows
themselves are the library's (mps/history.h): part of the solver's state, saved and rolled back with it."""

import inspect
import math
import numbers
import operator
import re
from types import SimpleNamespace

import numpy

from ._errors import ArgumentError, StaleError
from ._library import ffi, library
from ._quantities import number


def wanted(module, method):
    """A package that libmps does not need."""
    try:
        return __import__(module)
    except ImportError as error:
        raise ImportError(f"{method}() needs {module}, which is not installed: pip install {module}") from error


class Rows:
    """Named columns over rows, as arrays: what History and files.Table share. `columns` are the names, `units` theirs by name,
    and _column(name) is the array of one."""

    def __getitem__(self, name):
        """The column `name`, or (rows, components) of all columns name_x, name_y ... or name_0, name_1 ..."""
        if name in self.columns:
            return self._column(name)
        parts = [column for column in self.columns if re.fullmatch(re.escape(name) + r"_([xyz]|\d+)", column)]
        if not parts:
            raise KeyError(f"there is no column {name!r}: {', '.join(self.columns)}")
        return numpy.stack([self._column(part) for part in parts], axis=1)

    def __contains__(self, name):
        return name in self.columns

    def __iter__(self):
        return iter(self.columns)

    @property
    def values(self):
        """All columns: an array (rows, columns)."""
        return numpy.stack([self._column(name) for name in self.columns], axis=1)

    def to_pandas(self):
        """A pandas.DataFrame whose index is the first column, mostly t (s); attrs["units"] has the units. A copy."""
        pandas = wanted("pandas", "to_pandas")
        first, *others = self.columns
        made = pandas.DataFrame({name: self._column(name) for name in others}, index=pandas.Index(self._column(first), name=first))
        made.attrs["units"] = dict(self.units)
        return made

    def to_xarray(self):
        """An xarray.Dataset over the first column, mostly t (s), with units as attributes. A copy."""
        xarray = wanted("xarray", "to_xarray")
        first, *others = self.columns
        made = xarray.Dataset({name: (first, self._column(name), {"units": self.units.get(name, "")}) for name in others},
                              coords={first: (first, self._column(first), {"units": self.units.get(first, "")})})
        return made


class HistoryRows(Rows):
    """What a History of Python has besides the functions of its header: h["force"] is an array, len(h) the number of rows."""

    def _created(self, bound):
        self._names = ("t", *bound["columns"])
        self._units = ("s", *(bound["units"] or [""] * len(bound["columns"])))

    def __len__(self):
        return self.count

    def __bool__(self):
        return True

    @property
    def columns(self):
        """Names of the columns: t, then those of the history."""
        return self._names

    @property
    def units(self):
        """Units of the columns by name."""
        return dict(zip(self._names, (unit or "" for unit in self._units)))

    @property
    def t(self):
        """Times (s) of the rows."""
        return self._column("t")

    def _column(self, name):
        return self.view(name)  # a copy

    _ipython_key_completions_ = Rows.__iter__


def _named(name, value):
    """(columns, numbers) of what a source gives: a number, an array, or a struct of results or a dictionary of them."""
    if isinstance(value, (SimpleNamespace, dict)):
        items = vars(value) if isinstance(value, SimpleNamespace) else value
        parts = [_named(f"{name}_{word}", item) for word, item in items.items()
                 if isinstance(item, (numbers.Number, numpy.ndarray)) and word != "struct_size" and not word.startswith("reserved")]
        return sum((part[0] for part in parts), []), numpy.concatenate([part[1] for part in parts]) if parts else numpy.zeros(0)
    found = numpy.asarray(value, float)
    if found.ndim == 0:
        return [name], found.reshape(1)
    labels = "xyz" if found.shape in ((2,), (3,)) else [str(k) for k in range(found.size)]
    return [f"{name}_{label}" for label in labels[:found.size]], found.ravel()


def _at_particle(particles, field, at):
    """A function that gives the field of the particle that is nearest to `at` now."""
    name, component = field if isinstance(field, tuple) else (field, None)
    particles[name]  # FieldError: which the set has
    mark = particles.nearest(at)
    if mark < 0:
        raise ArgumentError("record(): there is no particle")

    def ask(_solver):
        row = numpy.flatnonzero(particles["id"] == mark)
        if not len(row):
            raise StaleError(f"the particle {mark} of the history has been removed")
        value = numpy.array(particles[name][int(row[0])])
        return value if component is None else value[component]

    return ask, particles.fields[name].unit


def lag(solver, what, at):
    """How many steps before the solver's time the quantity holds. Explicit dynamics has accelerations, pressures and reactions of
    the beginning of the last step, velocities of its middle (mps/dynamics.h)."""
    if solver._kind != "dynamics" or callable(what):
        return 0.0
    name = what[0] if isinstance(what, tuple) else what
    if at is None:
        return 0.0 if isinstance(what, str) else 1.0
    if name in ("velocity", "spin"):
        return 0.0 if solver.definition.integrator.name == "EULER" else 0.5
    return 1.0 if name in ("acceleration", "pressure", "reaction") else 0.0


def source(solver, what, at):
    """(function of the solver, unit) of the quantity that record() is given. None keeps the solver, which keeps them."""
    if at is not None:
        if callable(what) or isinstance(what, int):
            raise TypeError("record(): 'at' is for a field of the particles by its name")
        return _at_particle(solver.particles, what, at)
    if isinstance(what, str):
        if what in solver.particles and not hasattr(type(solver), what):
            raise ArgumentError(f"record(): {what!r} is a field of the particles: at= says of which one, a function of all "
                                f"(lambda: solver.particles[{what!r}].mean(axis=0))")
        ask = operator.attrgetter(what)
        ask(solver)  # AttributeError: which name there is not, with the nearest
        return ask, "s" if what in ("time", "dt") else ""
    if isinstance(what, int) and not isinstance(what, bool):
        return lambda s: s.get_reaction(what).force, "N"
    if hasattr(type(what), "get_reaction"):  # a body or contact
        return lambda _s: what.get_reaction().force, "N"
    if not callable(what):
        raise TypeError(f"record(): {what!r} is no function, name of a quantity, number of a boundary, body or contact")
    try:
        takes = sum(p.default is p.empty and p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)
                    for p in inspect.signature(what).parameters.values())
    except (TypeError, ValueError):  # built in
        takes = 0
    return what if takes else lambda _s: what(), ""


class Recording:
    """What solvers have besides the functions of the headers: histories that are recorded as they run."""

    _records = ()

    def record(self, name, what=None, *, every=None, at=None, unit=None, path=None):
        """Begins a history that the solver adds to as it runs, and returns it: h.t, h["force"], h.to_pandas().

        name   of the history and its columns: force, or force_x, force_y, force_z of a vector. Letters, digits, _ and -
        what   a function without arguments, or of the solver, that returns numbers; the name of a quantity of the solver
               ("totals.kinetic"; None: `name`); with at= the name of a field ("velocity", or ("stress", 1)); the number of
               a boundary, or a body or contact, for its reaction (N)
        every  s between rows, or a text with a unit; None: each step. A row is of the first step at or after its time;
               the first is of now, where a force is 0 before the first step. step(n) looks once, after its steps. Explicit
               dynamics has accelerations, pressures and reactions a step late, velocities half of one: rows of these by
               name or number have the time at which they hold; of what a function returns, that of the solver
        at     place (m): of the particle that is nearest to it now, wherever it moves
        unit   of the numbers, for files and axes
        path   a CSV file that follows the history

        The rows belong to the state of the solver: rollback and restore leave those of the restored state, where the solver
        has recorded a history of that name. What the function raises ends the run."""
        what = name if what is None else what
        ask, known = source(self, what, at)
        every = 0.0 if every is None else number(every, "s", "every")
        if not (every >= 0 and math.isfinite(every)):
            raise ArgumentError(f"record(): 'every' is {every!r}, must be a time above 0 s")
        word = re.sub(r"[^\w-]", "_", name)
        columns, first = _named(word, ask(self))
        if not columns:
            raise TypeError(f"record(): {name!r} gives no numbers")
        history = _made(self, word, columns, [known if unit is None else unit] * len(columns))
        if path is not None:
            history.open(path, 10)
        history.record(math.nan, first)
        self._records = [*self._records, _Record(history, word, columns, ask, every, lag(self, what, at))]
        return history

    def _look(self, step=None):
        """Adds the rows that are due now; `step` is the size of the last step (s), where it is not dt."""
        for record in self._records:
            record.look(self, step)

    def _pace(self):
        """Steps between looks: explicit dynamics and implicit elasticity, whose steps are equal, need not stop at each."""
        if self._kind not in ("dynamics", "elastic") or not self.dt > 0:
            return 1
        return max(1, int(min(record.every for record in self._records) / self.dt / 8))

    def _recorded(self, invoke, function, values, keywords):
        """A run with its histories."""
        given = {**dict(zip(function.arguments, values)), **keywords}
        callback, every = given.get("callback"), given.get("every", 1)
        if not (isinstance(every, int) and every >= 1) or (callback is not None and not callable(callback)):
            return invoke(function, values, keywords)  # which says what is wrong
        pace, begun, start = self._pace(), self.steps, self.time
        pace = math.gcd(pace, every) if callback is not None else pace
        end = number(given["t_end"], "s", "t_end") if "t_end" in given else math.nan

        def seen(solver):
            done = self.steps - begun
            self._look((self.time - start) / done if done and self._kind == "dynamics" else None)  # steps of a run are equal there
            if callback is not None and (done % every == 0 or self.time >= end):
                return callback(solver)
            return None

        return invoke(function, (), {**given, "every": pace, "callback": seen})


def _made(solver, word, columns, units):
    """A history that belongs to its solver, and may outlive it."""
    from . import _objects

    made = _objects.classes["history"](solver, word, columns, units)
    made._alive = [held for held in made._alive if held is not solver]
    return made


class _Record:
    """A history with its source."""

    def __init__(self, history, word, columns, ask, every, lag):
        self.history, self.word, self.columns, self.ask, self.every, self.lag = history, word, columns, ask, every, lag
        self.start = self.last()

    def last(self):
        """The time of the last row, read where it lies: this is asked at every step."""
        seen = ffi.new("mps_view *")
        self.history._checked("History.view()", library.mps_history_view, b"t", seen)
        rows = seen.shape[0]
        return ffi.cast("double *", seen.data)[(rows - 1) * seen.stride[0]] if rows else -math.inf

    def look(self, solver, step=None):
        if self.history._pointer is None:  # closed by its user
            return
        last, now = self.last(), solver.time
        if self.lag:
            now -= self.lag * (solver.dt if step is None else step)
        if now <= last:
            return
        if self.every > 0 and math.isfinite(last):
            place = [math.floor((t - self.start) / self.every * (1 + 1e-12) + 1e-9) for t in (last, now)]
            if place[0] == place[1]:
                return
        columns, values = _named(self.word, self.ask(solver))
        if columns != self.columns:
            raise TypeError(f"the source of the history {self.word!r} gives {', '.join(columns)}, and gave {', '.join(self.columns)}")
        self.history.record(now if self.lag else math.nan, values)
