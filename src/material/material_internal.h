/* material_internal.h - the interface of a material for solvers: the law on a block, without
 * checks.
 *
 * How a solver calls it, block by block, after its G2P:
 *   1. Columns of the particles of one material in the block: the velocity gradient of the step
 *      (2D: gradient[0, 1, 3, 4]; gradient[8] = v_r/r if axisymmetric, NULL in plane strain; 3D:
 *      all nine), in/out stress, volume_ratio, flags, the history columns, and the deformation
 *      gradient if mpsi_material_needs_deformation. They must not overlap; any alignment will do,
 *      64 bytes is fastest. They are contiguous: a particle is an index, not a stride. Particles
 *      of several materials: one call for each run of equal ones.
 *   2. mpsi_material_apply(). It does everything of Nakamura step 12 and 13: spin, trial stress,
 *      return map, and the new volume ratio (J *= 1 + dt tr(d), or det F). Of frictional laws that
 *      is the volume of the grains, without gaps, else V drifts and dt shrinks. Laws without
 *      mpsi_material_reads_volume() only multiply the column: the volume itself may stand there
 *      instead of the ratio.
 *   3. The stable step (49)-(50): M = mps_material_wave_modulus() for every particle, unless
 *      mpsi_material_stiffens(): then mpsi_material_wave_moduli() writes the present M of each.
 *      c = sqrt(M V/m). A viscous law also requires
 *      dt <= rho h^2/(4 dim mpsi_material_viscosity()). A volumetric scheme that changes tr(d)
 *      passes the changed gradient, and updates the volume itself where that must follow the
 *      unchanged one.
 *
 * Any number of threads may apply one material at once. Results do not depend on how particles are
 * cut into blocks, nor on the processor's instruction set, bit for bit.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/given.h"
#include "core/internal.h"

#include <mps/material.h>

/* One more owner; mps_material_destroy releases. Thread safe. */
mps_material *mpsi_material_retain(mps_material *material);

/* MPS_ERROR_ARGUMENT of NULL, MPS_ERROR_UNSUPPORTED of another law than linear elasticity. */
mps_status mpsi_material_check_elastic(mps_context *context, const char *function,
                                       const mps_material *material);

/* MPS_ERROR_ARGUMENT of NULL, MPS_ERROR_UNSUPPORTED of another law than a Newtonian fluid. */
mps_status mpsi_material_check_newtonian(mps_context *context, const char *function,
                                         const mps_material *material);

/* Adds the constants of the law; for NULL, that there is none. */
void mpsi_material_give(mpsi_given *list, const mps_material *material);

/* Applies the law to block->count >= 0 particles. Not MPS_OK: a user's law has failed; its reason
 * is in block->message, its particle in block->refused, which the caller has set to "" and -1. */
mps_status mpsi_material_apply(const mps_material *material, const mps_material_block *block);
/* Records such a failure: of the particle `id`, in step `step` (each -1: not known). */
mps_status mpsi_material_refused(mps_context *context, const char *function,
                                 const mps_material *material, mps_status status,
                                 const char *message, int64_t id, int64_t step);
#define MPSI_MATERIAL_MESSAGE 256  /* bytes of a law's reason */
#define MPSI_MATERIAL_COLUMNS 1024 /* of history, at most */

/* True: the value of volume_ratio decides the stress (fluids, neo-Hookean, users' laws). */
bool mpsi_material_reads_volume(const mps_material *material);
bool mpsi_material_needs_deformation(const mps_material *material); /* not the rate */
/* The field of a set with history column `index`; NULL: no such column. */
const char *mpsi_material_history_field(const mps_material *material, int32_t index);
/* True: a frictional law with a gap between its grains; its history has plastic_strain and opening.
 */
bool mpsi_material_opens(const mps_material *material);
/* Where these two are among its columns. */
void mpsi_material_sand_columns(const mps_material *material, int32_t *strain, int32_t *gap);
/* Where the gap between grains is among the columns of any law, whose V/V0 is without it; -1: none.
 */
int32_t mpsi_material_gap_column(const mps_material *material);
/* True: such a law with plastic dilation, an angle above 0; of a user's law it is unknown. */
bool mpsi_material_dilates(const mps_material *material);
/* True: its plastic dilation never ends. */
bool mpsi_material_dilates_without_end(const mps_material *material);
/* True: a law of the library that yields, of ground or metal, so that V/V0 is near 1 if all is
 * well; not rubber, linear elasticity, fluids, users' laws and sand whose dilation has an end. */
bool mpsi_material_keeps_volume(const mps_material *material);
/* True: a law of the library under which a body may flow slowly and for long; not rubber, fluids,
 * laws of small strains and of cycles, and users' laws. */
bool mpsi_material_flows(const mps_material *material);
/* The volumetric strain that suits a law (MPS_MPM_VOLUMETRIC_BY_LAW of mps/mpm.h). */
typedef enum mpsi_volume {
  MPSI_VOLUME_OWN,     /* each particle's own */
  MPSI_VOLUME_MEAN,    /* a mean: the law flows at constant volume, or hardly changes it */
  MPSI_VOLUME_FILTERED /* each particle's own, and its mean stress is filtered: friction */
} mpsi_volume;
mpsi_volume mpsi_material_volume(const mps_material *material);
/* True: a user's law, which may fail for a block. */
bool mpsi_material_may_refuse(const mps_material *material);
/* The column of the factors of E of each particle among those of its history, in which 0 stands for
 * 1; NULL: E is the same for all. */
const double *mpsi_material_stiffness(const mps_material *material, double *const *history);
/* True: values of history that are not 0 at the start are kept, and stress and history must fit one
 * another (mpsi_material_check_state). */
bool mpsi_material_has_start(const mps_material *material);
/* Such a start of one particle: stress (2 dim components), its history with 0 for the law's own
 * value. False, with the reason, where the law cannot begin there. */
bool mpsi_material_check_state(const mps_material *material, int32_t dim, const double *stress,
                               const double *history, char *reason, size_t size);
/* True: the wave modulus follows the state. */
bool mpsi_material_stiffens(const mps_material *material);
/* Writes an upper bound of K + 4G/3 (Pa) in the present state of each particle. */
void mpsi_material_wave_moduli(const mps_material *material, const mps_material_block *block,
                               double *moduli);
/* K + 4G/3 (Pa) at zero strain, by which the size of a particle follows its stress: that of the
 * moduli, where a user's law states them, else its wave modulus. */
double mpsi_material_rest_modulus(const mps_material *material);
/* G (Pa) at zero strain; of a user's law that does not state it a third of the wave modulus (nu =
 * 1/4). */
double mpsi_material_shear(const mps_material *material);
/* Recoverable part of the work of the law's stresses. */
typedef enum mpsi_kept {
  MPSI_KEPT_ALL,         /* elastic; and users' laws, where it is unknown */
  MPSI_KEPT_ELASTIC,     /* change of the stress's energy by Hooke's law: elastic-plastic */
  MPSI_KEPT_PRESSURE,    /* the mean stress times tr(d): fluids */
  MPSI_KEPT_UNDISSIPATED /* all but the growth of the column mpsi_material_dissipated, J/m3 */
} mpsi_kept;
mpsi_kept mpsi_material_kept(const mps_material *material);
/* That column's index among those of such a law. */
int32_t mpsi_material_dissipated(void);
/* Pa s; 0 for all but fluids and users' laws. */
double mpsi_material_viscosity(const mps_material *material);
/* Fills the history columns of new particles [begin, end). */
void mpsi_material_begin(const mps_material *material, double *const *history, int64_t begin,
                         int64_t end);
