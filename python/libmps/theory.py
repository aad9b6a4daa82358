"""Closed forms that runs are compared with: earth pressure, bearing capacity, consolidation, waves in layers and in water,
contact. Arguments are numbers in SI (angles in rad), texts with a unit ("30 deg", "25 kPa") or, where that makes sense,
arrays; results are in SI.

    from libmps import theory

    theory.rankine("30 deg")                                      # 0.3333
    theory.earth_force("4 m", 1800, "30 deg", surcharge="10 kPa") # N per metre of wall
    theory.prandtl() * 25e3                                       # Pa, on clay of 25 kPa
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy

import libmps

from ._quantities import number

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    Value = Union[float, str]

G = 9.81  #: m/s2, where no other gravity is given


def _si(value: Any, unit: str, word: str) -> Any:
    """A number or text as a float of SI; arrays as arrays."""
    found = number(value, unit, word)
    return float(found) if numpy.ndim(found) == 0 else numpy.asarray(found, float)


def _checked(value: Any, unit: str, word: str, wrong: Any, must: str) -> Any:
    """A number or text as a float of SI, refused where `wrong` of it is true or it is not a number."""
    found = _si(value, unit, word)
    if numpy.any(wrong(found) | numpy.isnan(found)):
        raise ValueError(f"{word} is {value!r}, must be {must}{' ' + unit if unit else ''}")
    return found


def _positive(value: Any, unit: str, word: str) -> Any:
    return _checked(value, unit, word, lambda found: found <= 0, "above 0")


def _not_negative(value: Any, unit: str, word: str) -> Any:
    return _checked(value, unit, word, lambda found: found < 0, "at least 0")


def _angle(value: Any, word: str, highest: float = numpy.pi / 2) -> Any:
    found = _si(value, "rad", word)
    if not numpy.all((found >= 0) & (found < highest)):
        raise ValueError(f"{word} is {value!r}, must be from 0 to below {numpy.degrees(highest):.0f} deg (numbers are in rad)")
    return found


def _side(side: str) -> float:
    """-1 of the active side, 1 of the passive one."""
    if side not in ("active", "passive"):
        raise ValueError(f"side is {side!r}, must be 'active' or 'passive'")
    return -1.0 if side == "active" else 1.0


# ---- earth pressure ------------------------------------------------------------------------------


def rankine(friction: Value, side: str = "active") -> float:
    """Rankine's coefficient of earth pressure behind a smooth wall, level ground: tan^2(45 deg -+ phi/2).

    W. J. M. Rankine, Phil. Trans. R. Soc. 147 (1857) 9-27. friction: rad or text. No unit."""
    return float(numpy.tan(numpy.pi / 4 + _side(side) * _angle(friction, "friction") / 2) ** 2)


def coulomb(friction: Value, wall_friction: Value = 0.0, *, slope: Value = 0.0, batter: Value = 0.0, side: str = "active") -> float:
    """Coulomb's coefficient, of the force along the wall's friction angle: P = K rho g H^2/2 by a plane wedge.

    wall_friction, at most `friction`; slope of the ground behind the wall; batter of its back from the vertical, positive where
    the ground lies on the back, as on a gravity wall that is widest at its foot: rad or texts. The passive one is too high for
    rough walls (plane wedge): above a third of `friction` take a curved one; where no plane wedge is pushed up, ValueError.
    H. Mueller-Breslau (1906); Das, Principles of Foundation Engineering, eq. (7.26)."""
    phi, delta = _angle(friction, "friction"), _angle(wall_friction, "wall_friction")
    alpha, beta = _si(slope, "rad", "slope"), numpy.pi / 2 - _si(batter, "rad", "batter")
    sign = _side(side)
    if delta > phi:
        raise ValueError(f"wall_friction is {wall_friction!r}, must be at most the angle of friction")
    if not -phi <= alpha <= phi:
        raise ValueError(f"slope is {slope!r}, must be between minus and plus the angle of friction")
    if not abs(beta - numpy.pi / 2) + max(delta, alpha, -alpha) < numpy.pi / 2:
        raise ValueError(f"batter is {batter!r}, must leave less than 90 deg with the wall's friction and the slope (numbers are in rad)")
    root = numpy.sqrt(numpy.sin(phi + delta) * numpy.sin(phi + sign * alpha) /
                      (numpy.sin(beta + sign * delta) * numpy.sin(alpha + beta)))
    if sign > 0 and root >= 1:
        raise ValueError(f"wall_friction is {wall_friction!r} and slope {slope!r}: with friction {friction!r} no plane wedge is pushed up")
    return float(numpy.sin(beta - sign * phi) ** 2 /
                 (numpy.sin(beta) ** 2 * numpy.sin(beta + sign * delta) * (1 - sign * root) ** 2))


def earth_pressure(depth: Any, density: Value, friction: Value, *, surcharge: Value = 0.0, cohesion: Value = 0.0,
                   side: str = "active", gravity: Value = G) -> Any:
    """Rankine's pressure (Pa) at `depth` (m) below the surface: K (rho g z + q) -+ 2 c K^1/2; of the active side not below 0.

    A. L. Bell, Min. Proc. ICE 199 (1915) 233-272, for the cohesion."""
    k = rankine(friction, side)
    weight = _not_negative(density, "kg/m3", "density") * _not_negative(gravity, "m/s2", "gravity")
    vertical = weight * _not_negative(depth, "m", "depth") + _si(surcharge, "Pa", "surcharge")
    return numpy.maximum(0.0, k * vertical + _side(side) * 2 * _not_negative(cohesion, "Pa", "cohesion") * numpy.sqrt(k))


def earth_force(height: Value, density: Value, friction: Value, *, surcharge: Value = 0.0, cohesion: Value = 0.0,
                side: str = "active", gravity: Value = G) -> float:
    """Rankine's force (N per metre of wall): `earth_pressure` over `height` (m), without tension."""
    h, k = _positive(height, "m", "height"), rankine(friction, side)
    rise = k * _not_negative(density, "kg/m3", "density") * _not_negative(gravity, "m/s2", "gravity")
    top = k * _si(surcharge, "Pa", "surcharge") + _side(side) * 2 * _not_negative(cohesion, "Pa", "cohesion") * numpy.sqrt(k)
    start = 0.0 if top >= 0 else h if rise * h <= -top else -top / rise  # above, a crack
    return float((top + 0.5 * rise * (h + start)) * (h - start))


