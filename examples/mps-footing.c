/* mps-footing - a strip footing pressed into cohesive ground without weight (von Mises): seed
 * B 7.3, Figures 15 to 18, against Prandtl's bearing capacity (52), q = (2 + pi) c.
 *
 * Half of it is computed: x = 0 is the line of symmetry.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/mpm_model.h"
#include "common/plot.h"

#include <math.h>
#include <stdio.h>

#define PI 3.14159265358979323846
#define RAMP 0.1 /* s to full speed at the seed's rate; as much path at others */

enum { SAMPLES = 120 };

typedef struct settings {
  double h, mu, rate, half_width, width, depth, cohesion, young, poisson, density, k, settlement;
  int64_t ppc, threads;
  const char *out;
} settings;

typedef struct simulation {
  settings s;
  mpm_model m;
  double ramp, t_end;                       /* s */
  double path[SAMPLES + 1], q[SAMPLES + 1]; /* m, Pa */
  int rows;
  double strain; /* largest plastic strain */
} simulation;

/* ---- building -------------------------------------------------------------------------------- */

/* Speed up over the ramp, then constant until the settlement is reached. */
static mps_status make_footing(mps_context *context, const settings *s, simulation *sim) {
  const double speed = s->rate * 1e-3;
  sim->ramp = RAMP * fmin(1.0, 0.5 / s->rate);
  sim->t_end = s->settlement * 1e-3 / speed + 0.5 * sim->ramp;
  const double t[] = {0.0, sim->ramp, sim->t_end + 1.0}, v[] = {0.0, speed, speed};
  mps_signal *down = NULL;
  mps_status status = mps_signal_table(context, MPS_SIGNAL_VELOCITY, 3, t, v, &down);
  mps_body_def def = mps_body_defaults();
  const double height = s->half_width;
  def.position[1] = s->depth + 0.5 * height;
  def.friction = s->mu;
  def.penalty = s->k * 1e3;
  if (status == MPS_OK)
    status = mps_body_create_box(context, &def, 2.0 * s->half_width, height, &sim->m.body[0]);
  if (status == MPS_OK) status = mps_body_drive(sim->m.body[0], 1, down, -1.0);
  mps_signal_destroy(&down);
  return status == MPS_OK ? mps_mpm_add_body(sim->m.mpm, sim->m.body[0]) : status;
}

