"""libmps from Python: meshfree solid mechanics by the C library, through its public headers only.

    import libmps as mps

    context = mps.Context(threads=2)
    sand = context.particles_create(spacing=0.1)
    sand.fill_box([0, 0], [1, 1])
    sand.set("density", 0, 1800.0)
    law = context.material_create_linear_elastic(1e7, 0.3)
    solver = context.mpm_create(sand, law, cell=0.2, gravity=[0, -9.81, 0])
    solver.run(0.1, 10, lambda s: print(s.time()))
    print(sand["velocity"].mean(axis=0), solver.get_totals().kinetic)

Every function of the C headers is here: mps_mpm_step(mpm, 10) is solver.step(10), and a function
whose first argument is another object of the library is also a method of that object:
context.mpm_create(...). The C header says what it does. So much is different:

- a definition struct is given by keywords, its members; the rest are the defaults;
- what C returns through trailing pointers is returned: objects, numbers, structs of results;
- arrays are lists or NumPy arrays, of float64 or int64; where the function writes, NumPy arrays;
- a failed call raises Error with the text of the error record;
- a callback is a Python function, without C's `user`: arrays come as NumPy arrays, and what C has written
  through a pointer is returned; an exception in it ends the call and comes out;
- warnings of the library are Python's (MpsWarning), but where the context has a hook `log`.

A particle set gives its fields as NumPy arrays without a copy: sand["velocity"], for reading. They
raise StaleError once a solver has stepped, or particles were added, removed or sorted:
numpy.array(sand["velocity"]) is a copy that stays. To write:

    with sand.edit("velocity") as v:
        v[:, 0] = 1.0
"""

from . import _objects
from ._arrays import Edit, Field
from ._block import Block
from ._call import Error, MpsWarning, Result, StaleError, column, functions, library, results
from ._cdef import VERSION as __version__
from ._objects import Context, Object, Particles

_classes = {made.__name__: made for made in [*results.values(), *_objects.classes.values()]}
_free = [name for name in functions if name != "context_create" and
         not any(_objects.takes(kind, name) for kind in _objects.classes)]
__all__ = ["Block", "Context", "Edit", "Error", "Field", "MpsWarning", "Object", "Particles", "Result", "StaleError", "__version__", "column",
           "library", *_free]


def __getattr__(name):
    """Functions without an object (status_text, version), constants (DOF_X, MPM_GEOMETRY_SPACE), classes of objects
    and results (Mpm, Totals)."""
    from . import _call

    if name.startswith("_"):
        raise AttributeError(f"libmps has no {name!r}")
    if name in _classes:
        return _classes[name]
    found = _call.function_or_constant(name)
    return _objects.described(found, name, False) if name in _free else found


def __dir__():
    constants = [name[4:] for name in dir(library) if name.startswith("MPS_") and not name.startswith("MPS_DEF_")]
    return sorted({*__all__, *constants, *_classes})
