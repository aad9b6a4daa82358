/* mps-rolling-disc - a disc that slips or rolls down a slope: Nakamura 7.2, Figures 12-14, (51).
 *
 * --body slope: the disc is elastic and the slope a rigid body. --body disc: the disc is a free
 * rigid body on an elastic slope, drawn level with tilted gravity; both act on each other.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/compare.h"
#include "common/mpm_course.h"
#include "common/mpm_method.h"
#include "common/mpm_model.h"
#include "common/plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define PI 3.14159265358979323846
#define G 9.81      /* m/s2 */
#define RADIUS 0.05 /* m */
#define DENSITY 1e3 /* kg/m3 */
#define LENGTH 0.8  /* m, of the elastic slope */
#define DEPTH 0.1   /* m */

#define STIFF                                                                                      \
  2e-3 /* of E: the weight of a disc over its width, rho g R, beside which it is rigid */
#define LEAVES 0.5  /* radii: a disc that has been so far off has not rolled on the slope */
#define FIRST 0.2   /* of the run: from then on the path is long enough to be compared */
#define REGULAR 0.1 /* of the path: differences on the way, above which the end's says little */

enum { BODY_SLOPE, BODY_DISC, FILL_RINGS = 0, FILL_LATTICE, SAMPLES = 100 };

typedef struct settings {
  double courant;
  double h, mu, angle, k, young, poisson, duration;
  int64_t ppc, threads;
  int fill, body, contact; /* contact: mps_contact_method */
  int spline;              /* degree of the weights less 2 */
  mpm_method method;
  bool paper;
  mpm_course_options course;
  const char *out;
} settings;

/* The disc's motion along the slope. */
typedef struct motion {
  double t, x, v, omega; /* s, m, m/s, rad/s (rolling down: > 0) */
  double gap;            /* m, of the centre from where it started, off the slope */
} motion;

typedef struct simulation {
  settings s;
  mpm_model m;
  double along[2]; /* unit vector down the slope */
  double start[2]; /* m, of the disc's centre */
  mpm_course course;
} simulation;

static int rows_of(const simulation *sim) { return (int)sim->course.rows.count; }
static const motion *row_of(const simulation *sim, int k) {
  return (const motion *)sim->course.rows.row + k;
}

/* (51): position along the slope, from its start. */
static double theory(const settings *s, double t) {
  const double a = s->angle * PI / 180.0;
  if (tan(a) > 3.0 * s->mu) return 0.5 * G * t * t * (sin(a) - s->mu * cos(a));
  return G * t * t * sin(a) / 3.0;
}

/* ---- building -------------------------------------------------------------------------------- */

/* Concentric rings, each of particles as far apart as the rings are, and of the ring's area. */
static mps_status fill_rings(simulation *sim, double spacing) {
  const int rings = (int)nearbyint(RADIUS / spacing);
  mps_status status = mps_particles_add_field(sim->m.particles, "volume", 0);
  for (int r = 0; r < rings && status == MPS_OK; r++) {
    const double radius = ((double)r + 0.5) * spacing;
    const int count = (int)nearbyint(2.0 * PI * ((double)r + 0.5));
    const int64_t first = mps_particles_count(sim->m.particles);
    for (int k = 0; k < count && status == MPS_OK; k++) {
      const double a = 2.0 * PI * ((double)k + 0.5 * (r % 2)) / count;
      const double x[] = {sim->start[0] + radius * cos(a), sim->start[1] + radius * sin(a)};
      status = mps_particles_append(sim->m.particles, 1, x);
    }
    mps_edit volume;
    if (status == MPS_OK) status = mps_particles_edit(sim->m.particles, "volume", &volume);
    for (int64_t k = first; status == MPS_OK && k < first + count; k++)
      *mps_edit_f64(&volume, k, 0) = 2.0 * PI * radius * spacing / count;
    if (status == MPS_OK) status = mps_particles_commit(sim->m.particles, &volume);
  }
  return status;
}

