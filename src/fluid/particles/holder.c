/* holder.c - particles edited, added and removed between steps.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "holder.h"
#include "fluid/base/access.h"
#include "fluid/boundary/walls.h"
#include "fluid/boundary/polyline.h"

#include <string.h>

#define LEAST_GAP 0.3 /* l0: distance of a new particle from walls */

/* Images to begin with: three rows along the walls of a tank, some 10 count^1/2. */
static int64_t room_for_ghosts(int64_t count) {
  return (int64_t)(12.0 * sqrt((double)count)) + 256;
}

/* The arrays over particles, from three blocks, in place of smaller ones; their contents are
 * computed again. false: as before. */
bool mpsi_fluid_reserve(mps_fluid *f, int64_t count) {
  if (count <= f->capacity) return true;
  mpsi_fluid_system *s = &f->system;
  const int64_t n = (count + 7) / 8 * 8 + 24, chunks = count / MPSI_FLUID_CHUNK + 2;
  double **doubles[] = {&f->u_new[0], &f->u_new[1], &s->diagonal, &s->right,
                        &s->r,        &s->z,        &s->q,        &s->p};
  enum { DOUBLES = sizeof doubles / sizeof *doubles };
  double *block =
      mpsi_alloc(f->context, n * DOUBLES + 2 * chunks + (22 * n + 7) / 8, sizeof *block);
  mpsi_fluid_local *local = mpsi_alloc(f->context, count, sizeof *local);
  uint8_t *state = mpsi_alloc(f->context, 3 * count, sizeof *state);
  if (!block || !local || !state || !mpsi_fluid_grow_cloud(f, count, room_for_ghosts(count))) {
    MPSI_FREE(f->context, block, local, state);
    return false;
  }
  MPSI_FREE(f->context, f->slab, f->local, f->state);
  f->slab = block, f->local = local, f->state = state;
  for (int k = 0; k < DOUBLES; k++) *doubles[k] = block + k * n;
  f->pressure = s->right; /* of a solution, whose right side is of no more use */
  s->sums = block + DOUBLES * n;
  f->zone_normal[0] = (float *)(s->sums + 2 * chunks);
  f->zone_normal[1] = f->zone_normal[0] + n;
  f->start = (int32_t *)(f->zone_normal[1] + n);
  s->lower_end = f->start + n;
  s->inverse = (float *)(s->lower_end + n);
  f->near = (uint16_t *)(s->inverse + n);
  f->company = f->state + count;
  f->zone = (atomic_uchar *)(f->company + count);
  f->capacity = count;
  f->stale = true;
  return true;
}

void mpsi_fluid_find_speed(mps_fluid *f) {
  const double *u = mpsi_particles_column(f->particles, "velocity", 0);
  const double *v = mpsi_particles_column(f->particles, "velocity", 1);
  double most = 0.0;
  for (int64_t i = 0; i < f->count; i++) most = fmax(most, u[i] * u[i] + v[i] * v[i]);
  f->speed = sqrt(most);
}

/* Of water alone in space in the frame of its mean: drops that fly with ten times the velocity with
 * which they collide lost twice the energy. */
void mpsi_fluid_find_stir(mps_fluid *f) {
  double mean[2] = {0.0, 0.0}, most2 = 0.0;
  f->stir = f->speed;
  for (int b = 0; b < f->walls; b++)
    if (f->wall[b].used) return;
  for (int c = 0; c < 2; c++)
    for (int64_t i = 0; i < f->count; i++) mean[c] += f->u[c][i] / (double)f->count;
  for (int64_t i = 0; i < f->count; i++) {
    const double u[2] = {f->u[0][i] - mean[0], f->u[1][i] - mean[1]};
    most2 = fmax(most2, u[0] * u[0] + u[1] * u[1]);
  }
  f->stir = sqrt(most2);
}

static mps_status check_places(mps_fluid *f, const char *function, int64_t first, int64_t end) {
  const double *x = mpsi_particles_column(f->particles, "position", 0);
  const double *y = mpsi_particles_column(f->particles, "position", 1);
  for (int64_t i = first; i < end; i++) {
    const double at[2] = {x[i], y[i]};
    double least = mpsi_fluid_before_lines(f, at), d;
    for (int b = 0; b < f->boundaries; b++)
      if (f->wall[b].used)
        least = fmin(least, mpsi_fluid_distance(&f->wall[b], f->wall[b].now.s, x[i], y[i]));
    for (int b = 0; b < f->bodies; b++) {
      if (!f->body[b].body) continue;
      mpsi_fluid_face_of(f, &f->body[b], false, at, &d);
      least = fmin(least, d);
    }
    if (!(least >= LEAST_GAP * f->l0))
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "the particle at (%g, %g) m is %g m inside the fluid's walls, must be at "
                       "least %g l0 = %g m",
                       x[i], y[i], least, LEAST_GAP, LEAST_GAP * f->l0);
  }
  return MPS_OK;
}

