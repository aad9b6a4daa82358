/* results.c - tables, summary and pictures of mps-tank, with theory.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "tank.h"

#include "common/area.h"
#include "common/compare.h"
#include "common/plot.h"
#include "common/series.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- figures of the run ---------------------------------------------------------------------- */

static bool in_window(const tank_model *m, int64_t k) {
  return m->sample[k].t >= m->s.window[0] - 1e-9 && m->sample[k].t <= m->s.window[1] + 1e-9;
}

/* Quantities with a harmonic, besides the gauges. */
enum { FORCE = -1, WALL = -2 };

static series series_of(const tank_model *m, const tank_sample *sample, int what) {
  const double *value = what >= 0       ? &sample->level[what]
                        : what == FORCE ? &sample->right
                                        : &sample->deflection;
  return (series){m->samples, sizeof *sample, &sample->t, value};
}

/* Amplitude of the first harmonic of the period in the window; NaN where that has less than one.
 * `phase` (rad, may be NULL): before sin(2 pi t/T). */
static double harmonic(const tank_model *m, const tank_sample *sample, int what, double *phase) {
  const series s = series_of(m, sample, what);
  const double from = fmax(m->s.window[0], sample->t);
  return series_harmonic(&s, m->s.period, from, m->s.window[1], phase);
}

typedef struct figures {
  double mean, deviation, least, most, period, decay, first, last, first_fall, last_fall,
      deflection;
} figures;

/* The oscillating quantity: the force on the right wall, or the structure. */
static double swings(const tank_model *m, int64_t k) {
  return tank_swings(&m->s) ? m->sample[k].deflection : m->sample[k].right;
}

/* Mean over the whole periods between two times (trapezium rule). */
static double mean_between(const tank_model *m, double first, double last) {
  double sum = 0.0, span = 0.0;
  for (int64_t k = 1; k < m->samples; k++) {
    const double t = m->sample[k - 1].t, dt = m->sample[k].t - t;
    if (t < first || m->sample[k].t > last) continue;
    sum += 0.5 * dt * (swings(m, k - 1) + swings(m, k)), span += dt;
  }
  return span > 0.0 ? sum / span : NAN;
}

/* Mean period and decay (1/s) of what oscillates about `mean`, from its rising zeros and from the
 * largest value between them. */
static void find_swing(const tank_model *m, double mean, figures *f) {
  double first = NAN, last = NAN, peak = 0.0, early = NAN, early_at = 0.0, late = NAN,
         late_at = 0.0;
  double peak_at = 0.0, first_fall = NAN, last_fall = NAN;
  int64_t zeros = 0;
  for (int64_t k = 1; k < m->samples; k++) {
    if (!in_window(m, k - 1) || !in_window(m, k)) continue;
    const tank_sample *p = &m->sample[k - 1], *q = &m->sample[k];
    const double a = swings(m, k - 1) - mean, b = swings(m, k) - mean;
    if (zeros > 0 && b > peak) peak = b, peak_at = q->t;
    if (a >= 0.0 && b < 0.0) {
      last_fall = p->t + (q->t - p->t) * a / (a - b);
      if (isnan(first_fall)) first_fall = last_fall;
    }
    if (!(a < 0.0 && b >= 0.0)) continue;
    last = p->t + (q->t - p->t) * a / (a - b);
    if (zeros == 0) first = last;
    if (zeros == 1) early = peak, early_at = peak_at;
    if (zeros > 1) late = peak, late_at = peak_at;
    zeros++;
    peak = 0.0;
  }
  f->first = first, f->last = last;
  f->first_fall = first_fall, f->last_fall = last_fall;
  f->period = zeros > 1 ? (last - first) / (double)(zeros - 1) : NAN;
  f->decay = late_at > early_at ? log(early / late) / (late_at - early_at) : NAN;
}

/* The structure oscillates about a mean that is known only over whole periods. Between rising zeros
 * a decaying oscillation shifts the mean by as much as between falling ones, with the opposite
 * sign. */
static void find_motion(const tank_model *m, figures *f) {
  f->deflection = mean_between(m, m->s.window[0], m->s.window[1]);
  for (int n = 0; n < 3; n++) {
    find_swing(m, f->deflection, f);
    if (isnan(f->period)) return;
    f->deflection =
        0.5 * (mean_between(m, f->first, f->last) + mean_between(m, f->first_fall, f->last_fall));
  }
}

