/* pictures.c - pile.png: load and plug along the path (Nakamura, Figure 23) and the soil at the
 * end; and the soil around the pile at some depths, one picture a quantity (Figures 24 and 25).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pile.h"

#include "common/area.h"
#include "common/plot.h"

#include <math.h>
#include <stdlib.h>

/* Upper bound of all but a few of the soil's particles: the colour scale ignores single particles
 * under a corner. */
static double most_of(const pile *p, const pile_frame *frame, int field, double share) {
  double *value = malloc((size_t)(p->particles + 1) * sizeof *value);
  for (int64_t k = 0; value && k < p->particles; k++)
    value[k] = (double)fabsf(frame->value[k * FIELDS + field]);
  const double most = value ? push_most(p->particles, value, share) : NAN;
  free(value);
  return most;
}

/* ---- soil ------------------------------------------------------------------------------------ */

typedef struct quantity {
  const char *name, *title;
  int field;
  double factor; /* of fields-N.csv over the frame's value: Pa to kPa, pressure positive */
  double share;  /* of the particles that the colours reach */
} quantity;

static const quantity mean_stress = {"mean_stress", "Mean pressure (kPa)", FIELD_MEAN, -1e-3,
                                     0.995};
static const quantity deviatoric_stress = {"deviatoric_stress", "Deviatoric stress (kPa)",
                                           FIELD_DEVIATOR, 1e-3, 0.995};
static const quantity shear_strain = {"shear_strain", "Plastic shear strain (-)", FIELD_STRAIN, 1.0,
                                      0.97};

/* The part of the section that is shown, m. */
static double section_top(const pile *p) { return 0.08 * p->s.depth + 4.0 * p->s.h; }
static double section_bottom(const pile *p) {
  return -fmin(p->s.height, p->s.depth + 3.0 * p->s.inner_diameter);
}

/* Picture of a quantity: NAME.bin has the soil of all frames. */
typedef struct section {
  const quantity *q;
  char file[40];
  area *image; /* of each frame */
  area_def def;
} section;

typedef struct wall {
  double inner, outer, tip; /* m */
} wall;

static bool in_wall(const void *user, double r, double z) {
  const wall *w = user;
  return r > w->inner && r < w->outer && z > w->tip;
}

static bool image_sections(app *a, const pile *p, const quantity *q, section *x) {
  output f;
  *x = (section){.q = q, .image = calloc((size_t)p->frames_kept + 1, sizeof *x->image)};
  snprintf(x->file, sizeof x->file, "%s.bin", q->name);
  double *row = malloc((size_t)p->particles * 3 * sizeof *row);
  if (!row || !x->image) {
    free(row);
    return app_no_memory(a);
  }
  const bool good = output_open(&f, a, p->s.out, x->file);
  for (int64_t n = 0; good && n < p->frames_kept; n++) {
    for (int64_t k = 0; k < p->particles; k++) {
      const float *value = p->frame[n].value + k * FIELDS;
      row[3 * k] = (double)value[FIELD_R];
      row[3 * k + 1] = (double)value[FIELD_Z];
      row[3 * k + 2] = (double)value[q->field];
    }
    const wall pipe = {p->inner, p->outer, -p->frame[n].depth};
    x->def = (area_def){.spacing = mps_particles_spacing(p->m.particles),
                        .slit = AREA_SLIT_SHEARED,
                        .lower = {0.0, section_bottom(p)},
                        .upper = {p->s.width, section_top(p)},
                        .walled = true,
                        .side = AREA_SIDE,
                        .factor = q->factor,
                        .solid = in_wall,
                        .user = &pipe};
    area_write(&f, &x->def, p->particles, row, &x->image[n]);
  }
  free(row);
  return good && output_close(&f);
}

/* Variables of maps.gp: half sections with the wall, r to the right. */
static void set_section(output *f, const pile *p, const section *x) {
  const quantity *q = x->q;
  const pile_frame *last = &p->frame[p->frames_kept - 1];
  area_set(f, x->file, &x->def, p->frames_kept, x->image, 1.0);
  output_text(f, "array tip[maps]\n");
  for (int k = 0; k < p->frames_kept; k++)
    output_text(f, "tip[%d] = %.9g; titles[%d] = 'tip at %.3f m'\n", k + 1, -p->frame[k].depth,
                k + 1, p->frame[k].depth);
  output_text(
      f,
      "x_name = 'r (m)'; y_name = 'z (m)'; heading = cb_name = '%s'\n"
      "palette = 'blues'; cb_least = 0; cb_most = %.9g\n"
      "cover(k) = sprintf(\"set object 1 rectangle from %.9g,%%g to %.9g,%.9g fillcolor rgb "
      "'#555555' fillstyle solid noborder front\", tip[k + 1])\n",
      q->title, fabs(q->factor) * most_of(p, last, q->field, q->share), p->inner, p->outer,
      section_top(p));
}

static bool draw_sections(app *a, const pile *p, const section *x) {
  output f;
  if (!plot_begin(&f, a, p->s.out, x->q->name)) return false;
  set_section(&f, p, x);
  return plot_end(&f, p->s.out, x->q->name, "maps");
}

/* ---- all in one ------------------------------------------------------------------------------ */

static bool draw_overview(app *a, const pile *p, const section *stress, const section *strain) {
  output f;
  if (!plot_begin(&f, a, p->s.out, "pile")) return false;
  output_text(
      &f,
      "depth = %.9g\nfirst = 'Open-ended pile, inner diameter %g m, wall %g mm, to %g m at %g "
      "m/s'\nsecond = 'h = %g mm, %lld particles, {/Symbol f} = %g degrees (%s cone), "
      "{/Symbol m} = %g'\n",
      p->s.depth, p->s.inner_diameter, 1e3 * p->s.wall, p->s.depth, p->s.rate, 1e3 * p->s.h,
      (long long)p->particles, p->s.phi, pile_cone_name(&p->s), p->s.friction);
  set_section(&f, p, stress);
  output_text(&f, "stress = image; stress_lowest = cb_lowest; stress_highest = cb_highest; "
                  "stress_most = cb_most\n");
  set_section(&f, p, strain);
  return plot_end(&f, p->s.out, "pile", "pile/pile");
}

bool pile_draw(app *a, const pile *p) {
  if (p->frames_kept == 0 || p->push.rows == 0) return true;
  static const quantity *const all[3] = {&mean_stress, &deviatoric_stress, &shear_strain};
  section x[3] = {{.q = NULL}};
  bool good = true;
  for (int k = 0; k < 3; k++) good = good && image_sections(a, p, all[k], &x[k]);
  good = good && draw_overview(a, p, &x[0], &x[2]);
  for (int k = 0; k < 3; k++) good = good && draw_sections(a, p, &x[k]);
  for (int k = 0; k < 3; k++) free(x[k].image);
  return good;
}
