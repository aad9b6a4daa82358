/* joints.c - faces between cells of different material (conservative method).
 *
 * The gradient of a cell is the difference of its face values. Between equal cells the face value
 * is the mean of both. At a joint it is the one with which the tractions of both half cells are
 * equal: with lower cell 1, upper cell 2, normal axis a, tangential axes t, M = lambda + 2 mu and F
 * the displacement gradient at the face (normal derivative: difference of the two particles,
 * tangential derivatives: mean of both cells' plain differences),
 *
 *   u_face = (u_1 + u_2)/2 + delta
 *   delta_a = h/2 [ (M_2 - M_1) F_aa + (lambda_2 - lambda_1) sum_t F_tt ] / (M_1 + M_2)
 *   delta_t = h/2 (mu_2 - mu_1) (F_ta + F_at) / (mu_1 + mu_2).
 *
 * Every face value enters its two cells with opposite signs, so that uniform tractions stay in
 * equilibrium; layers in any constant traction are exact, and rigid motions free of stress. The
 * correction of the gradients, and its transpose in the forces, keep the operator symmetric.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "joints.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/body/bending.h"

#include <stdlib.h>
#include <string.h>

/* ---- which faces ----------------------------------------------------------------------------- */

static bool differ(const mps_elastic *e, int64_t i, int64_t j) {
  return e->lambda[i] != e->lambda[j] || e->mu[i] != e->mu[j];
}

/* The cell on the upper side of i along `axis`, where there is a joint between them; else -1. */
static int64_t beyond_joint(const mps_elastic *e, int64_t i, int axis) {
  const int64_t j = mpsi_elastic_neighbours(e, i)[e->links.face[axis][1]];
  return j >= 0 && mpsi_elastic_within(e, e->window, j) && differ(e, i, j) ? j : -1;
}

/* Those of the window. */
static int64_t count_joints(const mps_elastic *e) {
  int64_t count = 0;
  for (int64_t k = e->window.from; k < e->window.to; k++)
    for (int axis = 0; axis < e->dim; axis++)
      count += beyond_joint(e, mpsi_elastic_in_order(e, k), axis) >= 0;
  return count;
}

/* Does the body have joints, on any rank? */
static mps_status find_any(mps_elastic *e, const char *function, int64_t count, bool *any) {
  mpsi_sites *sites = NULL;
  bool one = true;
  *any = count > 0;
  for (int64_t i = 1; i < e->n && one; i++) one = !differ(e, 0, i);
  if (*any || one || !e->shared) return MPS_OK;
  const mps_status status = mpsi_elastic_open_sites(e, function, &sites);
  for (int64_t i = 0; status == MPS_OK && i < e->n; i++)
    for (int axis = 0; axis < e->dim; axis++) {
      const int64_t j = mpsi_elastic_beside(sites, i, axis, 1);
      *any = *any || (j >= 0 && differ(e, i, j));
    }
  mpsi_elastic_close_sites(e, sites);
  return status;
}

/* The joint at a face of cell i (lower and upper one of each axis in turn), or -1. */
static int64_t joint_at(const mps_elastic *e, int64_t i, int face) {
  return e->joint_at[mpsi_elastic_slot(e, i) * 2 * e->dim + face];
}

void mpsi_elastic_drop_joints(mps_elastic *e) {
  MPSI_FREE(e->context, e->joints, e->joint_at, e->joint_scratch);
  e->joints = NULL;
  e->joint_at = NULL;
  e->joint_scratch = NULL;
  e->joint_count = 0;
}

/* Are these the present joints? The pattern of the matrix depends on their faces. */
static bool same_joints(const mps_elastic *e, const mpsi_joint *joints, int64_t count) {
  return count == e->joint_count &&
         (count == 0 || memcmp(joints, e->joints, (size_t)count * sizeof *joints) == 0);
}