# ---- bearing capacity ----------------------------------------------------------------------------


def prandtl() -> float:
    """q/c of a strip on clay, 2 + pi: L. Prandtl, Nachr. Ges. Wiss. Goettingen (1920) 74-85. No unit."""
    return 2.0 + float(numpy.pi)


def n_q(friction: Value) -> float:
    """N_q = e^(pi tan phi) tan^2(45 deg + phi/2): H. Reissner, Proc. 1st Int. Congr. Appl. Mech. Delft (1924) 295-311."""
    phi = _angle(friction, "friction")
    return float(numpy.exp(numpy.pi * numpy.tan(phi)) * numpy.tan(numpy.pi / 4 + phi / 2) ** 2)


def n_c(friction: Value) -> float:
    """N_c = (N_q - 1) cot phi; 2 + pi without friction (Prandtl)."""
    phi = _angle(friction, "friction")
    return float((n_q(phi) - 1) / numpy.tan(phi)) if phi > 1e-7 else prandtl()


def n_gamma(friction: Value, by: str = "vesic") -> float:
    """N_gamma, of q = rho g B N_gamma/2, by approximations of design: "vesic" 2 (N_q + 1) tan phi (Vesic 1973, J. Soil
    Mech. Found. Div. 99, 45-73), "hansen" 1.5 (N_q - 1) tan phi (Brinch Hansen 1970, Danish Geotech. Inst. Bull. 28),
    "meyerhof" (N_q - 1) tan 1.4 phi (Meyerhof 1963, Can. Geotech. J. 1, 16-26)."""
    phi, q = _angle(friction, "friction"), n_q(friction)
    forms = {"vesic": 2 * (q + 1) * numpy.tan(phi), "hansen": 1.5 * (q - 1) * numpy.tan(phi),
             "meyerhof": (q - 1) * numpy.tan(1.4 * phi)}
    if by not in forms:
        raise ValueError(f"by is {by!r}, must be one of {', '.join(forms)}")
    if by == "meyerhof" and phi >= numpy.pi / 2.8:
        raise ValueError(f"friction is {friction!r}, must be below 64.3 deg for Meyerhof's tan 1.4 phi")
    return float(forms[by])


