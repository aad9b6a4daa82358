"""Pictures on matplotlib: particles with their bodies, coloured by a field; histories and curves against theory; response
spectra; animations of a run or of a series of frames.

    from libmps import plot

    ax = plot.particles(sand, "velocity", bodies=[strip])       # |v|, with its colour bar
    ax = plot.particles(sand, ("stress", 1))                    # one component
    ax = plot.particles(sand, pressure, label="pressure (Pa)")  # an array, one value a particle
    plot.curve(settlement, load, x_label="settlement (m)", y_label="load (N/m)", theory=5.14e3)
    plot.history(force, "force_x", theory=-6.3e3)               # a History, a files.Table; units on the axes
    plot.spectrum({"surface": spectrum, "theory": exact})       # of signals.response_spectrum
    plot.animation("fall.gif", solver, 1.0, 40, lambda ax: plot.particles(sand, "velocity", ax=ax))
    plot.film("pile.gif", files.Series("pile.vtkhdf"), "velocity")

Every particle is drawn as the square that its material was, deformed: by its `deformation_gradient` where the set has
that field, else by its `volume_ratio`, else with the set's spacing. A set in 3D is drawn where a plane cuts it.
Frames of a series (files.Series) are drawn as sets are. Functions return the axes, to which anything of matplotlib may be
added; they neither show nor save. Colours are told apart by the colour-blind too: viridis, and for lines those of COLOURS.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as pyplot
import numpy
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.collections import PolyCollection

from . import _show

if TYPE_CHECKING:  # of the stubs: what the package makes of the headers has no names to import
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from . import Body, Dynamics, Fluid, History, Mpm, Particles
    from .files import Frame, Series, Table
    from .signals import Spectrum

AXES = "xyz"
#: For lines: M. Okabe and K. Ito, Color Universal Design (2008); theory is black.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")


def _unit(particles, name):
    """The unit of a field, of a set or a frame."""
    units = particles.units if hasattr(particles, "units") else {found: unit for found, unit, _ in _show.fields(particles)}
    return f" ({units[name]})" if units.get(name, "") not in ("", "-") else ""


def _labelled(name, unit):
    return f"{name.replace('_', ' ')} ({unit})" if unit not in ("", "-") else name.replace("_", " ")


def _values(particles, field):
    """(values, label) of what the particles are coloured by."""
    if isinstance(field, (str, tuple)):
        name, component = (field, None) if isinstance(field, str) else field
        values = numpy.array(particles[name], float)
        unit = _unit(particles, name)
        if component is not None:
            if values.ndim == 1 or not 0 <= component < values.shape[1]:
                raise ValueError(f"component of {name!r} is {component}, must be from 0 to "
                                 f"{0 if values.ndim == 1 else values.shape[1] - 1}")
            return values[:, component], f"{name}[{component}]{unit}"
        if values.ndim == 1:
            return values, name + unit
        if values.shape[1] > 3:
            raise ValueError(f"{name!r} has {values.shape[1]} components: name one, ({name!r}, 0)")
        return numpy.sqrt((values ** 2).sum(axis=1)), f"|{name}|{unit}"
    values = numpy.array(field, float)
    count = len(particles["id"])
    if values.shape != (count,):
        raise ValueError(f"values have the shape {values.shape}, must have one for each of the {count} particles")
    return values, None


def _plane(particles, plane):
    """(which particles are drawn, axes of the drawing) of a set in 2D, or of one in 3D that a plane cuts."""
    dim, position = particles.dim, numpy.array(particles["position"])
    if dim == 2:
        if plane is not None:
            raise ValueError(f"plane is {plane!r}, must be None for a set in 2D")
        return position, numpy.arange(len(position)), (0, 1)
    if plane is None or plane[0] not in AXES:
        raise ValueError(f"plane is {plane!r}, must be ('x', 'y' or 'z', its coordinate in m) for a set in 3D")
    normal = AXES.index(plane[0])
    near = numpy.flatnonzero(abs(position[:, normal] - plane[1]) <= 0.5001 * particles.spacing)
    if not len(near):
        raise ValueError(f"the plane {plane[0]} = {plane[1]:g} m cuts no particle")
    return position, near, tuple(a for a in range(3) if a != normal)


def _shapes(particles, which, axes):
    """The edges (2 x 2) of each particle's square, as deformed."""
    count, dim = len(which), particles.dim
    edges = numpy.tile(numpy.eye(2), (count, 1, 1))
    if "deformation_gradient" in particles:
        gradient = numpy.array(particles["deformation_gradient"])[which]
        deformed = gradient.any(axis=1)  # all zero: not deformed
        square = gradient[:, :dim * dim].reshape(count, dim, dim)[:, axes][:, :, axes]
        edges[deformed] = square[deformed]
    elif "volume_ratio" in particles:
        ratio = numpy.array(particles["volume_ratio"])[which]
        edges *= (numpy.where(ratio > 0, ratio, 1.0) ** (1.0 / dim))[:, None, None]
    return edges * particles.spacing


