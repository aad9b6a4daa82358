"""Pages of the public headers: one reStructuredText page for each, with every declaration and its comment.

A header begins with one comment, which is the page's introduction. A comment /** */ belongs to the declaration
behind it, a comment behind a member or enumerator (or before it) to that. Structs, enumerations, callbacks,
functions, inline functions and constants become entries of Sphinx's C domain, so that search, index and links
know them.
"""

import re
import textwrap

TOKEN = re.compile(r"""
    (?P<comment>/\*.*?\*/)
  | (?P<macro>^\#(?:[^\n\\]|\\\n|\\.)*$)
  | (?P<struct>typedef\s+(?:struct|enum|union)\s+\w+\s*\{)
  | (?P<enum>enum\s*\{)
  | (?P<inline>static\s+inline\s[^{};]*\{)
  | (?P<skip>MPS_EXTERN_C_(?:BEGIN|END)|extern\s+"C"\s*\{)
  | (?P<declaration>[A-Za-z_][^;{}]*;)
""", re.X | re.M | re.S)
MARKS = r"\b(?:MPS_API|MPS_PETSC_API|MPS_NODISCARD|MPS_DEPRECATED\(\d+, \d+,\s*\"[^\"]*\"\))(?!\w)\s*"


def plain(comment):
    """A comment's text, without its frame of stars."""
    text = re.sub(r"^/\*+|\*+/$", "", comment.strip())
    lines = [re.sub(r"^\s*\* ?", "", line) for line in text.splitlines()]
    first, rest = lines[:1], textwrap.dedent("\n".join(lines[1:])).splitlines()
    return "\n".join([*(line.strip() for line in first), *rest]).strip("\n ")


def tidy(text):
    """A declaration on one line."""
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
    return re.sub(r"\s+", " ", text).replace("( ", "(").strip(" ;")


class Entry:
    """A declaration: its kind in the C domain, its signature, comment, members and line."""

    def __init__(self, kind, name, signature, comment, line, members=()):
        self.kind, self.name, self.signature, self.comment = kind, name, signature, comment
        self.line, self.members = line, list(members)


def closing(text, start):
    """The place behind the brace that closes the one before `start`."""
    depth = 1
    for match in re.compile(r"/\*.*?\*/|[{}]", re.S).finditer(text, start):
        depth += {"{": 1, "}": -1}.get(match[0], 0)
        if depth == 0:
            return match.end()
    raise ValueError("a brace is not closed")


def declared(text):
    """The name that a declaration declares."""
    pointer = re.search(r"\(\s*\*\s*(\w+)\s*\)\s*\(", text)
    if pointer:
        return pointer[1]
    head = re.sub(r"\[[^\]]*\]", "", text.split("(")[0])
    return re.findall(r"\w+", head)[-1]


def table_entries(line, tables):
    """The enumerators that a macro for rows of a table makes: [name, declaration, comment]."""
    match = re.match(r"#define (MPS_\w+)_ENTRY\(.*?\) (MPS_\w*?)##", line)
    rows = tables.get(match[1], {}) if match else {}
    return [[match[2] + name, f"{match[2]}{name} = {value}", f"{text[:1].upper()}{text[1:]}."] for name, (value, text) in rows.items()]


def members_of(body, enum, tables):
    """(name, declaration, comment) of each member or enumerator. Members on one line share the comment behind them."""
    end = "," if enum else ";"
    found, group, before, text = [], [], "", ""

    def finish():
        nonlocal group, before, text
        said = re.sub(r"^(?:MPS_\w+_TABLE\(\w+\)\s*|MPS_STATUS_FORCE.*)", "", tidy(text)).strip()
        text = ""
        if re.search(r"\w", said):
            parts = [said] if enum else split_members(said)
            group = [[re.match(r"\w+", p)[0] if enum else declared(p), p, before] for p in parts]
            found.extend(group)
        before = ""

    for match in re.finditer(r"/\*.*?\*/|\#[^\n]*|" + end + r"|\n|[^/#\n" + end + r"]+|/", body, re.S):
        piece = match[0]
        if piece.startswith("/*"):
            if enum and text.strip():  # the last enumerator has no comma
                finish()
            line = body[body.rfind("\n", 0, match.start()) + 1:match.start()]
            if piece.startswith("/**") or not line.strip() or not group:
                before = plain(piece)
            else:
                for member in group:
                    member[2] = (member[2] + " " + plain(piece)).strip()
        elif piece.startswith("#"):
            found += table_entries(piece, tables)
        elif piece == end:
            finish()
        elif piece == "\n":
            text += " "
        else:
            text += piece
    finish()
    return [tuple(member) for member in found]