mps_status mpsi_elastic_find_joints(mps_elastic *e, const char *function) {
  const int64_t count = e->conservative ? count_joints(e) : 0;
  const int64_t places = mpsi_elastic_slots(e) * 2 * e->dim;
  mpsi_joint *joints = NULL;
  int64_t *at = NULL;
  double *scratch = NULL, *bending = NULL;
  bool any = false;
  MPSI_TRY(find_any(e, function, count, &any));
  if (mpsi_elastic_has_bending(e, any)) {
    const int64_t size = mpsi_elastic_bending_size(e);
    if (!(bending = mpsi_alloc(e->context, size, sizeof *bending)))
      return mpsi_fail_memory(e->context, function, (size_t)size * sizeof *bending);
  }
  if (count > 0 && (!(joints = mpsi_alloc(e->context, count, sizeof *joints)) ||
                    !(at = mpsi_alloc(e->context, places, sizeof *at)) ||
                    !(scratch = mpsi_alloc(e->context, count * e->dim, sizeof *scratch)))) {
    MPSI_FREE(e->context, joints, at, bending);
    return mpsi_fail_memory(e->context, function, (size_t)places * sizeof *at);
  }
  for (int64_t k = 0; at && k < places; k++) at[k] = -1;
  for (int64_t p = e->window.from, k = 0; count > 0 && p < e->window.to; p++)
    for (int axis = 0; axis < e->dim; axis++) {
      const int64_t i = mpsi_elastic_in_order(e, p), j = beyond_joint(e, i, axis);
      if (j < 0) continue;
      at[mpsi_elastic_slot(e, i) * 2 * e->dim + 2 * axis + 1] = k;
      at[mpsi_elastic_slot(e, j) * 2 * e->dim + 2 * axis] = k;
      joints[k++] = (mpsi_joint){.low = i, .high = j, .axis = axis};
    }
  if (!same_joints(e, joints, count)) e->pattern_valid = false;
  mpsi_elastic_drop_joints(e);
  mpsi_free(e->context, e->bending);
  e->bending = bending;
  e->joints = joints;
  e->joint_at = at;
  e->joint_scratch = scratch;
  e->joint_count = count;
  return MPS_OK;
}

/* ---- one joint ------------------------------------------------------------------------------- */

static mpsi_joint_law joint_law(const mps_elastic *e, const mpsi_joint *q) {
  const double l1 = e->lambda[q->low], l2 = e->lambda[q->high];
  const double m1 = e->mu[q->low], m2 = e->mu[q->high], half = 0.5 * e->spacing;
  const double normal = half / (l1 + 2.0 * m1 + l2 + 2.0 * m2);
  return (mpsi_joint_law){.normal = normal * (l2 + 2.0 * m2 - l1 - 2.0 * m1),
                          .lateral = normal * (l2 - l1),
                          .shear = half * (m2 - m1) / (m1 + m2)};
}

/* Coefficient of the face value on side `up` of `axis` in the gradient of cell i: 1/h, or 2/h where
 * the cell has no other face neighbour and its own value stands for the surface. */
static double face_weight(const mps_elastic *e, int64_t i, int axis, int up) {
  const double weight = (e->faces[i] >> 2 * axis & 3) == 3 ? 1.0 : 2.0;
  return (up ? weight : -weight) / e->spacing;
}

bool mpsi_elastic_pair_crosses(const mps_elastic *e, int64_t i, int64_t j, int32_t k) {
  if (differ(e, i, j)) return true;
  for (int axis = 0; axis < e->dim; axis++) {
    if (abs(e->links.step[k][axis]) < 2) continue;
    for (int face = 2 * axis; face < 2 * axis + 2; face++)
      if (joint_at(e, i, face) >= 0 || joint_at(e, j, face) >= 0) return true;
  }
  return false;
}

/* ---- gradients and forces -------------------------------------------------------------------- */

typedef struct joint_task {
  mps_elastic *e;
  const double *u;
  double *tensor; /* gradients, or stresses P */
  double *f;
} joint_task;

/* delta of joint k, from the plain gradients. */
static void find_delta(void *task, int64_t k) {
  const joint_task *t = task;
  const mps_elastic *e = t->e;
  const int d = e->dim;
  const mpsi_joint *q = &e->joints[k];
  const mpsi_joint_law law = joint_law(e, q);
  const double *g1 = t->tensor + mpsi_elastic_slot(e, q->low) * d * d;
  const double *g2 = t->tensor + mpsi_elastic_slot(e, q->high) * d * d;
  const double *u1 = t->u + q->low * d, *u2 = t->u + q->high * d;
  const int a = q->axis;
  double *delta = e->joint_scratch + k * d;
  delta[a] = law.normal * (u2[a] - u1[a]) / e->spacing;
  for (int b = 0; b < d; b++) {
    if (b == a) continue;
    delta[a] += law.lateral * 0.5 * (g1[b * d + b] + g2[b * d + b]);
    delta[b] = law.shear * ((u2[b] - u1[b]) / e->spacing + 0.5 * (g1[a * d + b] + g2[a * d + b]));
  }
}

/* Correction of the gradient of cell i by its joints. */
static void add_delta(void *task, int64_t i) {
  const joint_task *t = task;
  const mps_elastic *e = t->e;
  const int d = e->dim;
  for (int face = 0; face < 2 * d; face++) {
    const int64_t k = joint_at(e, i, face);
    if (k < 0) continue;
    const double weight = face_weight(e, i, face / 2, face % 2);
    for (int c = 0; c < d; c++)
      t->tensor[(mpsi_elastic_slot(e, i) * d + c) * d + face / 2] +=
          weight * e->joint_scratch[k * d + c];
  }
}

void mpsi_elastic_joint_gradients(mps_elastic *e, const double *u, double *gradient) {
  if (e->joint_count == 0) return;
  joint_task task = {.e = e, .u = u, .tensor = gradient};
  mpsi_elastic_for_each(e, e->joint_count, find_delta, &task);
  mpsi_elastic_for_span(e, e->span[(int)e->def.radius_ratio + 2], add_delta, &task);
}

