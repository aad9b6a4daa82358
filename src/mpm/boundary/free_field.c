/* free_field.c - free-field sides: what they need, and the column of soil beside one, made of
 * copies of the particles in the cells at the side. See free_field.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "free_field.h"
#include "mpm/ranks/partition.h"

#include "corners.h"
#include "kinds.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SAME_ROW 1e-6 /* cells */
#define BESIDE "allowed there are MPS_BOUNDARY_HELD, _DRIVEN, _ROLLER, _ABSORBING, _FREE and _OPEN"
enum { MARGIN = 8, GHOSTS = 2 }; /* nodes above and below the particles; beyond a side */

/* ---- checks ---------------------------------------------------------------------------------- */

bool mpsi_mpm_has_free_field(const mpsi_boundaries *boundaries) {
  return mpsi_kind_of(&boundaries->boundary[0])->column ||
         mpsi_kind_of(&boundaries->boundary[1])->column;
}

mps_status mpsi_mpm_check_beside_field(mps_context *context, const mpsi_boundaries *boundaries,
                                       const char *function, int32_t number, int32_t kind) {
  if (number / 2 != 1 || kind != MPS_BOUNDARY_FRICTIONAL || !mpsi_mpm_has_free_field(boundaries))
    return MPS_OK;
  return mpsi_fail(
      context, function, MPS_ERROR_ARGUMENT,
      "kind is MPS_BOUNDARY_FRICTIONAL beside a side of kind MPS_BOUNDARY_FREE_FIELD: " BESIDE);
}

mps_status mpsi_mpm_check_free_field(const mpsi_boundary_setup *setup, const char *function,
                                     int32_t number) {
  const mpsi_grid *grid = setup->grid;
  static const char kind[] = "kind is MPS_BOUNDARY_FREE_FIELD";
  if (grid->geometry != MPS_MPM_GEOMETRY_PLANE_STRAIN)
    return mpsi_fail(setup->context, function, MPS_ERROR_ARGUMENT,
                     "%s with geometry %s, must be MPS_MPM_GEOMETRY_PLANE_STRAIN", kind,
                     mpsi_name_of("mps_mpm_geometry", (int32_t)grid->geometry).text);
  if (number / 2 != 0)
    return mpsi_fail(setup->context, function, MPS_ERROR_ARGUMENT,
                     "%s at %s, must be at MPS_SIDE_X_LOWER or MPS_SIDE_X_UPPER", kind,
                     mpsi_name_of("mps_side", number).text);
  if (grid->standard || grid->by_weight)
    return mpsi_fail(setup->context, function, MPS_ERROR_ARGUMENT,
                     "%s, which the standard method and transfer by weights do not allow", kind);
  if (setup->partition)
    return mpsi_fail(setup->context, function, MPS_ERROR_ARGUMENT,
                     "%s on several ranks, allowed in one process: the column needs all particles "
                     "at the side",
                     kind);
  if (grid->high[0] - grid->low[0] < MPSI_FIELD_CELLS)
    return mpsi_fail(setup->context, function, MPS_ERROR_ARGUMENT,
                     "%s of a domain %lld cells wide, must be at least %d", kind,
                     (long long)(grid->high[0] - grid->low[0]), MPSI_FIELD_CELLS);
  for (int32_t k = MPS_SIDE_Y_LOWER; k <= MPS_SIDE_Y_UPPER; k++)
    if (setup->boundaries->boundary[k].kind == MPS_BOUNDARY_FRICTIONAL)
      return mpsi_fail(setup->context, function, MPS_ERROR_ARGUMENT,
                       "%s beside %s of kind MPS_BOUNDARY_FRICTIONAL: " BESIDE, kind,
                       mpsi_name_of("mps_side", k).text);
  if (setup->has_relaxation)
    return mpsi_fail(setup->context, function, MPS_ERROR_STATE,
                     "%s after mps_mpm_settle was cancelled, which has left velocities that are no "
                     "motion of the ground: let it end, or make a step",
                     kind);
  return MPS_OK;
}

/* ---- memory ---------------------------------------------------------------------------------- */

enum { FIXED = 23, RESTS = 6 }; /* columns besides histories; numbers of the sides across y */

static void lay_out(mpsi_free_field *f) {
  double *at = f->state;
  double **columns[FIXED] = {
      &f->y,    &f->v[0], &f->v[1], &f->slope[0],    &f->slope[1], &f->s[0], &f->s[1], &f->s[2],
      &f->s[3], &f->V,    &f->m,    &f->J,           &f->F[0],     &f->F[1], &f->F[2], &f->F[3],
      &f->F[4], &f->cp,   &f->cs,   &f->temperature, &f->u,        &f->g,    &f->seen};
  for (int c = 0; c < FIXED; c++, at += f->count) *columns[c] = at;
  f->history = at;
  f->rest = at + f->histories * f->count;
}

static bool take(mps_context *context, void *pointer, int64_t count, size_t size) {
  void *memory = mpsi_alloc(context, count, size);
  memcpy(pointer, &memory, sizeof memory);
  return memory != NULL;
}

