/* objects.c - fields of a test's particles. SPDX-License-Identifier: BSD-3-Clause */
#include "test_common.h"

mps_view view_field(mps_particles *set, const char *field) {
  mps_view view;
  OK(mps_particles_view(set, field, &view));
  return view;
}

mps_edit edit_field(mps_particles *set, const char *field) {
  mps_edit edit;
  OK(mps_particles_edit(set, field, &edit));
  return edit;
}

mps_edit *commit_field(mps_particles *set, mps_edit *edit) {
  OK(mps_particles_commit(set, edit));
  return NULL;
}

mps_particles *box_of(mps_context *context, double spacing, const double *lo, const double *hi) {
  DEF(particles, def, .spacing = spacing);
  MAKE_KEPT(particles, set, create, context, &def);
  OK(mps_particles_fill_box(set, lo, hi, NULL));
  return set;
}

void set_fields(mps_particles *set, const field_value *values) {
  for (const field_value *v = values; v->field; v++)
    OK(mps_particles_set(set, v->field, 0, v->value));
}
