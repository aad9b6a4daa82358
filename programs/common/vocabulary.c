/* vocabulary.c - see vocabulary.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "vocabulary.h"

#include "record.h"

#include <stdio.h>
#include <string.h>

#define FROM_TO(lower, upper) lower, upper, false
#define ABOVE_TO(lower, upper) lower, upper, true
/* Wide enough for any model of soil, structures or water, and narrow enough that no computation
 * with them overflows. */
#define LENGTH FROM_TO(1e-6, 1e6)
#define DURATION FROM_TO(1e-9, 1e6)
#define SPEED FROM_TO(1e-6, 1e5)
#define FREQUENCY FROM_TO(1e-4, 1e6)
#define ACCELERATION FROM_TO(-1e5, 1e5)
#define GRAVITY FROM_TO(0.0, 1e4)
#define DENSITY FROM_TO(1e-3, 1e5)
#define MODULUS FROM_TO(1e-3, 1e16)
#define STRENGTH FROM_TO(0.0, 1e11)
#define STIFFNESS FROM_TO(1e-3, 1e16)

/* NULL where a program has to say: of a choice its words, of a text what it is made of. */
#define NUMBER(name, unit, range, help)                                                            \
  { name, OPTION_IS_NUMBER, unit, {range}, help }
#define INTEGER(name, unit, range, help)                                                           \
  { name, OPTION_IS_INTEGER, unit, {range}, help }
#define CHOICE(name, words, help)                                                                  \
  { name, OPTION_IS_CHOICE, words, {FROM_TO(0.0, 0.0)}, help }
#define TEXT(name, what, help)                                                                     \
  { name, OPTION_IS_TEXT, what, {FROM_TO(0.0, 0.0)}, help }
#define FLAG(name, help)                                                                           \
  { name, OPTION_IS_FLAG, NULL, {FROM_TO(0.0, 0.0)}, help }

