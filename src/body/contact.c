/* contact.c - creation and release of a contact: definition, references of solver and caller,
 * forces on the body. SPDX-License-Identifier: BSD-3-Clause */
#include "contact_internal.h"

#include "rotation.h"
#include "core/base/digits.h"

#include <string.h>

#define ROUGHEST 1e3 /* friction */
#define MOST_SWEEPS 1000
#define SWEEPS 10         /* usual */
#define SWEEPS_AT_MOST 30 /* where a tolerance may end them earlier */

static const mps_contact_def contact_defaults = {.struct_size = sizeof(mps_contact_def),
                                                 .penalty = NAN,
                                                 .xi = NAN,
                                                 .offset = NAN,
                                                 .depth = NAN,
                                                 .strength = NAN,
                                                 .tolerance = NAN};

mps_status mps_contact_def_init(mps_contact_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_contact_def, def, size, &contact_defaults);
}

/* ---- checks ---------------------------------------------------------------------------------- */

static mps_status check_choices(mps_context *context, const char *function,
                                const mps_contact_def *d) {
  const struct {
    const char *name, *allowed;
    int32_t value;
  } list[] = {{"mover", "0 (solver) and 1 (other)", d->mover},
              {"method", "0 (impulse) and 1 (penalty)", d->method},
              {"thin", "0 (refused) and 1 (allowed)", d->thin},
              {"inside", "0 (refuse), 1 (push) and 2 (remove)", d->inside}};
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    if (list[k].value < 0 || list[k].value > (k == 3 ? 2 : 1))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %d, allowed are %s",
                       list[k].name, list[k].value, list[k].allowed);
  return MPS_OK;
}

static mps_status check_shear(mps_context *context, const char *function,
                              const mps_contact_def *d) {
  if (!(d->adhesion >= 0.0 && d->adhesion <= MPSI_BODY_HEAVY))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "adhesion is %s Pa, must be in 0 to %g",
                     mpsi_outside(d->adhesion, 0.0, MPSI_BODY_HEAVY).text, MPSI_BODY_HEAVY);
  if (!isnan(d->strength) && !(d->strength > 0.0 && d->strength <= MPSI_BODY_HEAVY))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "strength is %s Pa, must be > 0 and at most %g, or NaN",
                     mpsi_outside(d->strength, 0.0, MPSI_BODY_HEAVY).text, MPSI_BODY_HEAVY);
  if (d->method == MPS_CONTACT_METHOD_PENALTY && (d->adhesion > 0.0 || !isnan(d->strength)))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "%s is given, and method is 1 (penalty), which has Coulomb friction alone: "
                     "choose method 0 (impulse)",
                     d->adhesion > 0.0 ? "adhesion" : "strength");
  return MPS_OK;
}

static mps_status check_corner(mps_context *context, const char *function,
                               const mps_contact_def *d) {
  if (!(d->corner >= 0.0 && d->corner <= MPSI_BODY_FAR))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "corner is %s m, must be in 0 to %g",
                     mpsi_outside(d->corner, 0.0, MPSI_BODY_FAR).text, MPSI_BODY_FAR);
  if (d->method == MPS_CONTACT_METHOD_PENALTY && d->corner > 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "corner is %g m, and method is 1 (penalty), which rounds no corners: choose "
                     "method 0 (impulse), or 0 m",
                     d->corner);
  return check_shear(context, function, d);
}

static mps_status check_numbers(mps_context *context, const char *function,
                                const mps_contact_def *d) {
  if (d->sweeps < 0 || d->sweeps > MOST_SWEEPS)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "sweeps is %d, must be in 0 to %d",
                     d->sweeps, MOST_SWEEPS);
  if (!isnan(d->tolerance) && !(d->tolerance >= 0.0 && d->tolerance < 1.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "tolerance is %g, must be >= 0 and below 1, or NaN", d->tolerance);
  if (!(d->friction >= 0.0 && d->friction <= ROUGHEST))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "friction is %s, must be in 0 to %g",
                     mpsi_outside(d->friction, 0.0, ROUGHEST).text, ROUGHEST);
  if (!isnan(d->penalty) && !(d->penalty > 0.0 && d->penalty <= MPSI_BODY_HEAVY))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "penalty is %s N/m, must be > 0 and at most %g, or NaN",
                     mpsi_outside(d->penalty, 0.0, MPSI_BODY_HEAVY).text, MPSI_BODY_HEAVY);
  if (!isnan(d->xi) && !(d->xi > 0.0 && d->xi < 1.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "xi is %g, must be in (0, 1), or NaN",
                     d->xi);
  if (d->method == MPS_CONTACT_METHOD_IMPULSE && (!isnan(d->xi) || !isnan(d->penalty)))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "%s is given, and method is 0 (impulse), which has no stiffness: leave it "
                     "NaN, or choose method 1 (penalty)",
                     isnan(d->xi) ? "penalty" : "xi");
  if (!isnan(d->xi) && !isnan(d->penalty))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "xi is %g and penalty %g N/m: give one of them, the other NaN", d->xi,
                     d->penalty);
  if (!isnan(d->offset) && !(d->offset >= 0.0 && d->offset <= MPSI_BODY_FAR))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "offset is %s m, must be in 0 to %g, or NaN",
                     mpsi_outside(d->offset, 0.0, MPSI_BODY_FAR).text, MPSI_BODY_FAR);
  if (!isnan(d->depth) && !(d->depth > 0.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "depth is %g m, must be > 0, or NaN",
                     d->depth);
  return check_corner(context, function, d);
}

