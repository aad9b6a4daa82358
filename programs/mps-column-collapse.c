/* mps-column-collapse - a column of sand or clay collapses on a bed: Nakamura, Figure 3, against
 * the run-out that Lube, Huppert, Sparks and Freundt measured.
 *
 * The column stands on the bed y = 0, L0 wide from the wall x = 0 (a line of symmetry), a L0 high,
 * and is released at once. Drucker-Prager in plane strain; or a cylinder of radius L0.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/compare.h"
#include "common/mpm_course.h"
#include "common/mpm_heap.h"
#include "common/mpm_method.h"
#include "common/mpm_model.h"
#include "common/plot.h"
#include "common/sand.h"

#include <math.h>
#include <stdio.h>

#define PI 3.14159265358979323846
#define G 9.81 /* m/s2 */

enum { CASES_MAX = 6, SAMPLES = 400, FRAMES = 4 };

typedef struct settings {
  double courant;
  double aspect, width, h, phi, psi, cohesion, bed_friction, young, poisson, density, falls;
  double flip_time; /* s */
  sand_voids voids;
  int64_t ppc, threads;
  int cone;
  int spline, volumetric; /* degree of the weights less 2; mps_mpm_volumetric */
  mpm_method method;
  bool paper;
  bool sweep, compare, axisymmetric;
  mpm_course_options course;
  const char *out;
} settings;

/* One column and its results. */
typedef struct column_case {
  const char *name;
  double aspect, phi, cohesion; /* -, degrees, Pa */
  int rows;
  double t[SAMPLES + 1], front[SAMPLES + 1], height[SAMPLES + 1], kinetic[SAMPLES + 1];
  double peak;         /* J/m: largest kinetic energy so far */
  int shots;           /* taken so far, but for the last one */
  double time_at_rest; /* s; NaN: it still moved at the end */
  double reach, end;   /* m, at the end */
  double volume_ratio, detached, mass, mass_start;
  mpm_snapshot shot[FRAMES];
} column_case;

typedef struct simulation {
  settings s;
  mpm_model m;
  mps_context *context;
  int count; /* of the columns requested; in the results, of those that were begun */
  int now;   /* the one that collapses */
  column_case column[CASES_MAX];
  mpm_course course;
} simulation;

/* ---- Lube et al. -------------------------------------------------------------------------------
 * G. Lube, H. E. Huppert, R. S. J. Sparks, A. Freundt, "Collapses of two-dimensional granular
 * columns", Phys. Rev. E 72 (2005) 041301: in a channel, for several sands, rice, sugar, whatever
 * the bed: (L - L0)/L0 = 1.2 a for a < 1.8 and 1.9 a^(2/3) for a > 2.8; between them here a
 * straight line. Height H/L0 = a where the top stays, a^(2/5) above; ours is the mean over 0.1 L0,
 * at least 2 h, at the wall. Glass beads run further, 1.8 a for a < 3 and 2.3 a^(2/3) above (E.
 * Lajeunesse, J. B. Monnier, G. M. Homsy, Phys. Fluids 17 (2005) 103302): only drawn.
 *
 * Cylinders: G. Lube, H. E. Huppert, R. S. J. Sparks, M. A. Hallworth, "Axisymmetric collapses of
 * granular columns", J. Fluid Mech. 508 (2004) 175-199: 1.24 a for a < 1.7 and 1.6 sqrt(a) above;
 * the height is a where the top stays, 0.88 a^(1/6) above. */

static double law_runout(const settings *s, double a) {
  if (s->axisymmetric) return a < 1.7 ? 1.24 * a : 1.6 * sqrt(a);
  const double low = 1.2 * 1.8, high = 1.9 * pow(2.8, 2.0 / 3.0);
  if (a <= 1.8) return 1.2 * a;
  return a < 2.8 ? low + (high - low) * (a - 1.8) : 1.9 * pow(a, 2.0 / 3.0);
}

static double law_height(const settings *s, double a) {
  if (s->axisymmetric) return fmin(a, 0.88 * pow(a, 1.0 / 6.0));
  return a <= 1.0 ? a : pow(a, 0.4);
}

