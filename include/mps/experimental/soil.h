/* mps/experimental/soil.h - ground: stiffness at small strain, sand that contracts under cyclic
 * shear, Cam-Clay at rest, properties that vary, values from another code's table.
 *
 * Thread rule: one thread at a time per context.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_SOIL_H
#define LIBMPS_EXPERIMENTAL_SOIL_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../soil.h"

MPS_EXTERN_C_BEGIN

/* ---- stiffness at small strain --------------------------------------------------------------- */

/** Stiffness that falls with the shear strain, and is G0 again at each reversal: on first
 *  loading tau = G0 gamma/(1 + (gamma/gamma_r)^a) (Hardin and Drnevich 1972 with a = 1, Darendeli
 *  2001) up to the strength, tau = sqrt(J2), gamma = 2 sqrt(J2 of the strain deviator), counted
 *  from the first state, whose stress stays; unloading and reloading by Masing's rules, small loops
 *  within large ones included. Ten elastic, perfectly plastic elements in parallel (Iwan 1967)
 *  approximate the curve, with G0 and the strength exact; strains below gamma_r/100 dissipate
 *  nothing. K is constant. No friction: the strength does not follow the pressure. Its history is
 *  `plastic_strain`, `dissipated` (J/m3) and the deviators of the layers, 52 columns. The HSsmall
 *  threshold gamma_0.7 is 0.385 gamma_r. */
typedef struct mps_material_small_strain_def {
  uint32_t struct_size;
  uint32_t reserved;
  double shear_modulus;    /* Pa, G0 at zero strain; no default */
  double poisson;          /* at zero strain, for K; default 0.3 */
  double reference_strain; /* gamma_r, engineering shear strain at which G/G0 is 1/2 on the
                              backbone, 1e-7 to 1; no default */
  double curvature;        /* a, 0.5 to 1; default 1 */
  double strength;         /* Pa, largest tau, from 0.05 G0 gamma_r to the backbone's largest: with
                              curvature 1 G0 gamma_r, else its value at 1000 gamma_r. NaN (default):
                              G0 gamma_r, with curvature 1 alone */
} mps_material_small_strain_def;

