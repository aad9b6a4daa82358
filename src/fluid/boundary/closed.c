/* closed.c - fluid that fills a closed space. Without a free surface the pressure equation has only
 * Neumann boundaries: it has a solution only where the walls keep the volume, up to a constant. So
 *
 *   - a step whose walls or bodies change the volume of a closed space that the fluid fills is an
 *     error, as is one with less space than fluid at its end;
 *   - the mean of the right side, then an error of the divergence, is subtracted from it;
 *   - the constant is chosen such that the least pressure of a particle is rho g l0/2, as under a
 *     lid that lies on water at rest.
 *
 * The space is the intersection of the boundaries' half-planes less the bodies: its area follows
 * from the lengths of the boundaries within the others, by the divergence theorem.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "closed.h"
#include "fluid/base/access.h"
#include "fluid/boundary/pose.h"
#include "fluid/ranks/partition.h"

#define ROUNDING 1e-9 /* of the area: largest change in a step that is accepted as none */
#define STAIRS                                                                                     \
  0.25 /* l0: apparent overlap of the fluid with its walls, as a fill's lattice                    \
          follows slopes by steps */

/* ---- space ----------------------------------------------------------------------------------- */

/* The stretch [low, high] of wall b, along it, in front of all other boundaries; false: none. */
static bool stretch(const mps_fluid *f, int b, double *low, double *high) {
  const mpsi_fluid_wall *w = &f->wall[b];
  *low = -INFINITY, *high = INFINITY;
  for (int k = 0; k < f->boundaries; k++) {
    const mpsi_fluid_wall *o = &f->wall[k];
    if (k == b || !o->used) continue;
    const double ahead = mpsi_fluid_distance(o, o->now.s, w->at[0] + w->now.s[0] * w->normal[0],
                                             w->at[1] + w->now.s[0] * w->normal[1]);
    const double slope = -w->normal[1] * o->normal[0] + w->normal[0] * o->normal[1];
    if (fabs(slope) < 1e-12) {
      if (ahead < 0.0) return false;
      continue;
    }
    if (slope > 0.0)
      *low = fmax(*low, -ahead / slope);
    else
      *high = fmin(*high, -ahead / slope);
  }
  return *low < *high;
}

/* Mean over [low, high] along the wall of a displacement at its nodes. */
static double mean_of(const mpsi_fluid_wall *w, const double *s, double low, double high) {
  enum { PARTS = 64 };
  if (w->nodes == 1) return s[0];
  double sum = 0.0;
  for (int k = 0; k < PARTS; k++)
    sum += mpsi_fluid_between(w, s, low + (high - low) * (k + 0.5) / PARTS) / PARTS;
  return sum;
}

/* A polygon that is clipped: at most a corner more by each boundary. */
typedef struct clipped {
  int most;
  double (*x)[2], (*out)[2], *d;
} clipped;

static clipped no_corners(const mps_fluid *f) {
  double *scratch = f->clip_room.item;
  const int64_t most = f->walls;
  return (clipped){(int)most, (double(*)[2])scratch, (double(*)[2])(scratch + 2 * most),
                   scratch + 4 * most};
}

/* Clips a convex polygon of n corners by a wall; returns the number of corners. */
static int cut(const mpsi_fluid_wall *w, int n, const clipped *p) {
  double(*const x)[2] = p->x;
  double(*const out)[2] = p->out;
  double *const d = p->d;
  int count = 0;
  for (int k = 0; k < n; k++) d[k] = mpsi_fluid_distance(w, w->now.s, x[k][0], x[k][1]);
  for (int k = 0; k < n; k++) {
    const int next = (k + 1) % n;
    if (d[k] >= 0.0 && count < p->most) out[count][0] = x[k][0], out[count][1] = x[k][1], count++;
    if ((d[k] >= 0.0) == (d[next] >= 0.0) || count == p->most) continue;
    const double t = d[k] / (d[k] - d[next]);
    for (int c = 0; c < 2; c++) out[count][c] = x[k][c] + t * (x[next][c] - x[k][c]);
    count++;
  }
  for (int k = 0; k < count; k++) x[k][0] = out[k][0], x[k][1] = out[k][1];
  return count;
}

/* Area of the part of a body in front of all boundaries, at the beginning or the end of the step.
 */
static double body_area(const mps_fluid *f, const mpsi_fluid_body *body, bool next) {
  const clipped polygon = no_corners(f);
  double(*const x)[2] = polygon.x;
  double area = 0.0;
  int n = body->faces;
  for (int k = 0; k < n; k++) mpsi_fluid_corner(body, next, k, x[k]);
  for (int b = 0; b < f->boundaries && n > 0; b++)
    if (f->wall[b].used) n = cut(&f->wall[b], n, &polygon);
  const double *a = n > 0 ? x[0] : NULL, *c = a;
  for (int k = 1; k < n; k++) { /* c: the corner before b */
    const double *b = x[k];
    area += 0.5 * ((c[0] - a[0]) * (b[1] - a[1]) - (c[1] - a[1]) * (b[0] - a[0]));
    c = b;
  }
  return area;
}

typedef struct space {
  double area, change, around; /* m2; m2 in the step being made; m, length of its walls */
} space;

