"""libmps from Python: meshfree solid mechanics by the C library, through its public headers only.

    import libmps as mps

    sand = mps.Particles(spacing="100 mm")
    sand.fill_box(lo=[0, 0], hi=[1, 1])
    sand["density"] = 1800
    law = mps.LinearElastic(young="10 MPa", poisson=0.3)
    solver = mps.Mpm(sand, law, cell=0.2, gravity=[0, -9.81, 0])
    solver.run(t_end=0.1, every=10, callback=lambda s: print(s.time))
    print(sand["velocity"].mean(axis=0), solver.totals.kinetic)

Every function of the C headers is here: mps_mpm_step(mpm, 10) is solver.step(10), and the C header says what it does.
So much is different:

- what a function of C creates is an object of a class: Mpm(...), MohrCoulomb(...), Disc(...). It belongs to
  default_context(), unless it is given `context=`, or an object of another context;
- arguments have their names in C, members of a definition are keywords; the rest have their defaults;
- lengths of arrays are not given; a selection of particles is ids=, box=(lower, upper) or all=True;
- a choice is a name, kind="frictional", or a member of its enumeration, BoundaryKind.FRICTIONAL;
- a quantity is a number in SI, or a text with a unit: "10 MPa", "5 mm", "30 deg";
- questions without arguments are properties: solver.time, solver.totals, body.state; solver.dt = 1e-3 sets;
- what C returns through trailing pointers is returned: objects, numbers, arrays, structs of results;
- a failed call raises an Error by its kind: ArgumentError (a ValueError), DivergedError, StateError ...;
- a callback is a Python function, without C's `user`: arrays come as NumPy arrays, and what C has written
  through a pointer is returned; an exception in it ends the call and comes out;
- warnings of the library are Python's (libmps.Warning), but where the context has a hook `log`.

A particle set gives its fields as NumPy arrays without a copy: sand["velocity"], for reading. They
raise StaleError once a solver has stepped, or particles were added, removed or sorted:
numpy.array(sand["velocity"]) is a copy that stays. To write:

    sand["velocity"] = [1, 0]
    with sand.edit("velocity") as v:
        v[:, 0] += 1.0
"""

from . import _errors, _objects, _tables
from ._arrays import Edit, Field
from ._block import Block
from ._call import Result, column, functions, results
from ._cdef import VERSION as __version__
from ._enums import enumeration
from ._errors import Error, StaleError, Warning  # noqa: F401 (a name of the package)
from ._library import library
from ._objects import Context, FieldInfo, Object, Particles, default_context

_classes = {made.__name__: made for made in [*results.values(), *_objects.classes.values(), *_objects.ways.values(),
                                             *_errors.KINDS.values()]}
_free = {function.word: function for function in functions.values() if function.form == "function"}
_constants = tuple(name.removeprefix("MPS_") for name in _tables.CONSTANTS)
#: All but Warning, which is a name of Python's own.
__all__ = ["Block", "Context", "Edit", "Error", "Field", "FieldInfo", "Object", "Particles", "Result", "StaleError", "__version__",
           "column", "default_context", "library", *_classes, *_tables.ENUMS, *_free, *_constants]


def __getattr__(name):
    """Classes of objects, results and enumerations, functions without an object, constants."""
    if name in _classes:
        found = _classes[name]
    elif name in _free:
        found = _objects.free(_free[name])
    elif name in _tables.ENUMS:
        found = enumeration(name)
    elif name in _constants:
        found = getattr(library, f"MPS_{name}")
    else:
        raise AttributeError(f"libmps has no {name!r}")
    globals()[name] = found
    return found


def __dir__():
    return sorted({*__all__, "Warning"})
