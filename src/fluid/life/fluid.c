/* fluid.c - the fluid solver as an object: definition, creation, boundaries, queries.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/base/access.h"
#include "fluid/boundary/walls.h"
#include "fluid/life/state.h"
#include "fluid/reading/probe.h"
#include "fluid/step/step.h"
#include "fluid/life/properties.h"
#include "fluid/particles/holder.h"
#include "fluid/particles/look.h"
#include "fluid/step/exchange.h"
#include "fluid/boundary/polyline.h"
#include "fluid/particles/rock.h"
#include "fluid/pressure/coarse.h"
#include "fluid/base/loops.h"
#include "fluid/ranks/partition.h"
#include "core/definition/digits.h"
#include "solver/linear.h"

#include <mps/body.h>
#include <mps/experimental/domain.h>

#include <string.h>

/* ---- checks ---------------------------------------------------------------------------------- */

static bool within(double value, double low, double high) { return value >= low && value <= high; }

static mps_status check_def(mps_context *context, const mps_fluid_def *d, double l0) {
  static const char function[] = "mps_fluid_create";
  const double g = hypot(d->gravity[0], d->gravity[1]);
  const double longest = g > 0.0 ? 0.5 * sqrt(l0 / g) : INFINITY;
  if (!within(d->density, 1e-3, 1e6))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "density is %s kg/m3, must be in 0.001 to 1e6",
                     mpsi_outside(d->density, 1e-3, 1e6).text);
  if (!(g <= 1e6))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "gravity is (%g, %g) m/s2, must be at most 1e6 long", d->gravity[0],
                     d->gravity[1]);
  if (!isnan(d->dt) && d->dt > longest)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "dt is %g s, must be at most %g s, half of (l0/g)^1/2, or NaN", d->dt,
                     longest);
  return mpsi_fluid_check_viscosity(context, function, d->viscosity);
}

/* The radius is that of the kernel, if given. */
static mps_status read_kernel(mps_context *context, mps_fluid_def *d, double l0) {
  if (!d->kernel) return MPS_OK;
  if (mps_kernel_get_kind(d->kernel) != MPS_KERNEL_SMOOTH)
    return mpsi_fail(context, "mps_fluid_create", MPS_ERROR_ARGUMENT,
                     "kernel: its kind is %s, and that of a fluid must be MPS_KERNEL_SMOOTH",
                     mpsi_name_of("mps_kernel_kind", mps_kernel_get_kind(d->kernel)).text);
  d->radius_ratio = mps_kernel_radius(d->kernel) / l0;
  if (!within(d->radius_ratio, 2.6, 4.0))
    return mpsi_fail(context, "mps_fluid_create", MPS_ERROR_ARGUMENT,
                     "kernel of the fluid has a radius of %g m, must be 2.6 to 4 spacings of %g m",
                     mps_kernel_radius(d->kernel), l0);
  return MPS_OK;
}

static mps_status check_particles(mps_context *context, mps_particles *particles) {
  static const char *const function = "mps_fluid_create";
  const int64_t n = mps_particles_count(particles);
  if (mps_particles_dim(particles) != 2)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "the particle set has dim %d: the fluid is in the plane, dim 2",
                     mps_particles_dim(particles));
  if (n < 1 || n > MPSI_FLUID_MOST_PARTICLES)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the particle set has %lld particles, allowed are 1 to %d", (long long)n,
                     MPSI_FLUID_MOST_PARTICLES);
  static const char *const names[] = {"position", "velocity"};
  for (int f = 0; f < 2; f++)
    for (int c = 0; c < 2; c++) {
      const double *value = mpsi_particles_column(particles, names[f], c);
      for (int64_t i = 0; value && i < n; i++)
        if (!(fabs(value[i]) <= 1e12))
          return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                           "particles: %s of particle %lld is %g, must be finite and at most 1e12",
                           names[f], (long long)mpsi_particles_integers(particles, "id")[i],
                           value[i]);
    }
  return MPS_OK;
}

/* ---- creation -------------------------------------------------------------------------------- */

