/* mps/material.h - constitutive laws, applied to blocks of particles.
 *
 * A material is immutable after creation: it may be shared by solvers, contexts and threads. The
 * state of the particles (stress, volume, deformation gradient, history) lives in columns, one
 * value a particle, that the solver or the caller owns. The equations are in docs/materials.md.
 *
 * Signs and components: tension is positive. Tensors of two indices are stored by 3 i + j with
 * x, y, z = 0, 1, 2; in 2D only xx, xy, yx, yy (0, 1, 3, 4) and zz (8) are used, zz being the
 * direction out of the plane or the hoop. Stress is stored as xx, yy, zz, xy, zx, yz; in 2D the
 * first four. Angles are in radians. With pore water (mps/experimental/pore_water.h) the stress is
 * the effective one, else the total one: undrained clay is von Mises or Tresca in total stress.
 *
 * I1 is the trace of the stress, J2 half the sum of the squares of its deviator, s1 >= s2 >= s3 its
 * principal values; d is the rate of deformation, F the deformation gradient, J = V/V0 its
 * determinant, and dev the part without trace.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_MATERIAL_H
#define LIBMPS_MATERIAL_H

#include "particles.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_material mps_material;

/* ---- laws ----------------------------------------------------------------------------------
 * E is Young's modulus (1e-6 to 1e18 Pa), nu Poisson's ratio (-0.999 to 0.49999); other moduli and
 * strengths up to 1e18 Pa, viscosities up to 1e18 Pa s. Every law but the neo-Hookean solid and the
 * fluid rotates the stress of the previous step by the spin increment, Nakamura (45)-(47) in a form
 * that keeps its principal values to the last bits, adds C:d dt, and then returns the trial stress
 * to the yield surface. Errors: MPS_ERROR_ARGUMENT with the value and its range, MPS_ERROR_MEMORY.
 * */

/** Linear elastic, Jaumann rate. MPS_ERROR_ARGUMENT: `young` or `poisson` out of range;
 *  MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_linear_elastic(mps_context *context,
                                                                    double young, double poisson,
                                                                    mps_material **out);
/** Compressible neo-Hookean solid, for large elastic strain; needs the deformation gradient. sigma
 *  = G/J (F F^T - 1) + lambda/2 (J - 1/J) 1. MPS_ERROR_ARGUMENT: `young` or `poisson` out of range;
 *  MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_neo_hookean(mps_context *context, double young,
                                                                 double poisson,
                                                                 mps_material **out);

/** von Mises: sqrt(3 J2) = yield_stress + hardening * plastic_strain, associated. */
typedef struct mps_material_von_mises_def {
  uint32_t struct_size;
  uint32_t reserved;
  double young;        /* Pa, > 0; no default */
  double poisson;      /* default 0.3 */
  double yield_stress; /* Pa, in uniaxial tension, > 0; no default. Plane strain with cohesion c:
                          sqrt(3) c, Nakamura (54) */
  double hardening;    /* Pa per plastic strain, >= 0; default 0 */
  /** Softening: the strength falls to `residual` of itself as residual + (1 - residual) exp(-band
   *  gamma/slip), gamma the plastic engineering shear strain sqrt(3) plastic_strain. */
  double residual;       /* 0 to 1; default 1: no softening. Below 1 slip and band are needed */
  double slip;           /* m, > 0: relative displacement across a band at exp(-1); no default */
  double band;           /* m, > 0: width over which the solver spreads a band; WLS-MPM 1.5 cells
                            with cubic weights, 1.4 with quadratic ones; no default */
  double rate_factor;    /* mu >= 0: the strength grows by 1 + mu log10(rate/rate_reference), rate
                            the largest less the smallest principal strain rate; default 0 */
  double rate_reference; /* 1/s, > 0; no increase at smaller rates; default 3e-6 */
} mps_material_von_mises_def;

