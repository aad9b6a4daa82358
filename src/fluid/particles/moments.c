/* moments.c - moments of each particle's neighbourhood, ghosts included, with w = (1-z)^4 (1+4z), z
 * = r/re:
 *
 *   n = sum w,  m = sum w dx,  S = sum w r^2/4,  M = sum w dx dx^T/r^2,
 *   G = grad u = (sum w du dx^T/r^2) M^-1.
 *
 * A particle is at the free surface where |m| > .15 n0 l0 and no particle is within 2.1 l0 inside
 * the cone of 45 degrees about e = -m/|m|, or where n < .72 n0 (Tsukamoto 2016, Marrone 2010), but
 * not where e points into an acute corner between a body and a boundary (sight.c), nor deep in the
 * wake of a body's corner. At a rock's face
 * the lattices of water and rock may part, so that n is small within the fluid: there the cone
 * alone decides, as long as the larger spacing asks. The surface then lies at x + h e, h = l0 (1/2
 * + (n - n_half)/n_slope): in an undisturbed lattice half a spacing outside. A particle with n <
 * .12 n0 is isolated and falls freely.
 *
 * Particles of the second row have missing neighbours beyond the surface too (|m| = .06 n0 l0 in a
 * lattice). Without a surface term their row of the pressure equation is not exact for a linear q,
 * and water that a wall accelerates responds at first as if its surface were .2 l0 higher. Their
 * surface point is the mean of those of their neighbours at the surface, with c = |m|/h too.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "moments.h"
#include "fluid/base/access.h"
#include "fluid/boundary/sight.h"
#include "fluid/boundary/turn.h"
#include "fluid/base/loops.h"
#include "fluid/boundary/polyline.h"
#include "fluid/particles/pores.h"
#include "fluid/ranks/partition.h"

#define APART 0.12     /* n/n0 */
#define FEW 0.72       /* n/n0 */
#define LEVEL 0.35     /* n/n0: below, spray, without a level */
#define ONE_SIDED 0.15 /* |m|/(n0 l0) */
#define WAKE 6.0       /* l0, from a corner of a body */
#define DEEP 6.0       /* l0, below the level of the water at rest */
#define PRESSED 3.0    /* rho g l0, in the last step */
#define GAP 0.5        /* n/n0, of a gap in a wake at least */
#define CONE_REACH 2.1 /* l0 */
#define CONE 0.70710678118654752
#define LEAST_RATIO 0.1 /* of the eigenvalues of M */
#define ZONE 1.6        /* l0 */
#define FADE 0.5        /* l0, along a segment from a corner around which the water turns */
#define FADE_FACE 1.0   /* l0, the same along a face of a body, of all images */
#define OPPOSITE -0.9   /* product of the normals of walls with a gap in between */
#define SQUEEZED 0.9    /* l0, width of a gap that holds no particle */
#define LONELY 9        /* neighbours there: images of three particles */
#define PARTED 0.05  /* l0^2, mean square of the distances along a gap: others are beyond reach */
#define WIDE 1.5     /* l0, width of a gap with whole rows along it */
#define CUT_OFF 0.01 /* of all particles in a narrow gap: a row there may be cut off as a whole */
#define HOLDING 0.3  /* l0^2, likewise: particles along the gap are neighbours */
#define LEAST_DEPTH 0.5 /* l0, of the second row below the surface */

static double invert(const double *M, double *inverse) {
  const double det = M[0] * M[2] - M[1] * M[1];
  inverse[0] = M[2] / det, inverse[1] = -M[1] / det, inverse[2] = M[0] / det;
  return det;
}

/* Adds to the diagonal of M where its smaller eigenvalue is below a tenth of the larger one. */
static void regularise(double *M) {
  const double mean = 0.5 * (M[0] + M[2]);
  const double half = sqrt(0.25 * (M[0] - M[2]) * (M[0] - M[2]) + M[1] * M[1]);
  const double largest = mean + half, smallest = mean - half;
  const double add = LEAST_RATIO * largest - smallest;
  if (add > 0.0) M[0] += add, M[2] += add;
}

