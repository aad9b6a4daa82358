"""Writes record.h and record_calls.c: for each public function a wrapper that writes the call as C and makes it.

usage: make_record.py CC INCLUDE FOLDER

CC preprocesses the headers of INCLUDE. Files that include record.h call the wrappers instead of the functions;
tests/api/record.c has what the wrappers call. Types decide what is written: record.h lists the cases."""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))
from make_cdef import preprocessed, shared, without_bodies  # noqa: E402

SCALARS = {"double": "real", "size_t": "whole", "int64_t": "whole", "int32_t": "whole", "uint32_t": "whole",
           "uint64_t": "whole", "uint8_t": "whole", "mps_status": "whole"}


def parse(text):
    """Opaque types, structs with their members, callbacks and functions."""
    opaque = re.findall(r"typedef struct (\w+) \1;", text)
    structs = {}
    for body, name in re.findall(r"typedef struct \w+ \{(.*?)\} (\w+);", text, re.S):
        structs[name] = [m for line in body.split(";") for m in members(" ".join(line.split()))]
    callbacks = re.findall(r"typedef [\w\s*]+\(\*(\w+)\)\(", text)
    functions = []
    for result, name, listed in re.findall(r"^ ?([a-z][\w ]*?[ *]+)(mps_\w+)\(([^()]*)\);", text, re.M):
        parameters = [parameter(" ".join(p.split())) for p in listed.split(",")]
        functions.append((result.strip(), name, [p for p in parameters if p]))
    return opaque, structs, callbacks, functions


def members(line):
    """(type, name, dimensions) of "const double *a, *b" or "double x[3][2]"."""
    if not line:
        return
    pointer = re.match(r".*\(\*(\w+)\)\(.*\)$", line)
    if pointer:
        yield "callback", pointer.group(1), ""
        return
    head = re.match(r"((?:const )?(?:struct )?\w+)\s*(.*)", line)
    for part in head.group(2).split(","):
        one = re.match(r"\s*([*]?\s*(?:const\s*)?[*]?)\s*(\w+)\s*((?:\[\w+\])*)$", part)
        if one:
            yield (head.group(1) + " " + one.group(1).replace(" ", "")).strip(), one.group(2), one.group(3)


def parameter(text):
    """(type, name); an array is a pointer."""
    if text in ("void", ""):
        return None
    one = re.match(r"(.*?)(\w+)((?:\[\w*\])?)$", text)
    kind = one.group(1).strip() + (" *" if one.group(3) else "")
    return re.sub(r"\s*\*", " *", kind).replace("* *", "**"), one.group(2)


