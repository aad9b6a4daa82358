/* table.c - a field from the points of another code's table: the nearest point's value, or a linear
 * function fitted by moving least squares.
 *
 * The fit at the place x takes the weights (1 - (r/R)^2)^2/r^2 of the nearest points, R being a
 * little more than the distance of the farthest: linear functions are reproduced, and at a point
 * its own weight is all there is. With the weighted mean m of the points and their matrix of second
 * moments C about it, the value is the sum over the points of (w + w (x_j - m) C^-1 (x - m)) v_j;
 * C^-1 leaves out the directions in which the whole table has no extent.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "particles_private.h"

#include "core/definition/digits.h"
#include "core/base/nearest.h"
#include "core/base/symmetric.h"
#include "fields.h"

#include <mps/soil.h>
#include <mps/experimental/soil.h>

enum { MOST_NEAR = 256, BLOCK = 1024, HULL_STEPS = 64 };
#define MAX_POINTS (INT64_C(1) << 31)
#define WITHOUT_EXTENT 1e-12 /* of the largest principal second moment, of the whole table */
#define TOO_FLAT 1e-8        /* the same, of the points of a fit */
#define ON_A_POINT 1e-12     /* r^2 over R^2: there the weights end to grow */
#define BEYOND 1e-9          /* of R^2: the distance of a plane between a place and the points */

static const char function[] = "mps_particles_set_table";

typedef struct table {
  mps_particles *set;
  mps_context *context;
  mps_table_def def;
  mpsi_nearest tree;
  mpsi_field shape;
  int32_t components, rank;           /* of the field; directions in which the points extend */
  const double *values, *position[3]; /* position: of the particles */
  double *out;                        /* components values a particle */
  struct block {
    int64_t outside, refused; /* particles; the first one too far or without a fit, or -1 */
    double distance;          /* of that, m */
    bool flat;
  } * blocks;
} table;

/* ---- the fit --------------------------------------------------------------------------------- */

/* Points of a fit, seen from the place. */
typedef struct fit {
  const table *t;
  int32_t count, rank;
  mpsi_near near[MOST_NEAR];
  double x[MOST_NEAR][3], w[MOST_NEAR];  /* m; sum of w is 1 */
  double mean[3], axis[3][3], moment[3]; /* the first `rank` axes are kept */
} fit;

/* Mean and principal second moments of weighted points; the axes whose moment is above `least` of
 * the largest come first. */
static void find_moments(int64_t count, const double (*x)[3], const double *w, double least,
                         fit *f) {
  double c[3][3] = {{0.0}}, value[3], axis[3][3], largest = 0.0;
  for (int32_t a = 0; a < 3; a++) f->mean[a] = 0.0;
  for (int64_t k = 0; k < count; k++)
    for (int32_t a = 0; a < 3; a++) f->mean[a] += w[k] * x[k][a];
  for (int64_t k = 0; k < count; k++)
    for (int32_t a = 0; a < 3; a++)
      for (int32_t b = 0; b < 3; b++)
        c[a][b] += w[k] * (x[k][a] - f->mean[a]) * (x[k][b] - f->mean[b]);
  mpsi_symmetric_principal((const double(*)[3])c, value, axis);
  for (int32_t a = 0; a < 3; a++) largest = fmax(largest, value[a]);
  f->rank = 0;
  for (int32_t a = 0; a < 3; a++) {
    if (!(value[a] > least * largest)) continue;
    for (int32_t b = 0; b < 3; b++) f->axis[f->rank][b] = axis[b][a];
    f->moment[f->rank++] = value[a];
  }
}

/* The number of directions in which the points of the whole table extend. */
static mps_status find_rank(table *t, const double *positions) {
  const int64_t n = t->tree.count;
  const int32_t dim = t->tree.dim;
  double(*x)[3] = mpsi_alloc(t->context, n + (n + 2) / 3, sizeof *x); /* and a weight a point */
  if (!x) return mpsi_fail_memory(t->context, function, (size_t)n * 4 * sizeof **x);
  double *w = x[n];
  fit f;
  for (int64_t i = 0; i < n; i++) {
    w[i] = 1.0 / (double)n;
    for (int32_t c = 0; c < dim; c++) x[i][c] = positions[i * dim + c] - positions[c];
  }
  find_moments(n, (const double(*)[3])x, w, WITHOUT_EXTENT, &f);
  t->rank = f.rank;
  mpsi_free(t->context, x);
  return MPS_OK;
}