static mps_status build(mps_context *context, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  const double lo[2] = {0.0, 0.0}, hi[2] = {s->width, s->depth};
  mps_particles_def set = mps_particles_defaults();
  set.spacing = s->h / sqrt((double)s->ppc);
  mps_status status = mps_particles_create(context, &set, &sim->m.particles);
  if (status == MPS_OK) status = mps_particles_fill_box(sim->m.particles, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(sim->m.particles, "density", 0, s->density);
  mps_von_mises_def law = mps_von_mises_defaults();
  law.young = s->young * 1e3, law.poisson = s->poisson;
  law.yield_stress = sqrt(3.0) * s->cohesion * 1e3; /* (54) */
  if (status == MPS_OK) status = mps_material_von_mises(context, &law, &sim->m.material);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = s->h;
  def.lower[0] = def.lower[1] = 0.0;
  def.upper[0] = s->width;
  def.wall_lower[1] = MPS_WALL_FIXED;
  if (status == MPS_OK)
    status = mps_mpm_create(context, sim->m.particles, sim->m.material, &def, &sim->m.mpm);
  return status == MPS_OK ? make_footing(context, s, sim) : status;
}

/* ---- running --------------------------------------------------------------------------------- */

/* Pressure from the impulse since the last sample. */
static mps_status march(void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  double last_impulse = 0.0, last_time = 0.0;
  mps_status status = MPS_OK;
  for (int k = 1; k <= SAMPLES && status == MPS_OK; k++) {
    mps_reaction reaction;
    mps_body_state body;
    status = mps_mpm_run(sim->m.mpm, sim->t_end * k / SAMPLES, INT64_MAX, NULL, NULL);
    if (status == MPS_OK) status = mps_body_get_reaction(sim->m.body[0], -1, &reaction);
    if (status == MPS_OK) status = mps_body_get_state(sim->m.body[0], &body);
    if (status != MPS_OK) break;
    const double t = mps_mpm_time(sim->m.mpm);
    sim->path[sim->rows] = s->depth + 0.5 * s->half_width - body.position[1];
    sim->q[sim->rows] = (reaction.impulse[1] - last_impulse) / (t - last_time) / s->half_width;
    sim->rows++;
    last_impulse = reaction.impulse[1];
    last_time = t;
  }
  return status;
}

/* ---- results --------------------------------------------------------------------------------- */

static bool write_pressure(app *a, const settings *s, const simulation *sim) {
  output f;
  if (!output_open(&f, a, s->out, "pressure.csv")) return false;
  output_text(&f, "settlement_mm,q_kPa,q_over_c\n");
  for (int k = 0; k < sim->rows; k++) {
    const double q = sim->q[k] * 1e-3, row[] = {sim->path[k] * 1e3, q, q / s->cohesion};
    csv_row(&f, 3, row);
  }
  return output_close(&f);
}

static bool write_particles(app *a, const settings *s, simulation *sim) {
  mps_view x, strain;
  output f;
  if (!app_check(a, mps_particles_view(sim->m.particles, "position", &x)) ||
      !app_check(a, mps_particles_view(sim->m.particles, "plastic_strain", &strain)) ||
      !output_open(&f, a, s->out, "particles.csv"))
    return false;
  output_text(&f, "x_m,y_m,plastic_strain\n");
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double row[] = {*mps_view_f64(&x, k, 0), *mps_view_f64(&x, k, 1),
                          *mps_view_f64(&strain, k, 0)};
    sim->strain = fmax(sim->strain, row[2]);
    csv_row(&f, 3, row);
  }
  return output_close(&f);
}

static bool draw(app *a, const settings *s, const simulation *sim) {
  output f;
  if (!plot_open(&f, a, s->out, "pressure", 1000, 640)) return false;
  output_text(&f,
              "set title \"Strip footing on cohesive ground\\n{/*0.85 h = %g m, half width %g m, "
              "%g mm/s}\"\nset xlabel 'settlement (mm)'\nset ylabel 'pressure over cohesion, q/c'\n"
              "set key right bottom opaque\nset yrange [0:*]\n"
              "plot 'pressure.csv' every ::1 using 1:3 with lines linecolor rgb '#1f4e8c' title "
              "'WLS-MPM', \\\n  2+pi dashtype '--' linecolor rgb '#c0392b' title 'Prandtl'\n",
              s->h, s->half_width, s->rate);
  if (!plot_close(&f, s->out, "pressure")) return false;
  if (!plot_open(&f, a, s->out, "shear_bands", 1100, 660)) return false;
  output_text(&f,
              "set title 'Plastic strain'\nset xlabel 'x (m)'\nset ylabel 'y (m)'\n"
              "set size ratio -1\nset palette defined (0 '#f7fbff', 0.3 '#6baed6', 1 '#08306b')\n"
              "set xrange [0:%.9g]\nset yrange [%.9g:%.9g]\n"
              "set object 1 rectangle from 0,%.9g to %.9g,%.9g fillcolor rgb '#888888' front\n"
              "set cbrange [0:%.9g]\n"
              "plot 'particles.csv' every ::1 using 1:2:3 with points pointtype 7 pointsize %.3g "
              "linecolor palette notitle\n",
              fmin(s->width, 5.0 * s->half_width), fmax(0.0, s->depth - 3.0 * s->half_width),
              s->depth + 0.3 * s->half_width, s->depth, s->half_width,
              s->depth + 0.3 * s->half_width, 0.5 * sim->strain + 1e-12,
              12.0 * s->h / s->half_width);
  return plot_close(&f, s->out, "shear_bands");
}

