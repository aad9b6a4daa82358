"""Writes what help() and editors show of the package, from the comments of the C headers.

usage: make_docs.py INCLUDE PACKAGE OUT

INCLUDE/mps has the headers, PACKAGE the sources of the package (the lengths of arrays in _shapes.py). Written are
OUT/_docs.py, the docstrings, and OUT/__init__.pyi, the stubs.
"""

import re
import sys
import textwrap
from os.path import commonprefix
from pathlib import Path

import headers
from interface import Interface, class_name

HEAD = '''"""Stubs of libmps, written by make_docs.py from the C headers."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from types import SimpleNamespace, TracebackType
from typing import Any, ClassVar

from numpy import ndarray
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike

__version__: str

class Error(Exception):
    """A failed call. `status` is ERROR_...; `step`, `particle` and `object` are those of the error record, where
    the library knew them (-1, -1, "")."""

    status: int
    function: str
    step: int
    particle: int
    object: str

class StaleError(Exception):
    """An array of a field taken before a solver stepped, or before particles were added, removed or sorted; a block
    whose law has returned."""

class MpsWarning(UserWarning):
    """A warning of the library, where the context has no hook `log`."""

class Field(NDArrayOperatorsMixin):
    """A field of particles, without a copy; it computes and answers as a NumPy array does."""

    stale: bool
    shape: tuple[int, ...]
    dtype: Any
    ndim: int
    size: int
    T: Any
    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **keywords: Any) -> Any: ...
    def __array__(self, dtype: Any = ..., copy: bool | None = ...) -> ndarray: ...
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
    gradient: ndarray
    stress: ndarray
    volume_ratio: ndarray
    deformation: ndarray | None
    history: ndarray
    flags: ndarray
    ids: ndarray
    position: ndarray
    temperature: ndarray | None

class Object:
    """An object of the C library; close(), the end of a `with` block, or the last reference destroys it."""

    kind: str
    context: Context
    def close(self) -> None: ...
    def __enter__(self) -> Any: ...
    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None: ...

class Result(SimpleNamespace):
    """A struct that C has filled: its members are attributes."""

    struct_size: int

def column(pointer: Any, count: int) -> ndarray | None:
    """The `count` numbers behind a pointer that a callback was given, for the duration of the callback."""

library: Any
'''

EXTRA = {
    "context": ["def __init__(self, {keywords}) -> None: ..."],
    "particles": ["def __len__(self) -> int: ...", "def __getitem__(self, name: str) -> Field: ...",
                  "def __setitem__(self, name: str, values: ArrayLike) -> None: ...",
                  "def __delitem__(self, name: str) -> None: ...", "def __contains__(self, name: str) -> bool: ...",
                  "def edit(self, name: str) -> Edit: ..."],
}
OWN = {"particles": ("particles_edit", "particles_commit", "particles_abandon", "particles_view")}
SHADOWED = ("context", "kind", "close")  # attributes of every object
WORDS = {"False", "None", "True", "and", "as", "class", "def", "del", "from", "in", "is", "lambda", "not", "or"}


