/* state.c - the state of a moving body: see core/state.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "contact_internal.h"

void mpsi_body_list_account(mpsi_state *state, mps_body *body) {
  mpsi_state_f64(state, "pending_force", body->pending.force, 3);
  mpsi_state_f64(state, "pending_moment", body->pending.moment, 3);
  for (int32_t part = 0; part < body->parts; part++) {
    mpsi_state_enter(state, "part%d", part);
    mpsi_state_reaction(state, &body->reaction[part]);
    mpsi_state_leave(state);
  }
}

void mpsi_body_list_source(mpsi_state *state, const mps_body *body, mpsi_body_source *source) {
  for (int32_t part = 0; part < body->parts; part++) {
    mpsi_state_enter(state, "contact%d", part);
    mpsi_state_reaction(state, &source->reaction[part]);
    mpsi_state_leave(state);
  }
}

void mpsi_body_list_state(mpsi_state *state, mps_body *body) {
  mpsi_pose *p = &body->pose;
  mpsi_state_agree_integer(state, "shape", body->shape);
  mpsi_state_agree_integer(state, "faces", body->faces);
  mpsi_state_agree_choice(state, "motion", "mps_body_motion_kind", body->def.motion);
  mpsi_state_agree_integer(state, "parts", body->parts);
  mpsi_state_f64(state, "time", &body->time, 1);
  mpsi_state_f64(state, "position", p->x, 3);
  mpsi_state_f64(state, "rotation", body->rotation, 3);
  mpsi_state_f64(state, "orientation", p->R, 9);
  mpsi_state_f64(state, "velocity", p->v, 3);
  mpsi_state_f64(state, "spin", p->spin, 3);
  mpsi_state_f64(state, "angular", body->angular, 3);
  mpsi_state_bool(state, "outside", &body->outside);
  mpsi_state_f64(state, "work_contacts", &body->work_contacts, 1);
  mpsi_state_f64(state, "work_loads", &body->work_loads, 1);
  mpsi_state_f64(state, "dissipated", &body->dissipated, 1);
  mpsi_state_f64(state, "load_force", body->load.force, 3);
  mpsi_state_f64(state, "load_moment", body->load.moment, 3);
  mpsi_body_list_account(state, body);
}

void mpsi_contact_list_state(mpsi_state *state, mps_contact *contact) {
  mpsi_body_list_source(state, contact->body, &contact->source);
}
