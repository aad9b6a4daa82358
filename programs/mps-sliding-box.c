/* mps-sliding-box - an elastic block between plates, pressed and dragged: Nakamura 7.1, Figures
 * 9-11.
 *
 * The upper plate comes down 0.45 mm, the rough lower one slides by as much; the sides are smooth.
 * The block is confined: its stress is M ln(1 + e) of the stretch's strain e, with the confined
 * modulus M, and without friction F_y = M |ln(1 - d/H)| L, d = 0.45 mm. Friction
 * adds to it where the block lifts off (docs/verification/wls-mpm/sliding-box.md).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/compare.h"
#include "common/mpm_course.h"
#include "common/mpm_method.h"
#include "common/mpm_model.h"
#include "common/plot.h"

#include <math.h>
#include <stdio.h>

#define PI 3.14159265358979323846
#define SIDE 0.1   /* m */
#define SPEED 5e-4 /* m/s */
#define STROKE 1.0 /* s: each plate's motion */
#define RAMP 0.1   /* s: to full speed, and back */
#define T_END 2.0  /* s */

enum { BOTTOM, RIGHT, TOP, LEFT, PLATES, SAMPLES = 400 };

typedef struct settings {
  double courant;
  double h, k, offset, turn, mu, young, poisson, density;
  int contact; /* mps_contact_method */
  int spline;  /* degree of the weights less 2 */
  int64_t ppc, threads;
  mpm_method method;
  bool paper;
  mpm_course_options course;
  const char *out;
} settings;

typedef struct sample_row {
  double t, fx, fy, impulse[2]; /* s; N/m on the lower plate; N s/m, so far, in the grid's axes */
} sample_row;

typedef struct simulation {
  settings s;
  mpm_model m;
  mpm_course course;
} simulation;

static int rows_of(const simulation *sim) { return (int)sim->course.rows.count; }
static const sample_row *row_of(const simulation *sim, int k) {
  return (const sample_row *)sim->course.rows.row + k;
}

/* M = E (1 - nu)/((1 + nu)(1 - 2 nu)), Pa. */
static double confined_modulus(const settings *s) {
  const double E = s->young, nu = s->poisson;
  return E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
}

/* ---- building -------------------------------------------------------------------------------- */

/* Velocity of the paper's Figure 10: up in 0.1 s, constant, down in 0.1 s. `start` in s. */
static mps_status stroke(mps_context *context, double start, mps_signal **out) {
  const double t[] = {start, start + RAMP, start + STROKE - RAMP, start + STROKE};
  const double v[] = {0.0, SPEED, SPEED, 0.0};
  return mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 4, t, v, out);
}

/* A vector of the upright block as it lies in the grid. */
static void turn(const settings *s, const double *upright, double *out) {
  const double a = s->turn * PI / 180.0;
  out[0] = cos(a) * upright[0] - sin(a) * upright[1];
  out[1] = sin(a) * upright[0] + cos(a) * upright[1];
}

static mps_status drive(const settings *s, mps_body *plate, const double *upright,
                        mps_signal *signal) {
  double along[2];
  mps_status status = MPS_OK;
  turn(s, upright, along);
  for (int c = 0; c < 2 && status == MPS_OK; c++)
    if (along[c] != 0.0) status = mps_body_drive(plate, c, signal, along[c]);
  return status;
}

static mps_status make_plates(mps_context *context, simulation *sim) {
  static const double normal[PLATES][2] = {{0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}, {1.0, 0.0}};
  static const double x_axis[2] = {1.0, 0.0};
  static const double at[PLATES][2] = {{0.0, 0.0}, {SIDE, 0.0}, {0.0, SIDE}, {0.0, 0.0}};
  mps_signal *down = NULL, *aside = NULL;
  mps_status status = stroke(context, 0.0, &down);
  if (status == MPS_OK) status = stroke(context, STROKE, &aside);
  for (int p = 0; p < PLATES && status == MPS_OK; p++) {
    mps_body_def def = mps_body_defaults();
    double outwards[2];
    turn(&sim->s, at[p], def.position);
    turn(&sim->s, normal[p], outwards);
    status = mps_body_create_half_plane(context, &def, outwards, &sim->m.body[p]);
    if (status == MPS_OK && p == TOP) status = drive(&sim->s, sim->m.body[p], normal[p], down);
    if (status == MPS_OK && p == BOTTOM) status = drive(&sim->s, sim->m.body[p], x_axis, aside);
  }
  mps_signal_destroy(&down);
  mps_signal_destroy(&aside);
  return status;
}

static mps_status add_contacts(const settings *s, simulation *sim) {
  mps_status status = MPS_OK;
  for (int p = 0; p < PLATES && status == MPS_OK; p++) {
    mps_contact_def contact = mps_contact_defaults();
    contact.method = s->contact;
    if (s->contact == MPS_CONTACT_METHOD_PENALTY && s->k > 0.0) contact.penalty = s->k;
    contact.friction = p == BOTTOM ? s->mu : 0.0;
    status = mps_mpm_add_contact(sim->m.mpm, sim->m.body[p], &contact, NULL);
  }
  return status;
}