/* It rests, or has had its time. One that Ctrl-C has stopped has no run-out yet. */
static bool has_ended(const column_case *c) {
  return !isnan(c->time_at_rest) || c->rows == SAMPLES + 1;
}

/* Where the heap is two hundredths of L0 thick. Farther out it is a layer of single particles,
 * whose end jumps by 7 % with the time step, as a gap opens in it or not. */
#define THICKNESS 0.02
#define WINDOW 0.05 /* L0: width of the mean thickness */
static double runout(const settings *s, const column_case *c) {
  return has_ended(c) ? c->front[c->rows - 1] / s->width - 1.0 : NAN;
}

/* Of the last particle before a gap. */
static double runout_end(const settings *s, const column_case *c) {
  return has_ended(c) ? c->end / s->width - 1.0 : NAN;
}

/* Of all but the foremost 2 % of the particles. */
static double runout_98(const settings *s, const column_case *c) {
  return has_ended(c) ? c->reach / s->width - 1.0 : NAN;
}

static double final_height(const settings *s, const column_case *c) {
  return has_ended(c) ? c->height[c->rows - 1] / s->width : NAN;
}

/* ---- building -------------------------------------------------------------------------------- */

/* At rest under its own weight, without lateral strain. */
static mps_status fill(mps_context *context, const settings *s, const column_case *c,
                       mpm_model *m) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {s->width, c->aspect * s->width};
  mps_particles_def set = mps_particles_defaults();
  set.spacing = s->h / sqrt((double)s->ppc);
  mps_status status = mpm_model_particles(m, context, &set);
  if (status == MPS_OK) status = mps_particles_fill_box(m->particles, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(m->particles, "density", 0, s->density);
  if (status == MPS_OK) status = mps_particles_set(m->particles, "stress", 0, 0.0);
  mps_view x;
  mps_edit stress;
  if (status == MPS_OK) status = mps_particles_view(m->particles, "position", &x);
  if (status == MPS_OK) status = mps_particles_edit(m->particles, "stress", &stress);
  const double k0 = s->poisson / (1.0 - s->poisson);
  for (int64_t k = 0; status == MPS_OK && k < x.shape[0]; k++) {
    const double vertical = -s->density * G * (hi[1] - *mps_view_f64(&x, k, 1));
    *mps_edit_f64(&stress, k, 0) = *mps_edit_f64(&stress, k, 2) = k0 * vertical;
    *mps_edit_f64(&stress, k, 1) = vertical;
  }
  if (status == MPS_OK) status = mps_particles_commit(m->particles, &stress);
  return status;
}

