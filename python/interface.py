"""The Python functions, methods and properties that the C functions become: which arguments remain, what becomes of each
parameter of C, which results there are, with their types, units, names and defaults. libmps/_call.py does what is written
here; make_docs.py writes it down."""

import re
from dataclasses import dataclass, field

from headers import Name

NUMBERS = {"double": "float", "int32_t": "int", "int64_t": "int", "uint32_t": "int", "uint64_t": "int",
           "size_t": "int", "int": "int", "uint8_t": "int", "uint16_t": "int"}
SOLVERS = ("mpm", "dynamics", "elastic", "fluid")
#: Defaults of parameters that C has to be given, by their name or by that of the function with them.
DEFAULTS = {"every": 1, "part": -1, "component": -1, "components": 0, "mpm_step.count": 1, "dynamics_step.count": 1,
            "elastic_step.count": 1, "fluid_step.count": 1, "solver_step.count": 1, "body_drive.factor": 1.0, "scale": 1.0,
            "phase": 0.0, "start": 0.0}
#: Pointers that may be NULL where the sentence of the header does not name the parameter.
NULLS = {"body_drive.signal", "body_set_load.force", "body_set_load.moment", "coupling_begin.start", "elastic_select_facets.lo",
         "elastic_select_facets.hi", "elastic_get_facets.facets", "fluid_set_boundary_motion.displacement",
         "fluid_set_boundary_motion.velocity"}
#: Enumerations of parameters that their comment does not name.
ENUMS = {"solver_get_numbers.kind": "mps_def_kind", "status_text.status": "mps_status", "domain_agree.status": "mps_status",
         "context_set_error.status": "mps_status", "solver_set_linear_solver.equation": "mps_linear_equation", "material_point_control.controlled": "MPS_MATERIAL_POINT_",
         "mpm_set_boundary.number": "mps_side", "mpm_remove_boundary.number": "mps_side", "mpm_get_boundary.number": "mps_side",
         "mpm_get_reaction.number": "mps_side"}
#: Units of parameters whose comment does not have them behind their name.
UNITS = {"lo": "m", "hi": "m", "x": "m", "xy": "m", "xyz": "m", "rz": "m", "points": "m", "positions": "m", "centre": "m", "r": "m",
         "radius": "m", "station": "m", "t": "s", "t_end": "s", "dt": "s", "duration": "s", "times": "s", "peak_time": "s",
         "density": "kg/m3"}
#: Not there in Python: subscripts of a set do it, or the class of the object.
HIDDEN = {"particles_view", "particles_edit", "particles_commit", "particles_abandon", "particles_set", "particles_set_array",
          "particles_has_field", "particles_remove_field", "context_create", "context_error", "context_parallel_for",
          "enumerator_name", "solver_remove", "recorder_close", "particles_get_field_info", "particles_field_count"}


@dataclass
class Argument:
    """An argument of Python. `default` is what the signature shows, ... where it must be given."""

    name: str
    type: str
    default: object = ...
    unit: str = ""
    enum: str = ""


@dataclass
class Function:
    """A function of the package. `owner` is the kind of its object ("mpm"), "" without one; `form` one of "method",
    "property", "setter", "class", "function"."""

    name: str
    full: str
    owner: str
    entry: object
    form: str = "method"
    parameters: list = field(default_factory=list)  # (role, name, more) of each parameter of C
    arguments: list = field(default_factory=list)
    definition: str = ""  # struct whose members are keywords
    results: list = field(default_factory=list)  # Name, with its Python type
    made: str = ""  # kind of the object that a class makes
    word: str = ""  # its name in Python


def class_name(kind):
    """mps_mpm_totals: MpmTotals."""
    if kind == "mps_error":
        return "ErrorRecord"
    return "".join(part.capitalize() for part in kind.removeprefix("mps_").split("_"))


