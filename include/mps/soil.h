/* mps/soil.h - ground: its state at rest under its own weight, a stress by a function, and modified
 * Cam-Clay.
 *
 * mps_particles_set_geostatic and _set_stress write the field `stress` of a particle set: the
 * initial stress of WLS-MPM with laws in rate form (linear elastic, von Mises, Drucker-Prager,
 * Mohr-Coulomb). Laws that take the stress from the deformation gradient or the volume
 * (neo-Hookean, Newtonian) do not read it. Tension is positive, so that these stresses are
 * negative. p = -I1/3 is the mean effective pressure, q = sqrt(3 J2), e the void ratio, v = 1 + e.
 *
 * Thread rule: one thread at a time per set and context; callbacks run on the calling thread.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_SOIL_H
#define LIBMPS_SOIL_H

#include "material.h"
#include "particles.h"

MPS_EXTERN_C_BEGIN

/** A layer of ground, from the surface or the layer above it downwards; layers are parallel to the
 *  surface, as depths are measured vertically. There is no water in it: with a water table give the
 *  buoyant density below. The size of one in an array is mps_geostatic_def.layer_size. */
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
  int32_t vertical; /* axis that points up: 0, 1, 2, or -1 (default) for the last of the set: y in
                       2D, z in 3D */
  int64_t layer_count;               /* >= 1; no default */
  const mps_geostatic_layer *layers; /* from the surface downwards; no default */
  double gravity;                    /* m/s2, > 0, downwards; default 9.81 */
  double surcharge;                  /* Pa, >= 0, load on the surface; default 0 */
  int64_t surface_points;            /* >= 2 with `surface_line`, else 0 (default) */
  /** The surface, by one of three: */
  double surface;             /* m, level of a flat one; NaN (default): half a spacing above the
                                 highest particle */
  const double *surface_line; /* 2D: x0, y0, x1, y1, ..., x ascending; beyond the ends level. Not
                                 where x is the vertical */
  mps_geostatic_level_fn surface_level;
  void *user;         /* passed to `surface_level` */
  int32_t layer_size; /* bytes from one of `layers` to the next: mps_geostatic_defaults writes
                         sizeof(mps_geostatic_layer); 0 (of mps_def_init): 24, that of
                         the first release */
  int32_t reserved;
} mps_geostatic_def;

static inline mps_geostatic_def mps_geostatic_defaults(void) {
  mps_geostatic_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_GEOSTATIC, &def, sizeof def) != MPS_OK) def.struct_size = 0;
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

/* ---- modified Cam-Clay ----------------------------------------------------------------------- */

/** Modified Cam-Clay: q^2/M^2 + p (p - pc) = 0, associated; K = v p/kappa, dpc/pc = v times the
 *  plastic volume strain over lambda - kappa. Effective stress. Its history is `plastic_strain`,
 *  `preconsolidation` (pc, Pa), `void_ratio` and `opening`; a particle whose fields hold other
 *  values than 0 starts from them, else from those of the definition. */
typedef struct mps_material_cam_clay_def {
  uint32_t struct_size;
  int32_t lode;          /* 0 (default): M in all directions; 1: it follows the Lode angle, in
                            triaxial extension (3 - sin phi)/(3 + sin phi) of that in compression,
                            and so does the flow: associated too */
  double critical_slope; /* M, q/p at the critical state in triaxial compression, 0.05 to 2.9, with
                            `lode` to 1.9; no default. 6 sin(phi)/(3 - sin(phi)) */
  double compression;   /* lambda, slope of virgin compression in v - ln p, 1e-4 to 5; no default */
  double swelling;      /* kappa, slope of unloading, 1e-5 to below lambda; no default */
  double poisson;       /* nu, 0 to 0.49, from which G follows K; default 0.3 */
  double shear_modulus; /* Pa, constant G instead of nu; NaN (default): by nu. G by nu gives and
                           takes energy in closed cycles of p and q */
  double void_ratio;    /* e, 0.01 to 20; no default */
  double preconsolidation; /* Pa, pc, 1e-3 to 1e12; no default */
  double least_pressure;   /* Pa, p below which grains part, up to pc/10; NaN (default): pc/1000 */
} mps_material_cam_clay_def;

static inline mps_material_cam_clay_def mps_material_cam_clay_defaults(void) {
  mps_material_cam_clay_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MATERIAL_CAM_CLAY, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Modified Cam-Clay. Constants are copied. mps_material_wave_modulus and mps_material_get_moduli
 *  give those at pc and e of the definition; a solver's step follows the present state.
 *  MPS_ERROR_ARGUMENT: a constant out of range, which the message names; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_cam_clay(mps_context *context,
                                                              const mps_material_cam_clay_def *def,
                                                              mps_material **out);

/** K0 of one-dimensional virgin compression of a Cam-Clay; NaN of another law or NULL. Thread safe.
 *  */
MPS_API double mps_material_normal_k0(const mps_material *material);

MPS_EXTERN_C_END
#endif
