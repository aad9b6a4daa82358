/* probe.c - fields of the particles at any points (mps/grid.h): at each a weighted least-squares
 * fit of a linear function, Nakamura (5), (6), with the roles of nodes and particles exchanged. The
 * fit is about the weighted mean of the particles' positions, which limits round-off. On several
 * ranks all receive the particles near the points. Sums are in the order of cells, within a cell of
 * ids. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "core/base/order.h"
#include "mpm/base/shape.h"

#include <mps/grid.h>
#include <mps/experimental/domain.h>

#include <stdlib.h>
#include <string.h>

#define LEAST_FILLED 0.2
#define SINGULAR 1e-9 /* cells squared: particles spread less have no gradient */
#define REACH 2       /* cells: half the width of the weights, rounded up */

/* A particle with its cell. */
typedef struct item {
  int64_t cell[3], id, index; /* index: position in the rows */
} item;

static int compare_cells(const int64_t *a, const int64_t *b) {
  for (int c = 2; c >= 0; c--)
    if (a[c] != b[c]) return a[c] < b[c] ? -1 : 1;
  return 0;
}

static int compare(const void *a, const void *b) {
  const item *p = a, *q = b;
  const int order = compare_cells(p->cell, q->cell);
  return order != 0 ? order : p->id < q->id ? -1 : p->id > q->id;
}

/* A particle's row: x, V, and the field's columns, as many as a field may have. */
enum { MOST_COLUMNS = 16, ROW_V = 3, ROW_FIELD, MOST_ROW = ROW_FIELD + MOST_COLUMNS };
typedef struct row {
  item at;
  double value[MOST_ROW];
} row;

/* Particles near the points, sorted by their cells. */
typedef struct near {
  mps_mpm *mpm;
  const double *column[MOST_COLUMNS]; /* columns of the field */
  int32_t columns;
  item *item;
  row *row;
  int64_t count;
} near;

static void fill_row(const near *list, int64_t k, row *out) {
  const mpsi_columns *p = &list->mpm->p;
  *out = (row){.at.id = mpsi_particles_integers(list->mpm->p.set, "id")[k]};
  for (int c = 0; c < list->mpm->grid.dim; c++) {
    out->value[c] = p->x[c][k];
    out->at.cell[c] = (int64_t)floor(mpsi_grid_at(&list->mpm->grid, c, p->x[c][k]));
  }
  out->value[ROW_V] = p->V[k];
  for (int32_t c = 0; c < list->columns; c++) out->value[ROW_FIELD + c] = list->column[c][k];
}

/* Lists this rank's particles near the points; false: no memory. */
static bool list_own(near *list, int64_t count, const double *points) {
  const mps_mpm *mpm = list->mpm;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int64_t i = 0; i < count; i++)
    for (int c = 0; c < mpm->grid.dim; c++) {
      const double X = mpsi_grid_at(&mpm->grid, c, points[3 * i + c]);
      low[c] = fmin(low[c], X - REACH), high[c] = fmax(high[c], X + REACH);
    }
  for (int pass = 0; pass < 2; pass++) {
    if (pass == 1) list->row = mpsi_alloc(mpm->context, list->count, sizeof *list->row);
    if (pass == 1 && !list->row) return false;
    list->count = 0;
    for (int64_t k = 0; k < mpm->p.count; k++) {
      bool inside = true;
      for (int c = 0; c < mpm->grid.dim && inside; c++) {
        const double X = mpsi_grid_at(&mpm->grid, c, mpm->p.x[c][k]);
        inside = X >= low[c] && X <= high[c];
      }
      if (inside && pass == 1) fill_row(list, k, &list->row[list->count]);
      list->count += inside;
    }
  }
  return true;
}

