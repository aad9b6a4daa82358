/* mps-dam-break - a column of water collapses on a dry bed: Nakamura, Figure 2, against the
 * experiments of Martin and Moyce (1952).
 *
 * The water stands between the wall x = 0 and a gate at x = a that vanishes at once; it is n^2 a
 * high. --still keeps the gate: then nothing should move, and p = rho g depth.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/compare.h"
#include "common/plot.h"
#include "common/waves.h"
#include "dam_break/dam_break.h"

#include <stdio.h>
#include <stdlib.h>

/* ---- Martin and Moyce -------------------------------------------------------------------------
 * "An experimental study of the collapse of liquid columns on a rigid horizontal plane", Phil.
 * Trans. R. Soc. A 244 (1952) 312-324: columns of rectangular section, a = 2.25 in. Front Z = x/a
 * against T = t sqrt(n^2 g/a); height at the wall H = y/(n^2 a) against tau = t sqrt(g/a). The
 * numbers are those of later authors, for n^2 = 2 as tables 2 and 6. When the gate was released
 * could not be timed well: it is usual to set the clocks at Z = 1.44. */

typedef struct series {
  int count;
  const double *t, *value;
} series;

static const double z_of_2[] = {1.11, 1.22, 1.44, 1.67, 1.89, 2.11, 2.33, 2.56,
                                2.78, 3.00, 3.22, 3.44, 3.67, 3.89, 4.11};
static const double t_of_2[] = {0.41, 0.84, 1.19, 1.43, 1.63, 1.83, 1.98, 2.20,
                                2.32, 2.51, 2.65, 2.83, 2.98, 3.11, 3.33};
static const double h_of_2[] = {0.94, 0.89, 0.83, 0.78, 0.72, 0.67, 0.61, 0.56, 0.50,
                                0.44, 0.39, 0.33, 0.28, 0.22, 0.17, 0.11, 0.06};
static const double tau_of_2[] = {0.56, 0.77, 0.93, 1.08, 1.28, 1.46, 1.66, 1.84, 2.00,
                                  2.21, 2.45, 2.70, 3.06, 3.44, 4.20, 5.25, 7.40};
static const double z_of_1[] = {1.11, 1.22, 1.44, 1.67, 1.89, 2.11, 2.33, 2.56, 2.78, 3.00,
                                3.22, 3.44, 3.67, 3.89, 4.11, 4.33, 4.56, 4.78, 4.89, 5.00};
static const double t_of_1[] = {0.43, 0.62, 0.80, 0.97, 1.14, 1.29, 1.45, 1.62, 1.76, 1.93,
                                2.07, 2.24, 2.40, 2.54, 2.71, 2.87, 3.04, 3.21, 3.29, 3.32};
static const double h_of_1[] = {0.89, 0.78, 0.67, 0.56, 0.44, 0.33, 0.22, 0.11};
static const double tau_of_1[] = {0.80, 1.29, 1.74, 2.15, 2.57, 3.08, 4.27, 6.29};

#define SERIES(t_, value_)                                                                         \
  { sizeof(t_) / sizeof *(t_), t_, value_ }
static const series fronts[2] = {SERIES(t_of_1, z_of_1), SERIES(t_of_2, z_of_2)};
static const series heights[2] = {SERIES(tau_of_1, h_of_1), SERIES(tau_of_2, h_of_2)};
#define CLOCK_AT 2 /* the point of each front series where the clocks are set */

/* Linear between the points; NaN outside them. */
static double interpolate(int count, const double *t, const double *value, double at) {
  for (int k = 1; k < count; k++)
    if (at >= t[k - 1] && at <= t[k])
      return value[k - 1] +
             (value[k] - value[k - 1]) * (at - t[k - 1]) / fmax(t[k] - t[k - 1], 1e-300);
  return NAN;
}

/* ---- the run --------------------------------------------------------------------------------- */

static double speed_of_sound(const settings *s) {
  return isnan(s->sound) ? 10.0 * sqrt(2.0 * G * column_height(s)) : s->sound;
}