/* The force on delta of joint k: transpose of add_delta. */
static void find_pull(void *task, int64_t k) {
  const joint_task *t = task;
  const mps_elastic *e = t->e;
  const int d = e->dim;
  const mpsi_joint *q = &e->joints[k];
  const double w1 = face_weight(e, q->low, q->axis, 1);
  const double w2 = face_weight(e, q->high, q->axis, 0);
  const double *p1 = t->tensor + mpsi_elastic_slot(e, q->low) * d * d;
  const double *p2 = t->tensor + mpsi_elastic_slot(e, q->high) * d * d;
  for (int c = 0; c < d; c++)
    e->joint_scratch[k * d + c] = w1 * p1[c * d + q->axis] + w2 * p2[c * d + q->axis];
}

/* Transpose of find_delta: normal derivatives pull particle i, tangential ones add to its P. */
static void add_pull(void *task, int64_t i) {
  const joint_task *t = task;
  const mps_elastic *e = t->e;
  const int d = e->dim;
  double *f = t->f + i * d, *P = t->tensor + mpsi_elastic_slot(e, i) * d * d;
  for (int face = 0; face < 2 * d; face++) {
    const int64_t k = joint_at(e, i, face);
    if (k < 0) continue;
    const mpsi_joint_law law = joint_law(e, &e->joints[k]);
    const double *pull = e->joint_scratch + k * d, side = face % 2 ? -1.0 : 1.0;
    const int a = face / 2;
    f[a] += side * law.normal * pull[a] / e->spacing;
    for (int b = 0; b < d; b++) {
      if (b == a) continue;
      f[b] += side * law.shear * pull[b] / e->spacing;
      P[b * d + b] += 0.5 * law.lateral * pull[a];
      P[a * d + b] += 0.5 * law.shear * pull[b];
    }
  }
}

void mpsi_elastic_joint_forces(mps_elastic *e, double *stress, double *f) {
  if (e->joint_count == 0) return;
  joint_task task = {.e = e, .tensor = stress, .f = f};
  mpsi_elastic_for_each(e, e->joint_count, find_pull, &task);
  mpsi_elastic_for_span(e, e->span[1], add_pull, &task);
}

/* ---- coefficients, for the matrix and for loads ---------------------------------------------- */

static double (*site_of(mpsi_wide *w, int64_t site))[3] {
  int32_t s = 0;
  while (s < w->count && w->site[s] != site) s++;
  if (s == w->count) {
    w->site[w->count++] = site;
    memset(w->c[s], 0, sizeof w->c[s]);
  }
  return w->c[s];
}

/* Adds scale * (plain derivative of u_from along `axis` at cell i) to row `row`. */
static void add_derivative(const mps_elastic *e, int64_t i, int axis, int from, int row,
                           double scale, mpsi_wide *w) {
  int64_t sites[MPSI_STENCIL_MAX];
  double g[MPSI_STENCIL_MAX][3];
  const int32_t m = mpsi_elastic_stencil(e, i, sites, g);
  for (int32_t s = 0; s < m; s++)
    if (g[s][axis] != 0.0) site_of(w, sites[s])[row][from] += scale * g[s][axis];
}

/* Adds scale * delta of joint q to column `axis` of the gradient. */
static void add_joint(const mps_elastic *e, const mpsi_joint *q, double scale, mpsi_wide *w) {
  const mpsi_joint_law law = joint_law(e, q);
  const int d = e->dim, a = q->axis;
  for (int c = 0; c < d; c++) {
    const double normal = scale * (c == a ? law.normal : law.shear) / e->spacing;
    site_of(w, q->high)[c * d + a][c] += normal;
    site_of(w, q->low)[c * d + a][c] -= normal;
  }
  for (int end = 0; end < 2; end++)
    for (int t = 0; t < d; t++) {
      const int64_t i = end ? q->high : q->low;
      if (t == a) continue;
      add_derivative(e, i, t, t, a * d + a, 0.5 * scale * law.lateral, w);
      add_derivative(e, i, t, a, t * d + a, 0.5 * scale * law.shear, w);
    }
}

void mpsi_elastic_wide_gradient(const mps_elastic *e, int64_t i, mpsi_wide *w) {
  const int d = e->dim;
  w->count = 0;
  site_of(w, i);
  for (int c = 0; c < d; c++)
    for (int b = 0; b < d; b++) add_derivative(e, i, b, c, c * d + b, 1.0, w);
  for (int face = 0; e->joint_at && face < 2 * d; face++) {
    const int64_t k = joint_at(e, i, face);
    if (k < 0) continue;
    add_joint(e, &e->joints[k], face_weight(e, i, face / 2, face % 2), w);
  }
}
