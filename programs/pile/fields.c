/* fields.c - the soil at some depths of the pile: kept for the pictures (Nakamura, Figures 24 and
 * 25), and as a VTKHDF series where the library has HDF5. SPDX-License-Identifier: BSD-3-Clause */
#include "pile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Pictures show frames evenly among all, the last one always. */
int64_t pile_pictures(const pile *p, int64_t frames) {
  const int64_t all = p->s.course.frames, shown = all < PILE_PICTURES ? all : PILE_PICTURES;
  return all > 0 ? frames * shown / all : 0;
}

static mps_status keep(pile *p, mps_particles *set) {
  mps_view x, stress, strain;
  mps_status status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(set, "stress", &stress);
  if (status == MPS_OK) status = mps_particles_view(set, "plastic_strain", &strain);
  if (status != MPS_OK) return status;
  float *value = malloc((size_t)x.shape[0] * FIELDS * sizeof *value);
  int64_t *rows = mpm_rows_by_id(set);
  if (!value || !rows) {
    free(value);
    free(rows);
    return MPS_ERROR_MEMORY;
  }
  p->frame[p->frames_kept++] = (pile_frame){push_depth(&p->push), value};
  for (int64_t i = 0; i < x.shape[0]; i++, value += FIELDS) {
    const int64_t k = rows[i];
    double s[4];
    for (int c = 0; c < 4; c++) s[c] = *mps_view_f64(&stress, k, c);
    const double mean = (s[0] + s[1] + s[2]) / 3.0;
    double j2 = s[3] * s[3];
    for (int c = 0; c < 3; c++) j2 += 0.5 * (s[c] - mean) * (s[c] - mean);
    value[FIELD_R] = (float)*mps_view_f64(&x, k, 0);
    value[FIELD_Z] = (float)(*mps_view_f64(&x, k, 1) - p->s.height);
    value[FIELD_MEAN] = (float)mean;
    value[FIELD_DEVIATOR] = (float)sqrt(3.0 * j2);
    value[FIELD_STRAIN] = (float)*mps_view_f64(&strain, k, 0);
  }
  free(rows);
  return MPS_OK;
}

mps_status pile_take_frame(pile *p) {
  mps_particles *whole;
  mps_status status = mpm_model_whole(&p->m, &whole);
  if (status == MPS_OK && whole && pile_pictures(p, p->frames + 1) > p->frames_kept)
    status = keep(p, whole);
  p->frames++;
  status = mpm_model_tell(&p->m, status, 0, NULL);
  return status == MPS_OK ? mpm_course_frame(&p->course) : status;
}

/* Of a checkpoint: how many there were, and those that are kept. */
void pile_pass_frames(pile *p, resume_bytes *b) {
  const size_t bytes = (size_t)p->particles * FIELDS * sizeof(float);
  int64_t kept = p->frames_kept;
  resume_pass(b, &p->frames, sizeof p->frames);
  resume_pass(b, &kept, sizeof kept);
  if (resume_wrong(b, p->frames < 0 || p->frames > p->s.course.frames ||
                          kept != pile_pictures(p, p->frames)))
    return;
  for (int64_t f = 0; f < kept; f++) {
    if (f >= p->frames_kept && !(p->frame[f].value = malloc(bytes))) {
      b->status = MPS_ERROR_MEMORY;
      return;
    }
    if (f >= p->frames_kept) p->frames_kept++;
    resume_pass(b, &p->frame[f].depth, sizeof p->frame[f].depth);
    resume_pass(b, p->frame[f].value, bytes);
  }
}

bool pile_write_frames(app *a, pile *p) {
  for (int64_t f = 0; f < p->frames_kept; f++) {
    char name[32];
    output file;
    snprintf(name, sizeof name, "fields-%d.csv", (int)f + 1);
    if (!output_open(&file, a, p->s.out, name)) return false;
    output_text(&file, "r_m,z_m,mean_stress_kPa,deviatoric_stress_kPa,plastic_strain\n");
    for (int64_t k = 0; k < p->particles; k++) {
      const float *v = p->frame[f].value + k * FIELDS;
      output_text(&file, "%.5g,%.5g,%.4g,%.4g,%.4g\n", (double)v[FIELD_R], (double)v[FIELD_Z],
                  1e-3 * (double)v[FIELD_MEAN], 1e-3 * (double)v[FIELD_DEVIATOR],
                  (double)v[FIELD_STRAIN]);
    }
    if (!output_close(&file)) return false;
  }
  return true;
}

void pile_free_frames(pile *p) {
  for (int64_t f = 0; f < p->frames_kept; f++) free(p->frame[f].value);
  p->frames_kept = 0;
}
