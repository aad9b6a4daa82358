"""Constitutive laws compiled by numba: they run without Python's lock, on all threads of a step, at the speed of C.

    from libmps import compiled

    @compiled.law
    def elastic(dt, gradient, stress, volume_ratio, history):
        for k in range(len(volume_ratio)):
            ...
            stress[0][k] += ...

    material = UserMaterial(update=elastic, name="elastic", bulk_modulus=K, shear_modulus=G)

Other callbacks may be numba.cfunc of the C type (mps/*.h); the package takes their address.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
from numba import carray, cfunc, njit, types
from numba.core import cgutils
from numba.extending import intrinsic

from ._library import ffi, library

_KIND = ffi.typeof("mps_material_block")
#: Place of each member in words of eight bytes.
_AT = {name: field.offset // 8 for name, field in _KIND.fields}
_WORDS = ffi.sizeof("mps_material_block") // 8
_COUNT, _DT, _GRADIENT, _STRESS = _AT["count"], _AT["dt"], _AT["gradient"], _AT["stress"]
_RATIO, _HISTORY, _REFUSED = _AT["volume_ratio"], _AT["history"], _AT["refused"]
_FAILED = int(library.MPS_ERROR_NUMERIC)


@intrinsic
def _pointer(_context, _address):
    """An address as a pointer."""
    def generate(_context, builder, _signature, arguments):
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), generate


@njit
def _column(address, count):
    """The `count` numbers at an address; none where it is NULL."""
    return carray(_pointer(address), (count if address else 0,), numba.float64)


@njit
def _place(words, count, k):
    return _column(words[k], count)


def law(update: Callable[..., Any] | None = None, *, history: int = 0) -> Any:
    """Decorator: a constitutive law as a compiled callback for UserMaterial.

    update(dt, gradient, stress, volume_ratio, history) is called with a block of n particles: dt in s; `gradient`,
    nine arrays of n, dv_i/dx_j in 1/s, row by row; `stress`, six arrays of n, Cauchy stress in Pa (xx, yy, zz, xy, zx, yz), to be written;
    `volume_ratio`, V/V0; `history`, as many arrays as `history` says, to be written. Arrays that the dimension does
    not have are empty (in plane strain also gradient[8]). It returns nothing, or the number of the particle in the
    block at which it fails, which ends the step with NumericError. It must not raise: numba has no way to carry an
    exception out of a callback."""
    if update is None:
        return lambda function: law(function, history=history)
    inner = njit(update)

    @njit
    def answer(found):
        return -1 if found is None else found

    source = f"""
def called(_user, block):
    words = carray(_pointer(block), ({_WORDS},), int64)
    reals = carray(_pointer(block), ({_WORDS},), float64)
    n = words[{_COUNT}]
    gradient = ({', '.join(f'_place(words, n, {_GRADIENT + c})' for c in range(9))},)
    stress = ({', '.join(f'_place(words, n, {_STRESS + c})' for c in range(6))},)
    columns = carray(_pointer(words[{_HISTORY}]), ({history},), int64)
    history = ({''.join(f'_column(columns[{c}], n),' for c in range(history))})
    failed = answer(inner(reals[{_DT}], gradient, stress, _place(words, n, {_RATIO}), history))
    if failed < 0:
        return 0
    if words[{_REFUSED}]:
        carray(_pointer(words[{_REFUSED}]), (1,), int64)[0] = failed
    return {_FAILED}
"""
    names = {"carray": carray, "_pointer": _pointer, "_place": _place, "_column": _column, "int64": numba.int64,
             "float64": numba.float64, "inner": inner, "answer": answer}
    exec(source, names)  # unrolled: tuples of a fixed length
    return cfunc(types.int32(types.int64, types.int64))(names["called"])
