/* dynamics.c - life of the explicit MPS solver: definition, checks, storage.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dynamics_private.h"

#include "core/particles_internal.h"
#include "core/state.h"
#include "layout.h"

#include <mps/experimental.h>
#include <mps/kernel.h>

#include <float.h>

static const mps_dynamics_def dynamics_defaults = {
    .struct_size = sizeof(mps_dynamics_def),
    .integrator = MPS_DYNAMICS_INTEGRATOR_VERLET,
    .rotation = MPS_DYNAMICS_ROTATION_MEAN_MATRIX,
    .damping = MPS_DYNAMICS_DAMPING_PAIR,
    .dt = NAN,
    .courant = 0.9,
    .radius_ratio = 1.5,
    .f1 = 1.0,
    .f2 = 14.0,
    .period_x = NAN,
    .divergence = 1e15,
    .measure = 1.0,
};

mps_status mps_dynamics_def_init(mps_dynamics_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_dynamics_def, def, size, &dynamics_defaults);
}

/* Extent of a set in spacings: positions keep a millionth of one. */
#define MOST_SPACINGS 1e9

/* ---- checks ---------------------------------------------------------------------------------- */

static mps_status check_choices(mps_context *context, const mps_dynamics_def *def) {
  static const char *const function = "mps_dynamics_create";
  const struct {
    const char *name, *allowed;
    int32_t value, most;
  } checks[] = {
      {"integrator", "0 (Verlet), 1 (leapfrog), 2 (Euler)", def->integrator, 2},
      {"rotation", "0 (mean matrix), 1 (mean angle)", def->rotation, 1},
      {"damping", "0 (pair), 1 (particle)", def->damping, 1},
      {"watch_damping", "0 and 1", def->watch_damping, 1},
      {"reserved", "0", def->reserved, 0},
  };
  for (size_t k = 0; k < sizeof checks / sizeof *checks; k++)
    if (checks[k].value < 0 || checks[k].value > checks[k].most)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %d, allowed are %s",
                       checks[k].name, checks[k].value, checks[k].allowed);
  return MPS_OK;
}

static mps_status check_numbers(mps_context *context, const mps_dynamics_def *def) {
  const struct {
    const char *name, *unit;
    double value, least, most;
    bool open, may_lack; /* `least` itself is not allowed; NaN is */
  } checks[] = {
      {"dt", " s, or NaN (chosen by the library)", def->dt, MPSI_DYN_LEAST_DT, MPSI_DYN_MOST_DT,
       false, true},
      {"courant", "", def->courant, 0.0, 1.0, true, false},
      {"radius_ratio", "", def->radius_ratio, 1.0, 4.0, true, false},
      {"f1", " Hz", def->f1, 1e-20, 1e9, false, false},
      {"f2", " Hz", def->f2, 1e-20, 1e9, false, false},
      {"period_x", " m, or NaN (none)", def->period_x, 0.0, 1e300, true, true},
      {"divergence", " m/s2", def->divergence, 0.0, 1e300, true, false},
      {"measure", " m", def->measure, 1e-9, 1e9, false, false},
  };
  for (size_t k = 0; k < sizeof checks / sizeof *checks; k++) {
    const double value = checks[k].value;
    const bool above = checks[k].open ? value > checks[k].least : value >= checks[k].least;
    if ((above && value <= checks[k].most) || (isnan(value) && checks[k].may_lack)) continue;
    return mpsi_fail(context, "mps_dynamics_create", MPS_ERROR_ARGUMENT,
                     "%s is %g, must be %s %g and at most %g%s", checks[k].name, value,
                     checks[k].open ? "above" : "at least", checks[k].least, checks[k].most,
                     checks[k].unit);
  }
  return MPS_OK;
}