def bearing_capacity(width: Value, density: Value, friction: Value, *, cohesion: Value = 0.0, surcharge: Value = 0.0,
                     by: str = "vesic", gravity: Value = G) -> float:
    """Pressure (Pa) under a strip `width` (m) wide at failure: c N_c + q N_q + rho g B N_gamma/2 (K. Terzaghi 1943)."""
    weight = _not_negative(density, "kg/m3", "density") * _not_negative(gravity, "m/s2", "gravity") * _positive(width, "m", "width")
    return (_not_negative(cohesion, "Pa", "cohesion") * n_c(friction) + _not_negative(surcharge, "Pa", "surcharge") * n_q(friction) +
            0.5 * weight * n_gamma(friction, by))


def soft_over_stiff(width: Value, thickness: Value) -> float:
    """q/c of a rough strip on a clay layer of strength c that is thin against its width, on ground that does not yield:
    pi + 1 + B/(2 H) for H < B/2, Prandtl's 2 + pi else.

    G. G. Meyerhof and T. K. Chaplin, Brit. J. Appl. Phys. 4 (1953) 20-26."""
    return max(prandtl(), float(numpy.pi) + 1 + _positive(width, "m", "width") / (2 * _positive(thickness, "m", "thickness")))


def stiff_over_soft(width: Value, thickness: Value, upper: Value, lower: Value) -> float:
    """q/c_upper of a strip that punches through a layer into softer clay: 1.5 H/B + 5.14 c_lower/c_upper, at most 5.14.

    J. D. Brown and G. G. Meyerhof, Proc. 7th Int. Conf. Soil Mech. Found. Eng. 2 (1969) 45-51: fitted to model tests."""
    ratio = _not_negative(lower, "Pa", "lower") / _positive(upper, "Pa", "upper")
    return min(5.14, 1.5 * _not_negative(thickness, "m", "thickness") / _positive(width, "m", "width") + 5.14 * ratio)


def button(width: Value, thickness: Value, upper: Value, lower: Value) -> float:
    """q/c_upper of a strip on two layers of clay, of strengths `upper` and `lower` (Pa), the upper one `thickness` (m) thick: the
    least over circles through one edge of the strip; an upper bound, on even ground 5.52 (exact 5.14).

    S. J. Button, Proc. 3rd Int. Conf. Soil Mech. Found. Eng. 1 (1953) 332-335."""
    h = _not_negative(thickness, "m", "thickness") / _positive(width, "m", "width")
    ratio = _not_negative(lower, "Pa", "lower") / _positive(upper, "Pa", "upper")
    x, y = numpy.meshgrid(numpy.linspace(0.51, 4.0, 700), numpy.linspace(0.0, 4.0, 801))  # of the centre, from the edge, over B
    r = numpy.hypot(x, y)
    low = numpy.arccos(numpy.minimum(1.0, (y + h) / r))
    return float((2 * r * r * (numpy.arccos(y / r) + (ratio - 1) * low) / (x - 0.5)).min())


# ---- slopes --------------------------------------------------------------------------------------


def infinite_slope(angle: Value, friction: Value, *, cohesion: Value = 0.0, depth: Value = 1.0, density: Value = 1800.0,
                   gravity: Value = G) -> float:
    """Factor of safety of a long, dry slope against sliding at `depth` (m): tan phi/tan beta + c/(rho g z sin beta cos beta)."""
    beta, phi = _angle(angle, "angle"), _angle(friction, "friction")
    weight = _positive(density, "kg/m3", "density") * _positive(gravity, "m/s2", "gravity") * _positive(depth, "m", "depth")
    cohesive = _not_negative(cohesion, "Pa", "cohesion")
    if beta == 0:
        return float("inf")  # nothing drives level ground
    return float(numpy.tan(phi) / numpy.tan(beta) + cohesive / (weight * numpy.sin(beta) * numpy.cos(beta)))


