/* notices.c - see notices.h. SPDX-License-Identifier: BSD-3-Clause */
#include "notices.h"

#include "mpm/ranks/block_range.h"

#include <string.h>

static mps_status find_ranges(const mps_mpm *mpm, const char *function, mpsi_pore_notices *out) {
  const mpsi_grid *grid = &mpm->grid;
  mps_domain *domain = mpm->partition->domain;
  const int64_t ranks = mps_domain_size(domain);
  out->range = mpsi_alloc(mpm->context, MPSI_BLOCK_RANGE * ranks, sizeof *out->range);
  mps_status status = MPS_OK;
  if (!out->range)
    status = mpsi_fail_memory(mpm->context, function,
                              (size_t)(MPSI_BLOCK_RANGE * ranks) * sizeof *out->range);
  status = mpsi_domain_agree(domain, function, status);
  if (status != MPS_OK) return status;
  memset(out->range, 0, (size_t)(MPSI_BLOCK_RANGE * ranks) * sizeof *out->range);
  int64_t *mine = out->range + MPSI_BLOCK_RANGE * mps_domain_rank(domain);
  for (int64_t g = 0; g < grid->node_count; g++) {
    if (grid->nodes[g].foreign) continue;
    mpsi_block_range_add(mine, grid->nodes[g].at);
  }
  return mpsi_domain_sum(domain, function, (int32_t)(MPSI_BLOCK_RANGE * ranks), out->range);
}

static bool is_announced(const mps_mpm *mpm, const mpsi_pore_notices *n, int32_t rank, int64_t g) {
  return rank != mps_domain_rank(mpm->partition->domain) && !mpm->grid.nodes[g].foreign &&
         mpsi_mpm_counts_node_block(&mpm->grid, g) &&
         mpsi_block_range_near(n->range + MPSI_BLOCK_RANGE * rank, mpm->grid.nodes[g].at);
}

/* The notices for each rank, one list behind the other; returns the number of lists. */
static int32_t write_notices(const mps_mpm *mpm, mpsi_pore_notices *out) {
  const mpsi_grid *grid = &mpm->grid;
  int64_t notices = 0;
  int32_t messages = 0;
  for (int32_t r = 0; r < mps_domain_size(mpm->partition->domain); r++) {
    const int64_t first = notices;
    for (int64_t g = 0; g < grid->node_count; g++) {
      if (!is_announced(mpm, out, r, g)) continue;
      out->sent[notices].number = (int32_t)g;
      memcpy(out->sent[notices++].at, grid->nodes[g].at, sizeof grid->nodes[g].at);
    }
    if (notices > first)
      out->message[messages++] =
          (mps_domain_message){.rank = r,
                               .bytes = (notices - first) * (int64_t)sizeof *out->sent,
                               .data = out->sent + first};
  }
  return messages;
}

static mps_status announce(const mps_mpm *mpm, const char *function, mpsi_pore_notices *out) {
  mps_domain *domain = mpm->partition->domain;
  const int32_t ranks = mps_domain_size(domain);
  int64_t notices = 0;
  int32_t messages = 0;
  for (int32_t r = 0; r < ranks; r++)
    for (int64_t g = 0; g < mpm->grid.node_count; g++) notices += is_announced(mpm, out, r, g);
  out->sent = mpsi_alloc(mpm->context, notices, sizeof *out->sent);
  out->message = mpsi_alloc(mpm->context, ranks, sizeof *out->message);
  mps_status status = MPS_OK;
  if (out->sent && out->message)
    messages = write_notices(mpm, out);
  else
    status = mpsi_fail_memory(mpm->context, function, (size_t)notices * sizeof *out->sent);
  status = mpsi_domain_agree(domain, function, status);
  if (status != MPS_OK) return status;
  return mpsi_domain_exchange(domain, function, messages, out->message, &out->box);
}

mps_status mpsi_pore_find_notices(const mps_mpm *mpm, const char *function,
                                  mpsi_pore_notices *out) {
  *out = (mpsi_pore_notices){.box.context = mpm->context};
  const mps_status status = find_ranges(mpm, function, out);
  return status == MPS_OK ? announce(mpm, function, out) : status;
}

int64_t mpsi_pore_count_notices(const mpsi_pore_notices *notices) {
  int64_t count = 0;
  for (int32_t m = 0; m < notices->box.count; m++)
    count += notices->box.mail[m].bytes / (int64_t)sizeof(mpsi_pore_notice);
  return count;
}

void mpsi_pore_free_notices(mps_context *context, mpsi_pore_notices *notices) {
  mpsi_domain_free_mail(&notices->box);
  mpsi_free(context, notices->range);
  mpsi_free(context, notices->sent);
  mpsi_free(context, notices->message);
}
