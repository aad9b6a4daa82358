/* corner.c - see corner.h. The rounded body is that of all balls of the radius r inside the body,
 * and their centres are the points C at least r below all faces: near a corner of flat faces k,
 *
 *   n_k . (C - a_k) <= -r.
 *
 * The rounded body is at the distance |x - C| - r from x, C the nearest of them. Faces are found by
 * asking the body for the foot of C, first that of a ball on the face at x, until none is nearer
 * than r. SPDX-License-Identifier: BSD-3-Clause */
#include "corner.h"

#include "body/rotation.h"

#include <string.h>

enum { MOST_FACES = 6 };
#define NEARLY 1e-6 /* of the radius */
#define FLAT 1e-8   /* determinant of the normals: faces that turn by less are one */
#define KEPT 0.25   /* of the half size: no particle comes nearer to the body itself */

typedef struct faces {
  int count;
  double normal[MOST_FACES][3], at[MOST_FACES][3];
} faces;

/* lambda with n_k . (x - sum lambda_l n_l - a_k) = -r for the `count` faces of `which`; false where
 * one of them pulls or two are one. */
static bool solve(const faces *f, const int *which, int count, double radius, const double *x,
                  double *lambda) {
  double G[3][4];
  for (int i = 0; i < count; i++) {
    const double *n = f->normal[which[i]], *a = f->at[which[i]];
    const double off[3] = {x[0] - a[0], x[1] - a[1], x[2] - a[2]};
    for (int j = 0; j < count; j++) G[i][j] = mpsi_dot3(n, f->normal[which[j]]);
    G[i][count] = mpsi_dot3(n, off) + radius;
  }
  for (int i = 0; i < count; i++) { /* definite: no pivots */
    if (!(G[i][i] > FLAT)) return false;
    for (int k = i + 1; k < count; k++)
      for (int j = count; j >= i; j--) G[k][j] -= G[k][i] / G[i][i] * G[i][j];
  }
  for (int i = count - 1; i >= 0; i--) {
    lambda[i] = G[i][count];
    for (int j = i + 1; j < count; j++) lambda[i] -= G[i][j] * lambda[j];
    lambda[i] /= G[i][i];
    if (lambda[i] < 0.0) return false;
  }
  return true;
}

static bool is_below(const faces *f, double radius, const double *C) {
  for (int k = 0; k < f->count; k++) {
    const double *n = f->normal[k], *a = f->at[k];
    const double off[3] = {C[0] - a[0], C[1] - a[1], C[2] - a[2]};
    if (mpsi_dot3(n, off) > -radius * (1.0 - NEARLY)) return false;
  }
  return true;
}

/* The point C nearest to x that is the radius below all faces: on one of them, or where two or
 * three meet. */
static bool nearest_centre(const faces *f, double radius, const double *x, double *C) {
  double best = INFINITY;
  for (unsigned set = 1; set < 1u << f->count; set++) {
    int which[3], count = 0;
    double lambda[3], at[3] = {x[0], x[1], x[2]};
    if (__builtin_popcount(set) > 3) continue;
    for (int k = 0; k < f->count; k++)
      if (set >> k & 1) which[count++] = k;
    if (!solve(f, which, count, radius, x, lambda)) continue;
    for (int i = 0; i < count; i++)
      for (int a = 0; a < 3; a++) at[a] -= lambda[i] * f->normal[which[i]][a];
    const double off[3] = {at[0] - x[0], at[1] - x[1], at[2] - x[2]};
    const double square = mpsi_dot3(off, off);
    if (!(square < best) || !is_below(f, radius, at)) continue;
    best = square;
    memcpy(C, at, 3 * sizeof *C);
  }
  return best < INFINITY;
}

/* C of the point x outside or on the body with the foot `own`; false where there is no corner, or
 * no ball fits. */
static bool find_centre(const mps_body *body, double radius, const double *x, const mpsi_foot *own,
                        double *C) {
  faces f = {.count = 0};
  const mpsi_foot *next = own;
  mpsi_foot foot;
  while (f.count < MOST_FACES) {
    memcpy(f.normal[f.count], next->normal, sizeof next->normal);
    memcpy(f.at[f.count++], next->at, sizeof next->at);
    if (!nearest_centre(&f, radius, x, C)) return false;
    foot = mpsi_body_foot(body, C);
    if (foot.distance <= -radius * (1.0 - 2.0 * NEARLY)) return f.count > 1;
    next = &foot;
  }
  return false;
}

mpsi_bearing mpsi_corner_bearing(const mps_body *body, double radius, const double *x, double half,
                                 const mpsi_foot *own) {
  mpsi_bearing out = {*own, half, own->distance};
  double C[3], off[3];
  if (!(radius > 0.0) || body->shape == MPSI_BALL || body->shape == MPSI_HALF) return out;
  const double *from = own->distance > 0.0 ? x : own->at;
  const double from3[3] = {from[0], from[1], body->dim == 3 ? from[2] : 0.0};
  if (!find_centre(body, radius, from3, own, C)) return out;
  for (int a = 0; a < 3; a++) off[a] = from3[a] - C[a];
  const double reach = sqrt(mpsi_dot3(off, off));
  const double distance = reach - radius + fmin(own->distance, 0.0);
  if (own->distance - KEPT * half < distance - half) {
    out.half = KEPT * half;
    return out;
  }
  out.foot.distance = distance;
  for (int a = 0; a < 3; a++) {
    out.foot.normal[a] = off[a] / reach;
    out.foot.at[a] = C[a] + radius * out.foot.normal[a];
  }
  return out;
}