static bool reserve(mps_context *context, mpsi_free_field *f) {
  const int64_t n = f->count;
  f->doubles = (FIXED + f->histories) * n + RESTS;
  if (!take(context, &f->state, f->doubles, sizeof *f->state) ||
      !take(context, &f->kept, f->doubles, sizeof *f->kept) ||
      !take(context, &f->law, n, sizeof *f->law) || !take(context, &f->id, n, sizeof *f->id) ||
      !take(context, &f->row_of, n, sizeof *f->row_of) ||
      !take(context, &f->row, n, sizeof *f->row) ||
      !take(context, &f->derivative[0], 4 * n, sizeof(double)) ||
      !take(context, &f->lowest, n, sizeof *f->lowest) ||
      !take(context, &f->node, f->nodes, sizeof *f->node))
    return false;
  f->derivative[1] = f->derivative[0] + n;
  f->x = f->derivative[0] + 2 * n;
  f->former = f->derivative[0] + 3 * n;
  lay_out(f);
  return true;
}

void mpsi_mpm_free_field_free(mps_context *context, mpsi_free_field **pointer) {
  mpsi_free_field *f = *pointer;
  if (!f) return;
  MPSI_FREE(context, f->state, f->kept, f->law, f->id, f->row_of, f->row, f->derivative[0],
            f->lowest, f->node);
  mpsi_free(context, f);
  *pointer = NULL;
}

/* ---- particles ------------------------------------------------------------------------------- */

/* A particle of the set in the cells at the side. */
typedef struct source {
  int64_t index, law;
  double y;
} source;

/* By law, so that a law is called with runs of its own particles; then from below. */
static int compare(const void *left, const void *right) {
  const source *a = left, *b = right;
  if (a->law != b->law) return a->law < b->law ? -1 : 1;
  if (a->y != b->y) return a->y < b->y ? -1 : 1;
  return (a->index > b->index) - (a->index < b->index);
}

static bool is_at_side(const mpsi_grid *grid, const mpsi_columns *p, int32_t number, int64_t k) {
  const double X = mpsi_grid_at(grid, 0, p->x[0][k]);
  const double depth = number % 2 ? (double)grid->high[0] - X : X - (double)grid->low[0];
  return depth > -MPSI_ON_BORDER && depth < 1.0 - MPSI_ON_BORDER;
}

/* The particles at the side; `out` NULL: counts them. */
static int64_t find_sources(const mpsi_grid *grid, const mpsi_columns *p, int32_t number,
                            source *out) {
  int64_t count = 0;
  for (int64_t k = 0; k < p->count; k++) {
    if (!is_at_side(grid, p, number, k)) continue;
    if (out) out[count] = (source){k, p->law ? p->law[k] : 0, p->x[1][k]};
    count++;
  }
  if (out) qsort(out, (size_t)count, sizeof *out, compare);
  return count;
}

static void copy_particle(const mpsi_columns *p, int64_t k, int64_t to, mpsi_free_field *f) {
  const mpsi_law_use *law = mpsi_law_of(p, k);
  f->y[to] = p->x[1][k];
  for (int c = 0; c < 2; c++) f->v[c][to] = p->v[c][k], f->slope[c][to] = p->L[2 * c + 1][k];
  for (int c = 0; c < 4; c++) f->s[c][to] = p->s[c][k];
  f->V[to] = p->V[k];
  f->m[to] = p->m[k];
  f->J[to] = p->J ? p->J[k] : 1.0;
  for (int c = 0; c < 5; c++) f->F[c][to] = p->F[c] ? p->F[c][k] : c == 0 || c >= 3 ? 1.0 : 0.0;
  double wave, shear;
  mpsi_mpm_saturated(p, k, &wave, &shear);
  f->cp[to] = sqrt(wave * p->V[k] / p->m[k]);
  f->cs[to] = sqrt(shear * p->V[k] / p->m[k]);
  f->u[to] = f->seen[to] = p->u ? p->u[k] : 0.0;
  f->g[to] = p->u ? p->g[1][k] : 0.0;
  f->temperature[to] = p->laws.temperature ? p->laws.temperature[k] : 0.0;
  for (int32_t h = 0; h < law->columns; h++) f->history[h * f->count + to] = law->history[h][k];
  f->law[to] = p->law ? p->law[k] : 0;
  f->id[to] = p->laws.ids[k];
}

static int compare_heights(const void *left, const void *right) {
  const double *a = left, *b = right;
  if (*a != *b) return *a < *b ? -1 : 1;
  return (a[1] > b[1]) - (a[1] < b[1]);
}

/* Gathers particles at one height in a row: by stresses of rows the heights between two of them are
 * interpolated. The order of rows never changes, as particles of a column do not pass others. */
static void find_rows(const mpsi_grid *grid, mpsi_free_field *f, double (*scratch)[2]) {
  for (int64_t k = 0; k < f->count; k++) scratch[k][0] = f->y[k], scratch[k][1] = (double)k;
  qsort(scratch, (size_t)f->count, sizeof *scratch, compare_heights);
  f->rows = 0;
  for (int64_t k = 0; k < f->count; k++) {
    if (k == 0 || scratch[k][0] - scratch[k - 1][0] > SAME_ROW * grid->cell) f->rows++;
    f->row_of[(int64_t)scratch[k][1]] = f->rows - 1;
  }
}