def _bodies(line: Any, centre: Sequence[float], r: float) -> list[tuple[float, float]]:
    """(left, right) between the places where the lower half of a circle cuts the ground, from left to right."""
    found = []
    for start, end in zip(line, line[1:]):
        way, to = end - start, start - numpy.asarray(centre, float)
        a, b, c = way @ way, 2 * (way @ to), to @ to - r * r
        if b * b >= 4 * a * c:
            for share in ((-b - numpy.sqrt(b * b - 4 * a * c)) / (2 * a), (-b + numpy.sqrt(b * b - 4 * a * c)) / (2 * a)):
                at = start + share * way
                if -1e-9 <= share <= 1 + 1e-9 and at[1] <= centre[1] + 1e-9 * r:
                    found.append(float(at[0]))
    found.sort()
    return [(left, right) for left, right in zip(found, found[1:]) if right - left > 1e-6 * r]


def bishop(surface: ArrayLike, centre: Sequence[float], radius: Value, density: Value, friction: Value, cohesion: Value = 0.0, *,
           pore_ratio: float = 0.0, slices: int = 200, gravity: Value = G) -> float:
    """Factor of safety of the body that one circle cuts off, by Bishop's simplified method; exact moments where phi = 0.
    inf: nothing drives it.

    surface     points (x, y) of the ground from left to right, m; the slope falls to the left or to the right
    centre, radius of the circle, m
    pore_ratio  r_u: pore pressure over the weight above, one number

    A. W. Bishop, Geotechnique 5 (1955) 7-17."""
    r, phi = _positive(radius, "m", "radius"), _angle(friction, "friction")
    weight_of = _positive(density, "kg/m3", "density") * _positive(gravity, "m/s2", "gravity")
    _checked(pore_ratio, "", "pore_ratio", lambda found: (found < 0) | (found > 1), "from 0 to 1")
    if not (numpy.diff(numpy.asarray(surface, float)[:, 0]) > 0).all():
        raise ValueError("surface must have its points from left to right, x growing from each to the next")
    driving, weight, sine, wide = 0.0, numpy.zeros(0), numpy.zeros(0), 0.0
    for left, right in _bodies(numpy.asarray(surface, float), centre, r):  # the one that is driven most
        x = left + (right - left) * (numpy.arange(slices) + 0.5) / slices
        base = centre[1] - numpy.sqrt(numpy.maximum(r * r - (x - centre[0]) ** 2, 0.0))
        height = numpy.interp(x, *numpy.asarray(surface, float).T) - base
        part, lean = weight_of * height * (right - left) / slices, (x - centre[0]) / r
        if height.min() > 0 and abs(moment := float((part * lean).sum())) > abs(driving):
            driving, weight, sine, wide = moment, part, lean, (right - left) / slices
    if driving == 0.0:
        return float("inf")
    sine = numpy.sign(driving) * sine
    cosine = numpy.sqrt(1 - sine**2)
    resisting = _not_negative(cohesion, "Pa", "cohesion") * wide + weight * (1 - pore_ratio) * numpy.tan(phi)
    factor = 1.0
    for _ in range(100):
        found = float((resisting / (cosine + sine * numpy.tan(phi) / factor)).sum()) / abs(driving)
        if abs(found - factor) < 1e-10 * factor:
            break
        factor = found
    return factor


# ---- consolidation -------------------------------------------------------------------------------


def terzaghi(time_factor: Any, depth: Any) -> Any:
    """Excess pore pressure over its first value, in a layer that drains at depth 0 and rests on an impervious base at depth 1:
    `time_factor` T = c_v t/H^2, `depth` z/H; one of them may be an array, or both of shapes that broadcast.

    K. Terzaghi and O. K. Froehlich (1936): the Fourier series, for T above 1e-4."""
    _checked(depth, "", "depth", lambda found: (found < 0) | (found > 1), "from 0 to 1")
    factors, places = _not_negative(time_factor, "", "time_factor"), numpy.asarray(depth, float)
    t, z = numpy.broadcast_arrays(numpy.asarray(factors)[..., None], places[..., None])
    m = numpy.pi * (numpy.arange(200) + 0.5)
    found = (2 / m * numpy.sin(m * z) * numpy.exp(-(m**2) * t)).sum(axis=-1)
    return float(found) if found.ndim == 0 else found


def consolidation_degree(time_factor: Any) -> Any:
    """Settlement over the final one of Terzaghi's layer at T = c_v t/H^2: .5 at T = .197, .9 at .848."""
    t = numpy.asarray(_not_negative(time_factor, "", "time_factor"))[..., None]
    m = numpy.pi * (numpy.arange(2000) + 0.5)
    found = 1 - (2 / m**2 * numpy.exp(-(m**2) * t)).sum(axis=-1)
    return float(found) if found.ndim == 0 else found


