"""What a release is held to: its programs as binaries, its headers, and tables of what it computes and accepts.

scripts/release-abi makes the folder tests/abi/released/<version> by `make`; the tests abi/released/* compare the present
library with each folder by `check`. Both produce the tables by the same functions here: a table is a dictionary of
lines, and each kind of table has its own rule of what later versions may change.
"""

import io
import lzma
import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path.insert(0, str(ROOT / "python"))
import headers as reading  # noqa: E402

SOURCES = ("scenes.h", "scenes.c", "solvers.c", "calls.c", "client.cpp")
PLUGIN = ROOT / "tests/install/plugin"
#: Programs of examples that use the stable interface alone, and print a table.
EXAMPLES = ("servo", "coupling")
SYSTEM = ["-lm", "-lpthread", "-ldl"]
#: Differences of numbers that other compilers, instruction sets and libraries make, of the largest number of a line or
#: column: of solvers' first steps, and of whole programs.
CLOSE, PROGRAMS_CLOSE = 1e-6, 1e-3


def run(command, **options):
    """The output of a command; a failure ends the program with all that it wrote."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)
    if done.returncode:
        raise SystemExit(f"{' '.join(str(c) for c in command)}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def stable():
    rows = [line.split() for line in (ROOT / "src/api.since").read_text().splitlines() if line[:1] != "#"]
    return [row[0] for row in rows if row[2] != "experimental"]


# ---- the client of every stable function -----------------------------------------------------------------------------

def calls_table(include):
    """C text for calls.c: a function that makes the call and an entry for each stable function."""
    functions, callbacks, structs, _, _ = reading.read(include / "mps")
    base = (include / "mps/base.h").read_text()
    kinds = {name: number for number, name in re.findall(r"^ +X\([A-Z_]+, (\d+), (mps_\w+)\)", base, re.M)}
    opaque = set(re.findall(r"typedef struct (mps_\w+) \1;", "".join(p.read_text() for p in include.rglob("*.h"))))
    calls, entries, used, inline = [], [], {}, {}
    for header in include.glob("mps/*.h"):  # inline ones, that have definitions of their own
        for name, listed in re.findall(r"static\s+inline\s+mps_status\s+(mps_\w+_(?:add|set)_(?:boundary|load))\(([^)]*)\)", header.read_text()):
            inline[name] = reading.Entry(name, header.name, "", "mps_status", reading.parameters(listed))
    functions.update(inline)
    for name in [*stable(), *sorted(inline)]:
        entry, arguments, names, sorts, definitions = functions[name], [], [], [], []
        before = "char"
        for k, parameter in enumerate(entry.names):
            target = re.sub(r"\bconst\b|\bstruct\b|\*|\[\w*\]", " ", parameter.type).split()[0]
            stars = parameter.type.count("*") + parameter.type.count("[")
            if target in opaque and stars == 1:
                sort, value = "HANDLE", f'handle("{target}", v[{k}])'
            elif target in opaque and name.endswith("_destroy"):
                sort, value = "PLACE", f'owned({k}, "{target}", v[{k}])'
            elif target in kinds and stars == 1:
                sort, value = "DEFINITION", f"definition({k}, {kinds[target]}, v[{k}])"
                used[target] = kinds[target]
            elif target == "char" and stars == 1 and "const" in parameter.type:
                sort, value = "TEXT", f"text(v[{k}])"
            elif target == "double" and stars and "const" in parameter.type:
                sort, value = "NUMBERS", f"numbers({k}, v[{k}])"
            elif stars:
                sort, value = "PLACE", f"place({k}, v[{k}])"
            elif target in callbacks:
                sort, value = "CALLBACK", "NULL"
            elif target == "double":
                sort, value = "REAL", f"real(v[{k}])"
            elif target == "size_t":
                sort, value = "SIZE", f"size({f'sizeof({before})' if before.startswith('mps_') else '64'}, v[{k}])"
            elif target == "uint32_t":
                sort, value = "BITS", f"bits(v[{k}])"
            else:
                sort, value = "WHOLE", f"({target})whole(v[{k}])"
            before = target if stars else before
            arguments.append(value), names.append(f'"{parameter.name}"'), sorts.append(sort)
            definitions.append(kinds[target] if sort == "DEFINITION" else "0")
        call, use = f"{name}({', '.join(arguments)})", "" if entry.names else "  (void)v;\n"
        if entry.result == "mps_status":
            body = f"  return (int){call};"
        elif entry.result == "void" or "*" in entry.result:
            body = f"  {'' if entry.result == 'void' else '(void)'}{call};\n  return -1;"
        else:
            body = f"  returned = (double){call};\n  return -1;"
        calls.append(f"static int call_{name}(const int *v) {{\n{use}{body}\n}}")
        entries.append(f'  {{"{name}", call_{name}, {len(names)}, {{{", ".join(names) or "NULL"}}}, {{{", ".join(sorts) or "HANDLE"}}}, '
                       f'{{{", ".join(definitions) or "0"}}}}},')
    numbers = {"double": "8", "int32_t": "4", "uint32_t": "4", "int64_t": "-8"}
    members, kinds_used = [], []
    for target, kind in used.items():
        rows = [(m.name, numbers[m.type.split("[")[0].strip()]) for m in structs[target].names
                if m.type.split("[")[0].strip() in numbers and m.name != "struct_size"]
        members.append(f"static const member members_{target}[] = {{" +
                       ", ".join(f'{{"{m}", offsetof({target}, {m}), {size}}}' for m, size in rows) + "};")
        kinds_used.append(f"      {{{kind}, sizeof({target}), members_{target}, {len(rows)}}},")
    calls = [*members, "static const definitions *definition_of(int32_t kind) {", "  static const definitions all[] = {", *kinds_used,
             "  };", "  for (size_t k = 0; k < sizeof all / sizeof *all; k++)", "    if (all[k].kind == kind) return &all[k];",
             "  return NULL;", "}", *calls]
    return "/* Written by released.py. */\n" + "\n".join(calls) + "\nstatic const entry entries[] = {\n" + "\n".join(entries) + "\n};\n"


# ---- tables: each a dictionary of lines ------------------------------------------------------------------------------

def enumerations(include, cc, scratch):
    """Value of each constant of the stable headers."""
    source = scratch / "enumerations.c"
    names = set()
    for header in [*include.glob("mps/*.h")]:
        names |= set(re.findall(r"^#define (MPS_\w+) +(?:\d+|0x[\da-fA-F]+)u?\b", header.read_text(), re.M))
    source.write_text("#include <mps/mps.h>\n")
    text = run([cc, "-E", "-P", "-I", include, source])
    for body in re.findall(r"enum\s*\w*\s*\{(.*?)\}", text, re.S):
        names |= set(re.findall(r"\b(MPS_\w+)\s*=", body))
    names = sorted(name for name in names if not re.match(r"MPS_(API_)?VERSION", name))
    source.write_text("#include <mps/mps.h>\n#include <stdio.h>\nint main(void) {\n" +
                      "".join(f'  printf("{n} %lld\\n", (long long){n});\n' for n in names) + "  return 0;\n}\n")
    run([cc, "-std=c11", "-I", include, source, "-o", scratch / "enumerations"])
    return lines(run([scratch / "enumerations"]), " ")


def layouts(include, cc, scratch):
    """Place and bytes of each member of the structs of the stable headers; the size of those whose layout is frozen."""
    stable_headers = {p.name for p in include.glob("mps/*.h")}
    structs, rows = reading.read(include / "mps")[2], []
    for name, entry in structs.items():
        if entry.header not in stable_headers:
            continue
        for member in entry.names:
            rows.append(f'  printf("{name}.{member.name}: at %zu, %zu bytes\\n", offsetof({name}, {member.name}), sizeof(({name} *)0)->{member.name});')
        if "Frozen layout" in entry.text:
            rows.append(f'  printf("{name}: %zu bytes\\n", sizeof({name}));')
    source = scratch / "layouts.c"
    source.write_text("#include <mps/mps.h>\n#include <stddef.h>\n#include <stdio.h>\nint main(void) {\n" + "\n".join(rows) +
                      "\n  return 0;\n}\n")
    run([cc, "-std=c11", "-I", include, source, "-o", scratch / "layouts"])
    return lines(run([scratch / "layouts"]), ": ")


def lines(text, separator):
    """Each line under what stands before the last (" ") or first (": ") separator."""
    rows = [line.rsplit(" ", 1) if separator == " " else line.split(separator, 1) for line in text.splitlines()]
    return {row[0]: row[1] if len(row) > 1 else "" for row in rows}


def library_tables(program, include):
    """Definitions of the stable headers and fields, from the program that prints the tables of the library."""
    public = set(re.findall(r"^\} (mps_\w+);", "".join(p.read_text() for p in include.glob("mps/*.h")), re.M))
    definitions, fields = {}, {}
    for line in run([program]).splitlines():
        kind, name, *rest = line.split("\t")
        if kind == "field":
            fields[name] = "\t".join(rest)
        elif name in public:
            definitions[f"{name}.{rest[0]}"] = "\t".join(rest[1:])
    return definitions, fields


# ---- rules: what later versions may change ---------------------------------------------------------------------------

def same(name, then, now):
    return [] if then == now else [f"{name} was {then} and is {now}"]


def narrower(what, then, now):
    """Ranges (lower, upper, allowed besides) may only grow; "-" has no bound in the table: the code checks it."""
    found = []
    for k, end in enumerate(("lower", "upper")):
        if "-" == now[k] or then[k] == "-":
            continue
        a, b = (float(text.strip("()")) for text in (then[k], now[k]))
        opened = now[k] != now[k].strip("()") and then[k] == then[k].strip("()")
        if (b > a if k == 0 else b < a) or (a == b and opened):
            found.append(f"{what}: the {end} end of its range was {then[k]} and is {now[k]}, which is narrower")
    return found


def same_definition(name, then, now):
    then, now, found = then.split("\t"), now.split("\t"), []
    for k, what in ((0, "type"), (1, "count"), (2, "unit"), (6, "default")):
        if then[k] != now[k]:
            found.append(f"{name}: its {what} was {then[k]} and is {now[k]}")
    found += narrower(name, then[3:5], now[3:5])
    if set(then[5].split()) - set(now[5].split()) - {"needed"} or "needed" in set(now[5].split()) - set(then[5].split()):
        found.append(f"{name}: allowed besides the range was '{then[5]}' and is '{now[5]}'")
    if then[7] and now[7]:
        former, present = (text.split(":")[-1].split("|") for text in (then[7], now[7]))
        lost = [c for k, c in enumerate(former) if c and (k >= len(present) or present[k] != c)]
        found += [f"{name}: the choice {', '.join(lost)} is gone or has another number"] if lost else []
    return found


def same_field(name, then, now):
    then, now = then.split("\t"), now.split("\t")
    found = [f"field '{name}': its {what} was {then[k]} and is {now[k]}"
             for k, what in enumerate(("type", "number of components in 2D", "number of components in 3D", "unit")) if then[k] != now[k]]
    if then[6] != now[6]:
        found.append(f"field '{name}': its first release was {then[6]} and is {now[6]}")
    return found + narrower(f"field '{name}'", then[4:6], now[4:6])


def new_fields(then, now, release):
    """A field that the release lacks has a later one."""
    number = lambda text: [int(part) for part in text.split(".")]  # noqa: E731
    return [f"field '{name}' is not in {release}, and its first release is {value.split(chr(9))[6]}"
            for name, value in now.items() if name not in then and number(value.split("\t")[6]) <= number(release)]


def same_status(name, then, now):
    if then == now or (now == "OK" and then.startswith("ERROR_")):
        return []  # what was refused may be allowed later
    return [f"{name} gave {then} and gives {now}"]


def same_numbers(name, then, now):
    a, b = ([float(x) for x in text.split()] for text in (then, now))
    if len(a) != len(b):
        return [f"{name}: {len(a)} numbers were printed and {len(b)} are"]
    scale = max((abs(x) for x in a), default=0.0)
    worst = max(range(len(a)), key=lambda k: abs(a[k] - b[k]), default=0)
    if a and not abs(a[worst] - b[worst]) <= CLOSE * scale:
        return [f"{name}: number {worst + 1} was {a[worst]:.12g} and is {b[worst]:.12g}, of up to {scale:.3g}"]
    return []


def compare(kind, then, now, rule):
    """The differences between a table of a release and today's, in words; additions are free."""
    found = []
    for name, value in then.items():
        found += rule(name, value, now[name]) if name in now else [f"{name} is missing"]
    added = [name for name in now if name not in then]
    print(f"{kind}: {len(then)} lines, {len(found)} differences, {len(added)} additions")
    return found


