/* move.c - new velocities and positions from the pressure:
 *
 *   grad q = (M + c e e^T)^-1 (sum w (q_j - q_i) dx/r^2 + c (q_s - q_i) e/h),
 *   u += -(dt/rho) grad q, smoothing and viscosity (smooth.c), friction of faces (friction.c).
 *
 * Guards: pairs that approach within l0/2 share their momentum, a particle that strikes a wall is
 * stopped .35 l0 before it, |u| <= 1.1 of the neighbours' largest plus a free fall's share, and no
 * particle comes nearer than .1 l0 to a wall; the report counts them. Then
 *
 *   x += dt u + f,  u += b G f,  f = -2.5 dt s0 l0 sum w dx/(r n0), |f| <= .05 l0,
 *
 * near the surface .3 of its part along it, keeps the particles evenly apart (Lind 2012, Khayyer
 * 2017); s0 = sqrt(g/l0), b = max(0, 1 - |G|^2/(.05 s0^2)).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "move.h"
#include "fluid/base/access.h"
#include "fluid/step/keep_off.h"
#include "fluid/base/loops.h"
#include "fluid/boundary/polyline.h"
#include "fluid/particles/kink.h"
#include "fluid/particles/pores.h"
#include "fluid/ranks/partition.h"
#include "fluid/step/exchange.h"
#include "fluid/step/friction.h"
#include "fluid/step/smooth.h"

#define SHIFT 2.5
#define MOST_SHIFT 0.05 /* l0 */
#define ZONE_SHIFT 0.3  /* of the shift, within 1.6 l0 of the surface */
#define PAIR 0.5        /* l0: where two particles collide */
#define OWN_IMAGE 0.7   /* l0: one and its image, .35 l0 from the wall, .. */
#define IMPACT 0.3      /* (g/l0)^1/2: .. where they approach at this rate */

static void pressure_gradient(const mps_fluid *f, int64_t i, double *gradient) {
  const mpsi_fluid_local *local = &f->local[i];
  double sum[2];
  f->loops->slope(f, i, sum);
  if (f->state[i] == MPSI_FLUID_SURFACE) { /* c = |m|/h and e = -m/|m| */
    const double s = (local->qs - f->q[i]) / (local->h * local->h);
    sum[0] -= s * local->m[0], sum[1] -= s * local->m[1];
  }
  const double *I = local->inverse;
  gradient[0] = I[0] * sum[0] + I[1] * sum[1];
  gradient[1] = I[1] * sum[0] + I[2] * sum[1];
}

static void find_accelerated(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const double rho = f->def.density, dt = f->dt;
  for (int64_t i = begin; i < end; i++) {
    double gradient[2], du[2], u[2] = {f->u[0][i], f->u[1][i]};
    mpsi_fluid_smooth(f, chunk, i, du);
    const mpsi_fluid_pore *pore = mpsi_fluid_pore_of(f, i);
    const double ease = pore ? pore->ease : 1.0;
    if (f->state[i] == MPSI_FLUID_APART) {
      for (int c = 0; c < 2; c++) u[c] -= ease * dt * f->g * f->up[c];
    } else {
      if (!(mpsi_fluid_is_mixed(f, i) && mpsi_fluid_kinked_gradient(f, i, gradient)))
        pressure_gradient(f, i, gradient);
      for (int c = 0; c < 2; c++) u[c] -= ease * dt / rho * gradient[c];
    }
    for (int c = 0; c < 2; c++) f->u_new[c][i] = u[c] + du[c];
  }
}

/* ---- guards ---------------------------------------------------------------------------------- */