/* Rows along the plates, of whole particles a side: as near to h / sqrt(ppc) as can be. */
static mps_status fill(mps_context *context, const settings *s, mps_particles **out) {
  const int count = (int)fmax(1.0, nearbyint(SIDE * sqrt((double)s->ppc) / s->h));
  mps_particles_def set = mps_particles_defaults();
  set.spacing = SIDE / count;
  mps_status status = mps_particles_create(context, &set, out);
  for (int row = 0; row < count; row++)
    for (int k = 0; k < count && status == MPS_OK; k++) {
      const double upright[2] = {(k + 0.5) * set.spacing, (row + 0.5) * set.spacing};
      double x[2];
      turn(s, upright, x);
      status = mps_particles_append(*out, 1, x);
    }
  return status;
}

static mps_status build(mps_context *context, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  static const rows_column columns[] = {
      {"Fx", "N/m", 0}, {"Fy", "N/m", 0}, {"impulse", "N s/m", 2}, {0}};
  sim->course = mpm_course_of(&s->course, &sim->m, s->out, "mps-sliding-box 2", NULL, NULL);
  sim->course.what = "block";
  sim->course.duration = T_END;
  sim->course.columns = columns;
  mps_status status = mpm_course_peek(&sim->course, context);
  if (status == MPS_OK) status = fill(context, s, &sim->m.particles);
  if (status == MPS_OK) status = mps_particles_set(sim->m.particles, "density", 0, s->density);
  if (status == MPS_OK)
    status = mps_material_create_linear_elastic(context, s->young, s->poisson, &sim->m.material);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = s->h;
  def.courant = s->courant;
  def.spline = s->spline + 2;
  def.origin[0] = def.origin[1] = s->offset * s->h;
  mpm_method_define(&s->method, &def);
  if (status == MPS_OK) status = make_plates(context, sim);
  status = mpm_model_create(&sim->m, context, status, &def);
  status = mpm_method_choose(&s->method, sim->m.mpm, status);
  if (status == MPS_OK) status = add_contacts(s, sim);
  return status == MPS_OK ? mpm_course_begin(&sim->course, context, true) : status;
}

/* ---- running --------------------------------------------------------------------------------- */

/* Mean force on the block (x) and on the lower plate (y) since the last sample, from the impulse:
 * the noise of single steps is no part of it. */
static mps_status sample(simulation *sim) {
  mps_reaction now;
  const mps_status status = mps_body_get_reaction(sim->m.body[BOTTOM], -1, &now);
  if (status != MPS_OK) return status;
  const int rows = rows_of(sim);
  const sample_row last = rows > 0 ? *row_of(sim, rows - 1) : (sample_row){0};
  sample_row row = {.t = mps_mpm_time(sim->m.mpm), .impulse = {now.impulse[0], now.impulse[1]}};
  const double span = row.t - last.t;
  const double force[2] = {-(row.impulse[0] - last.impulse[0]) / span,
                           -(row.impulse[1] - last.impulse[1]) / span};
  const double a = sim->s.turn * PI / 180.0;
  row.fx = cos(a) * force[0] + sin(a) * force[1];
  row.fy = cos(a) * force[1] - sin(a) * force[0];
  return mpm_course_add(&sim->course, &row);
}

static mps_status march(void *user) {
  simulation *sim = user;
  mps_status status = MPS_OK;
  progress_part(&sim->m.a->bar, 0.0, 1.0, 0.0, T_END);
  if (rows_of(sim) == 0) status = mpm_course_sample(&sim->course, 0, SAMPLES);
  for (int k = rows_of(sim) + 1; k <= SAMPLES && status == MPS_OK; k++) {
    status = mpm_model_advance(&sim->m, T_END * k / SAMPLES, INT64_MAX, NULL, NULL);
    if (status == MPS_OK) status = sample(sim);
    if (status == MPS_OK) status = mpm_course_sample(&sim->course, k, SAMPLES);
  }
  return mpm_course_end(&sim->course, status);
}

/* ---- results --------------------------------------------------------------------------------- */

static bool draw(app *a, const settings *s, double fy_exact) {
  char contact[48] = "impulses";
  if (s->contact == MPS_CONTACT_METHOD_PENALTY)
    snprintf(contact, sizeof contact, "springs k = %g kN/m", 1e-3 * s->k);
  return plot_draw(a, s->out, "forces", "sliding-box",
                   "second = 'h = %g m, %s, {/Symbol m} = %g'\nexact = %.9g; mu = %.9g", s->h,
                   contact, s->mu, fy_exact, s->mu);
}

/* The confined block without friction. */
static comparison compare_force(const settings *s, double fy, double smooth) {
  comparison c = compare_with("the confined block without friction", fy, smooth);
  compare_require(&c, s->mu == 0.0, "friction of %g adds to the force where the block lifts off",
                  s->mu);
  return c;
}

