"""Writes the declarations of the C headers, without comments, macros and bodies, for cffi.

usage: make_cdef.py CC INCLUDE OUT

CC preprocesses INCLUDE/mps/mps.h. The result is a Python module with the text, the version and the SONAME.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path


def preprocessed(cc, include):
    """mps.h through the preprocessor, with empty system headers: cffi knows their types."""
    with tempfile.TemporaryDirectory() as empty:
        for name in ("stddef.h", "stdint.h", "string.h"):
            Path(empty, name).touch()
        command = [cc, "-E", "-P", "-nostdinc", "-U__GNUC__", "-U__clang__", "-I", empty,
                   "-I", str(include), str(include / "mps" / "mps.h")]
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


def constants(include):
    """Integers that macros name; enumerations are in the text already."""
    pattern = re.compile(r"^#define (MPS_[A-Z0-9_]+) +(0x[0-9a-fA-F]+|[0-9]+)u?(?: |$)", re.M)
    for header in sorted((include / "mps").glob("*.h")):
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


def main():
    cc, include, out = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    text = without_bodies(preprocessed(cc, include))
    text += "\n".join(constants(include)) + "\n"
    version = dict(re.findall(r"#define MPS_VERSION_(\w+) (\d+)", text))
    soname = f"libmps.so.{version['MAJOR']}.{version['MINOR']}"
    rows = "".join(f"    {name!r}: {names!r},\n" for name, names in parameters(text).items())
    number = ".".join(version[part] for part in ("MAJOR", "MINOR", "PATCH"))
    out.write_text(f'"""Written by make_cdef.py."""\n\nVERSION = {number!r}\nSONAME = {soname!r}\n'
                   f'PARAMETERS = {{\n{rows}}}\nTEXT = r"""\n{text}"""\n')


main()