def split_members(text):
    """`double mass, volume` as two declarations."""
    if "(" in text:
        return [text]
    names = [part.strip() for part in text.split(",")]
    base = re.match(r"(.*?)(\**\s*\w+\s*(?:\[[^\]]*\])*)$", names[0])
    return [names[0]] + [base[1].rstrip("* ") + " " + other for other in names[1:]]


def inline_comment(name):
    """What an inline function without a comment of its own does: there are two kinds of these."""
    if name.endswith("_defaults"):
        return "The defaults by value, as `mps_def_init` fills them (inline)."
    return f"Calls `{name}_sized` with the size of the struct that this header declares (inline)."


def parse(text):
    """The introduction of a header and its entries."""
    tables = {}
    for name, body in re.findall(r"#define (MPS_\w+_TABLE)\(X\)((?:[^\n]*\\\n)*[^\n]*)", text):
        rows = re.findall(r'X\((\w+),\s*(\d+),\s*"([^"]*)"\)', body)
        tables[name.replace("_TABLE", "")] = {row[0]: (row[1], row[2]) for row in rows}
    introduction, entries, comment, place = None, [], "", 0
    while True:
        match = TOKEN.search(text, place)
        if not match:
            return introduction or "", entries
        line = text.count("\n", 0, match.start()) + 1
        place, kind, piece = match.end(), match.lastgroup, match[0]
        if kind == "comment":
            if introduction is None:
                introduction = plain(piece)
            comment = plain(piece) if piece.startswith("/**") else ""
            continue
        if kind == "macro":
            constant = re.match(r"#define (MPS_\w+)[ \t]+(\S[^\n]*)$", piece)
            if constant and "\\" not in piece and not re.search(r"_(H|API|NODISCARD|ENTRY|BEGIN|END)$", constant[1]):
                value, _, behind = constant[2].partition("/*")
                said = plain("/*" + behind) if behind else comment
                entries.append(Entry("macro", constant[1], f"{constant[1]}", f"Value: `{value.strip()}`. {said}".strip(), line))
            if piece.startswith("#define MPS_DOF") or not constant:
                continue
        elif kind in ("struct", "enum"):
            end = closing(text, match.end())
            body = text[match.end():end - 1]
            enum = "enum" in piece.split("{")[0]
            tail = re.match(r"\s*(\w*)\s*;", text[end:])
            place = end + tail.end()
            members = members_of(body, enum, tables)
            entries.append(Entry("enum" if enum else "struct", tail[1], tail[1], comment, line, members))
        elif kind == "inline":
            place = closing(text, match.end())
            signature = tidy(re.sub(r"static\s+inline\s+", "", piece[:-1]))
            name = declared(signature)
            if not comment:
                comment = inline_comment(name)
            entries.append(Entry("function", name, signature, comment, line))
        elif kind == "declaration":
            signature = tidy(re.sub(MARKS, "", piece))
            if signature.startswith("typedef"):
                signature = signature[len("typedef "):]
                opaque = re.fullmatch(r"struct (\w+) (\w+)", signature)
                name = opaque[2] if opaque else declared(signature)
                entries.append(Entry("type", name, name if opaque else signature, comment or ("Opaque handle." if opaque else ""), line))
            elif "(" in signature and signature.split("(")[0].split()[-1].lstrip("*").startswith("mps_"):
                entries.append(Entry("function", declared(signature), signature, comment, line))
        comment = ""


def pieces(text):
    """A comment in pieces, (code?, text): what stands in backticks, and names of the interface, are code."""
    for k, part in enumerate(text.split("`")):
        if k % 2:
            yield True, part
        else:
            for j, piece in enumerate(re.split(r"\b((?:mps|MPS)_\w+)", part)):
                yield bool(j % 2), piece