static figures find_figures(const tank_model *m) {
  figures f = {.least = INFINITY, .most = -INFINITY};
  double sum = 0.0, square = 0.0, n = 0.0;
  for (int64_t k = 0; k < m->samples; k++) {
    if (!in_window(m, k)) continue;
    const double force = m->sample[k].right;
    sum += force, square += force * force, n += 1.0;
    f.least = fmin(f.least, force), f.most = fmax(f.most, force);
  }
  if (n == 0.0) return (figures){NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
  f.mean = sum / n;
  f.deviation = sqrt(fmax(square / n - f.mean * f.mean, 0.0));
  if (tank_swings(&m->s))
    find_motion(m, &f);
  else
    find_swing(m, f.mean, &f);
  return f;
}

/* ---- tables ---------------------------------------------------------------------------------- */

static int gauges_of(const tank_model *m) {
  int count = 0;
  while (count < TANK_GAUGES && !isnan(m->s.gauge[count])) count++;
  return count;
}

static bool write_force(app *a, const tank_model *m) {
  output f;
  if (!output_open(&f, a, m->s.out, "force.csv")) return false;
  csv_header(&f, "t_s,force_left_N,force_right_N,kinetic_J,potential_J");
  for (int64_t k = 0; k < m->samples; k++) {
    const tank_sample *p = &m->sample[k];
    const double row[] = {p->t, p->left, p->right, p->kinetic, p->potential};
    csv_row(&f, 5, row);
  }
  return output_close(&f);
}

static bool write_gauges(app *a, const tank_model *m) {
  const int gauges = gauges_of(m);
  char names[512] = "t_s";
  output f;
  for (int k = 0; k < gauges; k++) {
    const size_t at = strlen(names);
    snprintf(names + at, sizeof names - at, ",level_at_%g_m?", m->s.gauge[k]);
  }
  strncat(names, ",level_at_wall_m?", sizeof names - strlen(names) - 1);
  if (!output_open(&f, a, m->s.out, "gauges.csv")) return false;
  csv_header(&f, names);
  for (int64_t k = 0; k < m->samples; k++) {
    double row[TANK_GAUGES + 2] = {m->sample[k].t};
    for (int g = 0; g < gauges; g++) row[1 + g] = m->sample[k].level[g];
    row[1 + gauges] = m->sample[k].level[TANK_GAUGES];
    csv_row(&f, gauges + 2, row);
  }
  return output_close(&f);
}

static bool write_linear(app *a, const tank_model *m) {
  output f;
  if (!output_open(&f, a, m->s.out, "linear.csv")) return false;
  csv_header(&f, "t_s,force_right_N,level_at_wall_m");
  const double still = 0.5 * WAVES_DENSITY * WAVES_G * m->s.depth * m->s.depth;
  for (int64_t k = 0; k < m->samples; k++) {
    const tank_sample *p = &m->linear[k];
    const double row[] = {p->t, still + p->right, p->level[TANK_GAUGES]};
    csv_row(&f, 3, row);
  }
  return output_close(&f);
}

static bool write_drop(app *a, const tank_model *m) {
  output f;
  if (!output_open(&f, a, m->s.out, "drop.csv")) return false;
  csv_header(&f, "t_s,a_m,a_theory_m,b_m,b_theory_m,centre_Pa,centre_theory_Pa,kinetic_J");
  for (int64_t k = 0; k < m->samples; k++) {
    const tank_sample *p = &m->sample[k];
    double x, y, centre;
    tank_drop(m->s.depth, p->t, &x, &y, &centre);
    const double row[] = {p->t, p->a, x, p->b, y, p->centre, centre, p->kinetic};
    csv_row(&f, 8, row);
  }
  return output_close(&f);
}

static bool write_structure(app *a, const tank_model *m) {
  output f;
  if (!output_open(&f, a, m->s.out, "structure.csv")) return false;
  csv_header(&f, "t_s,deflection_m,deflection_linear_m?");
  for (int64_t k = 0; k < m->samples; k++) {
    const double row[] = {m->sample[k].t, m->sample[k].deflection,
                          m->linear ? m->linear[k].deflection : NAN};
    csv_row(&f, 3, row);
  }
  return output_close(&f);
}

static bool write_particles(app *a, tank_model *m) {
  mps_view x, u, p, surface;
  output f;
  if (!app_check(a, mps_particles_view(m->water, "position", &x)) ||
      !app_check(a, mps_particles_view(m->water, "velocity", &u)) ||
      !app_check(a, mps_particles_view(m->water, "pressure", &p)) ||
      !app_check(a, mps_particles_view(m->water, "free_surface", &surface)) ||
      !output_open(&f, a, m->s.out, "particles.csv"))
    return false;
  csv_header(&f, "x_m,y_m,vx_m_s,vy_m_s,pressure_Pa,surface");
  for (int64_t i = 0; i < x.shape[0]; i++) {
    const double row[] = {*mps_view_f64(&x, i, 0), *mps_view_f64(&x, i, 1),
                          *mps_view_f64(&u, i, 0), *mps_view_f64(&u, i, 1),
                          *mps_view_f64(&p, i, 0), (double)*mps_view_i64(&surface, i, 0)};
    csv_row(&f, 6, row);
  }
  return output_close(&f);
}

/* ---- pictures -------------------------------------------------------------------------------- */

/* Outline of the box where it is now. */
static void set_box(output *f, const tank_model *m) {
  const double x = 0.5 * m->s.width, y = m->s.draft;
  const double corner[4][2] = {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
  mps_body_state box;
  if (mps_body_get_state(m->box, &box) != MPS_OK) return;
  const double C = cos(box.rotation[2]), S = sin(box.rotation[2]);
  output_text(f, "cover(k) = 'set object 1 polygon from ");
  for (int k = 0; k <= 4; k++) {
    const double *c = corner[k % 4];
    output_text(f, "%s%.6g,%.6g", k ? " to " : "", box.position[0] + C * c[0] - S * c[1],
                box.position[1] + S * c[0] + C * c[1]);
  }
  output_text(f, " fillstyle solid 0.6 border linecolor rgb \"#444444\" fillcolor rgb "
                 "\"#c9b79c\"'\n");
}

/* water.bin: the pressure. */
static bool image_water(app *a, const tank_model *m, const area_def *def, area *image) {
  mps_view x, p;
  if (!app_check(a, mps_particles_view(m->water, "position", &x)) ||
      !app_check(a, mps_particles_view(m->water, "pressure", &p)))
    return false;
  double *row = malloc((size_t)(x.shape[0] + 1) * 3 * sizeof *row);
  if (!row) return app_no_memory(a);
  for (int64_t i = 0; i < x.shape[0]; i++) {
    row[3 * i] = *mps_view_f64(&x, i, 0);
    row[3 * i + 1] = *mps_view_f64(&x, i, 1);
    row[3 * i + 2] = *mps_view_f64(&p, i, 0);
  }
  const bool good = area_image(a, m->s.out, "water.bin", def, x.shape[0], row, image);
  free(row);
  return good;
}

static bool draw_water(app *a, const tank_model *m) {
  const tank_settings *s = &m->s;
  const bool drop = s->kind == TANK_DROP;
  const double width =
      drop ? 5.0 * s->depth : s->length + 2.0 * fabs(s->amplitude) + 2.0 * s->spacing;
  const double over = s->kind == TANK_FLOAT ? 1.2 * s->draft : 0.0;
  const double high =
      drop ? 5.0 * s->depth
           : (tank_swings(s) ? 1.1 : 1.6) * s->depth + over + 4.0 * fabs(s->amplitude);
  const double left = drop ? -2.5 * s->depth : -fabs(s->amplitude) - s->spacing;
  const double low = drop ? left : -s->spacing;
  const area_def def = {.spacing = s->spacing,
                        .slit = AREA_SLIT,
                        .lower = {left, low},
                        .upper = {left + width, drop ? low + high : high},
                        .side = AREA_SIDE,
                        .factor = 1e-3};
  area image;
  output f;
  if (!image_water(a, m, &def, &image) || !plot_begin(&f, a, s->out, "water")) return false;
  area_set(&f, "water.bin", &def, 1, &image, 1.0);
  output_text(
      &f,
      "titles[1] = 'water at t = %.3f s, %lld particles'; x_name = 'x (m)'; y_name = 'y (m)'\n"
      "cb_name = 'pressure (kPa)'; palette = 'water'; cb_least = cb_lowest; cb_most = "
      "cb_highest\n",
      m->samples ? m->sample[m->samples - 1].t : 0.0, (long long)mps_particles_count(m->water));
  if (s->kind == TANK_FLOAT) set_box(&f, m);
  return plot_end(&f, s->out, "water", "maps");
}

/* The classical scheme has no levels. */
static bool draw_force(app *a, const tank_model *m) {
  const tank_settings *s = &m->s;
  const int gauges = s->scheme == 1 ? 0 : gauges_of(m) + 1;
  output f;
  if (!plot_begin(&f, a, s->out, "force")) return false;
  output_text(&f,
              "end = %.9g; still = %.9g; linear = %d; gauges = %d; noise = %.6g\narray "
              "names[gauges + 1]\n",
              s->duration, 0.5 * WAVES_DENSITY * WAVES_G * s->depth * s->depth, m->linear != NULL,
              gauges, 10.0 * s->spacing); /* mm: noise at rest stays small */
  for (int k = 0; k < gauges - 1; k++)
    output_text(&f, "names[%d] = 'x = %g m'\n", k + 1, s->gauge[k]);
  if (gauges > 0) output_text(&f, "names[gauges] = 'at the right wall'\n");
  return plot_end(&f, s->out, "force", "tank/force");
}

static bool draw_structure(app *a, const tank_model *m) {
  const bool plate = m->s.kind == TANK_PLATE, box = m->s.kind == TANK_FLOAT;
  const double unit = plate ? 1e6 : 1e3;
  return plot_draw(a, m->s.out, "structure", "tank/structure",
                   "first = '%s'; y_name = '%s'; end = %.9g; unit = %g; linear = %d\namplitude = "
                   "%.9g; omega = %.9g; rest = %.9g",
                   plate ? "Middle of the plate"
                   : box ? "Heave of the box"
                         : "Wall on a spring",
                   plate ? "deflection (10^{-6} m)" : "displacement (mm)", m->s.duration, unit,
                   m->linear != NULL, box ? m->s.amplitude : NAN,
                   box ? 2.0 * WAVES_PI / tank_float_period(&m->s) : 0.0,
                   box     ? NAN
                   : plate ? unit * tank_plate_deflection(&m->s)
                           : 0.0);
}

/* ---- theory ---------------------------------------------------------------------------------- */

#define STEEP                                                                                      \
  0.2 /* k a: amplitudes of waves up to which linear theory holds within some percent              \
       */
#define SHALLOW 0.2   /* of the depth */
#define CREEPING 1e-2 /* nu k^2/omega: waves that viscosity damps within some periods */
#define UPRIGHT 0.05  /* rad */
#define THIN 0.3      /* of a plate's thickness: deflections without tension */

/* Unknown where the run has too few periods. */
static void print_decay(double decay) {
  if (!isnan(decay)) printf(", decay %.3f 1/s", decay);
}

/* Largest |deflection| of the run, m. */
static double most_deflection(const tank_model *m) {
  double most = 0.0;
  for (int64_t k = 0; k < m->samples; k++) most = fmax(most, fabs(m->sample[k].deflection));
  return most;
}

/* Small motion (amplitude a at wave number k) of water without viscosity. */
static comparison compare_linear(const tank_model *m, const char *source, double value,
                                 double reference, double a, double k) {
  const tank_settings *s = &m->s;
  const double omega = sqrt(WAVES_G * k * tanh(k * s->depth)), nu = s->viscosity / WAVES_DENSITY;
  comparison c = compare_with(source, value, reference);
  compare_require(&c, isfinite(a), "the window has no whole period of the run");
  compare_require(&c, a <= SHALLOW * s->depth,
                  "it is of small motion, and the amplitude is %.2g of the depth", a / s->depth);
  compare_require(&c, k * a <= STEEP,
                  "it is of small motion, and the steepness k a of these waves is %.2g", k * a);
  compare_require(&c, nu * k * k <= CREEPING * omega,
                  "it is of water without viscosity, and nu k^2 is %.2g times the frequency",
                  nu * k * k / omega);
  return c;
}

/* ---- summary --------------------------------------------------------------------------------- */

static void summarise_waves(output *f, const tank_model *m, const figures *g) {
  const tank_settings *s = &m->s;
  const double k = waves_number(s->period, s->depth);
  const double havelock = 2.0 * s->amplitude * waves_havelock(k, s->depth);
  const double H = harmonic(m, m->sample, TANK_GAUGES, NULL);
  const double gauge = gauges_of(m) ? 2.0 * harmonic(m, m->sample, 0, NULL) : NAN;
  const double wall = harmonic(m, m->linear, TANK_GAUGES, NULL);
  const comparison level =
      compare_linear(m, "linear potential flow", gauge,
                     gauges_of(m) ? 2.0 * harmonic(m, m->linear, 0, NULL) : NAN, 0.5 * wall, k);
  json_number(f, "wave_number", k);
  json_number(f, "havelock_height", havelock);
  json_number(f, "gauge_height", gauge);
  json_comparison(f, "gauge_height_linear", &level);
  json_number(f, "wall_harmonic", H);
  const bool linear = !level.reason[0];
  json_number_if(f, linear, "wall_harmonic_linear", wall);
  json_number(f, "force_harmonic", harmonic(m, m->sample, FORCE, NULL));
  json_number_if(f, linear, "force_harmonic_linear", harmonic(m, m->linear, FORCE, NULL));
  json_number(f, "crest_force", g->most);
  json_number(f, "trough_force", g->least);
  json_number(f, "sainflou_crest", isnan(H) ? NAN : waves_sainflou(k, s->depth, H, 1));
  json_number(f, "sainflou_trough", isnan(H) ? NAN : waves_sainflou(k, s->depth, H, -1));
  if (!isnan(gauge)) printf("wave height at the gauge %.4f m", gauge);
  if (!isnan(gauge) && compare_holds(&level))
    printf(", linear potential flow in this tank %.4f m, Havelock for an endless flume %.4f m",
           level.reference, havelock);
  if (!isnan(gauge)) printf("\n");
  if (level.reason[0]) compare_tell(&level);
  if (!isnan(H) && !isnan(g->most))
    printf("force on the wall: crest %.1f N, Sainflou %.1f N; trough %.1f N, Sainflou %.1f N\n",
           g->most, waves_sainflou(k, s->depth, H, 1), g->least,
           waves_sainflou(k, s->depth, H, -1));
}

static double degrees(double angle) { return 180.0 / WAVES_PI * remainder(angle, 2.0 * WAVES_PI); }

/* Phases are those behind the piston, of motions away from the water. */
static void summarise_resonance(output *f, const tank_model *m) {
  const tank_settings *s = &m->s;
  mps_coupling_report report;
  tank_response flume;
  double phase, linear;
  const double wall = harmonic(m, m->sample, WALL, &phase);
  const double exact = harmonic(m, m->linear, WALL, &linear);
  tank_flume(s, &flume);
  if (mps_coupling_get_report(m->structure.coupling, &report) == MPS_OK)
    json_number(f, "solutions_a_step",
                (double)report.all_repeats / fmax((double)report.steps, 1.0));
  json_number(f, "frequency_ratio", flume.ratio);
  json_number(f, "stiffness", s->stiffness);
  json_number(f, "added_mass", flume.added_mass);
  json_number(f, "radiation_damping", flume.damping);
  comparison c = compare_linear(m, "linear potential flow", wall, exact, fmax(wall, s->amplitude),
                                waves_number(s->period, s->depth));
  json_number(f, "deflection", wall);
  json_comparison(f, "deflection_exact", &c);
  json_number(f, "deflection_flume", flume.amplitude);
  json_number(f, "phase", degrees(WAVES_PI - phase));
  json_number_if(f, compare_holds(&c), "phase_exact", degrees(WAVES_PI - linear));
  json_number(f, "lag_flume", degrees(flume.lag));
  if (isnan(wall)) return;
  printf("wall %.3f mm", 1e3 * wall);
  if (compare_holds(&c))
    printf(
        ", linear potential flow in this tank %.3f mm (%+.2f %%), phase %+.1f degrees from it; in "
        "an endless flume %.3f mm",
        1e3 * exact, 100.0 * compare_error(&c), degrees(phase - linear), 1e3 * flume.amplitude);
  printf("\n");
  compare_tell(&c);
}

static void summarise_structure(output *f, const tank_model *m, const figures *g) {
  const tank_settings *s = &m->s;
  const bool plate = s->kind == TANK_PLATE;
  const double exact = plate ? tank_plate_omega(s) : tank_spring_omega(s);
  mps_coupling_report report;
  if (mps_coupling_get_report(m->structure.coupling, &report) == MPS_OK)
    json_number(f, "solutions_a_step",
                (double)report.all_repeats / fmax((double)report.steps, 1.0));
  const double most = most_deflection(m), size = plate ? s->plate_thickness : s->depth;
  const double small = plate ? THIN : SHALLOW;
  comparison omega = compare_with("potential flow", 2.0 * WAVES_PI / g->period, exact);
  comparison rest = compare_with("a plate at rest", g->deflection, tank_plate_deflection(s));
  comparison *const both[] = {&omega, &rest};
  for (int k = 0; k < 2; k++)
    compare_require(both[k], most <= small * size,
                    "it is of small motion, and the %s moves by %.2g of %s",
                    plate ? "plate" : "wall", most / size, plate ? "its thickness" : "the depth");
  json_number(f, "omega", 2.0 * WAVES_PI / g->period);
  json_comparison(f, "omega_exact", &omega);
  json_number(f, "decay", g->decay);
  json_number(f, "deflection", g->deflection);
  if (plate)
    json_comparison(f, "deflection_exact", &rest);
  else
    json_number(f, "deflection_exact", 0.0);
  if (!isnan(g->period)) {
    printf("omega %.3f rad/s", 2.0 * WAVES_PI / g->period);
    if (compare_holds(&omega))
      printf(", potential flow %.3f (%+.2f %%)", exact, 100.0 * compare_error(&omega));
    print_decay(g->decay);
    putchar('\n');
  }
  if (plate && !isnan(g->deflection) && compare_holds(&rest))
    printf("mean deflection %.4g m, at rest %.4g m (%+.2f %%)\n", g->deflection,
           tank_plate_deflection(s), 100.0 * compare_error(&rest));
  compare_tell(&omega);
}

static void summarise_box(output *f, const tank_model *m, const figures *g) {
  const double exact = tank_float_period(&m->s);
  comparison c = compare_with("potential flow", g->period, exact);
  compare_require(&c, m->roll <= UPRIGHT,
                  "it is of a box that stays upright, and this one rolls by up to %.1f degrees",
                  degrees(m->roll));
  compare_require(&c, m->s.amplitude <= SHALLOW * m->s.draft,
                  "it is of small motion, and the box is let go %.2g of its draft from rest",
                  m->s.amplitude / m->s.draft);
  json_number(f, "period", g->period);
  json_comparison(f, "period_exact", &c);
  json_number(f, "decay", g->decay);
  json_number(f, "deflection", g->deflection);
  json_number(f, "deflection_exact", 0.0 - m->s.amplitude);
  json_number(f, "roll_max", m->roll);
  if (!isnan(g->period)) {
    printf("heave: period %.4f s", g->period);
    if (compare_holds(&c))
      printf(", potential flow %.4f s (%+.2f %%)", exact, 100.0 * compare_error(&c));
    print_decay(g->decay);
    printf("; mean %.3f mm, at rest %.3f mm\n", 1e3 * g->deflection, -1e3 * m->s.amplitude);
  }
  compare_tell(&c);
}

/* The largest relative difference of the pressure in the middle, but of the first samples: the
 * first steps find a pressure that is not there yet. */
static double drop_error(const tank_model *m) {
  double most = 0.0;
  for (int64_t k = 0; k < m->samples; k++) {
    double a, b, centre;
    if (m->sample[k].t < 0.02 * m->s.duration) continue;
    tank_drop(m->s.depth, m->sample[k].t, &a, &b, &centre);
    most = fmax(most, fabs(m->sample[k].centre / centre - 1.0));
  }
  return most;
}

static void summarise_drop(output *f, const tank_model *m) {
  const tank_sample *last = &m->sample[m->samples - 1];
  double a, b, centre;
  tank_drop(m->s.depth, last->t, &a, &b, &centre);
  const double nu = m->s.viscosity / WAVES_DENSITY;
  const double creep = nu / (m->s.depth * m->s.depth); /* over the rate of 1/s */
  comparison c = compare_with("a drop without viscosity", last->a, a);
  compare_require(&c, creep <= CREEPING, "nu over the square of the radius is %.2g times its rate",
                  creep);
  const bool holds = compare_holds(&c);
  json_number(f, "a", last->a);
  json_comparison(f, "a_exact", &c);
  json_number(f, "b", last->b);
  json_number_if(f, holds, "b_exact", b);
  json_number(f, "p_c", last->centre);
  json_number_if(f, holds, "p_c_exact", centre);
  json_number_if(f, holds, "p_c_error_max", drop_error(m));
  printf("semi-axes %.4f and %.4f m", last->a, last->b);
  if (holds)
    printf(", theory %.4f and %.4f m; pressure in the middle within %.1f %%", a, b,
           100.0 * drop_error(m));
  printf("\n");
  compare_tell(&c);
}

/* 1/s. Crests of the force also hold its second harmonic, which oscillates with another mode: two
 * of them may differ by ten times the decay of a few periods. */
static double sloshing_decay(const tank_model *m, double period) {
  const series kinetic = {m->samples, sizeof *m->sample, &m->sample->t, &m->sample->kinetic};
  const double from = fmax(m->s.window[0], m->sample[0].t);
  const double to = fmin(m->s.window[1], m->sample[m->samples - 1].t);
  return isnan(period) ? NAN : series_wave_decay(&kinetic, period, from, to);
}

static void summarise_tank(output *f, const tank_model *m) {
  const tank_settings *s = &m->s;
  const figures g = find_figures(m);
  const double still = 0.5 * WAVES_DENSITY * WAVES_G * s->depth * s->depth;
  json_number(f, "force_mean", g.mean);
  json_number(f, "force_std", g.deviation);
  json_number(f, "force_still", still);
  if (s->kind == TANK_STILL && !isnan(g.mean))
    printf(
        "force on the right wall: mean %.3f N, rho g d^2/2 is %.3f N; standard deviation %.3f N\n",
        g.mean, still, g.deviation);
  if (s->kind == TANK_SLOSHING) {
    const double exact = waves_sloshing_period(s->length, s->depth);
    const double decay = sloshing_decay(m, g.period);
    const comparison c =
        compare_linear(m, "linear theory", g.period, exact, s->amplitude, WAVES_PI / s->length);
    json_number(f, "period", g.period);
    json_comparison(f, "period_exact", &c);
    json_number(f, "decay", decay);
    if (!isnan(g.period)) printf("period %.5f s", g.period);
    if (!isnan(g.period) && compare_holds(&c))
      printf(", theory %.5f s (%+.2f %%)", exact, 100.0 * compare_error(&c));
    if (!isnan(g.period)) printf("\n");
    compare_tell(&c);
    if (!isnan(decay)) printf("the amplitude decays with %.4f 1/s\n", decay);
  }
  if (s->kind == TANK_FLOAT) summarise_box(f, m, &g);
  if (s->kind == TANK_PISTON) summarise_waves(f, m, &g);
  if (s->kind == TANK_RESONANCE)
    summarise_resonance(f, m);
  else if (tank_is_coupled(s))
    summarise_structure(f, m, &g);
}

static bool write_summary(app *a, const tank_model *m) {
  output f;
  if (!summary_open(&f, a, m->s.out)) return false;
  json_integer(&f, "particles", mps_particles_count(m->water));
  json_integer(&f, "steps", mps_fluid_steps(m->fluid));
  json_number(&f, "time", mps_fluid_time(m->fluid));
  if (m->s.kind == TANK_DROP)
    summarise_drop(&f, m);
  else
    summarise_tank(&f, m);
  json_integer(&f, "collisions", m->report.collisions);
  json_integer(&f, "limited", m->report.limited);
  json_integer(&f, "pushed", m->report.pushed);
  json_number(&f, "iterations_a_step",
              (double)m->report.all_iterations / (double)mps_fluid_steps(m->fluid));
  json_end(&f);
  return output_close(&f);
}

static bool find_linear(app *a, tank_model *m) {
  if (m->s.kind != TANK_RESONANCE && m->s.kind != TANK_PISTON) return true;
  m->linear = calloc((size_t)m->samples, sizeof *m->linear);
  if (!m->linear) return app_no_memory(a);
  return app_check(a, tank_linear(&m->s, m->samples, m->sample, m->linear));
}

bool tank_write(app *a, tank_model *m) {
  const bool drop = m->s.kind == TANK_DROP;
  tank_warn(a, m);
  if (!find_linear(a, m)) return false;
  if (drop ? !write_drop(a, m) : !write_force(a, m) || !write_gauges(a, m)) return false;
  if (tank_swings(&m->s) && !write_structure(a, m)) return false;
  if (m->linear && !write_linear(a, m)) return false;
  if (m->series && !app_check(a, mps_recorder_close(&m->series))) return false;
  if (!write_particles(a, m) || !write_summary(a, m) || !draw_water(a, m) ||
      (!drop && !draw_force(a, m)) || (tank_swings(&m->s) && !draw_structure(a, m)) ||
      !tank_write_density(a, m))
    return false;
  app_tell_results(a, m->s.out);
  return true;
}
