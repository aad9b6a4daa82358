/* mps/experimental/pore_water.h - water in the pores of the ground of a WLS-MPM solver: undrained
 * by the bulk modulus of the water, or partly drained by Darcy's law (the u-p formulation),
 * explicit or with implicit pressures.
 *
 * The laws then act on the effective stress: the field `stress` is effective, tension positive; the
 * total stress is `stress` less `pore_pressure` (compression positive) on the normal components.
 * Mass and density are those of grains and water together (saturated). Pressures follow from the
 * continuity of the water in the cells of the grid:
 *
 *   n/K_w dp/dt = -tr(d) - div q,   q = -k/(rho_w g) (grad p - rho_w b)
 *
 * with porosity n, permeability k (m/s), gravity b, that of the solver's definition, and g
 * = 9.80665 m/s2 in the weight of water rho_w g that k refers to, whatever b. The field
 * `body_acceleration` moves the ground as a whole and no water through it: a steady one belongs to
 * the gravity of the definition, which the log says once it has lasted. The acceleration of the
 * water relative to the grains is left out, which is right for k below 1e-3 m/s and without shocks
 * in the water. In the explicit scheme, pressures, porosities and permeabilities follow the volume
 * strain in each step; water flows between cells, and pressures are smoothed, every 8 steps, more
 * often if the stability limit of the flow requires it.
 *
 * Fields: `pore_pressure` (Pa) and `porosity`, which the caller may write between steps,
 * `pore_pressure_gradient` (Pa/m), `permeability` (m/s, the present one) where water flows, and
 * `seepage` (m/s, q), written where the set has it; gradient and seepage are those of the last
 * flow step. With implicit pressures steps write `pore_pressure_mean` (Pa), a running mean over
 * about 32 steps. Water that leaves the ground takes its mass from the particles, at their
 * velocity.
 *
 * Implicit pressures are solved for by conjugate gradients, or by a solver of the caller
 * (mps/experimental/linear_solver.h).
 *
 * A cell's face is impervious at sides of the domain and at bodies, and drained at the free surface
 * with the pressure 0, unless a face (mps_mpm_add_pore_face) says otherwise. A body thinner than
 * the cells that it crosses does not separate the water on its two sides. Steps with implicit
 * pressures refuse thin bodies and local damping (MPS_ERROR_STATE).
 *
 * On several ranks all functions are collective but mps_mpm_get_pore_water, with the bits of one.
 * Thread rule: as mps/mpm.h. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_PORE_WATER_H
#define LIBMPS_EXPERIMENTAL_PORE_WATER_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../mpm.h"

MPS_EXTERN_C_BEGIN

#define MPS_PORE_GRAVITY 9.80665 /* m/s2, of the weight of water that permeabilities refer to */

typedef enum mps_pore_scheme {
  MPS_PORE_SCHEME_EXPLICIT = 0, /* waves in the water and its flow limit the step (default) */
  MPS_PORE_SCHEME_IMPLICIT = 1  /* neither does: each step solves for the pressures */
} mps_pore_scheme;

typedef struct mps_pore_water_def {
  uint32_t struct_size;
  int32_t scheme;      /* mps_pore_scheme, of pressures in time */
  double porosity;     /* n in (0, 1) of all particles. NaN (default): the field `porosity` */
  double permeability; /* k, m/s, > 0 and at most 1, of all particles at their present porosity.
                          NaN (default): the field `permeability`, > 0 everywhere, where the set has
                          it; else the ground is undrained */
  double bulk;         /* K_w, Pa, > 0; water without air has 2.2e9. NaN (default): such that K_w/n
                          is at least 50 times K + 4G/3 of each particle at rest, which adds 2 % to
                          settlements at most and lets steps be longer */
  double density;      /* rho_w, kg/m3, > 0; default 1000 */
  double exponent;     /* a >= 0 and */
  double ratio_slope;  /* c_k > 0 of k = k0 (v/v0)^a exp((e - e0)/c_k), with e = n/(1 - n) and
                          v = 1 + e; defaults 0 and infinity: constant */
} mps_pore_water_def;

