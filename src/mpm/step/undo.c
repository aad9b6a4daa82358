/* undo.c - see undo.h. A step has changed, when it fails half way: columns of the particles,
 * positions and sums of boundaries, forces at rest of absorbing sides, and the warm-start impulses
 * of contacts and of lists of particles. Time, bodies, energy budget and the sums of the water
 * change after that.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/water/water.h"

#include <string.h>

static void add(mpsi_undo *u, double *column) {
  if (column) u->column[u->columns++] = column;
}

static void list_columns(const mpsi_grid *grid, const mpsi_columns *p, double *const *seepage,
                         mpsi_undo *u) {
  u->columns = 0;
  for (int c = 0; c < grid->dim; c++) add(u, p->x[c]), add(u, p->v[c]);
  for (int c = 0; c < 2 * grid->dim; c++) add(u, p->s[c]);
  for (int c = 0; c < 9; c++) add(u, p->L[c]), add(u, p->F[c]);
  add(u, p->V), add(u, p->J);
  add(u, p->u), add(u, p->slow == p->u ? NULL : p->slow), add(u, p->n), add(u, p->k),
      add(u, p->m); /* pore water */
  for (int c = 0; c < grid->dim; c++) add(u, p->g[c]), add(u, seepage[c]);
  for (int32_t k = 0; k < p->laws.count; k++)
    for (int32_t h = 0; h < p->laws.law[k].columns; h++) add(u, p->laws.law[k].history[h]);
}

static double *saved(const mpsi_undo *u, int32_t c, int64_t count) {
  return (double *)u->room.item + c * count;
}

/* A step swaps the memory of the warm-start impulses with that of the step before. */
static void save_impulses(const mpsi_contacts *contacts, mpsi_undo *undo, int which) {
  const mpsi_impulses *all = &contacts->impulses;
  undo->impulses[which].kept = all->warm_room.item;
  undo->impulses[which].warm_count = all->warm_count;
  undo->impulses[which].warm_dt = all->warm_dt;
}

static void restore_impulses(mpsi_contacts *contacts, const mpsi_undo *undo, int which) {
  mpsi_impulses *all = &contacts->impulses;
  if (all->warm_room.item != undo->impulses[which].kept) {
    const mpsi_room next = all->warm_room;
    all->warm_room = all->next_room;
    all->next_room = next;
  }
  all->warm = all->warm_room.item;
  all->warm_count = undo->impulses[which].warm_count;
  all->warm_dt = undo->impulses[which].warm_dt;
}

/* Copies the sums of boundaries, or restores them (`back`). */
static void copy_sums(const mpsi_boundaries *boundaries, const mpsi_undo *undo, bool back) {
  mpsi_boundary_sums *saved = undo->sums_room.item;
  for (int32_t k = 0; k < boundaries->count; k++) {
    mpsi_boundary_sums *sums = boundaries->boundary[k].sums;
    if (!sums) continue;
    if (back)
      *sums = *saved++;
    else
      *saved++ = *sums;
  }
}

mps_status mpsi_mpm_prepare_undo(mps_mpm *mpm, const char *function) {
  mpsi_undo *u = &mpm->undo;
  const mpsi_boundaries *b = &mpm->boundaries;
  double *seepage[3] = {NULL};
  for (int c = 0; c < mpm->grid.dim && mpm->water; c++)
    seepage[c] = mpsi_particles_column(mpm->p.set, "seepage", c);
  mpsi_bound_begin(mpm);
  u->on = !mpsi_bound_is_calm(mpm) || mpsi_pore_predicts(mpm) || mpsi_bound_by_law(&mpm->p);
  if (!u->on) return MPS_OK;
  int64_t most = MPSI_UNDO_COLUMNS, sums = 0;
  for (int32_t k = 0; k < b->count; k++) sums += b->boundary[k].sums != NULL;
  for (int32_t k = 0; k < mpm->p.laws.count; k++) most += mpm->p.laws.law[k].columns;
  bool good =
      mpsi_room_ensure(mpm->context, &u->list_room, most, sizeof *u->column) &&
      mpsi_room_ensure(mpm->context, &u->boundary_room, b->count, sizeof *b->boundary) &&
      mpsi_room_ensure(mpm->context, &u->sums_room, sums, sizeof(mpsi_boundary_sums)) &&
      mpsi_room_ensure(mpm->context, &u->dashpot_room, b->dashpot_count, sizeof *b->dashpot);
  u->column = u->list_room.item;
  if (good) list_columns(&mpm->grid, &mpm->p, seepage, &mpm->undo);
  good =
      good && mpsi_room_ensure(mpm->context, &u->room, u->columns * mpm->p.count, sizeof(double));
  if (!good)
    return mpsi_fail_memory(mpm->context, function,
                            (size_t)(u->columns * mpm->p.count) * sizeof(double));
  memcpy(u->boundary_room.item, b->boundary, (size_t)b->count * sizeof *b->boundary);
  copy_sums(&mpm->boundaries, &mpm->undo, false);
  save_impulses(&mpm->contact, &mpm->undo, 0);
  save_impulses(&mpm->prescribed.constraints, &mpm->undo, 1);
  if (b->dashpot_count > 0)
    memcpy(u->dashpot_room.item, b->dashpot, (size_t)b->dashpot_count * sizeof *b->dashpot);
  return MPS_OK;
}

void mpsi_mpm_save_block(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_undo *u,
                         int64_t block) {
  const mpsi_cell_block *cells = &grid->cells[block];
  const size_t bytes = (size_t)(cells->end - cells->begin) * sizeof(double);
  for (int32_t c = 0; c < u->columns; c++)
    memcpy(saved(u, c, p->count) + cells->begin, u->column[c] + cells->begin, bytes);
}

void mpsi_mpm_undo(const mpsi_grid *grid, const mpsi_columns *p, mpsi_boundaries *b,
                   mpsi_contacts *contacts, mpsi_prescribed *prescribed, const mpsi_undo *u) {
  for (int32_t c = 0; c < u->columns; c++)
    memcpy(u->column[c], saved(u, c, p->count), (size_t)p->count * sizeof(double));
  memcpy(b->boundary, u->boundary_room.item, (size_t)b->count * sizeof *b->boundary);
  copy_sums(b, u, true);
  restore_impulses(contacts, u, 0);
  restore_impulses(&prescribed->constraints, u, 1);
  if (b->dashpot_count > 0)
    memcpy(b->dashpot, u->dashpot_room.item, (size_t)b->dashpot_count * sizeof *b->dashpot);
  for (int64_t c = 0; c < grid->cell_count; c++) { /* no particle has moved */
    grid->cells[c].left = grid->cells[c].gone = grid->cells[c].lost = false;
    grid->cells[c].bad = -1;
  }
}
