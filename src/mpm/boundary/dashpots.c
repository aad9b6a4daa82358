/* dashpots.c - dashpots of absorbing sides (absorb.c) on several ranks: sums of coefficients of the
 * ranks' own blocks are exchanged as tiles are, and dashpots are sent to ranks that newly have a
 * block of nodes when the lists are rebuilt, after a sort. Sums of frictional sides are exchanged
 * likewise.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kinds.h"
#include "core/base/order.h"
#include "mpm/ranks/messages.h"

#include <stdlib.h>
#include <string.h>

/* ---- coefficients ---------------------------------------------------------------------------- */

static int64_t plane_doubles(const mpsi_grid *grid) {
  return 2 * (grid->dim == 3 ? MPSI_DASH_PLANE : MPSI_TILE_SIDE);
}

/* Sums at the sides that absorb, or at those with friction. */
typedef struct side_sums {
  const mpsi_boundary_setup *setup;
  bool friction;
} side_sums;

/* The planes of all sides. */
static void pack(void *data, int64_t b, int32_t worker, double *message) {
  const side_sums *sums = data;
  const mpsi_boundary_setup *setup = sums->setup;
  const mpsi_grid *grid = setup->grid;
  const size_t bytes = (size_t)plane_doubles(grid) * sizeof *message;
  for (int32_t side = 0; side < MPSI_SIDES; side++, message += plane_doubles(grid)) {
    double tile[MPSI_DASH_PLANE][2];
    memset(message, 0, bytes);
    const mpsi_boundary_kind *kind = mpsi_kind_of(&setup->boundaries->boundary[side]);
    if ((sums->friction ? kind->friction : kind->absorbs) &&
        mpsi_mpm_sum_at_side(grid, setup->p, setup->boundaries, &grid->cells[b], side, tile))
      memcpy(message, tile, bytes);
  }
}

static mps_status exchange_sums(const mpsi_boundary_setup *setup, const char *function,
                                mps_status status, bool friction) {
  mpsi_partition *partition = setup->partition;
  side_sums sums = {setup, friction};
  const int64_t doubles = MPSI_SIDES * plane_doubles(setup->grid);
  if (status == MPS_OK)
    status = mpsi_mpm_reserve_messages(setup->context, partition, function, doubles);
  status = mpsi_domain_agree(partition->domain, function, status);
  if (status == MPS_OK)
    status = mpsi_mpm_exchange_messages(setup->context, partition, function, doubles, pack, &sums);
  return status;
}

mps_status mpsi_mpm_exchange_dashpots(const mpsi_boundary_setup *setup, const char *function,
                                      mps_status status) {
  status = exchange_sums(setup, function, status, false);
  if (status == MPS_OK)
    mpsi_mpm_find_dashpots(setup->grid, setup->p, setup->boundaries, setup->partition);
  return status;
}

mps_status mpsi_mpm_find_borne(const mpsi_boundary_setup *setup, const char *function,
                               mps_status status) {
  if (!setup->water || !mpsi_mpm_has_friction(setup->boundaries)) return status;
  if (setup->partition) status = exchange_sums(setup, function, status, true);
  if (status == MPS_OK)
    mpsi_mpm_sum_borne(setup->grid, setup->p, setup->boundaries, setup->partition);
  return status;
}

/* ---- lists ----------------------------------------------------------------------------------- */

/* Head of a record of the dashpots of a block of nodes; those of its plane follow. */
typedef struct place {
  int32_t at[3], boundary;
} place;

typedef struct sending {
  int64_t held;
  int32_t rank;
} sending;

static int64_t plane_nodes(const mpsi_grid *grid) { return grid->block_nodes / MPSI_SIDE; }

static int64_t record_bytes(const mpsi_grid *grid) {
  return (int64_t)sizeof(place) + plane_nodes(grid) * (int64_t)sizeof(mpsi_dashpot);
}

static int by_rank(const void *left, const void *right) {
  const sending *a = left, *b = right;
  if (a->rank != b->rank) return a->rank < b->rank ? -1 : 1;
  return (a->held > b->held) - (a->held < b->held);
}

/* Receivers of dashpots: the other ranks that may have blocks of cells over these nodes. */
static int64_t list_sendings(const mpsi_grid *grid, mpsi_partition *partition, const mpsi_held *old,
                             int64_t old_count, sending *out) {
  const int32_t rank = mps_domain_rank(partition->domain);
  int64_t count = 0;
  for (int64_t t = 0; t < old_count; t++) {
    if (old[t].dashpot < 0 || !old[t].counted) continue;
    const int64_t first = count;
    for (int q = 0; q < 1 << grid->dim; q++) {
      const int32_t at[3] = {old[t].at[0] - (q & 1), old[t].at[1] - (q >> 1 & 1),
                             old[t].at[2] - (q >> 2)};
      const int32_t owner = mpsi_mpm_block_owner(grid, partition, at);
      int64_t k = first;
      while (k < count && out[k].rank != owner) k++;
      if (owner != rank && k == count) out[count++] = (sending){t, owner};
    }
  }
  qsort(out, (size_t)count, sizeof *out, by_rank);
  return count;
}

