/* field.h - the map of peak accelerations of a slope.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_WAVE_FIELD_H
#define EXAMPLES_WAVE_FIELD_H

#include "settings.h"

typedef struct field {
  mps_particles *particles; /* borrowed; of several ranks this one's share */
  int64_t count;            /* of all ranks; 0: no map */
  double *peak;             /* |acceleration|, m/s2, by particle id; of others' particles 0 */
} field;

/* Of `count` particles of all ranks. */
bool field_create(app *a, const settings *s, mps_particles *particles, int64_t count, field *out);
void field_destroy(field *f);
/* Raises the peaks to the present accelerations. */
mps_status field_record(field *f);
/* Brings the peaks of all ranks together. Collective. */
mps_status field_join(field *f, mps_domain *domain);
/* peaks.csv: x, y, peak of each particle of the slope, which `whole` has all; peaks.png. */
bool field_write(app *a, const settings *s, const field *f, mps_particles *whole);

#endif