static mps_status check_material(mps_context *context, mps_particles *particles) {
  static const char *const function = "mps_dynamics_create";
  const int64_t n = mps_particles_count(particles);
  const int64_t *id = mpsi_particles_integers(particles, "id");
  const char *const names[3] = {"density", "shear_velocity", "pressure_velocity"};
  const double *column[3];
  for (int f = 0; f < 3; f++) {
    column[f] = mpsi_particles_column(particles, names[f], 0);
    if (!column[f])
      return mpsi_fail(context, function, MPS_ERROR_FIELD,
                       "the particle set has no field '%s': set it with mps_particles_set",
                       names[f]);
    for (int64_t k = 0; k < n; k++)
      if (!(column[f][k] >= 1e-6 && column[f][k] <= 1e9))
        return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "%s of particle %lld is %g, must be in 1e-6..1e9 %s", names[f],
                         (long long)id[k], column[f][k], f == 0 ? "kg/m3" : "m/s");
  }
  const double *damping = mpsi_particles_column(particles, "damping", 0);
  for (int64_t k = 0; k < n; k++) {
    if (column[2][k] < sqrt(2.0) * column[1][k] * (1.0 - 1e-12))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "pressure_velocity of particle %lld is %g m/s, must be at least sqrt(2) "
                       "times its shear_velocity %g m/s (lambda >= 0)",
                       (long long)id[k], column[2][k], column[1][k]);
    if (damping && !(damping[k] >= 0.0 && damping[k] <= 1000.0))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "damping of particle %lld is %g, must be in 0..1000", (long long)id[k],
                       damping[k]);
  }
  return MPS_OK;
}

/* What is there of position and of the initial state must be finite. */
static mps_status check_state(mps_context *context, mps_particles *particles) {
  static const char *const names[] = {"position", "displacement", "rotation", "velocity", "spin"};
  const int64_t n = mps_particles_count(particles);
  for (size_t f = 0; f < sizeof names / sizeof *names; f++)
    for (int c = 0; c < 2; c++) {
      const double *column = mpsi_particles_column(particles, names[f], c);
      for (int64_t k = 0; column && k < n; k++)
        if (!isfinite(column[k]))
          return mpsi_fail(context, "mps_dynamics_create", MPS_ERROR_ARGUMENT,
                           "%s of particle %lld is %g, must be finite", names[f],
                           (long long)mpsi_particles_integers(particles, "id")[k], column[k]);
    }
  return MPS_OK;
}

/* Least and greatest position without the displacement that particles may have, m. */
static void extent(mps_particles *particles, int32_t component, double *lo, double *hi) {
  const double *x = mpsi_particles_column(particles, "position", component);
  const double *d = mpsi_particles_column(particles, "displacement", component);
  *lo = INFINITY, *hi = -INFINITY;
  for (int64_t k = 0; k < mps_particles_count(particles); k++) {
    const double at = x[k] - (d ? d[k] : 0.0);
    *lo = fmin(*lo, at), *hi = fmax(*hi, at);
  }
}

static mps_status check_geometry(mps_context *context, mps_particles *particles,
                                 const mps_dynamics_def *def) {
  static const char *const function = "mps_dynamics_create";
  const int64_t n = mps_particles_count(particles);
  if (mps_particles_dim(particles) != 2)
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "the particle set has dim %d: the solver is for plane strain, dim 2",
                     mps_particles_dim(particles));
  if (n < 1 || n > INT32_MAX)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "the particle set has %lld particles, allowed are 1 to %d", (long long)n,
                     INT32_MAX);
  const int64_t *side = mpsi_particles_integers(particles, "free_field");
  const double D = mps_particles_spacing(particles), re = def->radius_ratio * D;
  double lo[2], hi[2];
  int64_t body = 0;
  for (int c = 0; c < 2; c++) extent(particles, c, &lo[c], &hi[c]);
  for (int64_t k = 0; k < n; k++) {
    if (side && (side[k] < 0 || side[k] > MPS_DYNAMICS_SIDE_RIGHT))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "free_field of particle %lld is %lld, allowed are 0, 1 (left), 2 (right)",
                       (long long)mpsi_particles_integers(particles, "id")[k], (long long)side[k]);
    body += !(side && side[k]);
  }
  for (int c = 0; c < 2; c++)
    if (!(hi[c] - lo[c] <= MOST_SPACINGS * D))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "the particles reach from %g m to %g m in %c, allowed are %g spacings",
                       lo[c], hi[c], c == 0 ? 'x' : 'y', MOST_SPACINGS);
  if (body == 0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "all %lld particles belong to free-field columns, a body is needed",
                     (long long)n);
  if (def->period_x > 0.0 && body < n)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "period_x is %g m, must be NaN with free-field columns", def->period_x);
  if (def->period_x > 0.0 && (def->period_x <= re || def->period_x <= hi[0] - lo[0]))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "period_x is %g m, must be above re = %g m and the body's width %g m "
                     "between outer particle centres",
                     def->period_x, re, hi[0] - lo[0]);
  return MPS_OK;
}