static mps_status make_particles(mps_context *context, const settings *s, simulation *sim) {
  mps_particles_def set = mps_particles_defaults();
  set.spacing = s->h / sqrt((double)s->ppc);
  if (s->body == BODY_SLOPE) {
    if (s->fill == FILL_RINGS) set.spacing = RADIUS / fmax(1.0, nearbyint(RADIUS / set.spacing));
    set.origin[0] = sim->start[0], set.origin[1] = sim->start[1];
  }
  mps_status status = mps_particles_create(context, &set, &sim->m.particles);
  if (status != MPS_OK) return status;
  if (s->body == BODY_DISC) {
    const double lo[] = {0.0, 0.0}, hi[] = {LENGTH, DEPTH};
    status = mps_particles_fill_box(sim->m.particles, lo, hi, NULL);
  } else {
    status = s->fill == FILL_RINGS
                 ? fill_rings(sim, set.spacing)
                 : mps_particles_fill_ball(sim->m.particles, sim->start, RADIUS, NULL);
  }
  return status == MPS_OK ? mps_particles_set(sim->m.particles, "density", 0, DENSITY) : status;
}

static mps_status make_rigid(mps_context *context, const settings *s, simulation *sim) {
  mps_body_def def = mps_body_defaults();
  if (s->body == BODY_SLOPE) {
    const double normal[] = {-sim->along[1], sim->along[0]};
    return mps_body_create_half_plane(context, &def, normal, &sim->m.body[0]);
  }
  def.motion = MPS_BODY_MOTION_FREE;
  def.mass = DENSITY * PI * RADIUS * RADIUS;
  def.inertia[2] = 0.5 * def.mass * RADIUS * RADIUS;
  def.position[0] = sim->start[0], def.position[1] = sim->start[1];
  def.gravity[0] = G * sin(s->angle * PI / 180.0);
  def.gravity[1] = -G * cos(s->angle * PI / 180.0);
  return mps_body_create_disc(context, &def, RADIUS, &sim->m.body[0]);
}

static mps_status add_contact(const settings *s, simulation *sim) {
  mps_contact_def contact = mps_contact_defaults();
  contact.friction = s->mu;
  contact.method = s->contact;
  if (s->contact == MPS_CONTACT_METHOD_PENALTY) contact.penalty = s->k;
  return mps_mpm_add_contact(sim->m.mpm, sim->m.body[0], &contact, NULL);
}

