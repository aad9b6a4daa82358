/* field.c - peak acceleration at every particle of a slope: where the ground amplifies the wave.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "field.h"

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

static bool write_table(app *a, const settings *s, const field *f, mps_particles *whole) {
  output file;
  mps_view x, id, mark = {0};
  if (!app_check(a, mps_particles_view(whole, "reference", &x)) ||
      !app_check(a, mps_particles_view(whole, "id", &id)))
    return false;
  const bool columns = s->sides == SIDES_FREEFIELD;
  if (columns && !app_check(a, mps_particles_view(whole, "free_field", &mark))) return false;
  if (!output_open(&file, a, s->out, "peaks.csv")) return false;
  csv_header(&file, "x_m,y_m,peak_m_s2");
  for (int64_t k = 0; k < f->count; k++) {
    if (columns && *mps_view_i64(&mark, k, 0) != 0) continue;
    const double row[] = {*mps_view_f64(&x, k, 0), *mps_view_f64(&x, k, 1),
                          f->peak[*mps_view_i64(&id, k, 0)]};
    csv_row(&file, 3, row);
  }
  return output_close(&file);
}

bool field_write(app *a, const settings *s, const field *f, mps_particles *whole) {
  output g;
  if (f->count == 0) return true;
  /* that of the section at equal scales, with room for names of axes and title */
  const int high = (int)fmin(fmax(910.0 * 1.05 * s->height / s->width, 200.0), 900.0) + 170;
  if (!write_table(a, s, f, whole) || !plot_open(&g, a, s->out, "peaks", 1200, high)) return false;
  const double half = 0.505 * s->spacing; /* wide enough to leave no seams */
  char input[48] = ", recorded motion";
  if (s->ricker) snprintf(input, sizeof input, " of %.3g m/s^2", s->amplitude);
  output_text(&g,
              "set title \"Peak acceleration in the slope under %s wave%s\"\n"
              "set xlabel 'x (m)'\nset ylabel 'y (m)'\nset cblabel 'peak |a| (m/s^2)'\n"
              "set size ratio -1\nunset key\nset cbrange [0:*]\n"
              "set palette defined (0 '#f7fbff', 0.35 '#9ecae1', 0.6 '#fdd49e', 0.8 '#ef6548', "
              "1 '#7f0000')\n"
              "set style fill solid noborder\n"
              "set xrange [0:%.9g]\nset yrange [0:%.9g]\n"
              "plot 'peaks.csv' every ::1 using 1:2:(%.9g):(%.9g):3 with boxxyerror fillcolor "
              "palette\n",
              settings_wave(s) == 'S' ? "a shear" : "a pressure", input, s->width, 1.05 * s->height,
              half, half);
  return plot_close(&g, s->out, "peaks");
}