/* Replaces this rank's rows by those of all ranks. */
static mps_status join_rows(near *list, const char *function, const mpsi_mailbox *box) {
  mps_context *context = list->mpm->context;
  int64_t count = list->count;
  for (int32_t m = 0; m < box->count; m++) count += box->mail[m].bytes / (int64_t)sizeof(row);
  row *all = mpsi_alloc(context, count, sizeof *all);
  if (!all) return mpsi_fail_memory(context, function, (size_t)count * sizeof *all);
  if (list->count > 0) memcpy(all, list->row, (size_t)list->count * sizeof *all);
  char *to = (char *)(all + list->count);
  for (int32_t m = 0; m < box->count; to += box->mail[m++].bytes)
    memcpy(to, box->mail[m].data, (size_t)box->mail[m].bytes);
  mpsi_free(context, list->row);
  list->row = all;
  list->count = count;
  return MPS_OK;
}

static mps_status exchange_particles(near *list, const char *function, mps_status status) {
  mps_domain *domain = list->mpm->domain;
  mps_context *context = list->mpm->context;
  mpsi_mailbox box = {.context = context};
  int32_t count = 0;
  mps_domain_message *message = mpsi_alloc(context, mps_domain_size(domain), sizeof *message);
  if (!message && status == MPS_OK)
    status = mpsi_fail_memory(context, function, (size_t)mps_domain_size(domain) * 24);
  status = mpsi_domain_agree(domain, function, status);
  for (int32_t r = 0; status == MPS_OK && r < mps_domain_size(domain) && list->count > 0; r++)
    if (r != mps_domain_rank(domain))
      message[count++] = (mps_domain_message){
          .rank = r, .bytes = list->count * (int64_t)sizeof(row), .data = list->row};
  if (status == MPS_OK) status = mpsi_domain_exchange(domain, function, count, message, &box);
  if (status == MPS_OK)
    status = mpsi_domain_agree(domain, function, join_rows(list, function, &box));
  mpsi_domain_free_mail(&box);
  mpsi_free(context, message);
  return status;
}

static mps_status list_near(near *list, const char *function, int64_t count, const double *points) {
  mps_context *context = list->mpm->context;
  mps_status status = MPS_OK;
  if (!list_own(list, count, points))
    status = mpsi_fail_memory(context, function, (size_t)list->count * sizeof *list->row);
  if (list->mpm->partition) status = exchange_particles(list, function, status);
  if (status != MPS_OK) return status;
  list->item = mpsi_alloc(context, list->count, sizeof *list->item);
  if (!list->item)
    status = mpsi_fail_memory(context, function, (size_t)list->count * sizeof *list->item);
  status = mpsi_mpm_agree(list->mpm->partition, function, status);
  for (int64_t k = 0; status == MPS_OK && k < list->count; k++) {
    list->item[k] = list->row[k].at;
    list->item[k].index = k;
  }
  if (status == MPS_OK) qsort(list->item, (size_t)list->count, sizeof *list->item, compare);
  return status;
}

/* The first item that is not before `cell`. */
static int64_t first_from(const near *list, const int64_t *cell) {
  int64_t low;
  MPSI_BISECT(low, list->count, middle, compare_cells(list->item[middle].cell, cell) < 0);
  return low;
}

/* ---- one point ------------------------------------------------------------------------------- */

/* Weighted sums over the particles about a point: positions in cells from it. */
typedef struct fit {
  const near *list;
  double X[3];
  double weight, filled, mean[3];
  double inverse[3][3]; /* inverse of the second moments about the mean; 0 along directions without
                           spread */
} fit;

typedef void (*particle_fn)(fit *f, int64_t particle, double w, const double *s, void *data);

