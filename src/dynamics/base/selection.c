/* selection.c - the particles of a boundary or load of the explicit MPS solver: of a list, of a
 * box, or all. SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "core/context/retain.h"
#include "selection.h"
#include "dynamics/base/dynamics_solver.h"
#include "signal/signal_internal.h"

#include <stdlib.h>

mps_status mpsi_dynamics_agree_definition(mps_dynamics *dynamics, const char *function,
                                          mps_status status, const mpsi_dynamics_selection *s,
                                          mpsi_given *list) {
  if (status == MPS_OK) {
    mpsi_give(list, "all", s->all);
    mpsi_give(list, "id_count", (double)s->id_count);
    MPSI_GIVE_VECTOR(list, s, lower, 2);
    MPSI_GIVE_VECTOR(list, s, upper, 2);
    MPSI_GIVE_VECTOR(list, s, factor, 2);
    mpsi_give_bytes(list, "a hash of ids", s->id_count > 0 ? s->ids : NULL,
                    (size_t)s->id_count * sizeof *s->ids);
    for (int c = 0; c < 3; c++) mpsi_signal_give(list, "a hash of signal", s->signal[c]);
  }
  return mpsi_domain_agree_given(dynamics->domain, function, status, list);
}

static int compare_indices(const void *left, const void *right) {
  const int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
  return a < b ? -1 : a > b;
}

static mps_status select_list(mps_dynamics *dynamics, const char *function,
                              const mpsi_dynamics_selection *s, mpsi_dynamics_part *out,
                              int64_t *found) {
  for (int64_t k = 0; k < s->id_count; k++) {
    const int64_t i = mps_particles_index(dynamics->particles, s->ids[k]);
    if (i < 0 && mpsi_domain_many(dynamics->domain)) continue; /* may be of another rank */
    if (i < 0)
      return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: the set has no such particle", (long long)k,
                       (long long)s->ids[k]);
    out->particle[(*found)++] = (int32_t)i;
  }
  qsort(out->particle, (size_t)*found, sizeof *out->particle, compare_indices);
  for (int64_t k = 0; k < *found; k++) /* each particle once */
    if (k == 0 || out->particle[k] != out->particle[k - 1])
      out->particle[out->count++] = out->particle[k];
  return MPS_OK;
}

static void select_box(const mps_dynamics *dynamics, const mpsi_dynamics_selection *s,
                       mpsi_dynamics_part *out) {
  const double *x = mpsi_dynamics_column(dynamics, "position", 0);
  const double *y = mpsi_dynamics_column(dynamics, "position", 1);
  for (int64_t k = 0; k < dynamics->count; k++)
    if (s->all ||
        (x[k] >= s->lower[0] && x[k] <= s->upper[0] && y[k] >= s->lower[1] && y[k] <= s->upper[1]))
      out->particle[out->count++] = (int32_t)k;
}

/* Number of particles selected by all ranks; columns, which all ranks have, are counted on the
 * leading one. */
static mps_status count_selected(mps_dynamics *dynamics, const char *function,
                                 const mpsi_dynamics_selection *s, mpsi_dynamics_part *part) {
  int64_t sum[2] = {0, 0}; /* in all, and of the list as given */
  for (int64_t k = 0; k < part->count; k++)
    sum[0] += part->particle[k] < dynamics->body || dynamics->lead;
  for (int64_t k = 0; s->ids && k < s->id_count; k++) {
    const int64_t i = mps_particles_index(dynamics->particles, s->ids[k]);
    sum[1] += i >= 0 && (i < dynamics->body || dynamics->lead);
  }
  const mps_status status = mpsi_domain_sum(dynamics->domain, function, 2, sum);
  if (status != MPS_OK) return status;
  part->total = sum[0];
  if (s->ids && sum[1] != s->id_count)
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "of %lld ids %lld are of particles of the set on any rank",
                     (long long)s->id_count, (long long)sum[1]);
  if (part->total == 0)
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "lower and upper: no particle lies in the box from (%g, %g) m to (%g, %g) m",
                     s->lower[0], s->lower[1], s->upper[0], s->upper[1]);
  return MPS_OK;
}