static void write_record(const mpsi_grid *grid, const mpsi_held *held, const mpsi_dashpot *dashpot,
                         char *to) {
  const place at = {{held->at[0], held->at[1], held->at[2]}, held->boundary};
  memcpy(to, &at, sizeof at);
  to += sizeof at;
  memcpy(to, &dashpot[held->dashpot], (size_t)plane_nodes(grid) * sizeof *dashpot);
}

static void read_record(const mpsi_grid *grid, const mpsi_boundaries *b, const char *from) {
  place at;
  memcpy(&at, from, sizeof at);
  from += sizeof at;
  mpsi_held key = {.boundary = at.boundary};
  memcpy(key.at, at.at, sizeof key.at);
  int64_t low;
  MPSI_BISECT(low, b->held_count, middle, mpsi_mpm_compare_held(&b->held[middle], &key) < 0);
  if (low == b->held_count || mpsi_mpm_compare_held(&b->held[low], &key) != 0) return;
  memcpy(&b->dashpot[b->held[low].dashpot], from, (size_t)plane_nodes(grid) * sizeof *b->dashpot);
}

typedef struct records {
  sending *sending;
  char *mail;
  mps_domain_message *message;
  mpsi_mailbox box;
} records;

static mps_status write_records(const mpsi_boundary_setup *setup, const char *function,
                                const mpsi_held_list *old, records *r, int32_t *messages) {
  mps_context *context = setup->context;
  mpsi_partition *partition = setup->partition;
  const mpsi_grid *grid = setup->grid;
  const int64_t record = record_bytes(grid);
  r->sending = mpsi_alloc(context, old->count << grid->dim, sizeof *r->sending);
  r->message = mpsi_alloc(context, mps_domain_size(partition->domain), sizeof *r->message);
  const int64_t count = r->sending && r->message
                            ? list_sendings(grid, partition, old->held, old->count, r->sending)
                            : 0;
  r->mail = mpsi_alloc(context, count, (size_t)record);
  if (!r->sending || !r->message || !r->mail)
    return mpsi_fail_memory(context, function, (size_t)(count * record));
  for (int64_t k = 0; k < count; k++) {
    char *to = r->mail + k * record;
    write_record(grid, &old->held[r->sending[k].held], old->dashpot, to);
    if (k == 0 || r->sending[k].rank != r->sending[k - 1].rank)
      r->message[(*messages)++] = (mps_domain_message){.rank = r->sending[k].rank, .data = to};
    r->message[*messages - 1].bytes += record;
  }
  return MPS_OK;
}

mps_status mpsi_mpm_send_dashpots(const mpsi_boundary_setup *setup, const char *function,
                                  const mpsi_held_list *old) {
  mps_context *context = setup->context;
  mps_domain *domain = setup->partition->domain;
  records r = {.box.context = context};
  int32_t messages = 0;
  mpsi_mpm_carry_dashpots(setup->grid, setup->boundaries, old);
  mps_status status = write_records(setup, function, old, &r, &messages);
  status = mpsi_domain_agree(domain, function, status);
  if (status == MPS_OK)
    status = mpsi_domain_exchange(domain, function, messages, r.message, &r.box);
  for (int32_t m = 0; status == MPS_OK && m < r.box.count; m++)
    for (int64_t at = 0; at < r.box.mail[m].bytes; at += record_bytes(setup->grid))
      read_record(setup->grid, setup->boundaries, (const char *)r.box.mail[m].data + at);
  mpsi_domain_free_mail(&r.box);
  MPSI_FREE(context, r.sending, r.mail, r.message);
  return status;
}

/* ---- files ----------------------------------------------------------------------------------- */

/* Order of rows: position of the block, then the dashpots of its plane. */
static int by_place(const void *left, const void *right) {
  mpsi_held a = {0}, b = {0};
  place p, q;
  memcpy(&p, left, sizeof p);
  memcpy(&q, right, sizeof q);
  memcpy(a.at, p.at, sizeof a.at), a.boundary = p.boundary;
  memcpy(b.at, q.at, sizeof b.at), b.boundary = q.boundary;
  return mpsi_mpm_compare_held(&a, &b);
}

static int64_t fill_rows(const mpsi_boundaries *b, int64_t row, char *to) {
  int64_t rows = 0;
  for (int64_t t = 0; t < b->held_count; t++) {
    const mpsi_held *held = &b->held[t];
    if (held->dashpot < 0 || !held->counted) continue;
    if (to) {
      const place at = {{held->at[0], held->at[1], held->at[2]}, held->boundary};
      memcpy(to + rows * row, &at, sizeof at);
      memcpy(to + rows * row + sizeof at, b->dashpot + held->dashpot, (size_t)row - sizeof at);
    }
    rows++;
  }
  return rows;
}