def _draw_bodies(ax, bodies, axes, plane, box):
    """The outline of each body: where its distance function is zero."""
    (left, right), (low, high) = box
    step = max(right - left, high - low) / 400
    x = numpy.arange(left, right + step, step)
    y = numpy.arange(low, high + step, step)
    grid = numpy.meshgrid(x, y)
    for body in bodies:
        points = numpy.zeros((grid[0].size, body.dim))
        points[:, axes[0]], points[:, axes[1]] = grid[0].ravel(), grid[1].ravel()
        if body.dim == 3:
            points[:, AXES.index(plane[0])] = plane[1]
        distance = body.distance(points).distance.reshape(grid[0].shape)
        if distance.min() < 0 < distance.max():
            ax.contourf(x, y, distance, [distance.min(), 0], colors=["0.75"], zorder=3)
            ax.contour(x, y, distance, [0], colors="black", linewidths=1, zorder=4)


def particles(particles: Particles | Frame, field: str | tuple[str, int] | ArrayLike | None = None, *,
              bodies: Iterable[Body] = (), plane: tuple[str, float] | None = None,
              limits: Sequence[float] | None = None, label: str | None = None, size: float = 1.0,
              cmap: Any = "viridis", ax: Axes | None = None) -> Axes:
    """Draws the particles as deformed squares, coloured by `field`, and the outlines of `bodies`.

    field   name of a field (a vector is drawn by its length), (name, component), an array of one value a particle,
            or None: one colour
    plane   ("y", 0.0): the plane that cuts a set in 3D
    limits  (lowest, highest) of the colours; None: those of the values. Values outside have arrows at the colour bar
    label   of the colour bar; None: name and unit of the field
    size    factor on the squares: 1.3 closes the slits that shear opens between squares drawn without deformation
            gradient
    ax      axes to draw into, cleared before; None: new ones

    Returns the axes. FieldError: no field of that name; ValueError: values, plane or component that do not
    fit the set."""
    position, which, axes = _plane(particles, plane)
    values, named = (None, None) if field is None else _values(particles, field)
    if ax is None:
        ax = pyplot.figure(layout="constrained").add_subplot()
    for bar in getattr(ax, "_libmps_bars", []):
        bar.remove()
    ax.clear()
    ax._libmps_bars = []
    corners = 0.5 * numpy.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    polygons = position[which][:, None, axes] + numpy.einsum("nij,kj->nki", size * _shapes(particles, which, axes), corners)
    drawn = PolyCollection(polygons, cmap=cmap, edgecolors="face", linewidths=0.5, antialiaseds=False, zorder=2)
    if values is None:
        drawn.set_facecolor("tab:blue")
    else:
        shown = values[which]
        low, high = limits if limits is not None else (shown.min(), shown.max())
        drawn.set_array(shown)
        drawn.set_clim(low, high)
        beyond = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
        extend = beyond[bool(shown.min() < low), bool(shown.max() > high)]
    ax.add_collection(drawn)
    lower, upper = polygons.min(axis=(0, 1)), polygons.max(axis=(0, 1))
    margin = 0.08 * (upper - lower).max()
    box = [(lower[k] - margin, upper[k] + margin) for k in range(2)]
    _draw_bodies(ax, bodies, axes, plane, box)
    ax.set(xlim=box[0], ylim=box[1], aspect="equal", xlabel=f"{AXES[axes[0]]} (m)", ylabel=f"{AXES[axes[1]]} (m)")
    if values is not None:
        bar = ax.figure.colorbar(drawn, ax=ax, label=label or named or "", extend=extend,
                                 shrink=min(1.0, max(0.5, (box[1][1] - box[1][0]) / (box[0][1] - box[0][0]))))
        ax._libmps_bars.append(bar)
    return ax