def same_program(name, then, now):
    """Two outputs of a program: words as they are, numbers by column."""
    number = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?$")
    a, b = ([re.split(r"[,;\s]+", line.strip()) for line in text.splitlines()] for text in (then, now))
    if [len(row) for row in a] != [len(row) for row in b]:
        return [f"{name}: {len(a)} lines were written and {len(b)} are, or with other columns"]
    largest = {}
    for row in a:
        for c, cell in enumerate(row):
            if number.match(cell):
                largest[c, len(row)] = max(largest.get((c, len(row)), 0.0), abs(float(cell)))
    for k, (before, after) in enumerate(zip(a, b)):
        for c, (x, y) in enumerate(zip(before, after)):
            if number.match(x) and number.match(y):
                if abs(float(x) - float(y)) <= PROGRAMS_CLOSE * largest[c, len(before)] + 1e-9:
                    continue
            elif x == y:
                continue
            return [f"{name}, line {k + 1}: was {' '.join(before)} and is {' '.join(after)}"]
    return []


# ---- binaries --------------------------------------------------------------------------------------------------------

def environment(library):
    return {**os.environ, "LD_LIBRARY_PATH": str(library.parent), "LD_BIND_NOW": "1", "OPENBLAS_NUM_THREADS": "1",
            "OMP_NUM_THREADS": "1"}