/* False where the boundaries enclose none. */
static bool find_space(const mps_fluid *f, space *s) {
  *s = (space){0};
  for (int b = 0; b < f->boundaries; b++) {
    const mpsi_fluid_wall *w = &f->wall[b];
    double low, high;
    if (!w->used || !stretch(f, b, &low, &high)) continue;
    if (!isfinite(low) || !isfinite(high)) return false;
    const double from[2] = {f->x[0][0], f->x[1][0]}, length = high - low;
    const double is = mean_of(w, w->now.s, low, high), to = mean_of(w, w->next.s, low, high);
    s->area += 0.5 * length * (mpsi_fluid_distance(w, w->now.s, from[0], from[1]));
    s->change -= length * (to - is);
    s->around += length;
  }
  for (int b = 0; b < f->bodies; b++) {
    if (!f->body[b].body) continue;
    const double area = body_area(f, &f->body[b], false);
    s->area -= area;
    s->change -= body_area(f, &f->body[b], true) - area;
    for (int k = 0; k < f->body[b].faces; k++) s->around += f->wall[f->body[b].first + k].length;
  }
  return s->area > 0.0;
}

static bool stands_there(const mps_fluid *f, const mpsi_fluid_body *body, int b) {
  for (int k = 0; k < body->faces; k++)
    if (mpsi_fluid_stands_on(f, &f->wall[body->first + k], 0, b)) return true;
  return false;
}

/* A moving body that stands on several boundaries, which may divide the fluid into parts of unknown
 * volume. -1: none. */
static int parting_body(const mps_fluid *f) {
  for (int b = 0; b < f->bodies; b++) {
    const mpsi_fluid_body *body = &f->body[b];
    int on = 0;
    for (int k = 0; k < f->boundaries; k++) on += stands_there(f, body, k);
    double moved = 0.0;
    for (int k = 0; k < body->faces; k++)
      for (int n = 0; n < 2; n++) moved = fmax(moved, fabs(f->wall[body->first + k].next.s[n]));
    if (on > 1 && moved > ROUNDING * f->l0) return b;
  }
  return -1;
}

mps_status mpsi_fluid_check_space(mps_fluid *f, const char *function) {
  space s;
  if (f->segments > 0 || !find_space(f, &s)) return MPS_OK; /* of plane walls alone */
  const double fluid = (double)f->count * f->l0 * f->l0;
  if (f->report.surface == 0 && fabs(s.change) > ROUNDING * s.area)
    return mpsi_fail(
        f->context, function, MPS_ERROR_STATE,
        "step %lld, t = %g s: the fluid has no free surface, and walls and bodies change "
        "the %g m2 that it fills by %g m2: allowed are motions that keep the volume; the "
        "step is not made",
        (long long)f->steps, f->time, s.area, s.change);
  const int parting = f->report.surface == 0 ? parting_body(f) : -1;
  if (parting >= 0)
    return mpsi_fail(
        f->context, function, MPS_ERROR_STATE,
        "step %lld, t = %g s: the fluid has no free surface, and body %d, which stands on "
        "several boundaries, moves: it may part the fluid into volumes that change; the "
        "step is not made",
        (long long)f->steps, f->time, parting);
  if (fluid > s.area + s.change + STAIRS * f->l0 * s.around)
    return mpsi_fail(
        f->context, function, MPS_ERROR_STATE,
        "step %lld, t = %g s: walls and bodies leave %g m2 for %g m2 of fluid; the step "
        "is not made",
        (long long)f->steps, f->time, s.area + s.change, fluid);
  return MPS_OK;
}

/* ---- pressure -------------------------------------------------------------------------------- */

static void sum_right(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  double sum = 0.0, rows = 0.0;
  for (int64_t i = begin; i < end; i++) {
    if (f->state[i] == MPSI_FLUID_APART) continue;
    sum += f->system.right[i], rows += 1.0;
  }
  f->system.sums[2 * chunk] = sum, f->system.sums[2 * chunk + 1] = rows;
}

static void shift_right(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  for (int64_t i = begin; i < end; i++)
    if (f->state[i] != MPSI_FLUID_APART) f->system.right[i] -= f->system.mean;
}

void mpsi_fluid_balance(mps_fluid *f) {
  if (f->report.surface > 0) return;
  double sum = 0.0, rows = 0.0;
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, sum_right);
  mpsi_fluid_send_sums(f, MPSI_FLUID_CHUNK);
  for (int64_t k = 0; k * MPSI_FLUID_CHUNK < f->count; k++)
    sum += f->system.sums[2 * k], rows += f->system.sums[2 * k + 1];
  f->system.mean = rows > 0.0 ? sum / rows : 0.0;
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, shift_right);
}

static void find_least(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  double least = INFINITY;
  for (int64_t i = begin; i < end; i++)
    if (f->state[i] != MPSI_FLUID_APART)
      least = fmin(least, f->system.x[i] - mpsi_fluid_head(f, f->x[0][i], f->x[1][i]));
  f->system.sums[2 * chunk] = least, f->system.sums[2 * chunk + 1] = 0.0;
}

static void shift_solution(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  for (int64_t i = begin; i < end; i++) f->system.x[i] += f->system.mean;
}

void mpsi_fluid_set_level(mps_fluid *f) {
  if (f->report.surface > 0) return;
  double least = INFINITY;
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, find_least);
  mpsi_fluid_send_sums(f, MPSI_FLUID_CHUNK);
  for (int64_t k = 0; k * MPSI_FLUID_CHUNK < f->count; k++)
    least = fmin(least, f->system.sums[2 * k]);
  f->system.mean = isfinite(least) ? 0.5 * f->def.density * f->g * f->l0 - least : 0.0;
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, shift_solution);
}
