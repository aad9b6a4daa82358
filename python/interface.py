"""The Python functions that the C functions become, as libmps/_call.py calls them: which arguments remain, which
results there are, and of what type, for the docstrings and stubs that make_docs.py writes."""

import re
from dataclasses import dataclass, field

from headers import Name

NUMBERS = {"double": "float", "int32_t": "int", "int64_t": "int", "uint32_t": "int", "uint64_t": "int",
           "size_t": "int", "int": "int", "uint8_t": "int", "uint16_t": "int"}


@dataclass
class Function:
    """A function of the package. `owner` is the kind of its object ("mpm"), "" without one."""

    name: str
    full: str
    owner: str
    entry: object
    arguments: list = field(default_factory=list)  # Name, with its Python type
    optional: int = 0  # so many of the last ones may be left out
    definition: str = ""  # struct whose members are keywords
    results: list = field(default_factory=list)  # Name, with its Python type

    @property
    def method(self):
        """The name as a method of its owner."""
        return self.name.removeprefix(self.owner + "_") if self.owner else self.name


def class_name(kind):
    """mps_mpm_totals: MpmTotals."""
    return "".join(part.capitalize() for part in kind.removeprefix("mps_").split("_"))


class Interface:
    """All functions, with what is known of types: opaque objects, structs, callbacks, lengths of arrays."""

    def __init__(self, functions, callbacks, structs, enums, constants, shapes):
        self.callbacks, self.structs, self.enums = callbacks, structs, enums
        self.shapes, self.lengths = shapes, shapes["FUNCTIONS"]
        self.constants = [n for entry in enums.values() for n in entry.names] + constants
        self.kinds = sorted(name.removeprefix("mps_").removesuffix("_destroy") for name in functions
                            if name.endswith("_destroy"))
        self.kinds.append("grid") # lent by its solver
        self.functions = {}
        for full, entry in sorted(functions.items()):
            of_any_kind = any(n.name in ("def", "out") and "void" in n.type for n in entry.names)
            if not full.endswith(("_destroy", "_init")) and not of_any_kind:
                made = self.function(full, entry)
                self.functions[made.name] = made

    def base(self, kind):
        return re.sub(r"\bconst\b|\*|\[.*?\]", "", kind).strip()

    def python(self, kind, where=""):
        """The Python type of a value: of an argument ("in"), a member or a result ("out")."""
        base, pointer = self.base(kind), "*" in kind
        if "(*)" in kind or base in self.callbacks:
            return "Callable[..., Any] | None"
        if base.removeprefix("mps_") in self.kinds:
            return (f"Sequence[{class_name(base)} | None]" if "[" in kind or kind.count("*") > 1 else
                    class_name(base) + ("" if where == "out" else " | None"))
        if base == "char":
            many = kind.count("*") > 1 or ("[" in kind and pointer)
            return "Sequence[str]" if many else "str" if where == "out" else "str | PathLike[str]"
        if base in NUMBERS and (pointer or "[" in kind):
            return "ndarray" if where == "out" else "ArrayLike"
        if base in NUMBERS:
            return NUMBERS[base]
        if base in self.enums or base == "mps_status":
            return "int"
        if base in self.structs:
            if where == "out":
                return class_name(base)
            return "Sequence[Mapping[str, Any]]" if where == "member" else f"{class_name(base)} | Mapping[str, Any] | None"
        return "Any"

    def form(self, name):
        """How Python's function of a parameter or member is called, where that is a callback: "inside(x) -> ..."."""
        named = self.base(name.type)
        if named not in self.callbacks or self.callbacks[named].names[0].name != "user":
            return ""
        words = [n.name for n in self.callbacks[named].names[1:]]
        return f"{name.name}({', '.join(self.shapes['passed'](named, words))}){self.shapes['answer'](named)}"

    def is_object(self, kind):
        return kind.count("*") == 1 and self.base(kind).removeprefix("mps_") in self.kinds

    def function(self, full, entry):
        name = full.removeprefix("mps_").removesuffix("_sized")
        names = list(entry.names)
        made = Function(name, full, "", entry)
        if names and self.is_object(names[0].type) and "const" not in names[0].type.split("*")[1]:
            made.owner = self.base(names.pop(0).type).removeprefix("mps_")
        sized, capacity = full.endswith("_sized"), any(n.name == "capacity" for n in names)
        lengths = self.lengths.get("mps_" + name, {})
        trailing = True  # from the end: what is written, and may be left out
        for parameter in reversed(names):
            kind, constant = parameter.type, parameter.type.startswith("const ")
            if (parameter.name == "user" and kind == "void *") or kind == "mps_release_fn" or (sized and parameter.name == "size"):
                continue
            if parameter.name == "def" and constant and self.base(kind) in self.structs:
                made.definition = self.base(kind)
                trailing = False
                continue
            written = "*" in kind and not constant and not self.is_object(kind)
            if capacity and parameter.name == "count":
                continue
            if trailing and written:
                out = Name(parameter.name, self.written(parameter, lengths))
                made.results.insert(0, out)
                continue
            argument = Name(parameter.name, self.python(kind, "in"))
            made.arguments.insert(0, argument)
            optional = parameter.name == "capacity" or "Callable" in argument.type
            if trailing and optional:
                made.optional += 1
            else:
                trailing = False
        if entry.result not in ("mps_status", "void"):
            made.results = [Name("", self.python(entry.result, "out"))]
        return made

    def written(self, parameter, lengths):
        if parameter.name in lengths:
            return "ndarray"
        kind = parameter.type.replace("*", "", 1).strip()
        return self.python(kind if kind.count("*") or self.base(kind) in self.structs else self.base(kind), "out")
