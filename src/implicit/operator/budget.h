/* budget.h - strain energy, and the works of loads, boundaries and damping.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

/* Works since the motion began, or of the last static solution (J). */
typedef struct mpsi_ledger {
  double loads, boundaries;
  double inner; /* of K (u + a1 v): strain energy and stiffness damping together */
  double mass_damping;
  double left;            /* of the forces that the solutions leave unbalanced */
  double kinetic, strain; /* at the start */
} mpsi_ledger;

/* ---- budget.c -------------------------------------------------------------------------------- */
mps_status mpsi_elastic_strain_energy(mps_elastic *e, const char *function, double *out);
/* Before a change of moduli: keeps the strain energy of a motion under way. */
mps_status mpsi_elastic_note_strain(mps_elastic *e, const char *function);
/* At the start of a motion. */
mps_status mpsi_elastic_begin_ledger(mps_elastic *e, const char *function);
/* Statics, loaded in proportion from rest; e->work is the load less K u. */
void mpsi_elastic_count_solution(mps_elastic *e);
/* Works of a step to displacements u, velocities v, accelerations a and forces inner, held. */
void mpsi_elastic_count_step(mps_elastic *e, const double *u, const double *v, const double *a,
                             const double *inner, const double *held);

mps_status mpsi_elastic_get_totals(void *elastic, const char *function, mps_totals *out);
