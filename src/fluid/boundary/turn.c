/* turn.c - water that turns around a convex corner of a body or a polyline has there, with
 * z = r e^(i theta) from one of the faces and the angle beta of the water, the potential and
 * velocity
 *
 *   phi = A Re z^p,  u - i v = A p z^(p - 1),  p = pi/beta < 1.
 *
 * Its gradient grows without bound towards the corner, so what a linear fit to the neighbours
 * leaves of it is no roughness: smoothing that took it for one made .46 (five spacings of
 * draught) to .30 (ten) of the damping of a box in heave, where waves should take it all, and
 * sloshing over an upright baffle of a polyline lose .31 and .17 of itself in a period. Within
 * four spacings of a corner the strength A is fitted to what the linear fit leaves of the
 * velocities,
 *
 *   A = sum w r^-2 (du - G dx) . (ds - G_s dx)/sum w r^-2 |ds - G_s dx|^2,  s of A = 1,
 *
 * and smoothing acts on what remains of it. An image has the mirrored s of its parent.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "turn.h"

#include "fluid/boundary/sight.h"
#include "fluid/boundary/vicinity.h"
#include "fluid/particles/pores.h"

#define REACH 4.0  /* l0 */
#define LEAST 0.05 /* l0: distances count as no less */
#define SHARP 0.5  /* rad: corners that turn by less are none */
#define ALIKE 1e-3 /* of sum w |ds|^2/r^2: what a linear fit leaves is 0 */
#define PI 3.141592653589793

/* The nearest corner yet. */
typedef struct nearest {
  double reach; /* m: how far it is, or may be */
  const mpsi_fluid_wall *face;
  double power;
} nearest;

/* A corner where the wall w begins, around which the water turns by `turn` beyond half a turn. */
static void try_corner(const mpsi_fluid_wall *w, double turn, const double *x, nearest *to) {
  const double r = hypot(x[0] - w->at[0], x[1] - w->at[1]);
  if (turn > SHARP && r < to->reach) *to = (nearest){r, w, PI / (PI + turn)};
}

/* The face or segment that begins at the nearest corner around which the water turns; and p. */
static nearest find_corner(const mps_fluid *f, int64_t i) {
  const double x[2] = {f->x[0][i], f->x[1][i]};
  nearest found = {.reach = REACH * f->l0};
  for (int n = 0; n < f->bodies && f->faces > 0; n++) {
    const mpsi_fluid_body *body = &f->body[n];
    if (!mpsi_fluid_beside(body, x, found.reach)) continue;
    for (int k = 0; k < body->faces; k++) {
      const mpsi_fluid_wall *w = &f->wall[body->first + k];
      if (!w->used || w->from != 0.0) continue;
      const double *N = w->normal,
                   *M = f->wall[body->first + (k + body->faces - 1) % body->faces].normal;
      try_corner(w, atan2(M[0] * N[1] - M[1] * N[0], M[0] * N[0] + M[1] * N[1]), x, &found);
    }
  }
  if (f->segments == 0 || mpsi_fluid_is_mixed(f, i)) return found; /* rock has another flow */
  found.reach = fmin(found.reach, mpsi_fluid_listed_reach(f));
  const mpsi_fluid_listed near = mpsi_fluid_near_chunk(f, i / MPSI_FLUID_CHUNK);
  for (int64_t n = 0; n < near.count; n++) {
    const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, near.item[n]);
    if (!s->infinite[1]) try_corner(&s->wall, s->angle[1] - PI, x, &found);
  }
  return found;
}