/* Pressure at the start: rho g depth behind the gate; once it is removed, that of the first moment
 * of an incompressible column, whose free sides have none. It is harmonic plus rho g depth, a
 * series in cos(b y) cosh(b x). From rho g depth instead, sound would run to and fro all the while.
 */
static double pressure_at(const settings *s, double x, double y) {
  const double H = column_height(s);
  double p = H - y;
  for (int k = 1; k < 400 && !s->rest; k += 2) {
    const double b = 0.5 * PI * k / H;
    const double growth = exp(b * (x - s->base)) * (1.0 + exp(-2.0 * b * x)) /
                          (1.0 + exp(-2.0 * b * s->base)); /* cosh(b x)/cosh(b a) */
    p -= 8.0 * H / (PI * PI * k * k) * cos(b * y) * growth;
  }
  return DENSITY * G * p;
}

#define GOLDEN 0.6180339887498949
#define STAGGER 0.98 /* the outermost particles stay inside */

/* Displaces the rows of particles along the bed by parts of a spacing that are spread evenly, by
 * the golden section. Else the columns of a lattice are still files when the water is drawn out,
 * and there are cells between them without particles. */
static mps_status stagger(mps_particles *water, double spacing) {
  mps_edit x;
  mps_status status = mps_particles_edit(water, "position", &x);
  for (int64_t k = 0; status == MPS_OK && k < x.view.shape[0]; k++) {
    const double part = GOLDEN * nearbyint(*mps_edit_f64(&x, k, 1) / spacing - 0.5);
    *mps_edit_f64(&x, k, 0) += spacing * STAGGER * (part - floor(part) - 0.5);
  }
  return status == MPS_OK ? mps_particles_commit(water, &x) : status;
}

static mps_status fill(mps_context *context, const settings *s, simulation *sim) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {s->base, column_height(s)};
  const double K = DENSITY * speed_of_sound(s) * speed_of_sound(s);
  mps_particles_def set = mps_particles_defaults();
  set.spacing = s->h / sqrt((double)s->ppc);
  mps_status status = mpm_model_particles(&sim->m, context, &set);
  mps_particles *water = sim->m.particles;
  if (status == MPS_OK) status = mps_particles_fill_box(water, lo, hi, NULL);
  if (status == MPS_OK && !s->rest) status = stagger(water, set.spacing);
  if (status == MPS_OK) status = mps_particles_set(water, "density", 0, DENSITY);
  if (status == MPS_OK) status = mps_particles_set(water, "stress", 0, 0.0);
  if (status == MPS_OK) status = mps_particles_set(water, "volume_ratio", 0, 1.0);
  mps_view x;
  mps_edit stress, ratio;
  if (status == MPS_OK) status = mps_particles_view(water, "position", &x);
  if (status == MPS_OK) status = mps_particles_edit(water, "stress", &stress);
  if (status == MPS_OK) status = mps_particles_edit(water, "volume_ratio", &ratio);
  for (int64_t k = 0; status == MPS_OK && k < x.shape[0]; k++) {
    const double p = pressure_at(s, *mps_view_f64(&x, k, 0), *mps_view_f64(&x, k, 1));
    for (int c = 0; c < 3; c++) *mps_edit_f64(&stress, k, c) = -p;
    *mps_edit_f64(&ratio, k, 0) = s->state == MPS_MATERIAL_STATE_EQUATION_TAIT
                                      ? pow(1.0 + 7.0 * p / K, -1.0 / 7.0)
                                      : 1.0 / (1.0 + p / K);
  }
  if (status == MPS_OK) status = mps_particles_commit(water, &stress);
  if (status == MPS_OK) status = mps_particles_commit(water, &ratio);
  return status;
}