# ---- elasticity ----------------------------------------------------------------------------------


def hertz(depth: Any, radius: Value, young: Value, poisson: float) -> Any:
    """Force (N) that presses a rigid sphere `depth` (m) into a half space: 4/3 E/(1 - nu^2) R^1/2 depth^3/2.

    H. Hertz, J. reine angew. Math. 92 (1882) 156-171. Two bodies: put 1/R = 1/R1 + 1/R2, 1/E* = sum (1 - nu^2)/E."""
    nu = _checked(poisson, "", "poisson", lambda found: (found <= -1) | (found > 0.5), "from above -1 to 0.5")
    modulus = _positive(young, "Pa", "young") / (1 - nu**2)
    return 4 / 3 * modulus * numpy.sqrt(_positive(radius, "m", "radius")) * _not_negative(depth, "m", "depth") ** 1.5


class Stress(NamedTuple):
    """Stress (Pa) in polar coordinates."""

    radial: Any
    hoop: Any
    shear: Any


def kirsch(r: Any, angle: Any, radius: Value, across: Value, along: Value = 0.0) -> Stress:
    """Stress around a circular hole of `radius` (m) in a plate under stresses `across` (x) and `along` (y), Pa, at distance r
    (m) from its middle and `angle` (rad) from the x axis: three times `across` less `along` at the hole's top.

    G. Kirsch, Z. VDI 42 (1898) 797-807."""
    a = _positive(radius, "m", "radius")
    a2 = (a / _checked(r, "m", "r", lambda found: found < a * (1 - 1e-12), f"outside the hole, at least {a:g}")) ** 2
    sx, sy, twice = _si(across, "Pa", "across"), _si(along, "Pa", "along"), 2 * _si(angle, "rad", "angle")
    mean, half = 0.5 * (sx + sy), 0.5 * (sx - sy)
    return Stress(mean * (1 - a2) + half * (1 - 4 * a2 + 3 * a2**2) * numpy.cos(twice),
                  mean * (1 + a2) - half * (1 + 3 * a2**2) * numpy.cos(twice),
                  -half * (1 + 2 * a2 - 3 * a2**2) * numpy.sin(twice))


# ---- waves ---------------------------------------------------------------------------------------


def _layers(layers: Sequence[Mapping[str, Any]], also: tuple[str, ...] = ()) -> list[dict[str, Any]]:
    """Layers with numbers of SI, the last being a half space; a key besides those known and `also`, or a value out of range, is an
    error that names the layer."""
    if len(layers) < 2:
        raise ValueError(f"there are {len(layers)} layers, must be one at least above the half space")
    known = ("thickness", "vs", "density", "damping", *also)
    made = []
    for k, layer in enumerate(layers):
        which = f"of layer {k + 1}" if k + 1 < len(layers) else "of the half space"
        for key in layer:
            if key not in known:
                raise ValueError(f"{key!r} {which} is unknown, must be one of {', '.join(known)}")
        for key in ("thickness", "vs", "density")[k + 1 == len(layers):]:
            if key not in layer:
                raise ValueError(f"the {key} {which} is missing")
        found = {**layer, **{key: _positive(layer[key], unit, f"{key} {which}")
                             for key, unit in (("vs", "m/s"), ("density", "kg/m3"), ("vp", "m/s")) if key in layer}}
        if k + 1 < len(layers):
            found["thickness"] = _positive(layer["thickness"], "m", f"thickness {which}")
        found["damping"] = _checked(layer.get("damping", 0.0), "", f"damping {which}", lambda h: (h < 0) | (h >= 1), "a ratio from 0 to below 1")
        made.append(found)
    return made


