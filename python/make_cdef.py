"""Writes the declarations of the C headers, without comments, macros and bodies, as cffi reads them: parsed when the package is
built, so that its import needs no parser.

usage: make_cdef.py CC INCLUDE OUT

CC preprocesses INCLUDE/mps/mps.h and experimental.h. Written are OUT/_ffi.py, cffi's module without a compiled part, and
OUT/_cdef.py: the version, the SONAME, names of parameters, callbacks.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

import cffi

import headers


def preprocessed(cc, include):
    """The headers through the preprocessor, with empty system headers: cffi knows their types."""
    with tempfile.TemporaryDirectory() as empty:
        for name in ("stddef.h", "stdint.h", "string.h"):
            Path(empty, name).touch()
        source = Path(empty, "all.h")
        source.write_text("#define MPS_EXPERIMENTAL\n#include <mps/mps.h>\n#include <mps/experimental.h>\n")
        command = [cc, "-E", "-P", "-nostdinc", "-U__GNUC__", "-U__clang__", "-I", empty, "-I", str(include), str(source)]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def without_bodies(text):
    """Inline functions only shorten what other functions do: the package has its own."""
    kept = []
    while True:
        start = text.find("static inline")
        if start < 0:
            return "".join(kept) + text
        kept.append(text[:start])
        end = text.index("{", start) + 1
        depth = 1
        while depth > 0:
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        text = text[end:]


def shared(include):
    """Functions that all solvers share: their declarations under the name of one, each with a type shared_<name>, and which
    function of mps_solver each is, and the kind of definition that it takes first, or ""."""
    text, table = "", {}
    for header in sorted((include / "mps").glob("*.h")):
        for _, result, name, listed, target, kind in headers.shared(header.read_text()):
            listed = " ".join(listed.split())
            text += f"{result} {name}({listed});\ntypedef {result} (*shared_{name})({listed});\n"
            table[name] = (target, kind)
    return text, table


def constants(include):
    """Integers that macros name; enumerations are in the text already."""
    pattern = re.compile(r"^#define (MPS_[A-Z0-9_]+) +(0x[0-9a-fA-F]+|[0-9]+)u?(?: |$)", re.M)
    for header in sorted((include / "mps").rglob("*.h")):
        for name, value in pattern.findall(header.read_text()):
            yield f"#define {name} {value}"


def parameters(text):
    """The names of each function's parameters, "const" before those that it only reads: the types
    are in the text, but cffi keeps neither names nor const."""
    table = {}
    for name, listed in re.findall(r"(mps_\w+)\(([^()]*)\);", text):
        names = []
        for parameter in listed.split(","):
            words = re.findall(r"\w+", parameter.split("[")[0])
            if words != ["void"]:
                names.append(("const " if words[0] == "const" else "") + words[-1])
        table[name] = tuple(names)
    return table


def callbacks(text):
    """The names of the parameters of each callback type, and the type of each parameter and member that is one."""
    types = {name: tuple(re.findall(r"\w+", parameter.split("[")[0])[-1] for parameter in listed.split(","))
             for name, listed in re.findall(r"typedef [\w ]+[ *]\(\*(mps_\w+_fn)\)\(([^()]*)\);", text)}
    places = {}
    for name, listed in re.findall(r"(mps_\w+)\(([^()]*)\);", text):
        places.update({(name, word): kind for kind, word in re.findall(r"(mps_\w+_fn) (\w+)", listed)})
    for body, name in re.findall(r"typedef struct mps_\w+ \{(.*?)\} (mps_\w+);", text, re.S):
        places.update({(name, word): kind for kind, word in re.findall(r"(mps_\w+_fn)\s+(\w+);", body)})
    return types, places


def main():
    cc, include, out = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    declared, inline = shared(include)
    text = without_bodies(preprocessed(cc, include)) + declared
    text += "\n".join(constants(include)) + "\n"
    version = dict(re.findall(r"#define MPS_VERSION_(\w+) (\d+)", text))
    suffix = re.search(r'#define MPS_VERSION_SUFFIX "([^"]*)"', (include / "mps/base.h").read_text())[1]
    soname = f"libmps.so.{version['MAJOR']}"
    rows = "".join(f"    {name!r}: {names!r},\n" for name, names in parameters(text).items())
    types, places = (f"{{\n{''.join(f'    {key!r}: {value!r},' + chr(10) for key, value in table.items())}}}"
                     for table in callbacks(text))
    number = ".".join(version[part] for part in ("MAJOR", "MINOR", "PATCH")) + suffix
    (out / "_cdef.py").write_text(f'"""Written by make_cdef.py."""\n\nVERSION = {number!r}\nSONAME = {soname!r}\n'
                                  f'PARAMETERS = {{\n{rows}}}\nSHARED = {inline!r}\nCALLBACKS = {types}\nPLACES = {places}\n')
    ffi = cffi.FFI()
    ffi.cdef(text)
    ffi.set_source("libmps._ffi", None)
    ffi.emit_python_code(str(out / "_ffi.py"))


if __name__ == "__main__":
    main()