/* In the order of the alphabet. */
static const struct {
  const char *name;
  option_kind kind;
  const char *unit;
  option_range range;
  const char *help;
} rows[] = {
    CHOICE("absorb", NULL,
           "how waves are absorbed: active, the maker, and without a wall the far end, follow the "
           "level at their face; zone, waves fade before the far end"),
    NUMBER("acceleration", "m/s2", ACCELERATION, "largest acceleration of the pulse or sine"),
    NUMBER("accuracy", "1", ABOVE_TO(1.0, 100.0),
           "ratio of the bounds at which the bisection ends; the paper uses 1.01 with 2.2 and 1.2 "
           "with 1e15"),
    NUMBER("adhesion", "1", FROM_TO(0.001, 10.0),
           "shear stress on the surface at most, over the cohesion"),
    FLAG("also-axisymmetric", "after the run in space, the same about an axis, to compare"),
    NUMBER("amplitude", "m", FROM_TO(0.0, 1e3), "amplitude"),
    INTEGER("animation", "N", FROM_TO(0.0, 400.0),
            "frames of an animation of the last three periods (0: none)"),
    NUMBER("apex-angle", "degrees", FROM_TO(20.0, 160.0), "angle of the cone's apex"),
    NUMBER("aspect", "1", FROM_TO(0.1, 20.0), "height over width of the column, a = H0/L0"),
    FLAG("axisymmetric", "symmetric about an axis: x is the radius"),
    NUMBER("band", "m", LENGTH, "width of the band that softens"),
    CHOICE("base", NULL, "what is below the ground"),
    NUMBER("base-unit-weight", "N/m3", FROM_TO(1.0, 1e6),
           "unit weight of the half space; default that of the lowest layer"),
    NUMBER("base-vp", "m/s", FROM_TO(0.1, 1e5),
           "Vp of the half space; default that of the lowest layer"),
    NUMBER("base-vs", "m/s", FROM_TO(0.1, 1e5),
           "Vs of the half space; default that of the lowest layer"),
    CHOICE("baseline", "linear|none|mean|quadratic|cubic", "baseline correction of a record"),
    CHOICE("bed", NULL, "bed of the tank"),
    NUMBER("below-toe", "m", FROM_TO(0.0, 1e6), "depth of ground below the toe"),
    NUMBER("bending", "1", FROM_TO(0.0, 1.0),
           "a cell's own stiffness against bending; without it thin parts are too soft"),
    NUMBER("blow-count", "1", FROM_TO(1.0, 60.0), "blow count (N1)60 of the sand"),
    CHOICE("body", NULL, "which of the two is rigid; disc: it is free, and the slope elastic"),
    NUMBER("bulk", "Pa", MODULUS, "newtonian: bulk modulus"),
    NUMBER("c1", "1", FROM_TO(1e-4, 100.0), "constant C1 of the contraction"),
    NUMBER("c2", "1", FROM_TO(0.0, 100.0), "constant C2; default 0.4/C1"),
    NUMBER("c3", "1", FROM_TO(1e-4, 100.0),
           "constants C3 and C4: the equation of Martin, Finn and Seed, not that of Byrne"),
    NUMBER("c4", "1", FROM_TO(1e-4, 100.0), "constant C4"),
    CHOICE("case", NULL, "the problem"),
    NUMBER("cell", "m", LENGTH, "side of a cell of the grid"),
    TEXT("checkpoint", "FILE",
         "written during the run and at Ctrl-C, to continue with --restart (default "
         "OUT/checkpoint.h5)"),
    NUMBER("cohesion", "Pa", STRENGTH, "cohesion c"),
    FLAG("compare", "three columns: sand; phi/2 and c = 0.05 rho g H; clay of c = 0.15 rho g H"),
    CHOICE("cone", "planestrain|circumscribed|inscribed|extension",
           "where the cone of Drucker and Prager agrees with Mohr and Coulomb"),
    TEXT("config", "FILE", "preCICE's configuration"),
    CHOICE("contact", "impulse|penalty",
           "impulses at the surface, or springs at the particles, Nakamura (28) to (34)"),
    FLAG("convergence", "also compare both methods and finite elements at four sizes"),
    NUMBER("corner", "1", FROM_TO(0.0, 2.0), "radius of edges for the soil, in cells; impulses"),
    FLAG("coupled",
         "the wall moves the water too, in every step until both agree; else it is loaded only"),
    TEXT("coupling-mesh", "NAME", "name of the participant's mesh"),
    NUMBER("courant", "1", FROM_TO(1e-3, 1.0), "time step over the stability limit"),
    NUMBER("crest", "m", LENGTH,
           "level ground behind the crest; default 1.2 times height and depth below the toe"),
    NUMBER("criterion", "m/s2", FROM_TO(1e-6, 1e30),
           "a run is unstable when any acceleration exceeds it; default 2.2, Euler 1e15, as in the "
           "paper"),
    NUMBER("csr", "1", ABOVE_TO(0.0, 10.0),
           "cyclic: stress in place of --strain, shear over first vertical effective stress "
           "(triaxial: q over twice p0)"),
    NUMBER("curvature", "1", FROM_TO(0.5, 1.0), "smallstrain: exponent of the backbone"),
    INTEGER("cycles", "N", FROM_TO(1.0, 1000.0), "number of cycles"),
    NUMBER("damping", "1", FROM_TO(0.0, 1.0),
           "Rayleigh damping ratio h at f1 and f2; 0.05 is 5 % of critical"),
    CHOICE("damping-form", "pair|particle",
           "Rayleigh damping by pairs, which keeps momentum, or by the h of each particle, Yoshida "
           "(A1) to (A24)"),
    TEXT("data", "NAME", "name of the data in it"),
    NUMBER("density", "kg/m3", DENSITY, "density"),
    NUMBER("density-at", "m", FROM_TO(0.0, 1e6),
           "x of a vertical line on which the density of the particles is given over the height at "
           "the end"),
    NUMBER("depth", "m", LENGTH, "depth"),
    NUMBER("diameter", "m", LENGTH, "D of the tip, at least 4 cells; pressures are over pi D^2/4"),
    TEXT("displacement", "NAME", "name of the displacements in preCICE's configuration,"),
    NUMBER("disturb", "spacings", FROM_TO(0.0, 0.2),
           "random displacement of the water's particles at the start, at most"),
    NUMBER("draft", "m", LENGTH,
           "draft of the box, half its height: its mass is that of the water there"),
    NUMBER("drain-ratio", "1", FROM_TO(2.0, 64.0),
           "barron: n, radius of the cylinder over that of the drain"),
    CHOICE("drainage", NULL, "sides of a layer that drain; T counts its whole height in any case"),
    FLAG("drained", "cyclic: vertical (triaxial: lateral) stress stays, not the volume"),
    NUMBER("drawdown", "m", FROM_TO(-1e6, 1e6),
           "level above the toe from which a pool has fallen to --water-level at once, undrained: "
           "the pressures are less the load that the ground has lost"),
    NUMBER("dt", "s", DURATION, "time step"),
    NUMBER("duration", "s", DURATION, "simulated time"),
    NUMBER("e0", "1", FROM_TO(0.01, 20.0), "void ratio at the start"),
    NUMBER("eccentricity", "m", FROM_TO(0.0, 1e3),
           "distance of the load on a strip from its middle; it is free to turn about the line of "
           "the load; von Mises"),
    CHOICE(
        "edge", "mirror|fit",
        "shape functions at rollers and fixed sides: with images of the nodes inside, or fitted to "
        "the nodes that there are, Nakamura (5), (6)"),
    NUMBER("edge-stress", "Pa", FROM_TO(1e-9, 1e15), "stress at the far edge"),
    NUMBER("emax", "1", FROM_TO(0.01, 20.0),
           "void ratio at which dilation ends, from --e0, which is emax - Dr (emax - emin)"),
    CHOICE("end", NULL,
           "what is behind a structure: water leaves there, or the flume continues to --length "
           "with an end as without a structure"),
    NUMBER("end-load", "N/m", FROM_TO(1e-9, 1e15), "load P at the end, downwards"),
    CHOICE("equation-of-state", NULL, "pressure from density"),
    NUMBER("every-checkpoint", "s", DURATION, "simulated time between checkpoints"),
    NUMBER("f1", "Hz", FREQUENCY, "first frequency of the damping"),
    NUMBER("f2", "Hz", FREQUENCY, "second frequency of the damping"),
    NUMBER("factor", "1", FROM_TO(0.05, 20.0),
           "divides c and tan(phi) of the one trial; default: the factor of safety is sought"),
    NUMBER("factor-tolerance", "1", FROM_TO(1e-3, 1.0),
           "tolerance of the factor of safety: between one that stands and one that fails"),
    NUMBER("falls", "(H/g)^1/2", FROM_TO(1e-3, 1e6), "simulated time at most, in times of fall"),
    CHOICE("fill", NULL, "how particles fill an elastic disc"),
    NUMBER("flip-time", "s", FROM_TO(0.0, 1e6),
           "time in which a particle loses what the nodes do not represent of its velocity; 0: at "
           "each step"),
    NUMBER("focus", "m", FROM_TO(0.0, 1e6),
           "X,T: station (m) and time (s) of the focus of a group of waves"),
    TEXT("force", "NAME", "name of the forces in it,"),
    CHOICE("form", NULL, "active absorption: complete at --period, or for long waves"),
    INTEGER("frames", "N", FROM_TO(0.0, 100000.0), "frames of the series for ParaView (0: none)"),
    FLAG("free", "the box falls by itself, without a coupling"),
    NUMBER("freeboard", "m", LENGTH, "crest of the wall above the water at rest"),
    NUMBER("frequency", "Hz", FREQUENCY, "frequency of the pulse or sine"),
    NUMBER(
        "frequency-ratio", "1", FROM_TO(0.05, 20.0),
        "resonance: frequency of the waves over that of the wall in water, which gives its spring"),
    NUMBER("friction", "1", FROM_TO(0.0, 10.0), "Coulomb's coefficient mu of the contact"),
    NUMBER("friction-factor", "1", FROM_TO(0.0, 10.0),
           "f of water on faces, of Fanning: stress rho f v^2/2"),
    NUMBER("gamma", "1", FROM_TO(1.0, 20.0), "peak enhancement of JONSWAP"),
    TEXT("gauge", "m,...", "stations of level gauges"),
    CHOICE(
        "gradient", "derivative|fit",
        "velocity gradient that the law receives: of the field that the shape functions span, or "
        "the slope of the fit, Nakamura (42)"),
    NUMBER("gravity", "m/s2", GRAVITY, "g"),
    NUMBER("half-width", "m", LENGTH, "B/2 of a strip, radius of a circle"),
    NUMBER("hardening", "Pa", STRENGTH, "vonmises: linear hardening, per plastic strain"),
    NUMBER("height", "m", LENGTH, "height"),
    FLAG("impact", "by MPS: a column H high and 2 H = --width wide (default 1.2 m) hits a wall at "
                   "5.366 H; its pressure at .2 H against Buchner (2002)"),
    NUMBER("incline", "m", LENGTH,
           "X1,X2,H2: the surface falls from the height at x = X1 to the height H2 at x = X2"),
    NUMBER("influence", "spacings", ABOVE_TO(1.0, 4.0),
           "radius of influence; default 1.5 (conservative), 3 (published)"),
    NUMBER("initial", "Pa", FROM_TO(100.0, 1e9),
           "mcc: vertical effective stress before the load, the largest so far"),
    NUMBER("inner-diameter", "m", LENGTH, "inner diameter of the pile"),
    NUMBER("inset", "1", FROM_TO(0.0, 2.0),
           "how far before edges of a body its faces end for the soil, in cells; in place of "
           "--corner"),
    CHOICE("integrator", "verlet|leapfrog|euler", "time integration"),
    NUMBER("ir", "1", FROM_TO(1.0, 1e5),
           "rigidity index G/su instead of --young; clay, tresca, mcc; su, which N_kt refers to "
           "too, is that of triaxial compression, half the largest q: of clay 0.866 of the "
           "cohesion, of tresca the cohesion"),
    NUMBER("k", "N/m", STIFFNESS,
           "contact stiffness per unit thickness of each particle, Nakamura (28)"),
    NUMBER("k0", "1", FROM_TO(0.0, 10.0), "horizontal over vertical effective stress at the start"),
    NUMBER("kappa", "1", FROM_TO(1e-5, 5.0), "mcc: slope of unloading"),
    NUMBER("lambda", "1", FROM_TO(1e-4, 5.0), "mcc: slope of virgin compression in e - ln p"),
    CHOICE("law", NULL, "law of the ground"),
    TEXT("layers", "FILE",
         "horizontal layers from the surface down; a header names the columns, in any order and "
         "unit"),
    NUMBER("length", "m", LENGTH, "length"),
    TEXT("levels", "FILE",
         "level of the water at x = 0: columns whose header names time, level and units; s and m "
         "without"),
    TEXT("levels-column", "NAME", "column of --levels, of a file with several gauges"),
    FLAG("linear", "linear fall of the strength, over at --slip"),
    NUMBER("load", "Pa", ABOVE_TO(0.0, 1e12), "pressure put on the ground"),
    NUMBER("load-ramp", "T", FROM_TO(0.0, 10.0),
           "time in which the load on a layer grows evenly; 0: at once"),
    TEXT("loads", "Pa,...",
         "pressures on a layer, ascending, in place of --load: steps of an oedometer, each of "
         "which lasts as long as the last of --times, which then count from its beginning"),
    FLAG("lode", "mcc: M follows the Lode angle"),
    NUMBER("loop", "m", FROM_TO(0.0, 1e4), "depth of which loop.csv has strain and stress"),
    NUMBER("M", "1", FROM_TO(0.05, 2.9),
           "mcc: slope of the critical state line in compression, q/p"),
    NUMBER("mass", "kg", FROM_TO(1e-6, 1e12),
           "mass of the wall on a spring (default 10, of resonance 100)"),
    NUMBER("mass-damping", "1/s", FROM_TO(0.0, 1e6), "viscous damping by the velocity"),
    NUMBER("max-frequency", "Hz", FROM_TO(0.1, 1000.0),
           "highest frequency that counts: twenty cells to its wave length in the softest layer"),
    TEXT("mesh", "FILE",
         "closed STL mesh for --tip stl: lowest point at its origin, z upwards; a quarter of it is "
         "pushed unless --symmetry whole"),
    CHOICE("method", NULL, "how it is computed"),
    TEXT("model", "FILE",
         "bed, structure, caisson, rock, probes and any of these options in a text file (YAML); "
         "options on the command line count more"),
    NUMBER("moist-density", "kg/m3", DENSITY,
           "density of the ground above --water-level; default --density"),
    CHOICE("motion", NULL, "of the wall: as a whole, or turning about its toe or its top"),
    CHOICE("n", NULL,
           "divisor of the sums (published): number density at a particle, or the same for all"),
    INTEGER("n2", "1", FROM_TO(1.0, 2.0), "n^2, height over width of the column"),
    CHOICE("negative-pressure", NULL, "what becomes of negative pressure"),
    NUMBER("ocr", "1", FROM_TO(1.0, 1000.0), "mcc: largest former stress over the present one"),
    NUMBER("offset", "cells", FROM_TO(-1.0, 1.0), "shift of the grid along x and y"),
    CHOICE("order", NULL,
           "theory of the maker: sums and differences of all pairs of components; linear; "
           "differences alone, as of a narrow band; the stream function, of regular long waves"),
    TEXT("out", "DIR", "directory of the results"),
    NUMBER("p0", "Pa", FROM_TO(0.0, 1e11),
           "first mean effective pressure; laws of F or V/V0 begin without stress"),
    FLAG("paper", "the case and the method of the paper, but for the options that are given"),
    TEXT("participant", "NAME", "name of this participant"),
    CHOICE("passed", NULL,
           "what becomes of water that has passed the crest: within some two periods it returns to "
           "the surface near the maker, so that the mean level stays; or the flume loses it"),
    CHOICE("path", NULL,
           "isotropic, oedometer, triaxial undrained and drained, plane strain, triaxial extension "
           "(both undrained), simple shear, and that to and fro; triaxial compression and "
           "extension in turns"),
    TEXT("path-file", "FILE",
         "CSV of stages instead: increments of strain exx, eyy, ezz, gxy, gzx, gyz or of stress "
         "sxx, syy, szz, sxy, szx, syz (Pa), tension positive, and steps; an empty cell is no "
         "strain"),
    NUMBER("peak-time", "s", FROM_TO(0.0, 1e6), "time of the largest acceleration of the pulse"),
    NUMBER("period", "s", DURATION, "period of the waves"),
    NUMBER("permeability", "m/s", ABOVE_TO(0.0, 1.0), "coefficient of permeability"),
    NUMBER("phi", "degrees", FROM_TO(0.0, 60.0), "angle of friction of the soil"),
    NUMBER("plate-density", "kg/m3", DENSITY, "density of the plate"),
    NUMBER("plate-length", "m", LENGTH, "length of the plate"),
    NUMBER("plate-thickness", "m", LENGTH, "thickness of the plate"),
    NUMBER("poisson", "1", FROM_TO(0.0, 0.49), "Poisson's ratio nu"),
    NUMBER("porosity", "1", FROM_TO(0.01, 1.0), "porosity"),
    INTEGER("ppc", "N", FROM_TO(1.0, 100.0), "particles a cell"),
    CHOICE("pressure", NULL, "of the ground on the wall: the wall moves away from it or into it"),
    TEXT("profile", "m,...",
         "X,Y,X,Y,...: the face from the toe 0,0 over slopes, berms and crest to its rear edge, "
         "distance from the toe and height above the bed"),
    NUMBER("psi", "degrees", FROM_TO(0.0, 60.0), "angle of dilation"),
    NUMBER("radius", "m", LENGTH, "radius of the hole"),
    NUMBER("ramp", "s", FROM_TO(0.0, 1e6), "time in which the maker's amplitude rises"),
    CHOICE("random", NULL, "what is random of the components of a sea"),
    NUMBER("rate", "m/s", FROM_TO(1e-6, 10.0), "speed at which the body is driven"),
    NUMBER("rate-factor", "1", FROM_TO(0.0, 10.0), "growth of the strength for a tenfold rate"),
    NUMBER("rate-reference", "1/s", FROM_TO(1e-12, 1e6), "rate up to which there is no growth"),
    CHOICE("reads", NULL, "kind of the data that are read: N on each vertex, or Pa"),
    INTEGER("receivers", "N", FROM_TO(2.0, 1000.0),
            "receivers along the middle column, surface and base included"),
    TEXT("record", NULL, "motion: a pulse, or a recorded acceleration: " RECORD_FILES ""),
    TEXT("record-column", "NAME", "column of a record with several in its header"),
    NUMBER("record-scale", "1", FROM_TO(-1e6, 1e6), "factor on a record"),
    NUMBER("record-step", "s", DURATION,
           "time between the values of a record without times; default by its header"),
    CHOICE("record-unit", "file|m/s2|g|gal",
           "unit of a record; file: what it says, m/s2 where it names none"),
    NUMBER("reference-strain", "1", FROM_TO(1e-7, 1.0),
           "smallstrain: gamma at which half of G is left"),
    NUMBER("relative-density", "1", FROM_TO(0.1, 1.0),
           "relative density Dr of the sand; default 0.5 where neither (N1)60 nor C1 is given"),
    NUMBER("repeat", "s", DURATION,
           "time after which the sea repeats itself (default: the duration, at least 20 periods)"),
    NUMBER("residual", "1", FROM_TO(0.0, 1.0), "vonmises, tresca: last over first strength"),
    NUMBER("residual-cohesion", "Pa", STRENGTH, "cohesion at last; default cohesion"),
    NUMBER("residual-phi", "degrees", FROM_TO(0.0, 60.0), "angle of friction at last; default phi"),
    NUMBER("rest", "s", FROM_TO(0.0, 1e6),
           "time before the pile moves, to see whether the soil rests"),
    TEXT("restart", "FILE",
         "continue a checkpoint made with the same options (but --out, --threads and those of "
         "checkpoints); the results are those of the whole run, frames for ParaView those from "
         "here on; where --out has results already they go to OUT-from-T"),
    TEXT("rock", "m,...",
         "X,Y,X,Y,...: corners of a region of rock, from the maker and above the bed"),
    NUMBER("rock-alpha", "1", FROM_TO(0.0, 1e6), "resistance of rock to slow flow (Darcy)"),
    NUMBER("rock-beta", "1", FROM_TO(0.0, 1e3), "resistance of rock to fast flow (Forchheimer)"),
    CHOICE("rotation", "mean-matrix|mean-angle", "how the rigid rotation of a pair is removed"),
    NUMBER("ru", "1", FROM_TO(0.0, 0.9),
           "pressure of the water over the weight of the ground above, everywhere"),
    FLAG("runout", "how far the ground goes whose strength, divided by --factor (default 1), "
                   "softens, until it rests"),
    NUMBER("sample", "s", DURATION, "time between rows of the tables"),
    NUMBER("scale", "m", LENGTH, "unit of the mesh"),
    CHOICE("scheme", NULL,
           "pressures of the pores in time: explicit, or by the solution of a system in each step, "
           "which may then be longer; strip settles, where both are the same; default implicit "
           "with --layers"),
    NUMBER("section", "m", FROM_TO(-1e6, 1e6),
           "x of a vertical line on which the stresses are given over the depth at the end"),
    INTEGER("seed", "N", FROM_TO(0.0, 1e9), "number of the sequence of random numbers"),
    CHOICE("seepage", NULL,
           "pressures below a line: of water at rest, or of water that flows along it, cos^2 of "
           "its inclination times that"),
    NUMBER("settlement", "m", LENGTH,
           "where the run ends; default 0.6 mm or 120 c/E half widths, Drucker-Prager 4 mm"),
    CHOICE("shape", NULL, "of the footing; circle: axisymmetry; cohesive ground"),
    NUMBER("share", "1", ABOVE_TO(0.0, 1.0),
           "fraction of the density error that the classical scheme corrects in a step"),
    NUMBER("shear-modulus", "Pa", MODULUS,
           "mcc: constant G, default by Poisson's ratio; smallstrain: G at zero strain, default by "
           "Young's modulus"),
    NUMBER("sheet", "m", FROM_TO(0.0, 1e6),
           "length of the wall below the ground in front, whole cells, beside which no pressure is "
           "counted; default 2 cells with --pressure active and --below-toe of at least 4 cells, "
           "but not with --motion toe"),
    NUMBER("side", "m", LENGTH, "side of the plate; hole: of the quarter (default 4 radii)"),
    CHOICE("sides", NULL, "the sides of the model"),
    NUMBER("slip", "m", LENGTH,
           "displacement across a band at which 1/e of the fall of the strength is left"),
    NUMBER("slope", "1", FROM_TO(0.0, 100.0), "inclination of the face: horizontal per vertical"),
    NUMBER("slope-angle", "degrees", FROM_TO(1.0, 60.0),
           "inclination of the slope that the disc rolls down"),
    TEXT("soil", NULL, "size of the ground in m, whole cells"),
    CHOICE("solver", "own|multigrid|direct",
           "of the pressure: the library's, the same bit for bit on all numbers of ranks; or "
           "PETSc's algebraic multigrid, for a hundred thousand particles and more, or its direct "
           "solver: they agree within the tolerance"),
    NUMBER("sound-speed", "m/s", SPEED,
           "speed of sound c, K = rho c^2 (default 10 sqrt(2 g n^2 a))"),
    NUMBER("spacing", "m", LENGTH, "distance of neighbouring particles"),
    NUMBER("speed", "m/s", SPEED, "highest speed of the maker: waves that need more are refused"),
    CHOICE("spline", "2|3", "degree of the weights"),
    NUMBER("stabilisation", "1", FROM_TO(0.03, 100.0),
           "coefficient of the stabilisation (conservative)"),
    NUMBER("start", "m", FROM_TO(0.0, 1e4),
           "depth of the lowest point at the start, in a hole that cone and shaft fill; 0: above "
           "the ground"),
    CHOICE("state", "stress|strain", "plane stress or plane strain"),
    INTEGER("steps", "N", FROM_TO(1.0, 1e6), "steps of the path, or of a loop of the cyclic one"),
    NUMBER(
        "stiffness", "N/m", FROM_TO(1e-3, 1e16),
        "stiffness of the spring of the wall (default 211800, of resonance by --frequency-ratio)"),
    FLAG("still", "the gate stays: water at rest"),
    NUMBER("stone", "m", FROM_TO(1e-6, 100.0), "median diameter D50 of the stones of rock"),
    NUMBER("strain", "1", ABOVE_TO(0.0, 10.0),
           "logarithmic, at the end: axial, of the volume (iso), gamma (shear), or its amplitude "
           "(cyclic)"),
    NUMBER("strain-limit", "1", ABOVE_TO(0.0, 1.0),
           "amplitude beyond which larger ones contract no more"),
    NUMBER("strain-rate", "1/s", FROM_TO(1e-12, 1e6),
           "rate of the largest strain, for laws that know time"),
    NUMBER("strength", "Pa", STRENGTH,
           "smallstrain: largest sqrt(J2); default, with curvature 1: that of the backbone"),
    NUMBER("strength-gradient", "Pa/m", FROM_TO(0.0, 1e9), "growth of the cohesion with depth"),
    NUMBER("stroke", "m", LENGTH,
           "farthest position of the maker: waves that need more are refused"),
    FLAG("study", "all cases: V 100 to 800 m/s, h 0.001 to 1, R 0.25 to 1.6 m, S and P waves"),
    CHOICE("support", NULL, "motion of the supported end: as (11) says, or none"),
    NUMBER("surcharge", "Pa", FROM_TO(0.0, 1e9), "vertical pressure on the surface"),
    FLAG("sweep", "columns of a = 0.5, 1, 2, 3, 4, 6 against the law"),
    CHOICE("symmetry", NULL,
           "about an axis; in space, a quarter with rollers on its planes, or all"),
    NUMBER("tank", "widths", FROM_TO(1.5, 1000.0), "distance of the far wall of the tank"),
    NUMBER("tension", "Pa", STRENGTH, "largest tension; default: up to the apex"),
    INTEGER("threads", "N", FROM_TO(0.0, 1024.0), "threads; 0: all processors"),
    NUMBER("threshold", "1", FROM_TO(0.0, 0.01), "amplitude of shear strain without contraction"),
    NUMBER("time-unit", "s", DURATION, "time that T = 1 lasts, which gives the permeability"),
    TEXT("times", "T,...",
         "T = c_v t/H^2, ascending, of the profiles; default 0.05,0.1,0.2,0.5,1, cryer "
         "0.01,0.05,0.1,0.2"),
    CHOICE("tip", NULL, "what is pushed in; cone: with a shaft as thick"),
    NUMBER("toe", "m", LENGTH,
           "level ground in front of the toe, up to whole cells; default 1.5 heights with "
           "--below-toe"),
    NUMBER("tolerance", "1", FROM_TO(1e-14, 1e-2), "residual of the pressure over its right side"),
    NUMBER("top", "m", FROM_TO(0.0, 1e6),
           "thickness of an upper layer of another cohesion; von Mises"),
    NUMBER("top-cohesion", "Pa", FROM_TO(0.0, 1e11),
           "cohesion of the layer --top, over which pressures are then given"),
    CHOICE("torque", "conserving|printed",
           "as derived, which conserves angular momentum, or twice that as the paper prints it"),
    CHOICE("transfer", NULL, "weights from particles to nodes"),
    NUMBER("travel", "m", LENGTH,
           "path of the end of the wall that moves most; default 0.01 of the height, passive 0.02, "
           "three times that with --motion toe"),
    NUMBER("turn", "degrees", FROM_TO(-180.0, 180.0),
           "inclination of block and plates against the grid; forces are along the plates"),
    FLAG("undrained", "water in the pores that does not flow"),
    NUMBER("unit-weight", "N/m3", FROM_TO(1.0, 1e6), "unit weight; density follows with 9.8 m/s2"),
    CHOICE("variant", "wls|flip|pic",
           "WLS-MPM, or the original material point method, Nakamura Table 1, with the velocity of "
           "particles by increments (FLIP) or as that of the nodes (PIC)"),
    TEXT("velocity", "NAME", "name of the velocities in it,"),
    NUMBER("viscosity", "Pa s", FROM_TO(0.0, 1e3), "dynamic viscosity of the water"),
    CHOICE("volumetric", "law|point|cell|nodes",
           "change of volume: as suits the law, each particle's own, F-bar by cell, or means by "
           "nodes"),
    NUMBER("vp", "m/s", FROM_TO(0.1, 1e5), "pressure wave velocity Vp, at least sqrt(2) Vs"),
    NUMBER("vs", "m/s", FROM_TO(0.1, 1e5), "shear wave velocity Vs"),
    CHOICE("wall", NULL,
           "what is at the far end; caisson and slope (a dike) end at --freeboard, a profile where "
           "it ends, and water that passes them falls behind and leaves"),
    NUMBER("wall-density", "kg/m3", DENSITY, "density of the wall"),
    NUMBER("wall-height", "m", LENGTH, "height of the wall above the bed"),
    CHOICE("wall-method", "conservative|published",
           "discretisation of the wall: the library's, or as Chikazawa (10) prints it, corrected"),
    NUMBER("wall-thickness", "m", LENGTH, "thickness of the wall"),
    NUMBER("water-bulk", "Pa", FROM_TO(1e4, 1e11), "K_w, bulk modulus of the water"),
    TEXT("water-level", "m|FILE",
         "level of the water above the toe, of a pool where it is above the ground; or a line, "
         "each of its points x_m from the crest's edge (to the toe) and level_m above the toe, "
         "level beyond its ends; below it phi and cohesion are effective, --density is saturated"),
    NUMBER("water-stiffness", "1", FROM_TO(5.0, 1e4),
           "stiffness of the water, (K_w/n)/M', of --layers the stiffest M'"),
    NUMBER(
        "water-table", "m", FROM_TO(0.0, 1e6),
        "depth of the water below the surface; below it phi and cohesion are effective, densities "
        "saturated; the water is at rest on both sides of the wall, in front up to the ground"),
    CHOICE("wave", "S|P", "shear wave (moves in x) or pressure wave (in y)"),
    NUMBER(
        "wave-velocity", "m/s", SPEED,
        "in place of --vs and --vp: velocity V of the wave as in the paper, S: Vs = V, P: Vp = V"),
    CHOICE("waves", NULL,
           "one wave; seas by a spectrum of JONSWAP or Pierson and Moskowitz; a group whose crests "
           "come together at --focus; those of --levels; a single crest of Boussinesq"),
    NUMBER("width", "m", LENGTH, "width"),
    NUMBER("window", "s", FROM_TO(0.0, 1e6), "T1,T2: the times that are analysed"),
    NUMBER("x", "m", FROM_TO(-1e6, 1e6), "place along x"),
    NUMBER("xi", "1", FROM_TO(0.0, 0.99),
           "instead of --k: k = 2 (1 - xi) m/dt^2 of the first step, Nakamura (58), there 0.6"),
    NUMBER("y", "m", FROM_TO(-1e6, 1e6), "level of the ground"),
    NUMBER("yield", "Pa", ABOVE_TO(0.0, 1e11),
           "vonmises: yield stress; default sqrt(3) times the cohesion"),
    NUMBER("young", "Pa", MODULUS, "Young's modulus E"),
    NUMBER("zone", "wave lengths", FROM_TO(0.1, 100.0), "length of the zone that absorbs"),
    NUMBER("zone-rate", "1/periods", FROM_TO(0.0, 1000.0), "rate of absorption at the zone's end"),
};
enum { ROWS = sizeof rows / sizeof *rows };

