/* point.c - one particle with its state, without a solver: a law along a path of strain, or one of
 * which some components of the stress are given and the rest of the strain, as in a triaxial cell.
 * There the strains of a step are found by Newton's method, with a matrix by differences, since
 * laws give no tangent. SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/symmetric.h"
#include "material_private.h"

#include <mps/soil.h>
#include <mps/experimental/material_point.h>

mps_status mps_material_point_init(mps_context *context, const mps_material *material,
                                   mps_material_point *point) {
  if (!context) return mpsi_null(__func__, "context");
  if (!material || !point)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     material ? "point" : "material");
  *point = (mps_material_point){.deformation = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0},
                                .volume_ratio = 1.0};
  for (int32_t c = 0; c < material->history_count; c++)
    point->history[c] = material->history_initial[c];
  return MPS_OK;
}

static mps_status check_drive(mps_context *context, const char *function,
                              const mps_material *material, const mps_material_point *point,
                              const double *gradient, double duration, int64_t steps) {
  if (!material || !point || !gradient)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is NULL",
                     !material ? "material"
                     : !point  ? "point"
                               : "gradient");
  for (int c = 0; c < 9; c++)
    if (!isfinite(gradient[c]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "gradient[%d] is %g, must be finite",
                       c, gradient[c]);
  if (!isfinite(duration) || duration <= 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "duration is %g s, must be finite and > 0", duration);
  if (steps < 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "steps is %lld, must be >= 1",
                     (long long)steps);
  return MPS_OK;
}

/* What is too large for the stack of a host's thread. */
typedef struct drive {
  mps_material_point now; /* the caller's point changes only when every step succeeds */
  double *history[MPS_MATERIAL_POINT_HISTORY];
} drive;

static mps_status follow(mps_context *context, const char *function, const mps_material *material,
                         mps_material_point *point, const double gradient[9], double duration,
                         int64_t steps, drive *d) {
  mps_material_point *now = &d->now;
  *now = *point;
  char message[MPSI_MATERIAL_MESSAGE] = "";
  int64_t refused = -1;
  mps_material_block block = {.struct_size = sizeof block,
                              .dim = 3,
                              .count = 1,
                              .dt = duration / (double)steps,
                              .history = d->history,
                              .history_count = material->history_count,
                              .message = message,
                              .message_size = sizeof message,
                              .refused = &refused,
                              .volume_ratio = &now->volume_ratio,
                              .flags = &now->flags};
  for (int c = 0; c < 9; c++) {
    block.gradient[c] = &gradient[c];
    block.deformation[c] = &now->deformation[c];
  }
  for (int c = 0; c < 6; c++) block.stress[c] = &now->stress[c];
  for (int32_t c = 0; c < material->history_count; c++) d->history[c] = &now->history[c];
  for (int64_t step = 0; step < steps; step++) {
    block.time = point->time + duration * (double)(step + 1) / (double)steps;
    mps_status answer = mpsi_material_apply(material, &block);
    if (answer == MPS_OK) answer = mpsi_check_results(&block, material->history_count);
    if (answer != MPS_OK)
      return mpsi_material_refused(context, function, material, answer, message, -1, step);
  }
  now->time = point->time + duration;
  *point = *now;
  return MPS_OK;
}

mps_status mps_material_point_drive(mps_context *context, const mps_material *material,
                                    mps_material_point *point, const double gradient[9],
                                    double duration, int64_t steps) {
  if (!context) return mpsi_null(__func__, "context");
  MPSI_TRY(check_drive(context, __func__, material, point, gradient, duration, steps));
  drive *d = mpsi_alloc(context, 1, sizeof *d);
  if (!d) return mpsi_fail_memory(context, __func__, sizeof *d);
  const mps_status answer =
      follow(context, __func__, material, point, gradient, duration, steps, d);
  mpsi_free(context, d);
  return answer;
}

/* ---- given stresses -------------------------------------------------------------------------- */

enum { COMPONENTS = 6, ROUNDS = 60, HALVINGS = 30 };
#define CLOSE 1e-9     /* of the largest stress of a step */
#define ROUNDING 1e-14 /* of the wave modulus */

/* One step: what is looked for, and what it is to give. */
typedef struct control {
  mps_context *context;
  const mps_material *material;
  const mps_material_point *start;
  mps_material_point *other; /* for differences */
  double gradient[9], dt;
  int n, component[COMPONENTS]; /* of the stress */
  double target[COMPONENTS];    /* of these, Pa */
  double small;                 /* difference of a rate, 1/s */
  double close;                 /* Pa */
} control;

static const char function[] = "mps_material_point_control";

static void build_gradient(const control *c, const double *rate, double *gradient) {
  memcpy(gradient, c->gradient, sizeof c->gradient);
  for (int k = 0; k < c->n; k++) {
    const int i = mpsi_symmetric_row[c->component[k]], j = mpsi_symmetric_column[c->component[k]];
    gradient[3 * i + j] += rate[k];
    if (i != j) gradient[3 * j + i] += rate[k];
  }
}