/* ---- storage --------------------------------------------------------------------------------- */

double *mpsi_dynamics_column(const mps_dynamics *dynamics, const char *name, int32_t component) {
  return mpsi_particles_column(dynamics->particles, name, component);
}

/* Takes the reference position from position and displacement, but keeps one that differs from it
 * by round-off alone: a second solver on a set finds the pairs of the first. */
static void set_reference(mps_dynamics *dynamics) {
  const double spacing = mps_particles_spacing(dynamics->particles);
  for (int32_t c = 0; c < 2; c++) {
    const double *x = mpsi_dynamics_column(dynamics, "position", c);
    const double *d = mpsi_dynamics_column(dynamics, "displacement", c);
    double *r = mpsi_dynamics_column(dynamics, "reference", c);
    for (int64_t k = 0; k < dynamics->count; k++) {
      const double round_off = 1e-9 * spacing + 4.0 * DBL_EPSILON * (fabs(x[k]) + fabs(d[k]));
      if (!(fabs(x[k] - d[k] - r[k]) <= round_off)) r[k] = x[k] - d[k];
    }
  }
}

/* Adds the fields that the solver writes. */
static mps_status add_fields(mps_dynamics *dynamics) {
  static const char *const names[] = {
      "displacement", "rotation",         "velocity",     "spin",          "acceleration",
      "pressure",     "displacement_old", "rotation_old", "restoring_old", "reference"};
  mps_status status = MPS_OK;
  for (size_t k = 0; status == MPS_OK && k < sizeof names / sizeof *names; k++)
    status = mps_particles_add_field(dynamics->particles, names[k], 0);
  if (status == MPS_OK) set_reference(dynamics);
  return status;
}

/* The arrays that are not fields, from one slab; starts staggered so that they do not alias in the
 * first-level cache. */
static bool allocate(mps_dynamics *dynamics) {
  mpsi_dynamics_state *s = &dynamics->state;
  double **arrays[] = {&s->gx, &s->gy,  &s->gth, &s->c,  &s->s,   &s->mu,    &s->lambda, &s->sx,
                       &s->sy, &s->sth, &s->ix,  &s->iy, &s->ith, &s->alpha, &s->beta};
  const int64_t number = sizeof arrays / sizeof *arrays;
  const int64_t n = (dynamics->count + 7) / 8 * 8, stride = n + 24;
  const int64_t slots = (dynamics->mesh.slots + 7) / 8 * 8 + 40;
  dynamics->slab = mpsi_alloc(dynamics->context, number * stride + 2 * slots, sizeof(double));
  dynamics->scratch = mpsi_alloc(dynamics->context,
                                 (int64_t)mps_context_threads(dynamics->context) * MPSI_DYN_SCRATCH,
                                 sizeof(double));
  dynamics->bad = mpsi_alloc(dynamics->context, dynamics->mesh.blocks, sizeof(int32_t));
  dynamics->part = mpsi_alloc(dynamics->context, 2 * dynamics->mesh.blocks, sizeof(double));
  if (!dynamics->part || !dynamics->slab || !dynamics->scratch || !dynamics->bad) return false;
  for (int64_t k = 0; k < number; k++) *arrays[k] = dynamics->slab + k * stride;
  s->ex = dynamics->slab + number * stride;
  s->ey = s->ex + slots;
  return true;
}

void mpsi_dynamics_bind(mps_dynamics *dynamics) {
  mpsi_dynamics_state *s = &dynamics->state;
  const struct {
    double **to;
    const char *name;
    int component;
  } bind[] = {{&s->rx, "reference", 0},
              {&s->ry, "reference", 1},
              {&s->dx, "displacement", 0},
              {&s->dy, "displacement", 1},
              {&s->th, "rotation", 0},
              {&s->ox, "displacement_old", 0},
              {&s->oy, "displacement_old", 1},
              {&s->oth, "rotation_old", 0},
              {&s->vx, "velocity", 0},
              {&s->vy, "velocity", 1},
              {&s->vth, "spin", 0},
              {&s->hx, "restoring_old", 0},
              {&s->hy, "restoring_old", 1},
              {&s->hth, "restoring_old", 2},
              {&s->ax, "acceleration", 0},
              {&s->ay, "acceleration", 1},
              {&s->p, "pressure", 0}};
  for (size_t k = 0; k < sizeof bind / sizeof *bind; k++)
    *bind[k].to = mpsi_dynamics_column(dynamics, bind[k].name, bind[k].component);
}

