/* material_private.h - the members of a material, and the loops over a block that are compiled for
 * several instruction sets, for src/material only.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "kinds.h"

#define MPSI_MATERIAL_NAME 48  /* bytes of a name */
#define MPSI_MATERIAL_FIELD 96 /* bytes of a field's name: <material>.<column> */

/* Components in use. Axisymmetric is 2D with a rate of zz. */
typedef enum mpsi_geometry_kind {
  MPSI_PLANE,
  MPSI_AXIAL,
  MPSI_SPACE,
  MPSI_GEOMETRIES
} mpsi_geometry_kind;

/* The constants of a law, in the form of its loop. */
typedef struct mpsi_law {
  bool has_moduli; /* shear and bulk are those of an elastic solid at zero strain */
  /* from here to `layer_strength` only doubles: mpsi_material_give has each of them */
  double shear, bulk, lambda; /* Pa */
  double per_bulk;            /* 1/K */
  double yield, hardening;    /* von Mises, Pa */
  /* Drucker-Prager: the cone, the flow cone's slope, 1/(G + 9 K alpha alpha_flow), and the limit of
   * tension: mean stress and sqrt(J2) of the cone there. Mohr-Coulomb uses the inscribed cone to
   * find the particles that may yield. */
  double alpha, kappa, alpha_flow, cone, tension, q_tension;
  /* Mohr-Coulomb; cut: largest principal stress, infinite where the apex comes first. */
  double sin_phi, sin_psi, c_cos_phi, apex, cut;
  /* Both: V/V0 without stress at which dilation ends; 0: it does not end. */
  double loosest;
  /* Softening and rate: share of the strength that is left at last, exponent per plastic strain,
   * mu and 1/(reference rate); Mohr-Coulomb's slopes and cohesion, first and last. */
  double residual, per_strain, rate_factor, per_rate;
  double tan_phi, tan_phi_last, tan_psi, cohesion, cohesion_last, given_cut;
  /* Cam-Clay: M, lambda, kappa, G/K (0: `shear` is constant), a^4 of the Lode angle (1: a circle),
   * pc and e of the definition, p below which grains part and its logarithm. */
  double slope, compression, swelling, shear_ratio, lode, first_pc, first_void, least_pressure,
      log_least;
  /* Cyclic sand: C1 to C4 (C3 0: Byrne's form), least and largest amplitude that counts. */
  double contract[4], threshold, strain_limit;
  double viscosity; /* Pa s */
  /* Small strain: shear modulus and strength (sqrt(J2)) of each layer, Pa. */
  double layer_shear[MPSI_LAYERS], layer_strength[MPSI_LAYERS];
  bool tait, no_tension;                            /* fluid */
  bool turns_stress, needs_deformation, frictional; /* user */
  bool softens, softens_linearly;                   /* or depends on the rate */
  int32_t history_count;                            /* user */
  mps_material_fn update;
  mps_material_moduli_fn moduli;
  void *user;
} mpsi_law;

/* Applies a law to a block: not MPS_OK when a user's law fails. */
typedef mps_status (*mpsi_law_fn)(const mpsi_law *law, const mps_material_block *block);
typedef struct mpsi_law_table {
  mpsi_law_fn apply[MPSI_LAW_COUNT][MPSI_GEOMETRIES];
} mpsi_law_table;

/* x86-64 level: 0 the best that processor and build have, 1 the plain build; NULL if missing. */
const mpsi_law_table *mpsi_laws_select(int32_t isa);

struct mps_material {
  mps_context *context;
  atomic_int references;
  const mpsi_law_type *type;
  mpsi_law law;
  const mpsi_law_table *table;
  double wave_modulus; /* Pa */
  char name[MPSI_MATERIAL_NAME];
  int32_t history_count;
  char (*history_names)[MPSI_MATERIAL_NAME];
  char (*history_fields)[MPSI_MATERIAL_FIELD];
  double *history_initial;
  mps_release_fn release; /* of a user's law or UMAT, with its `user` */
  void *release_user;
  void *owned; /* data of law.user that the library allocated, freed with the material; or NULL */
  const double *owned_constants; /* in `owned`: those of a UMAT */
  int32_t owned_count;
  bool by_field; /* the last two columns of history are factors of stiffness and strength */
};