/* The point after the step with these rates, and how far its stresses are from the targets. */
static mps_status try_rates(const control *c, const double *rate, mps_material_point *point,
                            double *miss, double *size) {
  double gradient[9];
  build_gradient(c, rate, gradient);
  *point = *c->start;
  const mps_status status =
      mps_material_point_drive(c->context, c->material, point, gradient, c->dt, 1);
  *size = 0.0;
  for (int k = 0; k < c->n && status == MPS_OK; k++) {
    miss[k] = point->stress[c->component[k]] - c->target[k];
    *size = fmax(*size, fabs(miss[k]));
  }
  return status;
}

/* Gauss with pivots; false of a matrix that is singular to `least` of its largest entry. */
static bool solve(int n, double (*a)[COMPONENTS], double *x, double least) {
  double largest = 0.0;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) largest = fmax(largest, fabs(a[i][j]));
  for (int k = 0; k < n; k++) {
    int best = k;
    for (int i = k + 1; i < n; i++)
      if (fabs(a[i][k]) > fabs(a[best][k])) best = i;
    if (!(fabs(a[best][k]) > least * largest)) return false;
    for (int j = 0; j < n; j++) {
      const double kept = a[k][j];
      a[k][j] = a[best][j], a[best][j] = kept;
    }
    const double kept = x[k];
    x[k] = x[best], x[best] = kept;
    for (int i = k + 1; i < n; i++) {
      const double ratio = a[i][k] / a[k][k];
      for (int j = k; j < n; j++) a[i][j] -= ratio * a[k][j];
      x[i] -= ratio * x[k];
    }
  }
  for (int k = n; k-- > 0;) {
    for (int j = k + 1; j < n; j++) x[k] -= a[k][j] * x[j];
    x[k] /= a[k][k];
  }
  return true;
}

/* The shortest of all solutions, nearly, of a singular matrix: on an edge of a pyramid two stresses
 * are equal whatever the difference of the strains. */
static bool solve_shortest(int n, double (*a)[COMPONENTS], double *x) {
  double square[COMPONENTS][COMPONENTS] = {{0.0}}, right[COMPONENTS] = {0.0}, trace = 0.0;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < n; k++) {
      for (int j = 0; j < n; j++) square[i][j] += a[k][i] * a[k][j];
      right[i] += a[k][i] * x[k];
    }
  for (int i = 0; i < n; i++) trace += square[i][i];
  for (int i = 0; i < n; i++) square[i][i] += 1e-10 * trace;
  memcpy(x, right, (size_t)n * sizeof *x);
  return solve(n, square, x, 0.0);
}

/* Newton's direction; false where there is none. */
static mps_status find_direction(const control *c, const double *rate, const double *miss,
                                 double *direction, bool *found) {
  double matrix[COMPONENTS][COMPONENTS] = {{0.0}}, other[COMPONENTS], moved[COMPONENTS], size;
  memcpy(moved, rate, sizeof moved);
  for (int k = 0; k < c->n; k++) {
    moved[k] = rate[k] + c->small;
    MPSI_TRY(try_rates(c, moved, c->other, other, &size));
    for (int i = 0; i < c->n; i++) matrix[i][k] = (other[i] - miss[i]) / (moved[k] - rate[k]);
    moved[k] = rate[k];
    direction[k] = -miss[k];
  }
  double copy[COMPONENTS][COMPONENTS], right[COMPONENTS];
  memcpy(copy, matrix, sizeof copy);
  memcpy(right, direction, sizeof right);
  *found = solve(c->n, copy, direction, 1e-7);
  if (!*found) {
    memcpy(direction, right, sizeof right);
    *found = solve_shortest(c->n, matrix, direction);
  }
  for (int k = 0; k < c->n; k++) *found = *found && isfinite(direction[k]);
  return MPS_OK;
}

/* The rates of one step, from those given; *size is what is missing at the end. */
static mps_status find_rates(const control *c, double *rate, mps_material_point *point,
                             double *size) {
  double miss[COMPONENTS], direction[COMPONENTS];
  mps_status status = try_rates(c, rate, point, miss, size);
  for (int round = 0; round < ROUNDS && status == MPS_OK && *size > c->close; round++) {
    bool found = false;
    status = find_direction(c, rate, miss, direction, &found);
    if (status != MPS_OK || !found) return status;
    const double former = *size;
    double next[COMPONENTS], share = 1.0;
    for (int half = 0; half < HALVINGS; half++, share *= 0.5) {
      for (int k = 0; k < c->n; k++) next[k] = rate[k] + share * direction[k];
      status = try_rates(c, next, point, miss, size);
      if (status == MPS_ERROR_NUMERIC) { /* refused: strains too large for the law */
        status = MPS_OK;
        *size = INFINITY;
      }
      if (status != MPS_OK || *size < former) break;
    }
    if (status != MPS_OK) return status;
    if (!(*size < former)) {
      *size = former;
      return MPS_OK;
    }
    memcpy(rate, next, (size_t)c->n * sizeof *rate);
  }
  return status;
}