/* ---- life ------------------------------------------------------------------------------------ */

mps_status mpsi_contact_make(mps_context *context, const char *function, mps_body *body,
                             const mpsi_contact_owner *kind, void *owner, mps_contact **out) {
  mps_contact *contact = mpsi_alloc(context, 1, sizeof *contact);
  if (!contact) return mpsi_fail_memory(context, function, sizeof *contact);
  contact->context = mpsi_context_retain(context);
  contact->references = 2;
  contact->def = contact_defaults;
  contact->body = body;
  contact->extent = mpsi_body_extent(body);
  contact->kind = kind;
  contact->owner = owner;
  contact->parts = body->parts;
  body->references++;
  if (!mpsi_body_make_source(body, &contact->source)) {
    contact->references = 1;
    mpsi_contact_release(contact);
    return mpsi_fail_memory(context, function, (size_t)body->part_room * sizeof(mps_reaction));
  }
  *out = contact;
  return MPS_OK;
}

mps_status mpsi_contact_new(mps_context *context, const char *function, mps_body *body,
                            const mps_contact_def *user, const mpsi_contact_owner *kind,
                            void *owner, mps_contact **out) {
  mps_contact_def def = contact_defaults;
  mps_status status = MPS_OK;
  if (user) status = MPSI_DEF_READ(context, function, mps_contact_def, user, &def);
  if (status == MPS_OK) status = check_choices(context, function, &def);
  if (status == MPS_OK) status = check_numbers(context, function, &def);
  if (status == MPS_OK && def.mover == MPS_CONTACT_MOVER_SOLVER && mpsi_body_mover(body))
    status = mpsi_fail(context, function, MPS_ERROR_STATE,
                       "another solver moves the body: make this contact with mover 1 (other)");
  if (status != MPS_OK) return status;
  mps_contact *contact = NULL;
  status = mpsi_contact_make(context, function, body, kind, owner, &contact);
  if (status != MPS_OK) return status;
  contact->def = def;
  if (isnan(def.tolerance)) contact->def.tolerance = 0.0;
  if (def.sweeps == 0) contact->def.sweeps = contact->def.tolerance > 0.0 ? SWEEPS_AT_MOST : SWEEPS;
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

mps_body *mps_contact_body(const mps_contact *contact) { return contact ? contact->body : NULL; }

mps_status mps_contact_get_reaction_sized(const mps_contact *contact, int32_t part,
                                          mps_reaction *out, size_t size) {
  static const char function[] = "mps_contact_get_reaction";
  if (!contact) return MPS_ERROR_ARGUMENT;
  const mps_status status = mpsi_body_check_part(contact->body, function, part);
  if (status != MPS_OK) return status;
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
  if (!contact) return MPS_ERROR_ARGUMENT;
  if (capacity < 0 || !count)
    return mpsi_fail(contact->context, __func__, MPS_ERROR_ARGUMENT,
                     "capacity is %lld and count %s, must be >= 0 and given", (long long)capacity,
                     count ? "given" : "NULL");
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
  if (def->penalty > 0.0) return def->penalty;
  const double depth = contact->body->dim == 3 ? spacing : 1.0; /* 2D: per m of thickness */
  if (isnan(def->xi)) return 1.33 * modulus * depth;
  /* (58) is 2 (1 - xi) m/dt^2; with dt = CFL cell/sqrt(modulus/density), m/dt^2 is this: */
  const double share = spacing / (courant * cell);
  return 2.0 * (1.0 - def->xi) * modulus * share * share * depth;
}

double mpsi_contact_speed(const mps_contact *contact) {
  const mpsi_pose *p = &contact->body->pose;
  return sqrt(mpsi_dot3(p->v, p->v)) + contact->extent * sqrt(mpsi_dot3(p->spin, p->spin));
}