/* The weights and moments of the `count` nearest points. */
static void begin_fit(fit *f, const double *at, int32_t count) {
  const mpsi_nearest *tree = &f->t->tree;
  f->count = count;
  const double radius = 1.01 * f->near[count - 1].square;
  double sum = 0.0;
  for (int32_t k = 0; k < count; k++) {
    const double q = radius > 0.0 ? f->near[k].square / radius : 0.0;
    f->w[k] = (1.0 - q) * (1.0 - q) / (q + ON_A_POINT);
    sum += f->w[k];
    for (int32_t c = 0; c < 3; c++)
      f->x[k][c] = c < tree->dim ? tree->x[f->near[k].point * tree->dim + c] - at[c] : 0.0;
  }
  for (int32_t k = 0; k < count; k++) f->w[k] /= sum;
  find_moments(count, (const double(*)[3])f->x, f->w, TOO_FLAT, f);
}

/* A point, or a direction from the place, in the axes of the fit. */
static void in_axes(const fit *f, const double *x, double *out) {
  for (int32_t a = 0; a < f->rank; a++) {
    out[a] = 0.0;
    for (int32_t c = 0; c < 3; c++) out[a] += f->axis[a][c] * x[c];
  }
}

static double dot(const fit *f, const double *a, const double *b) {
  double sum = 0.0;
  for (int32_t c = 0; c < f->rank; c++) sum += a[c] * b[c];
  return sum;
}

/* Whether a plane lies between the place and all points, in the directions of the fit: the point of
 * the hull nearest to the place is approached by Gilbert's algorithm, and its direction is the
 * plane's normal. Places that are outside by little remain without such a plane. */
static bool is_outside(const fit *f) {
  double p[3], y[3], best[3] = {0.0};
  const double margin = BEYOND * f->near[f->count - 1].square;
  in_axes(f, f->x[0], p);
  for (int32_t step = 0; step < HULL_STEPS; step++) {
    double least = INFINITY;
    for (int32_t k = 0; k < f->count; k++) {
      in_axes(f, f->x[k], y);
      const double along = dot(f, p, y);
      if (along >= least) continue;
      least = along;
      for (int32_t a = 0; a < f->rank; a++) best[a] = y[a];
    }
    if (least > margin) return true;
    double d[3];
    for (int32_t a = 0; a < f->rank; a++) d[a] = best[a] - p[a];
    const double length = dot(f, d, d);
    if (!(length > 0.0)) return false;
    const double share = fmin(fmax(-dot(f, p, d) / length, 0.0), 1.0);
    for (int32_t a = 0; a < f->rank; a++) p[a] += share * d[a];
    if (!(dot(f, p, p) > margin)) return false;
  }
  return false;
}

/* The value of the linear function at the place; within those of the points unless it may continue
 * beyond them. */
static void evaluate(const fit *f, bool within, double *out) {
  const table *t = f->t;
  double share[MOST_NEAR], slope[3], y[3];
  in_axes(f, f->mean, slope);
  for (int32_t a = 0; a < f->rank; a++) slope[a] /= -f->moment[a];
  for (int32_t k = 0; k < f->count; k++) {
    double from[3];
    for (int32_t c = 0; c < 3; c++) from[c] = f->x[k][c] - f->mean[c];
    in_axes(f, from, y);
    share[k] = f->w[k] * (1.0 + dot(f, slope, y));
  }
  for (int32_t c = 0; c < t->components; c++) {
    const double first = t->values[f->near[0].point * t->components + c];
    double low = 0.0, high = 0.0, sum = 0.0;
    for (int32_t k = 0; k < f->count; k++) {
      const double more = t->values[f->near[k].point * t->components + c] - first;
      sum += share[k] * more, low = fmin(low, more), high = fmax(high, more);
    }
    out[c] = first + (within ? fmin(fmax(sum, low), high) : sum);
  }
}