def loads(program, library):
    """Whether the program runs with this library and no other."""
    found = run(["ldd", program], env=environment(library))
    if str(library.parent) not in found:
        raise SystemExit(f"{program.name} does not load {library}:\n{found}")


def link(objects, library, out, cc="gcc", more=()):
    run([cc, "-o", out, *objects, library, *more, *SYSTEM])
    loads(out, library)
    return out


def printed(program, arguments, library, scratch):
    folder = scratch / "run"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    return run([program, *arguments], env=environment(library), cwd=folder)


def table_of(program, arguments, library, scratch, separator):
    return lines(printed(program, arguments, library, scratch), separator)


def compile_object(source, scratch, include, prefix="", options=(), cc="gcc", standard="-std=gnu11"):
    out = scratch / f"{prefix}{source.stem}.o"
    run([cc, standard, "-O1", "-fPIC", *options, "-I", include, "-I", HERE, "-I", scratch, "-c", source, "-o", out])
    return out


def experimental_calls(binary):
    used = set(re.findall(r" U (mps_\w+)", run(["nm", binary])))
    return sorted(used - set(stable()))


# ---- the folder of a release -----------------------------------------------------------------------------------------

def write_archive(path, files):
    """A tar archive that depends on the contents alone."""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w", format=tarfile.USTAR_FORMAT) as tar:
        for name, data in sorted(files.items()):
            info = tarfile.TarInfo(name)
            info.size, info.mode, info.mtime = len(data), 0o755 if name.startswith("bin/") else 0o644, 0
            tar.addfile(info, io.BytesIO(data))
    path.write_bytes(lzma.compress(buffer.getvalue(), preset=9))


def open_archive(folder, scratch):
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    with tarfile.open(folder / "binaries.tar.xz") as tar:
        tar.extractall(scratch, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    return scratch


def write_table(path, table, separator):
    path.write_text("".join(f"{name}{separator}{value}\n" for name, value in table.items()))


def read_table(path, separator):
    return lines(path.read_text(), separator)