static bool write_forces(app *a, const simulation *sim) {
  output f;
  if (!csv_open(&f, a, sim->s.out, "forces.csv", "t_s,Fx_N_m,Fy_N_m")) return false;
  for (int k = 0; k < rows_of(sim); k++) {
    CSV_LINE(&f, row_of(sim, k)->t, row_of(sim, k)->fx, row_of(sim, k)->fy);
  }
  return output_close(&f);
}

/* Means while the lower plate slides at its full speed. */
static bool finish(app *a, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  const double smooth = -confined_modulus(s) * SIDE * log1p(-SPEED * (STROKE - RAMP) / SIDE);
  double fx = 0.0, fy = 0.0;
  int count = 0;
  for (int k = 0; k < rows_of(sim); k++) {
    if (row_of(sim, k)->t < STROKE + 4.0 * RAMP || row_of(sim, k)->t > 2.0 * STROKE - RAMP)
      continue;
    fx += row_of(sim, k)->fx, fy += row_of(sim, k)->fy, count++;
  }
  if (count > 0) fx /= count, fy /= count; /* none: the run ended before */
  output f;
  if (!write_forces(a, sim) || !mpm_model_summary(a, &sim->m, s->out, &f)) return false;
  json_number(&f, "cell", s->h);
  if (s->contact == MPS_CONTACT_METHOD_PENALTY) json_number(&f, "k", s->k);
  const comparison force = compare_force(s, count > 0 ? fy : NAN, smooth);
  json_comparison(&f, "Fy_smooth", &force);
  JSON_NUMBERS(&f, {"Fy", count > 0 ? fy : NAN}, {"Fy_over_smooth", count > 0 ? fy / smooth : NAN},
               {"Fx_over_Fy", count > 0 ? fx / fy : NAN});
  json_end(&f);
  if (!output_close(&f) || !draw(a, s, smooth)) return false;
  app_tell_results(a, s->out);
  if (count > 0) printf("F_y %.2f N/m", fy);
  if (count > 0 && compare_holds(&force))
    printf(" (exact without friction %.2f, %+.2f %%)", smooth, 100.0 * compare_error(&force));
  if (count > 0) printf(", F_x/F_y %.5f (friction %g)\n", fx / fy, s->mu);
  if (count > 0) compare_tell(&force);
  return true;
}

int main(int argc, char **argv) {
  static simulation sim;
  settings *s = &sim.s;
  option table[] = {OPTION_HEADING("Block"),
                    OPTION_FLAG("paper", &s->paper, NULL),
                    OPTION_NUMBER("young", &s->young, NULL, 1e6),
                    OPTION_NUMBER("poisson", &s->poisson, NULL, 0.3),
                    OPTION_NUMBER("density", &s->density, NULL, 1000.0),
                    OPTION_HEADING("Contact"),
                    MPM_MODEL_CONTACT(&s->contact),
                    OPTION_NUMBER("k", &s->k, NULL, 2e6),
                    OPTION_NUMBER("friction", &s->mu, "of the lower plate", 0.3),
                    OPTION_HEADING("Grid"),
                    OPTION_NUMBER_IN("cell", OPTION_FROM_TO(1e-4, 0.1), &s->h, NULL, 0.02),
                    OPTION_INTEGER("ppc", &s->ppc, NULL, 4),
                    OPTION_NUMBER("courant", &s->courant, NULL, 0.5),
                    OPTION_CHOICE("spline", &s->spline, NULL, 1),
                    MPM_METHOD_OPTIONS(&s->method),
                    OPTION_NUMBER("offset", &s->offset, NULL),
                    OPTION_NUMBER("turn", &s->turn, NULL),
                    OPTION_HEADING("Run"),
                    MPM_COURSE_OPTIONS(&s->course, SAMPLES),
                    OPTIONS_OF_ALL(s),
                    {0}};
  const options_program program = {
      "mps-sliding-box",
      "An elastic block of 0.1 m pressed between plates and dragged (WLS-MPM): Nakamura, Figures "
      "9\n"
      "to 11. The forces on the rough lower plate are compared with the exact ones.",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  static const option_preset paper[] = {{"contact", "penalty"}, {"k", "2MN/m"}, {0}};
  const int settled = mpm_method_settle(&program, &s->method, s->paper, paper, 0.0);
  if (settled >= 0) return settled;
  const char *refused = mpm_model_refuse_stiffness(table, s->contact);
  if (refused) return options_refuse(&program, refused);
  const char *large = mpm_model_too_large(pow(SIDE / s->h, 2.0) * (double)s->ppc);
  if (large) return options_refuse(&program, large);
  if (RAMP * sqrt(confined_modulus(s) / s->density) < 5.0 * SIDE)
    return options_refuse(&program,
                          "--young over --density is too small for a block in equilibrium: "
                          "sound must cross it 5 times in the 0.1 s of a start");
  static const mpm_model_parts parts = {build, march, finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  return mpm_model_run(&program, s->threads, &places, &sim.m, &parts, &sim);
}
