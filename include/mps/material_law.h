/* mps/material_law.h - laws on blocks of particles: what a law receives and returns, a law of the
 * caller's own, an Abaqus UMAT, and any law without a solver, on a block or in one particle.
 *
 * Signs, components and units: mps/material.h, which includes this header.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_MATERIAL_LAW_H
#define LIBMPS_MATERIAL_LAW_H

#include "material.h"

MPS_EXTERN_C_BEGIN

/** State of a particle after this step's update: bits of the column `flags`. */
#define MPS_MATERIAL_FLAG_PLASTIC 1 /* the trial stress was outside the yield surface */
#define MPS_MATERIAL_FLAG_APEX 2    /* at the limit of tension, or a gap between grains is open */

/** A block of particles, the input and output of a law: columns of `count` doubles, each
 *  contiguous. */
typedef struct mps_material_block {
  uint32_t struct_size;
  int32_t dim;   /* 2 or 3 */
  int64_t count; /* >= 0 */
  double dt;     /* s, > 0 */
  double time;   /* s, at the end of the step */
  /** In: velocity gradient of the step, dv_i/dx_j, 1/s. In 2D zz may be NULL: plane strain. */
  const double *gradient[9];
  /** In, out: deformation gradient, updated by Nakamura (44) before a user's law is called. All the
   *  components of `dim` (in 2D also zz), or all NULL for a law that does not need it. */
  double *deformation[9];
  /** In, out: V/V0. A user's law receives its value at the end of the step: the library has
   *  multiplied it by 1 + dt tr(d), or set it to det F. Such a law does not change it, unless part
   *  of the volume strain is not that of the material: in the frictional laws here it is that of
   *  the grains, without the gaps between them. */
  double *volume_ratio;
  double *stress[6]; /* In, out: Cauchy stress, Pa. */
  /** In, out: history_count columns, at least mps_material_history_count; NULL for none. Column h
   * of particle i is history[h][i]. */
  double *const *history;
  int32_t history_count;
  int32_t message_size; /* bytes of `message` */
  int64_t *flags;       /* Out: MPS_MATERIAL_... bits. */
  /* In, each NULL where unknown: */
  const int64_t *ids;        /* of the particles */
  const double *position[3]; /* m, at the end of the step */
  const double *temperature; /* K: the set's field `temperature` */
  /* Out, where a user's law fails; each may be NULL. */
  char *message;    /* the reason, terminated; "" on entry */
  int64_t *refused; /* index within the block of the particle at which it fails; -1 on entry */
} mps_material_block;

static inline mps_material_block mps_material_block_defaults(void) {
  mps_material_block block;
  memset(&block, 0, sizeof block);
  if (mps_def_init(MPS_DEF_MATERIAL_BLOCK, &block, sizeof block) != MPS_OK) block.struct_size = 0;
  return block;
}

/* ---- laws of the caller's own ---------------------------------------------------------------- */

/** A user's law. Called once a block, by several threads at once; reads `gradient` and writes
 *  `stress`, `history` and `flags` (zero on entry). `deformation` and `volume_ratio` are those of
 *  the end of the step already; a law may set the volume ratio back. Returns MPS_OK. Any other
 *  status ends the solver's call, which returns it; the error record has the name of the law, the
 *  particle block->refused and the text of block->message. Where several blocks fail in a step the
 *  first is reported. The step is undone: a solver with such a law keeps its particles' former
 *  values for that (8 bytes for each component of the fields that a step writes). */
typedef mps_status (*mps_material_fn)(void *user, const mps_material_block *block);

/** Writes an upper bound of K + 4G/3 (Pa, finite and > 0) of each particle of the block in its
 *  present state: by it the solver limits its step. Reads `stress`, `volume_ratio`, `history`,
 *  `temperature`; `gradient` and `deformation` are those of the last step. Called by several
 *  threads at once. Any other value is MPS_ERROR_DIVERGED of the step, which names the particle. */
typedef void (*mps_material_moduli_fn)(void *user, const mps_material_block *block, double *moduli);