/** Fit of the Drucker-Prager cone to the Mohr-Coulomb pyramid. All cones have its apex; the flow
 *  potential is the same kind of cone for the angle of dilation. */
typedef enum mps_material_cone {
  MPS_MATERIAL_CONE_PLANE_STRAIN = 0,  /* the same strength in plane strain, whatever the dilation;
                                 where that equals the friction: Nakamura (56) */
  MPS_MATERIAL_CONE_CIRCUMSCRIBED = 1, /* outer cone, through the edges of triaxial compression */
  MPS_MATERIAL_CONE_INSCRIBED =
      2, /* inner cone, the largest that stays inside: always Nakamura (56) */
  MPS_MATERIAL_CONE_EXTENSION = 3 /* through the edges of triaxial extension */
} mps_material_cone;

/** Drucker-Prager: sqrt(J2) + alpha I1 = kappa, Nakamura (55), perfectly plastic. */
typedef struct mps_material_drucker_prager_def {
  uint32_t struct_size;
  int32_t cone;    /* mps_material_cone, default MPS_MATERIAL_CONE_PLANE_STRAIN */
  double young;    /* Pa, > 0; no default */
  double poisson;  /* default 0.3 */
  double friction; /* rad, angle phi, 0 <= phi < pi/2; no default */
  double dilation; /* rad, angle psi, 0 <= psi <= phi; default 0. Associated: phi */
  double cohesion; /* Pa, c >= 0, not 0 when phi is; default 0 */
  double tension;  /* Pa, largest mean stress I1/3, >= 0; default infinity: up to the apex of the
                      cone, c/tan(phi) */
  double void_ratio, max_void_ratio; /* end of dilation, as in Mohr-Coulomb; NaN (default) */
} mps_material_drucker_prager_def;

/** How the strength falls with the plastic strain. */
typedef enum mps_material_softening {
  MPS_MATERIAL_SOFTENING_EXPONENTIAL = 0,
  MPS_MATERIAL_SOFTENING_LINEAR = 1
} mps_material_softening;

/** Mohr-Coulomb: (s1 - s3) + (s1 + s3) sin(phi) = 2 c cos(phi), with a cut-off s1 <= T (Rankine)
 *  whose flow is normal to it. Perfectly plastic unless softening is given. Tresca: friction 0,
 *  cohesion su. */
typedef struct mps_material_mohr_coulomb_def {
  uint32_t struct_size;
  uint32_t reserved;
  double young;    /* Pa, > 0; no default */
  double poisson;  /* default 0.3 */
  double friction; /* rad, angle phi, 0 <= phi < pi/2; no default */
  double dilation; /* rad, angle psi, 0 <= psi <= phi; default 0 */
  double cohesion; /* Pa, c >= 0, not 0 when phi is; default 0 */
  double tension;  /* Pa, T, largest principal stress, >= 0; default infinity: up to the apex */
  /** Softening: tan(phi) and c go from their values to residual ones, tan(psi) to 0, with the share
   *  exp(-band gamma/slip) or max(0, 1 - band gamma/slip) of what is left, as in von Mises. */
  double residual_friction; /* rad, 0 to friction; NaN (default): friction */
  double residual_cohesion; /* Pa, 0 to cohesion; NaN (default): cohesion */
  double slip, band;        /* m, as in von Mises; needed where a residual value is smaller */
  double rate_factor;       /* as in von Mises, of the cohesion; default 0 */
  double rate_reference;    /* 1/s, > 0; default 3e-6 */
  int32_t softening;        /* mps_material_softening; default MPS_MATERIAL_SOFTENING_EXPONENTIAL */
  int32_t reserved_2;
  /** Dilation ends where the sand, without its stress, would have the largest void ratio: at e_max
   *  less the elastic compression, for which (1 + e)/(1 + void_ratio) is V/V0. So e is at most
   *  max_void_ratio in compression, whatever the path. Both or neither. */
  double void_ratio;     /* e at the start, 0.001 to 100; NaN (default): dilation does not end */
  double max_void_ratio; /* e_max, void_ratio to 100; NaN (default) */
} mps_material_mohr_coulomb_def;