class Writer:
    def __init__(self, opaque, structs, callbacks):
        self.opaque, self.structs, self.callbacks = opaque, structs, callbacks

    def value(self, kind, text, place):
        """C that writes one member or parameter of this type, an expression of C; `place` names it."""
        base = " ".join(kind.replace("const", " ").split()).replace("* *", "**")
        if base in SCALARS:
            cast = "(double)" if SCALARS[base] == "real" else "(long long)"
            return f"rec_{SCALARS[base]}({cast}{text});"
        if base in self.callbacks or base == "callback":
            return f"rec_function((rec_any){text});"
        target = base.rstrip("* ").replace(" const", "")
        stars = base.count("*")
        if target in self.opaque and stars == 1:
            return f"rec_object({text});"
        if target == "char" and stars == 1 and kind.startswith("const"):
            return f"rec_text({text});"
        if target == "char" and stars == 2:
            return f"rec_texts((const char *const *){text}, {place});"
        if target == "void":
            return f"rec_user({text});"
        return None

    def struct(self, name):
        lines = [f"static void rec_members_{name}(const {name} *v) {{"]
        for kind, member, dims in self.structs[name]:
            count = dims.count("[")
            base = " ".join(kind.replace("const", " ").split())
            if member == "struct_size" or not count:
                one = self.value(kind, f"v->{member}", "0")
                if one is None and base.endswith("*") and base.rstrip("* ") in SCALARS:
                    one = f"rec_name_array(v->{member});"
                if one is None and base.rstrip("* ") in self.structs and base.count("*") == 1:
                    one = f"rec_name_array(v->{member});"
                if one is not None:
                    lines.append(f'  rec_member("{member}"); {one} rec_next();')
                continue
            one = self.value(kind, f"(&v->{member}{'[0]' * count})[k]", "0")
            if one is None and base.rstrip("* ") in SCALARS and base.count("*") == 1:
                one = f"rec_name_array(v->{member}[k]);"
            if one is None:
                continue
            sized = f"(int)(sizeof v->{member} / sizeof v->{member}{'[0]' * count})"
            lines.append(f'  for (int k = 0; k < {sized}; k++) {{ rec_element("{member}", k, {count}); {one} '
                         "rec_next(); }")
        return "\n".join([*lines, "}"])

    def arrays(self, name):
        """Declares the arrays that the members of a struct point to, before it."""
        lines = [f"static void rec_arrays_{name}(const {name} *v) {{", "  (void)v;"]
        lines += [f"  rec_count((long long)v->{member});" for kind, member, dims in self.structs[name]
                  if SCALARS.get(kind) == "whole" and not dims and member != "struct_size"]
        for kind, member, dims in self.structs[name]:
            base = " ".join(kind.replace("const", " ").split())
            of = base.rstrip("* ")
            if base.count("*") != 1:
                continue
            if of in SCALARS and of != "size_t" and dims.count("[") < 2:
                each = f"for (int k = 0; k < (int)(sizeof v->{member} / sizeof *v->{member}); k++) " if dims else ""
                at = f"v->{member}[k]" if dims else f"v->{member}"
                lines.append(f'  {each}rec_array("{of}", {at}, sizeof *{at}, {int(of == "double")});')
            elif of in self.structs and not dims:
                lines += [f"  {of} {member}[8];",
                          f'  const int {member}_count = rec_structs("{of}", v->{member}, {member}, sizeof *{member});',
                          f"  for (int k = 0; k < {member}_count; k++) {{ rec_brace(); "
                          f"rec_members_{of}(&{member}[k]); rec_unbrace(); }}",
                          f"  if ({member}_count > 0) rec_close();"]
        return "\n".join([*lines, "}"])

    def function(self, result, name, parameters):
        signature = ", ".join(f"{k} {n}".replace("* ", "*") for k, n in parameters) or "void"
        head = f"{result} record_{name}({signature})".replace("* record", "*record")
        body = [f'  const bool on = rec_begin("{name}");', "  if (on) {"]
        wholes = [n for k, n in parameters if SCALARS.get(k) == "whole" and k not in ("mps_status",)]
        body += [f"    rec_count((long long){n});" for n in wholes]
        writes, after = [], []
        for k, (kind, arg) in enumerate(parameters):
            base = kind.replace("const ", "").strip()
            target, stars = base.rstrip("* ").replace(" const", ""), base.count("*")
            one = self.value(kind, arg, "0")
            if one is not None:
                writes.append(one)
            elif target in self.opaque and stars == 2:
                writes.append(f'rec_place("{target}", {arg} ? *{arg} : NULL, {arg} != NULL);')
                after.append(f"rec_made({arg} ? *{arg} : NULL, {arg} != NULL);")
            elif target == "mps_edit":
                body.append(f"    rec_find_edit({arg} ? {arg}->data : NULL, {int(name == 'mps_particles_edit')});")
                writes.append(f"rec_edit({arg} != NULL);")
                if name == "mps_particles_edit":
                    after.append(f"rec_keep_edit({arg} ? {arg}->data : NULL);")
                elif name == "mps_particles_commit":
                    body.append(f"    if ({arg}) rec_fill_edit(&{arg}->view, {arg}->data);")
            elif target in self.structs and (kind.startswith("const") or self.is_input(target, name)):
                body.append(f"    if ({arg}) {{ rec_arrays_{target}({arg}); rec_open({k}, \"{target}\"); "
                            f"rec_members_{target}({arg}); rec_close(); }}")
                writes.append(f"rec_argument({k}, {arg} != NULL);")
            elif target in SCALARS and stars == 1:
                of = int(target == "double")
                body.append(f'    rec_array("{target}", {arg}, sizeof *{arg}, {of});')
                writes.append(f"rec_name_array({arg});")
            else:
                writes.append(f"rec_room({k}, {arg} != NULL);")
        opaque_result = result.rstrip("* ").replace("const ", "") in self.opaque
        kind = "status" if result == "mps_status" else "object" if opaque_result else "other"
        body.append(f"    rec_call_{kind}(\"{name}\");")
        body += [f"    {one}{' rec_comma();' if k + 1 < len(writes) else ''}" for k, one in enumerate(writes)]
        body += ["    rec_end_call();", "  }"]
        call = f"{name}({', '.join(n for _, n in parameters)})"
        if result == "void":
            body += ["  rec_enter();", f"  {call};", "  rec_leave();"]
        else:
            typed = f"{result} rec_out".replace("* rec_out", "*rec_out")
            body += ["  rec_enter();", f"  {typed} = {call};", "  rec_leave();"]
        if after or kind != "other":
            body.append("  if (on) {")
            body += [f"    {one}" for one in after]
            if kind == "status":
                body.append("    rec_status(rec_out);")
            if kind == "object":
                body.append("    rec_result(rec_out);")
            body.append("  }")
        body.append("  if (on) rec_finish();")
        if result != "void":
            body.append("  return rec_out;")
        return "\n".join([head + " {", *body, "}"])

    def is_input(self, target, name):
        if name.endswith("_init") or "_get_" in name or name == "mps_material_point_init":
            return False
        return target == "mps_material_point" or any(m[1] == "struct_size" for m in self.structs[target])


