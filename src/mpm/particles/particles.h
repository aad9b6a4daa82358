/* particles.h - the particles of the set as the solver has them (particles.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_PARTICLES_H
#define MPSI_MPM_PARTICLES_H

#include "mpm/base/mpm_solver.h"

#define MPSI_MPM_MOST_PARTICLES INT32_MAX

/* Columns and number as they are in the set now. */
void mpsi_mpm_bind(const mpsi_grid *grid, mpsi_columns *p, mpsi_water *water);
/* Room for what the solver keeps for each particle; false: refused. Of the forces of loads only
 * where there are such, or by the second. */
bool mpsi_mpm_make_room(void *mpm, int64_t particles);
/* The same, giving up what there is. */
bool mpsi_mpm_shrink_room(mps_mpm *mpm, int64_t particles);
bool mpsi_mpm_force_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                         mpsi_rooms *rooms, int64_t particles);
/* What means of the change of volume and the filter of stresses need, as laws do. */
bool mpsi_mpm_volume_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                          mpsi_rooms *r, int64_t particles, bool means, bool filter);

/* Places inside the domain, of particles [first, end). */
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
/* Of the particles whose law reads it: what is turned inside out has no stress. */
mps_status mpsi_mpm_check_deformations(mps_context *context, const mpsi_grid *grid,
                                       const mpsi_columns *p, const char *function);
/* Volumes and masses from density and spacing; unstrained states where the caller gave none. */
void mpsi_mpm_begin_particles(const mpsi_grid *grid, const mpsi_columns *p,
                              mpsi_contacts *contacts);
/* The volume of a particle that the caller gave none. */
double mpsi_mpm_lattice_volume(const mpsi_grid *grid, const mpsi_columns *p, int64_t particle);

/* outflow.c: room for the marks of a step that may take particles out; those that have passed open
 * sides in it. */
mps_status mpsi_mpm_prepare_outflow(mps_context *context, const mpsi_columns *p, mpsi_boundaries *b,
                                    const mpsi_contacts *contacts, mpsi_rooms *rooms,
                                    const char *function);
void mpsi_mpm_remove_leaving(const mpsi_grid *grid, const mpsi_columns *p,
                             const mpsi_boundaries *boundaries, mpsi_energy *energy,
                             const mpsi_rooms *rooms);

/* As the holder of the set: see mpsi_holder; insertion.c from the third on. */
bool mpsi_mpm_compares(const void *mpm, const char *field);
mps_status mpsi_mpm_note_edit(void *mpm, const char *function, const char *field,
                              const double *former);
mps_status mpsi_mpm_insert(void *mpm, const char *function, int64_t first, int64_t count);
mps_status mpsi_mpm_remove(void *mpm, const char *function, int64_t count, const int64_t *ids);
void mpsi_mpm_renew(void *mpm);

/* ready.c: a call that fails after it has taken up what the caller has written
 * (mpsi_mpm_apply_edits) puts that off again: the step and its limit are those of before. */
typedef struct mpsi_edit_state {
  double speed;
  bool edited;
} mpsi_edit_state;
mpsi_edit_state mpsi_mpm_edit_state(const mpsi_run *run);
void mpsi_mpm_restore_edit_state(mpsi_run *run, const mpsi_edit_state *before);

#endif