mps_status mpsi_fluid_commit(void *self, const char *function, const char *field,
                             const double *former) {
  mps_fluid *f = self;
  const mps_status status = mpsi_fluid_ready(f, function);
  if (status == MPS_OK) f->edited = f->renewed = true;
  if (status != MPS_OK || strcmp(field, "external_force") == 0) return status; /* steps read it */
  if (strcmp(field, "velocity") != 0) f->stale = true;
  if (strcmp(field, "position") == 0) f->unknown = 1;
  mpsi_fluid_find_speed(f);
  return MPS_OK;
}

/* The set may still return an error: the surface is unknown once it has changed. */
static void expect_change(mps_fluid *f, mpsi_fluid_change by) {
  double kinetic;
  f->energy_before = mpsi_fluid_energy(f, &kinetic);
  f->change = by;
}

mps_status mpsi_fluid_insert(void *self, const char *function, int64_t first, int64_t count) {
  mps_fluid *f = self;
  mps_status status = mpsi_fluid_ready(f, function);
  if (status == MPS_OK && first + count > MPSI_FLUID_MOST_PARTICLES)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "%lld particles to add to %lld, a fluid has at most %d", (long long)count,
                     (long long)first, MPSI_FLUID_MOST_PARTICLES);
  if (status == MPS_OK) status = check_places(f, function, first, first + count);
  if (status == MPS_OK) status = mpsi_particles_check_crowding(f->particles, function, first, NULL);
  if (status != MPS_OK) return status;
  if (!mpsi_fluid_reserve(f, first + count))
    return mpsi_fail_memory(f->context, function, (size_t)(first + count) * sizeof *f->local);
  expect_change(f, MPSI_FLUID_CHANGED_BY_CALLER);
  return MPS_OK;
}

mps_status mpsi_fluid_remove(void *self, const char *function, int64_t count, const int64_t *ids) {
  mps_fluid *f = self;
  MPSI_TRY(mpsi_fluid_ready(f, function));
  if (count >= f->count)
    return mpsi_fail(f->context, function, MPS_ERROR_STATE,
                     "all %lld particles are to be removed, a fluid needs one",
                     (long long)f->count);
  expect_change(f, MPSI_FLUID_CHANGED_BY_CALLER);
  return MPS_OK;
}

/* ---- open sides ------------------------------------------------------------------------------ */

/* The open side that x has passed, or -1. */
static int passed(const mps_fluid *f, double x, double y) {
  for (int b = 0; b < f->boundaries; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    if (w->open && (x - w->at[0]) * w->normal[0] + (y - w->at[1]) * w->normal[1] < 0.0) return b;
  }
  return -1;
}

/* The momentum of a removed particle is subtracted from the total, as by an impulse. */
static void carry_out(const mps_fluid *f, mpsi_fluid_wall *w, const double *x, const double *u) {
  const double mass = f->def.density * f->l0 * f->l0 * f->def.measure;
  const double spin = mass * (x[0] * u[1] - x[1] * u[0]);
  for (int c = 0; c < 2; c++) {
    w->load.force[c] -= mass * u[c] / f->dt;
    w->impulse[c] -= mass * u[c];
  }
  w->load.moment -= spin / f->dt;
  w->moment_impulse -= spin;
  w->load.wetted++;
  w->removed++;
  w->removed_mass += mass;
}

void mpsi_fluid_remove_outflow(mps_fluid *f) {
  uint8_t *const gone = f->company; /* free between steps; computed again when needed */
  bool open = false;
  int64_t count = 0;
  for (int b = 0; b < f->boundaries; b++) {
    if (f->wall[b].open) open = true, f->wall[b].load = (mpsi_fluid_load){0};
  }
  if (!open) return;
  for (int64_t i = 0; i < f->count; i++) {
    const double x[2] = {f->x[0][i], f->x[1][i]}, u[2] = {f->u[0][i], f->u[1][i]};
    const int b = passed(f, x[0], x[1]);
    gone[i] = b >= 0 && count < f->count - 1; /* a fluid needs one */
    if (!gone[i]) continue;
    carry_out(f, &f->wall[b], x, u);
    count++;
  }
  f->stale = true;
  if (count == 0) return;
  expect_change(f, MPSI_FLUID_CHANGED_BY_STEP);
  mpsi_particles_take_out(f->particles, gone);
}

/* Energy of added or removed particles is no work. */
void mpsi_fluid_renew(void *self) {
  mps_fluid *f = self;
  double kinetic;
  f->count = mps_particles_count(f->particles);
  if (f->change != MPSI_FLUID_UNCHANGED)
    f->energy += mpsi_fluid_energy(f, &kinetic) - f->energy_before;
  if (f->change == MPSI_FLUID_CHANGED_BY_CALLER) f->unknown = 1, f->edited = true;
  f->change = MPSI_FLUID_UNCHANGED;
  f->ghosts = 0;
  f->stale = true;
  mpsi_fluid_find_speed(f);
}