static void set_gravity(mps_fluid *f) {
  const double *gravity = f->def.gravity;
  f->g = hypot(gravity[0], gravity[1]);
  f->up[0] = f->g > 0.0 ? -gravity[0] / f->g : 0.0;
  f->up[1] = f->g > 0.0 ? -gravity[1] / f->g : 1.0;
  const double *x = mpsi_particles_column(f->particles, "position", 0);
  const double *y = mpsi_particles_column(f->particles, "position", 1);
  double low = INFINITY, top = -INFINITY;
  for (int64_t i = 0; i < f->count; i++) {
    const double height = f->up[0] * x[i] + f->up[1] * y[i];
    low = fmin(low, height), top = fmax(top, height + 0.5 * f->l0);
  }
  f->level = isnan(f->def.level) ? top : f->def.level;
  f->rest = f->level >= low && f->level <= top + 0.5 * f->l0 ? f->level : top;
}

/* q before the first step, as of water at rest: 0 where the level is the water's. With 0 and a
 * level of another datum all water was under pressure, or none (in_wake), and the first steps
 * differed. */
static void guess_pressure(mps_fluid *f) {
  double *q = mpsi_particles_column(f->particles, "reduced_pressure", 0);
  double *old = mpsi_particles_column(f->particles, "reduced_pressure_old", 0);
  if (f->rest == f->level) return;
  for (int64_t i = 0; i < f->count; i++)
    if (q[i] != 0.0 || old[i] != 0.0) return; /* of a fluid before */
  for (int64_t i = 0; i < f->count; i++)
    q[i] = old[i] = f->def.density * f->g * (f->rest - f->level);
}