/* Coefficients of each particle: Lame constants, inverse masses, Rayleigh damping. */
void mpsi_dynamics_set_coefficients(mps_dynamics *dynamics) {
  const double *rho = mpsi_dynamics_column(dynamics, "density", 0);
  const double *vs = mpsi_dynamics_column(dynamics, "shear_velocity", 0);
  const double *vp = mpsi_dynamics_column(dynamics, "pressure_velocity", 0);
  const double *h = mpsi_dynamics_column(dynamics, "damping", 0);
  const double D = mps_particles_spacing(dynamics->particles);
  const double f1 = dynamics->def.f1, f2 = dynamics->def.f2, pi = 3.14159265358979323846;
  /* I = rho D^4/6 and one half of each pair's moment to either end: 3/(rho D^2) */
  const double spin = 3.0 * dynamics->torque;
  double least = INFINITY, most = 0.0;
  mpsi_dynamics_state *s = &dynamics->state;
  for (int64_t k = 0; k < dynamics->count; k++) {
    const double lambda = rho[k] * (vp[k] * vp[k] - 2.0 * vs[k] * vs[k]);
    s->mu[k] = rho[k] * vs[k] * vs[k];
    s->lambda[k] = lambda > 0.0 ? lambda : 0.0;
    s->ix[k] = s->iy[k] = 1.0 / rho[k];
    s->ith[k] = spin / (rho[k] * D * D);
    const double ratio = h ? h[k] : 0.0;
    s->alpha[k] = ratio * 4.0 * pi * f1 * f2 / (f1 + f2);
    s->beta[k] = ratio / (pi * (f1 + f2));
    least = fmin(least, ratio), most = fmax(most, ratio);
  }
  if (most > 0.0)
    dynamics->damping = least == most || dynamics->def.damping == MPS_DYNAMICS_DAMPING_PARTICLE
                            ? MPSI_DYN_BY_PARTICLES
                            : MPSI_DYN_BY_PAIRS;
}

/* ---- creation -------------------------------------------------------------------------------- */

/* Are all offsets whole spacings? Those of a lattice have been made exact. */
static bool on_lattice(double spacing, int64_t count, const mpsi_dynamics_pair *pair) {
  for (int64_t k = 0; k < count; k++)
    if (pair[k].r0x != nearbyint(pair[k].r0x / spacing) * spacing ||
        pair[k].r0y != nearbyint(pair[k].r0y / spacing) * spacing)
      return false;
  return true;
}

/* Sorts the set and builds the pair structure. */
static mps_status arrange(mps_dynamics *dynamics) {
  static const char *const function = "mps_dynamics_create";
  mps_context *context = dynamics->context;
  mps_particles *p = dynamics->particles;
  int64_t *order = mpsi_alloc(context, dynamics->count, sizeof *order);
  mpsi_dynamics_geometry g = {.count = dynamics->count,
                              .x = mpsi_particles_column(p, "reference", 0),
                              .y = mpsi_particles_column(p, "reference", 1),
                              .side = mpsi_particles_integers(p, "free_field"),
                              .spacing = mps_particles_spacing(p),
                              .radius = dynamics->radius,
                              .period_x =
                                  isnan(dynamics->def.period_x) ? 0.0 : dynamics->def.period_x};
  mps_status status = MPS_OK;
  if (!order || !mpsi_dynamics_layout_order(context, &g, order))
    status = mpsi_fail_memory(context, function, (size_t)dynamics->count * sizeof *order);
  if (status == MPS_OK) status = mpsi_particles_permute(p, function, order);
  mpsi_free(context, order);
  if (status != MPS_OK) return status;
  g.x = mpsi_particles_column(p, "reference", 0);
  g.y = mpsi_particles_column(p, "reference", 1);
  g.side = mpsi_particles_integers(p, "free_field");
  dynamics->body = 0;
  while (dynamics->body < dynamics->count && !(g.side && g.side[dynamics->body])) dynamics->body++;

  mpsi_dynamics_pair *pair = NULL;
  int64_t count = 0;
  status = mpsi_dynamics_layout_pairs(context, function, &g, &count, &pair, &dynamics->pairs);
  if (status != MPS_OK) return status;
  dynamics->lattice = on_lattice(g.spacing, count, pair);
  const mpsi_dynamics_mesh_def def = {g.spacing, dynamics->radius, dynamics->density};
  const bool built =
      mpsi_dynamics_mesh_build(context, &dynamics->mesh, &def, dynamics->count, count, pair);
  mpsi_free(context, pair);
  return built ? MPS_OK : mpsi_fail_memory(context, function, (size_t)count * sizeof *pair);
}