static mps_status build(mps_context *context, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  static const rows_column columns[] = {
      {"x", "m", 0}, {"v", "m/s", 0}, {"omega", "rad/s", 0}, {"gap", "m", 0}, {0}};
  sim->course = mpm_course_of(&s->course, &sim->m, s->out, "mps-rolling-disc 3", NULL, NULL);
  sim->course.what = s->body == BODY_SLOPE ? "disc" : "slope";
  sim->course.duration = s->duration;
  sim->course.columns = columns;
  const double a = s->angle * PI / 180.0;
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = s->h;
  def.courant = s->courant;
  def.spline = s->spline + 2;
  mpm_method_define(&s->method, &def);
  if (s->body == BODY_SLOPE) {
    sim->along[0] = cos(a), sim->along[1] = -sin(a);
    sim->start[0] = RADIUS * sin(a), sim->start[1] = RADIUS * cos(a);
    def.gravity[1] = -G;
  } else {
    sim->along[0] = 1.0, sim->along[1] = 0.0;
    sim->start[0] = 0.15, sim->start[1] = DEPTH + RADIUS;
    def.origin[1] = 0.0;
    def.lower[0] = 0.0, def.lower[1] = 0.0;
    def.upper[0] = s->h * ceil(LENGTH / s->h - 1e-9);
  }
  mps_status status = mpm_course_peek(&sim->course, context);
  if (status == MPS_OK) status = make_particles(context, s, sim);
  if (status == MPS_OK)
    status = mps_material_create_linear_elastic(context, s->young, s->poisson, &sim->m.material);
  if (status == MPS_OK) status = make_rigid(context, s, sim);
  status = mpm_model_create(&sim->m, context, status, &def);
  status = mpm_method_choose(&s->method, sim->m.mpm, status);
  if (status == MPS_OK && s->body != BODY_SLOPE)
    status = mps_mpm_set_side(sim->m.mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  if (status == MPS_OK) status = add_contact(s, sim);
  return status == MPS_OK ? mpm_course_begin(&sim->course, context, true) : status;
}

/* ---- running --------------------------------------------------------------------------------- */

/* Centre of mass, its velocity, and angular momentum over moment of inertia. */
static mps_status measure(mps_particles *set, double *x, double *v, double *omega) {
  mps_view px, pv, pm;
  double m = 0.0, inertia = 0.0, angular = 0.0;
  mps_status status = mps_particles_view(set, "position", &px);
  if (status == MPS_OK) status = mps_particles_view(set, "velocity", &pv);
  if (status == MPS_OK) status = mps_particles_view(set, "mass", &pm);
  int64_t *row = status == MPS_OK ? mpm_rows_by_id(set) : NULL;
  if (!row) return status == MPS_OK ? MPS_ERROR_MEMORY : status;
  for (int64_t i = 0; i < px.shape[0]; i++) {
    const int64_t k = row[i];
    const double mass = *mps_view_f64(&pm, k, 0);
    m += mass;
    for (int c = 0; c < 2; c++) {
      x[c] += mass * *mps_view_f64(&px, k, c);
      v[c] += mass * *mps_view_f64(&pv, k, c);
    }
  }
  for (int c = 0; c < 2; c++) x[c] /= m, v[c] /= m;
  for (int64_t i = 0; i < px.shape[0]; i++) {
    const int64_t k = row[i];
    const double mass = *mps_view_f64(&pm, k, 0);
    const double dx = *mps_view_f64(&px, k, 0) - x[0], dy = *mps_view_f64(&px, k, 1) - x[1];
    inertia += mass * (dx * dx + dy * dy);
    angular += mass * (dx * *mps_view_f64(&pv, k, 1) - dy * *mps_view_f64(&pv, k, 0));
  }
  *omega = -angular / inertia;
  free(row);
  return MPS_OK;
}

static mps_status look_at_particles(simulation *sim, double *x, double *v, double *omega) {
  mps_particles *whole;
  double found[5] = {0.0};
  mps_status status = mpm_model_whole(&sim->m, &whole);
  if (status == MPS_OK && whole) status = measure(whole, found, found + 2, found + 4);
  status = mpm_model_tell(&sim->m, status, 5, found);
  for (int c = 0; c < 2; c++) x[c] = found[c], v[c] = found[2 + c];
  *omega = found[4];
  return status;
}

static mps_status look_at_body(simulation *sim, double *x, double *v, double *omega) {
  mps_body_state b;
  const mps_status status = mps_body_get_state(sim->m.body[0], &b);
  if (status != MPS_OK) return status;
  for (int c = 0; c < 2; c++) x[c] = b.position[c], v[c] = b.velocity[c];
  *omega = -b.spin[2];
  return MPS_OK;
}

static mps_status sample(const settings *s, simulation *sim) {
  double x[2] = {0}, v[2] = {0}, omega = 0.0;
  const mps_status status = s->body == BODY_SLOPE ? look_at_particles(sim, x, v, &omega)
                                                  : look_at_body(sim, x, v, &omega);
  if (status != MPS_OK) return status;
  motion row = {.t = mps_mpm_time(sim->m.mpm), .omega = omega};
  for (int c = 0; c < 2; c++) {
    row.x += x[c] * sim->along[c];
    row.v += v[c] * sim->along[c];
  }
  row.gap = (x[1] - sim->start[1]) * sim->along[0] - (x[0] - sim->start[0]) * sim->along[1];
  return mpm_course_add(&sim->course, &row);
}

static mps_status march(void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  mps_status status = MPS_OK;
  progress_part(&sim->m.a->bar, 0.0, 1.0, 0.0, s->duration);
  for (int k = rows_of(sim); k <= SAMPLES && status == MPS_OK; k++) {
    if (k > 0)
      status = mpm_model_advance(&sim->m, s->duration * k / SAMPLES, INT64_MAX, NULL, NULL);
    if (status == MPS_OK) status = sample(s, sim);
    if (status == MPS_OK) status = mpm_course_sample(&sim->course, k, SAMPLES);
  }
  return mpm_course_end(&sim->course, status);
}

/* ---- results --------------------------------------------------------------------------------- */

static bool write_motion(app *a, const settings *s, const simulation *sim) {
  output f;
  if (!csv_open(&f, a, s->out, "motion.csv", "t_s,x_m,x_theory_m,v_m_s,omega_rad_s")) return false;
  for (int k = 0; k < rows_of(sim); k++) {
    const motion *m = row_of(sim, k);
    CSV_LINE(&f, m->t, m->x - row_of(sim, 0)->x, theory(s, m->t), m->v, m->omega);
  }
  return output_close(&f);
}

static bool draw(app *a, const settings *s) {
  return plot_draw(a, s->out, "motion", "rolling-disc",
                   "first = '%s disc on %s slope of %g degrees'\n"
                   "second = 'h = %g R, {/Symbol m} = %g, %d particles a cell, %s'",
                   s->body == BODY_SLOPE ? "An elastic" : "A rigid",
                   s->body == BODY_SLOPE ? "a rigid" : "an elastic", s->angle, s->h / RADIUS, s->mu,
                   (int)s->ppc,
                   s->body == BODY_SLOPE && s->fill == FILL_RINGS ? "rings" : "lattice");
}

/* The largest relative difference from the path (51) on the way, and when, s. */
static double worst_on_the_way(const simulation *sim, double *at) {
  double worst = 0.0;
  *at = NAN;
  for (int k = 1; k < rows_of(sim); k++) {
    const motion *m = row_of(sim, k);
    if (m->t < FIRST * sim->s.duration * (1.0 - 1e-9)) continue;
    const double off = (m->x - row_of(sim, 0)->x) / theory(&sim->s, m->t) - 1.0;
    if (fabs(off) > fabs(worst)) worst = off, *at = m->t;
  }
  return worst;
}

/* The farthest that the disc has been off the slope, m. */
static double farthest(const simulation *sim) {
  double most = 0.0;
  for (int k = 0; k < rows_of(sim); k++) most = fmax(most, row_of(sim, k)->gap);
  return most;
}

/* (51) is the path of a rigid disc that stays on the slope. */
static comparison compare_path(const simulation *sim, double x) {
  const settings *s = &sim->s;
  const motion *end = row_of(sim, rows_of(sim) - 1);
  double at;
  const double worst = worst_on_the_way(sim, &at), soft = DENSITY * G * RADIUS / s->young;
  comparison c = compare_with("Nakamura's path of a rigid disc", x, theory(s, end->t));
  compare_require(&c, end->t > (1.0 - 1e-6) * s->duration, "the run has not come to its end");
  compare_require(&c, soft <= STIFF,
                  "the material is soft: rho g R is %.2g times its Young's modulus", soft);
  compare_require(&c, s->mu == 0.0 || farthest(sim) <= LEAVES * RADIUS,
                  "the disc has been %.2g radii off the slope: corners of its lattice start inside "
                  "it, and springs push them out; take --fill rings or --contact impulse",
                  farthest(sim) / RADIUS);
  compare_require(
      &c, fabs(worst) <= REGULAR || fabs(compare_error(&c)) >= 0.5 * fabs(worst),
      "on the way the path differs by up to %+.0f %%, at %.2g s: the disc hops, and the "
      "end agrees by chance",
      100.0 * worst, at);
  return c;
}

static bool finish(app *a, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  const motion *end = row_of(sim, rows_of(sim) - 1);
  const double x = end->x - row_of(sim, 0)->x, ratio = end->omega * RADIUS / end->v;
  const comparison path = compare_path(sim, x);
  double worst_at;
  const double worst = worst_on_the_way(sim, &worst_at);
  output f;
  if (!write_motion(a, s, sim) || !mpm_model_summary(a, &sim->m, s->out, &f)) return false;
  json_text(&f, "body", s->body == BODY_SLOPE ? "slope" : "disc");
  JSON_NUMBERS(&f, {"cell", s->h}, {"mu", s->mu}, {"x", x});
  json_comparison(&f, "x_theory", &path);
  json_number(&f, "x_error_05", compare_error(&path)); /* at the end */
  JSON_NUMBERS(&f, {"x_error_worst", !isnan(worst_at) ? worst : NAN}, {"omega_ratio", ratio},
               {"farthest_off", farthest(sim)});
  json_end(&f);
  if (!output_close(&f) || !draw(a, s)) return false;
  app_tell_results(a, s->out);
  printf("path %.5f m after %g s", x, end->t);
  if (compare_holds(&path))
    printf(" (theory %.5f, %+.2f %%; on the way up to %+.2f %%, at %.2g s)", path.reference,
           100.0 * compare_error(&path), 100.0 * worst, worst_at);
  if (s->mu > 0.0) printf(", omega R/v %.3f", ratio);
  printf("\n");
  compare_tell(&path);
  return true;
}

int main(int argc, char **argv) {
  static simulation sim;
  settings *s = &sim.s;
  option table[] = {OPTION_HEADING("Disc and slope"),
                    OPTION_FLAG("paper", &s->paper, NULL),
                    OPTION_CHOICE_OF("body", "slope|disc", &s->body, NULL),
                    OPTION_NUMBER("slope-angle", &s->angle, NULL, 30.0),
                    OPTION_NUMBER("friction", &s->mu, "the disc rolls where tan(angle) <= 3 mu"),
                    MPM_MODEL_CONTACT(&s->contact),
                    OPTION_NUMBER("k", &s->k, NULL, 2e6),
                    OPTION_NUMBER("young", &s->young, NULL, 1e6),
                    OPTION_NUMBER("poisson", &s->poisson, NULL, 0.3),
                    OPTION_HEADING("Grid"),
                    OPTION_NUMBER_IN("cell", OPTION_FROM_TO(1e-4, 0.05), &s->h,
                                     "the disc's radius R is 0.05 m", 0.01),
                    OPTION_INTEGER("ppc", &s->ppc, NULL, 4),
                    OPTION_NUMBER("courant", &s->courant, NULL, 0.5),
                    OPTION_CHOICE("spline", &s->spline, NULL, 1),
                    MPM_METHOD_OPTIONS(&s->method),
                    OPTION_CHOICE_OF("fill", "rings|lattice", &s->fill, NULL),
                    OPTION_HEADING("Run"),
                    OPTION_NUMBER_IN("duration", OPTION_FROM_TO(0.01, 0.55), &s->duration,
                                     "x_error_05 is that at its end", 0.5),
                    MPM_COURSE_OPTIONS(&s->course, SAMPLES),
                    OPTIONS_OF_ALL(s),
                    {0}};
  const options_program program = {
      "mps-rolling-disc",
      "A disc of radius 0.05 m slips or rolls down a slope (WLS-MPM): Nakamura, Figures 12 to 14.\n"
      "Its path is compared with that of a rigid disc, Nakamura (51).",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  static const option_preset paper[] = {
      {"contact", "penalty"}, {"k", "2MN/m"}, {"friction", "0.3"}, {"fill", "lattice"}, {0}};
  const int settled = mpm_method_settle(&program, &s->method, s->paper, paper, 0.0);
  if (settled >= 0) return settled;
  const char *refused = mpm_model_refuse_stiffness(table, s->contact);
  if (refused) return options_refuse(&program, refused);
  static const mpm_model_parts parts = {build, march, finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  return mpm_model_run(&program, s->threads, &places, &sim.m, &parts, &sim);
}