def curve(x: ArrayLike, y: ArrayLike, *, x_label: str = "displacement (m)", y_label: str = "force (N)",
          label: str | None = None, theory: ArrayLike | None = None, theory_label: str = "theory",
          ax: Axes | None = None) -> Axes:
    """Draws a curve, such as force over displacement. `theory` is a number, drawn as a level line, or an array as
    long as x. Values that are not finite leave a gap. Returns the axes; ValueError: x, y or `theory` of different
    lengths."""
    x, y = numpy.array(x, float), numpy.array(y, float)
    if x.ndim != 1 or x.shape != y.shape:
        raise ValueError(f"x and y have the shapes {x.shape} and {y.shape}, must have one and the same length")
    if theory is not None and numpy.ndim(theory) and numpy.shape(theory) != x.shape:
        raise ValueError(f"theory has the shape {numpy.shape(theory)}, must be a number or have that of x, {x.shape}")
    if ax is None:
        ax = pyplot.figure(layout="constrained").add_subplot()
    ax.plot(x, y, label=label, color=COLOURS[len(ax.lines) % len(COLOURS)])
    if theory is not None and numpy.ndim(theory):
        ax.plot(x, theory, "k--", label=theory_label)
    elif theory is not None:
        ax.axhline(theory, color="black", linestyle="--", label=theory_label)
    ax.set(xlabel=x_label, ylabel=y_label)
    ax.grid(True, alpha=0.3)
    if label or theory is not None:
        ax.legend()
    return ax


def history(rows: History | Table, *names: str, theory: ArrayLike | Mapping[str, ArrayLike] | None = None,
            theory_label: str = "theory", ax: Axes | None = None) -> Axes:
    """Draws columns of a history or table over its first column (mostly t); of these names, or all. `theory` is a number or
    an array as long as the rows, or a dictionary of them by the names of columns: dashed. Labels have the units. KeyError: no
    such column; ValueError: an array of another length."""
    first, *others = rows.columns
    shown, x = list(names) or others, rows[first]
    for name in shown:
        if rows[name].ndim > 1:
            raise ValueError(f"{name!r} has components: name them, as {name}_x")
    lines = theory if isinstance(theory, Mapping) else {} if theory is None else {theory_label: theory}
    if ax is None:
        ax = pyplot.figure(layout="constrained").add_subplot()
    for k, name in enumerate(shown):
        ax.plot(x, rows[name], color=COLOURS[k % len(COLOURS)], label=name.replace("_", " "))
    for k, (name, values) in enumerate(lines.items()):
        level = numpy.broadcast_to(numpy.asarray(values, float), x.shape) if numpy.ndim(values) == 0 else numpy.asarray(values, float)
        if level.shape != x.shape:
            raise ValueError(f"theory has the shape {level.shape}, must be a number or have that of the rows, {x.shape}")
        said = theory_label if len(lines) == 1 else f"{theory_label}: {name.replace('_', ' ')}"
        ax.plot(x, level, color="black", linestyle=("--", ":", "-.")[k % 3], label=said)
    units = {rows.units.get(name, "") for name in shown}
    ax.set(xlabel=_labelled(first, rows.units.get(first, "")),
           ylabel=_labelled(shown[0] if len(shown) == 1 else "", units.pop() if len(units) == 1 else "").strip())
    ax.grid(True, alpha=0.3)
    if len(shown) > 1 or lines:
        ax.legend()
    return ax