static void for_particles(fit *f, particle_fn add, void *data) {
  const near *list = f->list;
  const mps_mpm *mpm = list->mpm;
  int64_t own[3] = {0}, cell[3];
  for (int c = 0; c < mpm->grid.dim; c++) own[c] = (int64_t)floor(f->X[c]);
  const int64_t deep = mpm->grid.dim == 3 ? REACH : 0;
  for (cell[2] = own[2] - deep; cell[2] <= own[2] + deep; cell[2]++)
    for (cell[1] = own[1] - REACH; cell[1] <= own[1] + REACH; cell[1]++) {
      cell[0] = own[0] - REACH;
      for (int64_t n = first_from(list, cell); n < list->count; n++) {
        const item *at = &list->item[n];
        if (at->cell[2] != cell[2] || at->cell[1] != cell[1] || at->cell[0] > own[0] + REACH) break;
        double w = 1.0, s[3] = {0.0};
        for (int c = 0; c < mpm->grid.dim; c++) {
          s[c] = mpsi_grid_at(&mpm->grid, c, list->row[at->index].value[c]) - f->X[c];
          w *= mpsi_spline_at(mpm->grid.spline, s[c]);
        }
        if (w > 0.0) add(f, at->index, w, s, data);
      }
    }
}

static void add_weight(fit *f, int64_t k, double w, const double *s, void *data) {
  const mps_mpm *mpm = f->list->mpm;
  const double across =
      mpm->grid.measure *
      (mpm->grid.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC ? f->list->row[k].value[0] : 1.0);
  f->weight += w;
  f->filled += w * f->list->row[k].value[ROW_V] / across;
  for (int c = 0; c < 3; c++) f->mean[c] += w * s[c];
}

static void add_spread(fit *f, int64_t k, double w, const double *s, void *data) {
  double(*spread)[3] = data;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) spread[a][b] += w * (s[a] - f->mean[a]) * (s[b] - f->mean[b]);
}

/* Inverse by Gauss-Jordan elimination; rows and columns without a pivot become 0. */
static void invert(int n, double (*m)[3], double (*out)[3]) {
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) out[a][b] = a == b && a < n ? 1.0 : 0.0;
  for (int p = 0; p < n; p++) {
    const bool flat = !(m[p][p] > SINGULAR);
    const double scale = flat ? 0.0 : 1.0 / m[p][p];
    for (int b = 0; b < n; b++) m[p][b] *= scale, out[p][b] *= scale;
    for (int a = 0; a < n; a++) {
      const double factor = a == p ? 0.0 : m[a][p];
      for (int b = 0; b < n; b++) m[a][b] -= factor * m[p][b], out[a][b] -= factor * out[p][b];
    }
  }
}

static int32_t begin_fit(fit *f) {
  const mps_mpm *mpm = f->list->mpm;
  double spread[3][3] = {{0.0}};
  for (int c = 0; c < mpm->grid.dim; c++)
    if (!(f->X[c] >= (double)mpm->grid.low[c] && f->X[c] <= (double)mpm->grid.high[c]))
      return MPS_GRID_POINT_OUTSIDE;
  for_particles(f, add_weight, NULL);
  for (int c = 0; c < mpm->grid.dim; c++) f->filled *= mpm->grid.inverse;
  if (!(f->filled >= LEAST_FILLED)) return MPS_GRID_POINT_EMPTY;
  for (int c = 0; c < 3; c++) f->mean[c] /= f->weight;
  for_particles(f, add_spread, spread);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) spread[a][b] /= f->weight;
  invert(mpm->grid.dim, spread, f->inverse);
  return MPS_GRID_POINT_INSIDE;
}

/* Weighted sum of a column, and its first moment about the mean position. */
typedef struct sums {
  int32_t column; /* index in the rows */
  double value, slope[3];
} sums;

static void add_value(fit *f, int64_t k, double w, const double *s, void *data) {
  sums *sum = data;
  const double value = f->list->row[k].value[sum->column];
  sum->value += w * value;
  for (int c = 0; c < 3; c++) sum->slope[c] += w * (s[c] - f->mean[c]) * value;
}

static double value_of(fit *f, int32_t column) {
  sums sum = {.column = ROW_FIELD + column};
  for_particles(f, add_value, &sum);
  double value = sum.value / f->weight;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) value -= f->mean[a] * f->inverse[a][b] * sum.slope[b] / f->weight;
  return value;
}

/* ---- public function ------------------------------------------------------------------------- */

