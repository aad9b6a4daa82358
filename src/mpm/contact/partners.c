/* partners.c - see partners.h. Ranks reduce the counts of failures and of constraints and a matrix
 * of bits, of which each rank sets two rows: ranks whose constraints are linked to its own by
 * common nodes; and ranks whose constraints change nodes under its blocks that have no constraints
 * of their own there (readers). With more than MPSI_MOST_PARTNERS ranks, or with free bodies, there
 * is one row, of the ranks with constraints. SPDX-License-Identifier: BSD-3-Clause */
#include "partners.h"

#include "core/base/room_array.h"
#include "mpm/grid/blocks.h"
#include "mpm/ranks/partition.h"
#include "pairs.h"

#include "domain/domain_internal.h"

#include <string.h>

enum { FAILED, CONSTRAINTS, HEAD };

static int32_t words_of(const mps_domain *domain) { return (mps_domain_size(domain) + 63) / 64; }

/* Whether some body moves freely: it couples the constraints of all blocks. */
static bool has_free_bodies(const mpsi_contacts *contacts) {
  bool found = false;
  for (int32_t b = 0; b < contacts->bodies; b++)
    found = found || contacts->body[b]->def.motion != MPS_BODY_MOTION_DRIVEN;
  return found;
}

/* Number of rows of the matrix: two for each rank, or one. */
static int32_t rows_of(const mpsi_contacts *contacts, const mps_domain *domain) {
  const int32_t ranks = mps_domain_size(domain);
  const bool lists = contacts->bodies == 0; /* whose solution is local, but reaches far */
  return lists || has_free_bodies(contacts) || ranks > MPSI_MOST_PARTNERS ? 1 : 2 * ranks;
}

static bool has_bit(const uint64_t *row, int32_t bit) { return row[bit / 64] >> (bit % 64) & 1; }

static void set_bit(uint64_t *row, int32_t bit) { row[bit / 64] |= UINT64_C(1) << (bit % 64); }

mps_status mpsi_mpm_begin_partners(mpsi_contact_partners *m, mps_domain *domain,
                                   const char *function) {
  mps_context *context = mpsi_domain_context(domain);
  const int64_t words = words_of(domain), ranks = mps_domain_size(domain);
  const int64_t rows = ranks > MPSI_MOST_PARTNERS ? 1 : 2 * ranks;
  const bool good = MPSI_ENSURE(context, m, words, HEAD + rows * words) &&
                    MPSI_ENSURE(context, m, own, 2 * words);
  return good ? MPS_OK
              : mpsi_fail_memory(context, function,
                                 (size_t)(HEAD + (rows + 2) * words) * sizeof *m->words);
}

void mpsi_mpm_free_partners(mpsi_contact_partners *m, mps_context *context) {
  MPSI_FREE(context, m->words_room.item, m->own_room.item);
}

bool mpsi_mpm_is_partner(const mpsi_contact_partners *m, int32_t rank) {
  return has_bit(m->own, rank);
}

/* ---- this rank's blocks ---------------------------------------------------------------------- */

void mpsi_mpm_mark_contact_blocks(const mpsi_contacts *contacts, mpsi_grid *grid) {
  const mpsi_impulses *all = &contacts->impulses;
  for (int64_t b = 0; b < grid->cell_count; b++) {
    mpsi_cell_block *cells = &grid->cells[b];
    cells->in_contact = cells->sent = false;
    for (int32_t q = 0; q < cells->pairs && all->areas && !cells->ghost; q++)
      if (mpsi_has_areas(contacts->handle[contacts->cell_pair[cells->first_pair + q].body],
                         contacts->wet))
        cells->in_contact = true;
  }
  for (int64_t k = 0; k < all->block_count; k++) grid->cells[all->block[k].cells].in_contact = true;
}

/* Extends the marks `sent` to blocks with constraints that share a block of nodes with a marked
 * one; returns whether any was new. */
static bool spread(const mpsi_grid *grid) {
  bool changed = false;
  for (int64_t g = 0; g < grid->node_count; g++) {
    const mpsi_node_block *nodes = &grid->nodes[g];
    bool sent = false;
    for (int q = 0; q < 1 << grid->dim; q++)
      sent = sent || (nodes->from[q] >= 0 && grid->cells[nodes->from[q]].sent);
    for (int q = 0; q < 1 << grid->dim && sent; q++) {
      mpsi_cell_block *cells = nodes->from[q] >= 0 ? &grid->cells[nodes->from[q]] : NULL;
      if (!cells || !cells->in_contact || cells->ghost || cells->sent) continue;
      cells->sent = changed = true;
    }
  }
  return changed;
}

/* Marks own blocks with constraints beside ghosts as sent; sets the ranks of ghosts with
 * constraints in `linked` where an own block has constraints too, else in `readers`. */
