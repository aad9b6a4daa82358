/* outside.c - see outside.h. An entry of the matrix joins two cells with a node in reach of both,
 * which are within three cells along each axis: sum over these nodes of dt^2 G_i m^-1 G_j. Rows and
 * columns are divided by the roots of their diagonals: a solver that ends on the sum of squares of
 * its residual then ends where the library's own does, on r.D^-1 r.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "outside.h"

#include "core/base/room_array.h"
#include "mpm/water/wide_halo.h"
#include "solver/linear.h"

#include <string.h>

enum { REACH = MPSI_PORE_SPAN - 1, SIDE = 2 * REACH + 1, MOST = SIDE * SIDE * SIDE };

typedef struct mpsi_pore_system system_of;
typedef struct mpsi_pore_outside outside_of;

bool mpsi_pore_solved_outside(const mps_mpm *mpm) {
  const system_of *s = mpm->water->system;
  return !s->contacts.any && mpsi_linear_serves(&mpm->base, s->unknowns);
}

void mpsi_pore_free_outside(mps_context *context, mpsi_pore_outside *o) {
  if (!o) return;
  MPSI_FREE(context, o->start_room.item, o->column_room.item, o->value_room.item,
            o->vector_room.item, o);
}

/* ---- numbers of rows ------------------------------------------------------------------------- */

/* Calls `task` with the unknowns that this rank counts, in order. */
typedef void unknown_task(mps_mpm *mpm, int64_t cell, int64_t number);

static int64_t for_unknowns(mps_mpm *mpm, unknown_task *task) {
  const mpsi_grid *grid = &mpm->grid;
  int64_t number = 0;
  for (int64_t g = 0; g < grid->node_count; g++) {
    const int64_t first = mpsi_first_node(grid, g);
    for (int k = 0; mpsi_mpm_counts_node_block(grid, g) && k < grid->block_nodes; k++)
      if (mpsi_pore_is_unknown(mpm->water, g, k)) task(mpm, first + k, number++);
  }
  return number;
}

static void count(mps_mpm *mpm, int64_t cell, int64_t number) {}

/* The root of the reciprocal diagonal. */
static void set_root(mps_mpm *mpm, int64_t cell, int64_t number) {
  system_of *s = mpm->water->system;
  s->direction[cell] = s->product[cell] = sqrt(s->inverse[cell]);
}

static void set_number(mps_mpm *mpm, int64_t cell, int64_t number) {
  mpm->water->system->direction[cell] = (double)(mpm->water->outside->first + number);
}

static void set_right(mps_mpm *mpm, int64_t cell, int64_t number) {
  const system_of *s = mpm->water->system;
  outside_of *o = mpm->water->outside;
  o->right[number] = s->residual[cell] * s->product[cell];
  o->solution[number] = 0.0;
}

static void take_solution(mps_mpm *mpm, int64_t cell, int64_t number) {
  system_of *s = mpm->water->system;
  const outside_of *o = mpm->water->outside;
  s->direction[cell] = o->solution[number] * s->product[cell];
}

/* This rank's rows among those of all. */
static mps_status find_place(mps_mpm *mpm, const char *function) {
  outside_of *o = mpm->water->outside;
  o->rows = for_unknowns(mpm, count);
  return mpsi_domain_count(mpm->domain, function, o->rows, &o->first, &o->all);
}

/* `product`: roots of the reciprocal diagonals, `direction`: numbers of the rows, or -1; both in
 * the wide halo too. */
static mps_status send_numbers(mps_mpm *mpm, const char *function) {
  system_of *s = mpm->water->system;
  const int64_t own = mpm->grid.node_count * mpm->grid.block_nodes,
                wide = s->wide_halo ? s->wide_halo->cells : 0;
  mps_status status = MPS_OK;
  for (int64_t k = 0; k < own; k++) s->direction[k] = 0.0;
  (void)for_unknowns(mpm, set_root);
  if (mpm->partition) status = mpsi_pore_send_direction(mpm, function);
  if (status != MPS_OK) return status;
  if (wide > 0) memcpy(s->product + own, s->direction + own, (size_t)wide * sizeof *s->product);
  for (int64_t k = 0; k < own; k++) s->direction[k] = -1.0;
  (void)for_unknowns(mpm, set_number);
  return mpm->partition ? mpsi_pore_send_direction(mpm, function) : MPS_OK;
}

