/* mps/geostatic.h - the initial state: ground at rest under its own weight, a stress by a function,
 * fields from another code's table.
 *
 * mps_particles_set_geostatic and _set_stress write the field `stress` of a particle set: the
 * initial stress of WLS-MPM with laws in rate form (linear elastic, von Mises, Drucker-Prager,
 * Mohr-Coulomb). Laws that take the stress from the deformation gradient or the volume
 * (neo-Hookean, Newtonian) do not read it. Tension is positive, so that these stresses are
 * negative.
 *
 * Thread rule: one thread at a time per set and context; callbacks run on the calling thread.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_GEOSTATIC_H
#define LIBMPS_GEOSTATIC_H

#include "particles.h"

MPS_EXTERN_C_BEGIN

/** A layer of ground. Layers follow the surface: depths are vertical ones below it. The
 *  size of one in an array is mps_geostatic_def.layer_size. */
typedef struct mps_geostatic_layer {
  double thickness; /* m, 1e-9 to 1e9; infinite allowed for the lowest */
  double k0;        /* horizontal over vertical stress, >= 0; elastic ground held at its sides:
                       nu/(1 - nu) */
  double density;   /* kg/m3, 1e-9 to 1e9; NaN: that of the field `density` of the particles whose
                       centres lie in the layer, which must be one value */
} mps_geostatic_layer;

/** Writes the level (m) of the surface above or below the position x (m, as many values as the set
 *  has dimensions; the vertical one is that of the particle). Another status than MPS_OK ends the
 *  call, which returns it. */
typedef mps_status (*mps_geostatic_level_fn)(void *user, const double *x, double *level);

