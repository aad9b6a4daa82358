/* row_order.c - order of the rows of all ranks in the whole set (partition.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/grid/blocks.h"
#include "mpm/ranks/partition.h"

#include <string.h>

/* Rows of particles that the caller has added, which no block has: behind the others, by id. */
static int64_t list_added(const mpsi_columns *p, int64_t first, mpsi_row_run *out) {
  const int64_t *id = mpsi_particles_integers(p->set, "id");
  for (int64_t k = first; out && k < p->count; k++)
    out[k - first] = (mpsi_row_run){
        .at = {(int32_t)(id[k] & INT32_MAX), (int32_t)(id[k] >> 31), INT32_MAX}, .rows = 1};
  return p->count - first;
}

int64_t mpsi_mpm_list_rows(const mpsi_grid *grid, const mpsi_columns *p, mpsi_row_run *out) {
  int64_t count = 0, rows = 0;
  for (int64_t b = 0; b < grid->cell_count; b++) {
    const mpsi_cell_block *cells = &grid->cells[b];
    if (cells->ghost) continue;
    if (out) {
      out[count] = (mpsi_row_run){.rows = cells->end - cells->begin};
      memcpy(out[count].at, cells->at, sizeof cells->at);
    }
    rows += cells->end - cells->begin;
    count++;
  }
  return count + list_added(p, rows, out ? out + count : NULL);
}

void mpsi_mpm_close_gaps(mpsi_grid *grid, const uint8_t *gone) {
  int64_t out = 0;
  for (int64_t b = 0; b < grid->cell_count; b++) {
    mpsi_cell_block *cells = &grid->cells[b];
    const int64_t begin = cells->begin - out;
    for (int64_t k = cells->begin; k < cells->end; k++) out += gone[k] != 0;
    cells->begin = begin;
    cells->end -= out;
  }
}