/** Pressure of a fluid from its density ratio r = rho/rho0 = V0/V. */
typedef enum mps_material_state_equation {
  MPS_MATERIAL_STATE_EQUATION_LINEAR = 1, /* p = K (r - 1) */
  MPS_MATERIAL_STATE_EQUATION_TAIT = 0    /* p = K/7 (r^7 - 1) */
} mps_material_state_equation;

/** Weakly compressible Newtonian fluid: sigma = -p 1 + 2 viscosity dev(d). */
typedef struct mps_material_newtonian_def {
  uint32_t struct_size;
  int32_t state;       /* mps_material_state_equation, default MPS_MATERIAL_STATE_EQUATION_TAIT */
  double bulk_modulus; /* Pa, K = rho0 c^2 > 0; no default */
  double viscosity;    /* Pa s, >= 0; default 0. Viscous flow needs flip_time of mps_mpm_def */
  int32_t no_tension;  /* 1: p >= 0, and the volume does not grow beyond V0; default 0 */
  int32_t reserved;
} mps_material_newtonian_def;

static inline mps_material_von_mises_def mps_material_von_mises_defaults(void) {
  mps_material_von_mises_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MATERIAL_VON_MISES, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}
static inline mps_material_drucker_prager_def mps_material_drucker_prager_defaults(void) {
  mps_material_drucker_prager_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MATERIAL_DRUCKER_PRAGER, &def, sizeof def) != MPS_OK)
    def.struct_size = 0;
  return def;
}
static inline mps_material_mohr_coulomb_def mps_material_mohr_coulomb_defaults(void) {
  mps_material_mohr_coulomb_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MATERIAL_MOHR_COULOMB, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}