/* The linear value at the place; false: no number of points gives a fit. */
static bool interpolate(fit *f, const double *at, double *out, bool *outside) {
  const table *t = f->t;
  const int64_t n = t->tree.count;
  const int32_t most = n < MOST_NEAR ? (int32_t)n : MOST_NEAR;
  int32_t wanted = t->tree.dim == 2 ? 12 : 20, good = 0;
  *outside = true;
  for (bool last = false; *outside && !last; wanted *= 2) {
    last = wanted >= most;
    const int32_t count = last ? most : wanted;
    (void)mpsi_nearest_find(&t->tree, at, count, f->near);
    begin_fit(f, at, count);
    if (f->rank < t->rank) continue;
    if (good == 0) good = count;
    *outside = is_outside(f);
  }
  if (good == 0) return false;
  if (*outside && t->def.extrapolate) begin_fit(f, at, good);
  if (*outside && !t->def.extrapolate)
    for (int32_t c = 0; c < t->components; c++)
      out[c] = t->values[f->near[0].point * t->components + c];
  else
    evaluate(f, !*outside, out);
  return true;
}

/* ---- all particles --------------------------------------------------------------------------- */

static void set_block(void *data, int64_t block, int32_t worker) {
  table *t = data;
  struct block *b = &t->blocks[block];
  const int64_t begin = block * BLOCK;
  const int64_t end = begin + BLOCK < t->set->count ? begin + BLOCK : t->set->count;
  fit f = {.t = t};
  b->refused = -1;
  for (int64_t i = begin; i < end && b->refused < 0; i++) {
    double at[3] = {0.0}, *out = t->out + i * t->components;
    bool outside = false, good = true;
    for (int32_t c = 0; c < t->tree.dim; c++) at[c] = t->position[c][i];
    (void)mpsi_nearest_find(&t->tree, at, 1, f.near);
    b->distance = sqrt(f.near[0].square);
    if (b->distance > t->def.reach) {
      b->refused = i;
    } else if (t->def.interpolation == MPS_TABLE_INTERPOLATION_LINEAR) {
      good = interpolate(&f, at, out, &outside);
      if (!good) b->refused = i, b->flat = true;
    } else {
      for (int32_t c = 0; c < t->components; c++)
        out[c] = t->values[f.near[0].point * t->components + c];
    }
    b->outside += outside;
  }
}

static mps_status refuse(const table *t, const struct block *b) {
  const int64_t *id = t->set->fields[MPSI_FIELD_ID]->data;
  (void)(b->flat
             ? mpsi_fail(
                   t->context, function, MPS_ERROR_ARGUMENT,
                   "positions: the %d points nearest to particle %lld lie too near a line "
                   "or plane for a linear function, others do not: MPS_TABLE_INTERPOLATION_NEAREST "
                   "takes them",
                   t->tree.count < MOST_NEAR ? (int)t->tree.count : MOST_NEAR,
                   (long long)id[b->refused])
             : mpsi_fail(t->context, function, MPS_ERROR_ARGUMENT,
                         "particle %lld is %g m from the nearest of positions, reach is %g m",
                         (long long)id[b->refused], b->distance, t->def.reach));
  mpsi_fail_where(t->context, -1, id[b->refused]);
  return MPS_ERROR_ARGUMENT;
}

static mps_status find_values(table *t, int64_t *outside) {
  const int64_t blocks = (t->set->count + BLOCK - 1) / BLOCK;
  mpsi_parallel_for(t->context, blocks, set_block, t);
  *outside = 0;
  for (int64_t b = 0; b < blocks; b++) {
    if (t->blocks[b].refused >= 0) return refuse(t, &t->blocks[b]);
    *outside += t->blocks[b].outside;
  }
  return mpsi_executor_check(t->context, function);
}

/* ---- arguments ------------------------------------------------------------------------------- */