static mps_status add_fields(mps_particles *particles) {
  static const char *const names[] = {"velocity",         "pressure",
                                      "reduced_pressure", "reduced_pressure_old",
                                      "free_surface",     "surface_rise"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    MPSI_TRY(mps_particles_add_field(particles, names[k], 0));
  return MPS_OK;
}

static void destroy(void *solver) {
  mps_fluid *f = solver;
  mps_context *context = f->context;
  mpsi_fluid_free_outside(f);
  mpsi_free(context, f->push_room.item);
  mpsi_fluid_drop_exchange(f);
  mpsi_fluid_partition_destroy(f);
  mpsi_fluid_coarse_drop(f);
  MPSI_FREE(context, f->slab, f->local, f->state, f->cloud, f->index_room.item, f->w_room.item,
            f->crowd_room.item, f->fit_room.item, f->lower_col_room.item, f->lower_room.item,
            f->near_wall_room.item, f->segment_room.item, f->path_room.item, f->box_room.item,
            f->near_line_room.item, f->wedge_room.item, f->clip_room.item);
  for (int b = f->bodies - 1; b >= 0; b--) mpsi_fluid_drop_body(f, &f->body[b]);
  for (int b = 0; b < f->walls; b++) mpsi_fluid_drop_wall(f, &f->wall[b]);
  MPSI_FREE(context, f->wall_room.item, f->body_room.item);
  mpsi_fluid_drop_lines(f);
  mpsi_fluid_drop_rocks(f);
  mps_kernel_destroy(&f->def.kernel);
}

/* ---- as one of all solvers ------------------------------------------------------------------- */

static double time_of(const void *solver) { return ((const mps_fluid *)solver)->time; }
static int64_t steps_of(const void *solver) { return ((const mps_fluid *)solver)->steps; }

static mps_status agree(void *solver, const char *function, mps_status status) {
  return mpsi_fluid_agree(solver, function, status);
}

static mps_status use_dt(void *solver, const char *function, double dt) {
  ((mps_fluid *)solver)->def.dt = dt;
  return MPS_OK;
}

static mps_status get_totals(void *solver, const char *function, mps_totals *out) {
  const mps_fluid *f = solver;
  MPSI_TRY(mpsi_particles_committed(f->particles, function));
  const double volume = f->l0 * f->l0 * f->def.measure, mass = f->def.density * volume;
  const double *x = mpsi_particles_column(f->particles, "position", 0);
  const double *y = mpsi_particles_column(f->particles, "position", 1);
  const double *u = mpsi_particles_column(f->particles, "velocity", 0);
  const double *v = mpsi_particles_column(f->particles, "velocity", 1);
  mps_totals t = {.volume = volume * (double)f->count, .mass = mass * (double)f->count};
  for (int64_t i = 0; i < f->count; i++) {
    t.linear[0] += mass * u[i], t.linear[1] += mass * v[i];
    t.angular[2] += mass * (x[i] * v[i] - y[i] * u[i]);
  }
  for (int c = 0; c < 2; c++) {
    t.impulse_loads[c] = f->exchange.loads[c];
    t.impulse_scheme[c] = f->exchange.scheme[c];
  }
  const double energy = mpsi_fluid_energy(f, &t.kinetic);
  t.strain = energy - t.kinetic;
  t.work_boundaries = f->work_boundaries;
  t.work_loads = f->work_loads;
  t.dissipated = t.scheme = f->work_boundaries + f->work_loads - (energy - f->energy);
  *out = t;
  return MPS_OK;
}

static void get_def(const void *solver, void *out) {
  const mps_fluid *f = solver;
  mps_fluid_def *def = out;
  *def = f->def;
  def->level = f->level;
}

static const mpsi_solver_kind fluid_kind = {
    .name = MPSI_SOLVER_NAMES("fluid"),
    .task = "fluid",
    .def_kind = MPS_DEF_FLUID,
    .get_def = get_def,
    .time = time_of,
    .steps = steps_of,
    .dt = mpsi_fluid_dt,
    .limit = mpsi_fluid_limit,
    .ready = mpsi_fluid_closed,
    .agree = agree,
    .check_dt = mpsi_fluid_check_dt,
    .use_dt = use_dt,
    .equation = MPS_LINEAR_EQUATION_PRESSURE,
    .get_totals = get_totals,
    .get_reaction = mpsi_fluid_get_reaction,
    .boundary = &mpsi_fluid_boundaries,
    .load = &mpsi_fluid_loads,
    .begin = mpsi_fluid_begin_march,
    .advance = mpsi_fluid_advance_march,
    .state = mpsi_fluid_state,
    .settle = mpsi_fluid_closed,
    .destroy = destroy,
};

static mps_status start(mps_fluid *f, const char *function) {
  f->count = mps_particles_count(f->particles);
  f->l0 = mps_particles_spacing(f->particles);
  f->reach = f->def.radius_ratio * f->l0;
  f->weight = mpsi_fluid_make_weight(f->l0, f->reach, f->reach);
  f->most_near = 28, f->most_lower = 8 * 13;
  f->loops = mpsi_fluid_choose_loops(mpsi_context_level(f->context));
  set_gravity(f);
  guess_pressure(f);
  mps_status status = mpsi_fluid_partition_create(f, function);
  if (status == MPS_OK && !(mpsi_fluid_coarse_create(f) && mpsi_fluid_reserve(f, f->count)))
    status = mpsi_fail_memory(f->context, function, (size_t)f->count * sizeof *f->local);
  MPSI_TRY(mpsi_fluid_agree(f, function, status));
  MPSI_TRY(mpsi_fluid_look(f, function));
  MPSI_TRY(mpsi_fluid_sort(f, function));
  MPSI_TRY(mpsi_fluid_look(f, function));
  f->unknown = 1;
  mpsi_fluid_find_speed(f);
  double kinetic;
  f->energy = mpsi_fluid_energy(f, &kinetic);
  return MPS_OK;
}

/* Have all ranks the same fluid? */
static mps_status agree_on_fluid(const mps_fluid_def *d, const char *function, mps_status status,
                                 mps_particles *particles) {
  mpsi_given given = MPSI_GIVEN;
  if (!mpsi_domain_many(d->domain)) return status;
  MPSI_GIVE_DEF(&given, mps_fluid_def, d);
  status = mpsi_domain_agree_given(d->domain, function, status, &given);
  return status == MPS_OK ? mpsi_domain_agree_particles(d->domain, function, status, particles)
                          : status;
}

mps_status mps_fluid_create(mps_context *context, mps_particles *particles,
                            const mps_fluid_def *user_def, mps_fluid **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_fluid_def def = mps_fluid_defaults();
  MPSI_TRY(mpsi_particles_check_context(particles, context, __func__));
  mps_status status = MPSI_DEF_READ_OR_DEFAULTS(context, __func__, mps_fluid_def, user_def, &def);
  if (status == MPS_OK) status = check_particles(context, particles);
  const double l0 = mps_particles_spacing(particles);
  if (status == MPS_OK) status = read_kernel(context, &def, l0);
  if (status == MPS_OK) status = mpsi_fluid_read_material(context, __func__, particles, &def);
  if (status == MPS_OK) status = check_def(context, &def, l0);
  if (status == MPS_OK) status = mpsi_domain_check(context, __func__, def.domain);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, __func__, MPSI_USE_MOVE);
  if (status == MPS_OK) status = mpsi_particles_check_deal(particles, __func__, NULL);
  if (status == MPS_OK)
    status = mpsi_fail_of(context, mpsi_particles_check_crowding(particles, __func__, 0, NULL),
                          "particles");
  mps_fluid *f = NULL;
  if (status == MPS_OK && !(f = mpsi_alloc(context, 1, sizeof *f)))
    status = mpsi_fail_memory(context, __func__, sizeof *f);
  status = agree_on_fluid(&def, __func__, status, particles);
  if (status != MPS_OK) {
    mpsi_free(context, f);
    return status;
  }
  const int32_t fields = mps_particles_field_count(particles);
  const mpsi_holder holder = {.name = "a fluid solver (mps_fluid)",
                              .kind = MPSI_USE_MOVE,
                              .commit = mpsi_fluid_commit,
                              .insert = mpsi_fluid_insert,
                              .remove = mpsi_fluid_remove,
                              .renew = mpsi_fluid_renew};
  mpsi_solver_start(&f->base, __func__, &fluid_kind, context, particles, def.domain, &holder);
  f->def = def;
  f->def.kernel = def.kernel ? mpsi_kernel_retain(def.kernel) : NULL;
  status = mpsi_fluid_agree(f, __func__, mpsi_as(context, __func__, add_fields(particles)));
  if (status == MPS_OK) status = start(f, __func__);
  if (status != MPS_OK) {
    mpsi_particles_drop_fields(particles, fields);
    mpsi_solver_end(&f->base);
    return status;
  }
  *out = f;
  return MPS_OK;
}

