/* conditions.c - the public functions for what acts on a solver: boundaries, loads and contacts.
 * They take its parts; the work is done by boundary/boundaries.c, particles/loads.c and
 * contact/contacts.c. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"

#include "core/base/digits.h"

/* ---- boundaries ------------------------------------------------------------------------------ */

mps_status mps_mpm_add_boundary(mps_mpm *mpm, const mps_mpm_boundary_def *def, int32_t *number) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(mpm);
  return mpsi_mpm_add_boundary(&setup, __func__, def, number);
}

mps_status mps_mpm_set_boundary(mps_mpm *mpm, int32_t number, const mps_mpm_boundary_def *def) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(mpm);
  return mpsi_mpm_set_boundary(&setup, __func__, number, def);
}

mps_status mps_mpm_remove_boundary(mps_mpm *mpm, int32_t number) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(mpm);
  return mpsi_mpm_remove_boundary(&setup, __func__, number);
}

mps_status mps_mpm_get_reaction_sized(const mps_mpm *mpm, int32_t number, mps_reaction *out,
                                      size_t size) {
  static const char function[] = "mps_mpm_get_reaction";
  if (!mpm) return MPS_ERROR_ARGUMENT;
  mps_reaction reaction;
  /* scratch and messages only: the state stays */
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of((mps_mpm *)mpm);
  const mps_status status = mpsi_mpm_find_reaction(&setup, function, number, &reaction);
  if (status != MPS_OK) return status;
  return mpsi_out_write(mpm->context, function, out, size, &reaction, sizeof reaction);
}

/* ---- loads ----------------------------------------------------------------------------------- */

mps_status mps_mpm_add_load(mps_mpm *mpm, const mps_mpm_load_def *def, int32_t *number) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mpsi_load_setup setup = mpsi_load_setup_of(mpm);
  return mpsi_mpm_add_load(&setup, __func__, def, number);
}

mps_status mps_mpm_set_load(mps_mpm *mpm, int32_t number, const mps_mpm_load_def *def) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mpsi_load_setup setup = mpsi_load_setup_of(mpm);
  return mpsi_mpm_set_load(&setup, __func__, number, def);
}

mps_status mps_mpm_remove_load(mps_mpm *mpm, int32_t number) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mpsi_load_setup setup = mpsi_load_setup_of(mpm);
  return mpsi_mpm_remove_load(&setup, __func__, number);
}

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
      .check = check_owner, .end = end, .particles = list_particles};
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mpsi_contact_setup setup = mpsi_contact_setup_of(mpm);
  return mpsi_mpm_add_contact(&setup, __func__, &owner, mpm, body, def, out);
}