typedef struct mps_geostatic_def {
  uint32_t struct_size;
  int32_t layer_count;               /* >= 1; no default */
  const mps_geostatic_layer *layers; /* from the surface downwards; no default */
  double gravity;                    /* m/s2, > 0, downwards; default 9.81 */
  double surcharge;                  /* Pa, >= 0, load on the surface; default 0 */
  int32_t vertical;       /* axis that points up: 0, 1, 2, or -1 (default) for the last of the
                             set: y in 2D, z in 3D */
  int32_t surface_points; /* >= 2 with `surface_line`, else 0 (default) */
  /** The surface, by one of three: */
  double surface;             /* m, level of a flat one; NaN (default): half a spacing above the
                                 highest particle */
  const double *surface_line; /* 2D: x0, y0, x1, y1, ..., x ascending; beyond the ends level. Not
                                 where x is the vertical */
  mps_geostatic_level_fn surface_level;
  void *user;         /* passed to `surface_level` */
  int32_t layer_size; /* bytes from one of `layers` to the next: mps_geostatic_defaults writes
                         sizeof(mps_geostatic_layer); 0 (of mps_geostatic_def_init): 24, that of
                         0.3 */
  int32_t reserved;
} mps_geostatic_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_geostatic_def_init(mps_geostatic_def *def, size_t size);
static inline mps_geostatic_def mps_geostatic_defaults(void) {
  mps_geostatic_def def;
  memset(&def, 0, sizeof def);
  if (mps_geostatic_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  def.layer_size = (int32_t)sizeof(mps_geostatic_layer);
  return def;
}

/** Sets the stress at rest of every particle, adding the field where the set lacks it: vertically
 *  the weight of the ground above the particle's centre, summed layer by layer without an error of
 *  integration, horizontally K0 times that, no shear. In 2D the direction out of the plane, or the
 *  hoop, is horizontal. Under a level surface this is in balance; under a slope it is a start.
 *  MPS_ERROR_ARGUMENT: a value out of range, a particle above the surface or below the lowest
 *  layer, different densities in a layer that takes its density from them. MPS_ERROR_FIELD: no
 *  `density` to take it from. MPS_ERROR_UNSUPPORTED: a `surface_line` that is not 2D with y
 *  upwards. MPS_ERROR_STATE: a solver's callback is running. Nothing is changed on an error. */
MPS_API MPS_NODISCARD mps_status mps_particles_set_geostatic(mps_particles *particles,
                                                             const mps_geostatic_def *def);

/** Writes the stress (Pa) at the position x (m): xx, yy, zz, xy in 2D, and zx, yz in 3D, which are
 *  zero on entry. Another status than MPS_OK ends the call, which returns it. */
typedef mps_status (*mps_geostatic_stress_fn)(void *user, const double *x, double *stress);

/** Sets the stress of every particle by the caller's function, adding the field where the set lacks
 *  it. MPS_ERROR_ARGUMENT for a stress that is not finite, or the status that the function returns;
 *  then nothing is changed. */
MPS_API MPS_NODISCARD mps_status mps_particles_set_stress(mps_particles *particles,
                                                          mps_geostatic_stress_fn stress,
                                                          void *user);

/* ---- from another code's table --------------------------------------------------------------- */

/** How a particle gets its value from the points of a table. */
typedef enum mps_table_interpolation {
  MPS_TABLE_NEAREST = 0, /* that of the nearest point, of equally near ones the first */
  MPS_TABLE_LINEAR = 1 /* a linear function, fitted by weighted least squares to the nearest points
                          (12 in 2D, 20 in 3D; more where these lie on one line or plane, or on one
                          side of the particle): exact for linear fields, and at a point that
                          point's value. Points at one place count with their mean; a direction in
                          which the whole table has no extent, as across a column of points, has no
                          gradient */
} mps_table_interpolation;

typedef struct mps_table_def {
  uint32_t struct_size;
  int32_t interpolation; /* an mps_table_interpolation; MPS_TABLE_NEAREST (0) by default */
  int32_t extrapolate; /* LINEAR, of particles outside: 0 (default): the value of the nearest point;
                          1: the linear function continues. `reach` then is needed */
  int32_t reserved;    /* 0 */
  double reach; /* m, > 0: a particle farther from its nearest point is an error; NaN (default):
                   any distance */
} mps_table_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_table_def_init(mps_table_def *def, size_t size);
static inline mps_table_def mps_table_defaults(void) {
  mps_table_def def;
  memset(&def, 0, sizeof def);
  if (mps_table_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Gives every particle the value of the float64 field `field` at its position from a table of
 *  `count` points (1 to 2^31), such as the Gauss points of a finite-element analysis: positions[i *
 *  dim + c] in m, within 1e15 m, in any order; values[i * components + c] in the field's unit, all
 *  components of the field in its order (stress: xx, yy, zz, xy in 2D, and zx, yz in 3D; Pa,
 * tension positive; docs/fields.md). Adds a field of the table of fields that the set lacks. The
 * arrays are read during the call only. `def` NULL: the defaults. `outside` (may be NULL) receives,
 * for MPS_TABLE_LINEAR, the number of particles that lie outside the points, beyond the convex hull
 * of the nearest ones, which a log message of the level INFO states too; 0 for MPS_TABLE_NEAREST.
 * The search takes time in proportion to log(count) a particle, on the context's threads; results
 * are the same for every number of them. Of a set on several ranks each rank sets its own
 * particles, from a table of its own choice: not collective. On an error nothing is changed.
 *  MPS_ERROR_ARGUMENT: a NULL array, `count` out of range, a position or value that is not finite,
 *  a particle farther than `reach` from the table, a value outside the field's range, points too
 *  near a line or plane for a linear function; MPS_ERROR_FIELD: no such field, one of int64 or that
 *  only the library writes, or of other `components`; MPS_ERROR_STATE: a field is being edited, or
 * a solver's callback is running; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_particles_set_table(
    mps_particles *particles, const char *field, int64_t count, const double *positions,
    int32_t components, const double *values, const mps_table_def *def, int64_t *outside);

MPS_EXTERN_C_END
#endif
