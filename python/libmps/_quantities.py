"""Numbers with a unit as texts: "10 MPa", "5mm", "30 deg". The units are those of the programs."""

import re

from . import _tables
from ._errors import ArgumentError

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?inf(?:inity)?|nan)\s*(.*?)\s*$", re.I)


def si(text, unit, word):
    """The number of a text in the unit of SI that the library takes."""
    found = _NUMBER.match(text)
    if not found:
        raise ArgumentError(f"{word!r} is {text!r}: a number{f' in {unit}' if unit else ''} is wanted, or a text such as "
                            f"{'1.5 ' + unit if unit else '1.5'!r}")
    value, given = float(found[1]), found[2]
    if not given or given == unit:
        return value
    what, units = _tables.UNITS.get(unit or "1", (None, {}))
    factor = units.get(given) if unit or given in ("%", "percent", "pct") else None
    if factor is None:
        wanted = (f"{what} is wanted ({', '.join(units)})" if unit and what else f"its unit is {unit}" if unit
                  else "a number without a unit is wanted")
        raise ArgumentError(f"{word!r} is {text!r}: {wanted}")
    return value * factor


def number(value, unit, word):
    """A text as a number of SI, also inside of lists; what is no text stays."""
    if isinstance(value, str):
        return si(value, unit, word)
    if isinstance(value, (list, tuple)):
        return [number(v, unit, word) for v in value]
    return value
