/* standard.c - see standard.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "standard.h"

#include <string.h>

#define NONE                                                                                       \
  { 0.0, 0.0, false } /* of text and choices */

static const struct {
  const char *name, *unit;
  option_range range;
  const char *help;
} standard[] = {
    /* material */
    {"young", "Pa", OPTION_MODULUS, "Young's modulus E"},
    {"poisson", "1", OPTION_FROM_TO(0.0, 0.49), "Poisson's ratio nu"},
    {"density", "kg/m3", OPTION_DENSITY, "density rho"},
    {"unit-weight", "N/m3", OPTION_FROM_TO(1.0, 1e6), "unit weight; density follows with 9.8 m/s2"},
    {"cohesion", "Pa", OPTION_STRENGTH, "cohesion c"},
    {"phi", "degrees", OPTION_FROM_TO(0.0, 60.0), "angle of friction"},
    {"psi", "degrees", OPTION_FROM_TO(0.0, 60.0), "angle of dilation"},
    {"vs", "m/s", OPTION_FROM_TO(0.1, 1e5), "shear wave velocity Vs"},
    {"vp", "m/s", OPTION_FROM_TO(0.1, 1e5), "pressure wave velocity Vp, at least sqrt(2) Vs"},
    {"damping", "1", OPTION_FROM_TO(0.0, 1.0),
     "Rayleigh damping ratio h at f1 and f2; 0.05 is 5 % of critical"},
    {"f1", "Hz", OPTION_FREQUENCY, "first frequency of the damping"},
    {"f2", "Hz", OPTION_FREQUENCY, "second frequency of the damping"},
    {"viscosity", "Pa s", OPTION_FROM_TO(0.0, 1e3), "dynamic viscosity of the water"},
    {"gravity", "m/s2", OPTION_GRAVITY, "g"},
    {"state", "stress|strain", NONE, "plane stress or plane strain"},
    /* contact */
    {"friction", "1", OPTION_FROM_TO(0.0, 10.0), "Coulomb's coefficient mu"},
    {"contact", "impulse|penalty", NONE,
     "impulses at the surface, or springs at the particles, Nakamura (28) to (34)"},
    {"k", "N/m", OPTION_STIFFNESS,
     "contact stiffness per unit thickness of each particle, Nakamura (28)"},
    {"corner", "1", OPTION_FROM_TO(0.0, 2.0), "radius of edges for the soil, in cells; impulses"},
    {"rate", "m/s", OPTION_FROM_TO(1e-6, 10.0), "speed of penetration"},
    /* geometry and waves */
    {"length", "m", OPTION_LENGTH, "length"},
    {"depth", "m", OPTION_LENGTH, "depth"},
    {"amplitude", "m", OPTION_FROM_TO(0.0, 1e3), "amplitude"},
    {"period", "s", OPTION_DURATION, "period of the piston"},
    {"ramp", "s", OPTION_FROM_TO(0.0, 1e6), "time in which the piston's amplitude rises"},
    {"wave", "S|P", NONE, "shear wave (moves in x) or pressure wave (in y)"},
    {"gauge", "m,...", NONE, "stations of level gauges, at most 8"},
    /* discretisation */
    {"h", "m", OPTION_LENGTH, "grid spacing"},
    {"ppc", "N", OPTION_FROM_TO(1.0, 100.0), "particles a cell"},
    {"spline", "2|3", NONE, "degree of the weights"},
    {"volumetric", "law|point|cell|nodes", NONE,
     "change of volume: as suits the law, each particle's own, F-bar by cell, or means by nodes"},
    {"radius", "m", OPTION_LENGTH, "particle radius R; the spacing is D = 2R"},
    {"spacing", "m", OPTION_LENGTH, "spacing of the particles"},
    {"disturb", "spacings", OPTION_FROM_TO(0.0, 0.2),
     "random displacement of the water's particles at the start, at most"},
    {"courant", "1", OPTION_FROM_TO(1e-3, 1.0), "time step over the stability limit"},
    {"flip-time", "s", OPTION_FROM_TO(0.0, 1e6),
     "time in which a particle loses what the nodes do not represent of its velocity; 0: at each "
     "step"},
    {"dt", "s", OPTION_DURATION, "time step"},
    {"integrator", "verlet|leapfrog|euler", NONE, "time integration"},
    {"rotation", "mean-matrix|mean-angle", NONE, "how the rigid rotation of a pair is removed"},
    {"torque", "conserving|printed", NONE,
     "as derived, which conserves angular momentum, or twice that as the paper prints it"},
    {"solver", "own|multigrid|direct", NONE,
     "of the pressure: the library's, the same bit for bit on all numbers of ranks; or PETSc's "
     "algebraic multigrid, for a hundred thousand particles and more, or its direct solver: they "
     "agree within the tolerance"},
    {"tolerance", "1", OPTION_FROM_TO(1e-14, 1e-2), "residual of the pressure over its right side"},
    /* the run */
    {"duration", "s", OPTION_DURATION, "simulated time"},
    {"sample", "s", OPTION_DURATION, "time between rows of the tables"},
    {"frames", "N", OPTION_FROM_TO(0.0, 100000.0), "frames of the series for ParaView (0: none)"},
    {"checkpoint", "FILE", NONE,
     "written during the run and at Ctrl-C, to continue with --restart (default "
     "OUT/checkpoint.h5)"},
    {"every-checkpoint", "s", OPTION_DURATION, "simulated time between checkpoints"},
    {"restart", "FILE", NONE,
     "continue a checkpoint made with the same options (but --out, --threads and those of "
     "checkpoints); the results are those of the whole run, frames for ParaView those from here "
     "on; "
     "where --out has results already they go to OUT-from-T"},
    {"out", "DIR", NONE, "directory of the results"},
    {"threads", "N", OPTION_FROM_TO(0.0, 1024.0), "threads; 0: all processors"},
};

static bool is_zero(const option_range *r) {
  return r->lower == 0.0 && r->upper == 0.0 && !r->open;
}

bool standard_complete(option *table, const char **name) {
  for (option *o = table; o->name || o->help; o++) {
    if (!o->common) continue;
    size_t k = 0;
    const size_t count = sizeof standard / sizeof *standard;
    while (k < count && strcmp(standard[k].name, o->name) != 0) k++;
    *name = o->name;
    if (k == count) return false;
    if (!o->unit) o->unit = standard[k].unit;
    if (!o->help) o->help = standard[k].help;
    if (is_zero(&o->range)) o->range = standard[k].range;
  }
  return true;
}

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

const char *standard_likelier_unit(const option *o, double value) {
  for (size_t k = 0; k < sizeof usual / sizeof *usual; k++)
    if (o->name && strcmp(usual[k].name, o->name) == 0 && value > 0.0 && value < usual[k].least &&
        !(o->usual > 0.0 && o->usual < usual[k].least))
      return usual[k].unit;
  return NULL;
}

/* ---- former names ---------------------------------------------------------------------------- */

static const standard_former formers[] = {
    {"E", "young", NULL},
    {"nu", "poisson", NULL},
    {"mu", "friction", NULL},
    {"speed", "rate", NULL},
    {"vtk", "frames", " N: how many of them, not the time between them"},
    {"duration", "falls", " N: fall times (H/g)^1/2"},
};

const standard_former *standard_find_former(const option *table, const char *name) {
  for (size_t k = 0; k < sizeof formers / sizeof *formers; k++)
    for (const option *o = table; strcmp(formers[k].name, name) == 0 && (o->name || o->help); o++)
      if (o->name && strcmp(o->name, formers[k].now) == 0) return &formers[k];
  return NULL;
}
