"""What the public C headers say: functions, structs, enumerations and callbacks, each with its comment.

The headers follow one form, which tests of the sources keep: a comment of its own before each function, a comment
behind (or a /** */ before) a member, `typedef struct mps_x {...} mps_x;`. What is found here becomes docstrings and
stubs (make_docs.py)."""

import re
from dataclasses import dataclass, field


@dataclass
class Name:
    """A parameter, member or constant: its C type and what its comment says of it."""

    name: str
    type: str
    text: str = ""


@dataclass
class Entry:
    """A function, callback, struct or enumeration."""

    name: str
    header: str
    text: str
    result: str = ""
    names: list = field(default_factory=list)


FUNCTION = re.compile(r"^MPS_API\s+(?:MPS_DEPRECATED\(\d+, \d+,\s*\"[^\"]*\"\)\s+)?(?:MPS_NODISCARD\s+)?([\w\s*]+?)\b(mps_\w+)\s*\(([^;]*?)\);", re.M)
#: Functions that all solvers share, under the name of one: inline over those of mps_solver.
INLINE = r"^(?:MPS_NODISCARD\s+)?static\s+inline\s+([\w\s*]+?)\b(mps_(\w+?)_(\w+))\s*\(([^;{]*?)\)\s*\{"
SHARED = re.compile(INLINE + r"(?:[^}]|\};)*?\bmps_solver_(?!get_def\b)\4\(", re.M)
#: The same of functions that take the kind of a definition, which the name of one says.
OF_KIND = re.compile(INLINE + r"\s*return (mps_solver_(?:add|set|remove|get|get_def))\(\s*(?:mps_\w+_solver\(\w+\)|\w+),"
                     r"\s*(MPS_DEF_\w+),", re.M)
CALLBACK = re.compile(r"^typedef\s+([\w\s*]+?)\s*\(\*(mps_\w+)\)\s*\(([^;]*?)\);", re.M)
BODY = re.compile(r"^typedef (struct|enum) mps_\w+ \{(.*?)^\} (mps_\w+);", re.M | re.S)
COMMENT = re.compile(r"/\*.*?\*/", re.S)
MACRO = re.compile(r"^#define (MPS_[A-Z0-9_]+) +(?:0x[0-9a-fA-F]+|[0-9]+)u? *(/\*.*?\*/)?$", re.M | re.S)
TABLE = re.compile(r"^#define MPS_\w+_TABLE\(X\)(.*?)^#define MPS_\w+_ENTRY\(name, value, text\) (MPS_\w*?)##name", re.M | re.S)
ROW = re.compile(r'X\((\w+), \d+, "(.*?)"\)')


def plain(comment):
    """The words of a comment on one line; paragraphs and indented lines stay apart."""
    lines = [re.sub(r"^\s*\*? ?", "", line) for line in re.sub(r"^/\*+|\*/$", "", comment).split("\n")]
    paragraphs, words = [], []
    for line in [*lines, ""]:
        if line.strip():
            words.append(line.strip())
        elif words:
            paragraphs.append(" ".join(words))
            words = []
    return "\n\n".join(paragraphs)


def before(text, place):
    """The /** */ comment that ends at `place`, as plain words."""
    head = text[:place].rstrip()
    start = head.rfind("/*") if head.endswith("*/") else -1
    return plain(head[start:]) if start >= 0 and head[start:].startswith("/**") else ""


def declared(words):
    """(name, type) of each declarator in "double a[3], b" or "void (*f)(int)"."""
    words = " ".join(words.split())
    pointer = re.match(r"(.*)\(\*(\w+)\)(\(.*\))$", words)
    if pointer:
        return [(pointer[2], f"{pointer[1].strip()} (*){pointer[3]}")]
    found = []
    for part in words.split(","):
        match = re.match(r"(.*?)([\s*]*)(\w+)\s*(\[.*\])?$", part.strip())
        base = match[1].strip() or found[-1][2]
        found.append((match[3], f"{base} {match[2].strip()}".strip() + (match[4] or ""), base))
    return [(name, kind) for name, kind, _ in found]


def parameters(listed):
    listed = COMMENT.sub("", listed).strip()
    parts = re.split(r",(?![^()]*\))", listed) if listed != "void" else []
    return [Name(name, kind) for part in parts for name, kind in declared(part)]


def members(body):
    """Members of a struct with their comments: one behind them, or a /** */ before."""
    found, ahead, last = [], "", []
    for comment, words in re.findall(r"(/\*.*?\*/)|([^;/]+;|[^;/]+)", body, re.S):
        if comment.startswith("/**"):
            ahead, last = plain(comment), []
        elif comment:
            for name in last:
                name.text = f"{name.text} {plain(comment)}".strip()
        elif not words.strip():
            last = [] if "\n" in words else last  # a comment on a line of its own is a heading
        elif words.strip().endswith(";"):
            last = [Name(name, kind, ahead) for name, kind in declared(words.strip()[:-1])]
            found += last
            ahead = ""
    return found


def constants(body):
    """Names of an enumeration with their comments."""
    return [Name(name, "int", plain(comment) if comment else "")
            for name, comment in re.findall(r"\b(MPS_\w+)\s*=[^,/}]*,?\s*(/\*.*?\*/)?", body, re.S)]


def macros(text):
    """Constants that are macros, and those of a table of names, numbers and texts."""
    found = [Name(name, "int", plain(comment) if comment else "") for name, comment in MACRO.findall(text)]
    return found + [Name(prefix + name, "int", words) for rows, prefix in TABLE.findall(text)
                    for name, words in ROW.findall(rows)]


def shared(text):
    """Those functions: (match, result, name, parameters, function of mps_solver, kind or ""). Results are sized, as
    exported."""
    for match in [*SHARED.finditer(text), *OF_KIND.finditer(text)]:
        of_kind = match.re is OF_KIND
        size = "_sized" if match[4].startswith("get_") else ""
        yield (match, match[1].strip(), match[2] + size, match[5] + (", size_t size" if size else ""),
               match[6] if of_kind else f"mps_solver_{match[4]}{size}", match[7] if of_kind else "")


def read(directory):
    """(functions, callbacks, structs, enumerations by name, constants outside of these), of all headers that mps.h
    and experimental.h include."""
    functions, callbacks, structs, enums, plain_constants = {}, {}, {}, {}, []
    included = [name for all_of in ("mps.h", "experimental.h")
                for name in re.findall(r'#include "([\w/]+\.h)"', (directory / all_of).read_text())]
    for header in included:
        text = (directory / header).read_text()
        for match in FUNCTION.finditer(text):
            functions[match[2]] = Entry(match[2], header, before(text, match.start()), match[1].strip(),
                                        parameters(match[3]))
        for match, result, name, listed, _, _ in shared(text):
            functions[name] = Entry(name, header, before(text, match.start()), result, parameters(listed))
        for match in CALLBACK.finditer(text):
            callbacks[match[2]] = Entry(match[2], header, before(text, match.start()), match[1].strip(),
                                        parameters(match[3]))
        for match in BODY.finditer(text):
            where, take = (structs, members) if match[1] == "struct" else (enums, constants)
            where[match[3]] = Entry(match[3], header, before(text, match.start()), "", take(match[2]))
        plain_constants += macros(text)
    return functions, callbacks, structs, enums, plain_constants