/* s at particle or image j, without a unit: with A = 1 and lengths over l0. */
static void field_at(const mps_fluid *f, const mpsi_fluid_turn *turn, int64_t j, double *s) {
  const int64_t ghost = j - f->count, own = ghost < 0 ? j : f->parent[ghost];
  const double *N = turn->face->normal, T[2] = {-N[1], N[0]}, p = turn->power;
  const double dx = f->x[0][own] - turn->face->at[0], dy = f->x[1][own] - turn->face->at[1];
  const double along = dx * T[0] + dy * T[1], across = dx * N[0] + dy * N[1];
  const double r = fmax(hypot(along, across) / f->l0, LEAST);
  double angle = atan2(across, along);
  if (angle < -0.5 * PI * (2.0 - 1.0 / p)) /* in the body */
    angle += 2.0 * PI;
  const double size = p * pow(r, p - 1.0);
  const double a = size * cos((p - 1.0) * angle), b = -size * sin((p - 1.0) * angle);
  for (int c = 0; c < 2; c++) s[c] = a * T[c] + b * N[c];
  if (ghost < 0) return;
  MPSI_FLUID_FLIPS(k, f->flips[ghost]) {
    const double *M = f->wall[f->flips[ghost].wall[k]].normal, to = s[0] * M[0] + s[1] * M[1];
    for (int c = 0; c < 2; c++) s[c] -= 2.0 * to * M[c];
  }
  const mpsi_fluid_path *path = mpsi_fluid_path_of(f, ghost);
  if (path) mpsi_fluid_reflect(path, s);
}

/* Sums over the neighbours: of w/r^2 times dx dx, du dx, ds dx, du ds, ds ds; of w, w dx, w ds. */
typedef struct sums {
  double M[3], u[4], s[4], us, ss, n, x[2], ds[2];
} sums;

static sums add_up(const mps_fluid *f, int64_t i, const mpsi_fluid_turn *turn) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *weight = f->w + mpsi_fluid_pairs(f, i);
  sums all = {0};
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t j = index[k];
    const double d[2] = {f->x[0][j] - f->x[0][i], f->x[1][j] - f->x[1][i]};
    const double r2 = fmax(d[0] * d[0] + d[1] * d[1], 0.0025 * f->l0 * f->l0);
    const double w = weight[k], v = w / r2;
    double s[2];
    field_at(f, turn, j, s);
    all.n += w;
    all.M[0] += v * d[0] * d[0], all.M[1] += v * d[0] * d[1], all.M[2] += v * d[1] * d[1];
    for (int c = 0; c < 2; c++) {
      const double du = f->u[c][j] - f->u[c][i], ds = s[c] - turn->own[c];
      all.us += v * du * ds, all.ss += v * ds * ds;
      all.x[c] += w * d[c], all.ds[c] += w * ds;
      for (int q = 0; q < 2; q++)
        all.u[2 * c + q] += v * du * d[q], all.s[2 * c + q] += v * ds * d[q];
    }
  }
  return all;
}

bool mpsi_fluid_fit_turn(const mps_fluid *f, int64_t i, mpsi_fluid_turn *turn) {
  const nearest corner = find_corner(f, i);
  turn->face = corner.face, turn->power = corner.power;
  if (!turn->face) return false;
  field_at(f, turn, i, turn->own);
  const sums all = add_up(f, i, turn);
  const double *M = all.M, det = M[0] * M[2] - M[1] * M[1];
  if (!(det > 0.01 * (M[0] + M[2]) * (M[0] + M[2]))) return false; /* on a line */
  const double I[3] = {M[2] / det, -M[1] / det, M[0] / det};
  double above = all.us, below = all.ss;
  for (int c = 0; c < 2; c++) {
    const double *s = all.s + 2 * c, *u = all.u + 2 * c;
    double *G = turn->G + 2 * c;
    G[0] = s[0] * I[0] + s[1] * I[1], G[1] = s[0] * I[1] + s[1] * I[2];
    above -= G[0] * u[0] + G[1] * u[1], below -= G[0] * s[0] + G[1] * s[1];
  }
  if (!(below > ALIKE * all.ss)) return false;
  turn->strength = above / below;
  for (int c = 0; c < 2; c++) {
    const double *G = turn->G + 2 * c;
    turn->rest[c] = turn->strength * (all.ds[c] - G[0] * all.x[0] - G[1] * all.x[1]) / all.n;
  }
  return true;
}

void mpsi_fluid_add_turn(const mps_fluid *f, const mpsi_fluid_turn *turn, int64_t i, int64_t j,
                         double *v) {
  const double dx = f->x[0][j] - f->x[0][i], dy = f->x[1][j] - f->x[1][i];
  double s[2];
  field_at(f, turn, j, s);
  for (int c = 0; c < 2; c++)
    v[c] += turn->strength * (s[c] - turn->own[c] - turn->G[2 * c] * dx - turn->G[2 * c + 1] * dy);
}