def main():
    cc, include, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    text = without_bodies(preprocessed(cc, include))
    text += "\n".join(line for line in shared(include)[0].splitlines() if "_sized(" not in line)
    opaque, structs, callbacks, functions = parse(text)
    writer = Writer(opaque, structs, callbacks)
    head = ["/* Written by make_record.py. */", "#ifndef TESTS_API_RECORD_H", "#define TESTS_API_RECORD_H",
            "#define MPS_EXPERIMENTAL 1", "#include <mps/mps.h>", "#include <mps/experimental.h>"]
    used = {}
    for result, name, parameters in functions:
        for kind, _ in parameters:
            target = kind.replace("const ", "").rstrip("* ")
            if target in structs and (kind.startswith("const") or writer.is_input(target, name)):
                used[target] = None
        signature = ", ".join(f"{k} {n}".replace("* ", "*") for k, n in parameters) or "void"
        head.append(f"{result} record_{name}({signature});".replace("* record", "*record"))
    head.append("#ifndef TESTS_API_RECORD_CALLS")
    for _, name, parameters in functions:
        head.append(f"#define {name}(...) record_{name}(__VA_ARGS__)" if parameters else
                    f"#define {name}() record_{name}()")
    (folder / "record.h").write_text("\n".join([*head, "#endif", "#endif"]) + "\n")
    used.pop("mps_edit", None)
    source = ["/* Written by make_record.py. */", '#include "record_private.h"', "#define TESTS_API_RECORD_CALLS", '#include "record.h"']
    wrappers = "\n\n".join(writer.function(*f) for f in functions)
    arrays = [writer.arrays(name) for name in structs if f"rec_arrays_{name}(" in wrappers]
    calls = "\n\n".join([*arrays, wrappers])
    source += [writer.struct(name) for name in structs if f"rec_members_{name}(" in calls]
    (folder / "record_calls.c").write_text("\n\n".join([*source, calls]) + "\n")


main()