/* Limits velocities by those of the neighbours. */
static void limit_speed(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const double allowed = 0.5 * sqrt(f->g * f->l0) + 2.0 * f->g * f->dt;
  int64_t cuts = 0;
  for (int64_t i = begin; i < end; i++) {
    const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
    const double u2 = f->u_new[0][i] * f->u_new[0][i] + f->u_new[1][i] * f->u_new[1][i];
    double most = f->u[0][i] * f->u[0][i] + f->u[1][i] * f->u[1][i];
    const double least = 1.1 * sqrt(most) + allowed;
    if (f->g == 0.0 || !(u2 > least * least)) continue;
    for (int32_t k = 0; k < f->near[i]; k++) {
      const int32_t j = index[k];
      const int64_t own = j < f->count ? j : f->parent[j - f->count];
      most = mpsi_fluid_larger(most, f->u[0][own] * f->u[0][own] + f->u[1][own] * f->u[1][own]);
    }
    const double limit = 1.1 * sqrt(most) + allowed;
    if (!(u2 > limit * limit)) continue;
    const double factor = limit / sqrt(u2);
    for (int c = 0; c < 2; c++) f->u_new[c][i] *= factor;
    cuts++;
  }
  f->system.sums[2 * chunk] = (double)cuts;
}

static void accelerate(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  find_accelerated(f, begin, end, chunk);
  mpsi_fluid_add_friction(f, begin, end, chunk);
  limit_speed(f, begin, end, chunk);
}

static void accelerate_classical(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  mpsi_fluid_classical_accelerate(f, begin, end, chunk);
  mpsi_fluid_add_friction(f, begin, end, chunk);
}

/* The velocity that image j has after the step. */
static void image_velocity(const mps_fluid *f, int64_t ghost, double *v) {
  const int64_t own = f->parent[ghost];
  v[0] = f->u_new[0][own], v[1] = f->u_new[1][own];
  MPSI_FLUID_FLIPS(k, f->flips[ghost]) {
    const mpsi_fluid_wall *w = &f->wall[f->flips[ghost].wall[k]];
    const double u = mpsi_fluid_of_wall(w, w->next.u, f->x[0][own], f->x[1][own]);
    const double across = v[0] * w->normal[0] + v[1] * w->normal[1] - u;
    v[0] -= 2.0 * across * w->normal[0], v[1] -= 2.0 * across * w->normal[1];
  }
  const mpsi_fluid_path *path = mpsi_fluid_path_of(f, ghost);
  if (path) mpsi_fluid_reflect(path, v);
}

/* Pairs that are too close and approach lose half their relative velocity each. A particle and its
 * own image do so earlier: no gradient of pressure stops it, as its image has its pressure, but the
 * closer they come the more divergence they show to the neighbours, and the pressure of a thin jet
 * on a wall rose to 20 rho g H in three steps. The result goes to r and z of the system, free now.
 */
static void collide(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const double l02 = f->l0 * f->l0, pair2 = PAIR * PAIR * l02, own2 = OWN_IMAGE * OWN_IMAGE * l02;
  int64_t collisions = 0;
  for (int64_t i = begin; i < end; i++) {
    const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
    double u[2] = {f->u_new[0][i], f->u_new[1][i]};
    const double own[2] = {u[0], u[1]};
    const int32_t near = f->company[i] & MPSI_FLUID_NEAR_CLOSE ? f->near[i] : 0;
    for (int32_t k = 0; k < near; k++) {
      const int32_t j = index[k];
      const double dx = f->x[0][j] - f->x[0][i], dy = f->x[1][j] - f->x[1][i];
      const double r2 = dx * dx + dy * dy;
      const bool image = j >= f->count && f->parent[j - f->count] == i;
      if (!(r2 < (image ? own2 : pair2)) || !(r2 > 0.0)) continue;
      double v[2];
      if (j < f->count)
        v[0] = f->u_new[0][j], v[1] = f->u_new[1][j];
      else
        image_velocity(f, j - f->count, v);
      const double approach = (own[0] - v[0]) * dx + (own[1] - v[1]) * dy;
      if (!(approach > 0.0)) continue;
      if (!(r2 < pair2 || approach > IMPACT * mpsi_fluid_rate(f) * r2)) continue;
      const double dv[2] = {-0.5 * approach * dx / r2, -0.5 * approach * dy / r2};
      u[0] += dv[0], u[1] += dv[1];
      if (j >= f->count) mpsi_fluid_exchange_image(f, chunk, j - f->count, i, dv);
      collisions++;
    }
    f->system.r[i] = u[0], f->system.z[i] = u[1];
  }
  f->system.sums[2 * chunk + 1] = (double)collisions;
}

