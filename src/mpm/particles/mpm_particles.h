/* mpm_particles.h - columns and checks of the solver's particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/particles/particles_internal.h"
#include "mpm/base/run.h"
#include "mpm/grid/blocks.h"

#define MPSI_MPM_MOST_PARTICLES INT32_MAX

/* Sets the columns and the number of particles from the set. */
void mpsi_mpm_bind(const mpsi_grid *grid, mpsi_columns *p, mpsi_water *water);
/* Checks that the positions of particles [first, end) are inside the domain. */
mps_status mpsi_mpm_check_places(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 const mps_mpm_def *def, const char *function, int64_t first,
                                 int64_t end);
/* Fields are finite and places inside the domain; density, volume and volume ratio are positive;
 * every particle has a mass. */
mps_status mpsi_mpm_check_start(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                const mps_mpm_def *def, const char *function);
/* After a step that has lost a particle: MPS_ERROR_STATE as long as one is outside the domain. */
mps_status mpsi_mpm_check_lost(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                               const mpsi_run *run, const mps_mpm_def *def, const char *function);
mps_status mpsi_mpm_check_amounts(mps_context *context, const mpsi_grid *grid,
                                  const mpsi_columns *p, const char *function);
mps_status mpsi_mpm_check_masses(mps_context *context, const mpsi_columns *p, const char *function);
/* Checks the deformation gradient of particles whose law reads it: an inverted one has no
 * stress. */
mps_status mpsi_mpm_check_deformations(mps_context *context, const mpsi_grid *grid,
                                       const mpsi_columns *p, const char *function);
/* Volumes and masses from density and spacing; unstrained states where the caller gave none. */
void mpsi_mpm_begin_particles(const mpsi_grid *grid, const mpsi_columns *p,
                              mpsi_contacts *contacts);
/* New masses of particles whose density or volume (`field`) the caller has changed; `former`: its
 * values before. Added particles have no mass yet. */
mps_status mpsi_mpm_renew_masses(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 mpsi_contacts *contacts, const char *function, const char *field,
                                 const double *former);
/* Volume of a particle for which the caller gave none: that of the lattice. */
double mpsi_mpm_lattice_volume(const mpsi_grid *grid, const mpsi_columns *p, int64_t particle);

/* ready.c */
mpsi_edit_state mpsi_mpm_edit_state(const mpsi_run *run);
void mpsi_mpm_restore_edit_state(mpsi_run *run, const mpsi_edit_state *before);