static mps_status check(const mps_mpm *mpm, const char *function, const char *field,
                        int32_t component, int64_t count, const double *points,
                        const double *values, int32_t *components) {
  if (!field) return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT, "field is NULL");
  if (count < 0)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  if (count > 0 && (!points || !values))
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT, "%s is NULL",
                     points ? "values" : "points");
  mps_status status = mpsi_particles_ready(mpm->p.set, function);
  if (status == MPS_OK && (mpm->run.broken || mpm->run.lost))
    status = mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                       "the last step ended with a particle that is %s: there is no state to read",
                       mpm->run.broken ? "not finite" : "outside the domain");
  if (status != MPS_OK) return status;
  for (*components = 0; mpsi_particles_column(mpm->p.set, field, *components); ++*components)
    continue;
  if (*components == 0)
    return mpsi_fail(mpm->context, function, MPS_ERROR_FIELD,
                     "the set has no field '%.60s' of float64", field);
  if (component < -1 || component >= *components)
    return *components == 1
               ? mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                           "component of field '%s' is %d, and the field has one alone: 0 or -1",
                           field, component)
               : mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                           "component of field '%s' is %d, allowed are 0 to %d, and -1 for all",
                           field, component, *components - 1);
  for (int64_t i = 0; i < count; i++)
    for (int c = 0; c < mpm->grid.dim; c++)
      if (!(fabs(points[3 * i + c]) <= 1e15))
        return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                         "points: point %lld has %c = %g m, must be within 1e15 m", (long long)i,
                         "xyz"[c], points[3 * i + c]);
  return MPS_OK;
}

/* Checks that all ranks ask for the same: each adds its particles to every point. */
static mps_status agree_on_points(const mpsi_grid *grid, mpsi_partition *partition,
                                  const char *function, mps_status status, const char *field,
                                  int32_t component, int64_t count, const double *points) {
  mpsi_given given = MPSI_GIVEN;
  if (!partition) return status;
  if (status == MPS_OK) {
    mpsi_give_text(&given, "a hash of field", field);
    mpsi_give(&given, "component", component);
    mpsi_give(&given, "count", (double)count);
    for (int64_t i = 0; i < count; i++) /* in 2D the third coordinate is not read */
      mpsi_give_vector(&given, "points", grid->dim, points + 3 * i);
  }
  return mpsi_domain_agree_given(partition->domain, function, status, &given);
}

mps_status mps_grid_evaluate(const mps_grid *grid, const char *field, int32_t component,
                             int64_t count, const double *points, double *values, int32_t *states) {
  if (!grid) return mpsi_null(__func__, "grid");
  mps_mpm *mpm = grid->mpm;
  near list = {.mpm = mpm};
  int32_t components = 0;
  mps_status status = check(mpm, __func__, field, component, count, points, values, &components);
  status = agree_on_points(&mpm->grid, mpm->partition, __func__, status, field, component, count,
                           points);
  if (status != MPS_OK || count == 0) return status;
  const int32_t first = component < 0 ? 0 : component, width = component < 0 ? components : 1;
  list.columns = width;
  for (int32_t c = 0; c < width; c++)
    list.column[c] = mpsi_particles_column(mpm->p.set, field, first + c);
  status = list_near(&list, __func__, count, points);
  if (status != MPS_OK) {
    MPSI_FREE(mpm->context, list.row, list.item);
    return status;
  }
  for (int64_t i = 0; i < count; i++) {
    fit f = {.list = &list};
    for (int c = 0; c < mpm->grid.dim; c++) f.X[c] = mpsi_grid_at(&mpm->grid, c, points[3 * i + c]);
    const int32_t state = begin_fit(&f);
    for (int32_t c = 0; c < width; c++)
      values[width * i + c] = state == MPS_GRID_POINT_INSIDE ? value_of(&f, c) : NAN;
    if (states) states[i] = state;
  }
  MPSI_FREE(mpm->context, list.row, list.item);
  return MPS_OK;
}
