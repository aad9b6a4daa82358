/* signals.c - the caller's signals in a step: factors of loads and of friction at its beginning,
 * velocities of boundaries at its middle, positions of bodies at its end. All are evaluated before
 * anything of the step changes, so that one that refuses leaves the state as it was.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"

#include "signal/signal_internal.h"

static mps_status evaluate_loads(mps_context *context, const mpsi_grid *grid,
                                 const mpsi_loads *loads, const mpsi_run *run,
                                 const char *function) {
  for (int32_t k = 0; k < loads->list->capacity; k++) {
    mpsi_traction *load = mpsi_load_of(loads, k);
    for (int c = 0; load && c < grid->dim; c++) {
      const mpsi_signal_use use = {context, function, "load", k, c};
      MPSI_TRY(mpsi_signal_factor(load->def->signal[c], use, run->time, &load->now[c]));
    }
  }
  return MPS_OK;
}

static mps_status evaluate_friction(const mpsi_contacts *contacts, const mpsi_run *run,
                                    const char *function) {
  for (int32_t b = 0; b < contacts->bodies; b++)
    MPSI_TRY(mpsi_contact_set_friction(contacts->handle[b], function, b, run->time));
  return MPS_OK;
}

static mps_status evaluate_boundaries(mps_context *context, const mpsi_grid *grid,
                                      const mpsi_boundaries *boundaries,
                                      const mpsi_settling *settling, const mpsi_run *run,
                                      const char *function, double dt) {
  for (int32_t k = 0; k < boundaries->count; k++) {
    mpsi_boundary *boundary = &boundaries->boundary[k];
    for (int c = 0; c < grid->dim; c++) {
      const mpsi_signal_use use = {context, function, "boundary", k, c};
      mpsi_signal_motion m = {0};
      boundary->v[c] = 0.0;
      if (!boundary->signal[c] || settling->on) continue;
      MPSI_TRY(mpsi_signal_evaluate(boundary->signal[c], use, run->time + 0.5 * dt, &m));
      boundary->v[c] = boundary->factor[c] * m.v;
    }
  }
  return MPS_OK;
}

static mps_status evaluate_bodies(const mpsi_contacts *contacts, const mpsi_settling *settling,
                                  const char *function, double dt) {
  for (int32_t b = 0; b < contacts->bodies && !settling->on; b++) {
    if (!contacts->handle[b]->source.moves) continue;
    MPSI_TRY(mpsi_body_look_ahead(contacts->body[b], function, b, dt));
  }
  return MPS_OK;
}

mps_status mpsi_mpm_evaluate_signals(mps_mpm *mpm, const char *function, double dt, bool moves) {
  const mpsi_guard outer = mpsi_guard_close(&mpm->guard, mpm->context, "a signal of the solver");
  mps_status status = evaluate_loads(mpm->context, &mpm->grid, &mpm->loads, &mpm->run, function);
  if (status == MPS_OK) status = evaluate_friction(&mpm->contact, &mpm->run, function);
  if (status == MPS_OK)
    status = evaluate_boundaries(mpm->context, &mpm->grid, &mpm->boundaries, &mpm->settling,
                                 &mpm->run, function, dt);
  if (status == MPS_OK && moves)
    status = evaluate_bodies(&mpm->contact, &mpm->settling, function, dt);
  mpm->guard = outer;
  return status;
}

bool mpsi_mpm_signals_may_refuse(const mpsi_grid *grid, const mpsi_loads *loads,
                                 const mpsi_boundaries *boundaries, const mpsi_contacts *contacts) {
  bool may = false;
  for (int32_t b = 0; b < contacts->bodies; b++)
    may = may || mpsi_signal_may_fail(contacts->handle[b]->def.friction_factor);
  for (int c = 0; c < grid->dim; c++) {
    for (int32_t k = 0; k < loads->list->capacity; k++)
      may = may || (mpsi_load_of(loads, k) &&
                    mpsi_signal_may_fail(mpsi_load_of(loads, k)->def->signal[c]));
    for (int32_t k = 0; k < boundaries->count; k++)
      may = may || mpsi_signal_may_fail(boundaries->boundary[k].signal[c]);
  }
  return may;
}

/* ---- ranks ----------------------------------------------------------------------------------- */

/* Values of the signals in the step to be made. */
static void give_signals(const mpsi_grid *grid, const mpsi_loads *loads,
                         const mpsi_boundaries *boundaries, const mpsi_contacts *contacts,
                         const mpsi_settling *settling, mpsi_given *list) {
  for (int32_t k = 0; k < boundaries->count; k++)
    if (boundaries->boundary[k].kind != MPSI_BOUNDARY_NONE)
      mpsi_give_vector(list, "the velocity of a boundary", grid->dim, boundaries->boundary[k].v);
  for (int32_t k = 0; k < loads->list->capacity; k++)
    if (mpsi_load_of(loads, k))
      mpsi_give_vector(list, "the present factor on a load", grid->dim,
                       mpsi_load_of(loads, k)->now);
  for (int32_t b = 0; b < contacts->bodies; b++)
    if (contacts->handle[b]->def.friction_factor)
      mpsi_give(list, "the present friction of a contact", contacts->handle[b]->friction);
  for (int32_t b = 0; b < contacts->bodies && !settling->on; b++)
    if (contacts->handle[b]->source.moves) mpsi_body_give_ahead(list, contacts->body[b]);
}

mps_status mpsi_mpm_agree_in_step(mps_mpm *mpm, const char *function, mps_status status,
                                  int32_t count, double *values) {
  mpsi_given list = MPSI_GIVEN;
  mpsi_mpm_give_state(&mpm->contact, &mpm->run, &mpm->def, &list);
  if (status == MPS_OK)
    give_signals(&mpm->grid, &mpm->loads, &mpm->boundaries, &mpm->contact, &mpm->settling, &list);
  return mpsi_domain_agree_given_max(mpm->domain, function, status, &list, count, values);
}
