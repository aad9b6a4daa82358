/* field.c - peak acceleration at every particle of a slope: where the ground amplifies the wave.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wave.h"

#include "common/area.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

bool field_create(app *a, const settings *s, mps_particles *particles, int64_t count, field *out) {
  *out = (field){.particles = particles};
  if (!s->sloped) return true;
  out->count = count;
  out->peak = calloc((size_t)out->count, sizeof *out->peak);
  return out->peak ? true : app_no_memory(a);
}

void field_destroy(field *f) {
  free(f->peak);
  f->peak = NULL;
}

mps_status field_record(field *f) {
  mps_view a, id;
  if (f->count == 0) return MPS_OK;
  mps_status status = mps_particles_view(f->particles, "acceleration", &a);
  if (status == MPS_OK) status = mps_particles_view(f->particles, "id", &id);
  for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(f->particles); k++) {
    double *peak = &f->peak[*mps_view_i64(&id, k, 0)];
    *peak = fmax(*peak, hypot(*mps_view_f64(&a, k, 0), *mps_view_f64(&a, k, 1)));
  }
  return status;
}

mps_status field_join(field *f, mps_domain *domain) {
  return domain && f->count > 0 ? mps_domain_max(domain, (int32_t)f->count, f->peak) : MPS_OK;
}

/* peaks.csv and peaks.bin, the picture of it. */
static bool write_table(app *a, const settings *s, const field *f, mps_particles *whole,
                        const area_def *def, area *image) {
  output file;
  mps_view x, id, mark = {0};
  if (!app_check(a, mps_particles_view(whole, "reference", &x)) ||
      !app_check(a, mps_particles_view(whole, "id", &id)))
    return false;
  const bool columns = s->sides == SIDES_FREEFIELD;
  if (columns && !app_check(a, mps_particles_view(whole, "free_field", &mark))) return false;
  double *rows = malloc((size_t)f->count * 3 * sizeof *rows);
  if (!rows) return app_no_memory(a);
  if (!csv_open(&file, a, s->out, "peaks.csv", "x_m,y_m,peak_m_s2")) return free(rows), false;
  int64_t count = 0;
  for (int64_t k = 0; k < f->count; k++) {
    if (columns && *mps_view_i64(&mark, k, 0) != 0) continue;
    double *row = rows + 3 * count++;
    row[0] = *mps_view_f64(&x, k, 0), row[1] = *mps_view_f64(&x, k, 1);
    row[2] = f->peak[*mps_view_i64(&id, k, 0)];
    csv_row(&file, 3, row);
  }
  const bool good =
      output_close(&file) && area_image(a, s->out, "peaks.bin", def, count, rows, image);
  free(rows);
  return good;
}

bool field_write(app *a, const settings *s, const field *f, mps_particles *whole) {
  const area_def def = {.spacing = s->spacing,
                        .slit = AREA_SLIT,
                        .upper = {s->width, 1.05 * s->height},
                        .walled = true,
                        .side = AREA_SIDE};
  area image;
  output g;
  if (f->count == 0) return true;
  if (!write_table(a, s, f, whole, &def, &image) || !plot_begin(&g, a, s->out, "peaks"))
    return false;
  char input[48] = ", recorded motion";
  if (s->ricker) snprintf(input, sizeof input, " of %.3g m/s^2", s->amplitude);
  area_set(&g, "peaks.bin", &def, 1, &image, 1.0);
  output_text(&g,
              "titles[1] = 'Peak acceleration in the slope under %s wave%s'\nx_name = 'x (m)'; "
              "y_name = 'y (m)'; cb_name = 'peak |a| (m/s^2)'\npalette = 'heat'; cb_least = 0; "
              "cb_most = cb_highest\n",
              settings_wave(s) == 'S' ? "a shear" : "a pressure", input);
  return plot_end(&g, s->out, "peaks", "maps");
}
