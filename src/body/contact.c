/* contact.c - creation and release of a contact: definition, references of solver and caller,
 * forces on the body. SPDX-License-Identifier: BSD-3-Clause */
#include "contact_internal.h"

#include "rotation.h"
#include "core/context/retain.h"

#include <string.h>

#define SWEEPS 10         /* usual */
#define SWEEPS_AT_MOST 30 /* where a tolerance may end them earlier */

/* ---- life ------------------------------------------------------------------------------------ */

mps_status mpsi_contact_make(mps_context *context, const char *function, mps_body *body,
                             const mpsi_contact_owner *kind, void *owner, mps_contact **out) {
  mps_contact *contact = mpsi_alloc(context, 1, sizeof *contact);
  if (!contact) return mpsi_fail_memory(context, function, sizeof *contact);
  contact->context = mpsi_context_retain(context);
  contact->references = 2;
  contact->def = mps_contact_defaults();
  contact->body = body;
  contact->extent = mpsi_body_extent(body);
  contact->kind = kind;
  contact->owner = owner;
  contact->parts = body->parts;
  body->references++;
  if (!mpsi_body_make_source(body, &contact->source)) {
    contact->references = 1;
    mpsi_contact_release(contact);
    return mpsi_fail_memory(context, function, (size_t)body->part_capacity * sizeof(mps_reaction));
  }
  *out = contact;
  return MPS_OK;
}

mps_status mpsi_contact_new(mps_context *context, const char *function, mps_body *body,
                            const mps_contact_def *user, const mpsi_contact_owner *kind,
                            void *owner, mps_contact **out) {
  mps_contact_def def;
  MPSI_TRY(MPSI_DEF_READ_OR_DEFAULTS_IN(context, function, mps_contact_def, user,
                                        mpsi_scene_of(body->dim), &def));
  MPSI_TRY(mpsi_fail_of(
      context, mpsi_signal_check(context, function, MPSI_SIGNAL_NUMBER, 1, &def.friction_factor),
      "friction_factor"));
  if (def.mover == MPS_CONTACT_MOVER_SOLVER) MPSI_TRY(mpsi_body_check_mover(body, function));
  mps_contact *contact = NULL;
  MPSI_TRY(mpsi_contact_make(context, function, body, kind, owner, &contact));
  contact->def = def;
  contact->friction = def.friction;
  if (def.friction_factor) contact->def.friction_factor = mpsi_signal_retain(def.friction_factor);
  const bool sweeps = def.method == MPS_CONTACT_METHOD_IMPULSE;
  if (isnan(def.tolerance) && sweeps) contact->def.tolerance = 0.0;
  if (def.sweeps == 0 && sweeps)
    contact->def.sweeps = contact->def.tolerance > 0.0 ? SWEEPS_AT_MOST : SWEEPS;
  contact->source.moves = def.mover == MPS_CONTACT_MOVER_SOLVER;
  *out = contact;
  return MPS_OK;
}

void mpsi_contact_join(mps_contact *contact) { mpsi_body_join(contact->body, &contact->source); }

/* The body may move in the plane again; radial forces and moments of the last step, which cancel
 * around the ring, do not move it. */
static void leave_axis(mps_body *body) {
  if (!body->axial) return;
  body->axial = false;
  body->pending.force[0] = 0.0;
  memset(body->pending.moment, 0, sizeof body->pending.moment);
}

void mpsi_contact_leave(mps_contact *contact) {
  mpsi_body_leave(contact->body, &contact->source);
  if (!contact->body->sources) leave_axis(contact->body);
  contact->owner = NULL;
  mpsi_contact_release(contact);
}

void mpsi_contact_release(mps_contact *contact) {
  if (--contact->references > 0) return;
  mps_context *context = contact->context;
  mpsi_body_free_source(contact->body, &contact->source);
  mpsi_body_release(contact->body);
  mps_signal_destroy(&contact->def.friction_factor);
  MPSI_FREE(context, contact->inset, contact->bearer);
  mpsi_free(context, contact);
  mpsi_context_release(context);
}

void mps_contact_destroy(mps_contact **pointer) {
  if (!pointer || !*pointer) return;
  mps_contact *contact = *pointer;
  if (contact->owner && contact->kind->check(contact->owner, __func__) != MPS_OK) return;
  *pointer = NULL;
  if (contact->owner) contact->kind->end(contact->owner, contact);
  mpsi_contact_release(contact);
}

/* ---- questions ------------------------------------------------------------------------------- */