static void find_links(const mpsi_grid *grid, const int32_t *ghost_rank, uint64_t *linked,
                       uint64_t *readers) {
  for (int64_t g = 0; g < grid->node_count; g++) {
    const mpsi_node_block *nodes = &grid->nodes[g];
    mpsi_cell_block *over[MPSI_CORNERS];
    int count = 0;
    bool own = false, in_contact = false, ghost = false;
    for (int q = 0; q < 1 << grid->dim; q++)
      if (nodes->from[q] >= 0) over[count++] = &grid->cells[nodes->from[q]];
    for (int i = 0; i < count; i++) {
      own = own || !over[i]->ghost;
      ghost = ghost || over[i]->ghost;
      in_contact = in_contact || (over[i]->in_contact && !over[i]->ghost);
    }
    for (int i = 0; i < count && own && ghost; i++) {
      if (!over[i]->in_contact) continue;
      if (!over[i]->ghost)
        over[i]->sent = true;
      else
        set_bit(in_contact ? linked : readers, ghost_rank[over[i]->parcel]);
    }
  }
}

/* One row: marks all blocks with constraints as sent to all ranks that have any. */
static void send_rows(const mpsi_grid *grid, int32_t rank, uint64_t *row) {
  for (int64_t b = 0; b < grid->cell_count; b++) {
    mpsi_cell_block *cells = &grid->cells[b];
    if (!cells->in_contact) continue;
    cells->sent = !cells->ghost;
    set_bit(row, rank); /* ghosts are beside own blocks */
  }
}

/* ---- all ranks ------------------------------------------------------------------------------- */

/* Partners of this rank: the ranks that rows of linked ranks lead to, and the readers of any of
 * these. */
static void find_reachable(mpsi_contact_partners *m, int32_t ranks, const uint64_t *linked,
                           const uint64_t *readers) {
  const int32_t words = (ranks + 63) / 64;
  uint64_t *own = m->own, *all = own + words;
  bool changed = true;
  while (changed) {
    changed = false;
    for (int32_t r = 0; r < ranks; r++)
      for (int32_t w = 0; has_bit(own, r) && w < words; w++) {
        const uint64_t more = linked[(int64_t)r * words + w] & ~own[w];
        own[w] |= more;
        changed = changed || more != 0;
      }
  }
  memcpy(all, own, (size_t)words * sizeof *own);
  for (int32_t r = 0; r < ranks; r++)
    for (int32_t w = 0; w < words; w++)
      if (readers[(int64_t)r * words + w] & own[w]) set_bit(all, r);
  memcpy(own, all, (size_t)words * sizeof *own);
}

static void read_rows(mpsi_contact_partners *m, const mps_domain *domain, const uint64_t *rows,
                      int32_t count) {
  const int32_t words = words_of(domain);
  int64_t bits = 0;
  for (int64_t w = 0; w < (int64_t)count * words; w++) bits += __builtin_popcountll(rows[w]);
  m->any = count > 1 ? bits > 0 : bits > 1;
  memset(m->own, 0, (size_t)words * sizeof *m->own);
  set_bit(m->own, mps_domain_rank(domain));
  if (count > 1)
    find_reachable(m, mps_domain_size(domain), rows, rows + (int64_t)(count / 2) * words);
  else
    for (int32_t w = 0; w < words; w++) m->own[w] |= rows[w];
}

mps_status mpsi_mpm_find_partners(mpsi_contacts *contacts, const mpsi_grid *grid,
                                  const mpsi_partition *partition, const char *function,
                                  mps_status status, int64_t *constraints) {
  mpsi_contact_partners *m = &contacts->partners;
  mps_domain *domain = partition->domain;
  const int32_t words = words_of(domain), rows = rows_of(contacts, domain);
  uint64_t *row = (uint64_t *)m->words + HEAD;
  memset(m->words, 0, (size_t)(HEAD + rows * words) * sizeof *m->words);
  m->words[FAILED] = status != MPS_OK;
  m->words[CONSTRAINTS] = contacts->impulses.contact_count;
  if (status == MPS_OK && rows == 1)
    send_rows(grid, mps_domain_rank(domain), row);
  else if (status == MPS_OK) {
    uint64_t *linked = row + (int64_t)mps_domain_rank(domain) * words;
    find_links(grid, partition->ghost_rank, linked, linked + (int64_t)(rows / 2) * words);
    while (spread(grid)) {
    }
  }
  MPSI_TRY(mpsi_domain_sum(domain, function, HEAD + rows * words, m->words));
  if (m->words[FAILED] > 0) return mpsi_domain_agree(domain, function, status);
  *constraints = m->words[CONSTRAINTS];
  read_rows(m, domain, row, rows);
  return MPS_OK;
}