/* Spacing of a particle, m; at a rock's face the largest of all. */
static double spacing_at(const mps_fluid *f, int64_t i) {
  if (mpsi_fluid_is_mixed(f, i)) return f->rocks->spacing;
  return f->rocks ? mpsi_fluid_pore_of(f, i)->spacing : f->l0;
}

/* True where no particle is in the cone about e. */
static bool sees_out(const mps_fluid *f, int64_t i, const double *e) {
  const double spacing = spacing_at(f, i);
  const double reach2 = CONE_REACH * CONE_REACH * spacing * spacing;
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  for (int32_t k = 0; k < f->near[i]; k++) {
    const double dx = f->x[0][index[k]] - f->x[0][i], dy = f->x[1][index[k]] - f->x[1][i];
    const double r2 = dx * dx + dy * dy, along = dx * e[0] + dy * e[1];
    if (r2 < reach2 && along > 0.0 && along * along > CONE * CONE * r2) return false;
  }
  return true;
}

/* Deep beside a body's corner and under pressure in the last step. Where water parts from a corner
 * its particles do too, and a gap between them passed for the surface: no pressure in one place for
 * a step. */
static bool in_wake(const mps_fluid *f, int64_t i) {
  const double unit = f->def.density * f->g * f->l0;
  const double head = mpsi_fluid_head(f, f->x[0][i], f->x[1][i]); /* f->q: of the last step */
  const double depth = f->rest - (f->up[0] * f->x[0][i] + f->up[1] * f->x[1][i]);
  const double air = f->over && f->last_dt > 0.0 ? f->over[i] : 0.0;
  return depth > DEEP * f->l0 && f->q[i] - head - air > PRESSED * unit &&
         mpsi_fluid_within(f, i, WAKE * f->l0);
}

static bool at_surface(const mps_fluid *f, int64_t i, double n, const double *m, double length) {
  if (!(length > 0.0)) return false;
  const double e[2] = {-m[0] / length, -m[1] / length};
  const double n0 = mpsi_fluid_full(f, i);
  const double spacing = f->rocks ? mpsi_fluid_pore_of(f, i)->spacing : f->l0;
  const bool few = n < FEW * n0;
  if (!few && !(length > ONE_SIDED * n0 * spacing)) return false;
  if (f->faces && n > GAP * n0 && in_wake(f, i)) return false;
  const bool wedge = f->company[i] & MPSI_FLUID_NEAR_WEDGE;
  const bool sure = few && !mpsi_fluid_is_mixed(f, i); /* lattices part at a rock's face */
  return (sure || sees_out(f, i, e)) && !(wedge && mpsi_fluid_near_wedge(f, i, e));
}

/* Position of the surface, and M with it. */
static void place_surface(const mps_fluid *f, int64_t i, const double *M, double length,
                          mpsi_fluid_local *local) {
  const double e[2] = {-local->m[0] / length, -local->m[1] / length};
  const mpsi_fluid_weight *full = f->rocks ? mpsi_fluid_pore_of(f, i)->weight : &f->weight;
  const double l0 = f->rocks ? mpsi_fluid_pore_of(f, i)->spacing : f->l0;
  const double h =
      l0 * (0.5 + ((f->rocks ? mpsi_fluid_fill(f, i) : local->n) - full->half) / full->slope);
  local->h = fmin(fmax(h, 0.1 * l0), 2.0 * l0);
  local->qs = mpsi_fluid_head(f, f->x[0][i] + local->h * e[0], f->x[1][i] + local->h * e[1]);
  if (f->over) local->qs += f->over[i];
  local->qs += mpsi_fluid_surface_stress(f, local);
  const double c = mpsi_fluid_surface_weight(local);
  const double with[3] = {M[0] + c * e[0] * e[0], M[1] + c * e[0] * e[1], M[2] + c * e[1] * e[1]};
  invert(with, local->inverse);
}