/* ---- rows ------------------------------------------------------------------------------------ */

static int box_cells(const mpsi_grid *grid) { return grid->dim == 3 ? MOST : SIDE * SIDE; }
static int box_middle(const mpsi_grid *grid) { return box_cells(grid) / 2; }

/* Cells within reach of cell k of block g; returns how many of these are unknowns. */
static int find_box(const mpsi_grid *grid, const system_of *s, int64_t g, int k, int64_t *cell) {
  int at[3], unknowns = 0;
  mpsi_unravel(k, MPSI_SIDE, at);
  for (int e = 0; e < box_cells(grid); e++) {
    int offset[3];
    mpsi_unravel(e, SIDE, offset);
    for (int c = 0; c < 3; c++) offset[c] = c < grid->dim ? at[c] + offset[c] - REACH : 0;
    cell[e] = mpsi_pore_at(grid, s, g, offset);
    if (cell[e] >= 0 && !(s->direction[cell[e]] >= 0.0)) cell[e] = -1;
    unknowns += cell[e] >= 0;
  }
  return unknowns;
}

/* dt^2 G^T m^-1 G. */
static void add_node(const mpsi_grid *grid, const system_of *s, int64_t node, int q,
                     const double *own, const int64_t *cell, double *value) {
  static const int stride[3] = {1, SIDE, SIDE * SIDE};
  const int nodes = mpsi_pore_span_nodes(grid);
  int i[3];
  mpsi_unravel(q, MPSI_PORE_SPAN, i);
  for (int p = 0; p < nodes; p++) {
    int j[3], e = 0;
    double sum = 0.0;
    mpsi_unravel(p, MPSI_PORE_SPAN, j);
    for (int c = 0; c < grid->dim; c++) e += stride[c] * (i[c] - j[c] + REACH);
    if (cell[e] < 0) continue;
    const double *force = mpsi_pore_row(grid, s, cell[e]);
    for (int c = 0; c < grid->dim; c++)
      sum += own[c * nodes + q] * force[c * nodes + p] / s->inertia[node][c];
    value[e] += sum;
  }
}

/* The row of cell k of block g, by the cells of its box. */
static void find_row(const mps_mpm *mpm, int64_t g, int k, const int *shift, const int64_t *cell,
                     double *value) {
  static const int stride[3] = {1, SIDE, SIDE * SIDE};
  const mpsi_grid *grid = &mpm->grid;
  const system_of *s = mpm->water->system;
  const int middle = box_middle(grid);
  const int64_t here = mpsi_first_node(grid, g) + k;
  const double dt = mpm->run.dt, factor = dt * dt / grid->measure;
  const int32_t *near = s->reach + g * mpsi_pore_box_places(grid) + mpsi_pore_place(grid, k, 1);
  memset(value, 0, (size_t)box_cells(grid) * sizeof *value);
  for (int q = 0; q < mpsi_pore_span_nodes(grid); q++) {
    const int64_t node = near[shift[q]];
    if (node >= 0 && s->inertia[node][0] > 0.0)
      add_node(grid, s, node, q, mpsi_pore_row(grid, s, here), cell, value);
  }
  for (int e = 0; e < box_cells(grid); e++) value[e] *= factor;
  value[middle] += s->diagonal[here];
  for (int d = 0; d < 2 * grid->dim; d++) {
    const double flow = dt * s->conductance[here][d];
    value[middle] += flow;
    value[middle + (d & 1 ? stride[d / 2] : -stride[d / 2])] -= flow;
  }
  for (int e = 0; e < box_cells(grid); e++)
    if (cell[e] >= 0) value[e] *= s->product[here] * s->product[cell[e]];
}

static void count_rows(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const outside_of *o = mpm->water->outside;
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  int64_t cell[MOST];
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    if (mpsi_pore_is_unknown(mpm->water, g, k))
      o->start[(int64_t)s->direction[first + k] - o->first + 1] =
          find_box(&mpm->grid, s, g, k, cell);
}

