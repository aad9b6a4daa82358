/* walls.c - plane walls, their motion, and the mirror images (ghosts) of the particles within re of
 * each. Walls are taken in the order of their numbers, and images are mirrored at later walls that
 * stand at right angles to the earlier ones, so that corners of 90 degrees fill. At other corners
 * only the particles themselves are mirrored, and sight.c finds the visible images.
 *
 * A ghost has the mirrored velocity of its parent relative to the wall (velocity of the previous
 * step: free slip); its reduced pressure is the parent's less rho (a . N)(distance of the two), N
 * out of the fluid: the one place where the wall's new velocity enters.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "walls.h"
#include "fluid/base/access.h"
#include "fluid/boundary/sight.h"
#include "fluid/boundary/vicinity.h"
#include "signal/signal_internal.h"

#include <string.h>

#define LATE 0.005 /* of a wall's acceleration: see late_share */
#define LATE_AT_SURFACE 0.22
#define SQUARE 1e-6 /* cosine of the angle of walls at right angles */

/* ---- motion ---------------------------------------------------------------------------------- */

mps_status mpsi_fluid_look_ahead(mps_fluid *f, const char *function, double dt) {
  const mpsi_guard outer = mpsi_guard_close(&f->guard, f->context, "a signal of the solver");
  mps_status status = MPS_OK;
  for (int b = 0; b < f->boundaries && status == MPS_OK; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    const mpsi_signal_use use = {f->context, function, "boundary", b, -1};
    mpsi_signal_motion m;
    if (!w->used || !w->signal) continue;
    status = mpsi_signal_evaluate(w->signal, use, f->time + dt, &m);
    if (status != MPS_OK) break;
    w->ahead[0] = w->factor * (m.u - w->origin);
    w->ahead[1] = w->factor * m.v;
  }
  if (status == MPS_OK) status = mpsi_fluid_look_ahead_of_bodies(f, function, dt);
  f->guard = outer;
  return status;
}

/* Walls without a new motion continue at their velocity. */
void mpsi_fluid_begin_walls(mps_fluid *f, double dt) {
  for (int b = 0; b < f->walls; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    if (!w->used || w->of_body) continue;
    for (int64_t k = 0; k < w->nodes; k++) {
      if (w->signal) {
        w->next.s[k] = w->ahead[0];
        w->next.u[k] = (w->next.s[k] - w->now.s[k]) / dt;
      } else if (!w->given) {
        w->next.u[k] = w->now.u[k];
        w->next.s[k] = w->now.s[k] + dt * w->now.u[k];
      } else if (!w->placed) {
        w->next.s[k] = w->now.s[k] + 0.5 * dt * (w->now.u[k] + w->next.u[k]);
      }
      w->next.a[k] = (w->next.u[k] - w->now.u[k]) / dt;
      w->mean[k] = (w->next.s[k] - w->now.s[k]) / dt;
    }
  }
  mpsi_fluid_drive_bodies(f, dt);
}

void mpsi_fluid_end_walls(mps_fluid *f) {
  for (int b = 0; b < f->walls; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    if (!w->used || w->of_body) continue;
    memcpy(w->now.s, w->next.s, 3 * (size_t)w->nodes * sizeof *w->now.s);
    w->rate = w->ahead[1];
    w->given = w->placed = false;
  }
  mpsi_fluid_end_bodies(f);
}

void mpsi_fluid_add_impulses(mps_fluid *f) {
  for (int b = 0; b < f->walls; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    if (!w->used && !w->line) continue;
    const mpsi_fluid_load *load = &w->load;
    const mpsi_fluid_struck *struck = &w->struck;
    const double work = load->power * f->dt + struck->work;
    for (int c = 0; c < 2; c++) w->impulse[c] += load->force[c] * f->dt + struck->impulse[c];
    w->moment_impulse += load->moment * f->dt + struck->moment;
    w->work += work;
    f->work_boundaries += work;
  }
}