mps_status mps_contact_get_def(const mps_contact *contact, int32_t kind, void *out, size_t size) {
  if (!contact) return mpsi_null(__func__, "contact");
  const mpsi_contact_owner *of = contact->kind;
  const mpsi_definition *definition = mpsi_definition_of(of->def_kind);
  if (kind != of->def_kind)
    return mpsi_fail(
        contact->context, __func__, MPS_ERROR_ARGUMENT, "kind is %s, that of this contact is %s",
        mpsi_name_of("mps_def_kind", kind).text, mpsi_name_of("mps_def_kind", of->def_kind).text);
  if (!of->get_def)
    return mpsi_def_write(contact->context, __func__, out, size, &contact->def,
                          sizeof contact->def);
  if (!contact->owner)
    return mpsi_fail(contact->context, __func__, MPS_ERROR_STATE, "the contact has ended");
  union {
    double align;
    char bytes[MPSI_STRUCT_MOST];
  } known;
  mpsi_definition_fill(definition, &known, definition->size);
  of->get_def(contact->owner, contact, &known);
  return mpsi_def_write(contact->context, __func__, out, size, &known, definition->size);
}

mps_status mps_contact_get_reaction_sized(const mps_contact *contact, int32_t part,
                                          mps_reaction *out, size_t size) {
  static const char function[] = "mps_contact_get_reaction";
  if (!contact) return mpsi_null(__func__, "contact");
  MPSI_TRY(mpsi_body_check_part(contact->body, function, part));
  const bool asks = contact->owner && contact->kind->reaction;
  mps_reaction sum = {0};
  for (int32_t p = 0; p < contact->body->parts; p++) {
    if (part >= 0 && p != part) continue;
    mps_reaction r = contact->source.reaction[p];
    if (asks) contact->kind->reaction(contact->owner, contact, p, &r);
    mpsi_body_add_reaction(&sum, &r);
  }
  return mpsi_out_write(contact->context, function, out, size, &sum, sizeof sum);
}

mps_status mps_contact_get_particles(const mps_contact *handle, int64_t capacity, int64_t *count,
                                     int64_t *ids, double *gap, double *normal, double *force,
                                     double *foot) {
  mps_contact *contact = (mps_contact *)handle; /* scratch and messages only: the state stays */
  if (!contact) return mpsi_null(__func__, "contact");
  if (!count) return mpsi_fail(contact->context, __func__, MPS_ERROR_ARGUMENT, "count is NULL");
  if (capacity < 0)
    return mpsi_fail(contact->context, __func__, MPS_ERROR_ARGUMENT,
                     "capacity is %lld, must be >= 0", (long long)capacity);
  if (!contact->owner)
    return mpsi_fail(contact->context, __func__, MPS_ERROR_STATE, "the contact has ended");
  const mpsi_contact_list list = {capacity, ids, gap, normal, force, foot};
  return contact->kind->particles(contact->owner, contact, &list, count);
}

/* ---- for solvers ----------------------------------------------------------------------------- */

void mpsi_contact_react(mps_contact *contact, double dt, bool moves) {
  mpsi_body_react(contact->body, &contact->source, dt);
  if (moves && contact->source.moves) mpsi_body_advance(contact->body, dt);
}

double mpsi_contact_penalty(const mps_contact *contact, double modulus, double spacing, double cell,
                            double courant) {
  const mps_contact_def *def = &contact->def;
  if (!isnan(def->penalty)) return def->penalty;
  const double depth = contact->body->dim == 3 ? spacing : 1.0; /* 2D: per m of thickness */
  if (isnan(def->xi)) return 1.33 * modulus * depth;
  /* (58) is 2 (1 - xi) m/dt^2; with dt = CFL cell/sqrt(modulus/density), m/dt^2 is this: */
  const double share = spacing / (courant * cell);
  return 2.0 * (1.0 - def->xi) * modulus * share * share * depth;
}

mps_status mpsi_contact_set_friction(mps_contact *contact, const char *function, int32_t number,
                                     double t) {
  const mpsi_signal_use use = {contact->context, function, "contact", number, -1};
  double factor = 1.0;
  MPSI_TRY(mpsi_signal_factor(contact->def.friction_factor, use, t, &factor));
  if (!(factor >= 0.0))
    return mpsi_fail(contact->context, function, MPS_ERROR_ARGUMENT,
                     "friction_factor of contact %d is %g at t = %g s, must be >= 0", number,
                     factor, t);
  contact->friction = factor * contact->def.friction;
  return MPS_OK;
}

double mpsi_contact_speed(const mps_contact *contact) {
  const mpsi_pose *p = &contact->body->pose;
  return sqrt(mpsi_dot3(p->v, p->v)) + contact->extent * sqrt(mpsi_dot3(p->spin, p->spin));
}
