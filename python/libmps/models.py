"""Three models that many jobs begin with, each a page of calls of the layer below, all of which stays in reach:
`particles`, `solver` and bodies are the library's own objects.

    from libmps import models

    ground = models.Ground(size=(2.5, 1), cell=0.125, layers=[models.Layer(density=1800, law=sand, k0=0.5)])
    site = models.Site(layers=[...], rock={"vs": 700, "density": 2200}, spacing=1)
    tank = models.Tank(length=0.8, depth=0.3, spacing=0.025)

Lengths and other quantities are numbers in SI or texts with a unit.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy

import libmps as mps

from . import theory
from ._errors import ArgumentError, Warning
from .theory import _layers, _positive, _si

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from . import Array, Body, Context, Dynamics, Fluid, History, Material, Mpm, Particles

    Value = Union[float, str]


class Layer(NamedTuple):
    """A layer of the ground: density (kg/m3), a material of libmps, thickness (m; the last layer goes on down to the base), and
    the stress across over that along the vertical at rest."""

    density: Value
    law: Material
    thickness: Value = numpy.inf
    k0: float = 0.5


def _off_rows(depths: Array, row: float) -> list[str]:
    """Depths (m) that do not lie on faces of rows of particles."""
    return [f"{depth:g}" for depth in depths if numpy.isfinite(depth) and abs(depth / row - round(depth / row)) > 1e-6]


class Model:
    """What the models have in common: `particles` and `solver`, whose run() and record() are theirs too."""

    particles: Particles
    solver: Any

    def run(self, t_end: Value, **more: Any) -> None:
        """solver.run."""
        self.solver.run(t_end, **more)

    def record(self, name: str, what: Any = None, **more: Any) -> History:
        """solver.record."""
        return self.solver.record(name, what, **more)


class Ground(Model):
    """Level ground of layers in plane strain (WLS-MPM) from x = 0 to its length and from y = 0 up to its surface, at rest
    under its weight and a surcharge, between smooth sides.

    size       (length, height), m
    cell       of the grid, m; particles are half a cell apart
    layers     from the surface down: Layer(density, law, thickness, k0), each at least a cell thick; they end at faces of
               particles, half a spacing off at most, with a warning
    surcharge  Pa, on the surface, which it follows
    gravity    m/s2; 0: without weight, as in the theory of bearing capacity
    base       "roller": smooth; "held": rough
    room       m of the grid in front of x = 0, which a wall needs; 0: a smooth side, or a plane of symmetry, at x = 0
    more       keywords of Mpm"""

    solver: Mpm

    def __init__(self, size: Sequence[Value], cell: Value, layers: Sequence[Layer], *, surcharge: Value = 0.0, gravity: Value = 9.81,
                 base: str = "roller", room: Value = 0.0, context: Context | None = None, **more: Any) -> None:
        self.length, self.height = (_si(side, "m", "size") for side in size)
        self.cell, g, q = _si(cell, "m", "cell"), _si(gravity, "m/s2", "gravity"), _si(surcharge, "Pa", "surcharge")
        thickness = [_positive(layer.thickness, "m", "thickness") for layer in layers]
        for k, thick in enumerate(thickness[:-1]):
            if thick < self.cell * (1 - 1e-9):
                raise ArgumentError(f"layer {k + 1} is {thick:g} m thick, must be at least a cell, {self.cell:g} m")
        off = _off_rows(numpy.cumsum(thickness)[:-1], self.cell / 2)
        if off:
            warnings.warn(f"layers end at depths of {', '.join(off)} m, between rows of particles {self.cell / 2:g} m thick: a row is of the "
                          "layer at its middle", Warning, stacklevel=2)
        self.particles = mps.Particles(spacing=self.cell / 2, context=context or layers[0].law.context)
        self.particles.fill_box([0, 0], [self.length, self.height])
        bottoms = numpy.cumsum(thickness)
        bottoms[-1] = numpy.inf
        which = numpy.searchsorted(bottoms, self.height - numpy.array(self.particles["position", 1]))
        self.particles["density"] = numpy.array([_si(layer.density, "kg/m3", "density") for layer in layers])[which]
        if g or q:
            self.particles.set_geostatic(gravity=g, surface=self.height, surcharge=q, layers=[
                {"thickness": t if t < numpy.inf else 1e9, "density": _si(layer.density, "kg/m3", "density"), "k0": layer.k0}
                for t, layer in zip(thickness, layers)])
        ids = numpy.array(self.particles["id"])  # before the solver sorts the set
        given = {"lower": [-_si(room, "m", "room"), 0], "upper": [self.length, 2 * self.height], "gravity": [0, -g, 0], **more}
        self.solver = mps.Mpm(self.particles, layers[0].law, cell=self.cell, **given)
        for k in range(1, len(layers)):
            if (which == k).any():
                self.solver.set_material(layers[k].law, ids=ids[which == k])
        if base != "roller":
            self.solver.set_boundary("y_lower", kind=base)
        if q:
            top = self.particles.select_box([0, self.height - self.cell / 2], [self.length, self.height])
            self.solver.add_load(ids=top, traction=[0, -q])

    def _moving(self, body: Body, component: int, speed: float, ramp: float, factor: float, contact: dict[str, Any]) -> Body:
        body.drive(component, mps.Table("velocity", [0, ramp, ramp + 1e6], [0, speed, speed], context=self.particles.context), factor)
        self.solver.add_contact(body, **{"corner": 0.6 * self.cell, **contact})
        return body

    def wall(self, speed: Value, *, ramp: Value = 0.05, **contact: Any) -> Body:
        """A rigid wall at x = 0 that moves at `speed` (m/s) into the ground (passive), or away from it (negative: active),
        after `ramp` (s) of growing speed; friction=0 and other keywords of add_contact. Returns the body: its reaction in x
        is minus the ground's pressure."""
        v, h, thick = _si(speed, "m/s", "speed"), self.height, 2 * self.cell
        body = mps.Polygon([[0, -h / 2], [0, 1.5 * h], [-thick, 1.5 * h], [-thick, -h / 2]], context=self.particles.context)
        return self._moving(body, 0, abs(v), _si(ramp, "s", "ramp"), 1.0 if v > 0 else -1.0, contact)

    def footing(self, width: Value, speed: Value, *, ramp: Value = 0.01, **contact: Any) -> Body:
        """Half of a rigid strip `width` (m) wide on the surface, whose middle is at x = 0, a plane of symmetry; it sinks at
        `speed` (m/s). friction=0 is smooth, 10 rough. Returns the body: its reaction in y is that of half of the strip."""
        b = _positive(width, "m", "width")
        body = mps.Box(b, b / 2, position=[0, self.height + b / 4], context=self.particles.context)
        return self._moving(body, 1, _positive(speed, "m/s", "speed"), _si(ramp, "s", "ramp"), -1.0, contact)