/* Mean over the last fifth of the path: the footing goes down at constant pressure there. */
static bool finish(app *a, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  double q = 0.0;
  int count = 0;
  for (int k = sim->rows - sim->rows / 5; k < sim->rows; k++) q += sim->q[k], count++;
  const double ratio = q / count / (s->cohesion * 1e3);
  output f;
  if (!write_pressure(a, s, sim) || !write_particles(a, s, sim) ||
      !mpm_model_summary(a, &sim->m, s->out, &f))
    return false;
  json_text(&f, "model", "vonmises");
  json_number(&f, "h", s->h);
  json_number(&f, "rate", s->rate);
  json_number(&f, "q_over_c", ratio);
  json_number(&f, "q_exact", 2.0 + PI);
  json_end(&f);
  if (!output_close(&f) || !draw(a, s, sim)) return false;
  printf("Results: %s/ (pressure.csv, particles.csv, summary.json, pressure.png, "
         "shear_bands.png)\n",
         s->out);
  printf("bearing capacity q/c %.3f (Prandtl %.3f, %+.1f %%)\n", ratio, 2.0 + PI,
         100.0 * (ratio / (2.0 + PI) - 1.0));
  return true;
}

int main(int argc, char **argv) {
  static simulation sim = {.s = {.h = 0.1,
                                 .rate = 0.5,
                                 .half_width = 0.5,
                                 .width = 5.0,
                                 .depth = 5.0,
                                 .cohesion = 10.0,
                                 .young = 1e6,
                                 .poisson = 0.3,
                                 .density = 1000.0,
                                 .k = 2e6,
                                 .settlement = 0.6,
                                 .ppc = 4,
                                 .out = "out/footing"}};
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Ground"),
      OPTION_NUMBER("width", "m", OPTION_POSITIVE, &s->width,
                    "of the half model, whole cells from the line of symmetry"),
      OPTION_NUMBER("depth", "m", OPTION_POSITIVE, &s->depth, "of the ground, whole cells"),
      OPTION_NUMBER("cohesion", "kPa", OPTION_POSITIVE, &s->cohesion, "undrained strength c"),
      OPTION_NUMBER("young", "kPa", OPTION_POSITIVE, &s->young, "Young's modulus E"),
      OPTION_NUMBER("poisson", "1", OPTION_FROM_TO(0.0, 0.49), &s->poisson, "Poisson's ratio"),
      OPTION_HEADING("Footing"),
      OPTION_NUMBER("half-width", "m", OPTION_POSITIVE, &s->half_width, "B/2"),
      OPTION_NUMBER("mu", "1", OPTION_FROM_TO(0.0, 10.0), &s->mu, "friction of its base"),
      OPTION_NUMBER("rate", "mm/s", OPTION_ABOVE_TO(0.0, 100.0), &s->rate, "its speed"),
      OPTION_NUMBER("settlement", "mm", OPTION_POSITIVE, &s->settlement, "where the run ends"),
      OPTION_NUMBER("k", "kN/m", OPTION_POSITIVE, &s->k,
                    "contact stiffness per unit thickness of each particle, seed B (28)"),
      OPTION_HEADING("Grid"),
      OPTION_NUMBER("h", "m", OPTION_POSITIVE, &s->h, "grid spacing"),
      OPTION_INTEGER("ppc", "N", OPTION_FROM_TO(1.0, 100.0), &s->ppc, "particles a cell"),
      OPTION_HEADING("Run"),
      OPTION_OUT(&s->out),
      OPTION_THREADS(&s->threads),
      {0}};
  const options_program program = {
      "mps-footing",
      "A strip footing on cohesive ground without weight (WLS-MPM, von Mises): seed B, Figures 15\n"
      "to 18. Its bearing capacity is compared with Prandtl's.",
      table};
  const int code = options_parse(&program, argc, argv);
  if (code >= 0) return code;
  static const mpm_model_parts parts = {build, march, finish};
  return mpm_model_run(&program, s->threads, s->out, &sim.m, &parts, &sim);
}
