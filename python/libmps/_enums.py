"""Enumerations of the library: classes with the names of C without their prefix, and names as texts."""

import difflib
import enum
import re

from . import _tables
from ._errors import ArgumentError
from ._library import library

_made = {}


def enumeration(name):
    """The class of an enumeration, made when it is first asked for."""
    found = _made.get(name)
    if found is None:
        kind, prefix, names, text = _tables.ENUMS[name]
        rows = {}
        for word in names:
            short = word.removeprefix(prefix).removeprefix("ERROR_")
            rows["_" + short if short[0].isdigit() else short] = getattr(library, word)
        found = _made[name] = getattr(enum, kind)(name, rows, module="libmps")
        found.__doc__ = text or found.__doc__
    return found


def _plain(text):
    return re.sub(r"[\s-]+", "_", text.strip()).upper()


def _member(kind, word, text, allowed):
    found = kind.__members__.get(_plain(text))
    if found is not None and (not allowed or found.name.lower() in allowed):
        return found
    known = list(allowed) or [n.lower() for n in kind.__members__]
    near = difflib.get_close_matches(_plain(text).lower(), known, 1)
    raise ArgumentError(f"{word!r} is {text!r}, must be one of {', '.join(known)}{f' (is it {near[0]!r}?)' if near else ''}")


def number(name, word, value, allowed=()):
    """The number of a name of an enumeration; flags may be several names ("x y", "xy", ["x", "y"]). A number stays."""
    kind = enumeration(name)
    flags = issubclass(kind, enum.IntFlag)
    if isinstance(value, str):
        if not flags:
            return int(_member(kind, word, value, allowed))
        parts = re.split(r"[\s,|+]+", value.strip())
        if len(parts) == 1 and _plain(value) not in kind.__members__ and all(c.upper() in kind.__members__ for c in value):
            parts = list(value)
        value = parts
    if flags and isinstance(value, (list, tuple, set, frozenset)):
        made = 0
        for part in value:
            made |= int(_member(kind, word, part, allowed)) if isinstance(part, str) else int(part)
        return made
    return value


def named(name, value):
    """A number of C as a member of its enumeration, where it is one."""
    try:
        return enumeration(name)(value)
    except ValueError:
        return value