mps_status mpsi_mpm_gather_dashpots(mps_context *context, const mpsi_grid *grid,
                                    const mpsi_boundaries *boundaries, mpsi_partition *partition,
                                    const char *function, mpsi_value *dashpots) {
  mps_domain *domain = partition->domain;
  const int64_t plane = plane_nodes(grid), each = plane * MPSI_DASH;
  const int64_t row = (int64_t)sizeof(place) + each * (int64_t)sizeof(double);
  mpsi_value wide = {.type = MPSI_STATE_F64, .columns = (int32_t)(row / 8)};
  if (!mpsi_mpm_absorbs(boundaries)) return MPS_OK;
  const int64_t rows = fill_rows(boundaries, row, NULL);
  mps_status status = MPS_OK;
  if (!mpsi_value_reserve(context, &wide, wide.type, rows, wide.columns))
    status = mpsi_fail_memory(context, function, (size_t)(rows * row));
  status = mpsi_domain_agree(domain, function, status);
  if (status == MPS_OK) {
    fill_rows(boundaries, row, wide.data);
    status = mpsi_domain_gather_rows(domain, function, rows, &wide);
  }
  if (status == MPS_OK && mps_domain_rank(domain) == 0) {
    qsort(wide.data, (size_t)wide.rows, (size_t)row, by_place);
    if (!mpsi_value_reserve(context, dashpots, MPSI_STATE_F64, wide.rows * plane, MPSI_DASH))
      status = mpsi_fail_memory(context, function, (size_t)(wide.rows * row));
    if (status == MPS_OK) dashpots->rows = wide.rows * plane;
    for (int64_t k = 0; status == MPS_OK && k < wide.rows; k++)
      memcpy((double *)dashpots->data + k * each, (char *)wide.data + k * row + sizeof(place),
             (size_t)each * sizeof(double));
  }
  mpsi_free(context, wide.data);
  return mpsi_domain_agree(domain, function, status);
}

/* A block of nodes under a block of cells of the file. */
typedef struct under {
  int32_t at[3];
  bool own; /* some of these blocks of cells are this rank's */
} under;

static int by_block(const void *left, const void *right) {
  const under *a = left, *b = right;
  for (int c = 2; c >= 0; c--)
    if (a->at[c] != b->at[c]) return a->at[c] < b->at[c] ? -1 : 1;
  return 0;
}

static int64_t list_under(const mpsi_grid *grid, mpsi_partition *partition,
                          const mpsi_value *blocks, under *out) {
  const mpsi_block *block = blocks->data;
  const int32_t rank = mps_domain_rank(partition->domain);
  int64_t count = 0, kept = 0;
  for (int64_t b = 0; b < blocks->rows; b++) {
    int32_t at[3];
    for (int c = 0; c < 3; c++) at[c] = (int32_t)block[b][MPSI_BLOCK_AT + c];
    const bool own = mpsi_mpm_block_owner(grid, partition, at) == rank;
    for (int q = 0; q < 1 << grid->dim; q++)
      out[count++] = (under){{at[0] + (q & 1), at[1] + (q >> 1 & 1), at[2] + (q >> 2)}, own};
  }
  qsort(out, (size_t)count, sizeof *out, by_block);
  for (int64_t k = 0; k < count; k++) {
    if (kept > 0 && by_block(&out[kept - 1], &out[k]) == 0)
      out[kept - 1].own = out[kept - 1].own || out[k].own;
    else
      out[kept++] = out[k];
  }
  return kept;
}

mps_status mpsi_mpm_take_dashpots(mps_context *context, const mpsi_grid *grid,
                                  const mpsi_boundaries *boundaries, mpsi_partition *partition,
                                  const char *function, const mpsi_value *blocks,
                                  mpsi_value *dashpots) {
  const int64_t plane = plane_nodes(grid);
  const size_t bytes = (size_t)plane * sizeof(mpsi_dashpot);
  mpsi_dashpot *dashpot = dashpots->data;
  int64_t from = 0, to = 0;
  if (!mpsi_mpm_absorbs(boundaries)) return MPS_OK;
  under *nodes = mpsi_alloc(context, blocks->rows << grid->dim, sizeof *nodes);
  if (!nodes) return mpsi_fail_memory(context, function, (size_t)(blocks->rows << grid->dim) * 16);
  const int64_t count = list_under(grid, partition, blocks, nodes);
  for (int64_t g = 0; g < count; g++)
    for (int32_t side = 0; side < MPSI_SIDES; side++) {
      const mpsi_boundary *boundary = &boundaries->boundary[side];
      mpsi_range r;
      if (!mpsi_kind_of(boundary)->absorbs ||
          !mpsi_find_range(grid->dim, nodes[g].at, boundary, &r))
        continue;
      if (nodes[g].own && from + plane <= dashpots->rows) {
        memmove(dashpot + to, dashpot + from, bytes);
        to += plane;
      }
      from += plane;
    }
  mpsi_free(context, nodes);
  if (from != dashpots->rows)
    return mpsi_fail(context, function, MPS_ERROR_FORMAT,
                     "there are %lld dashpots of absorbing walls, must be %lld",
                     (long long)dashpots->rows, (long long)from);
  dashpots->rows = to;
  return MPS_OK;
}