mps_solver *mps_fluid_solver(const mps_fluid *f) { return f ? (mps_solver *)&f->base : NULL; }

/* ---- questions ------------------------------------------------------------------------------- */

static int64_t bytes_of(const mps_fluid *f) {
  const int64_t n = (f->count + 7) / 8 * 8 + 24, chunks = f->count / MPSI_FLUID_CHUNK + 2;
  return 8 * (8 * n + 2 * chunks) + 22 * n + f->count * ((int64_t)sizeof *f->local + 3) +
         f->cloud_capacity * (5 * 8) + f->ghost_capacity * 16 + f->index_room.capacity * 4 +
         f->w_room.capacity * 4 + f->crowd_room.capacity * (int64_t)sizeof(mpsi_fluid_crowd) +
         f->push_room.capacity * 8 + f->exchange.rows.capacity * 8 +
         f->exchange.sums.capacity * (int64_t)sizeof(mpsi_exact) + f->lower_col_room.capacity * 2 +
         f->lower_room.capacity * 4 + mpsi_fluid_coarse_bytes(f);
}

mps_status mps_fluid_get_report_sized(const mps_fluid *f, mps_fluid_report *out, size_t size) {
  if (!f) return mpsi_null(__func__, "fluid");
  mps_fluid_report report = f->report;
  report.bytes = bytes_of(f);
  return mpsi_out_write(f->context, "mps_fluid_get_report", out, size, &report, sizeof report);
}