/* Marks all particles within 1.6 l0 of a surface particle, own images included, as possibly in its
 * zone. At a bent wall two particles may be at different distances from each other's images. */
static void mark_zone(mps_fluid *f, int64_t i) {
  const double reach2 = 1.2 * ZONE * ZONE * f->l0 * f->l0;
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  atomic_store_explicit(&f->zone[i], 1, memory_order_relaxed);
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int32_t j = index[k], own = j < f->count ? j : f->parent[j - f->count];
    const double dx = f->x[0][j] - f->x[0][i], dy = f->x[1][j] - f->x[1][i];
    if (dx * dx + dy * dy < reach2) atomic_store_explicit(&f->zone[own], 1, memory_order_relaxed);
  }
}

/* Takes out of a particle's divergence what its own images in segments of a polyline add within
 * half a spacing of the end of the segment, at a corner around which the water turns: all of it at
 * the end, where the image appears. */
static void fade_divergence(const mps_fluid *f, int64_t i, const double *I, double *divergence) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t j = index[k];
    if (j < f->count || f->parent[j - f->count] != i) continue;
    const mpsi_fluid_path *path = mpsi_fluid_path_of(f, j - f->count);
    if (!path || path->count != 1) continue;
    const double x[2] = {f->x[0][i], f->x[1][i]};
    const double seen = mpsi_fluid_past_turn(mpsi_fluid_segment_of(f, path->segment[0]), x);
    const double part = 1.0 - seen / (FADE * f->l0);
    if (!(part > 0.0)) continue;
    const double d[2] = {f->x[0][j] - x[0], f->x[1][j] - x[1]};
    const double du[2] = {f->u[0][j] - f->u[0][i], f->u[1][j] - f->u[1][i]};
    const double r2 = fmax(d[0] * d[0] + d[1] * d[1], 0.0025 * f->l0 * f->l0);
    *divergence -= part * w[k] / r2 *
                   (du[0] * (I[0] * d[0] + I[1] * d[1]) + du[1] * (I[1] * d[0] + I[2] * d[1]));
  }
}

/* Divergence without what images in faces of bodies add whose line of sight passes the face within
 * a spacing of a corner: all of it at the corner, where such an image appears or vanishes. A moving
 * body's images differ by twice its velocity, and one that came at once was a blow of pressure:
 * white noise of 40 N rms on a box of 785 N in heave, 1.7 N with all of them faded. A particle's
 * own image stays where water rushes past the body. One that it does not hold has neighbours on one
 * side alone: the faster it goes towards them the more the pressure rises between them, and drives
 * it on. So particles below a wedge's tip ran away from it. */
static void fade_faces(const mps_fluid *f, int64_t i, const mpsi_fluid_sums *all,
                       double *divergence) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  double M[3] = {all->M[0], all->M[1], all->M[2]}, I[3];
  double G[4] = {all->G[0], all->G[1], all->G[2], all->G[3]};
  const double rush = mpsi_fluid_rush(f, i, f->reach);
  bool any = false;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t j = index[k];
    if (j < f->count) continue;
    const double past = mpsi_fluid_past_corner(f, i, j - f->count);
    double part = 1.0 - fmax(past, 0.0) / (FADE_FACE * f->l0);
    if (!(part > 0.0)) continue;
    if (f->parent[j - f->count] == i) part *= 1.0 - rush;
    const double d[2] = {f->x[0][j] - f->x[0][i], f->x[1][j] - f->x[1][i]};
    const double du[2] = {f->u[0][j] - f->u[0][i], f->u[1][j] - f->u[1][i]};
    const double r2 = fmax(d[0] * d[0] + d[1] * d[1], 0.0025 * f->l0 * f->l0);
    const double c = part * w[k] / r2;
    M[0] -= c * d[0] * d[0], M[1] -= c * d[0] * d[1], M[2] -= c * d[1] * d[1];
    for (int q = 0; q < 2; q++) G[q] -= c * du[0] * d[q], G[2 + q] -= c * du[1] * d[q];
    any = true;
  }
  if (!any) return;
  regularise(M);
  invert(M, I);
  *divergence = G[0] * I[0] + (G[1] + G[2]) * I[1] + G[3] * I[2];
}