class Site(Model):
    """Level layers on a half space of rock, a column of explicit dynamics that repeats itself across: shear waves rise
    through it as through endless layers. The surface is y = 0.

    layers   from the surface down: thickness (m), vs (m/s), density (kg/m3), damping (ratio; default 0), vp (default 2 vs). A row of
             particles in which layers meet has their mean mass and compliance, with a warning
    rock     vs, density (vp)
    spacing  of the particles, m: at most a tenth of the shortest wave
    f1, f2   Hz, at which Rayleigh damping has the ratios given"""

    solver: Dynamics

    def __init__(self, layers: Sequence[Mapping[str, Any]], rock: Mapping[str, Any], spacing: Value, *, f1: float = 1.0, f2: float = 8.0,
                 context: Context | None = None, **more: Any) -> None:
        self.layers, self.rock, self.f1, self.f2 = _layers([*layers, rock], ("vp",))[:-1], dict(rock), f1, f2
        d, depths = _positive(spacing, "m", "spacing"), numpy.cumsum([layer["thickness"] for layer in self.layers])
        self.depth = float(depths[-1])
        if abs(self.depth / d - round(self.depth / d)) > 1e-6:
            raise ArgumentError(f"spacing is {d:g} m, must divide the depth of the layers, {self.depth:g} m")
        off = _off_rows(depths[:-1], d)
        if off:
            warnings.warn(f"layers end at depths of {', '.join(off)} m, within rows of particles {d:g} m thick: these have the mean mass and "
                          "compliance of both layers", Warning, stacklevel=2)
        self.particles = mps.Particles(spacing=d, context=context)
        self.particles.fill_box([0, -self.depth - d], [3 * d, 0])  # with a row of rock, in whose middle the dashpots are
        row = numpy.rint(-numpy.array(self.particles["position", 1]) / d - 0.5).astype(int)
        for field, values in self._rows(d, depths).items():
            self.particles.add_field(field)
            self.particles[field] = values[row]
        self.solver = mps.Dynamics(self.particles, period_x=3 * d, f1=f1, f2=f2, **more)

    def _rows(self, d: float, depths: Array) -> dict[str, Array]:
        """Fields of the rows of particles from the surface down; the last is the upper half of a row of rock, as its dashpots are in
        its middle: half of the mass with the same moduli."""
        rows = int(round(self.depth / d))
        edges = d * numpy.arange(rows + 1)
        tops = numpy.concatenate(([0.0], depths[:-1]))
        inside = numpy.minimum(edges[1:, None], depths) - numpy.maximum(edges[:-1, None], tops)
        share = numpy.maximum(inside, 0.0) / d  # of each layer in each row
        rho, vs, h = (numpy.array([layer[name] for layer in self.layers]) for name in ("density", "vs", "damping"))
        shear, wave = rho * vs**2, rho * numpy.array([self._vp(layer) for layer in self.layers]) ** 2
        density = share @ rho
        damping = (share @ (h / shear)) / (share @ (1 / shear))
        speeds = [numpy.sqrt(1 / (share @ (1 / modulus)) / density) for modulus in (shear, wave)]
        rock = [_si(self.rock["density"], "kg/m3", "density") / 2, 2**0.5 * _si(self.rock["vs"], "m/s", "vs"), 2**0.5 * self._vp(self.rock),
                self.rock.get("damping", 0.0)]
        names = ("density", "shear_velocity", "pressure_velocity", "damping")
        return {name: numpy.append(values, last) for name, values, last in zip(names, (density, *speeds, damping), rock)}

    @staticmethod
    def _vp(layer: Mapping[str, Any]) -> float:
        return _si(layer["vp"], "m/s", "vp") if "vp" in layer else 2 * _si(layer["vs"], "m/s", "vs")

    def shake(self, t: ArrayLike, outcrop: ArrayLike) -> History:
        """The horizontal acceleration (m/s2) that the rock would have without the layers: half of it rises as a wave. Returns
        the history of the surface's acceleration, which run() fills: surface["a"]."""
        times, d = numpy.asarray(t, float), self.particles.spacing
        early = times - 0.5 * d / _si(self.rock["vs"], "m/s", "vs")  # it passes the middle of the row of rock
        wave = mps.Table("acceleration", early, 0.5 * numpy.asarray(outcrop, float), context=self.particles.context)
        base = ([None, -self.depth - d], [None, -self.depth - 0.4 * d])
        self.solver.add_boundary(box=base, kind="absorbing", signal=[wave, None], density=_si(self.rock["density"], "kg/m3", "density"),
                                 shear_velocity=_si(self.rock["vs"], "m/s", "vs"), pressure_velocity=self._vp(self.rock))
        middle, every = [1.5 * d, 0.0], float(numpy.diff(times).min())
        return self.solver.record("a", ("acceleration", 0), at=middle, every=every)

    def transfer(self, frequency: Any) -> Any:
        """Surface over outcrop by theory (theory.layers_transfer), complex, with the solver's Rayleigh damping."""
        rayleigh = [{**layer, "damping": 0.0, "mass": 4 * numpy.pi * layer.get("damping", 0.0) * self.f1 * self.f2 / (self.f1 + self.f2),
                     "stiffness": layer.get("damping", 0.0) / (numpy.pi * (self.f1 + self.f2))} for layer in self.layers]
        return theory.layers_transfer(frequency, [*rayleigh, self.rock])

    def expected(self, t: ArrayLike, outcrop: ArrayLike, t_end: float) -> tuple[Array, Array]:
        """(times, acceleration) of the surface by theory, up to t_end (s): the outcrop's Fourier transform times transfer(), over
        so long a time that the ringing has died out, which would come back at the beginning."""
        times = numpy.asarray(t, float)
        step = float(numpy.diff(times).min()) / 2
        shown = numpy.arange(int(numpy.floor(t_end / step * (1 + 1e-12))) + 1)
        before = None
        for doubled in range(1, 13):
            grid = step * numpy.arange(int(numpy.ceil(2**doubled * t_end / step)))
            moved = numpy.fft.rfft(numpy.interp(grid, times, numpy.asarray(outcrop, float), left=0, right=0))
            found = numpy.fft.irfft(moved * self.transfer(numpy.fft.rfftfreq(len(grid), step)), len(grid))[shown]
            if before is not None and abs(found - before).max() <= 1e-4 * abs(found).max():
                break
            before = found
        return step * shown, found