mps_status mps_fluid_set_boundary_motion(mps_fluid *f, int32_t number,
                                         const double *displacement_of, const double *velocity) {
  if (!f) return mpsi_null(__func__, "fluid");
  MPSI_TRY(mpsi_fluid_free(f, __func__));
  if (MPSI_FLUID_IS_BOUNDARY(f, number) && f->wall[number].line)
    return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT,
                     "number is %d: this boundary is a polyline, which does not move", number);
  if (!MPSI_FLUID_IS_BOUNDARY(f, number) || !f->wall[number].used)
    return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT,
                     "number is %d: there is no boundary of this number", number);
  if (!velocity) return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT, "velocity is NULL");
  mpsi_fluid_wall *w = &f->wall[number];
  if (w->signal)
    return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT,
                     "number is %d: this boundary follows a signal", number);
  for (int64_t k = 0; k < w->nodes; k++) {
    const double s = displacement_of ? displacement_of[k] : 0.0;
    if (!(fabs(velocity[k]) <= 1e6 && fabs(s) <= 1e12))
      return mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT,
                       "velocity of node %lld of boundary %d is %g m/s, its displacement %g m: "
                       "allowed are 1e6 m/s and 1e12 m",
                       (long long)k, number, velocity[k], s);
  }
  for (int64_t k = 0; k < w->nodes; k++) {
    const int64_t from = w->order[k];
    if (displacement_of) w->next.s[k] = displacement_of[from];
    w->next.u[k] = velocity[from];
  }
  w->given = true, w->placed = displacement_of != NULL;
  if (f->stage != MPSI_FLUID_BETWEEN) f->stage = MPSI_FLUID_BEGUN;
  return MPS_OK;
}

/* ---- ghosts ---------------------------------------------------------------------------------- */

static bool square(const mpsi_fluid_wall *a, const mpsi_fluid_wall *b) {
  return fabs(a->normal[0] * b->normal[0] + a->normal[1] * b->normal[1]) < SQUARE;
}

/* Only images at boundaries at right angles to this wall are mirrored again. */
static bool mirrors_again(const mps_fluid *f, int wall, mpsi_fluid_flips flips) {
  MPSI_FLUID_FLIPS(k, flips) {
    const mpsi_fluid_wall *w = &f->wall[flips.wall[k]];
    if (w->of_body || !square(w, &f->wall[wall])) return false;
  }
  return flips.wall[1] == MPSI_FLUID_NO_WALL;
}

static const mpsi_fluid_flips none = {{MPSI_FLUID_NO_WALL, MPSI_FLUID_NO_WALL}};

static mpsi_fluid_flips with(mpsi_fluid_flips flips, int wall) {
  flips.wall[flips.wall[0] == MPSI_FLUID_NO_WALL ? 0 : 1] = (uint16_t)wall;
  return flips;
}

static bool beyond_the_ends(const mps_fluid *f, const mpsi_fluid_wall *w, double x, double y) {
  const double along = mpsi_fluid_along(w, x, y), re = f->reach;
  return along < w->from - re || along > w->to + re;
}

/* Images of [begin, end) of the cloud at one wall; false where there is no room. A bent wall
 * mirrors at its local position, and continues beyond other walls as its mirror image there: at the
 * position of an image's parent. */
static bool mirror(mps_fluid *f, int wall, int64_t begin, int64_t end) {
  const mpsi_fluid_wall *w = &f->wall[wall];
  for (int64_t i = begin; i < end; i++) {
    const int64_t ghost = i - f->count, own = ghost < 0 ? i : f->parent[ghost];
    const double x = f->x[0][i], y = f->x[1][i];
    const double s = mpsi_fluid_of_wall(w, mpsi_fluid_places(f, w), f->x[0][own], f->x[1][own]);
    const double d = (x - w->at[0]) * w->normal[0] + (y - w->at[1]) * w->normal[1] - s;
    if (d >= f->reach || d < 0.0) continue;
    if (ghost >= 0 && !mirrors_again(f, wall, f->flips[ghost])) continue;
    const double to[2] = {x - 2.0 * d * w->normal[0], y - 2.0 * d * w->normal[1]};
    if (w->of_body && beyond_the_ends(f, w, x, y)) continue;
    if (f->ghosts == f->ghost_capacity) return false;
    const int64_t g = f->ghosts++;
    f->x[0][f->count + g] = to[0], f->x[1][f->count + g] = to[1];
    f->parent[g] = (int32_t)own;
    f->flips[g] = with(ghost < 0 ? none : f->flips[ghost], wall);
  }
  return true;
}

/* The box of each chunk's particles. */
static void find_box(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  double *box = (double *)f->box_room.item + 4 * chunk;
  for (int c = 0; c < 2; c++) {
    double low = f->x[c][begin], high = low;
    for (int64_t i = begin + 1; i < end; i++) {
      low = f->x[c][i] < low ? f->x[c][i] : low;
      high = f->x[c][i] > high ? f->x[c][i] : high;
    }
    box[c] = low, box[2 + c] = high;
  }
}