/* Whether particle i may see an image past a body's corner. */
static bool sees_corner(const mps_fluid *f, int64_t i) {
  return f->faces && (f->company[i] & MPSI_FLUID_NEAR_IMAGES) &&
         mpsi_fluid_within(f, i, f->reach + FADE_FACE * f->l0);
}

/* Takes the flow around a corner out of what a linear field leaves of the velocities. */
static void take_turn(mps_fluid *f, int64_t i, mpsi_fluid_local *local) {
  mpsi_fluid_turn turn;
  if (!mpsi_fluid_fit_turn(f, i, &turn)) return;
  for (int c = 0; c < 2; c++) local->rest[c] -= (float)turn.rest[c];
}

/* The narrowest gap between a body's face and a wall opposite, in both of which particle i has an
 * image of its own: its width, m, and a unit vector along it. Infinite: none. */
static double gap_around(const mps_fluid *f, int64_t i, double *along) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const double x[2] = {f->x[0][i], f->x[1][i]};
  const mpsi_fluid_wall *seen[8];
  double least = INFINITY;
  int count = 0;
  if (!(f->company[i] & MPSI_FLUID_NEAR_IMAGES) || (f->company[i] & MPSI_FLUID_NEAR_WEDGE))
    return least;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t ghost = index[k] - f->count;
    if (ghost < 0 || f->parent[ghost] != i) continue;
    const mpsi_fluid_flips *flips = &f->flips[ghost];
    if (flips->wall[0] == MPSI_FLUID_NO_WALL || flips->wall[1] != MPSI_FLUID_NO_WALL) continue;
    const mpsi_fluid_wall *w = &f->wall[flips->wall[0]];
    const double d = mpsi_fluid_distance(w, w->now.s, x[0], x[1]);
    for (int n = 0; n < count; n++) {
      const mpsi_fluid_wall *o = seen[n];
      const double across = w->normal[0] * o->normal[0] + w->normal[1] * o->normal[1];
      const double width = d + mpsi_fluid_distance(o, o->now.s, x[0], x[1]);
      if (!(w->of_body || o->of_body) || !(across < OPPOSITE) || !(width < least)) continue;
      least = width, along[0] = -w->normal[1], along[1] = w->normal[0];
    }
    if (count < 8) seen[count++] = w;
  }
  return least;
}

double mpsi_fluid_squeezed(const mps_fluid *f, int64_t i) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  double along[2] = {0.0, 0.0}, square = 0.0;
  const double width = gap_around(f, i, along);
  if (width < SQUEEZED * f->l0 && f->near[i] <= LONELY) return 1.0;
  if (!isfinite(width) || f->state[i] != MPSI_FLUID_INSIDE) return 0.0;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const double d =
        (f->x[0][index[k]] - f->x[0][i]) * along[0] + (f->x[1][index[k]] - f->x[1][i]) * along[1];
    square += w[k] * d * d;
  }
  const double spread = square / (f->local[i].n * f->l0 * f->l0);
  const double parted = (HOLDING - spread) / (HOLDING - PARTED);
  const double narrow = (WIDE - width / f->l0) / (WIDE - SQUEEZED);
  return fmin(fmax(fmax(parted, CUT_OFF * fmin(narrow, 1.0)), 0.0), 1.0);
}

