"""What the tables of definitions (src/core/definition) and of units (programs/common/units.c) say: of each member of a
definition its unit, its default and the names that it may have."""

import re

LINE = re.compile(r'X\(S,\s*(\w+),\s*(\w+),\s*(\w+),\s*"([^"]*)",\s*(.*),\s*([^,]+?),\s*(?:SAME|OWN)\)')
TABLE = re.compile(r"^#define (\w+)\(X, S\)(.*?[^\\])$", re.M | re.S)
DEFINITION = re.compile(r'^MPSI_DEFINITION(?:_RULED)?\((mps_\w+), "\w+", (\w+)', re.M)
CHOICES = re.compile(r'ONE_OF\((MPS_\w+), "([^"]*)"\)')


def number(text):
    """A default as a number; None: the library finds it, or the caller has to give it."""
    text = text.strip()
    if text == "INFINITY" or text == "-INFINITY":
        return float(text.lower().replace("infinity", "inf"))
    try:
        return int(text)
    except ValueError:
        pass
    try:
        return float(text)
    except ValueError:
        return None


def default(kind, count, rule, value):
    """The default as Python has it: of an array all its numbers, of a choice between no and yes a truth."""
    if "YES_NO" in rule:
        return bool(value)
    if value is None or kind not in ("INT", "BITS", "LONG", "REAL"):
        return None
    value = float(value) if kind == "REAL" else value
    if not count.isdigit() or count == "1":
        return value
    axis = re.search(r"OF_AXIS\((\d)\)", rule)
    return tuple(value if not axis or k == int(axis[1]) else 0.0 for k in range(int(count)))


def members(root):
    """{struct: {member: (unit, default, prefix of its constants, their names)}}"""
    found = {}
    for path in sorted((root / "src/core/definition").glob("*.c")):
        text = path.read_text()
        tables = {name: rows for name, rows in TABLE.findall(text)}
        for struct, table in DEFINITION.findall(text):
            found[struct] = {}
            for kind, member, count, unit, rule, initial in LINE.findall(tables.get(table, "")):
                choices = CHOICES.search(rule)
                names = tuple(choices[2].split("|")) if choices else ()
                found[struct][member] = (unit, default(kind, count, rule, number(initial)), choices[1] if choices else "", names)
    return found


def units(root):
    """{unit of the library: (what it measures, {unit that may be written: factor})}"""
    text = (root / "programs/common/units.c").read_text()
    values = {name: float(value) for name, value in re.findall(r"^#define (\w+) +([\d.]+)", text, re.M)}
    found = {}
    for what, listed in re.findall(r'\{"(an? [\w ]+)",\s*\d+,\s*\{(.*?)\}\}', text, re.S):
        rows = {name: float(eval(factor, {"__builtins__": {}}, values))  # products and quotients of numbers and macros
                for name, factor in re.findall(r'\{"([^"]+)",\s*([^{}]+)', listed)}
        found[next(iter(rows))] = (what, rows)
    what, rows = found.pop("degrees")  # the programs count angles in degrees, the library in radians
    found["rad"] = (what, {name: factor / rows["rad"] for name, factor in rows.items()})
    return found
