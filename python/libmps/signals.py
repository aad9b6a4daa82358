"""Recorded and computed motions as engineers look at them: response spectrum, Arias intensity, baseline correction,
integration, Fourier spectra and their ratio. Times (s) increase, evenly or not; values are linear between them, as in a
table of libmps (Table, Record), which `sampled` turns into arrays.

    from libmps import signals

    t, a = signals.sampled(mps.Record("quake.AT2"), dt=0.005)
    spectrum = signals.response_spectrum(t, a, damping=0.05)
    spectrum.acceleration[spectrum.period.searchsorted(0.5)]       # m/s2, pseudo-acceleration
    f, ratio = signals.transfer(t, surface, outcrop, width=0.2)    # Fourier ratio, smoothed over 0.2 Hz
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from . import Array, Signal

G = 9.80665  #: m/s2, of Arias's intensity and of records in g


def _record(t: ArrayLike, values: ArrayLike) -> tuple[Array, Array]:
    """Times and values as arrays that fit."""
    times, found = numpy.array(t, float), numpy.array(values, float)
    if times.ndim != 1 or times.shape != found.shape or len(times) < 2:
        raise ValueError(f"times and values have the shapes {times.shape} and {found.shape}, must have one and the same length, at least 2")
    if not (numpy.isfinite(times).all() and numpy.isfinite(found).all()):
        raise ValueError("times and values must be finite")
    if not (numpy.diff(times) > 0).all():
        raise ValueError("times must increase")
    return times, found


def sampled(signal: Signal, dt: float, quantity: str = "acceleration", t_end: float | None = None) -> tuple[Array, Array]:
    """(times, values) of a signal of libmps every `dt` (s) from its start to its end, or t_end. quantity: acceleration,
    velocity, displacement or value."""
    if quantity not in ("acceleration", "velocity", "displacement", "value"):
        raise ValueError(f"quantity is {quantity!r}, must be acceleration, velocity, displacement or value")
    start, end = signal.span
    end = end if t_end is None else t_end
    if not (numpy.isfinite(end) and end > start and dt > 0):
        raise ValueError(f"dt is {dt}, t_end {end}: must give at least one step from {start} s on")
    t = start + dt * numpy.arange(int(numpy.floor((end - start) / dt * (1 + 1e-12) + 1e-9)) + 1)
    ask = getattr(signal, quantity)
    return t, numpy.array([ask(x) for x in t])


def artificial(duration: float, dt: float, peak: float, *, frequency: float = 2.5, damping: float = 0.6, seed: int = 1) -> tuple[Array, Array]:
    """(times, acceleration in m/s2) of a motion like an earthquake's: noise with the spectrum of ground that has this
    `frequency` (Hz) and `damping`, under an envelope that is largest at a quarter of `duration` (s), scaled to `peak`. For
    trials, where a record is not at hand.

    K. Kanai, Bull. Earthq. Res. Inst. 35 (1957) 309-325; H. Tajimi, Proc. 2nd World Conf. Earthq. Eng. (1960) 781-797."""
    t = dt * numpy.arange(int(round(duration / dt)))
    f = numpy.fft.rfftfreq(len(t), dt)
    x = 2j * damping * f / frequency
    shape = (1 + x) / (1 - (f / frequency) ** 2 + x)
    shape *= f**2 / (f**2 + 0.3**2) / (1 + (f / 8) ** 4)  # no drift; hardly anything above 12 Hz
    noise = numpy.fft.rfft(numpy.random.default_rng(seed).standard_normal(len(t)))
    late = 4 * t / duration
    a = numpy.fft.irfft(noise * shape, len(t)) * late**2 * numpy.exp(-2 * late) * numpy.minimum(1, (duration - t) * 8 / duration)
    return t, a * (peak / abs(a).max())


def integrated(t: ArrayLike, acceleration: ArrayLike) -> tuple[Array, Array]:
    """(velocity, displacement) from rest: exact integrals of what is linear between samples, as a table of libmps has them."""
    times, a = _record(t, acceleration)
    dt = numpy.diff(times)
    v = numpy.concatenate(([0.0], numpy.cumsum(0.5 * dt * (a[1:] + a[:-1]))))
    u = numpy.concatenate(([0.0], numpy.cumsum(dt * v[:-1] + dt**2 * (2 * a[:-1] + a[1:]) / 6)))
    return v, u


def baseline(t: ArrayLike, acceleration: ArrayLike, kind: str = "linear") -> Array:
    """The acceleration less its baseline, as Record corrects it (docs/signals.md): "mean", or the trend of the velocity,
    a polynomial without a constant of degree 1 ("linear"), 2 ("quadratic") or 3 ("cubic"), by least squares over time."""
    times, a = _record(t, acceleration)
    kinds = {"none": 0, "mean": 0, "linear": 1, "quadratic": 2, "cubic": 3}
    if kind not in kinds:
        raise ValueError(f"kind is {kind!r}, must be one of {', '.join(kinds)}")
    degree, length = kinds[kind], times[-1] - times[0]
    v = integrated(times, a)[0]
    if kind == "none":
        return a
    if kind == "mean":
        return a - v[-1] / length
    if len(times) < degree + 1:
        raise ValueError(f"a correction of degree {degree} needs {degree + 1} samples")
    x = (times - times[0]) / length
    share = numpy.sqrt(numpy.gradient(x))  # a sample counts with the time between its neighbours
    share[[0, -1]] = numpy.sqrt(0.5 * numpy.diff(x)[[0, -1]])
    powers = numpy.arange(1, degree + 1)
    c = numpy.linalg.lstsq(x[:, None] ** powers * share[:, None], v * share, rcond=None)[0]
    return a - (x[:, None] ** (powers - 1) * (powers * c)).sum(axis=1) / length


class Spectrum(NamedTuple):
    """Largest responses of oscillators of one damping ratio: arrays over `period` (s)."""

    period: Any
    displacement: Any  # m, relative to the ground
    velocity: Any  # m/s, pseudo-velocity w S_d
    acceleration: Any  # m/s2, pseudo-acceleration w^2 S_d
    absolute: Any  # m/s2, of the mass
    damping: float


def _advance(mu: Array, dt: Array, a0: Array, a1: Array) -> tuple[Array, Array]:
    """(E, f) of y(t + dt) = E y + f for y = v - conj(mu) u of u'' + 2 h w u' + w^2 u = -a, so that y' = mu y - a, with
    mu = -h w + i w (1 - h^2)^1/2 and a linear from a0 to a1. One row a step."""
    dt, a0, a1 = dt[:, None], a0[:, None], a1[:, None]
    grown = numpy.expm1(mu * dt)
    even, ramp = grown / mu, (grown - mu * dt) / mu**2
    return grown + 1, -(a0 * even + (a1 - a0) * ramp / dt)


def response_spectrum(t: ArrayLike, acceleration: ArrayLike, periods: ArrayLike | None = None, damping: float = 0.05, *,
                      free: float = 1.0) -> Spectrum:
    """Response spectrum of a ground acceleration (m/s2): oscillators that start at rest, integrated exactly for an
    acceleration that is linear between samples. N. C. Nigam and P. C. Jennings, Bull. Seism. Soc. Am. 59 (1969) 909-922.

    periods  s, > 0; None: 100 from .02 to 5 s, evenly by their logarithm
    damping  ratio to the critical one, 0 to below 1
    free     periods that each oscillator goes on after the record

    Steps are parted to a fortieth of a period, so that the largest response between samples is found within .3 %."""
    times, a = _record(t, acceleration)
    period = numpy.geomspace(0.02, 5.0, 100) if periods is None else numpy.atleast_1d(numpy.array(periods, float))
    if period.ndim != 1 or not ((period > 0) & numpy.isfinite(period)).all():
        raise ValueError(f"periods are {periods!r}, must be numbers above 0 s")
    if not 0 <= damping < 1:
        raise ValueError(f"damping is {damping}, must be from 0 to below 1")
    w = 2 * numpy.pi / period
    mu = -damping * w + 1j * w * numpy.sqrt(1 - damping**2)
    peaks = _peaks(times, a, mu, numpy.ceil(40 * numpy.diff(times).max() / period).astype(int), free)
    return Spectrum(period, peaks[0], w * peaks[0], w * w * peaks[0], peaks[1], damping)


def _peaks(times: Array, a: Array, mu: Array, parts: Array, free: float) -> Array:
    """Largest relative displacements and absolute accelerations; each step is looked at in `parts` parts."""
    dt = numpy.diff(times)
    grown, forced = _advance(mu, dt, a[:-1], a[1:])
    y = numpy.zeros((len(times), len(mu)), complex)
    for k in range(len(dt)):
        numpy.multiply(grown[k], y[k], out=y[k + 1])
        y[k + 1] += forced[k]
    most = _largest(mu, y)
    for many in numpy.unique(parts):
        same = parts == many
        for part in range(1, many):
            e, f = _advance(mu[same], part / many * dt, a[:-1], a[:-1] + part / many * numpy.diff(a))
            most[:, same] = numpy.maximum(most[:, same], _largest(mu[same], e * y[:-1, same] + f))
    if free > 0:  # the ground is at rest
        ahead = numpy.linspace(0.0, free, 1 + int(numpy.ceil(80 * free)))[:, None] * 2 * numpy.pi / abs(mu)
        most = numpy.maximum(most, _largest(mu, y[-1] * numpy.exp(mu * ahead)))
    return most


def _largest(mu: Array, y: Array) -> Array:
    u = y.imag / mu.imag
    v = y.real + mu.real * u
    return numpy.array([abs(u).max(axis=0), abs(2 * mu.real * v - abs(mu) ** 2 * u).max(axis=0)])


def arias(t: ArrayLike, acceleration: ArrayLike, gravity: float = G) -> float:
    """Arias intensity (m/s): pi/(2 g) times the integral of a^2. A. Arias, in Hansen (ed.), Seismic Design for Nuclear
    Power Plants (1970) 438-483."""
    return float(arias_history(t, acceleration, gravity)[-1])


def arias_history(t: ArrayLike, acceleration: ArrayLike, gravity: float = G) -> Array:
    """Arias intensity (m/s) up to each time (Husid's plot): exact for values that are linear between samples."""
    times, a = _record(t, acceleration)
    pieces = numpy.diff(times) * (a[1:] ** 2 + a[1:] * a[:-1] + a[:-1] ** 2) / 3
    return numpy.pi / (2 * gravity) * numpy.concatenate(([0.0], numpy.cumsum(pieces)))


def duration(t: ArrayLike, acceleration: ArrayLike, low: float = 0.05, high: float = 0.95) -> float:
    """Significant duration (s): from `low` to `high` of Arias's intensity."""
    history = arias_history(t, acceleration)
    if history[-1] == 0.0:
        return 0.0
    at = numpy.interp([low * history[-1], high * history[-1]], history, numpy.asarray(t, float))
    return float(at[1] - at[0])


def fourier(t: ArrayLike, values: ArrayLike, *, dt: float | None = None, length: float | None = None) -> tuple[Array, Array]:
    """(frequencies in Hz, complex Fourier transform, unit times s) by fast Fourier transform of steps `dt` (s; None: the
    shortest of t), with zeros behind the record up to `length` (s; None: none)."""
    times, found = _record(t, values)
    step = float(numpy.diff(times).min()) if dt is None else dt
    grid = times[0] + step * numpy.arange(int(numpy.floor((times[-1] - times[0]) / step * (1 + 1e-12) + 1e-9)) + 1)
    n = max(len(grid), int(round((length or 0.0) / step)))
    return numpy.fft.rfftfreq(n, step), step * numpy.fft.rfft(numpy.interp(grid, times, found), n)


def smoothed(f: ArrayLike, amplitude: ArrayLike, width: float | None = None, konno_ohmachi: float | None = None) -> Array:
    """Amplitudes over frequencies (Hz, even), as means over `width` (Hz), or by the window of K. Konno and T. Ohmachi (Bull.
    Seism. Soc. Am. 88 (1998) 228-241) of this bandwidth coefficient, such as 40."""
    at, values = numpy.asarray(f, float), numpy.asarray(amplitude, float)
    if width is not None and konno_ohmachi is not None:
        raise ValueError("width and konno_ohmachi exclude one another")
    if width is not None:
        half = int(0.5 * width / (at[1] - at[0]))
        sums = numpy.concatenate(([0.0], numpy.cumsum(values)))
        low, high = numpy.maximum(numpy.arange(len(at)) - half, 0), numpy.minimum(numpy.arange(len(at)) + half + 1, len(at))
        return (sums[high] - sums[low]) / (high - low)
    if konno_ohmachi is None:
        return values.copy()
    found, reach = values.copy(), 10 ** (3 / konno_ohmachi)  # the window has fallen to its lobes there
    for k in range(1, len(at)):
        near = slice(max(1, int(numpy.searchsorted(at, at[k] / reach))), int(numpy.searchsorted(at, at[k] * reach)) + 1)
        x = konno_ohmachi * numpy.log10(at[near] / at[k])
        weight = numpy.sinc(x / numpy.pi) ** 4
        found[k] = (weight * values[near]).sum() / weight.sum()
    return found


def transfer(t: ArrayLike, output: ArrayLike, given: ArrayLike, *, width: float | None = None, konno_ohmachi: float | None = None,
             dt: float | None = None, length: float | None = None) -> tuple[Array, Array]:
    """(frequencies in Hz, |output|/|given|) of two histories over the same times: the ratio of their Fourier amplitudes, each
    smoothed before (see `smoothed`). Where `given` has nothing the ratio is NaN."""
    f, above = fourier(t, output, dt=dt, length=length)
    below = smoothed(f, abs(fourier(t, given, dt=dt, length=length)[1]), width, konno_ohmachi)
    above = smoothed(f, abs(above), width, konno_ohmachi)
    there = below > 1e-12 * below.max()
    return f, numpy.where(there, above / numpy.where(there, below, 1.0), numpy.nan)