static void swap(double **a, double **b) {
  double *const other = *a;
  *a = *b, *b = other;
}

void mpsi_fluid_find_velocities(mps_fluid *f) {
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  const bool classical = f->classical.gamma > 0.0;
  for (int64_t k = 0; k < chunks; k++) f->system.sums[2 * k] = 0.0;
  if (!classical) mpsi_fluid_prepare_smoothing(f);
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, classical ? accelerate_classical : accelerate);
  mpsi_fluid_send_halo(f, 2, f->u_new);
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, collide);
  mpsi_fluid_send_sums(f, MPSI_FLUID_CHUNK);
  swap(&f->u_new[0], &f->system.r);
  swap(&f->u_new[1], &f->system.z);
  for (int64_t k = 0; k < chunks; k++) {
    f->report.limited += (int64_t)f->system.sums[2 * k];
    f->report.collisions += (int64_t)f->system.sums[2 * k + 1];
  }
}

/* ---- positions ------------------------------------------------------------------------------- */

/* The shift that keeps the particles evenly apart. Along the surface it takes water from crests to
 * troughs, so it is less there. In an acute corner it is left out: images of images are missing
 * there, and it would press the particles into the corner. */
static void find_shift(const mps_fluid *f, int64_t i, double *shift) {
  shift[0] = shift[1] = 0.0;
  if (f->state[i] == MPSI_FLUID_APART || (f->company[i] & MPSI_FLUID_NEAR_WEDGE)) return;
  const double size = SHIFT * f->dt * mpsi_fluid_rate(f) * f->l0;
  for (int c = 0; c < 2; c++) shift[c] = -size * f->local[i].shift[c];
  if (f->zone[i]) {
    const double e[2] = {f->zone_normal[0][i], f->zone_normal[1][i]};
    const double across = shift[0] * e[0] + shift[1] * e[1];
    const double least = mpsi_fluid_near_surface(f, i, ZONE_SHIFT);
    for (int c = 0; c < 2; c++) shift[c] = least * (shift[c] - across * e[c]);
  }
  const double length = sqrt(shift[0] * shift[0] + shift[1] * shift[1]), most = MOST_SHIFT * f->l0;
  if (length > most)
    for (int c = 0; c < 2; c++) shift[c] *= most / length;
}

/* Share of G f in the velocity of a shifted particle: all in gentle flow, nothing in breakers. G is
 * that of one side at the root of a jet, and as particles shift into the jet they gain energy by
 * it: two blocks of 10 x 10 particles that strike ended with .94 of theirs, where .73 is right. */
static double carried(const mps_fluid *f, int64_t i) {
  return fmax(1.0 - mpsi_fluid_steepness(f, i), 0.0);
}

/* Puts x of particle i back to `off` from a wall that is nearer than that, and takes its velocity
 * into the wall. */
static bool keep_off(const mps_fluid *f, int wall, int64_t i, double *x, double *u) {
  const mpsi_fluid_wall *w = &f->wall[wall];
  const double d = mpsi_fluid_distance(w, w->next.s, x[0], x[1]), off = MPSI_FLUID_OFF_WALL * f->l0;
  if (d >= off) return false;
  const double moves = mpsi_fluid_of_wall(w, w->next.u, x[0], x[1]);
  const double into = u[0] * w->normal[0] + u[1] * w->normal[1] - moves;
  for (int c = 0; c < 2; c++) {
    x[c] += (off - d) * w->normal[c];
    if (into < 0.0) u[c] -= into * w->normal[c];
  }
  if (into < 0.0)
    mpsi_fluid_exchange_wall(f, i / MPSI_FLUID_CHUNK, wall, i,
                             (double[]){-into * w->normal[0], -into * w->normal[1]});
  return true;
}

