/* tiles.c - tiles on their way between ranks (share.h): the border is summed and sent, the interior
 * is summed meanwhile, and then what has come is added to the nodes.
 *
 * A parcel has two numbers, whether its forces are apart and whether they are split, and then the
 * part of the tile that is in use, and that of the forces where some tile of the step has them.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#include <string.h>

enum { HEAD = 2 }; /* doubles */

static int64_t parcel_doubles(const mpsi_share *share, bool apart) {
  return HEAD + (int64_t)share->most * (int64_t)(sizeof(mpsi_node) / sizeof(double)) * (1 + apart);
}

int64_t mpsi_share_parcel(const mps_mpm *mpm) {
  return parcel_doubles(mpm->share, true) * (int64_t)sizeof(double);
}

mps_status mpsi_share_ready(mps_mpm *mpm, const char *function, mps_status status) {
  mpsi_share *share = mpm->share;
  double apart = 0.0;
  for (int64_t k = 0; status == MPS_OK && k < share->borders; k++)
    if (mpm->grid.cells[share->border[k]].apart) apart = 1.0;
  status = mpsi_domain_settle_max(share->domain, function, status, 1, &apart);
  share->apart = apart > 0.0;
  share->item = (int32_t)(parcel_doubles(share, share->apart) * (int64_t)sizeof(double));
  return status;
}

/* ---- corners of cells with particles, where bodies are near -----------------------------------
 */

mps_status mpsi_share_reached(mps_mpm *mpm, const char *function, bool known) {
  mpsi_share *share = mpm->share;
  const int64_t words = (mpm->grid.tile_nodes + 63) / 64; /* less than a parcel has */
  uint64_t *out = (uint64_t *)share->out, *in = (uint64_t *)share->in;
  if (share->borders > 0) memset(out, 0, (size_t)(share->borders * words) * sizeof *out);
  for (int64_t k = 0; known && k < share->borders; k++)
    mpsi_mpm_list_reached(mpm, share->border[k], out + k * words);
  const int32_t item = (int32_t)(words * (int64_t)sizeof *out);
  mps_status status = mpsi_halo_begin_bytes(share->halo, function, item, out, in);
  if (status == MPS_OK) status = mpsi_halo_end_bytes(share->halo, function);
  for (int64_t b = 0; known && status == MPS_OK && b < mpm->grid.cell_count; b++)
    if (mpm->grid.cells[b].ghost)
      mpsi_mpm_take_reached(mpm, b, in + mpm->grid.cells[b].parcel * words);
  return status;
}

/* ---- packing --------------------------------------------------------------------------------- */

/* The part of a tile in use to or from a parcel, which it ends behind. */
static double *copy_tile(const mpsi_cell_block *cells, mpsi_node *tile, double *parcel, bool pack) {
  const size_t bytes = (size_t)(cells->high[0] - cells->low[0]) * sizeof *tile;
  for (int k = cells->low[2]; k < cells->high[2]; k++)
    for (int j = cells->low[1]; j < cells->high[1]; j++) {
      mpsi_node *row = tile + mpsi_tile_index(cells->low[0], j, k);
      memcpy(pack ? (void *)parcel : (void *)row, pack ? (void *)row : (void *)parcel, bytes);
      parcel += bytes / sizeof *parcel;
    }
  return parcel;
}

static void pack(void *data, int64_t k, int32_t number) {
  mps_mpm *mpm = data;
  mpsi_share *share = mpm->share;
  mpsi_worker *worker = &mpm->grid.workers[number];
  const mpsi_cell_block *cells = &mpm->grid.cells[share->border[k]];
  double *parcel = share->out + k * (share->item / (int64_t)sizeof *share->out);
  mpm->kernels->tile[mpm->def.geometry][mpm->def.spline - 2](mpm, share->border[k], number);
  parcel[0] = cells->apart;
  parcel[1] = cells->split;
  parcel = copy_tile(cells, worker->tile, parcel + HEAD, true);
  if (cells->apart) copy_tile(cells, worker->force, parcel, true);
}

mps_status mpsi_share_send(mps_mpm *mpm, const char *function) {
  mpsi_share *share = mpm->share;
  mpsi_parallel_for(mpm->context, share->borders, pack, mpm);
  share->lost = mpsi_halo_begin_bytes(share->halo, function, share->item, share->out, share->in);
  return share->lost;
}

void mpsi_share_receive(mps_mpm *mpm) {
  mpsi_share *share = mpm->share;
  if (share->lost == MPS_OK) share->lost = mpsi_halo_end_bytes(share->halo, "mps_mpm_step");
}

/* ---- to the nodes ---------------------------------------------------------------------------- */

void mpsi_share_scatter(mps_mpm *mpm, int64_t b, int32_t number) {
  mpsi_share *share = mpm->share;
  mpsi_cell_block *cells = &mpm->grid.cells[b];
  mpsi_worker *worker = &mpm->grid.workers[number];
  if (cells->parcel < 0) {
    mpm->kernels->p2g[mpm->def.geometry][mpm->def.spline - 2](mpm, b, number);
    return;
  }
  if (cells->ghost && share->lost != MPS_OK) return; /* the step has failed */
  double *parcel = (cells->ghost ? share->in : share->out) +
                   cells->parcel * (share->item / (int64_t)sizeof *share->out);
  cells->apart = parcel[0] != 0.0;
  cells->split = parcel[1] != 0.0;
  parcel = copy_tile(cells, worker->tile, parcel + HEAD, false);
  if (cells->apart) copy_tile(cells, worker->force, parcel, false);
  mpm->kernels->flush(mpm, b, number);
}
