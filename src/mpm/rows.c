/* rows.c - in which order the rows of all ranks make the whole (share.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include <string.h>

/* Rows that no block has are behind the others: particles that the caller has added. */
int64_t mpsi_mpm_share_runs(const void *self, mpsi_row_run *out) {
  const mps_mpm *mpm = self;
  int64_t count = 0, rows = 0;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[b];
    if (cells->ghost) continue;
    if (out) {
      out[count] = (mpsi_row_run){.rows = cells->end - cells->begin};
      memcpy(out[count].at, cells->at, sizeof cells->at);
    }
    rows += cells->end - cells->begin;
    count++;
  }
  if (out) out[count] = (mpsi_row_run){.at = {0, 0, INT32_MAX}, .rows = mpm->p.count - rows};
  return count + 1;
}

void mpsi_mpm_share_thin_out(mps_mpm *mpm, const uint8_t *gone) {
  int64_t out = 0;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    mpsi_cell_block *cells = &mpm->grid.cells[b];
    const int64_t begin = cells->begin - out;
    for (int64_t k = cells->begin; k < cells->end; k++) out += gone[k] != 0;
    cells->begin = begin;
    cells->end -= out;
  }
}