static inline mps_pore_water_def mps_pore_water_defaults(void) {
  mps_pore_water_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_PORE_WATER, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Saturates the ground of `mpm`, once and before its first step, with the pressures of the field
 *  `pore_pressure` (where the set has none: 0). The limit of the step follows at once: waves with K
 *  + 4G/3 + K_w/n, and where water flows 0.3 h^2/(2 dim D), D = k K_w/(n rho_w g), whatever
 *  `courant`; with implicit pressures it is that of dry ground, and steps may fail with
 *  MPS_ERROR_NUMERIC where these are not found. `def` NULL: the defaults. MPS_ERROR_ARGUMENT: a
 *  member of `def` or a field out of range (the message names the particle), a density below that
 *  of the water in the pores, a law without a modulus at rest and no `bulk`, or a fixed dt above
 *  the new limit; MPS_ERROR_STATE: the solver has taken steps or has water already;
 *  MPS_ERROR_UNSUPPORTED: the energy budget; MPS_ERROR_MEMORY. After an error the solver is as it
 *  was. */
MPS_API MPS_NODISCARD mps_status mps_mpm_add_pore_water(mps_mpm *mpm,
                                                        const mps_pore_water_def *def);
/** The definition of the water, with its defaults completed (`porosity` and `permeability` stay NaN
 *  where fields gave them). MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library;
 *  MPS_ERROR_STATE: the solver has no water. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_pore_water_sized(const mps_mpm *mpm,
                                                              mps_pore_water_def *out, size_t size);
static inline mps_status mps_mpm_get_pore_water(const mps_mpm *mpm, mps_pore_water_def *out) {
  return mps_mpm_get_pore_water_sized(mpm, out, sizeof *out);
}

/** Sets the pressures of water at rest with its level at `point` (m; 2 or 3 components, on the
 *  level): rho_w b.(x - point), 0 above. Needs gravity. MPS_ERROR_ARGUMENT: NULL, not finite, or no
 *  gravity; MPS_ERROR_STATE: no water, a step has failed, or a callback of the solver is running.
 *  */
MPS_API MPS_NODISCARD mps_status mps_mpm_set_pore_level(mps_mpm *mpm, const double *point);

typedef enum mps_pore_face {
  MPS_PORE_FACE_IMPERVIOUS = 0, /* no flow across (default) */
  MPS_PORE_FACE_DRAINED = 1     /* the pressure is given */
} mps_pore_face;

#define MPS_PORE_MAX_FACES 16

/* Exposed faces of cells: at sides of the domain, at bodies, and at the free surface. Where several
 * definitions select the same face, the one with the highest number applies. */
typedef struct mps_pore_face_def {
  uint32_t struct_size;
  int32_t kind;    /* mps_pore_face, default IMPERVIOUS */
  uint32_t sides;  /* bit k: faces that look to side k of mps_side (bit 0: -x, 1: +x, ...); 0
                      (default): all */
  int32_t at_rest; /* 1: the given pressure is that of water at rest, `pressure` + rho_w b.x;
                      0 (default): `pressure` everywhere */
  double lower[3]; /* m, box of the faces' centres; default +-infinity; in 2D the third value is */
  double upper[3]; /* not read */
  double pressure; /* Pa, of a drained face; default 0 */
} mps_pore_face_def;

static inline mps_pore_face_def mps_pore_face_defaults(void) {
  mps_pore_face_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_PORE_FACE, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}
/** Adds faces; `number` (may be NULL) receives theirs, from 0. They cannot be removed: set another
 *  definition. Drained ones of undrained ground are warned of: nothing passes. MPS_ERROR_ARGUMENT:
 *  a member of `def` out of range, or more than 16; MPS_ERROR_STATE: no water, or a callback of the
 *  solver is running. */
MPS_API MPS_NODISCARD mps_status mps_mpm_add_pore_face(mps_mpm *mpm, const mps_pore_face_def *def,
                                                       int32_t *number);
/** Gives faces `number` another definition, from the next flow step on. MPS_ERROR_ARGUMENT: no such
 *  number, or a member of `def` out of range; MPS_ERROR_STATE: as mps_mpm_add_pore_face. */
MPS_API MPS_NODISCARD mps_status mps_mpm_set_pore_face(mps_mpm *mpm, int32_t number,
                                                       const mps_pore_face_def *def);
/** Water that has left through the faces `number` (-1: the free surface, where no face says
 *  otherwise), less the water that has entered: `rate` (kg/s, mean over the last flow step) and
 *  `mass` (kg, since the start), for the modelled thickness or sector; each may be NULL.
 * MPS_ERROR_ARGUMENT: no such number; MPS_ERROR_STATE: no water. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_pore_flow(const mps_mpm *mpm, int32_t number,
                                                       double *rate, double *mass);

/** Mass of the water in the modelled thickness or sector. */
typedef struct mps_pore_budget {
  double mass;     /* kg, in the pores now: sum of rho_w n V (1 + p/K_w) over the particles */
  double start;    /* kg, at the first step */
  double drained;  /* kg, that has left through all faces, less what came in */
  double residual; /* kg, start - mass - drained: the error of the cells' means; also particles that
                      were added, removed or edited */
  double entered;  /* kg, that has come in through all faces, >= 0 */
  double left;     /* kg, that has gone out, >= 0; less `entered` it is `drained`, and the mass
                      that the particles have lost */
} mps_pore_budget;
/** Budget of the water at present. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library;
 *  MPS_ERROR_STATE: no water. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_pore_budget_sized(const mps_mpm *mpm,
                                                               mps_pore_budget *out, size_t size);
static inline mps_status mps_mpm_get_pore_budget(const mps_mpm *mpm, mps_pore_budget *out) {
  return mps_mpm_get_pore_budget_sized(mpm, out, sizeof *out);
}

/** The solution for the implicit pressures in the last step. */
typedef struct mps_pore_report {
  int64_t unknowns;   /* cells with a pressure of their own, of all ranks */
  int64_t coarse;     /* unknowns of the coarse equation; 0: without one */
  int64_t iterations; /* of the conjugate gradients, or as the caller's solver says */
} mps_pore_report;
/** All are 0 before the first step and with explicit pressures. MPS_ERROR_ARGUMENT: NULL, or a
 *  `size` unknown to this library; MPS_ERROR_STATE: no water. Not collective. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_pore_report_sized(const mps_mpm *mpm,
                                                               mps_pore_report *out, size_t size);
static inline mps_status mps_mpm_get_pore_report(const mps_mpm *mpm, mps_pore_report *out) {
  return mps_mpm_get_pore_report_sized(mpm, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