/* The planes near a chunk of particles, ascending; -1: all are looked at, as there are few. */
typedef struct planes {
  int count, number[16];
} planes;

/* Largest displacement for which the list is complete: a particle that is put back from a plane
 * comes no farther than twice that. */
static double listed_way(const mps_fluid *f) { return f->weight.re; }

/* Whether a place of the box is nearer to a plane at the end of the step than `reach`. */
static bool is_near(const mpsi_fluid_wall *w, const double *low, const double *high, double reach) {
  double least = 0.0, most = w->next.s[0];
  for (int64_t k = 1; k < w->nodes; k++) most = mpsi_fluid_larger(most, w->next.s[k]);
  for (int c = 0; c < 2; c++)
    least += w->normal[c] * ((w->normal[c] > 0.0 ? low[c] : high[c]) - w->at[c]);
  return !(least - most > reach);
}

static void find_planes(const mps_fluid *f, int64_t begin, int64_t end, planes *near) {
  enum { MOST = sizeof near->number / sizeof *near->number };
  double low[2], high[2];
  near->count = -1;
  if (f->boundaries <= MOST) return;
  for (int c = 0; c < 2; c++) {
    low[c] = high[c] = f->x[c][begin];
    for (int64_t i = begin + 1; i < end; i++) {
      low[c] = f->x[c][i] < low[c] ? f->x[c][i] : low[c];
      high[c] = f->x[c][i] > high[c] ? f->x[c][i] : high[c];
    }
  }
  int count = 0;
  for (int b = 0; b < f->boundaries; b++) {
    if (!f->wall[b].used || !is_near(&f->wall[b], low, high, 2.0 * listed_way(f) + f->l0)) continue;
    if (count == MOST) return;
    near->number[count++] = b;
  }
  near->count = count;
}

static int64_t keep_off_planes(const mps_fluid *f, const planes *near, int64_t i, double *x,
                               double *u) {
  const double way[2] = {x[0] - f->x[0][i], x[1] - f->x[1][i]}, most = listed_way(f);
  const bool listed = near->count >= 0 && way[0] * way[0] + way[1] * way[1] < most * most;
  const int count = listed ? near->count : f->boundaries;
  int64_t pushed = 0;
  for (int k = 0; k < count; k++) {
    const int b = listed ? near->number[k] : k;
    if (f->wall[b].used) pushed += keep_off(f, b, i, x, u);
  }
  return pushed;
}

static int64_t keep_off_walls(const mps_fluid *f, const planes *near, int64_t i, double *x,
                              double *u) {
  int64_t pushed = f->segments > 0 ? mpsi_fluid_keep_off_lines(f, i, x, u) : 0;
  for (int b = 0; b < f->bodies; b++) {
    double d; /* in front of an acute corner less than the distance from the body */
    if (!mpsi_fluid_beside(&f->body[b], x, 2.0 * f->weight.re)) continue;
    const int face = mpsi_fluid_face_of(f, &f->body[b], true, x, &d);
    if (d < MPSI_FLUID_OFF_WALL * f->l0 && f->wall[face].used) pushed += keep_off(f, face, i, x, u);
  }
  return pushed + keep_off_planes(f, near, i, x, u);
}

#define FASTEST 1e100 /* m/s: kinetic energies are numbers */
#define MOST_WAY 0.5  /* l0: of a particle in a step, besides that of the walls */

static bool finite(const double *x, const double *u) {
  return isfinite(x[0]) && isfinite(x[1]) && fabs(u[0]) <= FASTEST && fabs(u[1]) <= FASTEST;
}

