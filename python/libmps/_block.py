"""The particles that a law in Python is called with, as arrays: copies that C takes back when the law returns, so
that none can outlive its memory."""

import numpy

from ._errors import StaleError
from ._library import ffi

#: Columns of the stress: xx, yy, zz, xy in 2D, and zx, yz besides in 3D (mps/material.h).
STRESSES = {2: 4, 3: 6}


class Block:
    """A block of particles: what a law reads and writes. n is `count`.

    dim, count, dt (s), time (s, at the end of the step)
    gradient      (9, n): velocity gradient, row 3 i + j has dv_i/dx_j, 1/s; zero where it is none, as zz in
                  plane strain
    stress        (4, n) or (6, n): Cauchy stress, Pa, xx, yy, zz, xy (zx, yz), to be written
    volume_ratio  (n,): V/V0, at the end of the step
    deformation   (9, n): deformation gradient, likewise, or None for a law that did not ask for it
    history       (history_count, n): to be written
    flags         (n,) of int64: MATERIAL_... bits, to be written
    ids, position (dim, n), temperature (n,) or None: of the particles

    Write into the arrays, or assign: block.stress[0] += ..., block.stress = ... An exception ends the step. Arrays
    may be kept; a block that is kept gives no others after its law has returned (StaleError)."""

    _WRITTEN = ("stress", "volume_ratio", "deformation", "history", "flags")

    def __init__(self, pointer):
        self._struct = c = pointer[0]
        self.dim, self.count, self.dt, self.time = c.dim, c.count, c.dt, c.time
        self._taken = {}  # arrays by name, with the pointers that they came from

    def _take(self, name, pointers_of, dtype=numpy.float64):
        """The array `name`, copied from the pointers that `pointers_of` finds in the struct of C."""
        found = self._taken.get(name)
        if found is None:
            pointers = pointers_of(self._c)
            made = numpy.zeros((len(pointers), self.count), dtype)
            for row, pointer in zip(made, pointers):
                if pointer:
                    ffi.memmove(row, pointer, 8 * self.count)
            found = self._taken[name] = (made, pointers)
        return found[0]

    def _take_if(self, name, pointers_of, dtype=numpy.float64):
        """As _take; None where C has no such array."""
        if name not in self._taken and not pointers_of(self._c)[0]:
            return None
        return self._take(name, pointers_of, dtype)

    @property
    def _c(self):
        """The struct of C, which is there for the duration of the law."""
        if self._struct is None:
            raise StaleError("the law has returned, and the block has gone: keep copies of its arrays")
        return self._struct

    def _end(self):
        """The law has returned, or raised: C's memory is not looked at any more."""
        self._struct = None

    def _write(self):
        """What the law has written goes back to C."""
        for name in self._WRITTEN:
            made, pointers = self._taken.get(name, ((), ()))
            for row, pointer in zip(made, pointers):
                if pointer:
                    ffi.memmove(pointer, row, 8 * self.count)

    def _assign(self, name, value):
        self._c  # an array that was taken would receive what C never reads
        getattr(self, name)[...] = value

    @property
    def gradient(self):
        return self._take("gradient", lambda c: list(c.gradient))

    @property
    def deformation(self):
        return self._take_if("deformation", lambda c: list(c.deformation))

    @property
    def stress(self):
        return self._take("stress", lambda c: list(c.stress)[:STRESSES[self.dim]])

    @stress.setter
    def stress(self, value):
        self._assign("stress", value)

    @property
    def history(self):
        return self._take("history", lambda c: [c.history[k] for k in range(c.history_count)])

    @history.setter
    def history(self, value):
        self._assign("history", value)

    @property
    def volume_ratio(self):
        return self._take("volume_ratio", lambda c: [c.volume_ratio])[0]

    @volume_ratio.setter
    def volume_ratio(self, value):
        self._assign("volume_ratio", value)

    @property
    def flags(self):
        return self._take("flags", lambda c: [c.flags], numpy.int64)[0]

    @flags.setter
    def flags(self, value):
        self._assign("flags", value)

    @property
    def ids(self):
        found = self._take_if("ids", lambda c: [c.ids], numpy.int64)
        return None if found is None else found[0]

    @property
    def position(self):
        return self._take_if("position", lambda c: list(c.position)[:self.dim])

    @property
    def temperature(self):
        found = self._take_if("temperature", lambda c: [c.temperature])
        return None if found is None else found[0]

    def __repr__(self):
        return f"<libmps Block: {self.count} particles in {self.dim}D, dt = {self.dt:.6g} s>"
