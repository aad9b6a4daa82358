/* deal.c - sets in parts: every rank has the same fill and keeps an equal part of it, with the ids
 * of one process. No rank ever has memory for all particles.
 *
 * A part is a slab across the longest side of the fill: an interval of the columns of sites along
 * that axis, and of the two columns at its ends the first or the last ones in the fill's order, so
 * that parts differ by one particle at most. SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/hash.h"
#include "particles_private.h"

#include <string.h>

/* ---- which sets ------------------------------------------------------------------------------ */

mps_status mpsi_particles_deal_out(mps_particles *p, const char *function, const mpsi_deal *deal) {
  p->deal = mpsi_alloc(p->context, 1, sizeof *p->deal);
  if (!p->deal) return mpsi_fail_memory(p->context, function, sizeof *p->deal);
  *p->deal = *deal;
  p->deal->constants = MPSI_HASH;
  p->ids.sparse = true;
  return MPS_OK;
}

const mpsi_deal *mpsi_particles_deal(const mps_particles *p) { return p->deal; }

bool mpsi_particles_deals(const mps_particles *p) {
  for (const mpsi_holder *h = p->holders; h; h = h->next)
    if (h->agree) return false;
  return p->deal != NULL;
}

mps_status mpsi_particles_check_deal(const mps_particles *p, const char *function,
                                     const void *domain) {
  if (!p->deal || p->deal->self == domain) return MPS_OK;
  return mpsi_fail(p->context, function, MPS_ERROR_STATE,
                   "the set has %lld of %lld particles here, the others on %d other ranks "
                   "(mps_domain_create_particles): %s",
                   (long long)p->count, (long long)p->next_id, p->deal->size - 1,
                   domain ? "the solver has another domain than the set"
                          : "a solver without its domain, or one that needs all particles on each "
                            "rank, takes a set of mps_particles_create");
}

mps_status mpsi_deal_agree(const mps_particles *p, const char *function, mps_status status,
                           int64_t count, uint64_t hash) {
  return p->deal ? p->deal->agree(p->deal->self, function, status, count, hash) : status;
}

/* ---- slabs ----------------------------------------------------------------------------------- */

/* Bounds of the sites along each axis. */
static void find_bounds(const mpsi_site_runs *sites, int64_t *low, int64_t *high) {
  for (int64_t m = 0; m < sites->count; m++) {
    const mpsi_site_run *run = &sites->item[m];
    const int64_t begin[3] = {run->begin, run->j, run->k},
                  end[3] = {run->end, run->j + 1, run->k + 1};
    for (int c = 0; c < 3; c++) {
      if (m == 0 || begin[c] < low[c]) low[c] = begin[c];
      if (m == 0 || end[c] > high[c]) high[c] = end[c];
    }
  }
}

/* Numbers of sites in each column, from differences at the ends of runs. */
static void count_columns(const mpsi_site_runs *sites, int32_t axis, int64_t low, int64_t width,
                          int64_t *column) {
  memset(column, 0, (size_t)(width + 1) * sizeof *column);
  for (int64_t m = 0; m < sites->count; m++) {
    const mpsi_site_run *run = &sites->item[m];
    if (axis == 0)
      column[run->begin - low]++, column[run->end - low]--;
    else
      column[(axis == 1 ? run->j : run->k) - low] += run->end - run->begin;
  }
  for (int64_t c = 1; axis == 0 && c < width; c++) column[c] += column[c - 1];
}

bool mpsi_slab_cut(const mps_particles *p, const mpsi_site_runs *sites, mpsi_slab *out) {
  int64_t low[3] = {0}, high[3] = {0}, all = 0;
  *out = (mpsi_slab){.axis = 0};
  find_bounds(sites, low, high);
  for (int c = 1; c < 3; c++)
    if (high[c] - low[c] > high[out->axis] - low[out->axis]) out->axis = c;
  const int64_t width = high[out->axis] - low[out->axis];
  int64_t *column = mpsi_alloc(p->context, width + 1, sizeof *column);
  if (!column) return false;
  count_columns(sites, out->axis, low[out->axis], width, column);
  for (int64_t c = 0; c < width; c++) all += column[c];
  for (int end = 0; end < 2; end++) {
    const int64_t wanted = mpsi_deal_first(p->deal, p->deal->rank + end, all);
    int64_t below = 0, c = 0;
    while (c < width && below + column[c] <= wanted) below += column[c++];
    out->first[end] = low[out->axis] + c;
    out->skip[end] = wanted - below;
    out->count = wanted - (end ? out->count : 0);
  }
  mpsi_free(p->context, column);
  return true;
}

void mpsi_slab_next(mpsi_slab *s, const mpsi_site_run *run, int64_t *begin, int64_t *end) {
  int64_t bound[2];
  for (int e = 0; e < 2; e++) {
    const int64_t at = s->first[e], length = run->end - run->begin;
    if (s->axis == 0) {
      const bool crosses = at >= run->begin && at < run->end;
      /* this run has one site in that column, below the bound or not */
      bound[e] = at + (crosses && s->passed[e] < s->skip[e]);
      s->passed[e] += crosses;
    } else {
      const int64_t column = s->axis == 1 ? run->j : run->k;
      const int64_t left = s->skip[e] - s->passed[e];
      bound[e] = run->begin + (column < at ? length : column > at ? 0 : left);
      if (column == at) s->passed[e] += length;
    }
    if (bound[e] < run->begin) bound[e] = run->begin;
    if (bound[e] > run->end) bound[e] = run->end;
  }
  *begin = bound[0], *end = bound[1];
}
