/* owners.c - owners of the blocks of cells, by Hilbert's curve (domain/curve.h), and migration of
 * particles to the ranks of their blocks. The curve is cut again when a rank has more particles
 * than any had after the last cut. Results do not depend on the partition.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "domain/curve.h"
#include "core/base/order.h"
#include "domain/migrate.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/particles/rooms.h"
#include "mpm/ranks/partition.h"

#include <stdlib.h>
#include <string.h>

#define GROWTH 1.02 /* factor of the largest number of particles from which on a new cut pays */
#ifdef NDEBUG
#define COUNT_IDS false
#else
#define COUNT_IDS true /* checks each time that no particle is lost or doubled */
#endif

/* ---- the curve ------------------------------------------------------------------------------- */

static int64_t key_of(const mpsi_grid *grid, mpsi_partition *partition, const int32_t *at) {
  return mpsi_mpm_curve_key(grid->dim, &partition->orientation, at);
}

int32_t mpsi_mpm_block_owner(const mpsi_grid *grid, mpsi_partition *partition, const int32_t *at) {
  return mpsi_curve_owner(mps_domain_size(partition->domain), partition->first,
                          key_of(grid, partition, at));
}

typedef struct weighed {
  int64_t key, weight;
} weighed;

/* Orientation of the curve over the blocks, all of which are here; false: memory refused. */
static bool place_curve(mps_context *context, const mpsi_grid *grid, mpsi_partition *partition,
                        int32_t ranks) {
  const int64_t blocks = grid->cell_count;
  mpsi_placed *list = mpsi_alloc(context, blocks, sizeof *list);
  for (int64_t b = 0; list && b < blocks; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    list[b].particles = cells->end - cells->begin;
    memcpy(list[b].at, cells->at, sizeof list[b].at);
  }
  const bool good = list && mpsi_mpm_choose_orientation(context, grid->dim, ranks, blocks, list,
                                                        &partition->orientation);
  mpsi_free(context, list);
  return good;
}

mps_status mpsi_mpm_partition_cut(mps_context *context, const mpsi_grid *grid,
                                  mpsi_partition *partition, const char *function, bool whole) {
  const int32_t ranks = mps_domain_size(partition->domain);
  const int64_t all = grid->cell_count,
                blocks = whole && mps_domain_rank(partition->domain) > 0 ? 0 : all;
  const bool placed = !whole || place_curve(context, grid, partition, ranks);
  weighed *list = mpsi_alloc(context, blocks, sizeof *list);
  int64_t *key = mpsi_alloc(context, 2 * blocks, sizeof *key);
  if (!partition->first)
    partition->first = mpsi_alloc(context, ranks + 1, sizeof *partition->first);
  mps_status status = MPS_OK;
  if (!placed || !list || !key || !partition->first)
    status = mpsi_fail_memory(context, function, (size_t)(blocks + ranks) * sizeof *list);
  status = mpsi_domain_agree(partition->domain, function, status);
  for (int64_t b = 0; status == MPS_OK && b < blocks; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    list[b] = (weighed){key_of(grid, partition, cells->at), cells->end - cells->begin};
  }
  if (status == MPS_OK) {
    qsort(list, (size_t)blocks, sizeof *list, mpsi_ascending);
    for (int64_t b = 0; b < blocks; b++) key[b] = list[b].key, key[blocks + b] = list[b].weight;
    status =
        mpsi_curve_cut(partition->domain, function, blocks, key, key + blocks, partition->first);
  }
  MPSI_FREE(context, list, key);
  return status;
}

/* ---- migration ------------------------------------------------------------------------------- */

/* Particles that leave this rank, by present index, and all columns of the set. */
typedef struct departure {
  const mpsi_rank_part *part;
  uint8_t *gone;
  int64_t *row;
  int32_t *to;
  void **column;
  int64_t count;
  int32_t columns;
} departure;

static mps_status list_columns(departure *d) {
  mps_particles *set = d->part->p->set;
  mps_particles_field_info info;
  mps_status status = MPS_OK;
  d->columns = 0;
  for (int32_t f = 0; f < mps_particles_field_count(set) && status == MPS_OK; f++) {
    status = mps_particles_get_field_info(set, f, &info);
    for (int32_t c = 0; c < info.components && status == MPS_OK; c++) {
      void *column = info.dtype.code == 0 ? (void *)mpsi_particles_integers(set, info.name)
                                          : (void *)mpsi_particles_column(set, info.name, c);
      if (d->column) d->column[d->columns] = column;
      d->columns++;
    }
  }
  return status;
}

static mps_status list_leaving(departure *d, const char *function) {
  const mpsi_rank_part *part = d->part;
  const int32_t rank = mps_domain_rank(part->partition->domain);
  MPSI_TRY(list_columns(d));
  const int64_t count = part->p->count;
  d->column = mpsi_alloc(part->context, d->columns, sizeof *d->column);
  d->gone = mpsi_alloc(part->context, count, 1);
  d->row = mpsi_alloc(part->context, count, sizeof *d->row);
  d->to = mpsi_alloc(part->context, count, sizeof *d->to);
  if (!d->column || !d->gone || !d->row || !d->to)
    return mpsi_fail_memory(part->context, function, (size_t)count * 13);
  memset(d->gone, 0, (size_t)count);
  for (int64_t b = 0; b < part->grid->cell_count; b++) {
    const mpsi_cell_block *cells = &part->grid->cells[b];
    const int32_t owner = mpsi_mpm_block_owner(part->grid, part->partition, cells->at);
    for (int64_t k = cells->begin; owner != rank && k < cells->end; k++) {
      d->gone[k] = 1;
      d->row[d->count] = k;
      d->to[d->count++] = owner;
    }
  }
  return list_columns(d);
}