static inline mps_material_small_strain_def mps_material_small_strain_defaults(void) {
  mps_material_small_strain_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MATERIAL_SMALL_STRAIN, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Small-strain stiffness. Constants are copied. MPS_MATERIAL_FLAG_PLASTIC is set where the
 *  strength is reached. mps_material_wave_modulus and mps_material_get_moduli are those of zero
 *  strain, which limit a solver's step. MPS_ERROR_ARGUMENT: a constant out of range, which the
 *  message names; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_small_strain(
    mps_context *context, const mps_material_small_strain_def *def, mps_material **out);

/* ---- sand that contracts under cyclic shear -------------------------------------------------- */

/** Mohr-Coulomb sand (without softening) that contracts in every half cycle of shear of the
 *  amplitude g, engineering strain, by 1/2 C1 g exp(-C2 e/g), e the contraction before it (Byrne
 *  1991), or with `c3` and `c4` by 1/2 (C1 (g - C2 e) + C3 e^2/(g + C4 e)) (Martin, Finn and Seed
 *  1975). Dry or drained sand settles; with pore water (mps/experimental/pore_water.h) effective
 * stresses fall, without cohesion all in proportion, and the pressure of the water rises, to
 * liquefaction, and falls as water leaves. Half cycles end where the deviatoric strain turns back
 * by a tenth of its way from the last reversal and by two thresholds; g is half of that way, gamma
 * = 2 sqrt(J2), in any direction. Grains without effective stress do not contract. Strains of
 * mps_mpm_settle count: settle ground as Mohr-Coulomb, then mps_mpm_set_material. Of
 * `relative_density`, `blow_count` and `c1` one must be given. Its history is that of Mohr-Coulomb,
 * `contraction` (e), `contraction_before` (at the last reversal), `half_cycles` and two tensors of
 * strain, 15 columns. */
typedef struct mps_material_cyclic_sand_def {
  uint32_t struct_size;
  uint32_t reserved;
  double young;            /* Pa, > 0, at the amplitudes of the shaking; no default */
  double poisson;          /* default 0.3 */
  double friction;         /* rad, angle phi, 0 <= phi < pi/2; no default */
  double dilation;         /* rad, angle psi, 0 <= psi <= phi; default 0 */
  double cohesion;         /* Pa, c >= 0, not 0 when phi is; default 0 */
  double relative_density; /* Dr, 0.1 to 1: C1 = 7600 (100 Dr)^-2.5, C2 = 0.4/C1; NaN (default) */
  double blow_count;       /* (N1)60, 1 to 60: C1 = 8.7 (N1)60^-1.25, C2 = 0.4/C1; NaN (default) */
  double c1; /* C1 of a full cycle, 1e-4 to 100; NaN (default): by one of the former two */
  double c2; /* C2, 0 to 100; NaN (default): 0.4/C1 */
  double c3; /* C3 and */
  double c4; /* C4, 1e-4 to 100, of Martin, Finn and Seed, with c1 and c2; NaN (default): Byrne */
  double threshold;    /* amplitude, 0 to 0.01, up to which nothing contracts, and from twice which
                          all does; default 1e-4 */
  double strain_limit; /* amplitude, above the threshold and at most 1, beyond which larger ones
                          contract no more; default 0.01 */
  double void_ratio, max_void_ratio; /* dilation ends at max_void_ratio, as in Mohr-Coulomb; 0.001
                                        to 100; NaN (default): it has no end */
} mps_material_cyclic_sand_def;

static inline mps_material_cyclic_sand_def mps_material_cyclic_sand_defaults(void) {
  mps_material_cyclic_sand_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MATERIAL_CYCLIC_SAND, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Cyclic sand. Constants are copied. MPS_MATERIAL_FLAG_PLASTIC is also set where a particle has
 *  contracted. MPS_ERROR_ARGUMENT: a constant out of range, none or several of `relative_density`,
 *  `blow_count` and `c1`, `c2` without `c1`, one of `c3` and `c4`; the message names it;
 *  MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_cyclic_sand(
    mps_context *context, const mps_material_cyclic_sand_def *def, mps_material **out);

/* ---- ground of Cam-Clay at rest -------------------------------------------------------------- */

typedef struct mps_consolidation_def {
  uint32_t struct_size;
  int32_t reserved;
  double ocr; /* largest former vertical effective stress over the present one, 1 to 1000;
                 default 1 */
  double pop; /* Pa, >= 0: added to that largest stress; default 0 */
  double k0;  /* horizontal over vertical stress; NaN (default): that of the law after
                 one-dimensional loading to the largest stress and elastic unloading, at most
                 the passive one */
  double critical_volume; /* Gamma, v on the critical state line at `reference`, above 1: e follows
                             from p and pc; NaN (default): e of the law */
  double reference;       /* Pa, > 0: mean effective pressure of `critical_volume`; default 1000 */
  int64_t count;          /* of `ids`; 0 and NULL (default): all particles */
  const int64_t *ids;
  int32_t vertical; /* axis of the vertical stress, 0, 1, 2; -1 (default): the last of the set */
  int32_t reserved_2;
} mps_consolidation_def;

static inline mps_consolidation_def mps_consolidation_defaults(void) {
  mps_consolidation_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_CONSOLIDATION, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** From the vertical effective stress in the field `stress` (mps_particles_set_geostatic with
 *  buoyant densities) sets the horizontal stresses, and the fields `preconsolidation` and
 *  `void_ratio`, of level ground consolidated one-dimensionally under its weight and its former
 *  load, without shear stress. Call it before the solver is created. MPS_ERROR_ARGUMENT: a value
 * out of range, a vertical stress that is not compression (the message names the particle), k0
 * beyond the yield surface of the largest stress; MPS_ERROR_FIELD: no `stress`;
 * MPS_ERROR_UNSUPPORTED: a law that is not Cam-Clay; MPS_ERROR_STATE: a solver's callback is
 * running. Nothing is changed on an error. */
MPS_API MPS_NODISCARD mps_status mps_particles_set_consolidation(mps_particles *particles,
                                                                 const mps_material *material,
                                                                 const mps_consolidation_def *def);

/* ---- strength and stiffness that vary in the ground -------------------------------------------
 */

/** The law `law` with moduli and strengths of each particle: its fields `stiffness_factor`
 *  multiplies E and the hardening modulus, `strength_factor` the yield stress, cohesion and tension
 *  (the last and residual ones too). The caller sets these two fields, mps_particles_set_profile by
 *  depth; 0, as in particles that have none, is 1. Constants are copied. Its history has the two as
 *  last columns; mps_material_wave_modulus and mps_material_get_moduli are those of factor 1, and
 *  the step of a solver follows the factors. MPS_ERROR_ARGUMENT: NULL, or a law of another context;
 *  MPS_ERROR_UNSUPPORTED: another law than linear elastic, von Mises, Drucker-Prager,
 *  Mohr-Coulomb, small strain and cyclic sand, or one made by this function; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_by_field(mps_context *context,
                                                              const mps_material *law,
                                                              mps_material **out);

/** Writes a field of one component by depth: `value[k]` at `depth[k]` (m, `count` >= 1 of them,
 *  ascending), linear between, and the first and last value beyond. The field is added where the
 *  set lacks it. `ground` (may be NULL) gives the surface and the vertical axis as for
 *  mps_particles_set_geostatic; its other members are not read. MPS_ERROR_ARGUMENT: a number that
 *  is not finite, depths that do not ascend, a value that the field does not take, a particle above
 *  the surface; MPS_ERROR_FIELD: the field has several components or integers; MPS_ERROR_STATE: a
 *  solver's callback is running. Nothing is changed on an error. */
MPS_API MPS_NODISCARD mps_status mps_particles_set_profile(mps_particles *particles,
                                                           const char *field, int64_t count,
                                                           const double *depth, const double *value,
                                                           const mps_geostatic_def *ground);

/* ---- from another code's table --------------------------------------------------------------- */

/** How a particle gets its value from the points of a table. */
typedef enum mps_table_interpolation {
  MPS_TABLE_INTERPOLATION_NEAREST =
      0,                             /* that of the nearest point, of equally near ones the first */
  MPS_TABLE_INTERPOLATION_LINEAR = 1 /* a linear function, fitted by weighted least squares to the
                          nearest points (12 in 2D, 20 in 3D; more where these lie on one line or
                          plane, or on one side of the particle): exact for linear fields, and at a
                          point that point's value. Points at one place count with their mean; a
                          direction in which the whole table has no extent, as across a column of
                          points, has no gradient */
} mps_table_interpolation;

typedef struct mps_table_def {
  uint32_t struct_size;
  int32_t interpolation; /* an mps_table_interpolation; MPS_TABLE_INTERPOLATION_NEAREST (0) by
                            default */
  int32_t extrapolate; /* LINEAR, of particles outside: 0 (default): the value of the nearest point;
                          1: the linear function continues. `reach` then is needed */
  int32_t reserved;    /* 0 */
  double reach; /* m, > 0: a particle farther from its nearest point is an error; NaN (default):
                   any distance */
} mps_table_def;

static inline mps_table_def mps_table_defaults(void) {
  mps_table_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_TABLE, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Gives every particle the value of the float64 field `field` at its position from a table of
 *  `count` points (1 to 2^31), such as the Gauss points of a finite-element analysis: positions[i *
 *  dim + c] in m, within 1e15 m, in any order; values[i * components + c] in the field's unit, all
 *  components of the field in its order (stress: xx, yy, zz, xy in 2D, and zx, yz in 3D; Pa,
 * tension positive; docs/fields.md). Adds a field of the table of fields that the set lacks. The
 * arrays are read during the call only. `def` NULL: the defaults. `outside` (may be NULL) receives,
 * for MPS_TABLE_INTERPOLATION_LINEAR, the number of particles that lie outside the points, beyond
 * the convex hull of the nearest ones, which a log message of the level INFO states too; 0 for
 * MPS_TABLE_INTERPOLATION_NEAREST. The search takes time in proportion to log(count) a particle, on
 * the context's threads; results are the same for every number of them. Of a set on several ranks
 * each rank sets its own particles, from a table of its own choice: not collective. On an error
 * nothing is changed. MPS_ERROR_ARGUMENT: a NULL array, `count` out of range, a position or value
 * that is not finite, a particle farther than `reach` from the table, a value outside the field's
 * range, points too near a line or plane for a linear function; MPS_ERROR_FIELD: no such field, one
 * of int64 or that only the library writes, or of other `components`; MPS_ERROR_STATE: a field is
 * being edited, or a solver's callback is running; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_particles_set_table(
    mps_particles *particles, const char *field, int64_t count, const double *positions,
    int32_t components, const double *values, const mps_table_def *def, int64_t *outside);

MPS_EXTERN_C_END
#endif