static mps_status check_points(const table *t, const double *positions) {
  const int64_t n = t->tree.count;
  if (n < 1 || n > MAX_POINTS)
    return mpsi_fail(t->context, function, MPS_ERROR_ARGUMENT, "count is %lld, must be 1 to 2^31",
                     (long long)n);
  if (!positions || !t->values)
    return mpsi_fail(t->context, function, MPS_ERROR_ARGUMENT, "%s is NULL",
                     positions ? "values" : "positions");
  for (int64_t i = 0; i < n * t->tree.dim; i++)
    if (!(fabs(positions[i]) <= 1e15))
      return mpsi_fail(t->context, function, MPS_ERROR_ARGUMENT,
                       "positions: point %lld has %c = %s m, must be within 1e15 m",
                       (long long)(i / t->tree.dim), "xyz"[i % t->tree.dim],
                       mpsi_outside(positions[i], -1e15, 1e15).text);
  for (int64_t i = 0; i < n * t->components; i++)
    if (!(fabs(t->values[i]) <= MPSI_LARGEST))
      return mpsi_fail(t->context, function, MPS_ERROR_ARGUMENT,
                       "values: component %d of point %lld is %s, must be within %g",
                       (int)(i % t->components), (long long)(i / t->components),
                       mpsi_outside(t->values[i], -MPSI_LARGEST, MPSI_LARGEST).text, MPSI_LARGEST);
  return MPS_OK;
}

static mps_status check_shape(table *t, const char *field) {
  if (!field) return mpsi_fail(t->context, function, MPS_ERROR_ARGUMENT, "field is NULL");
  MPSI_TRY(mpsi_field_look_up(t->set, function, field, &t->shape));
  if (t->shape.dtype.code != 2 || t->shape.flags & MPS_VIEW_READONLY)
    return mpsi_fail(t->context, function, MPS_ERROR_FIELD, "field '%s' is %s", field,
                     t->shape.dtype.code != 2 ? "of int64, must be float64"
                                              : "written by the library only");
  if (t->shape.components != t->components)
    return mpsi_fail(t->context, function, MPS_ERROR_FIELD, "components is %d, field '%s' has %d",
                     (int)t->components, field, (int)t->shape.components);
  return MPS_OK;
}

/* ---- the field ------------------------------------------------------------------------------- */

static mps_status read_table(table *t, const char *field, const double *positions,
                             int64_t *outside) {
  const int64_t n = t->set->count;
  t->tree.order = mpsi_alloc(t->context, t->tree.count, sizeof *t->tree.order);
  if (t->tree.order) t->out = mpsi_alloc(t->context, n * t->components, sizeof *t->out);
  if (t->out) t->blocks = mpsi_alloc(t->context, n / BLOCK + 1, sizeof *t->blocks);
  if (!t->blocks)
    return mpsi_fail_memory(t->context, function,
                            (size_t)(t->tree.count + n * t->components) * sizeof *t->out);
  mpsi_nearest_build(&t->tree);
  mps_status status =
      t->def.interpolation == MPS_TABLE_INTERPOLATION_LINEAR ? find_rank(t, positions) : MPS_OK;
  if (status == MPS_OK) status = find_values(t, outside);
  return status == MPS_OK ? mpsi_field_write(t->set, function, field, &t->shape, -1, t->out)
                          : status;
}

mps_status mps_particles_set_table(mps_particles *particles, const char *field, int64_t count,
                                   const double *positions, int32_t components,
                                   const double *values, const mps_table_def *def,
                                   int64_t *outside) {
  if (!particles) return mpsi_null(__func__, "particles");
  table t = {.set = particles,
             .context = particles->context,
             .def = mps_table_defaults(),
             .tree = {.x = positions, .count = count, .dim = particles->def.dim},
             .components = components,
             .values = values};
  int64_t beyond = 0;
  MPSI_TRY(mpsi_particles_writable(particles, function));
  if (def) MPSI_TRY(MPSI_DEF_READ(t.context, function, mps_table_def, def, &t.def));
  MPSI_TRY(check_shape(&t, field));
  MPSI_TRY(check_points(&t, positions));
  for (int32_t c = 0; c < t.tree.dim; c++)
    t.position[c] = mpsi_field_column(particles->fields[MPSI_FIELD_POSITION], c);
  mps_status status = read_table(&t, field, positions, &beyond);
  MPSI_FREE(t.context, t.tree.order, t.out, t.blocks);
  if (status != MPS_OK) return status;
  if (beyond > 0)
    mpsi_log(
        t.context, MPS_CONTEXT_LOG_INFO,
        "field '%s': %lld of %lld particles lie outside the %lld points of the table and have %s",
        field, (long long)beyond, (long long)particles->count, (long long)count,
        t.def.extrapolate ? "the linear function of the nearest" : "the nearest one's value");
  if (outside) *outside = beyond;
  return MPS_OK;
}
