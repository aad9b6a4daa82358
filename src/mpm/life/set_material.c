/* set_material.c - another law for some particles, or all of them, between steps.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"

/* Number of particles of a list, NULL being all; index of the i-th of them. */
static int64_t listed(const mpsi_columns *p, int64_t count, const int64_t *ids) {
  return ids ? count : p->count;
}
static int64_t place(const mpsi_columns *p, const int64_t *ids, int64_t i) {
  return ids ? mps_particles_index(p->set, ids[i]) : i;
}

/* Number of the law of a material in the list; the length of the list for a new one. */
static int32_t number_of(const mpsi_columns *p, const mps_material *material) {
  int32_t number = 0;
  while (number < p->laws.count && p->laws.law[number].material != material) number++;
  return number;
}

/* Checks a list of particles: on several ranks it is the same on all, or of particles that the rank
 * has. */
static mps_status check_list(mps_mpm *mpm, const char *function, mps_status status,
                             const mps_material *material, int64_t count, const int64_t *ids) {
  int64_t known = 0, all;
  if (status == MPS_OK && (!ids || count < 0 || !mpm->partition))
    status = mpsi_particles_check_ids_or_all(mpm->p.set, function, count, ids);
  if (!mpm->partition) return status;
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "having a list of ids", ids != NULL);
  mpsi_material_give(&given, material);
  mpsi_give(&given, "the number of the material", number_of(&mpm->p, material));
  status = mpsi_domain_agree_given(mpm->domain, function, status, &given);
  if (status != MPS_OK || !ids) return status;
  for (int64_t k = 0; k < count; k++) known += mps_particles_index(mpm->p.set, ids[k]) >= 0;
  return mpsi_mpm_count_listed(mpm->context, mpm->partition, function, status, count, ids, known,
                               &all);
}

static mps_status check(mps_mpm *mpm, const char *function, const mps_material *material,
                        int64_t count, const int64_t *ids) {
  mps_status status = MPS_OK;
  if (!material) status = mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT, "material is NULL");
  MPSI_TRY(check_list(mpm, function, status, material, count, ids));
  const double *J = mpsi_material_reads_volume(material)
                        ? mpsi_particles_column(mpm->p.set, "volume_ratio", 0)
                        : NULL;
  for (int64_t i = 0; i < listed(&mpm->p, count, ids); i++) {
    const int64_t k = place(&mpm->p, ids, i);
    if (k >= 0 && J && !(J[k] >= 0.0 && J[k] < INFINITY))
      return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                       "ids: particle %lld has a volume_ratio of %g, must be > 0, or 0 for 1",
                       (long long)mpm->p.laws.ids[k], J[k]);
  }
  return MPS_OK;
}

/* Whether the particles' present state can be a first one of the law. Before the first step the
 * answer waits for it: the solver may be built for a state that is restored. */
static mps_status check_start(mps_mpm *mpm, const char *function, const mps_material *material,
                              int64_t count, const int64_t *ids) {
  if (!mpsi_material_has_start(material)) return MPS_OK;
  if (!mpm->run.begun) {
    mpm->run.unchecked = true;
    return MPS_OK;
  }
  mpsi_first_state first;
  mpsi_mpm_find_state(&mpm->p, material, &first);
  mps_status status = MPS_OK;
  for (int64_t i = 0; i < listed(&mpm->p, count, ids) && status == MPS_OK; i++) {
    const int64_t k = place(&mpm->p, ids, i);
    if (k >= 0)
      status = mpsi_mpm_check_state(mpm->context, &mpm->grid, &mpm->p, function, &first, k);
  }
  return status;
}

/* Adds the column of the laws' numbers, which a set with one law lacks. */
static mps_status number_particles(mpsi_columns *p) {
  if (p->law) return MPS_OK;
  MPSI_TRY(mps_particles_add_field(p->set, "material", 0));
  p->law = mpsi_particles_integers(p->set, "material");
  for (int64_t k = 0; k < p->count; k++) p->law[k] = 0;
  return MPS_OK;
}

/* Number of the law in the list, to which it is added if it is new. */
static mps_status list_law(mps_mpm *mpm, const char *function, mps_material *material,
                           int32_t *number) {
  mpsi_columns *p = &mpm->p;
  *number = number_of(p, material);
  if (*number < p->laws.count) return MPS_OK;
  const bool numbered = p->law != NULL;
  const int32_t fields = mps_particles_field_count(p->set);
  mps_status status = mpsi_as(mpm->context, function, number_particles(p));
  if (status == MPS_OK)
    status =
        mpsi_mpm_add_law(mpm->context, &mpm->grid, p, &mpm->rooms, &mpm->def, function, material);
  if (status == MPS_OK || numbered) return status;
  mpsi_particles_drop_fields(p->set, fields);
  p->law = NULL;
  return status;
}

mps_status mps_mpm_set_material(mps_mpm *mpm, mps_material *material, const int64_t *ids,
                                int64_t count) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  int32_t number = 0;
  mps_status status = mpsi_mpm_usable(mpm, __func__);
  if (mpm->partition)
    status = mpsi_mpm_compare_edits(&mpm->contact, mpm->partition, &mpm->run, &mpm->def, __func__,
                                    status);
  if (status == MPS_OK) status = check(mpm, __func__, material, count, ids);
  if (status == MPS_OK) status = check_start(mpm, __func__, material, count, ids);
  status = mpsi_mpm_agree(mpm->partition, __func__, status);
  if (status == MPS_OK) status = list_law(mpm, __func__, material, &number);
  MPSI_TRY(mpsi_mpm_agree(mpm->partition, __func__, status));
  for (int64_t i = 0; i < listed(&mpm->p, count, ids); i++) {
    const int64_t k = place(&mpm->p, ids, i);
    if (k < 0) continue;                    /* particle of another rank */
    if (mpm->p.law) mpm->p.law[k] = number; /* else there is one law */
    mpsi_mpm_begin_law(&mpm->grid, &mpm->p, &mpm->p.laws.law[number], k);
  }
  mpm->boundaries.renew = true; /* the dashpots of absorbing walls depend on the laws */
  /* the limit is updated with the other edits */
  if (mpm->run.edited || mpm->run.lost) return MPS_OK;
  mpsi_mpm_find_speeds(mpm);
  return mpsi_mpm_collect_block_results(mpm, __func__);
}
