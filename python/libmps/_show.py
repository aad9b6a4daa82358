"""What an object is, in a line of text and as a table of a notebook: looked up in the library, never kept."""

from html import escape

import numpy

from ._library import ffi, library


def _ask(owner, function, *values):
    return getattr(library, f"mps_{owner._kind}_{function}")(owner._pointer, *values)


def _many(number, word):
    return f"{number} {word}{'' if number == 1 else 's'}"


def _solver(owner):
    particles = library.mps_particles_count(_ask(owner, "particles"))
    return [_many(particles, "particle"), f"t = {_ask(owner, 'time'):.6g} s", _many(_ask(owner, "steps"), "step")]


def _particles(owner):
    count, dim = _ask(owner, "count"), _ask(owner, "dim")
    return [f"{_many(count, 'particle')} in {dim}D", f"spacing {_ask(owner, 'spacing'):.6g} m",
            "fields " + ", ".join(name for name, _, _ in fields(owner))]


def _context(owner):
    return [f"libmps {ffi.string(library.mps_version()).decode()}", _many(_ask(owner, "threads"), "thread")]


def _material(owner):
    return [ffi.string(_ask(owner, "name")).decode()]


def _body(owner):
    return [f"{_ask(owner, 'dim')}D"]


def _kernel(owner):
    return [f"radius {_ask(owner, 'radius'):.6g} m"]


def _recorder(owner):
    return [_many(_ask(owner, "frames"), "frame")]


def _domain(owner):
    return [f"rank {_ask(owner, 'rank')} of {_ask(owner, 'size')}"]


FACTS = {"particles": _particles, "mpm": _solver, "dynamics": _solver, "fluid": _solver, "elastic": _solver,
         "context": _context, "material": _material, "body": _body, "kernel": _kernel,
         "recorder": _recorder, "domain": _domain}


def fields(owner):
    """(name, unit, meaning) of each field of a set."""
    info = ffi.new("mps_particles_field_info *")
    found = []
    for k in range(_ask(owner, "field_count")):
        if library.mps_particles_get_field_info_sized(owner._pointer, k, info, ffi.sizeof(info[0])) == 0:
            found.append(tuple(ffi.string(text).decode() if text else ""
                               for text in (info.name, info.unit, info.meaning)))
    return found


def text(owner):
    name = type(owner).__name__
    if owner._pointer is None or owner.context._pointer is None:
        return f"<libmps {name}, closed>"
    facts = FACTS.get(owner._kind, lambda _owner: [])(owner)
    return f"<libmps {name}{': ' if facts else ''}{', '.join(facts)}>"


def table(rows, head):
    cells = ["<tr>" + "".join(f"<th>{escape(h)}</th>" for h in head) + "</tr>"]
    cells += ["<tr>" + "".join(f"<td style='text-align:left'>{escape(str(c))}</td>" for c in row) + "</tr>"
              for row in rows]
    return f"<table>{''.join(cells)}</table>"


def html(owner):
    """A set shows its fields with units and ranges; other objects their line."""
    line = f"<p>{escape(text(owner)[1:-1])}</p>"
    if owner._kind != "particles" or owner._pointer is None or owner.context._pointer is None:
        return line
    rows = []
    for name, unit, meaning in fields(owner):
        values = numpy.array(owner[name])
        limits = f"{values.min():.6g} to {values.max():.6g}" if values.size else ""
        rows.append((name, unit, limits, meaning))
    line = f"<p>{escape(', '.join(_particles(owner)[:2]))}</p>"
    return line + table(rows, ("field", "unit", "range", "meaning"))


def _value(value):
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, numpy.ndarray):
        return numpy.array2string(value, precision=6, threshold=12)
    return str(value)


def result(struct):
    """A struct of results, a row for each of its members."""
    rows = [(name, _value(value)) for name, value in vars(struct).items()
            if name not in ("struct_size", "reserved") and not isinstance(value, ffi.CData)]
    return f"<p>{escape(type(struct).__name__)}</p>" + table(rows, ("member", "value"))
