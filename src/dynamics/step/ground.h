/* ground.h - what the body is made of, and fields that the caller edits.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

mps_status mpsi_dynamics_check_ground(mps_particles *particles, const char *function);
/* Writes wave velocities of `count` particles, or of all (0, NULL): all or nothing. */
mps_status mpsi_dynamics_write_material(mps_particles *particles, const char *function,
                                        const mps_material *material, int64_t count,
                                        const int64_t *ids);
/* Kinetic and strain energy of the budget: 0 before it starts. A change of the body between steps
 * shifts the budget's initial value by the difference. Fails with a domain only. */
mps_status mpsi_dynamics_present_energy(mps_dynamics *dynamics, const char *function,
                                        double *energy);
/* The holder's commit: a field has been edited. */
mps_status mpsi_dynamics_commit(void *self, const char *function, const char *field,
                                const double *former);
/* Before a step: reads edited material fields, and finds whether the motion was edited (begins), or
 * returns the error of either. `status` is this rank's so far. */
mps_status mpsi_dynamics_reread_ground(mps_dynamics *dynamics, const char *function,
                                       mps_status status);
/* Before a query of the state: both. */
mps_status mpsi_dynamics_read_edits(mps_dynamics *dynamics, const char *function,
                                    mps_status status);