/* Dashpots between each free-field column and the edge of the body beside it. */
static mps_status couple_columns(mps_dynamics *dynamics) {
  const int64_t columns = dynamics->count - dynamics->body;
  if (columns == 0) return MPS_OK;
  mps_context *context = dynamics->context;
  mps_particles *p = dynamics->particles;
  const mpsi_dynamics_geometry g = {.count = dynamics->count,
                                    .x = mpsi_particles_column(p, "reference", 0),
                                    .y = mpsi_particles_column(p, "reference", 1),
                                    .side = mpsi_particles_integers(p, "free_field"),
                                    .spacing = dynamics->spacing,
                                    .radius = dynamics->radius};
  int64_t *edge = mpsi_alloc(context, dynamics->count, sizeof *edge);
  dynamics->column_dashpot = mpsi_alloc(context, 2 * columns, sizeof *dynamics->column_dashpot);
  if (!edge || !dynamics->column_dashpot) {
    mpsi_free(context, edge);
    return mpsi_fail_memory(context, "mps_dynamics_create", (size_t)dynamics->count * sizeof *edge);
  }
  const mps_status status = mpsi_dynamics_layout_edges(context, "mps_dynamics_create", &g, edge);
  const double *velocity[2] = {mpsi_particles_column(p, "pressure_velocity", 0),
                               mpsi_particles_column(p, "shear_velocity", 0)};
  for (int64_t k = dynamics->body; status == MPS_OK && k < dynamics->count; k++)
    for (int c = 0; c < 2 && edge[k] >= 0; c++)
      dynamics->column_dashpot[dynamics->column_dashpots++] =
          (mpsi_dynamics_dashpot){.particle = (int32_t)edge[k],
                                  .component = c,
                                  .boundary = -1,
                                  .partner = (int32_t)k,
                                  .c = velocity[c][k] / g.spacing};
  mpsi_free(context, edge);
  return status;
}

bool mpsi_dynamics_reserve_accounts(mps_dynamics *dynamics) {
  if (!dynamics->before)
    dynamics->before = mpsi_alloc(dynamics->context, 3 * dynamics->count, sizeof(double));
  return dynamics->before != NULL;
}

/* What Rayleigh damping that is watched needs. */
static mps_status reserve_watch(mps_dynamics *dynamics) {
  if (!dynamics->def.watch_damping || dynamics->damping == MPSI_DYN_UNDAMPED) return MPS_OK;
  dynamics->drag = mpsi_alloc(dynamics->context, 3 * dynamics->count, sizeof *dynamics->drag);
  if (dynamics->drag && mpsi_dynamics_reserve_accounts(dynamics)) return MPS_OK;
  return mpsi_fail_memory(dynamics->context, "mps_dynamics_create", (size_t)dynamics->count * 24);
}

static mps_status build(mps_dynamics *dynamics) {
  static const char *const function = "mps_dynamics_create";
  mps_context *context = dynamics->context;
  const double spacing = dynamics->spacing = mps_particles_spacing(dynamics->particles);
  mps_kernel *kernel = NULL;
  dynamics->torque = 1.0;
  dynamics->radius = dynamics->def.radius_ratio * spacing;
  mps_status status = mps_kernel_create(context, MPS_KERNEL_MPS, dynamics->radius, &kernel);
  if (status == MPS_OK) /* n0 is the interior value for every particle, no dummies */
    status = mps_kernel_density(context, kernel, 2, spacing, &dynamics->density);
  mps_kernel_destroy(&kernel);
  if (status == MPS_OK) status = add_fields(dynamics);
  if (status == MPS_OK) status = arrange(dynamics);
  if (status == MPS_OK && !allocate(dynamics))
    status = mpsi_fail_memory(context, function, (size_t)dynamics->mesh.slots * 16);
  if (status != MPS_OK) return status;
  mpsi_dynamics_bind(dynamics);
  mpsi_dynamics_set_coefficients(dynamics);
  status = couple_columns(dynamics);
  if (status == MPS_OK) status = reserve_watch(dynamics);
  if (status == MPS_OK) status = mpsi_dynamics_list_boundaries(dynamics, function);
  if (status == MPS_OK) status = mpsi_dynamics_begin(dynamics, function, 0.0);
  return status;
}

