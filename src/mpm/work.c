/* work.c - shares the blocks of a solver out to the threads of its context.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#define SMALL_SET 2048  /* particles: below, sharing the work costs more than it gains */
#define UNIT_NODES 4096 /* at least in a unit of work on nodes, which take a few ns each */

typedef struct work {
  mps_mpm *mpm;
  mpsi_mpm_task task;
  const int32_t *list; /* of what to work on, NULL: 0, 1, ... */
  int64_t count, grain;
} work;

static void unit_of_work(void *data, int64_t unit, int32_t worker) {
  const work *w = data;
  const int64_t last = (unit + 1) * w->grain;
  for (int64_t k = unit * w->grain; k < last && k < w->count; k++)
    w->task(w->mpm, w->list ? w->list[k] : k, worker);
}

static void share(mps_mpm *mpm, const int32_t *list, int64_t count, int64_t least,
                  mpsi_mpm_task task) {
  const int64_t most = mpm->p.count < SMALL_SET ? 1 : 8 * (int64_t)mpm->grid.worker_count;
  const int64_t wanted = (count + least - 1) / least, units = wanted < most ? wanted : most;
  if (units == 0) return;
  work w = {mpm, task, list, count, (count + units - 1) / units};
  mpsi_parallel_for(mpm->context, units, unit_of_work, &w);
}

void mpsi_mpm_for_nodes(mps_mpm *mpm, mpsi_mpm_task task) {
  share(mpm, NULL, mpm->grid.node_count, UNIT_NODES / mpm->grid.block_nodes, task);
}

void mpsi_mpm_for_cells(mps_mpm *mpm, mpsi_mpm_task task) {
  share(mpm, NULL, mpm->grid.cell_count, 1, task);
}

void mpsi_mpm_for_colours(mps_mpm *mpm, mpsi_mpm_task task) {
  for (int c = 0; c < 1 << mpm->dim; c++)
    share(mpm, mpm->grid.coloured + mpm->grid.colour[c],
          mpm->grid.colour[c + 1] - mpm->grid.colour[c], 1, task);
}