static void fill_rows(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  const outside_of *o = mpm->water->outside;
  const int64_t first = mpsi_first_node(grid, g);
  int shift[MPSI_PORE_MOST_SPAN];
  int64_t cell[MOST];
  double row[MOST];
  mpsi_pore_list_shifts(grid, shift);
  for (int k = 0; k < grid->block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k)) continue;
    const int64_t from = o->start[(int64_t)s->direction[first + k] - o->first];
    int64_t count = 0;
    (void)find_box(grid, s, g, k, cell);
    find_row(mpm, g, k, shift, cell, row);
    for (int e = 0; e < box_cells(grid); e++) {
      if (cell[e] < 0) continue;
      const int32_t number = (int32_t)s->direction[cell[e]];
      int64_t at = from + count++;
      for (; at > from && o->column[at - 1] > number; at--)
        o->column[at] = o->column[at - 1], o->value[at] = o->value[at - 1];
      o->column[at] = number, o->value[at] = row[e];
    }
  }
}

static mps_status make_vectors(mps_mpm *mpm, const char *function) {
  outside_of *o = mpm->water->outside;
  if (!MPSI_ENSURE(mpm->context, o, start, o->rows + 1) ||
      !mpsi_room_ensure(mpm->context, &o->vector_room, 2 * o->rows, sizeof *o->right))
    return mpsi_fail_memory(mpm->context, function, (size_t)o->rows * 2 * sizeof *o->right);
  o->right = o->vector_room.item;
  o->solution = o->right + o->rows;
  return MPS_OK;
}

static mps_status make_entries(mps_mpm *mpm, const char *function) {
  outside_of *o = mpm->water->outside;
  const int64_t entries = o->start[o->rows];
  if (!MPSI_ENSURE(mpm->context, o, column, entries) ||
      !MPSI_ENSURE(mpm->context, o, value, entries))
    return mpsi_fail_memory(mpm->context, function, (size_t)entries * 12);
  return MPS_OK;
}

static mps_status make_rows(mps_mpm *mpm, const char *function) {
  outside_of *o = mpm->water->outside;
  MPSI_TRY(find_place(mpm, function));
  MPSI_TRY(mpsi_domain_agree(mpm->domain, function, make_vectors(mpm, function)));
  MPSI_TRY(send_numbers(mpm, function));
  o->start[0] = 0;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, count_rows, 0.0);
  for (int64_t k = 0; k < o->rows; k++) o->start[k + 1] += o->start[k];
  mps_status status = mpsi_domain_agree(mpm->domain, function, make_entries(mpm, function));
  if (status == MPS_OK) mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, fill_rows, 0.0);
  return status;
}

/* ---- solution -------------------------------------------------------------------------------- */

static mps_status make_memory(mps_mpm *mpm, const char *function) {
  outside_of **o = &mpm->water->outside;
  if (!*o) *o = mpsi_alloc(mpm->context, 1, sizeof **o);
  return mpsi_domain_agree(mpm->domain, function,
                           *o ? MPS_OK : mpsi_fail_memory(mpm->context, function, sizeof **o));
}

mps_status mpsi_pore_solve_outside(mps_mpm *mpm, const char *function, double tolerance) {
  MPSI_TRY(make_memory(mpm, function));
  MPSI_TRY(make_rows(mpm, function));
  const outside_of *o = mpm->water->outside;
  mps_linear_matrix matrix = {.all = o->all,
                              .first = o->first,
                              .rows = o->rows,
                              .block = 1,
                              .start = o->start,
                              .column = o->column,
                              .value = o->value};
  MPSI_TRY(mpsi_linear_hand(&mpm->base, function, &matrix));
  (void)for_unknowns(mpm, set_right);
  MPSI_TRY(mpsi_linear_solve(&mpm->base, function, tolerance, o->right, o->solution));
  mpm->water->system->iterations = mpm->linear->result.iterations;
  (void)for_unknowns(mpm, take_solution);
  return MPS_OK;
}