typedef struct mps_material_user_def {
  uint32_t struct_size;
  int32_t history_count;      /* 0..1024; default 0 */
  mps_material_fn update;     /* no default */
  void *user;                 /* passed to `update` and `moduli` */
  mps_release_fn release;     /* of `user`, once no solver has the law */
  const char *name;           /* copied, at most 47 characters, not "user"; default "law" */
  const char *const *history; /* names [A-Za-z_][A-Za-z0-9_]*, at most 47 characters, copied; in a
                                 set the column is the field "<name>.<history>" */
  const double *history_initial; /* values before the first step; NULL: zero */
  double wave_modulus;       /* Pa, K + 4G/3 of the stiffest state, > 0; NaN (default): that of the
                                moduli below; one of the two must be stated */
  double viscosity;          /* Pa s, for the largest stable step, >= 0; default 0 */
  int32_t needs_deformation; /* 1: `deformation` is there; default 0 */
  int32_t turns_stress;      /* 1 (default): `stress` is already rotated by the spin increment */
  /** K > 0 and G >= 0 at zero strain, Pa. They give the elastic strain of a particle in contact
   *  from its stress. NaN, NaN (default): not stated; then K + 4G/3 is the wave modulus, and nu
   * 1/4. */
  double bulk_modulus, shear_modulus;
  /** The wave modulus by the present state; NULL (default): `wave_modulus` at all times. Contacts
   *  and absorbing walls take `wave_modulus`. */
  mps_material_moduli_fn moduli;
  /** 1: a law with friction between grains that part from one another, which solvers treat as
   *  Mohr-Coulomb: each particle has its own change of volume, and its mean stress is filtered
   *  (mps_mpm_volumetric). `history` must name "plastic_strain", which grows where the law yields,
   *  and "opening", the volume strain of the gap between the grains, >= 0; `bulk_modulus` must be
   *  stated and needs_deformation be 0. The filter changes the mean stress and the opening, with
   *  p + K opening for the mean stress of grains that have parted, and calls `update` once more
   *  with velocity gradients 0: it returns to the yield surface then. 0 (default): a law
   *  without such grains */
  int32_t frictional;
  int32_t reserved;
} mps_material_user_def;

/** An Abaqus UMAT, as a C function or as a Fortran subroutine (`umat_` of gfortran): for each
 *  particle one call with Abaqus' arguments, in Abaqus' order and conventions. NDI = 3; NSHR and
 *  NTENS are 1 and 4 in plane strain and axisymmetry (11, 22, 33, 12), 3 and 6 in 3D (11, 22, 33,
 *  12, 13, 23); shear strains are engineering ones; matrices are stored by columns, as Fortran has
 *  them. Integers are of 32 bits (not -fdefault-integer-8), reals of 64. docs/materials.md says
 *  what each argument holds. `cmname_length` is the hidden length of CMNAME, 80. */
typedef void (*mps_material_umat_fn)(
    double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd,
    double *rpl, double *ddsddt, double *drplde, double *drpldt, const double *stran,
    const double *dstran, const double *time, const double *dtime, const double *temp,
    const double *dtemp, const double *predef, const double *dpred, const char *cmname,
    const int32_t *ndi, const int32_t *nshr, const int32_t *ntens, const int32_t *nstatv,
    const double *props, const int32_t *nprops, const double *coords, const double *drot,
    double *pnewdt, const double *celent, const double *dfgrd0, const double *dfgrd1,
    const int32_t *noel, const int32_t *npt, const int32_t *layer, const int32_t *kspt,
    const int32_t *kstep, const int32_t *kinc, size_t cmname_length);

/** Head of a UMAT in C, its arguments by Abaqus' names in lower case; in its body
 *  MPS_MATERIAL_UMAT_UNUSED avoids warnings about unused arguments: static
 *  MPS_MATERIAL_UMAT(spring) { MPS_MATERIAL_UMAT_UNUSED; stress[0] += props[0] * dstran[0]; } */