mps_status mps_dynamics_create(mps_context *context, mps_particles *particles,
                               const mps_dynamics_def *user_def, mps_dynamics **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!particles) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "particles is NULL");
  if (mpsi_particles_context(particles) != context)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "the particle set was made from another context");
  mps_dynamics_def def = dynamics_defaults;
  mps_status status = MPS_OK;
  if (user_def) status = MPSI_DEF_READ(context, __func__, mps_dynamics_def, user_def, &def);
  if (status == MPS_OK) status = check_choices(context, &def);
  if (status == MPS_OK) status = check_numbers(context, &def);
  if (status == MPS_OK) status = check_state(context, particles);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, __func__, MPSI_USE_MOVE);
  if (status == MPS_OK) status = check_geometry(context, particles, &def);
  if (status == MPS_OK) status = check_material(context, particles);
  if (status != MPS_OK) return status;
  mps_dynamics *dynamics = mpsi_alloc(context, 1, sizeof *dynamics);
  if (!dynamics) return mpsi_fail_memory(context, __func__, sizeof *dynamics);
  dynamics->context = mpsi_context_retain(context);
  dynamics->particles = particles;
  dynamics->holder = (mpsi_holder){
      .name = "a solver of elastodynamics (mps_dynamics)", .self = dynamics, .kind = MPSI_USE_MOVE};
  (void)mpsi_particles_hold(particles, __func__, &dynamics->holder); /* checked above */
  dynamics->def = def;
  dynamics->count = mps_particles_count(particles);
  dynamics->kernels = mpsi_dynamics_kernels_select(mpsi_context_level(context));
  dynamics->dt = def.dt;
  dynamics->fresh = true;
  if ((status = build(dynamics)) != MPS_OK) {
    mps_dynamics_destroy(&dynamics);
    return status;
  }
  *out = dynamics;
  return MPS_OK;
}

void mps_dynamics_destroy(mps_dynamics **pointer) {
  if (!pointer || !*pointer) return;
  mps_dynamics *dynamics = *pointer;
  mps_context *context = dynamics->context;
  if (mpsi_dynamics_enter(dynamics, __func__) != MPS_OK) return;
  *pointer = NULL;
  mps_snapshot_destroy(&dynamics->present);
  mpsi_state_forget(&dynamics->identity);
  mpsi_dynamics_mesh_free(context, &dynamics->mesh);
  mpsi_dynamics_free_boundaries(dynamics);
  mpsi_dynamics_free_loads(dynamics);
  void *parts[] = {dynamics->slab,   dynamics->scratch, dynamics->bad,
                   dynamics->before, dynamics->drag,    dynamics->part};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) mpsi_free(context, parts[k]);
  mpsi_particles_release(dynamics->particles, &dynamics->holder);
  mpsi_free(context, dynamics);
  mpsi_context_release(context);
}

mps_status mps_experimental_dynamics_printed_torque(mps_dynamics *dynamics) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  const mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status != MPS_OK) return status;
  if (!dynamics->fresh)
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_STATE,
                     "steps have been taken: call it before the first");
  dynamics->torque = 2.0;
  mpsi_dynamics_set_coefficients(dynamics);
  dynamics->have_limit = dynamics->checked = false;
  dynamics->dt = dynamics->def.dt;
  return MPS_OK;
}

/* ---- questions ------------------------------------------------------------------------------- */

mps_status mps_dynamics_get_def_sized(const mps_dynamics *dynamics, mps_dynamics_def *out,
                                      size_t size) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_dynamics_def def = dynamics->def;
  def.struct_size = (uint32_t)size;
  def.dt = dynamics->dt;
  return mpsi_out_write(dynamics->context, "mps_dynamics_get_def", out, size, &def, sizeof def);
}

mps_particles *mps_dynamics_particles(const mps_dynamics *dynamics) {
  return dynamics ? dynamics->particles : NULL;
}

mps_context *mps_dynamics_context(const mps_dynamics *dynamics) {
  return dynamics ? dynamics->context : NULL;
}

int64_t mps_dynamics_pairs(const mps_dynamics *dynamics) { return dynamics ? dynamics->pairs : 0; }