static void move_chunk(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const double *before[2], *start[2];
  planes near;
  int64_t pushed = 0;
  double far2 = 0.0, gain[2] = {0.0, 0.0};
  for (int c = 0; c < 2; c++) {
    before[c] = mpsi_particles_column(f->particles, "velocity", c);
    start[c] = mpsi_particles_column(f->particles, "position", c); /* before the classical u* */
  }
  find_planes(f, begin, end, &near);
  for (int64_t i = begin; i < end; i++) {
    double shift[2], x[2], u[2];
    find_shift(f, i, shift);
    /* the classical particles have moved by u* already */
    const bool moved = f->classical.gamma > 0.0;
    double G[4];
    mpsi_fluid_gradient(&f->local[i], G);
    const double part = carried(f, i);
    const mpsi_fluid_pore *pore = mpsi_fluid_pore_of(f, i);
    const double open = pore ? 1.0 / pore->porosity : 1.0;
    for (int c = 0; c < 2; c++) {
      x[c] = f->x[c][i] + open * f->dt * (f->u_new[c][i] - (moved ? f->u[c][i] : 0.0)) + shift[c];
      u[c] = f->u_new[c][i] + part * (G[2 * c] * shift[0] + G[2 * c + 1] * shift[1]);
    }
    pushed += keep_off_walls(f, &near, i, x, u);
    mpsi_fluid_rises(f)[i] = mpsi_fluid_rise(f, i);
    const double way[2] = {x[0] - start[0][i], x[1] - start[1][i]};
    const double way2 = way[0] * way[0] + way[1] * way[1];
    far2 = finite(x, u) ? mpsi_fluid_larger(way2, far2) : (double)INFINITY;
    for (int c = 0; c < 2; c++) {
      f->x[c][i] = x[c], f->u[c][i] = u[c];
      gain[c] += u[c] - before[c][i];
    }
  }
  mpsi_fluid_gain(f, chunk, gain);
  f->system.sums[2 * chunk] = (double)pushed;
  f->system.sums[2 * chunk + 1] = far2;
}

/* m: largest displacement of a wall in the step. */
static double wall_travel(const mps_fluid *f) {
  double most = 0.0;
  for (int b = 0; b < f->walls; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    for (int64_t k = 0; w->used && k < w->nodes; k++)
      most = fmax(most, fabs(w->next.s[k] - w->now.s[k]));
  }
  return most;
}

int64_t mpsi_fluid_advance(mps_fluid *f, double *way) {
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, move_chunk);
  mpsi_fluid_send_sums(f, MPSI_FLUID_CHUNK);
  mpsi_fluid_send_all(
      f, 6,
      (double *const[]){f->x[0], f->x[1], f->u[0], f->u[1], f->pressure, mpsi_fluid_rises(f)});
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  double far2 = 0.0;
  for (int64_t k = 0; k < chunks; k++) {
    f->report.pushed += (int64_t)f->system.sums[2 * k];
    far2 = fmax(far2, f->system.sums[2 * k + 1]);
  }
  const double walls = wall_travel(f), most = MOST_WAY * f->l0 + walls;
  f->travel = sqrt(far2) + walls;
  *way = 0.0;
  if (far2 <= most * most) return -1;
  const double *start[2];
  int64_t farthest = -1;
  for (int c = 0; c < 2; c++) start[c] = mpsi_particles_column(f->particles, "position", c);
  for (int64_t i = 0; i < f->count; i++) {
    const double x[2] = {f->x[0][i], f->x[1][i]}, u[2] = {f->u[0][i], f->u[1][i]};
    const double moved = hypot(x[0] - start[0][i], x[1] - start[1][i]);
    if (!finite(x, u)) {
      *way = INFINITY;
      return i;
    }
    /* a drop by itself flies as far as it flies */
    const bool alone = f->state[i] == MPSI_FLUID_APART && f->classical.gamma == 0.0;
    if (alone || !(moved > *way)) continue;
    /* one that a gap between a body and a wall has closed on comes out of the body */
    if (moved > most && mpsi_fluid_inside_body(f, 0, (double[]){start[0][i], start[1][i]}))
      continue;
    *way = moved, farthest = i;
  }
  return *way > most ? farthest : -1;
}