static void look_around(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const bool near_rock = mpsi_fluid_near_rock(f, chunk);
  for (int64_t i = begin; i < end; i++) {
    mpsi_fluid_sums s;
    f->loops->add_up(f, i, &s);
    const double n0 = mpsi_fluid_full(f, i), plain[2] = {s.m[0], s.m[1]};
    if (near_rock)
      mpsi_fluid_sum_pores(f, i, &s);
    else if (f->rocks)
      mpsi_fluid_pore_of(f, i)->fill = s.n;
    mpsi_fluid_local local = {.n = s.n, .m = {s.m[0], s.m[1]}, .S = (float)(0.25 * s.r2)};
    const double fill = f->rocks ? mpsi_fluid_fill(f, i) : s.n;
    f->state[i] = MPSI_FLUID_APART;
    double M[3] = {s.M[0], s.M[1], s.M[2]};
    if (f->near[i] >= 2 && s.n >= APART * n0) {
      regularise(M);
      const double *I = local.inverse;
      invert(M, local.inverse);
      for (int c = 0; c < 2; c++) {
        const double *sum = s.G + 2 * c;
        const double by_x = sum[0] * I[0] + sum[1] * I[1], by_y = sum[0] * I[1] + sum[1] * I[2];
        local.divergence += c == 0 ? by_x : by_y;
        local.shear[2 * c] = (float)by_x;
        if (c == 0) local.shear[1] = (float)by_y;
        local.rest[c] = (float)((s.du[c] - by_x * plain[0] - by_y * plain[1]) / s.n);
        local.shift[c] = (float)(s.shift[c] / n0);
      }
      if (f->faces || f->segments > 0) take_turn(f, i, &local);
      const double whole = local.divergence;
      if (f->segments > 0 && mpsi_fluid_near_turn(f, i))
        fade_divergence(f, i, I, &local.divergence);
      if (sees_corner(f, i)) fade_faces(f, i, &s, &local.divergence);
      /* of xx and yy, which is the divergence less xx, half each */
      if (local.divergence != whole) local.shear[0] += (float)(0.5 * (local.divergence - whole));
      const double length = sqrt(s.m[0] * s.m[0] + s.m[1] * s.m[1]);
      f->state[i] = at_surface(f, i, fill, s.m, length) ? MPSI_FLUID_SURFACE : MPSI_FLUID_INSIDE;
      if (f->state[i] == MPSI_FLUID_SURFACE) place_surface(f, i, M, length, &local);
    }
    f->local[i] = local;
    if (f->state[i] != MPSI_FLUID_INSIDE) mark_zone(f, i);
  }
}

/* The vector m of a particle's image. */
static void mirrored_moment(const mps_fluid *f, int64_t ghost, double *m) {
  const mpsi_fluid_local *local = &f->local[f->parent[ghost]];
  m[0] = local->m[0], m[1] = local->m[1];
  MPSI_FLUID_FLIPS(k, f->flips[ghost]) {
    const double *N = f->wall[f->flips[ghost].wall[k]].normal;
    const double across = m[0] * N[0] + m[1] * N[1];
    m[0] -= 2.0 * across * N[0], m[1] -= 2.0 * across * N[1];
  }
  const mpsi_fluid_path *path = mpsi_fluid_path_of(f, ghost);
  if (path) mpsi_fluid_reflect(path, m);
}

/* Particles near the surface, and the surface's mean direction there. */
static void find_zone(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const double reach2 = ZONE * ZONE * f->l0 * f->l0;
  for (int64_t i = begin; i < end; i++) {
    if (!f->zone[i]) continue;
    const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
    const float *w = f->w + mpsi_fluid_pairs(f, i);
    bool near = f->state[i] != MPSI_FLUID_INSIDE;
    double sum[2] = {near ? f->local[i].m[0] : 0.0, near ? f->local[i].m[1] : 0.0};
    for (int32_t k = 0; k < f->near[i]; k++) {
      const int64_t j = index[k], ghost = j - f->count;
      const int64_t own = ghost < 0 ? j : f->parent[ghost];
      if (f->state[own] != MPSI_FLUID_SURFACE) continue;
      const double dx = f->x[0][j] - f->x[0][i], dy = f->x[1][j] - f->x[1][i];
      if (dx * dx + dy * dy >= reach2) continue;
      double m[2] = {f->local[own].m[0], f->local[own].m[1]};
      if (ghost >= 0) mirrored_moment(f, ghost, m);
      sum[0] += w[k] * m[0], sum[1] += w[k] * m[1];
      near = true;
    }
    const double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1]) + 1e-300;
    f->zone[i] = near;
    for (int c = 0; c < 2; c++) f->zone_normal[c][i] = (float)(-sum[c] / length);
  }
}

