/* collective_status.c - agreement of all ranks: on one status, on equal state and arguments, and on
 * largest values. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/run.h"
#include "mpm/contact/prescribed.h"
#include "mpm/ranks/partition.h"

bool mpsi_mpm_counts_node_block(const mpsi_grid *grid, int64_t g) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  int q = 0;
  while (nodes->from[q] < 0) q++;
  return !grid->cells[nodes->from[q]].ghost;
}

bool mpsi_mpm_node_block_complete(const mpsi_grid *grid, int64_t g) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  bool own = false;
  for (int q = 0; q < 1 << grid->dim; q++)
    own = own || (nodes->from[q] >= 0 && !grid->cells[nodes->from[q]].ghost);
  return own;
}

mps_status mpsi_mpm_any_rank(mpsi_partition *partition, const char *function, bool *any) {
  double one = *any;
  const mps_status status = mpsi_domain_max(partition->domain, function, 1, &one);
  *any = one > 0.0;
  return status;
}

mps_status mpsi_mpm_compare_edits(const mpsi_contacts *contacts, mpsi_partition *partition,
                                  mpsi_run *run, const mps_mpm_def *def, const char *function,
                                  mps_status status) {
  double found[4] = {run->edited, run->stale, run->lost, run->changed};
  partition->ready = false;
  MPSI_TRY(mpsi_mpm_agree_alike(contacts, partition, run, def, function, status, 4, found));
  run->edited = found[0] > 0.0;
  run->stale = found[1] > 0.0;
  run->lost = found[2] > 0.0;
  run->changed = found[3] > 0.0;
  return MPS_OK;
}

void mpsi_mpm_give_state(const mpsi_contacts *contacts, const mpsi_run *run, const mps_mpm_def *def,
                         mpsi_given *list) {
  mpsi_give(list, "the solver's time", run->time);
  mpsi_give(list, "the solver's number of steps", (double)run->steps);
  mpsi_give(list, "dt", def->dt);
  for (int32_t b = 0; b < contacts->bodies; b++) mpsi_body_give_state(list, contacts->body[b]);
}

mps_status mpsi_mpm_agree_alike(const mpsi_contacts *contacts, mpsi_partition *partition,
                                const mpsi_run *run, const mps_mpm_def *def, const char *function,
                                mps_status status, int32_t count, double *values) {
  mpsi_given list = MPSI_GIVEN;
  mpsi_mpm_give_state(contacts, run, def, &list);
  return mpsi_domain_agree_given_max(partition->domain, function, status, &list, count, values);
}

mps_status mpsi_mpm_agree(mpsi_partition *partition, const char *function, mps_status status) {
  return partition ? mpsi_domain_agree(partition->domain, function, status) : status;
}

/* ---- particles that the caller adds and removes ---------------------------------------------- */

mps_status mpsi_mpm_compare_added(const mpsi_grid *grid, const mpsi_columns *p,
                                  mpsi_partition *partition, const char *function,
                                  mps_status status, int64_t first) {
  const int64_t count = mps_particles_count(p->set) - first;
  uint64_t hash = mpsi_hash(MPSI_HASH, &count, sizeof count);
  for (int c = 0; c < grid->dim; c++) /* columns may have moved */
    hash = mpsi_hash(hash, mpsi_particles_column(p->set, "position", c) + first,
                     (size_t)count * sizeof(double));
  return mpsi_domain_agree_same(partition->domain, function, status,
                                "a hash of the particles to add", mpsi_hash_short(hash));
}

mps_status mpsi_mpm_count_listed(mps_context *context, mpsi_partition *partition,
                                 const char *function, mps_status status, int64_t count,
                                 const int64_t *ids, int64_t known, int64_t *all) {
  mps_domain *domain = partition->domain;
  double found[4] = {0.0};
  if (status == MPS_OK) {
    found[0] = mpsi_hash_short(mpsi_hash(MPSI_HASH, ids, (size_t)count * sizeof *ids));
    found[1] = -found[0];
    found[2] = (double)(count - known);
    found[3] = (double)count;
  }
  status = mpsi_domain_agree_max(domain, function, status, 4, found);
  *all = (int64_t)found[3];
  if (status != MPS_OK || found[2] == 0.0) return status;
  status = mpsi_domain_sum(domain, function, 1, &known);
  if (status != MPS_OK) return status;
  if (found[0] != -found[1])
    status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "of %lld ids some are of particles that this rank does not have, and other "
                       "ranks give other ids: give all ranks the same list, or each one ids of its "
                       "own particles",
                       (long long)count);
  else if (known != count)
    status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "of %lld ids %lld are of particles of the set on any rank", (long long)count,
                       (long long)known);
  return mpsi_domain_agree(domain, function, status);
}