/* Nodes that the particles reach, with a margin for their motion, and ghosts beyond the sides. */
static void find_nodes(const mpsi_grid *grid, const source *from, mpsi_free_field *f) {
  double low = INFINITY, high = -INFINITY;
  for (int64_t k = 0; k < f->count; k++) low = fmin(low, from[k].y), high = fmax(high, from[k].y);
  int64_t first = (int64_t)floor(mpsi_grid_at(grid, 1, low)) - MARGIN;
  int64_t last = (int64_t)ceil(mpsi_grid_at(grid, 1, high)) + MARGIN;
  if (first < grid->low[1] - GHOSTS) first = grid->low[1] - GHOSTS;
  if (last > grid->high[1] + GHOSTS) last = grid->high[1] + GHOSTS;
  f->first = first;
  f->nodes = last - first + 1;
}

static void fill(const mpsi_boundary_setup *setup, const source *from, int32_t number,
                 mpsi_free_field *f) {
  const mpsi_grid *grid = setup->grid;
  const int64_t wall = number == MPS_SIDE_X_LOWER ? grid->low[0] : grid->high[0];
  for (int64_t k = 0; k < f->count; k++) {
    copy_particle(setup->p, from[k].index, k, f);
    f->x[k] = grid->origin[0] + grid->cell * (double)wall;
  }
  for (int side = 0; side < 2; side++) f->rest[3 * side + 2] = 1.0;
}

mps_status mpsi_mpm_make_free_field(const mpsi_boundary_setup *setup, const char *function,
                                    int32_t number, mpsi_free_field **out) {
  const mpsi_grid *grid = setup->grid;
  const mpsi_columns *p = setup->p;
  const int64_t count = find_sources(grid, p, number, NULL);
  if (count == 0)
    return mpsi_fail(setup->context, function, MPS_ERROR_ARGUMENT,
                     "kind is MPS_BOUNDARY_FREE_FIELD at %s, and the cells at that side have no "
                     "particles: the ground that continues beyond it must reach it",
                     mpsi_name_of("mps_side", number).text);
  mpsi_free_field *f = mpsi_alloc(setup->context, 1, sizeof *f);
  source *from = f ? mpsi_alloc(setup->context, count, sizeof *from) : NULL;
  double(*scratch)[2] = from ? mpsi_alloc(setup->context, count, sizeof *scratch) : NULL;
  bool good = scratch != NULL;
  if (good) {
    f->count = count;
    for (int32_t k = 0; k < p->laws.count; k++)
      if (p->laws.law[k].columns > f->histories) f->histories = p->laws.law[k].columns;
    find_sources(grid, p, number, from);
    find_nodes(grid, from, f);
    good = reserve(setup->context, f);
  }
  if (good) {
    fill(setup, from, number, f);
    find_rows(grid, f, scratch);
    memcpy(f->kept, f->state, (size_t)f->doubles * sizeof *f->state);
  }
  MPSI_FREE(setup->context, from, scratch);
  if (!good) {
    mpsi_mpm_free_field_free(setup->context, &f);
    return mpsi_fail_memory(setup->context, function, (size_t)count * FIXED * sizeof(double));
  }
  *out = f;
  return MPS_OK;
}

/* ---- state ----------------------------------------------------------------------------------- */

void mpsi_mpm_list_free_field(mpsi_state *state, mpsi_free_field *field) {
  mpsi_state_agree_integer(state, "column_particles", field->count);
  mpsi_state_agree_integer(state, "column_histories", field->histories);
  mpsi_state_agree_integer(state, "column_nodes", field->nodes);
  mpsi_state_agree_integer(state, "column_first", field->first);
  /* ground that was set when it had settled otherwise may have its particles in other rows */
  mpsi_state_i64(state, "column_rows", &field->rows, 1);
  mpsi_state_f64(state, "column", field->state, field->doubles);
  mpsi_state_i64(state, "column_laws", field->law, field->count);
  mpsi_state_i64(state, "column_ids", field->id, field->count);
  mpsi_state_i64(state, "column_row_of", field->row_of, field->count);
}

static const int64_t *read_saved(mps_snapshot *from, int32_t number, const char *what) {
  char name[MPSI_STATE_NAME];
  (void)snprintf(name, sizeof name, "boundary%d/%s", number, what);
  return mpsi_values_find(&from->state, name)->data;
}

bool mpsi_mpm_free_field_fits(const mpsi_free_field *field, int32_t number, const mpsi_laws *laws,
                              mps_snapshot *from) {
  const int64_t rows = *read_saved(from, number, "column_rows");
  const int64_t *law = read_saved(from, number, "column_laws");
  const int64_t *row = read_saved(from, number, "column_row_of");
  if (rows < 1 || rows > field->count) return false;
  for (int64_t k = 0; k < field->count; k++)
    if (row[k] < 0 || row[k] >= rows || law[k] < 0 || law[k] >= laws->count ||
        laws->law[law[k]].columns > field->histories)
      return false;
  return true;
}