/* Whether a place of the box may be within re of a wall, whose largest displacement is `most`. */
static bool box_is_near(const mps_fluid *f, const mpsi_fluid_wall *w, double most,
                        const double *box) {
  double least = -most;
  for (int c = 0; c < 2; c++)
    least += w->normal[c] * (box[w->normal[c] > 0.0 ? c : 2 + c] - w->at[c]);
  return !(least > f->reach * (1.0 + 10.0 * SQUARE));
}

/* Whether all of the box is beyond the ends of a face, as far as its images reach. */
static bool box_is_beyond(const mps_fluid *f, const mpsi_fluid_wall *w, const double *box) {
  const double walk[2] = {-w->normal[1], w->normal[0]}, re = f->reach * (1.0 + 1e-9);
  double low = 0.0, high = 0.0;
  for (int c = 0; c < 2; c++) {
    low += walk[c] * (box[walk[c] > 0.0 ? c : 2 + c] - w->at[c]);
    high += walk[c] * (box[walk[c] > 0.0 ? 2 + c : c] - w->at[c]);
  }
  return high < w->from - re || low > w->to + re;
}

/* Images of the particles, then of the images so far: those of walls at right angles to this one,
 * which are as far from it as their particles. */
static bool mirror_all(mps_fluid *f, int wall) {
  bool near = false;
  mpsi_fluid_wall *w = &f->wall[wall];
  const int64_t all = f->count + f->ghosts;
  const double *s = mpsi_fluid_places(f, w), *box = f->box_room.item;
  double most = s[0];
  for (int64_t k = 1; k < w->nodes; k++) most = fmax(most, s[k]);
  w->first_image = f->ghosts;
  for (int64_t begin = 0; begin < f->count; begin += MPSI_FLUID_CHUNK, box += 4) {
    const int64_t end = begin + MPSI_FLUID_CHUNK < f->count ? begin + MPSI_FLUID_CHUNK : f->count;
    if (!box_is_near(f, w, most, box)) continue;
    near = true;
    if (w->of_body && box_is_beyond(f, w, box)) continue;
    if (!mirror(f, wall, begin, end)) return false;
  }
  w->images = f->ghosts - w->first_image;
  return !near || mirror(f, wall, f->count, all);
}

/* Arrays over the cloud, and over its ghosts; keeps the particles' part. */
bool mpsi_fluid_grow_cloud(mps_fluid *f, int64_t particles, int64_t ghosts) {
  enum { COLUMNS = 5 };
  double **column[COLUMNS] = {&f->x[0], &f->x[1], &f->u[0], &f->u[1], &f->q};
  const int64_t padded = (particles + ghosts + 7) / 8 * 8 + 24;
  double *block = mpsi_alloc(f->context, padded * COLUMNS + 2 * ghosts, sizeof *block);
  if (!block) return false;
  for (int k = 0; k < COLUMNS; k++) {
    if (f->cloud) memcpy(block + k * padded, *column[k], (size_t)f->count * sizeof *block);
    *column[k] = block + k * padded;
  }
  f->system.x = f->q;
  f->offset = block + COLUMNS * padded;
  f->parent = (int32_t *)(f->offset + ghosts);
  f->flips = (mpsi_fluid_flips *)(f->parent + ghosts);
  mpsi_free(f->context, f->cloud);
  f->cloud = block;
  f->cloud_capacity = particles + ghosts, f->ghost_capacity = ghosts;
  return true;
}

/* Walls that bend, those of no slip, and those with friction. */
static void find_kinds(mps_fluid *f) {
  f->bent = f->sticky = f->rough = 0;
  for (int b = 0; b < f->walls; b++) {
    mpsi_fluid_wall *w = &f->wall[b];
    w->bent = w->used && !w->of_body && w->nodes > 1;
    w->sticky = w->used && (w->kind == MPS_BOUNDARY_HELD || w->kind == MPS_BOUNDARY_DRIVEN);
    f->bent += w->bent, f->sticky += w->sticky;
    f->rough += (w->used || w->line) && w->friction > 0.0;
  }
}

/* False: no room for all images. */
static bool mirror_cloud(mps_fluid *f) {
  f->ghosts = 0;
  for (int b = 0; b < f->walls; b++)
    if (f->wall[b].used && !mirror_all(f, b)) return false;
  return f->segments == 0 || mpsi_fluid_mirror_lines(f);
}