static int find(const char *name) {
  int k = 0;
  while (k < ROWS && strcmp(rows[k].name, name) != 0) k++;
  return k < ROWS ? k : -1;
}

static option_kind kind_of(const option *o) {
  return o->number    ? OPTION_IS_NUMBER
         : o->integer ? OPTION_IS_INTEGER
         : o->text    ? OPTION_IS_TEXT
         : o->choice  ? OPTION_IS_CHOICE
                      : OPTION_IS_FLAG;
}

/* All of the words "a|b" of a program are among those of the table. */
static bool are_among(const char *words, const char *all) {
  for (; *words; words += strspn(words, "|")) {
    const size_t length = strcspn(words, "|");
    const char *at = all;
    while (*at && (strcspn(at, "|") != length || strncmp(at, words, length) != 0))
      at += strcspn(at, "|"), at += *at == '|';
    if (!*at) return false;
    words += length;
  }
  return true;
}

static const char *complete(option *o) {
  const int k = find(o->name);
  if (k < 0) return "not in the table of options (common/vocabulary.c)";
  if (rows[k].kind != kind_of(o)) return "of another kind in the table of options";
  if (!o->unit && !rows[k].unit && !o->flag) return "without its words";
  if (o->unit && rows[k].unit && o->unit != rows[k].unit &&
      !(o->choice && are_among(o->unit, rows[k].unit)))
    return "of other words in the table of options";
  if (!o->unit) o->unit = rows[k].unit;
  if (o->range.lower == 0.0 && o->range.upper == 0.0) o->range = rows[k].range;
  o->help = rows[k].help;
  return NULL;
}