static mps_status check_targets(mps_context *context, const mps_material_point *point,
                                const double *target, uint32_t controlled) {
  if (controlled >= 1u << COMPONENTS)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "controlled is %u, must be a sum of MPS_MATERIAL_POINT_... bits, below 64",
                     (unsigned)controlled);
  if (controlled != 0 && !target)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "target is NULL");
  for (int c = 0; c < COMPONENTS; c++) {
    if ((controlled >> c & 1) && !(fabs(target[c]) <= 1e18))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "target[%d] is %g Pa, must be finite and at most 1e18", c, target[c]);
    if (!isfinite(point->stress[c]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "stress[%d] of the point is %g, must be finite", c, point->stress[c]);
  }
  return MPS_OK;
}

/* The step's size, by which differences and the tolerance are chosen. */
static void set_scales(control *c) {
  double rate = 0.0, change = 0.0, stress = 0.0;
  for (int k = 0; k < 9; k++) rate = fmax(rate, fabs(c->gradient[k]));
  for (int k = 0; k < COMPONENTS; k++) stress = fmax(stress, fabs(c->start->stress[k]));
  for (int k = 0; k < c->n; k++) {
    change = fmax(change, fabs(c->target[k] - c->start->stress[c->component[k]]));
    stress = fmax(stress, fabs(c->target[k]));
  }
  const double modulus = mps_material_wave_modulus(c->material);
  c->small = 1e-4 * fmax(rate, change / (modulus * c->dt));
  if (!(c->small > 0.0)) c->small = 1e-9 / c->dt;
  c->close = fmax(CLOSE * stress, ROUNDING * modulus);
}

static mps_status take_step(control *c, double *rate, mps_material_point *point, int64_t step) {
  double size, first[COMPONENTS] = {0.0};
  set_scales(c);
  mps_status status = find_rates(c, rate, point, &size);
  if (status == MPS_OK && size > c->close) { /* from rest: the path may have turned */
    memcpy(rate, first, sizeof first);
    status = find_rates(c, rate, point, &size);
  }
  if (status != MPS_OK || size <= c->close) return status;
  return mpsi_fail(c->context, function, MPS_ERROR_NUMERIC,
                   "step %lld: no strain gives the target stress, the nearest is %g Pa from it: it "
                   "may lie beyond the strength of the law %s; take smaller steps or give strains",
                   (long long)step, size, mps_material_name(c->material));
}

/* `points`: the points before and after a step, and one for differences. */
static mps_status follow_targets(mps_context *context, const mps_material *material,
                                 mps_material_point *point, const double gradient[9],
                                 uint32_t controlled, const double target[6], double duration,
                                 int64_t steps, mps_material_point *points, double found[9]) {
  mps_material_point *now = &points[0], *next = &points[1];
  double rate[COMPONENTS] = {0.0};
  control c = {.context = context,
               .material = material,
               .start = now,
               .other = &points[2],
               .dt = duration / (double)steps};
  *now = *next = *point;
  memcpy(c.gradient, gradient, sizeof c.gradient);
  for (int k = 0; k < COMPONENTS; k++) {
    if (!(controlled >> k & 1)) continue;
    const int i = mpsi_symmetric_row[k], j = mpsi_symmetric_column[k];
    if (i == j) c.gradient[4 * i] = 0.0;
    c.component[c.n++] = k;
  }
  for (int64_t step = 0; step < steps; step++) {
    const double share = (double)(step + 1) / (double)steps;
    for (int k = 0; k < c.n; k++) {
      const int a = c.component[k];
      c.target[k] = point->stress[a] + share * (target[a] - point->stress[a]);
    }
    MPSI_TRY(mpsi_as(context, function, take_step(&c, rate, next, step)));
    *now = *next;
  }
  now->time = point->time + duration;
  if (found) build_gradient(&c, rate, found);
  *point = *now;
  return MPS_OK;
}

mps_status mps_material_point_control(mps_context *context, const mps_material *material,
                                      mps_material_point *point, const double gradient[9],
                                      uint32_t controlled, const double target[6], double duration,
                                      int64_t steps, double found[9]) {
  if (!context) return mpsi_null(__func__, "context");
  MPSI_TRY(check_drive(context, function, material, point, gradient, duration, steps));
  MPSI_TRY(check_targets(context, point, target, controlled));
  mps_material_point *points =
      mpsi_alloc(context, 3, sizeof *points); /* too large for a small stack */
  if (!points) return mpsi_fail_memory(context, function, 3 * sizeof *points);
  mps_status status = follow_targets(context, material, point, gradient, controlled, target,
                                     duration, steps, points, found);
  mpsi_free(context, points);
  return status;
}
