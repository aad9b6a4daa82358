"""Pictures of particles on matplotlib: a set with its bodies, coloured by a field; curves; animations.

    from libmps import plot

    ax = plot.particles(sand, "velocity", bodies=[strip])       # |v|, with its colour bar
    ax = plot.particles(sand, ("stress", 1))                    # one component
    ax = plot.particles(sand, pressure, label="pressure (Pa)")  # an array, one value a particle
    plot.curve(settlement, load, x_label="settlement (m)", y_label="load (N/m)", theory=5.14e3)
    plot.animation("fall.gif", solver, 1.0, 40, lambda ax: plot.particles(sand, "velocity", ax=ax))

Every particle is drawn as the square that its material was, deformed: by its `deformation_gradient` where the set has
that field, else by its `volume_ratio`, else with the set's spacing. A set in 3D is drawn where a plane cuts it.
Functions return the axes, to which anything of matplotlib may be added; they neither show nor save.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
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

    from . import Body, Dynamics, Fluid, Mpm, Particles

AXES = "xyz"


def _values(particles, field):
    """(values, label) of what the particles are coloured by."""
    if isinstance(field, (str, tuple)):
        name, component = (field, None) if isinstance(field, str) else field
        values = numpy.array(particles[name], float)
        unit = next(unit for found, unit, _ in _show.fields(particles) if found == name)
        unit = f" ({unit})" if unit not in ("", "-") else ""
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
    if values.shape != (len(particles),):
        raise ValueError(f"values have the shape {values.shape}, must have one for each of the {len(particles)} particles")
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


def particles(particles: Particles, field: str | tuple[str, int] | ArrayLike | None = None, *,
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
    ax.plot(x, y, label=label)
    if theory is not None and numpy.ndim(theory):
        ax.plot(x, theory, "k--", label=theory_label)
    elif theory is not None:
        ax.axhline(theory, color="black", linestyle="--", label=theory_label)
    ax.set(xlabel=x_label, ylabel=y_label)
    ax.grid(True, alpha=0.3)
    if label or theory is not None:
        ax.legend()
    return ax


def animation(path: str | PathLike[str], solver: Mpm | Fluid | Dynamics, t_end: float, frames: int,
              draw: Callable[[Axes], Any], *, fps: float = 20, dpi: float = 100,
              size: tuple[float, float] = (6.4, 4.8)) -> None:
    """Runs `solver` to t_end (s) and writes `frames` pictures of equal steps in time to `path`, a .gif (by Pillow) or
    .mp4 (by ffmpeg); the first shows the present state. `draw(ax)` draws each into the axes that it is given; what it
    raises ends the run. ValueError: another ending, or `frames` below 2."""
    writers = {".gif": PillowWriter, ".mp4": FFMpegWriter}
    ending = str(path)[-4:].lower()
    if ending not in writers:
        raise ValueError(f"path is {str(path)!r}, must end in .gif or .mp4")
    if frames < 2:
        raise ValueError(f"frames is {frames}, must be at least 2")
    figure = pyplot.figure(figsize=size, layout="constrained")
    try:
        ax, writer, start = figure.add_subplot(), writers[ending](fps=fps), solver.time
        with writer.saving(figure, str(path), dpi):
            for k in range(frames):
                if k:
                    solver.run(start + (t_end - start) * k / (frames - 1))
                draw(ax)
                ax.set_title(f"t = {solver.time:.3f} s")
                writer.grab_frame()
    finally:
        pyplot.close(figure)