/* Distance (m) along e to the mean surface point of i's neighbours at the surface; 0: none. *over
 * receives their mean pressure, Pa. Images are left out: on average they add nothing. */
static double depth_below(const mps_fluid *f, int64_t i, const double *e, double *over) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  double sum = 0.0, depth = 0.0;
  *over = 0.0;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int32_t j = index[k];
    if (j >= f->count || f->state[j] != MPSI_FLUID_SURFACE) continue;
    const double *m = f->local[j].m, size = f->local[j].h / sqrt(m[0] * m[0] + m[1] * m[1]);
    const double to[2] = {f->x[0][j] - size * m[0] - f->x[0][i],
                          f->x[1][j] - size * m[1] - f->x[1][i]};
    sum += w[k], depth += w[k] * (to[0] * e[0] + to[1] * e[1]);
    if (f->over) *over += w[k] * f->over[j];
  }
  if (!(sum > 0.0)) return 0.0;
  *over /= sum;
  return depth / sum;
}

/* Surface terms of the second row. */
static void find_depths(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  for (int64_t i = begin; i < end; i++) {
    mpsi_fluid_local *local = &f->local[i];
    if (!f->zone[i] || f->state[i] != MPSI_FLUID_INSIDE) continue;
    if (f->company[i] & MPSI_FLUID_NEAR_WEDGE) continue; /* m is that of missing images */
    const double length = sqrt(local->m[0] * local->m[0] + local->m[1] * local->m[1]);
    if (!(length > 0.0)) continue;
    const double e[2] = {-local->m[0] / length, -local->m[1] / length};
    double over;
    const double h = depth_below(f, i, e, &over);
    if (!(h > LEAST_DEPTH * f->l0 && h < f->weight.re)) continue;
    local->h = h;
    local->qs = mpsi_fluid_head(f, f->x[0][i] + h * e[0], f->x[1][i] + h * e[1]) + over;
    local->qs += mpsi_fluid_surface_stress(f, local);
  }
}

void mpsi_fluid_count(mps_fluid *f) {
  int64_t surface = 0, apart = 0, pairs = 0;
  for (int64_t i = 0; i < f->count; i++) {
    surface += f->state[i] == MPSI_FLUID_SURFACE;
    apart += f->state[i] == MPSI_FLUID_APART;
    pairs += f->near[i];
  }
  f->report.surface = surface, f->report.apart = apart, f->report.pairs = pairs;
}

double mpsi_fluid_rise(const mps_fluid *f, int64_t i) {
  const mpsi_fluid_local *local = &f->local[i];
  if (f->state[i] != MPSI_FLUID_SURFACE || mpsi_fluid_fill(f, i) < LEVEL * mpsi_fluid_full(f, i))
    return 0.0;
  const double length = sqrt(local->m[0] * local->m[0] + local->m[1] * local->m[1]);
  return -(local->m[0] * f->up[0] + local->m[1] * f->up[1]) / length * local->h;
}

void mpsi_fluid_find_moments(mps_fluid *f) {
  for (int64_t i = 0; i < f->count; i++) atomic_init(&f->zone[i], 0);
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, look_around);
  mpsi_fluid_send_moments(f);
  mpsi_fluid_count(f);
  f->any_apart = f->report.apart > 0;
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, find_zone);
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, find_depths);
}