static mps_status check_selection(mps_dynamics *dynamics, const char *function,
                                  const mpsi_dynamics_selection *s) {
  mps_context *context = dynamics->context;
  const bool listed = s->ids || s->id_count != 0;
  bool boxed = false;
  for (int c = 0; c < 2; c++) boxed = boxed || !isnan(s->lower[c]) || !isnan(s->upper[c]);
  if (listed && (!s->ids || s->id_count < 1))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "id_count is %lld and ids is %s: at least one particle is required",
                     (long long)s->id_count, s->ids ? "given" : "NULL");
  if (listed == boxed && !(s->all && !listed))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "%s: give either ids and id_count, or lower and upper",
                     listed ? "both a list and a box are given" : "no particles are given");
  for (int c = 0; c < 2 && boxed; c++)
    if (!(s->lower[c] <= s->upper[c]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "lower[%d] is %g m and upper[%d] %g m: must be numbers, lower <= upper", c,
                       s->lower[c], c, s->upper[c]);
  for (int c = 0; c < 2; c++)
    if (!isfinite(s->factor[c]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "factor[%d] is %g, must be finite", c,
                       s->factor[c]);
  if (s->signal[2])
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "signal[2] is given: the plane has x and y only");
  return MPS_OK;
}

mps_status mpsi_dynamics_select(mps_dynamics *dynamics, const char *function, mps_status status,
                                const mpsi_dynamics_selection *selection, mpsi_dynamics_part *out) {
  *out = (mpsi_dynamics_part){0};
  mpsi_dynamics_selection s = *selection;
  if (status == MPS_OK) status = check_selection(dynamics, function, &s);
  s.all = s.all && isnan(s.lower[0]) && isnan(s.lower[1]);
  const int64_t room = status != MPS_OK ? 0 : s.ids ? s.id_count : dynamics->count;
  int64_t found = 0;
  if (status == MPS_OK) out->particle = mpsi_alloc(dynamics->context, room, sizeof *out->particle);
  if (status == MPS_OK && !out->particle)
    status = mpsi_fail_memory(dynamics->context, function, (size_t)room * sizeof *out->particle);
  if (status == MPS_OK && s.ids)
    status = select_list(dynamics, function, &s, out, &found);
  else if (status == MPS_OK)
    select_box(dynamics, &s, out);
  if (status == MPS_OK && !(out->id = mpsi_alloc(dynamics->context, out->count, sizeof *out->id)))
    status = mpsi_fail_memory(dynamics->context, function, (size_t)out->count * sizeof *out->id);
  const int64_t *id = mpsi_particles_integers(dynamics->particles, "id");
  for (int64_t k = 0; status == MPS_OK && k < out->count; k++) out->id[k] = id[out->particle[k]];
  out->listed = out->count;
  for (int c = 0; c < 2; c++) {
    out->factor[c] = s.factor[c];
    if (status == MPS_OK && s.signal[c]) out->signal[c] = mpsi_signal_retain(s.signal[c]);
  }
  status = mpsi_domain_agree(dynamics->domain, function, status);
  if (status == MPS_OK) status = count_selected(dynamics, function, &s, out);
  if (status != MPS_OK) mpsi_dynamics_release_part(dynamics, out);
  return status;
}

mps_status mpsi_dynamics_reserve_slot(mps_dynamics *dynamics, const char *function, int32_t slot,
                                      void **slots, int32_t *room) {
  const int32_t wanted = slot + 8;
  if (slot < *room) return MPS_OK;
  if (!mpsi_grow(dynamics->context, slots, *room, wanted, sizeof(void *)))
    return mpsi_fail_memory(dynamics->context, function, (size_t)wanted * sizeof(void *));
  *room = wanted;
  return MPS_OK;
}

mps_status mpsi_dynamics_check_there(const mps_dynamics *dynamics, const char *function,
                                     const char *what, bool there, int32_t number) {
  if (there) return MPS_OK;
  return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT, "there is no %s number %d",
                   what, number);
}

void mpsi_dynamics_find_part(const mps_dynamics *dynamics, mpsi_dynamics_part *part) {
  bool sorted = true;
  part->count = 0;
  for (int64_t k = 0; k < part->listed; k++) {
    const int64_t i = mps_particles_index(dynamics->particles, part->id[k]);
    if (i < 0) continue;
    part->particle[part->count++] = (int32_t)i;
    sorted = sorted && (part->count < 2 || part->particle[part->count - 2] < i);
  }
  if (!sorted) qsort(part->particle, (size_t)part->count, sizeof *part->particle, compare_indices);
}

void mpsi_dynamics_release_part(mps_dynamics *dynamics, mpsi_dynamics_part *part) {
  mpsi_free(dynamics->context, part->id);
  mpsi_free(dynamics->context, part->particle);
  for (int c = 0; c < 2; c++) mps_signal_destroy(&part->signal[c]);
  *part = (mpsi_dynamics_part){0};
}