def spectrum(spectra: Spectrum | Mapping[str, Spectrum], quantity: str = "acceleration", *, ax: Axes | None = None) -> Axes:
    """Draws response spectra (signals.response_spectrum), one or several by name, over the period; one named "theory" is
    dashed and black. quantity: acceleration, velocity, displacement or absolute."""
    units = {"acceleration": "pseudo-acceleration (m/s$^2$)", "velocity": "pseudo-velocity (m/s)", "displacement": "displacement (m)",
             "absolute": "acceleration of the mass (m/s$^2$)"}
    if quantity not in units:
        raise ValueError(f"quantity is {quantity!r}, must be one of {', '.join(units)}")
    named = spectra if isinstance(spectra, Mapping) else {"": spectra}
    if ax is None:
        ax = pyplot.figure(layout="constrained").add_subplot()
    for k, (name, one) in enumerate(named.items()):
        exact = name == "theory"
        ax.semilogx(one.period, getattr(one, quantity), color="black" if exact else COLOURS[k % len(COLOURS)],
                    linestyle="--" if exact else "-", label=name)
    damping = {f"{100 * one.damping:g} %" for one in named.values()}
    ax.set(xlabel="period (s)", ylabel=units[quantity] + (f", {damping.pop()} damping" if len(damping) == 1 else ""))
    ax.grid(True, alpha=0.3)
    if not isinstance(spectra, tuple):
        ax.legend()
    return ax


def _writer(path):
    """What writes a film of this name."""
    writers = {".gif": PillowWriter, ".mp4": FFMpegWriter}
    ending = str(path)[-4:].lower()
    if ending not in writers:
        raise ValueError(f"path is {str(path)!r}, must end in .gif or .mp4")
    return writers[ending]


def animation(path: str | PathLike[str], solver: Mpm | Fluid | Dynamics, t_end: float, frames: int,
              draw: Callable[[Axes], Any], *, fps: float = 20, dpi: float = 100,
              size: tuple[float, float] = (6.4, 4.8)) -> None:
    """Runs `solver` to t_end (s) and writes `frames` pictures of equal steps in time to `path`, a .gif (by Pillow) or
    .mp4 (by ffmpeg); the first shows the present state. `draw(ax)` draws each into the axes that it is given; what it
    raises ends the run. ValueError: another ending, or `frames` below 2."""
    made = _writer(path)
    if frames < 2:
        raise ValueError(f"frames is {frames}, must be at least 2")
    figure = pyplot.figure(figsize=size, layout="constrained")
    try:
        ax, writer, start = figure.add_subplot(), made(fps=fps), solver.time
        with writer.saving(figure, str(path), dpi):
            for k in range(frames):
                if k:
                    solver.run(start + (t_end - start) * k / (frames - 1))
                draw(ax)
                ax.set_title(f"t = {solver.time:.3f} s")
                writer.grab_frame()
    finally:
        pyplot.close(figure)


def film(path: str | PathLike[str], series: Series, field: str | tuple[str, int] | None = None, *, fps: float = 20, dpi: float = 100,
         size: tuple[float, float] = (6.4, 4.8), **drawing: Any) -> None:
    """Writes the frames of a series to `path` (.gif, .mp4), coloured by `field`; keywords of `particles`. Without limits= the
    colours are those of the whole series, and the axes those of all its frames."""
    made = _writer(path)
    if field is not None and "limits" not in drawing:
        ends = [(values.min(), values.max()) for values in (_values(frame, field)[0] for frame in series) if len(values)]
        drawing["limits"] = (min(low for low, _ in ends), max(high for _, high in ends))
    figure = pyplot.figure(figsize=size, layout="constrained")
    boxes: list[Any] = []
    try:
        ax, writer = figure.add_subplot(), made(fps=fps)
        for frame in series:  # the view that holds all
            boxes.append((frame["position"].min(axis=0), frame["position"].max(axis=0)))
        low, high = numpy.min([b[0] for b in boxes], axis=0), numpy.max([b[1] for b in boxes], axis=0)
        margin = 0.08 * (high - low).max()
        with writer.saving(figure, str(path), dpi):
            for frame in series:
                particles(frame, field, ax=ax, **drawing)
                if series.dim == 2:
                    ax.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
                ax.set_title(f"t = {frame.time:.3f} s")
                writer.grab_frame()
    finally:
        pyplot.close(figure)
