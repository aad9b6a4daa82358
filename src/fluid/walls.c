/* walls.c - plane walls, what moves them, and the mirror images (ghosts) of the particles within re
 * of each. Walls are taken in the order of their numbers, and images are mirrored at later walls
 * that stand at right angles to the earlier ones, so that corners of 90 degrees fill. At other
 * corners only the particles themselves are mirrored, and images behind another wall are dropped.
 *
 * A ghost moves as the mirror image of its parent seen from the wall (velocity of the step before:
 * free slip); its reduced pressure is the parent's less
 * rho (a . N)(distance of the two), N out of the fluid: the one place where the wall's new velocity
 * enters.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid_private.h"

#include <string.h>

#define SQUARE 1e-6 /* cosine of the angle of walls at right angles */

static double displacement(const mpsi_fluid_wall *w, double t) {
  return w->signal ? w->factor * (mps_signal_displacement(w->signal, t) - w->origin) : 0.0;
}

void mpsi_fluid_begin_walls(mps_fluid *f, double dt) {
  for (int b = 0; b < MPS_FLUID_MAX_BOUNDARIES; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    if (!w->used) continue;
    w->s_new = displacement(w, f->time + dt);
    w->u_new = (w->s_new - w->s) / dt;
    w->a = (w->u_new - w->u) / dt;
  }
}

void mpsi_fluid_end_walls(mps_fluid *f) {
  for (int b = 0; b < MPS_FLUID_MAX_BOUNDARIES; b++)
    f->wall[b].s = f->wall[b].s_new, f->wall[b].u = f->wall[b].u_new;
}

void mpsi_fluid_add_impulses(mps_fluid *f) {
  for (int b = 0; b < MPS_FLUID_MAX_BOUNDARIES; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    if (!w->used) continue;
    const double across = w->force[0] * w->normal[0] + w->force[1] * w->normal[1];
    for (int c = 0; c < 2; c++) w->impulse[c] += w->force[c] * f->dt;
    w->moment_impulse += w->moment * f->dt;
    w->work += across * w->u * f->dt;
    f->work_boundaries += across * w->u * f->dt;
  }
}

/* ---- ghosts ---------------------------------------------------------------------------------- */

static bool square(const mpsi_fluid_wall *a, const mpsi_fluid_wall *b) {
  return fabs(a->normal[0] * b->normal[0] + a->normal[1] * b->normal[1]) < SQUARE;
}

/* Whether an image made at `wall` is dropped: behind another wall that is not at right angles. */
static bool behind_another(const mps_fluid *f, int wall, double x, double y) {
  for (int b = 0; b < MPS_FLUID_MAX_BOUNDARIES; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    if (b == wall || !w->used || square(w, &f->wall[wall])) continue;
    if (mpsi_fluid_distance(w, w->s, x, y) < 0.0) return true;
  }
  return false;
}

/* Only images at walls at right angles to this one are mirrored again. */
static bool mirrors_again(const mps_fluid *f, int wall, uint32_t flips) {
  for (int b = 0; b < wall; b++)
    if ((flips >> b & 1) && !square(&f->wall[b], &f->wall[wall])) return false;
  return true;
}

/* Images of the cloud at one wall; false where there is no room. */
static bool mirror(mps_fluid *f, int wall) {
  const mpsi_fluid_wall *w = &f->wall[wall];
  const int64_t all = f->count + f->ghosts;
  for (int64_t i = 0; i < all; i++) {
    const double x = f->x[0][i], y = f->x[1][i], d = mpsi_fluid_distance(w, w->s, x, y);
    const int64_t ghost = i - f->count;
    if (d >= f->weight.re || d < 0.0) continue;
    if (ghost >= 0 && !mirrors_again(f, wall, f->flips[ghost])) continue;
    const double to[2] = {x - 2.0 * d * w->normal[0], y - 2.0 * d * w->normal[1]};
    if (behind_another(f, wall, to[0], to[1])) continue;
    if (f->count + f->ghosts == f->cloud_capacity) return false;
    const int64_t g = f->ghosts++;
    f->x[0][f->count + g] = to[0], f->x[1][f->count + g] = to[1];
    f->parent[g] = ghost < 0 ? (int32_t)i : f->parent[ghost];
    f->flips[g] = (ghost < 0 ? 0u : f->flips[ghost]) | UINT32_C(1) << wall;
  }
  return true;
}

/* Arrays over the cloud; keeps the particles' part. */
bool mpsi_fluid_grow_cloud(mps_fluid *f, int64_t capacity) {
  enum { COLUMNS = 9 };
  double **column[COLUMNS] = {&f->x[0],      &f->x[1],      &f->u[0],     &f->u[1],    &f->q,
                              &f->slot_x[0], &f->slot_x[1], &f->system.x, &f->system.p};
  const int64_t padded = (capacity + 7) / 8 * 8 + 24;
  double *block = mpsi_alloc(f->context, padded * (COLUMNS + 3), sizeof *block);
  if (!block) return false;
  for (int k = 0; k < COLUMNS; k++) {
    if (f->cloud) memcpy(block + k * padded, *column[k], (size_t)f->count * sizeof *block);
    *column[k] = block + k * padded;
  }
  f->offset = block + COLUMNS * padded;
  f->slot = (int32_t *)(block + (COLUMNS + 1) * padded);
  f->parent = (int32_t *)(block + (COLUMNS + 2) * padded);
  f->flips = (uint32_t *)(f->parent + padded);
  mpsi_free(f->context, f->cloud);
  f->cloud = block;
  f->cloud_capacity = capacity;
  return true;
}

mps_status mpsi_fluid_make_ghosts(mps_fluid *f, const char *function) {
  for (bool room = false; !room;) {
    f->ghosts = 0;
    room = true;
    for (int b = 0; room && b < MPS_FLUID_MAX_BOUNDARIES; b++)
      if (f->wall[b].used) room = mirror(f, b);
    const int64_t capacity = f->cloud_capacity + f->cloud_capacity / 2;
    if (!room && !mpsi_fluid_grow_cloud(f, capacity))
      return mpsi_fail_memory(f->context, function, (size_t)capacity * 12 * sizeof(double));
  }
  f->report.ghosts = f->ghosts;
  return MPS_OK;
}

/* The velocity of an image at wall w of what moves with v. */
static void reflect(const mpsi_fluid_wall *w, double *v) {
  const double across =
      (v[0] - w->u * w->normal[0]) * w->normal[0] + (v[1] - w->u * w->normal[1]) * w->normal[1];
  v[0] -= 2.0 * across * w->normal[0], v[1] -= 2.0 * across * w->normal[1];
}

void mpsi_fluid_move_ghosts(mps_fluid *f) {
  const double rho = f->def.density;
  for (int64_t g = 0; g < f->ghosts; g++) {
    const int64_t j = f->count + g, own = f->parent[g];
    const double apart[2] = {f->x[0][j] - f->x[0][own], f->x[1][j] - f->x[1][own]};
    double v[2] = {f->u[0][own], f->u[1][own]};
    f->offset[g] = 0.0;
    for (int b = 0; b < MPS_FLUID_MAX_BOUNDARIES; b++) {
      if (!(f->flips[g] >> b & 1)) continue;
      const mpsi_fluid_wall *w = &f->wall[b];
      reflect(w, v);
      f->offset[g] -= rho * w->a * (apart[0] * w->normal[0] + apart[1] * w->normal[1]);
    }
    f->u[0][j] = v[0], f->u[1][j] = v[1];
  }
}
