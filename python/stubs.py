"""The stubs of the package, from what make_docs.py has found."""

import ast
import pathlib
import re
import textwrap

from interface import SOLVERS, class_name

HEAD = '''"""Stubs of libmps, written by make_docs.py from the C headers."""

import builtins
from collections.abc import Callable, Iterator, Mapping, Sequence
from enum import IntEnum, IntFlag
from os import PathLike
from types import SimpleNamespace, TracebackType
from typing import Any, ClassVar, NoReturn

from numpy import ndarray
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike
from typing_extensions import Self

Array = ndarray[Any, Any]

__version__: str

class Error(Exception):
    """A failed call. `status` is a Status; `step`, `particle` and `object` are those of the error record, where
    the library knew them (-1, -1, "")."""

    status: Status
    function: str
    step: int
    particle: int
    object: str

@errors@

class Field(NDArrayOperatorsMixin):
    """A field of particles, without a copy; it computes and answers as a NumPy array does."""

    stale: bool
    shape: tuple[int, ...]
    dtype: Any
    ndim: int
    size: int
    T: Any
    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **keywords: Any) -> Any: ...
    def __array__(self, dtype: Any = ..., copy: bool | None = ...) -> Array: ...
    def __getitem__(self, key: Any) -> Any: ...
    def __setitem__(self, key: Any, value: Any) -> None: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Any: ...
    def __float__(self) -> float: ...
    def __getattr__(self, name: str) -> Any: ...

class Edit:
    """A field open for writing: `array`, or the value of a `with` block, whose end commits."""

    array: Field
    def commit(self) -> None: ...
    def abandon(self) -> None: ...
    def __enter__(self) -> Field: ...
    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None: ...

class Block:
    """A block of particles: what a law in Python reads and writes."""

    dim: int
    count: int
    dt: float
    time: float
    gradient: Array
    stress: Array
    volume_ratio: Array
    deformation: Array | None
    history: Array
    flags: Array
    ids: Array
    position: Array
    temperature: Array | None

class Object:
    """An object of the C library; close(), the end of a `with` block, or the last reference destroys it."""

    context: Context
    def close(self) -> None: ...
    def __enter__(self) -> Self: ...
    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None: ...

class Result(SimpleNamespace):
    """A struct that C has filled: its members are attributes."""

def default_context(*, {context}) -> Context:
    """The context of all that is made without `context=`; with keywords, those of Context, a new one takes its place."""

def column(pointer: Any, count: int) -> Array | None:
    """The `count` numbers behind a pointer that a callback was given, for the duration of the callback."""

library: Any
'''
# The kinds of errors and warnings, as the package has them.
KINDS = (pathlib.Path(__file__).parent / "libmps/_errors.py").read_text()
KINDS = re.search(r"^class ArgumentError.*?(?=^KINDS =)", KINDS, re.M | re.S)[0]
HEAD = HEAD.replace("@errors@", KINDS.strip().replace("\n\n\n", "\n\n"))


def docstring(file, name, method):
    """A docstring of the package's own, as lines of a stub."""
    tree = ast.parse((pathlib.Path(__file__).parent / "libmps" / file).read_text())
    of = next(node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == name)
    text = ast.get_docstring(next(node for node in of.body if isinstance(node, ast.FunctionDef) and node.name == method))
    return [line and f"    {line}" for line in f'"""{text}"""'.splitlines()]


EXTRA = {
    "context": ["def __init__(self, *, {context}) -> None: ..."],
    "particles": ["def __len__(self) -> int: ...", "def __getitem__(self, name: str | bytes | tuple[str, int], /) -> Field: ...",
                  "def __setitem__(self, name: str | tuple[str, int], values: ArrayLike | Sequence[Any] | Field, /) -> None: ...",
                  "def __delitem__(self, name: str, /) -> None: ...", "def __contains__(self, name: object, /) -> bool: ...",
                  "def __iter__(self) -> Iterator[str]: ...", "fields: dict[str, FieldInfo]",
                  "def edit(self, name: str) -> Edit: ...", "def to_pandas(self, *names: str) -> Any: ...",
                  "def to_xarray(self, *names: str) -> Any: ..."],
    "solver": ["def record(self, name: str, what: Any = None, *, every: float | str | None = None, at: Sequence[float] | None = None,",
               "           unit: str | None = None, path: str | PathLike[str] | None = None) -> History:",
               *docstring("_history.py", "Recording", "record")],
    "history": ["columns: tuple[str, ...]", "units: dict[str, str]", "t: Array", "values: Array",
                "def __getitem__(self, name: str, /) -> Array: ...", "def __contains__(self, name: object, /) -> bool: ...",
                "def __iter__(self) -> Iterator[str]: ...", "def __len__(self) -> int: ...",
                "def to_pandas(self) -> Any: ...", "def to_xarray(self) -> Any: ..."],
}
#: Parents of the classes of objects; attributes of the solvers that the table of C does not have.
PARENTS = {kind: "Solver" for kind in SOLVERS}


def wrapped(words, indent):
    """Words with commas, in lines of at most 110 characters."""
    lines = [""]
    for k, word in enumerate(words):
        word += "" if k + 1 == len(words) else ","
        if len(lines[-1]) + len(word) > 100:
            lines.append(indent + word)
        else:
            lines[-1] += (" " if lines[-1] else "") + word
    return "\n".join(lines)