def escape(text):
    """Comment text as reStructuredText."""
    out = ""
    for code, piece in pieces(text):
        if code and piece.strip():
            joined = out and not re.search(r"[\s(\[{'\"/-]$", out)
            out += ("\\ " if joined else "") + f"``{piece.strip()}``"
        elif piece:
            glued = out.endswith("``") and re.match(r"[^\s.,:;!?'\")\]}/-]", piece)
            out += ("\\ " if glued else "") + re.sub(r"([\\*|_])", r"\\\1", piece)
    return out


def list_start(rows):
    """The first row of a list: behind a colon, or the first of its paragraph. A minus elsewhere is a minus."""
    for k, row in enumerate(rows):
        if re.match(r"\s*- ", row) and (k == 0 or rows[k - 1].rstrip().endswith(":")):
            return k
    return len(rows)


def paragraphs(text, indent):
    """A comment as paragraphs, lists and, where lines stand further in, literal blocks."""
    lines = []
    for block in re.split(r"\n\s*\n", text):
        rows = block.splitlines()
        if not block.strip():
            continue
        if len(rows) > 1 and all(row.startswith("  ") for row in rows) or (len(rows) == 1 and rows[0].startswith("    ")):
            lines += ["::", "", *["   " + row for row in textwrap.dedent(block).splitlines()], ""]
        else:
            first = list_start(rows)
            said = escape(" ".join(row.strip() for row in rows[:first]))
            lines += ["\\" + said if re.match(r"[-+*.#]|\w+[.)] ", said) and not said.startswith("\\") else said, ""]
            for row in rows[first:]:
                lines.append(("" if re.match(r"\s*- ", row) else "  ") + escape(row.strip()))
            lines.append("")
    return [" " * indent + line if line else "" for line in lines]


def summary(text):
    """The first sentence of a header's introduction."""
    said = plain(re.match(r"/\*.*?\*/", text, re.S)[0]).partition(" - ")[2].split("\n\n")[0]
    said = re.match(r".*?(?:\.(?=\s)|$)", " ".join(said.split()))[0]
    return escape(said[:1].upper() + said[1:])


def page(name, text, tables=None):
    """The page of the header `name`; `tables`: members of definitions (definitions.c), for a table of each."""
    introduction, entries = parse(text)
    introduction = re.sub(r"\s*SPDX-License-Identifier:.*", "", introduction)
    title, rest = f"mps/{name}", introduction.partition(" - ")[2]
    rest = rest[:1].upper() + rest[1:]
    lines = [title, "=" * len(title), "", *paragraphs(rest, 0)]
    groups = [("Types", ("type", "struct", "enum")), ("Functions", ("function",)), ("Constants", ("macro",))]
    for heading, kinds in groups:
        chosen = [entry for entry in entries if entry.kind in kinds]
        if chosen:
            lines += [heading, "-" * len(heading), ""]
        for entry in chosen:
            lines += directive(entry) + ranges((tables or {}).get(entry.name, []))
    return "\n".join(lines) + "\n", entries


def ranges(members):
    """What the library's own table says of each member of a definition, within its entry."""
    rows = [(f"``{name}``", unit, f"``{default}``", "; ".join(escape(said) for said in ([allowed] if allowed else []) + rules))
            for name, unit, default, allowed, rules in members if not name.startswith("reserved")]
    if not rows:
        return []
    lines = ["   .. list-table::", "      :header-rows: 1", ""]
    for row in [("member", "unit", "default", "allowed"), *rows]:
        lines += [f"      {'-' if k else '* -'} {cell}".replace("      -", "        -") for k, cell in enumerate(row)]
    return [*lines, ""]


def directive(entry):
    """An entry as directives of the C domain."""
    if entry.kind == "enum" and not entry.name:
        lines = [] if not entry.comment else paragraphs(entry.comment, 0)
        for name, text, comment in entry.members:
            lines += [f".. c:macro:: {name}", "", *paragraphs(f"Value: `{text.partition('=')[2].strip()}`. {comment}", 3)]
        return lines
    lines = [f".. c:{entry.kind}:: {entry.signature}", "", *paragraphs(entry.comment, 3)]
    for name, text, comment in entry.members:
        if entry.kind == "enum":
            lines += [f"   .. c:enumerator:: {text}", "      :no-contents-entry:", ""]
        else:
            lines += [f"   .. c:member:: {text}", "      :no-contents-entry:", ""]
        lines += paragraphs(comment, 6)
    return lines