static inline mps_material_newtonian_def mps_material_newtonian_defaults(void) {
  mps_material_newtonian_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MATERIAL_NEWTONIAN, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** von Mises plasticity. Constants are copied. MPS_ERROR_ARGUMENT: a constant out of range, which
 *  the message names; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_von_mises(
    mps_context *context, const mps_material_von_mises_def *def, mps_material **out);
/** Drucker-Prager plasticity. Constants are copied. MPS_ERROR_ARGUMENT: a constant out of range,
 *  which the message names; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_drucker_prager(
    mps_context *context, const mps_material_drucker_prager_def *def, mps_material **out);
/** Mohr-Coulomb plasticity. Constants are copied. MPS_ERROR_ARGUMENT: a constant out of range,
 *  which the message names; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_mohr_coulomb(
    mps_context *context, const mps_material_mohr_coulomb_def *def, mps_material **out);
/** Weakly compressible Newtonian fluid. Constants are copied. MPS_ERROR_ARGUMENT: a constant out of
 *  range, which the message names; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_newtonian(
    mps_context *context, const mps_material_newtonian_def *def, mps_material **out);
/** Releases and nulls; accepts NULL. Solvers that use the material keep their own reference. */
MPS_API void mps_material_destroy(mps_material **material);

/* ---- queries: thread safe; a NULL material gives "", 0 or NULL ------------------------------- */

/** "linear_elastic", "drucker_prager", ... or the user's name. Lives as long as the material. */
MPS_API const char *mps_material_name(const mps_material *material);
/** K + 4G/3 at zero strain (Pa): the P wave velocity is its square root over the density's. */
MPS_API double mps_material_wave_modulus(const mps_material *material);
/** Number of history columns of the law; 0 for NULL. */
MPS_API int32_t mps_material_history_count(const mps_material *material);
/** Name of a history column, NULL outside 0..count-1; the field of the set that holds it has the
 *  same name under the library's laws, "<material>.<column>" under a user's law or UMAT. Laws of
 * the same name share fields, since a particle obeys one law. `plastic_strain` is the sum of
 *  sqrt(2/3 de:de) over the plastic, deviatoric strain increments, `opening` (frictional laws) the
 *  volume strain of the gap that compression closes before the mean stress falls below 0. */
MPS_API const char *mps_material_history_name(const mps_material *material, int32_t index);
/** Value of a history column before the first step. */
MPS_API double mps_material_history_initial(const mps_material *material, int32_t index);

/* ---- constants of isotropic elasticity ------------------------------------------------------- */

/** Constants of isotropic elasticity. */
typedef struct mps_moduli {
  double young, poisson;      /* E, Pa; nu */
  double shear, bulk, lambda; /* G, K, K - 2G/3, Pa */
  double wave;                /* K + 4G/3, Pa */
  double density;             /* kg/m3 */
  double shear_velocity;      /* Vs = sqrt(G/rho), m/s */
  double pressure_velocity;   /* Vp = sqrt((K + 4G/3)/rho), m/s */
} mps_moduli;

/** From E (1e-6 to 1e18 Pa), nu (-0.999 to 0.49999) and the density (1e-9 to 1e9 kg/m3). These
 *  ranges hold wherever a material takes such a value. MPS_ERROR_ARGUMENT: outside. */
MPS_API MPS_NODISCARD mps_status mps_moduli_from_elastic_sized(mps_context *context, double young,
                                                               double poisson, double density,
                                                               mps_moduli *out, size_t size);
static inline mps_status mps_moduli_from_elastic(mps_context *owner, double young, double poisson,
                                                 double density, mps_moduli *out) {
  return mps_moduli_from_elastic_sized(owner, young, poisson, density, out, sizeof *out);
}
/** From Vs and Vp (1e-6 to 1e9 m/s; Vp 1.155 to 223 times Vs, so that nu is in its range) and the
 *  density. MPS_ERROR_ARGUMENT: a value, or the resulting E, out of range. */
MPS_API MPS_NODISCARD mps_status mps_moduli_from_velocities_sized(mps_context *context,
                                                                  double shear_velocity,
                                                                  double pressure_velocity,
                                                                  double density, mps_moduli *out,
                                                                  size_t size);
static inline mps_status mps_moduli_from_velocities(mps_context *owner, double shear_velocity,
                                                    double pressure_velocity, double density,
                                                    mps_moduli *out) {
  return mps_moduli_from_velocities_sized(owner, shear_velocity, pressure_velocity, density, out,
                                          sizeof *out);
}
/** Constants of a material in its elastic range, at zero strain, with `density` (kg/m3).
 *  MPS_ERROR_ARGUMENT: density out of range; MPS_ERROR_UNSUPPORTED: a fluid, or a user's law that
 *  does not state a shear modulus. */
MPS_API MPS_NODISCARD mps_status mps_material_get_moduli_sized(const mps_material *material,
                                                               double density, mps_moduli *out,
                                                               size_t size);
static inline mps_status mps_material_get_moduli(const mps_material *material, double density,
                                                 mps_moduli *out) {
  return mps_material_get_moduli_sized(material, density, out, sizeof *out);
}
/** Assigns a material and a density (kg/m3) to the particles `ids` (count 0 and NULL: all) in the
 *  fields that the solvers of elasticity read: `density`, `young`, `poisson`, `shear_velocity`,
 *  `pressure_velocity`, added where the set lacks them. So one linear elastic material serves
 *  explicit dynamics, implicit elasticity and, given to its create, WLS-MPM. MPS_ERROR_UNSUPPORTED:
 *  another law; MPS_ERROR_ARGUMENT: a material of another context, a density out of range, an id
 *  that the set lacks. Nothing has changed on an error. */
MPS_API MPS_NODISCARD mps_status mps_particles_set_material(mps_particles *particles,
                                                            const mps_material *material,
                                                            double density, const int64_t *ids,
                                                            int64_t count);

MPS_EXTERN_C_END

#include "material_law.h"

#endif
