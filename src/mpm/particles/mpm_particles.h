/* mpm_particles.h - columns, checks and memory of the solver's particles (mpm_particles.c, rooms.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_PARTICLES_H
#define MPSI_MPM_PARTICLES_H

#include "mpm/base/mpm_solver.h"

#define MPSI_MPM_MOST_PARTICLES INT32_MAX

/* Sets the columns and the number of particles from the set. */
void mpsi_mpm_bind(const mpsi_grid *grid, mpsi_columns *p, mpsi_water *water);
/* Memory for what the solver stores for each particle; false: refused. Memory for the forces of
 * loads is allocated where there are any, or by mpsi_mpm_force_room. */
bool mpsi_mpm_make_room(void *mpm, int64_t particles);
/* Memory as by mpsi_mpm_make_room, without the present contents and no larger than needed. */
bool mpsi_mpm_shrink_room(mps_mpm *mpm, int64_t particles);
bool mpsi_mpm_force_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                         mpsi_rooms *rooms, int64_t particles);
/* Memory for means of the change of volume and for the filter of stresses, as the laws need
 * them. */
bool mpsi_mpm_volume_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                          mpsi_rooms *r, int64_t particles, bool means, bool filter);

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
/* Volume of a particle for which the caller gave none: that of the lattice. */
double mpsi_mpm_lattice_volume(const mpsi_grid *grid, const mpsi_columns *p, int64_t particle);

/* outflow.c: memory for the marks of removed particles; removes those that have passed open sides
 * in the step. */
mps_status mpsi_mpm_prepare_outflow(mps_context *context, const mpsi_columns *p, mpsi_boundaries *b,
                                    const mpsi_contacts *contacts, mpsi_rooms *rooms,
                                    const char *function);
void mpsi_mpm_remove_leaving(const mpsi_grid *grid, const mpsi_columns *p,
                             const mpsi_boundaries *boundaries, mpsi_energy *energy,
                             const mpsi_rooms *rooms);

/* Callbacks of the holder of the set: see mpsi_holder; insertion.c from the third on. */
bool mpsi_mpm_compares(const void *mpm, const char *field);
mps_status mpsi_mpm_note_edit(void *mpm, const char *function, const char *field,
                              const double *former);
mps_status mpsi_mpm_insert(void *mpm, const char *function, int64_t first, int64_t count);
mps_status mpsi_mpm_remove(void *mpm, const char *function, int64_t count, const int64_t *ids);
void mpsi_mpm_renew(void *mpm);

/* ready.c: what mpsi_mpm_apply_edits changes, for a call that fails after it: the speed that limits
 * the step, and that edits are waiting. */
typedef struct mpsi_edit_state {
  double speed;
  bool edited;
} mpsi_edit_state;
mpsi_edit_state mpsi_mpm_edit_state(const mpsi_run *run);
void mpsi_mpm_restore_edit_state(mpsi_run *run, const mpsi_edit_state *before);

#endif