/* Stores received particles. All that can fail on any rank comes before anything has changed. */
static mps_status store_received(departure *d, const char *function, const mpsi_mailbox *box,
                                 int64_t arriving) {
  const mpsi_rank_part *part = d->part;
  const int64_t count = part->p->count - d->count + arriving;
  mps_status status = MPS_OK;
  if (count > MPSI_MPM_MOST_PARTICLES)
    status = mpsi_fail(part->context, function, MPS_ERROR_ARGUMENT,
                       "%lld particles would lie on one rank, which has at most %d",
                       (long long)count, MPSI_MPM_MOST_PARTICLES);
  if (status == MPS_OK &&
      !mpsi_mpm_make_room(part->context, part->grid, part->p, part->rooms, count))
    status =
        mpsi_fail_memory(part->context, function, (size_t)count * 2 * sizeof *part->grid->radix);
  if (status == MPS_OK) status = mpsi_particles_hold_room(part->p->set, function, count);
  mpsi_mpm_bind(part->grid, part->p, part->water); /* columns may have moved */
  MPSI_TRY(mpsi_domain_agree(part->partition->domain, function, status));
  mpsi_particles_make_way(part->p->set, d->gone);
  (void)list_columns(d);
  mpsi_migrate_unpack(box, d->columns, d->column, mps_particles_count(part->p->set));
  mpsi_particles_admit(part->p->set, arriving);
  mpsi_mpm_bind(part->grid, part->p, part->water);
  return MPS_OK;
}

static const int64_t *ids_of(const mpsi_rank_part *part) {
  return mpsi_particles_integers(part->p->set, "id");
}

static mps_status send(departure *d, const char *function, mps_status status, bool *moved) {
  const mpsi_rank_part *part = d->part;
  mps_domain *domain = part->partition->domain;
  mpsi_mailbox box = {.context = part->context};
  mpsi_census before;
  int64_t arriving = 0;
  if (status == MPS_OK) status = list_leaving(d, function);
  status = mpsi_domain_agree(domain, function, status);
  if (COUNT_IDS && status == MPS_OK)
    status = mpsi_census_take(domain, function, part->p->count, ids_of(part), &before);
  if (status != MPS_OK) return status;
  const mpsi_leaving leaving = {.count = d->count,
                                .row = d->row,
                                .to = d->to,
                                .columns = d->columns,
                                .column = (const void *const *)d->column};
  status = mpsi_migrate(domain, function, &leaving, &box, &arriving);
  if (status == MPS_OK) status = store_received(d, function, &box, arriving);
  if (COUNT_IDS && status == MPS_OK)
    status = mpsi_census_check(domain, function, part->p->count, ids_of(part), &before);
  *moved = status == MPS_OK && (d->count > 0 || arriving > 0);
  mpsi_domain_free_mail(&box);
  return status;
}

/* Cuts the curve again where a rank has more particles than any had after the last cut. */
static mps_status rebalance(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                            mpsi_partition *partition, const char *function, mps_status status) {
  double most = (double)p->count;
  status = mpsi_domain_agree_max(partition->domain, function, status, 1, &most);
  if (status != MPS_OK || (partition->heaviest > 0.0 && most <= GROWTH * partition->heaviest))
    return status;
  partition->heaviest = 0.0;
  return mpsi_mpm_partition_cut(context, grid, partition, function, false);
}

mps_status mpsi_mpm_partition_migrate(const mpsi_rank_part *part, const char *function,
                                      mps_status status, bool *moved) {
  mpsi_partition *partition = part->partition;
  departure d = {.part = part};
  status = rebalance(part->context, part->grid, part->p, part->partition, function, status);
  if (status == MPS_OK) status = send(&d, function, status, moved);
  if (status == MPS_OK && partition->heaviest == 0.0) {
    partition->heaviest = (double)part->p->count;
    status = mpsi_domain_max(partition->domain, function, 1, &partition->heaviest);
  }
  MPSI_FREE(part->context, d.column, d.gone, d.row, d.to);
  return status;
}

/* ---- particles that the caller adds ---------------------------------------------------------- */

static bool is_own(const mpsi_grid *grid, const mpsi_columns *p, mpsi_partition *partition,
                   int64_t k) {
  int32_t block[3] = {0};
  for (int c = 0; c < grid->dim; c++)
    block[c] =
        (int32_t)mpsi_block_of((int64_t)mpsi_base(grid->spline, mpsi_grid_at(grid, c, p->x[c][k])));
  return mpsi_mpm_block_owner(grid, partition, block) == mps_domain_rank(partition->domain);
}

mps_status mpsi_mpm_keep_own_inserted(const mpsi_rank_part *part, const char *function,
                                      mps_status status, int64_t first) {
  mpsi_columns *p = part->p;
  uint8_t *gone = NULL;
  if (status == MPS_OK && !(gone = mpsi_alloc(part->context, p->count, 1)))
    status = mpsi_fail_memory(part->context, function, (size_t)p->count);
  status = mpsi_domain_agree(part->partition->domain, function, status);
  if (status == MPS_OK) {
    memset(gone, 0, (size_t)first);
    for (int64_t k = first; k < p->count; k++) gone[k] = !is_own(part->grid, p, part->partition, k);
    mpsi_particles_make_way(p->set, gone);
    mpsi_mpm_bind(part->grid, p, part->water);
  }
  mpsi_free(part->context, gone);
  return status;
}