def layers_transfer(frequency: Any, layers: Sequence[Mapping[str, Any]], *, over: str = "outcrop") -> Any:
    """Complex motion of the surface over that of the rock, for shear waves that rise through level layers.

    layers  from the surface down, each with thickness (m), vs (m/s), density (kg/m3) and damping (ratio, 0 where not
            given); the last one is the half space below, whose thickness is not read
    over    "outcrop": the rock's motion where no layers lie on it; "within": the motion at its top, below them; also
            of a base that moves as it is told
    damping of a layer is a number, the same at all frequencies, or mass= (1/s) and stiffness= (s) of Rayleigh's

    N. A. Haskell, Bull. Seism. Soc. Am. 43 (1953) 17-34; S. L. Kramer, Geotechnical Earthquake Engineering (1996) 7.2.1.4."""
    if over not in ("outcrop", "within"):
        raise ValueError(f"over is {over!r}, must be 'outcrop' or 'within'")
    f = _not_negative(frequency, "Hz", "frequency")
    w = 2 * numpy.pi * numpy.where(f == 0, 1e-9, f)
    up = down = numpy.ones(numpy.shape(f), complex)
    made = []
    for layer in _layers(layers, ("mass", "stiffness", "vp")):
        heavy = layer["density"] * (1 - 1j * layer.get("mass", 0.0) / w)
        stiff = layer["density"] * layer["vs"] ** 2 * (1 + 2j * layer["damping"] + 1j * layer.get("stiffness", 0.0) * w)
        made.append((layer.get("thickness", 0.0), w * numpy.sqrt(heavy / stiff), numpy.sqrt(heavy * stiff)))
    for (thick, k, z), (_, _, below) in zip(made, made[1:]):
        e, ratio = numpy.exp(1j * k * thick), z / below
        up, down = (0.5 * (up * (1 + ratio) * e + down * (1 - ratio) / e), 0.5 * (up * (1 - ratio) * e + down * (1 + ratio) / e))
    found = 1 / up if over == "outcrop" else 2 / (up + down)
    return complex(found) if numpy.ndim(f) == 0 else found


def wave_number(period: Value, depth: Value, *, gravity: Value = G) -> float:
    """Wave number k (rad/m) of linear waves of `period` (s) in water of `depth` (m; "inf" for deep water):
    w^2 = g k tanh(k h)."""
    w, h, g = 2 * numpy.pi / _positive(period, "s", "period"), _positive(depth, "m", "depth"), _positive(gravity, "m/s2", "gravity")
    k = w * w / g
    if numpy.isinf(h):
        return float(k)
    k = max(k, w / numpy.sqrt(g * h))  # above the root of neither limit
    for _ in range(50):
        t = numpy.tanh(k * h)
        step = (g * k * t - w * w) / (g * t + g * k * h * (1 - t * t))
        k -= step
        if abs(step) < 1e-15 * k:
            break
    return float(k)


def wave_length(period: Value, depth: Value, *, gravity: Value = G) -> float:
    """Wave length 2 pi/k (m) of linear waves, see `wave_number`."""
    return 2 * float(numpy.pi) / wave_number(period, depth, gravity=gravity)


def goda(**wave_and_wall: Any) -> Any:
    """Pressures (Pa), force (N/m) and moment (N m/m) of the highest wave on a caisson, by the library's own evaluation
    of Y. Goda, Proc. 14th Int. Conf. Coastal Eng. (1974) 1702-1720: keywords of libmps.goda_evaluate (height, period, depth,
    crest, width, ...)."""
    return libmps.goda_evaluate(**wave_and_wall)


def jet_force(density: Value, speed: Value, thickness: Value, angle: Value = "90 deg") -> float:
    """Force (N per metre) of a steady sheet of fluid that a body turns by `angle` from its way: rho v^2 b (1 - cos angle),
    the momentum that it loses each second; a plate much wider than the sheet turns it by 90 deg."""
    turned = _si(angle, "rad", "angle")
    return float(_positive(density, "kg/m3", "density") * _si(speed, "m/s", "speed") ** 2 * _positive(thickness, "m", "thickness") *
                 (1 - numpy.cos(turned)))


def dam_break(x: Any, t: Value, depth: Value, *, gravity: Value = G) -> Any:
    """Depth (m) at x (m, the dam at 0, water of `depth` at x < 0) a time t (s) after the dam has gone, on a dry bed.

    A. Ritter, Z. VDI 36 (1892) 947-954: shallow water, no friction."""
    h, g, at = _positive(depth, "m", "depth"), _positive(gravity, "m/s2", "gravity"), _si(x, "m", "x")
    celerity = numpy.sqrt(g * h)
    return numpy.clip(2 * celerity - at / _positive(t, "s", "t"), 0.0, 3 * celerity) ** 2 / (9 * g)