const char *vocabulary_complete(option *table, const char **name) {
  for (option *o = table; o->name || o->help; o++) {
    if (!o->name) continue;
    *name = o->name;
    for (const option *other = table; other < o; other++)
      if (other->name && strcmp(other->name, o->name) == 0) return "twice in the program's table";
    const char *fault = complete(o);
    if (fault) return fault;
  }
  return NULL;
}

bool vocabulary_has(const char *name) { return find(name) >= 0; }

/* ---- units ----------------------------------------------------------------------------------- */

/* Less than the softest clay, the loosest powder, foam. */
static const struct {
  const char *name;
  double least;
  const char *unit;
} usual[] = {
    {"young", 1e4, "kPa"},
    {"cohesion", 100.0, "kPa"},
    {"tension", 100.0, "kPa"},
    {"density", 20.0, "t/m3"},
    {"wall-density", 20.0, "t/m3"},
    {"plate-density", 20.0, "t/m3"},
    {"unit-weight", 1e3, "kN/m3"},
    {"base-unit-weight", 1e3, "kN/m3"},
    {"k", 1e4, "kN/m"},
};

const char *vocabulary_likelier_unit(const option *o, double value) {
  for (size_t k = 0; k < sizeof usual / sizeof *usual; k++)
    if (o->name && strcmp(usual[k].name, o->name) == 0 && value > 0.0 && value < usual[k].least &&
        !(o->usual > 0.0 && o->usual < usual[k].least))
      return usual[k].unit;
  return NULL;
}

