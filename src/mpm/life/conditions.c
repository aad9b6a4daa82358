/* conditions.c - what acts on a solver: boundaries and loads as numbered conditions
 * (solver/conditions.h), contacts. The work is done by boundary/boundaries.c, particles/loads.c and
 * contact/contacts.c. SPDX-License-Identifier: BSD-3-Clause */
#include "conditions.h"
#include "mpm/base/mpm_solver.h"
#include "mpm/particles/mpm_particles.h"

#include "core/particles/particles_internal.h"

#include <string.h>

/* ---- particles ------------------------------------------------------------------------------- */

static bool counts(const void *solver, int64_t id) {
  return mps_particles_index(((const mps_mpm *)solver)->p.set, id) >= 0;
}

/* ---- boundaries ------------------------------------------------------------------------------ */

static bool has_side(const void *solver, int32_t number) {
  return mpsi_mpm_has_side(&((const mps_mpm *)solver)->grid, number);
}

/* Sides are rollers until the caller says otherwise, and free once removed. */
static void describe_side(const void *solver, int32_t number, void *def) {
  const int32_t kind = ((const mps_mpm *)solver)->boundaries.boundary[number].kind;
  ((mps_mpm_boundary_def *)def)->kind = kind == MPSI_BOUNDARY_NONE ? MPS_BOUNDARY_FREE : kind;
}

static mps_status check_boundary(void *solver, const char *function, int32_t number,
                                 const void *def) {
  const mps_mpm_boundary_def *d = def;
  const mps_mpm *mpm = solver;
  const int64_t most = mpm->partition ? MPSI_MPM_MOST_PARTICLES : mpm->p.count;
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(solver);
  if (number >= MPSI_SIDES && d->id_count > most)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "id_count is %lld, allowed are 1 to %lld particles", (long long)d->id_count,
                     (long long)most);
  return mpsi_mpm_check_boundary(&setup, function, number, def);
}

/* The nodes of a box are those of the grid. */
static bool keeps(const void *def, mpsi_selected by) { return true; }

static mps_status make_boundary(void *solver, const char *function, int32_t number, void *def,
                                void *own) {
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(solver);
  return mpsi_mpm_make_boundary(&setup, function, number, def, own);
}

static mps_status apply_boundary(void *solver, const char *function, int32_t number, void *def,
                                 void *own, void *former) {
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(solver);
  return def ? mpsi_mpm_set_boundary(&setup, function, number, def, own)
             : mpsi_mpm_remove_boundary(&setup, function, number);
}

const mpsi_condition_kind mpsi_mpm_boundary_kind = {
    MPSI_CONDITION_OF(MPM, mpm, BOUNDARY, boundary),
    .role = MPSI_SIGNAL_MOTION,
    .list = {{"ids", "id_count", 1}},
    .first = MPSI_SIDES,
    .most = INT32_MAX - 8,
    .size = sizeof(mpsi_boundary),
    .has = has_side,
    .describe = describe_side,
    .check = check_boundary,
    .selects = true,
    .keeps = keeps,
    .counts = counts,
    .make = make_boundary,
    .apply = apply_boundary,
};

mps_status mpsi_mpm_get_reaction(void *solver, const char *function, mps_status status,
                                 int32_t number, mps_reaction *out) {
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(solver);
  return mpsi_mpm_find_reaction(&setup, function, status, number, out);
}

/* ---- loads ----------------------------------------------------------------------------------- */

static mps_status check_load(void *solver, const char *function, int32_t number, const void *def) {
  const mps_mpm *mpm = solver;
  return mpsi_mpm_check_load(mpm->context, &mpm->grid, &mpm->p, mpm->partition, function, def);
}

static mps_status make_load(void *solver, const char *function, int32_t number, void *def,
                            void *own) {
  mps_mpm *mpm = solver;
  ((mpsi_traction *)own)->def = def;
  return mpsi_mpm_make_forces(mpm->context, &mpm->grid, &mpm->p, &mpm->rooms, function);
}

static mps_status apply_load(void *solver, const char *function, int32_t number, void *def,
                             void *own, void *former) {
  mpsi_traction *now = own;
  if (!now || !former) return MPS_OK;
  memcpy(now->now, ((mpsi_traction *)former)->now, sizeof now->now);
  memcpy(now->former, ((mpsi_traction *)former)->former, sizeof now->former);
  return MPS_OK;
}

const mpsi_condition_kind mpsi_mpm_load_kind = {
    MPSI_CONDITION_OF(MPM, mpm, LOAD, load),
    .role = MPSI_SIGNAL_NUMBER,
    .list = {{"ids", "id_count", 1}, {"area", "id_count", 1}},
    .most = INT32_MAX - 8,
    .size = sizeof(mpsi_traction),
    .check = check_load,
    .selects = true,
    .counts = counts,
    .make = make_load,
    .apply = apply_load,
};

/* ---- contacts -------------------------------------------------------------------------------- */

static mps_status check_owner(void *owner, const char *function) {
  mps_mpm *mpm = owner;
  return mpsi_mpm_between_steps(mpm->context, &mpm->run, function);
}

static void end(void *owner, mps_contact *contact) {
  mps_mpm *mpm = owner;
  mpsi_mpm_end_contact(&mpm->grid, &mpm->contact, contact);
}

static mps_status list_particles(void *owner, mps_contact *contact, const mpsi_contact_list *out,
                                 int64_t *count) {
  const mpsi_contact_setup setup = mpsi_contact_setup_of(owner);
  return mpsi_mpm_list_in_contact(&setup, contact, out, count);
}

mps_status mps_mpm_add_contact(mps_mpm *mpm, mps_body *body, const mps_contact_def *def,
                               mps_contact **out) {
  static const mpsi_contact_owner owner = {
      .check = check_owner, .end = end, .particles = list_particles, .def_kind = MPS_DEF_CONTACT};
  if (!mpm) return mpsi_null(__func__, "mpm");
  const mpsi_contact_setup setup = mpsi_contact_setup_of(mpm);
  return mpsi_mpm_add_contact(&setup, __func__, &owner, mpm, body, def, out);
}