mps_status dam_mpm_build(mps_context *context, simulation *sim) {
  const settings *s = &sim->s;
  mps_material_newtonian_def law = mps_material_newtonian_defaults();
  law.state = s->state;
  law.bulk_modulus = DENSITY * speed_of_sound(s) * speed_of_sound(s);
  law.viscosity = s->viscosity;
  law.no_tension = s->tension == 0;
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = s->h;
  def.courant = s->courant;
  def.spline = s->spline + 2;
  def.volumetric = s->volumetric;
  mpm_method_define(&s->variant, &def);
  def.lower[0] = def.lower[1] = 0.0;
  def.upper[0] = s->rest ? s->base : s->tank * s->base;
  def.gravity[1] = -G;
  mps_status status = fill(context, s, sim);
  if (status == MPS_OK) status = mps_material_create_newtonian(context, &law, &sim->m.material);
  status = mpm_model_create(&sim->m, context, status, &def);
  status = mpm_method_choose(&s->variant, sim->m.mpm, status);
  if (status == MPS_OK && s->bed == NO_SLIP)
    status = mps_mpm_set_side(sim->m.mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  return status;
}

/* ---- comparison ------------------------------------------------------------------------------ */

typedef struct misfit {
  double rms, worst;
  int points;
} misfit;

/* Computed `value` over `t` (scaled by `scale`, later by `shift`) less the experiment. */
static misfit compare(const simulation *sim, const series *data, const double *value, double scale,
                      double shift) {
  double t[SAMPLES + 1];
  misfit m = {0};
  for (int k = 0; k < sim->rows; k++) t[k] = sim->t[k] * scale + shift;
  for (int k = 0; k < data->count; k++) {
    const double d = interpolate(sim->rows, t, value, data->t[k]) - data->value[k];
    if (!isfinite(d)) continue;
    m.rms += d * d;
    if (fabs(d) > fabs(m.worst)) m.worst = d;
    m.points++;
  }
  m.rms = m.points ? sqrt(m.rms / m.points) : NAN;
  if (m.points == 0) m.worst = NAN;
  return m;
}

/* Shift of T such that the front is at the position where the experiment set its clock. */
static double clock_shift(const simulation *sim, const series *data, double scale) {
  for (int k = 1; k < sim->rows; k++)
    if (sim->Z[k] >= data->value[CLOCK_AT] && sim->Z[k - 1] < data->value[CLOCK_AT])
      return data->t[CLOCK_AT] -
             scale * interpolate(2, &sim->Z[k - 1], &sim->t[k - 1], data->value[CLOCK_AT]);
  return NAN;
}

/* The shift with which the front is nearest to all points: a single point, the tip of the tongue at
 * that moment, is less reliable. */
static double best_shift(const simulation *sim, const series *data, double scale) {
  double best = NAN, least = INFINITY;
  for (int k = 0; k <= 400; k++) {
    const double shift = 0.002 * k;
    const misfit m = compare(sim, data, sim->Z, scale, shift);
    if (m.points > data->count / 2 && m.rms < least) least = m.rms, best = shift;
  }
  return best;
}

/* ---- results --------------------------------------------------------------------------------- */

static bool write_front(app *a, const simulation *sim, double T, double tau) {
  const settings *s = &sim->s;
  const series *z = &fronts[s->n2 - 1], *h = &heights[s->n2 - 1];
  output f;
  if (!csv_open(&f, a, s->out, "front.csv",
                "t_s,T,Z,Z_experiment?,tau,H,H_experiment?,mass_kg_m,volume_m2,kinetic_J_m,"
                "potential_J_m,detached"))
    return false;
  for (int k = 0; k < sim->rows; k++) {
    const mpm_heap *p = &sim->heap[k];
    const double t = sim->t[k];
    CSV_LINE(&f, t, t * T, sim->Z[k], interpolate(z->count, z->t, z->value, t * T), t * tau,
             sim->H[k], interpolate(h->count, h->t, h->value, t * tau), p->mass, p->volume,
             p->kinetic, p->potential, p->detached);
  }
  if (!output_close(&f) || !csv_open(&f, a, s->out, "experiment.csv", "T?,Z?,tau?,H?"))
    return false;
  for (int k = 0; k < z->count || k < h->count; k++) {
    CSV_LINE(&f, k < z->count ? z->t[k] : NAN, k < z->count ? z->value[k] : NAN,
             k < h->count ? h->t[k] : NAN, k < h->count ? h->value[k] : NAN);
  }
  return output_close(&f);
}

static bool draw_front(app *a, const settings *s, double shift) {
  const bool mps = s->method == METHOD_MPS;
  char how[80];
  if (mps)
    snprintf(how, sizeof how, "particles every %.4g m", s->h);
  else
    snprintf(how, sizeof how, "h = %.4g m, c = %.3g m/s", s->h, speed_of_sound(s));
  return plot_draw(a, s->out, "front", "dam-break/front",
                   "n2 = %d; base = %.9g; how = '%s'; method = '%s'; shift = %.9g", (int)s->n2,
                   s->base, how, mps ? "MPS" : "WLS-MPM", shift);
}

/* Frames in one scale, lengths in bases. */
static bool draw_water(app *a, const simulation *sim, double T) {
  const settings *s = &sim->s;
  const double width = s->rest ? 1.0 : s->tank, height = 1.2 * (s->impact ? 1.0 : (double)s->n2);
  const bool mps = s->method == METHOD_MPS;
  const area_def def = {.spacing = s->h / (mps ? 1.0 : sqrt((double)s->ppc)),
                        .slit = mps ? AREA_SLIT : AREA_SLIT_SHEARED,
                        .upper = {width * s->base, height * s->base},
                        .walled = true,
                        .side = 1600,
                        .factor = 1e-3};
  area image[FRAMES];
  output f;
  if (!mpm_snapshots_image(a, s->out, "water.bin", FRAMES, sim->shot, &def, image) ||
      !plot_begin(&f, a, s->out, "water"))
    return false;
  area_set(&f, "water.bin", &def, FRAMES, image, s->base);
  for (int k = 0; k < FRAMES; k++)
    if (sim->shot[k].count > 0) /* none: the run ended before */
      output_text(&f, "titles[%d] = 'T = %.2f'\n", k + 1, sim->shot[k].time * T);
  output_text(&f,
              "x_name = 'x/a'; y_name = 'y/a'; cb_name = 'pressure (kPa)'; palette = 'water'\n"
              "cb_least = 0; cb_most = %.9g\n",
              0.9e-3 * DENSITY * G * column_height(s));
  return plot_end(&f, s->out, "water", "maps");
}

/* Pressure against rho g depth at the end, over that at the bed: RMS. */
static double rest_error(const simulation *sim) {
  const mpm_snapshot *shot = &sim->shot[FRAMES - 1];
  const double H = column_height(&sim->s);
  double sum = 0.0;
  if (shot->count == 0) return NAN; /* the run ended before */
  for (int64_t k = 0; k < shot->count; k++) {
    const double d = shot->row[3 * k + 2] / (DENSITY * G * H) - (1.0 - shot->row[3 * k + 1] / H);
    sum += d * d;
  }
  return sqrt(sum / (double)shot->count);
}

#define SMALLEST 0.02  /* m: columns below, in which surface tension counts */
#define LEAST_RE 1e4   /* Reynolds number (g a^3)^1/2/nu, below which viscosity counts */
#define LEAST_POINTS 3 /* of the experiment */

/* Martin and Moyce's columns: water, in a tank whose far wall is beyond their measurements. */
static comparison compare_experiment(const simulation *sim, const misfit *front) {
  const settings *s = &sim->s;
  const series *z = &fronts[s->n2 - 1];
  const double furthest = z->value[z->count - 1];
  const double Re =
      s->viscosity > 0.0 ? sqrt(G * pow(s->base, 3.0)) * DENSITY / s->viscosity : INFINITY;
  comparison c = compare_with("Martin and Moyce", front->rms, 0.0);
  compare_require(&c, !s->rest, "the water is at rest");
  compare_require(&c, s->tank >= furthest,
                  "the far wall is at %.3g bases, and the front is measured up to %.3g", s->tank,
                  furthest);
  compare_require(&c, s->base >= SMALLEST,
                  "the column is %.2g m wide: surface tension, which is left out, counts", s->base);
  compare_require(&c, Re >= LEAST_RE,
                  "it is of water, and viscosity counts: the Reynolds number is %.3g", Re);
  compare_require(&c, front->points >= LEAST_POINTS,
                  "the run ends before the front has passed %d of the measured places",
                  LEAST_POINTS);
  return c;
}

static void summarise(output *f, const simulation *sim, double T, double tau, double shift) {
  const settings *s = &sim->s;
  const series *z = &fronts[s->n2 - 1], *h = &heights[s->n2 - 1];
  const mpm_heap *first = &sim->heap[0], *last = &sim->heap[sim->rows - 1];
  const double scale = first->potential;
  double volume = 0.0, detached = 0.0, energy = -INFINITY, kinetic = 0.0;
  for (int k = 0; k < sim->rows; k++) {
    volume = fmax(volume, fabs(sim->heap[k].volume / first->volume - 1.0));
    detached = fmax(detached, sim->heap[k].detached);
    energy = fmax(energy, (sim->heap[k].kinetic + sim->heap[k].potential) / scale);
    kinetic = fmax(kinetic, sim->heap[k].kinetic / scale);
  }
  json_number(f, s->method == METHOD_MPS ? "spacing" : "cell", s->h);
  json_integer(f, "n2", s->n2);
  if (s->method == METHOD_MPM) json_number(f, "sound_speed", speed_of_sound(s));
  JSON_NUMBERS(f, {"mass", last->mass},
               {"mass_error", last->mass / (DENSITY * s->base * column_height(s)) - 1.0},
               {"volume_drift", volume}, {"energy_max", energy},
               {"energy_end", (last->kinetic + last->potential) / scale}, {"kinetic_max", kinetic});
  if (s->rest) {
    JSON_NUMBERS(f, {"pressure_error", rest_error(sim)}, {"height_end", sim->H[sim->rows - 1]});
    return;
  }
  const misfit front = compare(sim, z, sim->Z, T, 0.0), wall = compare(sim, h, sim->H, tau, 0.0);
  const misfit set = compare(sim, z, sim->Z, T, shift);
  const comparison experiment = compare_experiment(sim, &front);
  const bool holds = compare_holds(&experiment);
  JSON_NUMBERS(f, {"front_error_rms", holds ? front.rms : NAN},
               {"front_error_max", holds ? front.worst : NAN},
               {"front_clock_shift", holds ? shift : NAN},
               {"front_error_rms_clock", holds ? set.rms : NAN});
  const double fit = best_shift(sim, z, T);
  json_number_if(f, holds, "front_clock_fit", fit);
  const misfit fitted = compare(sim, z, sim->Z, T, fit);
  JSON_NUMBERS(f, {"front_error_rms_fit", holds ? fitted.rms : NAN},
               {"front_error_max_clock", holds ? set.worst : NAN},
               {"height_error_rms", holds ? wall.rms : NAN},
               {"height_error_max", holds ? wall.worst : NAN});
  json_reason(f, "experiment_reason", &experiment);
  json_number(f, "detached_max", detached);
  compare_tell(&experiment);
  if (!holds) return;
  printf("front against the experiment: RMS %.3f, at most %+.3f (a)", front.rms, front.worst);
  if (set.points > 0) printf("; clock set at Z = 1.44: RMS %.3f", set.rms);
  if (fitted.points > 0) printf("; by all points: RMS %.3f", fitted.rms);
  printf("\n");
}

static bool finish(app *a, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  if (s->impact)
    return mpm_snapshots_write(a, s->out, "particles.csv", "pressure_Pa", FRAMES, sim->shot) &&
           draw_water(a, sim, sqrt(2.0 * G / s->base)) && dam_impact_write(a, sim);
  const double tau = sqrt(G / s->base), T = tau * sqrt((double)s->n2);
  const double shift = s->rest ? NAN : clock_shift(sim, &fronts[s->n2 - 1], T);
  output f;
  if (!write_front(a, sim, T, tau) ||
      !mpm_snapshots_write(a, s->out, "particles.csv", "pressure_Pa", FRAMES, sim->shot) ||
      !mpm_model_summary(a, &sim->m, s->out, &f))
    return false;
  summarise(&f, sim, T, tau, shift);
  if (s->method == METHOD_MPS && !dam_guards_write(a, sim, &f)) return false;
  json_end(&f);
  if (!output_close(&f) || (!s->rest && !draw_front(a, s, shift)) || !draw_water(a, sim, T))
    return false;
  app_tell_results(a, s->out);
  if (s->rest && sim->shot[FRAMES - 1].count > 0)
    printf("pressure against rho g depth: RMS %.2f %% of that at the bed\n",
           100.0 * rest_error(sim));
  return true;
}

/* ---- options --------------------------------------------------------------------------------- */

/* Options of the method that is not used. */
static int check_needs(const options_program *program, const settings *s) {
  static const char grid[] = "--method mpm", particles[] = "--method mps";
  const bool mpm = s->method == METHOD_MPM;
  const options_need list[] = {{"sound-speed", grid, mpm},
                               {"equation-of-state", grid, mpm},
                               {"negative-pressure", grid, mpm},
                               {"bed", grid, mpm},
                               {"ppc", grid, mpm},
                               {"courant", grid, mpm},
                               {"spline", grid, mpm},
                               {"variant", grid, mpm},
                               {"edge", grid, mpm},
                               {"transfer", grid, mpm},
                               {"gradient", grid, mpm},
                               {"volumetric", grid, mpm},
                               {"disturb", particles, !mpm},
                               {"tolerance", particles, !mpm}};
  return options_check_needs(program, list, sizeof list / sizeof *list);
}

/* Defaults that depend on others, and lengths that must be whole cells. Returns -1 or a code. */
static int complete(const options_program *program, settings *s) {
  if (s->impact && (s->method != METHOD_MPS || s->rest || s->n2 != 2))
    return options_refuse(program, "--impact needs --method mps, and has no --still and --n2");
  if (s->paper && s->method == METHOD_MPS)
    return options_refuse(program, "--paper is for --method mpm");
  if (s->roughness > 0.0 && s->method != METHOD_MPS)
    return options_refuse(program, "--friction-factor is for --method mps only: of the grid the "
                                   "bed has slip or none, --bed");
  if (s->solver != 0 && s->method != METHOD_MPS)
    return options_refuse(program, "--solver is for --method mps only");
  if (s->impact) s->tank = 0.5 * 5.366;
  if (isnan(s->base)) s->base = s->impact ? 1.2 : 0.05715;
  const bool mps = s->method == METHOD_MPS;
  if (options_given(program->table, mps ? "cell" : "spacing"))
    return options_refuse(program, mps ? "--cell is for --method mpm, of mps it is --spacing"
                                       : "--spacing is for --method mps, of mpm it is --cell");
  if (isnan(s->h)) s->h = s->base / (s->impact ? 60.0 : mps ? 20.0 : 40.0);
  const double cells = options_divide(mps ? "spacing" : "cell", &s->h, "--width", s->base, false);
  if (cells < 4.0)
    return options_refuse(program, mps ? "--spacing must be at most a quarter of --width"
                                       : "--cell must be at most a quarter of --width");
  const double tank = nearbyint(s->tank * cells) / cells;
  if (!mps && !s->rest && fabs(tank - s->tank) > 1e-6) {
    options_note("--tank is %.6g widths, taken as %.6g: whole cells", s->tank, tank);
    s->tank = tank;
  }
  const char *large = mpm_model_too_large(cells * cells * (double)(s->n2 * s->ppc));
  if (large) return options_refuse(program, large);
  if (s->method == METHOD_MPM && speed_of_sound(s) < 2.0 * sqrt(2.0 * G * column_height(s)))
    return options_refuse(program, "--sound-speed must be at least 2 (2 g n^2 a)^1/2, twice the "
                                   "speed of the water: it is to be all but incompressible");
  if (isnan(s->duration) && s->impact) s->duration = 7.0 * sqrt(0.5 * s->base / G);
  if (isnan(s->duration)) s->duration = 6.0 * sqrt(s->base / (G * (double)s->n2));
  return -1;
}

int main(int argc, char **argv) {
  static simulation sim = {.s = {.course = {.frames = 60}}};
  settings *s = &sim.s;
  option table[] = {
      OPTION_HEADING("Method"),
      OPTION_FLAG("paper", &s->paper, NULL),
      OPTION_CHOICE_OF(
          "method", "mpm|mps", &s->method,
          "WLS-MPM on a grid, weakly compressible; MPS, moving particles, incompressible: "
          "--spacing in place of --cell, and no other options of the grid"),
      OPTION_FLAG("impact", &s->impact, NULL),
      OPTION_HEADING("Water"),
      OPTION_NUMBER("width", &s->base, "a of the column (default .05715)", NAN),
      OPTION_INTEGER("n2", &s->n2, NULL, 2),
      OPTION_NUMBER("tank", &s->tank, NULL, 6.0),
      OPTION_NUMBER_IN("viscosity", OPTION_FROM_TO(0.0, 1e6), &s->viscosity, NULL, 1e-3),
      OPTION_NUMBER("sound-speed", &s->sound, NULL, NAN),
      OPTION_CHOICE_OF("equation-of-state", "tait|linear", &s->state, NULL,
                       MPS_MATERIAL_STATE_EQUATION_TAIT),
      OPTION_CHOICE_OF("negative-pressure", "none|full", &s->tension, NULL),
      OPTION_CHOICE_OF("bed", "slip|fixed", &s->bed, NULL),
      OPTION_NUMBER("friction-factor", &s->roughness, "of the bed, of --method mps", 0.0),
      OPTION_FLAG("still", &s->rest, NULL),
      OPTION_HEADING("Grid"),
      OPTION_NUMBER("cell", &s->h, "default width/40", NAN),
      OPTION_NUMBER("spacing", &s->h, "of --method mps; default width/20, with --impact width/60",
                    NAN),
      OPTION_INTEGER("ppc", &s->ppc, NULL, 4),
      OPTION_NUMBER("courant", &s->courant, NULL, 0.5),
      OPTION_CHOICE("spline", &s->spline, NULL, 1),
      MPM_METHOD_OPTIONS(&s->variant),
      OPTION_CHOICE("volumetric", &s->volumetric, NULL),
      OPTION_NUMBER("disturb", &s->disturb, "of MPS", 0.1),
      WAVES_SOLVER(&s->solver, &s->tolerance),
      OPTION_HEADING("Run"),
      OPTION_NUMBER("duration", &s->duration, "default T = 6", NAN),
      MPM_COURSE_OPTIONS(&s->course, SAMPLES),
      OPTIONS_OF_ALL(s),
      {0}};
  const options_program program = {"mps-dam-break",
                                   "A column of water collapses on a dry bed, by WLS-MPM (weakly "
                                   "compressible: Nakamura,\nFigure 2) or MPS, against the "
                                   "experiments of Martin and Moyce (1952).",
                                   table};
  int code = options_parse(&program, argc, argv);
  static const option_preset paper[] = {{"volumetric", "point"}, {0}};
  if (code < 0) code = mpm_method_settle(&program, &s->variant, s->paper, paper, 0.0);
  if (code < 0) code = check_needs(&program, s);
  if (code < 0) code = complete(&program, s);
  if (code >= 0) return code;
  const mpm_model_parts parts = {dam_build, dam_march, finish};
  const mpm_model_places places = {&s->out, &s->course.checkpoint, s->course.restart};
  code = mpm_model_run(&program, s->threads, &places, &sim.m, &parts, &sim);
  free(sim.gauge_t);
  free(sim.gauge_p);
  for (int k = 0; k < FRAMES; k++) mpm_snapshot_free(&sim.shot[k]);
  return code;
}
