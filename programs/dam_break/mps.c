/* mps.c - the collapse of a column by moving particles (mps_fluid), and its impact on a far wall:
 * Buchner's case, a column H high and 2 H wide in a tank of 5.366 H, with a gauge on the wall.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dam_break.h"

#include "common/plot.h"
#include "common/waves.h"

#include <stdio.h>
#include <stdlib.h>

#define GAUGE 0.2 /* H: height of the gauge, where Greco (2001) puts Buchner's */
#define MEAN 0.05 /* (H/g)^1/2: half the interval of means */
#define RISE 0.05 /* rho g H: the pressure that the water arrives with */

enum { BED = 0, LEFT, FAR_WALL };

/* ---- water ----------------------------------------------------------------------------------- */

static double far_wall(const settings *s) { return (s->rest ? 1.0 : s->tank) * s->base; }

static mps_status add_wall(mps_fluid *fluid, double x, double nx, double ny, double friction) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.point[0] = x;
  def.normal[0] = nx, def.normal[1] = ny;
  def.friction_factor = friction;
  return mps_fluid_add_boundary(fluid, &def, NULL);
}

/* Mass and volume are constant: the heap is measured by them. */
mps_status dam_mps_build(mps_context *context, simulation *sim) {
  const settings *s = &sim->s;
  const double lo[2] = {0.0, 0.0}, hi[2] = {s->base, column_height(s)};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  set.spacing = s->h;
  def.density = DENSITY, def.viscosity = s->viscosity;
  def.gravity[1] = -G;
  def.tolerance = s->tolerance;
  mps_status status = mps_particles_create(context, &set, &sim->m.particles);
  mps_particles *water = sim->m.particles;
  if (status == MPS_OK) status = mps_particles_fill_box(water, lo, hi, NULL);
  /* A lattice stays one when it is stretched along the bed: particles in columns ever closer, and
   * none is displaced sideways, by symmetry. */
  if (status == MPS_OK) status = waves_disturb(water, s->disturb * s->h, 1);
  if (status == MPS_OK) status = mps_particles_set(water, "mass", 0, DENSITY * s->h * s->h);
  if (status == MPS_OK) status = mps_particles_set(water, "volume", 0, s->h * s->h);
  def.domain = sim->m.a->domain;
  status = app_settle(sim->m.a, status);
  if (status == MPS_OK) status = mps_fluid_create(context, water, &def, &sim->m.fluid);
  if (status == MPS_OK &&
      !waves_choose_solver(sim->m.a, s->solver, sim->m.fluid, sim->m.why, sizeof sim->m.why))
    return MPS_ERROR_UNSUPPORTED;
  if (status == MPS_OK) status = add_wall(sim->m.fluid, 0.0, 0.0, 1.0, s->roughness);
  if (status == MPS_OK) status = add_wall(sim->m.fluid, 0.0, 1.0, 0.0, 0.0);
  return status == MPS_OK ? add_wall(sim->m.fluid, far_wall(s), -1.0, 0.0, 0.0) : status;
}

/* ---- the run --------------------------------------------------------------------------------- */

bool dam_grow_gauge(simulation *sim) {
  const int64_t room = 2 * sim->gauge_room + 1024;
  double *times = realloc(sim->gauge_t, (size_t)room * sizeof *times);
  if (times) sim->gauge_t = times;
  double *values = realloc(sim->gauge_p, (size_t)room * sizeof *values);
  if (values) sim->gauge_p = values;
  if (!times || !values) return false;
  sim->gauge_room = room;
  return true;
}

static mps_status read_gauge(simulation *sim) {
  const settings *s = &sim->s;
  const double at[3] = {far_wall(s), GAUGE * column_height(s), 0.0};
  mps_status status = MPS_OK;
  if (sim->gauges == sim->gauge_room)
    status = app_settle(sim->m.a, dam_grow_gauge(sim) ? MPS_OK : MPS_ERROR_MEMORY);
  if (status != MPS_OK) return status;
  sim->gauge_t[sim->gauges] = mps_fluid_time(sim->m.fluid);
  status = mps_fluid_get_pressure(sim->m.fluid, FAR_WALL, 1, at, &sim->gauge_p[sim->gauges]);
  if (status == MPS_OK) sim->gauges++;
  return status;
}

/* No step is shortened to end at t: a change of the step from one to the next shows in the
 * pressure. The first one shows the pressures at the start.
 */
