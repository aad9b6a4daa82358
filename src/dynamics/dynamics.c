/* dynamics.c - life of the explicit MPS solver: definition, checks, storage.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dynamics_private.h"

#include "core/particles_internal.h"
#include "layout.h"

#include <float.h>

static const mps_dynamics_def dynamics_defaults = {
    .struct_size = sizeof(mps_dynamics_def),
    .integrator = MPS_INTEGRATOR_VERLET,
    .rotation = MPS_ROTATION_MEAN_MATRIX,
    .courant = 0.9,
    .radius_ratio = 1.5,
    .f1 = 1.0,
    .f2 = 14.0,
    .divergence = 1e15,
};

mps_status mps_dynamics_def_init(mps_dynamics_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_dynamics_def, def, size, &dynamics_defaults);
}

/* Extent of a set in spacings: positions keep a millionth of one. */
#define MOST_SPACINGS 1e9

/* ---- checks ---------------------------------------------------------------------------------- */

static mps_status check_choices(mps_context *context, const mps_dynamics_def *def) {
  static const char *const function = "mps_dynamics_create";
  if (def->integrator < MPS_INTEGRATOR_EULER || def->integrator > MPS_INTEGRATOR_VERLET)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "integrator is %d, allowed are 0 (Euler), 1 (leapfrog), 2 (Verlet)",
                     def->integrator);
  if (def->rotation != MPS_ROTATION_MEAN_ANGLE && def->rotation != MPS_ROTATION_MEAN_MATRIX)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "rotation is %d, allowed are 11 (mean angle) and 12 (mean matrix)",
                     def->rotation);
  if (def->torque != MPS_TORQUE_CONSERVING && def->torque != MPS_TORQUE_PRINTED)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "torque is %d, allowed are 0 (conserving) and 1 (as printed)", def->torque);
  if (def->damping != MPS_DAMPING_PAIR && def->damping != MPS_DAMPING_PARTICLE)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "damping is %d, allowed are 0 (pair) and 1 (particle)", def->damping);
  if (def->isa != 0 && def->isa != 1 && def->isa != 3 && def->isa != 4)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "isa is %d, allowed are 0 (the best), 1, 3 and 4", def->isa);
  if (!mpsi_dynamics_kernels_select(def->isa))
    return mpsi_fail(context, function, MPS_ERROR_UNSUPPORTED,
                     "this processor or build lacks x86-64-v%d", def->isa);
  return MPS_OK;
}

static mps_status check_numbers(mps_context *context, const mps_dynamics_def *def) {
  const struct {
    const char *name, *allowed;
    double value;
    bool good;
  } checks[] = {
      {"dt", "0 (chosen by the library) or > 0 s", def->dt, def->dt >= 0.0},
      {"courant", "in (0, 1]", def->courant, def->courant > 0.0 && def->courant <= 1.0},
      {"radius_ratio", "in (1, 4]", def->radius_ratio,
       def->radius_ratio > 1.0 && def->radius_ratio <= 4.0},
      {"f1", "> 0 Hz", def->f1, def->f1 > 0.0},
      {"f2", "> 0 Hz", def->f2, def->f2 > 0.0},
      {"period_x", "0 (none) or > 0 m", def->period_x, def->period_x >= 0.0},
      {"divergence", "> 0 m/s2", def->divergence, def->divergence > 0.0},
  };
  for (size_t k = 0; k < sizeof checks / sizeof *checks; k++)
    if (!checks[k].good || !isfinite(checks[k].value))
      return mpsi_fail(context, "mps_dynamics_create", MPS_ERROR_ARGUMENT,
                       "%s is %g, must be finite and %s", checks[k].name, checks[k].value,
                       checks[k].allowed);
  return MPS_OK;
}

static mps_status check_material(mps_context *context, mps_particles *particles) {
  static const char *const function = "mps_dynamics_create";
  const int64_t n = mps_particles_count(particles);
  const char *const names[3] = {"density", "shear_velocity", "pressure_velocity"};
  const double *column[3];
  for (int f = 0; f < 3; f++) {
    column[f] = mpsi_particles_column(particles, names[f], 0);
    if (!column[f])
      return mpsi_fail(context, function, MPS_ERROR_FIELD,
                       "the particle set has no field '%s': set it with mps_particles_set",
                       names[f]);
    for (int64_t k = 0; k < n; k++)
      if (!isfinite(column[f][k]) || column[f][k] <= 0.0)
        return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "%s of particle %lld is %g, must be finite and > 0", names[f],
                         (long long)mpsi_particles_integers(particles, "id")[k], column[f][k]);
  }
  const double *damping = mpsi_particles_column(particles, "damping", 0);
  for (int64_t k = 0; k < n; k++) {
    if (column[2][k] < sqrt(2.0) * column[1][k] * (1.0 - 1e-12))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "pressure_velocity of particle %lld is %g m/s, must be at least sqrt(2) "
                       "times its shear_velocity %g m/s (lambda >= 0)",
                       (long long)mpsi_particles_integers(particles, "id")[k], column[2][k],
                       column[1][k]);
    if (damping && !(damping[k] >= 0.0 && isfinite(damping[k])))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "damping of particle %lld is %g, must be finite and >= 0",
                       (long long)mpsi_particles_integers(particles, "id")[k], damping[k]);
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
    if (side && (side[k] < 0 || side[k] > MPS_SIDE_RIGHT))
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
                     "period_x is %g m, must be 0 with free-field columns", def->period_x);
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
  if (!dynamics->slab || !dynamics->scratch || !dynamics->bad) return false;
  for (int64_t k = 0; k < number; k++) *arrays[k] = dynamics->slab + k * stride;
  s->ex = dynamics->slab + number * stride;
  s->ey = s->ex + slots;
  return true;
}