class Writer:
    def __init__(self, interface):
        self.interface = interface
        self.spoken = {}
        for function in interface.functions.values():
            owner = class_name(function.owner) + "." if function.owner else ""
            self.spoken[f"mps_{function.name}"] = self.spoken[function.full] = owner + function.method
        for name in interface.structs:
            self.spoken.setdefault(name, class_name(name))
        for name, entry in interface.enums.items():
            self.spoken.setdefault(name, commonprefix([n.name for n in entry.names])[4:].rpartition("_")[0] + "_...")
        for kind in interface.kinds:
            self.spoken["mps_" + kind] = class_name(kind)
            self.spoken[f"mps_{kind}_destroy"] = class_name(kind) + ".close"

    def words(self, text):
        """A comment with the names that Python has."""
        text = re.sub(r"\bmps_\w+", lambda m: self.spoken.get(m[0], m[0]), text)
        return re.sub(r"\bNULL\b", "None", re.sub(r"\bMPS_(?=[A-Z])", "", text))

    def members(self, struct):
        return [m for m in self.interface.structs[struct].names
                if m.name not in ("struct_size", "reserved") and not m.name.endswith(("user", "release"))]

    def result(self, function):
        kinds = [n.type for n in function.results]
        return "None" if not kinds else kinds[0] if len(kinds) == 1 else f"tuple[{', '.join(kinds)}]"

    def doc(self, function):
        """The docstring: what C's comment says, the keywords, the results, the C function."""
        parts = [textwrap.fill(p, 90) for p in self.words(function.entry.text).split("\n\n")]
        forms = [form for n in function.entry.names if (form := self.interface.form(n))]
        if forms:
            parts.append("Called by the library: " + "; ".join(forms) + ".")
        if function.definition:
            parts.append("Keywords (members of the definition; those not given have their defaults):\n"
                         + self.rows(self.members(function.definition), "member"))
        returned = [self.words(f"{n.name}: {n.type}" if n.name not in ("", "out") else n.type)
                    for n in function.results]
        if returned:
            parts.append("Returns " + ", ".join(returned) + ".")
        if function.entry.result == "mps_status":
            parts.append("A failed call raises Error; its `status` is one of ERROR_... above.")
        listed = ", ".join(f"{n.type} {n.name}".replace("* ", "*") for n in function.entry.names) or "void"
        parts.append(textwrap.fill(f"C: {function.entry.result} {function.full}({listed}), mps/"
                                   f"{function.entry.header}", 90, subsequent_indent="   "))
        return "\n\n".join(parts)

    def rows(self, names, where):
        return "\n".join(textwrap.fill(f"{n.name} ({self.interface.python(n.type, where)})"
                                       f"{': ' + self.words(n.text) if n.text else ''}"
                                       f"{f' (called as {form})' if (form := self.interface.form(n)) else ''}", 90,
                                       initial_indent="  ", subsequent_indent="      ") for n in names)

    def keywords(self, struct):
        return [f"{m.name}: {self.interface.python(m.type, 'member')} = ..." for m in self.members(struct)
                if m.name not in WORDS]

    def stub(self, function, indent):
        """`def` of a function of the module (indent "") or of a method."""
        listed = ["self"] if indent else []
        required = len(function.arguments) - function.optional
        for k, a in enumerate(function.arguments):
            name = a.name + "_" if a.name in WORDS else a.name
            listed.append(f"{name}: {a.type}{' = ...' if k >= required else ''}")
        if len(listed) > (1 if indent else 0):
            listed.append("/")  # given by their places
        if function.definition:
            listed += ["*", *self.keywords(function.definition)]
        head = f"{indent}def {function.method if indent else function.name}({self.listed(listed, indent + '        ')})"
        return f'{head} -> {self.result(function)}:\n{self.quoted(self.doc(function), indent + "    ")}'

    @staticmethod
    def listed(words, indent):
        """Words with commas, in lines of at most 110 characters."""
        lines = [""]
        for k, word in enumerate(words):
            word += "" if k + 1 == len(words) else ","
            if len(lines[-1]) + len(word) > 100:
                lines.append(indent + word)
            else:
                lines[-1] += (" " if lines[-1] else "") + word
        return "\n".join(lines)

    @staticmethod
    def quoted(text, indent):
        body = textwrap.indent(text, indent).strip().replace("\\", "\\\\")
        body += " " if body.endswith('"') else ""
        return f'{indent}"""{body}"""\n'

    def stubs(self):
        interface, out = self.interface, [HEAD]
        for kind, entry in sorted(interface.structs.items()):
            if kind in ("mps_error", "mps_edit"):
                continue
            out.append(f"class {class_name(kind)}(Result):")
            out.append(self.quoted(self.words(entry.text) or kind, "    "))
            for m in entry.names:
                if m.name not in ("struct_size", "reserved", *WORDS):
                    out.append(f"    {m.name}: {interface.python(m.type, 'out')}")
                    if m.text:
                        out.append(self.quoted(textwrap.fill(self.words(m.text), 90), "    "))
            out.append("")
        for kind in interface.kinds:
            out.append(f"class {class_name(kind)}(Object):")
            for line in EXTRA.get(kind, []):
                keywords = self.listed(["*", *self.keywords("mps_context_def")], " " * 12)
                out.append("    " + line.format(keywords=keywords))
            out += [self.stub(f, "    ") for f in interface.functions.values()
                    if f.owner == kind and f.method not in SHADOWED and f.name not in OWN.get(kind, ())]
            out.append("    _libmps: ClassVar[Any]\n")
        out += [self.stub(f, "") for f in interface.functions.values() if not f.owner and f.name != "context_create"]
        for n in (n for n in interface.constants if not n.name.startswith("MPS_DEF_")):
            out.append(f"{n.name.removeprefix('MPS_')}: int")
            if n.text:
                out.append(self.quoted(textwrap.fill(self.words(n.text), 90), ""))
        return "\n".join(out)

    def docs(self):
        """The module _docs: of each function its docstring, arguments, how many may be left out, members of its
        definition and result; of each object and struct what it is."""
        rows = []
        for f in self.interface.functions.values():
            arguments = tuple((a.name, a.type) for a in f.arguments)
            keywords = tuple((m.name, self.interface.python(m.type, "member"))
                             for m in self.members(f.definition)) if f.definition else ()
            rows.append(f"    {f.name!r}: ({self.doc(f)!r},\n        {arguments!r}, {f.optional}, {keywords!r}, "
                        f"{self.result(f)!r}),")
        structs = [f"    {name!r}: {(self.words(e.text) + chr(10) + chr(10) + self.rows(self.members(name), 'out'))!r},"
                   for name, e in sorted(self.interface.structs.items())]
        return ('"""Written by make_docs.py."""\n\nFUNCTIONS = {\n' + "\n".join(rows) + "\n}\nSTRUCTS = {\n"
                + "\n".join(structs) + "\n}\n")


def main():
    include, package, out = map(Path, sys.argv[1:4])
    shapes = {}
    exec((package / "_shapes.py").read_text(), shapes)
    writer = Writer(Interface(*headers.read(include / "mps"), shapes))
    (out / "_docs.py").write_text(writer.docs())
    (out / "__init__.pyi").write_text(writer.stubs())


main()