class Tank(Model):
    """Water at rest in a tank from x = 0 to `length` and y = 0 to `depth` (m), between a bed and two walls.

    more  keywords of Fluid, such as density and viscosity

    `bed`, `left`, `right` are the numbers of the boundaries, for record() and get_reaction()."""

    solver: Fluid

    def __init__(self, length: Value, depth: Value, spacing: Value, *, context: Context | None = None, **more: Any) -> None:
        self.length, self.depth = _si(length, "m", "length"), _si(depth, "m", "depth")
        self.particles = mps.Particles(spacing=_si(spacing, "m", "spacing"), context=context)
        self.particles.fill_box([0, 0], [self.length, self.depth])
        self.solver = mps.Fluid(self.particles, **{"density": 1000.0, "level": self.depth, **more})
        self.bed = self.solver.add_boundary(point=[0, 0, 0], normal=[0, 1, 0])
        self.left = self.solver.add_boundary(point=[0, 0, 0], normal=[1, 0, 0])
        self.right = self.solver.add_boundary(point=[self.length, 0, 0], normal=[-1, 0, 0])

    def drop(self, width: Value, height: Value, mass: Value, *, above: Value = 0.0, damping: float = 0.0) -> Body:
        """A box of `mass` (kg for a metre of tank) that falls onto the middle of the water from `above` (m) over it; `damping`
        (1/s) of its motion up and down. Returns the body."""
        w, h, m = _si(width, "m", "width"), _si(height, "m", "height"), _si(mass, "kg", "mass")
        place = [self.length / 2, self.depth + h / 2 + _si(above, "m", "above")]
        body = mps.Box(w, h, motion="free", mass=m, inertia=[0, 0, m * (w * w + h * h) / 12], position=place,
                       gravity=self.solver.definition.gravity, damping=[damping], context=self.particles.context)
        self.solver.add_contact(body)
        return body

    def level(self, away: float = 0.0) -> float:
        """Height (m) of the water, mean over the tank but for what lies nearer than `away` (m) to its middle."""
        x = numpy.linspace(0, self.length, 82)[1:-1]
        x = x[abs(x - self.length / 2) > away]
        levels = self.solver.get_levels(x)
        return float(numpy.nanmean(levels))