static void bind_fields(mps_dynamics *dynamics) {
  mpsi_dynamics_state *s = &dynamics->state;
  const struct {
    double **to;
    const char *name;
    int component;
  } bind[] = {{&s->dx, "displacement", 0},
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

/* Coefficients of each particle: Lame constants, inverse masses, Rayleigh damping (A16). */
static void set_coefficients(mps_dynamics *dynamics) {
  const double *rho = mpsi_dynamics_column(dynamics, "density", 0);
  const double *vs = mpsi_dynamics_column(dynamics, "shear_velocity", 0);
  const double *vp = mpsi_dynamics_column(dynamics, "pressure_velocity", 0);
  const double *h = mpsi_dynamics_column(dynamics, "damping", 0);
  const double D = mps_particles_spacing(dynamics->particles);
  const double f1 = dynamics->def.f1, f2 = dynamics->def.f2, pi = 3.14159265358979323846;
  /* I = rho D^4/6 and one half of each pair's moment to either end: 3/(rho D^2); (A14) as printed
   * gives twice that */
  const double spin = dynamics->def.torque == MPS_TORQUE_PRINTED ? 6.0 : 3.0;
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
    dynamics->damping = least == most || dynamics->def.damping == MPS_DAMPING_PARTICLE
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
                              .period_x = dynamics->def.period_x};
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
  if (dynamics->body == dynamics->count) return MPS_OK;
  mps_particles *p = dynamics->particles;
  const mpsi_dynamics_geometry g = {.count = dynamics->count,
                                    .x = mpsi_particles_column(p, "reference", 0),
                                    .y = mpsi_particles_column(p, "reference", 1),
                                    .side = mpsi_particles_integers(p, "free_field"),
                                    .spacing = mps_particles_spacing(p),
                                    .radius = dynamics->radius};
  int64_t *edge = mpsi_alloc(dynamics->context, dynamics->count, sizeof *edge);
  if (!edge)
    return mpsi_fail_memory(dynamics->context, "mps_dynamics_create",
                            (size_t)dynamics->count * sizeof *edge);
  mps_status status =
      mpsi_dynamics_layout_edges(dynamics->context, "mps_dynamics_create", &g, edge);
  const double *velocity[2] = {mpsi_particles_column(p, "pressure_velocity", 0),
                               mpsi_particles_column(p, "shear_velocity", 0)};
  for (int64_t k = dynamics->body; status == MPS_OK && k < dynamics->count; k++)
    for (int c = 0; c < 2 && edge[k] >= 0; c++)
      if (!mpsi_dynamics_add_dashpot(dynamics,
                                     (mpsi_dynamics_dashpot){.particle = (int32_t)edge[k],
                                                             .component = c,
                                                             .partner = (int32_t)k,
                                                             .c = velocity[c][k] / g.spacing}))
        status = mpsi_fail_memory(dynamics->context, "mps_dynamics_create",
                                  sizeof(mpsi_dynamics_dashpot));
  mpsi_free(dynamics->context, edge);
  return status;
}

static mps_status build(mps_dynamics *dynamics) {
  static const char *const function = "mps_dynamics_create";
  mps_context *context = dynamics->context;
  const double spacing = mps_particles_spacing(dynamics->particles);
  mps_kernel *kernel = NULL;
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
  bind_fields(dynamics);
  set_coefficients(dynamics);
  status = couple_columns(dynamics);
  if (status == MPS_OK) status = mps_dynamics_restart(dynamics, 0.0);
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
  if (status == MPS_OK && mpsi_particles_check_free(particles, __func__) != MPS_OK)
    status = mpsi_fail(context, __func__, MPS_ERROR_STATE,
                       "another solver uses the set: destroy it first");
  if (status == MPS_OK) status = check_geometry(context, particles, &def);
  if (status == MPS_OK) status = check_material(context, particles);
  if (status != MPS_OK) return status;
  mps_dynamics *dynamics = mpsi_alloc(context, 1, sizeof *dynamics);
  if (!dynamics) return mpsi_fail_memory(context, __func__, sizeof *dynamics);
  dynamics->context = mpsi_context_retain(context);
  dynamics->particles = mpsi_particles_pin(particles);
  dynamics->def = def;
  dynamics->count = mps_particles_count(particles);
  dynamics->kernels = mpsi_dynamics_kernels_select(def.isa);
  dynamics->dt = def.dt;
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
  *pointer = NULL;
  mpsi_dynamics_mesh_free(context, &dynamics->mesh);
  for (int64_t k = 0; k < dynamics->signal_count; k++) mps_signal_destroy(&dynamics->signals[k]);
  void *parts[] = {dynamics->slab,    dynamics->scratch, dynamics->bad,    dynamics->drive,
                   dynamics->dashpot, dynamics->signals, dynamics->initial};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) mpsi_free(context, parts[k]);
  mpsi_particles_unpin(dynamics->particles);
  mpsi_free(context, dynamics);
  mpsi_context_release(context);
}

double mps_dynamics_time(const mps_dynamics *dynamics) {
  if (!dynamics) return 0.0;
  return dynamics->base_time + (double)(dynamics->steps - dynamics->base_step) * dynamics->dt;
}

int64_t mps_dynamics_steps(const mps_dynamics *dynamics) { return dynamics ? dynamics->steps : 0; }

int64_t mps_dynamics_pairs(const mps_dynamics *dynamics) { return dynamics ? dynamics->pairs : 0; }