/* ---- other names ----------------------------------------------------------------------------- */

/* A former name of version 0, or a word of other programs for nearly the same; the present name,
 * and what its value means where that differs. */
static const char others[] =
    "E young;nu poisson;mu friction;speed rate;"
    "vtk frames N: how many of them, not the time between them;"
    "duration falls N: fall times (H/g)^1/2;duration time-unit s: what T = 1 lasts;h cell;"
    "h spacing;cells cell m: the side of one, not their number;"
    "cells spacing m: the distance of particles, not their number;"
    "nx spacing m: the distance of particles, not their number;"
    "ny spacing m: the distance of particles, not their number;radius spacing m: D = 2 R;"
    "spacing cell where particles lie in a grid;cell spacing where there is no grid;"
    "alpha adhesion;alpha rock-alpha;alpha stabilisation;amplitude acceleration;"
    "angle apex-angle;angle slope-angle;base below-toe;base width;bed-friction friction;"
    "beta rock-beta;crest freeboard;domain soil;drained drainage;file levels;"
    "file-column levels-column;input record;input-column record-column;"
    "input-scale record-scale;input-step record-step;input-unit record-unit;load end-load;"
    "mesh coupling-mesh;model law;model symmetry;"
    "axisymmetric symmetry axial;no-space symmetry axial;path travel;ramp load-ramp;"
    "ratio drain-ratio;ratio frequency-ratio;re influence;rest still;"
    "ricker-frequency frequency;ricker-time peak-time;scheme method;slope incline;"
    "state equation-of-state;step dt;stiffness water-stiffness;tension edge-stress;"
    "tension negative-pressure;tolerance factor-tolerance;"
    "velocity wave-velocity;wall support;wall wall-thickness;"
    "water-level water-table m: a depth below the surface;"
    "water-table water-level m: a level above the toe;";

bool vocabulary_find_other(const option *table, const char *name, char *out, size_t size) {
  const size_t length = strlen(name);
  for (const char *at = others; *at; at += strcspn(at, ";") + 1) {
    const char *now = at + length + 1;
    if (strncmp(at, name, length) != 0 || at[length] != ' ') continue;
    const size_t letters = strcspn(now, " ;");
    for (const option *o = table; o->name || o->help; o++)
      if (o->name && strlen(o->name) == letters && strncmp(now, o->name, letters) == 0)
        return snprintf(out, size, "%.*s", (int)strcspn(now, ";"), now) > 0;
  }
  return false;
}
