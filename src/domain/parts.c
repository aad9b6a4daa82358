/* parts.c - sets of particles in parts: each rank makes the same fills and keeps its part of them
 * (core/particles/deal.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "domain_private.h"
#include "migrate.h"

#include <string.h>

static mps_status agree_added(void *self, const char *function, mps_status status, int64_t count,
                              uint64_t hash) {
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "the number of particles that are added", (double)count);
  mpsi_give(&given, "a hash of the positions of the added particles", mpsi_hash_short(hash));
  return mpsi_domain_agree_given(self, function, status, &given);
}

static mps_status settle(void *self, const char *function, mps_status status) {
  return mpsi_domain_agree(self, function, status);
}

static void release(void *self) {
  mps_domain *domain = self;
  mps_domain_destroy(&domain);
}

static mps_status create(mps_domain *domain, const char *function, const mps_particles_def *def,
                         mps_particles **out) {
  mps_context *context = domain->context;
  mps_status status = MPS_OK;
  if (!out) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "out is NULL");
  status = mpsi_as(context, function, mps_particles_create(context, def, out));
  if (status != MPS_OK || !mpsi_domain_many(domain)) return status;
  const mpsi_deal deal = {.self = domain,
                          .rank = domain->def.rank,
                          .size = domain->def.size,
                          .agree = agree_added,
                          .settle = settle,
                          .release = release};
  status = mpsi_particles_deal_out(*out, function, &deal);
  if (status == MPS_OK)
    (void)mpsi_domain_retain(domain);
  else
    mps_particles_destroy(out);
  return status;
}

mps_status mps_domain_create_particles(mps_domain *domain, const mps_particles_def *def,
                                       mps_particles **out) {
  if (!domain) return mpsi_null(__func__, "domain");
  mps_particles *made = NULL;
  mpsi_given given = MPSI_GIVEN;
  if (out) *out = NULL;
  mps_status status = create(domain, __func__, def, out ? &made : NULL);
  mps_particles_def known = mps_particles_defaults();
  if (status == MPS_OK)
    status = MPSI_DEF_READ(domain->context, __func__, mps_particles_def, def, &known);
  MPSI_GIVE_DEF(&given, mps_particles_def, &known);
  status = mpsi_domain_agree_given(domain, __func__, status, &given);
  if (status != MPS_OK)
    mps_particles_destroy(&made);
  else
    *out = made;
  return status;
}

mps_status mpsi_domain_agree_parts(mps_domain *domain, const char *function, mps_status status,
                                   const mps_particles *particles) {
  const mpsi_deal *deal = mpsi_particles_deal(particles);
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "whether the set is in parts (mps_domain_create_particles)", deal != NULL);
  if (deal) {
    uint64_t fields = MPSI_HASH;
    for (int32_t f = 0; f < mps_particles_field_count(particles); f++) {
      mps_particles_field_info info = {.name = ""};
      if (mps_particles_get_field_info(particles, f, &info) != MPS_OK) continue;
      fields = mpsi_hash(fields, info.name, strlen(info.name) + 1);
      fields = mpsi_hash(fields, &info.components, sizeof info.components);
    }
    mpsi_give(&given, "the number of fields of the set", mps_particles_field_count(particles));
    mpsi_give(&given, "a hash of the fields' names", mpsi_hash_short(fields));
    mpsi_give(&given, "a hash of the constants given by mps_particles_set",
              mpsi_hash_short(deal->constants));
  }
  return mpsi_domain_agree_given(domain, function, status, &given);
}

/* ---- moving ---------------------------------------------------------------------------------- */

/* What leaves this rank, by present index, and all columns of the set. */
typedef struct departure {
  mps_particles *set;
  uint8_t *gone;
  int64_t *row, count;
  int32_t *to;
  void **column;
  int32_t columns;
} departure;

/* `column` NULL: how many. */
static int32_t list_columns(mps_particles *set, void **column) {
  int32_t columns = 0;
  for (int32_t f = 0; f < mps_particles_field_count(set); f++) {
    mps_particles_field_info info = {.name = ""};
    if (mps_particles_get_field_info(set, f, &info) != MPS_OK) continue;
    for (int32_t c = 0; c < info.components; c++, columns++)
      if (column)
        column[columns] = info.dtype.code == 0 ? (void *)mpsi_particles_integers(set, info.name)
                                               : (void *)mpsi_particles_column(set, info.name, c);
  }
  return columns;
}

static mps_status list_leaving(departure *d, mps_domain *domain, const char *function,
                               const int32_t *to) {
  mps_context *context = domain->context;
  const int64_t count = mps_particles_count(d->set);
  int64_t leaving = 0;
  for (int64_t k = 0; k < count; k++) leaving += to[k] != domain->def.rank;
  d->columns = list_columns(d->set, NULL);
  d->column = mpsi_alloc(context, d->columns, sizeof *d->column);
  d->gone = mpsi_alloc(context, count, 1);
  d->row = mpsi_alloc(context, leaving, sizeof *d->row);
  d->to = mpsi_alloc(context, leaving, sizeof *d->to);
  if (!d->column || !d->gone || !d->row || !d->to)
    return mpsi_fail_memory(context, function, (size_t)count + (size_t)leaving * 12);
  list_columns(d->set, d->column);
  for (int64_t k = 0; k < count; k++) {
    d->gone[k] = to[k] != domain->def.rank;
    if (!d->gone[k]) continue;
    d->row[d->count] = k;
    d->to[d->count++] = to[k];
  }
  return MPS_OK;
}

mps_status mpsi_domain_move(mps_domain *domain, const char *function, mps_status status,
                            mps_particles *particles, const int32_t *to) {
  mps_context *context = domain->context;
  departure d = {.set = particles};
  mpsi_mailbox box = {.context = context};
  int64_t arriving = 0;
  if (status == MPS_OK) status = list_leaving(&d, domain, function, to);
  status = mpsi_domain_agree(domain, function, status);
  const mpsi_leaving leaving = {.count = d.count,
                                .row = d.row,
                                .to = d.to,
                                .columns = d.columns,
                                .column = (const void *const *)d.column};
  if (status == MPS_OK) status = mpsi_migrate(domain, function, &leaving, &box, &arriving);
  if (status == MPS_OK)
    status = mpsi_domain_agree(
        domain, function,
        mpsi_particles_hold_room(particles, function,
                                 mps_particles_count(particles) - d.count + arriving));
  if (status == MPS_OK) {
    mpsi_particles_make_way(particles, d.gone);
    list_columns(particles, d.column); /* which may have moved */
    mpsi_migrate_unpack(&box, d.columns, d.column, mps_particles_count(particles));
    mpsi_particles_admit(particles, arriving);
  }
  mpsi_domain_free_mail(&box);
  MPSI_FREE(context, d.gone, d.row, d.to, d.column);
  return status;
}