mps_status dam_mps_advance(simulation *sim, double t) {
  const double until = t > 0.0 ? t * (1.0 - 1e-9) : 1e-12;
  mps_status status = MPS_OK;
  while (status == MPS_OK && mps_fluid_time(sim->m.fluid) < until) {
    status = mps_fluid_step(sim->m.fluid, 1);
    if (status == MPS_OK && sim->s.impact) status = read_gauge(sim);
    progress_draw(&sim->m.a->bar, mps_fluid_time(sim->m.fluid) / sim->s.duration, "water");
    if (progress_interrupted() && status == MPS_OK && !sim->m.a->domain)
      status = MPS_ERROR_CANCELLED;
  }
  return status;
}

/* ---- impact ---------------------------------------------------------------------------------- */

/* Of the gauge, times in (H/g)^1/2 and pressures in rho g H; maxima are of means over .1. */
typedef struct impact {
  double rise, first, first_at, mean, second, second_at;
} impact;

/* The first value of the gauge at the time `from` or later: they are in order of time. */
static int64_t first_from(const simulation *sim, double from) {
  int64_t low = 0, high = sim->gauges;
  while (low < high) {
    const int64_t middle = low + (high - low) / 2;
    if (sim->gauge_t[middle] < from)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Mean of the pressure over the times from..to; each value is that of the step before it. */
static double mean_between(const simulation *sim, double from, double to) {
  double sum = 0.0, span = 0.0;
  const int64_t first = first_from(sim, from);
  for (int64_t k = first > 1 ? first : 1; k < sim->gauges && sim->gauge_t[k] <= to; k++) {
    const double dt = sim->gauge_t[k] - sim->gauge_t[k - 1];
    sum += dt * sim->gauge_p[k], span += dt;
  }
  return span > 0.0 ? sum / span : NAN;
}

static impact find_impact(const simulation *sim) {
  const double H = column_height(&sim->s), unit = DENSITY * G * H, clock = sqrt(G / H);
  impact i = {NAN, 0.0, NAN, mean_between(sim, 3.3 / clock, 4.9 / clock) / unit, 0.0, NAN};
  for (int64_t k = 0; k < sim->gauges; k++) {
    const double t = sim->gauge_t[k] * clock;
    const double p = mean_between(sim, (t - MEAN) / clock, (t + MEAN) / clock) / unit;
    if (isnan(i.rise) && sim->gauge_p[k] > RISE * unit) i.rise = t;
    if (t < 3.3 && p > i.first) i.first = p, i.first_at = t;
    if (t > 5.0 && p > i.second) i.second = p, i.second_at = t;
  }
  return i;
}

static bool write_gauge(app *a, const simulation *sim) {
  const double H = column_height(&sim->s), unit = DENSITY * G * H, clock = sqrt(G / H);
  output f;
  if (!csv_open(&f, a, sim->s.out, "pressure.csv",
                "t_s,t_scaled,pressure_Pa,pressure_scaled,mean_scaled?"))
    return false;
  for (int64_t k = 0; k < sim->gauges; k++) {
    const double t = sim->gauge_t[k], p = sim->gauge_p[k];
    const double mean = mean_between(sim, t - MEAN / clock, t + MEAN / clock) / unit;
    CSV_LINE(&f, t, t * clock, p, p / unit, mean);
  }
  return output_close(&f);
}

static bool draw_gauge(app *a, const settings *s) {
  const double H = column_height(s);
  return plot_draw(a, s->out, "pressure", "dam-break/pressure", "spacing = %.9g; end = %.9g",
                   s->h / H, s->duration * sqrt(G / H));
}

bool dam_guards_write(app *a, const simulation *sim, output *f) {
  mps_fluid_report report;
  if (!app_check(a, mps_fluid_get_report(sim->m.fluid, &report))) return false;
  json_integer(f, "collisions", report.collisions);
  json_integer(f, "limited", report.limited);
  json_integer(f, "pushed", report.pushed);
  return true;
}

bool dam_impact_write(app *a, simulation *sim) {
  const impact i = find_impact(sim);
  output f;
  if (!write_gauge(a, sim) || !mpm_model_summary(a, &sim->m, sim->s.out, &f)) return false;
  JSON_NUMBERS(&f, {"impact_mean", i.mean}, {"impact_mean_buchner", 0.545}, {"impact_rise", i.rise},
               {"impact_first", i.first}, {"impact_first_time", i.first_at},
               {"impact_second", i.second}, {"impact_second_time", i.second_at});
  if (!dam_guards_write(a, sim, &f)) return false;
  json_end(&f);
  if (!output_close(&f) || !draw_gauge(a, &sim->s)) return false;
  app_tell_results(a, sim->s.out);
  if (!isnan(i.mean))
    printf("gauge: mean p/(rho g H) %.3f, Buchner .545 (%+.1f %%); the water arrives at %.2f, "
           "first maximum %.2f\n",
           i.mean, 100.0 * (i.mean / 0.545 - 1.0), i.rise, i.first);
  return true;
}