def shown(default):
    """A default, where stubs may have it."""
    return "..." if "inf" in repr(default) and not isinstance(default, str) else repr(default)


def quoted(text, indent):
    body = textwrap.indent(text, indent).strip().replace("\\", "\\\\")
    body += " " if body.endswith('"') else ""
    return f'{indent}"""{body}"""\n'


class Stubs:
    def __init__(self, writer):
        self.writer, self.interface = writer, writer.interface

    def keywords(self, struct):
        return [f"{self.writer.safe(k.name)}: {k.type}{'' if k.type.endswith('None') else ' | None'} = {shown(k.default)}"
                for k, _ in self.interface.keywords(struct)]

    def arguments(self, f, first):
        listed = ["self"] if first else []
        for a in f.arguments:
            needed = a.default is ... and not (a.name == "ids" and f.owner in ("particles", *SOLVERS))  # a box may stand for them
            default = "" if needed else " = ..." if a.default is ... else f" = {shown(a.default)}"
            listed.append(f"{self.writer.safe(a.name)}: {a.type}{default}")
        keys = self.keywords(f.definition) if f.definition else []
        if "ids" in [a.name for a in f.arguments] and f.owner in ("particles", "solver", *SOLVERS):
            keys += ["box: Sequence[Any] | None = None", "all: bool = False"]
        if f.word == "run":
            keys.append("progress: bool = False")
        if f.form in ("class", "function") and any(role == "context" for role, _, _ in f.parameters):
            keys.append("context: Context | None = None")
        return listed + (["*", *keys] if keys else [])

    def function(self, f, indent):
        """`def` of a function of the module (indent "") or of a method."""
        name = "__init__" if f.form == "class" else f.word
        head = f"{indent}def {name}({wrapped(self.arguments(f, bool(indent)), indent + '        ')})"
        return f"{head} -> {self.writer.result(f)}:\n{quoted(self.writer.doc(f), indent + '    ')}"

    def attribute(self, f, setters):
        head = f"    @property\n    def {f.word}(self) -> {self.writer.result(f)}:\n{quoted(self.writer.doc(f), '        ')}"
        if f.word in setters:
            a = setters[f.word].arguments[0]
            head += f"    @{f.word}.setter\n    def {f.word}(self, {a.name}: {a.type}) -> None: ..."
        return head

    def object(self, kind, context):
        interface = self.interface
        mine = [f for f in interface.functions.values() if f.owner == kind]
        setters = {f.word: f for f in mine if f.form == "setter"}
        out = [f"class {class_name(kind)}({PARENTS.get(kind, 'Object')}):"]
        out += [line and "    " + line.replace("{context}", context) for line in EXTRA.get(kind, [])]
        makers = [f for f in interface.functions.values() if f.form == "class" and f.made == kind]
        own = [f for f in makers if f.word == class_name(kind)]
        out += [self.function(f, "    ") for f in own]
        if not own and kind != "context":
            out.append("    def __init__(self, *values: NoReturn) -> None: ...")
        # Properties last: a method called `property` or a type named as one would be hidden by it.
        out += [self.function(f, "    ") for f in mine if f.form == "method"]
        out += [self.attribute(f, setters) for f in mine if f.form == "property"]
        out.append("    _libmps: ClassVar[Any]\n")
        for f in makers:
            if f not in own:
                out += [f"class {f.word}({class_name(kind)}):", quoted(self.writer.doc(f), "    "), self.function(f, "    "), ""]
        return out

    def struct(self, kind, entry):
        out = [f"class {class_name(kind)}(Result):", quoted(self.writer.words(entry.text) or kind, "    ")]
        for m in entry.names:
            if m.name not in ("struct_size", "from") and not m.name.startswith("reserved"):
                enum, _ = self.interface.member_enum(kind, m)
                out.append(f"    {m.name}: {enum or self.interface.python(m.type, 'out')}")
                if m.text:
                    out.append(quoted(textwrap.fill(self.writer.words(m.text), 90), "    "))
        return [*out, ""]

    def enumeration(self, name, row):
        kind, prefix, names, _, text = row
        out = [f"class {name}({kind}):"]
        if text:
            out.append(quoted(self.writer.words(text), "    "))
        for n in names:
            out.append(f"    {self.writer.member(n.name, prefix)} = ...")
            if n.text:
                out.append(quoted(textwrap.fill(self.writer.words(n.text), 90), "    "))
        return [*out, ""]

    def text(self):
        interface = self.interface
        context = wrapped(self.keywords("mps_context_def"), " " * 12)
        out = [HEAD.replace("{context}", context)]
        out += ["class FieldInfo(Result):", '    """What a field of particles is."""', "", "    name: str", "    unit: str", "    meaning: str",
                "    components: int", "    integer: bool", "    readonly: bool", ""]
        for kind, entry in sorted(interface.structs.items()):
            if kind not in self.writer.UNSEEN and not kind.endswith("_call"):
                out += self.struct(kind, entry)
        for name, row in interface.groups.items():
            out += self.enumeration(name, row)
        for kind in interface.kinds:
            out += self.object(kind, context)
        out += [self.function(f, "") for f in interface.functions.values() if f.form == "function"]
        for n in interface.constants:
            out.append(f"{n.name.removeprefix('MPS_')}: int")
            if n.text:
                out.append(quoted(textwrap.fill(self.writer.words(n.text), 90), ""))
        return "\n".join(out)


def text(writer):
    return Stubs(writer).text()
