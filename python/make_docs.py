"""Writes what the package knows of the functions of C, and what help() and editors show of it, from the comments of the
headers and the tables of definitions and units.

usage: make_docs.py ROOT OUT

ROOT is the source tree. Written are OUT/_tables.py, which libmps/_call.py works by, and OUT/__init__.pyi, the stubs.
"""

import re
import sys
import textwrap
from pathlib import Path

import headers
import stubs
import tables
from interface import Interface, class_name

WORDS = {"False", "None", "True", "and", "as", "class", "def", "del", "from", "in", "is", "lambda", "not", "or"}
#: Structs that Python has no use for.
UNSEEN = ("mps_view", "mps_edit", "mps_dtype", "mps_particles_field_info")
ERRORS = {"IO": "FileError", "MEMORY": "OutOfMemoryError"}


def safe(name):
    """A name that Python has no other use for."""
    return name + "_" if name in WORDS else name


class Writer:
    UNSEEN, safe = UNSEEN, staticmethod(safe)

    def __init__(self, interface):
        self.interface = interface
        self.spoken = {}
        for function in interface.functions.values():
            owner = class_name(function.owner) + "." if function.owner else ""
            self.spoken[f"mps_{function.name}"] = self.spoken[function.full] = owner + function.word
        for name in interface.structs:
            self.spoken.setdefault(name, class_name(name))
        for kind in interface.kinds:
            self.spoken["mps_" + kind] = class_name(kind)
            self.spoken[f"mps_{kind}_destroy"] = class_name(kind) + ".close"
        self.spoken.update({"mps_particles_edit": "Particles.edit", "mps_particles_commit": "Edit.commit", "mps_last_error": "Context.error",
                            "mps_particles_abandon": "Edit.abandon", "mps_particles_view": "Particles[name]",
                            "mps_particles_set": "Particles[name] =", "mps_particles_set_array": "Particles[name] =",
                            "mps_particles_has_field": "name in Particles", "mps_particles_remove_field": "del Particles[name]",
                            "mps_context_error": "Context.error", "mps_context_create": "Context"})
        for name, (_, prefix, constants, of, _) in interface.groups.items():
            self.spoken[of] = name
            for n in constants:
                self.spoken[n.name] = f"{name}.{self.member(n.name, prefix)}"
        for status in (n.name for n in interface.groups["Status"][2]):
            if status != "MPS_OK":
                word = status.removeprefix("MPS_ERROR_")
                self.spoken[status] = ERRORS.get(word, word.capitalize() + "Error")

    @staticmethod
    def member(name, prefix):
        name = name.removeprefix(prefix).removeprefix("ERROR_")
        return "_" + name if name[0].isdigit() else name

    def words(self, text):
        """A comment with the names that Python has; an end alone, as in "mps_body_create_box, _polygon", is a whole name before."""
        text = re.sub(r"\b(mps_\w+)((?:(?:,| and| or)\s+_\w+)+)", self.whole, text)
        text = re.sub(r"\bmps_\w+|\bMPS_\w+", lambda m: self.spoken.get(m[0], m[0].removeprefix("MPS_") if m[0].isupper() else m[0]), text)
        return re.sub(r"\bNULL\b", "None", text)

    def whole(self, found):
        parts = found[1].split("_")
        starts = ["_".join(parts[:k]) for k in range(len(parts) - 1, 0, -1)]

        def name(end):
            return next((start + end[0] for start in starts if start + end[0] in self.spoken), end[0])

        return found[1] + re.sub(r"_\w+", name, found[2])

    def result(self, function):
        if function.form == "class":
            return "None"
        kinds = [n.type for n in function.results]
        if len(kinds) == 1 and function.results[0].name in self.interface.groups:
            return function.results[0].name
        return "None" if not kinds else kinds[0] if len(kinds) == 1 else f"tuple[{', '.join(kinds)}]"

    def doc(self, function):
        """The docstring: what C's comment says, arguments and keywords, the results, the C function."""
        entry = function.entry
        parts = [textwrap.fill(p, 90) for p in self.words(entry.text).split("\n\n")]
        forms = [form for n in entry.names if (form := self.interface.form(n))]
        if forms:
            parts.append("Called by the library: " + "; ".join(forms) + ".")
        noted = [f"{safe(a.name)} ({self.unit(a.unit)})" for a in function.arguments if a.unit]
        if noted:
            parts.append("Units: " + ", ".join(noted) + "; or texts with a unit.")
        if function.definition:
            parts.append("Keywords (those not given have their defaults):\n" + self.rows(function.definition))
        returned = [self.words(f"{n.name}: {n.type}" if n.name else n.type) for n in function.results]
        if returned and function.form != "class":
            parts.append("Returns " + ", ".join(returned) + ".")
        listed = ", ".join(f"{n.type} {n.name}".replace("* ", "*") for n in entry.names) or "void"
        parts.append(textwrap.fill(f"C: {entry.result} {function.full}({listed}), mps/{entry.header}", 90, subsequent_indent="   "))
        return "\n\n".join(parts)

    def unit(self, unit):
        return {"1": "a ratio"}.get(unit, unit)

    def rows(self, struct):
        made = []
        for keyword, member in self.interface.keywords(struct):
            said = self.words(member.text)
            form = self.interface.form(member)
            made.append(textwrap.fill(f"{safe(keyword.name)} ({keyword.type}){': ' + said if said else ''}"
                                      f"{f' (called as {form})' if form else ''}", 90, initial_indent="  ", subsequent_indent="      "))
        return "\n".join(made)

    def members(self, struct):
        """What members a struct has and what they mean, for the docstring of its class."""
        rows = []
        for m in self.interface.structs[struct].names:
            if m.name != "struct_size" and not m.name.startswith("reserved") and not m.name.endswith(("user", "release")):
                enum, _ = self.interface.member_enum(struct, m)
                said = self.words(m.text)
                rows.append(textwrap.fill(f"{m.name} ({enum or self.interface.python(m.type, 'out')}){': ' + said if said else ''}", 90,
                                          initial_indent="  ", subsequent_indent="      "))
        return "\n".join(rows)

    def table(self):
        """The module _tables."""
        interface, rows = self.interface, []
        for f in interface.functions.values():
            parameters = tuple((role, word, more if isinstance(more, str) else "") for role, word, more in f.parameters)
            arguments = tuple((safe(a.name), a.type, a.default, a.unit, a.enum) for a in f.arguments)
            results = tuple((safe(n.name), n.type) for n in f.results)
            rows.append(f"    {f.name!r}: ({f.full!r}, {f.owner!r}, {f.form!r}, {f.word!r}, {f.made!r}, {f.entry.result!r},\n"
                        f"        {parameters!r},\n        {arguments!r},\n        {f.definition!r}, {results!r}, {self.result(f)!r},\n"
                        f"        {self.doc(f)!r}),")
        definitions = {struct: {safe(k.name): (k.type, k.default, k.unit, k.enum, interface.member_enum(struct, m)[1] if m.type else ())
                                for k, m in interface.keywords(struct)}
                       for struct in interface.structs if struct in interface.tables or struct.endswith("_layer")}
        chosen = {struct: found for struct, entry in interface.structs.items()
                  if (found := {m.name: enum for m in entry.names if (enum := interface.member_enum(struct, m)[0])})}
        enums = {name: (kind, prefix, tuple(n.name for n in names), self.words(text))
                 for name, (kind, prefix, names, _, text) in interface.groups.items()}
        structs = {name: (class_name(name), self.words(e.text) + "\n\n" + self.members(name)) for name, e in sorted(interface.structs.items())
                   if name not in UNSEEN and not name.endswith("_call")}
        spoken = {name: said for name, said in self.spoken.items() if name.startswith("MPS_") or "." in said or said[0].isupper()}
        return ('"""Written by make_docs.py."""\n\nfrom math import inf\n\n#: name: (C function, owner, form, word, kind that it makes, C result, parameters '
                '(role, name, more), arguments\n#: (name, type, default, unit, enumeration), definition, results, type, docstring)\n'
                "FUNCTIONS = {\n" + "\n".join(rows) + "\n}\n"
                f"KINDS = {tuple(interface.kinds)!r}\nDEFINITIONS = {definitions!r}\nCHOSEN = {chosen!r}\nENUMS = {enums!r}\n"
                f"STRUCTS = {structs!r}\nUNITS = {interface.units!r}\nSPOKEN = {spoken!r}\n"
                f"CONSTANTS = {tuple(n.name for n in interface.constants)!r}\n")


def main():
    root, out = map(Path, sys.argv[1:3])
    shapes = {}
    exec((root / "python/libmps/_shapes.py").read_text(), shapes)
    writer = Writer(Interface(*headers.read(root / "include/mps"), shapes, tables.members(root), tables.units(root)))
    (out / "_tables.py").write_text(writer.table())
    (out / "__init__.pyi").write_text(stubs.text(writer))


main()