/* A material of one owner with room for its history, or NULL after recording that memory is short.
 */
mps_material *mpsi_material_new(mps_context *context, const char *function,
                                const mpsi_law_type *type, const char *name, int32_t history_count);

/* mps_material_create_user of a definition that is complete. */
mps_status mpsi_material_make_user(mps_context *context, const char *function,
                                   const mps_material_user_def *def, mps_material **out);
/* Checks the output of a user's law: describes the first value that is not finite in
 * block->message, its particle in *block->refused. */
mps_status mpsi_check_results(const mps_material_block *block, int32_t history_count);

/* Maps a trial stress (xx yy zz xy [zx yz]) back to the pyramid of Mohr and Coulomb. Returns its
 * flags; adds to *plastic_strain, opens and closes the gap, and returns, where it has flags, the
 * part of the step's volume strain that is not that of the grains. Dilation does not take the mean
 * stress below `least` (Pa): mpsi_least_mean. */
int64_t mpsi_mohr_coulomb_return(const mpsi_law *law, int32_t dim, double least, double *stress,
                                 double *plastic_strain, double *gap, double *opened);

/* State of one particle of Cam-Clay. */
typedef struct mpsi_clay {
  double strain, pc, void_ratio, gap; /* of the columns */
  double volume;                      /* V/V0 of the grains and their pores */
} mpsi_clay;
/* A step with the strain increment d (xx yy zz xy zx yz; 2D the first four) from a stress that has
 * been rotated. Returns the flags. */
int64_t mpsi_cam_clay_step(const mpsi_law *law, int32_t dim, const double *d, double *stress,
                           mpsi_clay *clay);

/* K0 of its one-dimensional virgin compression. */
double mpsi_cam_clay_k0(const mpsi_law *law);
/* M^2 in the direction of the deviator s (6, Pa) of the size q. */
double mpsi_cam_clay_slope2(const mpsi_law *law, const double *s, double q);

/* Columns of the factors of stiffness and strength. */
enum { MPSI_FACTORS = 2 };
/* by_field.c: the law with the factors of each particle. */
mps_status mpsi_apply_by_field(const mps_material *material, const mps_material_block *block);
/* Factor of a column's value: 0 stands for 1. */
static inline double mpsi_factor(double value) { return value > 0.0 ? value : 1.0; }

/* soften.c: share of the strength beyond the residual one that is left after a plastic strain. */
double mpsi_softening_share(const mpsi_law *law, double plastic_strain);
/* Factor of the strength at a rate (1/s): 1 + mu log10(rate/reference), at least 1. */
double mpsi_rate_factor(const mpsi_law *law, double rate);
/* Return of von Mises with softening: the drop of sqrt(3 J2) from its trial value and the new
 * plastic strain; `strength` is that of no plastic strain. */
double mpsi_soften_mises(const mpsi_law *law, double trial, double strength,
                         double *plastic_strain);
/* mpsi_mohr_coulomb_return with the strength of the plastic strain after the step. */
int64_t mpsi_soften_mohr_coulomb(const mpsi_law *law, int32_t dim, double rate, double least,
                                 double *stress, double *plastic_strain, double *gap,
                                 double *opened);

/* Mean stress (Pa) below which ground of the volume V/V0 does not get by dilation. Without its
 * stress it would have the volume V/V0 exp(-p/K), which neither elastic strain nor a gap changes:
 * it grows by dilation alone, up to that of the loosest state. */
static inline double mpsi_least_mean(const mpsi_law *law, double volume_ratio) {
  return law->loosest > 0.0 ? law->bulk * log(volume_ratio / law->loosest) : -INFINITY;
}