static mps_status build_case(simulation *sim, const column_case *c) {
  const settings *s = &sim->s;
  mpm_model *m = &sim->m;
  mps_material_drucker_prager_def law = mps_material_drucker_prager_defaults();
  law.cone = s->cone;
  law.young = s->young, law.poisson = s->poisson;
  law.friction = c->phi * PI / 180.0;
  law.dilation = fmin(s->psi, c->phi) * PI / 180.0;
  law.cohesion = c->cohesion;
  law.void_ratio = s->voids.e0, law.max_void_ratio = s->voids.e_max;
  mps_mpm_def def = mps_mpm_defaults();
  if (s->axisymmetric) def.geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC;
  def.cell = s->h;
  def.courant = s->courant;
  def.spline = s->spline + 2;
  def.lower[0] = def.lower[1] = 0.0;
  if (!isnan(s->bed_friction)) def.lower[1] = -4.0 * s->h; /* room below the rigid bed */
  def.gravity[1] = -G;
  def.flip_time = s->flip_time;
  def.volumetric = s->volumetric;
  mpm_method_define(&s->method, &def);
  mps_status status = fill(sim->context, s, c, m);
  if (status == MPS_OK)
    status = mps_material_create_drucker_prager(sim->context, &law, &m->material);
  const double up[2] = {0.0, 1.0};
  if (status == MPS_OK && !isnan(s->bed_friction))
    status = mps_body_create_half_plane(sim->context, NULL, up, &m->body[0]);
  status = mpm_model_create(m, sim->context, status, &def);
  status = mpm_method_choose(&s->method, m->mpm, status);
  if (status != MPS_OK) return status;
  if (isnan(s->bed_friction))
    return mps_mpm_set_side(m->mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  mps_contact_def bed = mps_contact_defaults();
  bed.friction = s->bed_friction;
  return mps_mpm_add_contact(m->mpm, m->body[0], &bed, NULL);
}

/* Falls from its height to the end of a run. */
static double case_end(const settings *s, const column_case *c) {
  return s->falls * sqrt(c->aspect * s->width / G);
}

static void pass_case(resume_bytes *b, column_case *c) {
  resume_pass(b, &c->rows, sizeof c->rows);
  resume_pass(b, &c->shots, sizeof c->shots);
  if (resume_wrong(b, c->rows < 0 || c->rows > SAMPLES + 1 || c->shots < 0 || c->shots >= FRAMES)) {
    c->rows = c->shots = 0;
    return;
  }
  const size_t bytes = (size_t)c->rows * sizeof *c->t;
  resume_pass(b, c->t, bytes);
  resume_pass(b, c->front, bytes);
  resume_pass(b, c->height, bytes);
  resume_pass(b, c->kinetic, bytes);
  double *const values[] = {&c->peak,     &c->time_at_rest, &c->reach,      &c->volume_ratio,
                            &c->detached, &c->mass,         &c->mass_start, &c->end};
  for (size_t k = 0; k < sizeof values / sizeof *values; k++)
    resume_pass(b, values[k], sizeof *values[k]);
  for (int k = 0; k < FRAMES; k++) resume_pass_snapshot(b, &c->shot[k]);
}

/* History of the run for a restart. */
static void pass(void *user, resume_bytes *b) {
  simulation *sim = user;
  int64_t samples = sim->m.samples;
  resume_pass(b, &sim->now, sizeof sim->now);
  resume_pass(b, &samples, sizeof samples);
  if (resume_wrong(b, sim->now < 0 || sim->now >= sim->count || samples < 0)) {
    sim->now = 0;
    return;
  }
  sim->m.samples = samples;
  for (int k = 0; k <= sim->now; k++) pass_case(b, &sim->column[k]);
}

static void name_course(simulation *sim) {
  static char what[40];
  const column_case *c = &sim->column[sim->now];
  if (sim->count > 1)
    snprintf(what, sizeof what, "column_%s", c->name);
  else
    snprintf(what, sizeof what, "column");
  const bool lost = sim->course.saves.lost; /* warned once for all columns */
  sim->course =
      mpm_course_of(&sim->s.course, &sim->m, sim->s.out, "mps-column-collapse 3", pass, sim);
  sim->course.what = what;
  sim->course.duration = case_end(&sim->s, c);
  sim->course.saves.lost = lost;
}

static mps_status build(mps_context *context, void *user) {
  simulation *sim = user;
  sim->context = context;
  name_course(sim);
  mps_status status = mpm_course_peek(&sim->course, context);
  if (status == MPS_OK) status = mpm_course_load(&sim->course, context); /* which column it is */
  name_course(sim);
  if (status == MPS_OK) status = build_case(sim, &sim->column[sim->now]);
  return status == MPS_OK ? mpm_course_begin(&sim->course, context, true) : status;
}

/* ---- running --------------------------------------------------------------------------------- */

#define AT_REST 1e-3 /* of the largest kinetic energy */

static mps_status sample(simulation *sim, column_case *c) {
  mpm_heap heap;
  const int k = c->rows;
  const settings *s = &sim->s;
  const mpm_heap_def def = {G,
                            fmax((s->axisymmetric ? 0.2 : 0.1) * s->width, 2.0 * s->h),
                            s->axisymmetric,
                            s->density,
                            THICKNESS * s->width,
                            WINDOW * s->width};
  const mps_status status = mpm_heap_measure(&sim->m, &def, &heap);
  if (status != MPS_OK) return status;
  c->t[k] = mps_mpm_time(sim->m.mpm);
  c->front[k] = heap.edge;
  c->height[k] = heap.height;
  c->kinetic[k] = heap.kinetic;
  c->volume_ratio = fmax(c->volume_ratio, heap.volume_ratio);
  c->reach = heap.reach;
  c->end = heap.front;
  c->detached = heap.detached;
  c->mass = heap.mass;
  if (k == 0) c->mass_start = s->density * c->aspect * s->width * s->width;
  if (k == 0 && s->axisymmetric) c->mass_start *= PI * s->width;
  c->peak = fmax(c->peak, heap.kinetic);
  c->rows++;
  sim->m.samples++;
  return MPS_OK;
}

/* Until it rests, or for so many falls from its height. */
static mps_status march_case(simulation *sim, column_case *c) {
  const double fall = sqrt(c->aspect * sim->s.width / G), end = case_end(&sim->s, c);
  static const double frames[FRAMES - 1] = {0.0, 1.0, 2.0}; /* falls; and at rest */
  mps_status status = MPS_OK;
  c->time_at_rest = NAN;
  for (int k = c->rows; k <= SAMPLES && status == MPS_OK; k++) {
    if (k > 0) status = mpm_model_advance(&sim->m, end * k / SAMPLES, INT64_MAX, NULL, NULL);
    if (status == MPS_OK) status = sample(sim, c);
    if (status == MPS_OK && c->shots < FRAMES - 1 && c->t[k] >= frames[c->shots] * fall - 1e-12) {
      status = mpm_snapshot_take(&sim->m, c->t[k], "plastic_strain", &c->shot[c->shots]);
      c->shots++;
    }
    const bool rests = status == MPS_OK && k > 0 && c->kinetic[k] <= AT_REST * c->peak;
    if (status == MPS_OK) status = mpm_course_sample(&sim->course, rests ? SAMPLES : k, SAMPLES);
    if (!rests) continue;
    c->time_at_rest = c->t[k];
    break;
  }
  /* the last one is also that of an interrupted run */
  const mps_status taken = c->rows > 0 ? mpm_snapshot_take(&sim->m, c->t[c->rows - 1],
                                                           "plastic_strain", &c->shot[FRAMES - 1])
                                       : MPS_OK;
  return status == MPS_OK ? taken : status;
}

static mps_status march(void *user) {
  simulation *sim = user;
  mps_status status = MPS_OK;
  for (;;) {
    const column_case *c = &sim->column[sim->now];
    progress_part(&sim->m.a->bar, (double)sim->now / sim->count, 1.0 / sim->count, 0.0,
                  case_end(&sim->s, c));
    status = mpm_course_end(&sim->course, march_case(sim, &sim->column[sim->now]));
    if (status != MPS_OK || sim->now + 1 == sim->count) return status;
    mpm_model_destroy(&sim->m);
    sim->now++;
    name_course(sim);
    status = build_case(sim, &sim->column[sim->now]);
    if (status == MPS_OK) status = mpm_course_begin(&sim->course, sim->context, false);
    if (status != MPS_OK) return status;
  }
}

/* ---- results --------------------------------------------------------------------------------- */

#define COHESIVE 0.01                             /* of rho g H0: above, the ground is no sand */
enum { LOOSEST = 25, DENSEST = 42, DILATES = 5 }; /* degrees: friction of the sands, dilation */

/* The law is of dry sands at rest, on beds to which they stick. */
static comparison compare_law(const settings *s, const column_case *c, double value, double law) {
  const double slide = tan(c->phi * PI / 180.0), weight = s->density * G * c->aspect * s->width;
  comparison out = compare_with("Lube's law", value, law);
  compare_require(&out, c->cohesion <= COHESIVE * weight,
                  "it is of sand, and this ground has a cohesion of %.2g times its weight",
                  c->cohesion / weight);
  compare_require(&out, c->phi >= LOOSEST && c->phi <= DENSEST,
                  "it is of sands, of some %d to %d degrees, and --phi is %g", LOOSEST, DENSEST,
                  c->phi);
  /* sin(phi) = 3 alpha in plane strain without dilation: 35 degrees are 55 */
  compare_require(&out, s->axisymmetric || s->cone != MPS_MATERIAL_CONE_CIRCUMSCRIBED,
                  "--cone circumscribed has a larger angle of friction in plane strain than the "
                  "--phi of %g degrees",
                  c->phi);
  compare_require(&out, fmin(s->psi, c->phi) <= DILATES,
                  "--psi is %g degrees: ground that dilates without end is no sand that flows",
                  s->psi);
  compare_require(&out, isnan(s->bed_friction) || s->bed_friction >= slide * (1.0 - 1e-9),
                  "sand slides on the bed, whose friction is less than its own");
  compare_require(&out, has_ended(c), "the run has not come to its end");
  compare_require(&out, !isnan(c->time_at_rest),
                  "it is of sand at rest, and this still moves at the end: take a larger --falls");
  return out;
}

static comparison compare_runout(const settings *s, const column_case *c) {
  return compare_law(s, c, runout(s, c), law_runout(s, c->aspect));
}

static comparison compare_height(const settings *s, const column_case *c) {
  return compare_law(s, c, final_height(s, c), law_height(s, c->aspect));
}

static bool write_cases(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  output f;
  if (!csv_open(&f, a, s->out, "cases.csv",
                "case,aspect,phi_deg,cohesion_Pa,runout?,runout_law?,height?,height_law?,"
                "time_at_rest_s?,volume_ratio_max,runout_98?,runout_end?"))
    return false;
  for (int k = 0; k < sim->count; k++) {
    const column_case *c = &sim->column[k];
    const comparison far = compare_runout(s, c), high = compare_height(s, c);
    const double row[] = {c->aspect,
                          c->phi,
                          c->cohesion,
                          runout(s, c),
                          compare_reference(&far),
                          final_height(s, c),
                          compare_reference(&high),
                          c->time_at_rest,
                          c->volume_ratio,
                          runout_98(s, c),
                          runout_end(s, c)};
    csv_named_row(&f, c->name, 11, row);
  }
  return output_close(&f);
}

static bool write_case(app *a, const settings *s, const column_case *c) {
  output f;
  char name[64];
  snprintf(name, sizeof name, "front_%s.csv", c->name);
  if (!csv_open(&f, a, s->out, name, "t_s,runout,height,kinetic_J_m")) return false;
  for (int k = 0; k < c->rows; k++) {
    CSV_LINE(&f, c->t[k], c->front[k] / s->width - 1.0, c->height[k] / s->width, c->kinetic[k]);
  }
  snprintf(name, sizeof name, "particles_%s.csv", c->name);
  return output_close(&f) &&
         mpm_snapshots_write(a, s->out, name, "plastic_strain", FRAMES, c->shot);
}

/* The start, one and two falls later, at rest, of each column; lengths in L0. */
static bool draw_columns(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  double width = 1.0, height = 0.0;
  for (int k = 0; k < sim->count; k++) {
    const column_case *c = &sim->column[k];
    width = fmax(width, 1.05 * c->front[c->rows - 1] / s->width);
    height = fmax(height, 1.1 * c->aspect);
  }
  const area_def def = {.spacing = s->h / sqrt((double)s->ppc),
                        .slit = AREA_SLIT_SHEARED,
                        .upper = {width * s->width, height * s->width},
                        .walled = true,
                        .side = 800};
  area image[CASES_MAX * FRAMES];
  const int count = sim->count * FRAMES;
  output f;
  if (!output_open(&f, a, s->out, "columns.bin")) return false;
  for (int k = 0; k < count; k++)
    area_write(&f, &def, sim->column[k / FRAMES].shot[k % FRAMES].count,
               sim->column[k / FRAMES].shot[k % FRAMES].row, &image[k]);
  if (!output_close(&f) || !plot_begin(&f, a, s->out, "columns")) return false;
  area_set(&f, "columns.bin", &def, count, image, s->width);
  for (int k = 0; k < count; k++) {
    const column_case *c = &sim->column[k / FRAMES];
    if (c->shot[k % FRAMES].count > 0) /* none: the run ended before */
      output_text(&f, "titles[%d] = '%s%st = %.2f s'\n", k + 1, sim->count > 1 ? c->name : "",
                  sim->count > 1 ? ", " : "", c->shot[k % FRAMES].time);
  }
  output_text(&f, "x_name = 'x/L_0'; y_name = 'y/L_0'; cb_name = 'plastic strain (-)'\n"
                  "palette = 'sand'; cb_least = 0; cb_most = cb_highest < 2 ? cb_highest : 2\n");
  return plot_end(&f, s->out, "columns", "maps");
}

static bool draw_law(app *a, const simulation *sim) {
  const settings *s = &sim->s;
  return plot_draw(a, s->out, "runout", "column-collapse/runout",
                   "second = '{/Symbol f} = %g°, h = L_0/%.3g'\nring = %d", s->phi, s->width / s->h,
                   s->axisymmetric);
}

/* Keys of the column requested; of a sweep, the last one and the worst misfit of all. */
static void summarise(output *f, const simulation *sim) {
  const settings *s = &sim->s;
  const column_case *c = &sim->column[sim->count - 1];
  double worst = NAN;
  for (int k = 0; k < sim->count; k++) {
    const comparison each = compare_runout(s, &sim->column[k]);
    const double d = compare_error(&each);
    if (isnan(worst) || fabs(d) > fabs(worst)) worst = d;
  }
  const comparison far = compare_runout(s, c), high = compare_height(s, c);
  json_integer(f, "columns", sim->count);
  JSON_NUMBERS(f, {"cell", s->h}, {"aspect", c->aspect}, {"phi", c->phi}, {"cohesion", c->cohesion},
               {"runout", runout(s, c)});
  json_comparison(f, "runout_law", &far);
  JSON_NUMBERS(f, {"runout_error", compare_error(&far)}, {"runout_error_worst", worst},
               {"runout_98", runout_98(s, c)}, {"runout_end", runout_end(s, c)},
               {"flip_time", s->flip_time});
  sand_write(f, &s->voids, s->psi);
  json_number(f, "height", final_height(s, c));
  json_comparison(f, "height_law", &high);
  JSON_NUMBERS(f, {"time_at_rest", c->time_at_rest}, {"volume_ratio_max", c->volume_ratio},
               {"detached", c->detached}, {"mass_error", c->mass / c->mass_start - 1.0});
}

static bool finish(app *a, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  output f;
  while (sim->count > 1 && sim->column[sim->count - 1].rows < MPM_MODEL_SAMPLES) sim->count--;
  if (!write_cases(a, sim)) return false;
  for (int k = 0; k < sim->count; k++)
    if (!write_case(a, s, &sim->column[k])) return false;
  if (!mpm_model_summary(a, &sim->m, s->out, &f)) return false;
  summarise(&f, sim);
  json_end(&f);
  if (!output_close(&f)) return false;
  if (!(s->sweep ? draw_law(a, sim) : draw_columns(a, sim))) return false;
  app_tell_results(a, s->out);
  for (int k = 0; k < sim->count; k++) {
    const column_case *c = &sim->column[k];
    if (!has_ended(c)) {
      printf("%-12s a = %-4g stopped at %.3g s, before its end\n", c->name, c->aspect,
             c->t[c->rows - 1]);
      continue;
    }
    const comparison far = compare_runout(s, c), high = compare_height(s, c);
    printf("%-12s a = %-4g run-out %.3f", c->name, c->aspect, runout(s, c));
    if (compare_holds(&far)) printf(" (law %.3f)", far.reference);
    printf("  height %.3f", final_height(s, c));
    if (compare_holds(&high)) printf(" (law %.3f)", high.reference);
    printf("  %s %.3g s\n", isnan(c->time_at_rest) ? "still moves at" : "at rest after",
           c->t[c->rows - 1]);
    compare_tell(&far);
  }
  sand_print(&s->voids, s->psi);
  return true;
}

/* ---- options --------------------------------------------------------------------------------- */

/* Which columns there are, and lengths that must be whole cells. Returns -1 or a code. */
static int complete(const options_program *program, simulation *sim) {
  settings *s = &sim->s;
  static const double aspects[] = {0.5, 1.0, 2.0, 3.0, 4.0, 6.0};
  static const char *const names[] = {"a0.5", "a1", "a2", "a3", "a4", "a6"};
  if (isnan(s->h)) s->h = s->width / 20.0;
  if (s->sweep && s->compare)
    return options_refuse(program, "--sweep and --compare exclude each other");
  if (s->sweep && options_given(program->table, "aspect"))
    return options_refuse(program, "--sweep and --aspect exclude each other");
  if (s->phi == 0.0 && s->cohesion == 0.0)
    return options_refuse(program, "--phi and --cohesion must not both be 0");
  options_whole("width", &s->width, "--cell", s->h);
  if (s->width < 3.5 * s->h)
    return options_refuse(program, "--cell must be at most a quarter of --width");
  const double weight = s->density * G * s->aspect * s->width;
  const char *large = mpm_model_too_large(s->aspect * pow(s->width / s->h, 2.0) * (double)s->ppc);
  if (large) return options_refuse(program, large);
  if (weight > 0.1 * s->young)
    return options_refuse(program, "--young must be at least 10 times the stress below the column, "
                                   "density g aspect width");
  sim->count = s->sweep ? 6 : s->compare ? 3 : 1;
  for (int k = 0; k < sim->count; k++)
    sim->column[k] = (column_case){.name = "column",
                                   .aspect = s->sweep ? aspects[k] : s->aspect,
                                   .phi = s->phi,
                                   .cohesion = s->cohesion};
  for (int k = 0; k < sim->count && s->sweep; k++) sim->column[k].name = names[k];
  if (s->compare) { /* the strength of clay as a share of the weight of the column */
    sim->column[0].name = "sand";
    sim->column[1].name = "loam";
    sim->column[1].phi = 0.5 * s->phi, sim->column[1].cohesion = 0.05 * weight;
    sim->column[2].name = "clay";
    sim->column[2].phi = 0.0, sim->column[2].cohesion = 0.15 * weight;
  }
  return -1;
}

int main(int argc, char **argv) {
  static simulation sim;
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Column"),
      OPTION_FLAG("paper", &s->paper, NULL),
      OPTION_NUMBER("aspect", &s->aspect, NULL, 2.0),
      OPTION_NUMBER("width", &s->width, "L0 from the wall, or radius of the cylinder", 0.1),
      OPTION_FLAG("axisymmetric", &s->axisymmetric, "a cylinder"),
      OPTION_FLAG("sweep", &s->sweep, NULL),
      OPTION_FLAG("compare", &s->compare, NULL),
      OPTION_HEADING("Soil (Drucker-Prager)"),
      OPTION_NUMBER("phi", &s->phi, NULL, 35.0),
      OPTION_NUMBER("psi", &s->psi, "at most phi: more counts as phi"),
      SAND_OPTIONS(&s->voids),
      OPTION_NUMBER("cohesion", &s->cohesion, NULL),
      OPTION_CHOICE("cone", &s->cone, NULL),
      OPTION_NUMBER("young", &s->young, NULL, 1e6),
      OPTION_NUMBER("poisson", &s->poisson, NULL, 0.3),
      OPTION_NUMBER("density", &s->density, "in bulk", 1600.0),
      OPTION_HEADING("Bed"),
      OPTION_NUMBER("friction", &s->bed_friction, "of the bed (default: soil sticks to it)", NAN),
      OPTION_HEADING("Grid"),
      MPM_MODEL_GRID(s, NAN, 9, 0.5, "default width/20"),
      OPTION_CHOICE("volumetric", &s->volumetric, NULL),
      MPM_METHOD_OPTIONS(&s->method),
      OPTION_NUMBER("flip-time", &s->flip_time,
                    "which takes energy out of the flow; default: by the cell and the wave speed",
                    NAN),
      OPTION_HEADING("Run"),
      OPTION_NUMBER("falls", &s->falls, "if the column does not come to rest before", 8.0),
      MPM_COURSE_OPTIONS(&s->course, SAMPLES),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {
      "mps-column-collapse",
      "A column of sand or clay collapses on a bed (WLS-MPM, Drucker-Prager): Nakamura, Figure 3,\n"
      "against the run-out measured by Lube, Huppert, Sparks and Freundt (2005).",
      table};
  int code = options_parse(&program, argc, argv);
  static const option_preset paper[] = {{"volumetric", "point"}, {0}};
  if (code < 0) code = mpm_method_settle(&program, &s->method, s->paper, paper, s->flip_time);
  if (code < 0) code = complete(&program, &sim);
  if (code >= 0) return code;
  static const mpm_model_parts parts = {build, march, finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  code = mpm_model_run(&program, s->threads, &places, &sim.m, &parts, &sim);
  for (int k = 0; k < sim.count; k++)
    for (int shot = 0; shot < FRAMES; shot++) mpm_snapshot_free(&sim.column[k].shot[shot]);
  return code;
}