mps_status mpsi_fluid_make_ghosts(mps_fluid *f, const char *function) {
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  if (!mpsi_room_ensure(f->context, &f->box_room, 4 * chunks, sizeof(double)))
    return mpsi_fail_memory(f->context, function, 4 * (size_t)chunks * sizeof(double));
  mpsi_fluid_for_all(f, f->count, MPSI_FLUID_CHUNK, find_box);
  f->travel = 0.0;
  if (!mpsi_fluid_list_segments(f) || (f->segments > 0 && !mpsi_fluid_find_vicinities(f)))
    return mpsi_fail_memory(f->context, function, (size_t)f->segments * sizeof(void *));
  find_kinds(f);
  mpsi_fluid_find_limits(f);
  while (!mirror_cloud(f)) {
    const int64_t ghosts = f->ghost_capacity + f->ghost_capacity / 4 + 256;
    if (!mpsi_fluid_grow_cloud(f, f->capacity, ghosts))
      return mpsi_fail_memory(f->context, function,
                              (size_t)(f->capacity + ghosts) * 7 * sizeof(double));
  }
  f->report.ghosts = f->ghosts;
  return MPS_OK;
}

/* A load acts on an image as on its parent, so that water under a load exerts it on the wall. */
static void move_images(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  for (int64_t g = begin; g < end; g++) {
    const int64_t j = f->count + g, own = f->parent[g];
    double v[2], kick[2] = {0.0, 0.0};
    for (int c = 0; c < 2; c++) {
      if (f->driven) kick[c] = f->dt * f->push[c][own];
      v[c] = f->u[c][own] - kick[c];
    }
    MPSI_FLUID_FLIPS(k, f->flips[g]) {
      const mpsi_fluid_wall *w = &f->wall[f->flips[g].wall[k]];
      const double u = mpsi_fluid_of_wall(w, w->now.u, f->x[0][own], f->x[1][own]);
      const double across = v[0] * w->normal[0] + v[1] * w->normal[1] - u;
      v[0] -= 2.0 * across * w->normal[0], v[1] -= 2.0 * across * w->normal[1];
    }
    const mpsi_fluid_path *path = mpsi_fluid_path_of(f, g);
    if (path) mpsi_fluid_reflect(path, v);
    for (int c = 0; c < 2; c++) f->u[c][j] = v[c] + kick[c];
  }
}

void mpsi_fluid_move_ghosts(mps_fluid *f) {
  mpsi_fluid_for_all(f, f->ghosts, MPSI_FLUID_CHUNK, move_images);
}

/* Fraction of a wall's acceleration that the images of particle i receive a step late, as velocity.
 * The matrix is not quite the divergence of the gradient that moves the particles (move.c), so a
 * step leaves divergence that the next one removes: a force in phase with the wall's velocity.
 * Where the first response is too high that force drives the wall, as where a wall crosses the
 * surface (.3 rho l0^2 of mass, q is r ln r there). With this fraction the first response is too
 * low instead, at every frequency and shape of the wall, and the force damps: by some .005
 * sin(omega dt) m omega. */
static double late_share(const mps_fluid *f, int64_t i) {
  return f->state[i] == MPSI_FLUID_SURFACE ? LATE_AT_SURFACE : LATE;
}

static void press_images(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  for (int64_t g = begin; g < end; g++) {
    const int64_t j = f->count + g, own = f->parent[g];
    const double apart[2] = {f->x[0][j] - f->x[0][own], f->x[1][j] - f->x[1][own]};
    const double rho = (1.0 - late_share(f, own)) * f->def.density;
    f->offset[g] =
        f->push[0] ? rho * (f->push[0][own] * apart[0] + f->push[1][own] * apart[1]) : 0.0;
    MPSI_FLUID_FLIPS(k, f->flips[g]) {
      const mpsi_fluid_wall *w = &f->wall[f->flips[g].wall[k]];
      const double a = mpsi_fluid_of_wall(w, w->next.a, f->x[0][own], f->x[1][own]);
      f->offset[g] -= rho * a * (apart[0] * w->normal[0] + apart[1] * w->normal[1]);
    }
  }
}

void mpsi_fluid_press_ghosts(mps_fluid *f) {
  mpsi_fluid_for_all(f, f->ghosts, MPSI_FLUID_CHUNK, press_images);
}