#define MPS_MATERIAL_UMAT(name)                                                                    \
  void name(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, \
            double *rpl, double *ddsddt, double *drplde, double *drpldt, const double *stran,      \
            const double *dstran, const double *time, const double *dtime, const double *temp,     \
            const double *dtemp, const double *predef, const double *dpred, const char *cmname,    \
            const int32_t *ndi, const int32_t *nshr, const int32_t *ntens, const int32_t *nstatv,  \
            const double *props, const int32_t *nprops, const double *coords, const double *drot,  \
            double *pnewdt, const double *celent, const double *dfgrd0, const double *dfgrd1,      \
            const int32_t *noel, const int32_t *npt, const int32_t *layer, const int32_t *kspt,    \
            const int32_t *kstep, const int32_t *kinc, size_t cmname_length)
#define MPS_MATERIAL_UMAT_UNUSED                                                                   \
  ((void)stress, (void)statev, (void)ddsdde, (void)sse, (void)spd, (void)scd, (void)rpl,           \
   (void)ddsddt, (void)drplde, (void)drpldt, (void)stran, (void)dstran, (void)time, (void)dtime,   \
   (void)temp, (void)dtemp, (void)predef, (void)dpred, (void)cmname, (void)ndi, (void)nshr,        \
   (void)ntens, (void)nstatv, (void)props, (void)nprops, (void)coords, (void)drot, (void)pnewdt,   \
   (void)celent, (void)dfgrd0, (void)dfgrd1, (void)noel, (void)npt, (void)layer, (void)kspt,       \
   (void)kstep, (void)kinc, (void)cmname_length)

typedef struct mps_material_umat_def {
  uint32_t struct_size;
  int32_t statev_count;      /* NSTATV: 0 (default) to 1000 */
  mps_material_umat_fn umat; /* no default */
  void *user; /* what `umat` needs to exist, such as its code; Abaqus' arguments have no place for
                 it */
  mps_release_fn release;          /* of `user`, once no solver has the law */
  const char *name;                /* CMNAME, as of a user's law; default "umat" */
  const double *props;             /* PROPS, copied, finite */
  int32_t props_count;             /* NPROPS, >= 0; default 0 */
  int32_t needs_deformation;       /* 1: DFGRD0 and DFGRD1, else unit tensors; default 0 */
  const char *const *statev_names; /* of the history columns; NULL: statev_1, statev_2, ... */
  const double *statev_initial;    /* STATEV before the first step; NULL: zero */
  double wave_modulus;             /* Pa, as of a user's law */
  double length;                   /* m, CELENT, > 0; default 1 */
  double temperature;              /* TEMP where the set has no field `temperature`; default 0 */
  int32_t keeps_strain; /* 1 (default): STRAN is the total strain, in six more columns of history;
                           0: zero */
  int32_t reserved;
  double bulk_modulus, shear_modulus; /* Pa, at zero strain, as of a user's law; default NaN, NaN */
} mps_material_umat_def;

static inline mps_material_user_def mps_material_user_defaults(void) {
  mps_material_user_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MATERIAL_USER, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}
static inline mps_material_umat_def mps_material_umat_defaults(void) {
  mps_material_umat_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MATERIAL_UMAT, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** A law by the caller's function. Names and constants are copied. MPS_ERROR_ARGUMENT: `update`
 *  NULL, a name that is not allowed, or a constant out of range; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_material_create_user(mps_context *context,
                                                          const mps_material_user_def *def,
                                                          mps_material **out);

/** A law by a UMAT. Threads call the UMAT concurrently, for different particles, so it must write
 *  to its arguments alone (in Fortran no SAVE, COMMON or DATA that changes, and gfortran
 *  -frecursive); otherwise create the context with MPS_CONTEXT_EXECUTOR_SERIAL. A step returns
 *  MPS_ERROR_NUMERIC where the UMAT sets PNEWDT below 1 or leaves a stress or state variable that
 *  is not finite. Creation: MPS_ERROR_ARGUMENT and MPS_ERROR_MEMORY as mps_material_create_user. */
MPS_API MPS_NODISCARD mps_status mps_material_create_umat(mps_context *context,
                                                          const mps_material_umat_def *def,
                                                          mps_material **out);

MPS_EXTERN_C_END
#endif