class Interface:
    """All functions, with what is known of types: opaque objects, structs, callbacks, lengths of arrays."""

    def __init__(self, functions, callbacks, structs, enums, constants, shapes, tables, units):
        self.callbacks, self.structs, self.enums = callbacks, structs, enums
        self.shapes, self.lengths, self.tables, self.units = shapes, shapes["FUNCTIONS"], tables, units
        self.kinds = sorted(name.removeprefix("mps_").removesuffix("_destroy") for name in functions
                            if name.endswith("_destroy"))
        self.kinds.append("grid")  # lent by its solver
        self.groups = self.enumerations(constants)
        self.spread = self.units_by_name()
        self.functions = {}
        for full, entry in sorted(functions.items()):
            of_any_kind = any(n.name in ("def", "out") and "void" in n.type for n in entry.names)
            name = full.removeprefix("mps_").removesuffix("_sized")
            if not entry.text and name in ("solver_remove_boundary", "solver_remove_load"):
                entry.text = functions["mps_solver_remove"].text  # one comment for three
            if not (full.endswith(("_destroy", "def_init")) or of_any_kind or name in HIDDEN or
                    re.fullmatch(rf"({'|'.join(SOLVERS)}|solver)_(context|solver)", name)):
                self.functions[name] = self.function(name, full, entry)
        self.setters()
        self.name_classes()

    # ---- names -------------------------------------------------------------------------------

    def enumerations(self, constants):
        """{class: (kind, prefix of the constants, [Name])} of all enumerations, and of flags that are macros; what is left
        are single constants."""
        made = {}
        for name, entry in self.enums.items():
            names = [n for n in entry.names if not n.name.endswith("FORCE_32BIT")]
            words = name.removeprefix("mps_").upper().split("_")
            if name in ("mps_status", "mps_feature"):
                prefix = "MPS_FEATURE_" if name == "mps_feature" else "MPS_"
                names = [n for n in constants if n.name.startswith(("MPS_FEATURE_",) if name == "mps_feature" else ("MPS_OK", "MPS_ERROR_"))]
            else:
                while not all(n.name.startswith("MPS_" + "_".join(words) + "_") for n in names):
                    words.pop()
                prefix = "MPS_" + "_".join(words) + "_"
            made[class_name(name)] = ("IntEnum", prefix, names, name, entry.text)
        for prefix, name in (("MPS_DOF_", "Dof"), ("MPS_MATERIAL_FLAG_", "MaterialFlag"), ("MPS_MATERIAL_POINT_", "MaterialPointStress")):
            names = [n for n in constants if n.name.startswith(prefix) and not n.name.endswith("_HISTORY")]
            made[name] = ("IntFlag", prefix, names, prefix, "")
        taken = {n.name for _, _, names, _, _ in made.values() for n in names}
        self.constants = [n for n in constants if n.name not in taken and n.name != "MPS_VIEW_READONLY"]
        return made

    def enum_class(self, name):
        """The class of an enumeration, by its name in C or by the prefix of its constants."""
        return next((made for made, row in self.groups.items() if name in (row[3], row[1])), "")

    def units_by_name(self):
        """Units of members by their name, where all tables agree: for parameters of that name."""
        found = {}
        for struct in self.tables.values():
            for name, (unit, _, _, _) in struct.items():
                found.setdefault(name, set()).add(unit)
        return {name: next(iter(units)) for name, units in found.items() if len(units) == 1}

    def base(self, kind):
        return re.sub(r"\bconst\b|\*|\[.*?\]", "", kind).strip()

    def enum_of(self, function, parameter, text):
        """The class of the enumeration that a parameter is of."""
        if self.base(parameter.type) in self.enums:
            return self.enum_class(self.base(parameter.type))
        if f"{function}.{parameter.name}" in ENUMS:
            return self.enum_class(ENUMS[f"{function}.{parameter.name}"])
        if parameter.type not in ("int32_t", "uint32_t"):
            return ""
        named = [e for e in self.enums if e == "mps_" + parameter.name or e.endswith("_" + parameter.name)]
        if len(named) != 1:
            named = [e for e in self.enums if re.search(rf"\b{e}\b", text)] if parameter.name == "kind" else []
        return self.enum_class(named[0]) if len(named) == 1 else ""

    def member_enum(self, struct, member):
        """The class of the enumeration that a member is of, and the names that the table allows."""
        _, _, prefix, names = self.tables.get(struct, {}).get(member.name, ("", None, "", ()))
        if prefix:
            return self.enum_class(prefix), tuple(n.lower() for n in names if n)
        if member.type not in ("int32_t", "uint32_t"):
            return "", ()
        if member.name == "dofs":
            return "Dof", ()
        named = [e for e in re.findall(r"\bmps_\w+", member.text) if e in self.enums]
        named = [e for e in named if member.name in e] if len(named) > 1 else named
        return (self.enum_class(named[0]) if named and member.text.startswith("mps_") else ""), ()

    def unit_of(self, parameter, text):
        """The unit of a parameter: in brackets behind its name, or that of all members of this name."""
        if self.base(parameter.type) != "double" or parameter.name == "amplitude" and "m/s2" not in text:
            return ""  # an amplitude is of the signal's quantity
        for found in re.finditer(rf"`?\b{parameter.name}\b`?(?: and `?\w+`?)? \(([^()]*)\)", text):
            for word in re.split(r", | or ", found[1]):
                if word in self.units or re.fullmatch(r"m2|1/s|rad/s|N m?|m2/s", word):
                    return word
        return UNITS.get(parameter.name) or self.spread.get(parameter.name, "")

    # ---- types -------------------------------------------------------------------------------

    def python(self, kind, where="", unit=""):
        """The Python type of a value: of an argument ("in"), a member or a result ("out")."""
        base, pointer = self.base(kind), "*" in kind
        if "(*)" in kind or base in self.callbacks:
            return "Callable[..., Any]"
        if base.removeprefix("mps_") in self.kinds:
            return (f"Sequence[{class_name(base)} | None]" if "[" in kind or kind.count("*") > 1 else class_name(base))
        if base == "char":
            many = kind.count("*") > 1 or ("[" in kind and pointer)
            return ("list[str]" if where == "out" else "Sequence[str]") if many else "str" if where == "out" else "str | PathLike[str]"
        if base == "mps_view":
            return "Array" if where == "out" else "ArrayLike"
        if base in NUMBERS and (pointer or "[" in kind):
            return "Array" if where == "out" else "Sequence[Any] | ArrayLike"
        if base in NUMBERS:
            return "float | str" if where != "out" and base == "double" else NUMBERS[base]
        if base in self.enums or base == "mps_status":
            return class_name(base)
        if base in self.structs:
            if where == "out":
                return class_name(base)
            return "Sequence[Mapping[str, Any]]" if where == "member" else f"{class_name(base)} | Mapping[str, Any]"
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

    def counts(self, formulas, names):
        """Names of numbers that arrays that are read say: factors of their lengths."""
        return {word for array, formula in formulas.items() if array in names
                for word in re.findall(r"\w+", re.sub(r"\w+\([^()]*\)", "", formula))}

    # ---- definitions -------------------------------------------------------------------------

    def keywords(self, struct):
        """The members of a definition as keywords: without numbers that arrays say; a box has the place of its corners."""
        members = self.structs[struct].names
        names = {m.name for m in members}
        hidden = self.counts(self.shapes["STRUCTS"].get(struct, {}), names) - {"kind"}
        hidden |= {m.name for m in members if m.name in ("struct_size", "field_count") or m.name.startswith("reserved") or
                   m.name.endswith(("user", "release")) or
                   (m.name.endswith("_size") and m.name[:-5] + "s" in names)}
        made = []
        selects = {"ids", "lower", "upper", "all"} <= names
        for m in members:
            if m.name in hidden or (selects and m.name == "upper"):
                continue
            if selects and m.name == "lower":
                made.append((Argument("box", "tuple[Any, Any] | Sequence[Any]", None, "m"),
                             Name("box", "", "m, (lower, upper), the corners, bounds included; None in a corner: no bound")))
                continue
            made.append((self.keyword(struct, m), m))
        return made

    def keyword(self, struct, member):
        unit, default, _, _ = self.tables.get(struct, {}).get(member.name, ("", None, "", ()))
        enum, names = self.member_enum(struct, member)
        kind = self.python(member.type, "member")
        if enum:
            kind = f"{enum} | str | int"
            rows = {n.name: k for k, n in enumerate(self.groups[enum][2])}
            if names and isinstance(default, int):
                default = [n.lower() for n in self.tables[struct][member.name][3]][default]
            elif enum == "Dof" or rows:
                default = None if not default else default
        elif member.name == "sides":  # bits of mps_side
            kind = "Side | str | Sequence[Side | str] | int"
        elif isinstance(default, bool):
            kind = "bool"
        if default is None:
            kind += " | None"
        return Argument(member.name, kind, default, unit, enum)

    # ---- functions ---------------------------------------------------------------------------

    def owner_of(self, name, names):
        """(owner, place): the object that a function is a method of."""
        first = self.base(names[0].type).removeprefix("mps_") if names and self.is_object(names[0].type) else ""
        if first != "context":
            makes = self.base(names[-1].type).removeprefix("mps_") if names else ""
            return ("" if name == makes + "_create" else first), 0
        if name.startswith("context_"):
            return "context", 0
        second = self.base(names[1].type).removeprefix("mps_") if len(names) > 1 and self.is_object(names[1].type) else ""
        if second and name.startswith(second + "_") and "_create" not in name:
            return second, 1
        return "", 0

    def function(self, name, full, entry):
        made = Function(name, full, "", entry)
        names = list(entry.names)
        made.owner, place = self.owner_of(name, names)
        creates = re.match(r"(\w+?)_create(?:_(\w+))?$", name)
        if creates and creates[1] in self.kinds and not made.owner:
            made.form, made.made = "class", creates[1]
        elif not made.owner:
            made.form = "function"
        lengths = self.lengths.get("mps_" + name, {})
        reads = {n.name for n in names if n.type.startswith("const ") or self.changes(name, n)}
        counts = self.counts(lengths, reads) & {n.name for n in names}
        trailing = self.trailing(name, names, lengths)
        for k, p in enumerate(names):
            role = self.role(name, full, k, p, place, made, counts, lengths, trailing)
            made.parameters.append(role)
        if entry.result not in ("mps_status", "void"):
            enum = "KernelKind" if name == "kernel_get_kind" else ""
            made.results = [Name(enum, self.python(entry.result, "out"))]
        elif made.form == "class":
            made.results = []
        self.order(made)
        made.word = self.word(made)
        if made.form == "method" and not made.arguments and not made.definition and self.asks(made):
            made.form = "property"
        return made

    def changes(self, name, parameter):
        """An array that C reads and writes."""
        return (name, parameter.name) == ("domain_max", "values")

    def trailing(self, name, names, lengths):
        """The places of what C writes: behind all that it only reads."""
        written = set()
        for k in range(len(names) - 1, -1, -1):
            p, kind = names[k], names[k].type
            if p.name in ("user", "size", "capacity", "release") or self.changes(name, p):
                continue
            if re.search(r"[*\[]", kind) and not kind.startswith("const ") and not self.is_object(kind) and "void" not in kind:
                written.add(k)
            elif kind.startswith("const ") and kind.count("*") > 1 and "char" not in kind:
                written.add(k)
            elif "(*)" in kind or self.base(kind) in self.callbacks:
                continue
            else:
                break
        return written

    def role(self, name, full, k, p, place, made, counts, lengths, trailing):
        """(role, name, more) of parameter k; arguments, definitions and results are noted in `made`."""
        kind, base, constant = p.type, self.base(p.type), p.type.startswith("const ")
        if k == place and made.owner:
            return ("self", p.name, made.owner)
        if base == "mps_context" and kind.count("*") == 1:
            return ("context", p.name, "")
        if (p.name == "user" and "void" in kind) or base == "mps_release_fn":
            return ("null", p.name, "")
        if p.name == "size" and full.endswith("_sized"):
            return ("size", p.name, "")
        if p.name == "capacity":
            return ("capacity", p.name, "")
        if p.name in counts and base in ("int64_t", "int32_t"):
            if "*" not in kind:
                return ("count", p.name, lengths)
        capacity = any(n.name == "capacity" for n in made.entry.names)
        if constant and base in self.structs and self.shapes["STRUCTS"].get(base) and base not in self.tables:
            made.results.append(Name("", class_name(base)))
            return ("arrays", p.name, base)
        if constant and base in self.tables and base != "mps_material_block":
            made.definition = base
            return ("def" if p.name == "def" else "info", p.name, base)
        if k in trailing:
            if p.name == "count" and capacity and "*" in kind:
                return ("many", p.name, "")
            made.results.append(Name("" if p.name == "out" else p.name, self.written(p, lengths)))
            if p.name in lengths:
                return ("borrow" if constant else "fill", p.name, lengths[p.name])
            return ("out", p.name, "")
        made.arguments.append(self.argument(name, p, made.entry.text, lengths))
        if self.changes(name, p):
            made.results.append(Name(p.name, "Array"))
            return ("change", p.name, "")
        if base in self.structs and not constant and not self.is_object(kind):
            return ("update", p.name, base)
        return ("argument", p.name, "const" if constant else "")

    def argument(self, name, p, text, lengths):
        kind = self.python(p.type, "in")
        unit, enum = self.unit_of(p, text), self.enum_of(name, p, text)
        made = Argument(p.name, kind, ..., unit, enum)
        if enum:
            made.type = f"{enum} | str | int"
        spoken = f"{name}.{p.name}"
        if p.name in ("every", "callback") or spoken in DEFAULTS:
            made.default = DEFAULTS.get(spoken, DEFAULTS.get(p.name))
        elif p.name in DEFAULTS and "*" not in p.type and not enum and name not in ("body_drive", "signal_create_ramp", "particles_set_table"):
            made.default = DEFAULTS[p.name]
        null = rf"(?<!but )`?\b{p.name}\b`?[^.;`]{{0,30}}\bNULL\b"
        pointer = "*" in p.type or self.base(p.type) in self.callbacks
        if spoken in NULLS or (pointer and self.base(p.type) != "mps_material" and re.search(null, text) and p.name != "inside"):
            made.default = None
        if p.name in ("log", "progress", "cancel", "fn") and self.base(p.type) in self.callbacks:
            made.default = None if p.name != "fn" or name == "history_set_source" else ...
        if name.endswith("_set_dt"):  # None is NaN: it follows the limit
            made.type += " | None"
        if made.default is None:
            made.type += " | None"
        return made

    def order(self, made):
        """Arguments with a default stand last."""
        made.arguments.sort(key=lambda a: a.default is not ...)

    def word(self, made):
        """Its name in Python: without its owner; of a question that has no arguments without get_."""
        word = made.name.removeprefix((made.owner or made.made) + "_") if made.owner else made.name
        if made.form == "method" and not made.arguments and not made.definition and word.startswith("get_"):
            word = {"def": "definition"}.get(word[4:], word[4:])
        return {"def": "definition"}.get(word, word)

    def asks(self, made):
        """Whether a method without arguments is a property: it returns what the object has."""
        result, results = made.entry.result, made.results
        if result not in ("mps_status", "void"):
            return True
        return bool(results) and (made.name.removeprefix(made.owner + "_").startswith("get_") or result == "void")

    def setters(self):
        """set_dt, of one argument, where there is a property dt, is how that is set."""
        for f in self.functions.values():
            if f.form != "method" or not f.word.startswith("set_") or len(f.arguments) != 1 or f.definition:
                continue
            asked = [g for g in self.functions.values() if g.owner == f.owner and g.form == "property" and g.word == f.word[4:]]
            if asked:
                f.form, f.word = "setter", f.word[4:]

    def name_classes(self):
        """Classes by their variant (Disc, MohrCoulomb), with the kind behind it where that is the name of another."""
        variants = {}
        for f in self.functions.values():
            if f.form == "class":
                variant = f.name.removeprefix(f.made + "_create").removeprefix("_")
                f.word = class_name(variant) if variant else class_name(f.made)
                variants.setdefault(f.word, []).append(f)
        taken = {class_name(kind) for kind in self.kinds} | set(self.groups) | {class_name(s) for s in self.structs}
        for word, listed in variants.items():
            for f in listed:
                if f.name != f.made + "_create" and (len(listed) > 1 or word in taken):
                    f.word = word + class_name(f.made)

    def written(self, parameter, lengths):
        if parameter.name in lengths:
            return "Array"
        kind = parameter.type.replace("*", "", 1).strip()
        if self.base(kind) == "mps_view":
            return "Array"
        return self.python(kind if kind.count("*") or self.base(kind) in self.structs else self.base(kind), "out")
