/* motion.c - how a rigid body moves, and the reactions it is told of.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body.h"

#include "core/retain.h"

#include <string.h>

/* ---- motion ---------------------------------------------------------------------------------- */

static void set_angle(mps_body *body, double angle) {
  body->angle = angle;
  body->pose.cosine = cos(angle);
  body->pose.sine = sin(angle);
}

/* Where the signals are at the body's time. */
static void follow(mps_body *body) {
  double at[3] = {body->def.position[0], body->def.position[1], body->def.angle}, rate[3] = {0};
  for (int c = 0; c < 3; c++) {
    if (!body->signal[c]) continue;
    at[c] += body->factor[c] * mps_signal_displacement(body->signal[c], body->time);
    rate[c] = body->factor[c] * mps_signal_velocity(body->signal[c], body->time);
  }
  for (int c = 0; c < 2; c++) body->pose.x[c] = at[c], body->pose.v[c] = rate[c];
  body->pose.spin = rate[2];
  set_angle(body, at[2]);
}

void mpsi_body_begin(mps_body *body) {
  const mps_body_def *def = &body->def;
  if (def->motion == MPS_MOTION_PRESCRIBED) {
    follow(body);
    return;
  }
  for (int c = 0; c < 2; c++)
    body->pose.x[c] = def->position[c], body->pose.v[c] = def->velocity[c];
  body->pose.spin = def->spin;
  set_angle(body, def->angle);
}

void mpsi_body_advance(mps_body *body, double dt) {
  const mps_body_def *def = &body->def;
  body->time += dt;
  if (def->motion == MPS_MOTION_PRESCRIBED) {
    follow(body);
    return;
  }
  double force[2] = {body->load[0], body->load[1]}, moment = body->load[2];
  for (int32_t part = 0; part < body->parts; part++) {
    for (int c = 0; c < 2; c++) force[c] += body->reaction[part].force[c];
    moment += body->reaction[part].moment;
  }
  for (int c = 0; c < 2; c++) { /* damping at the end of the step: stable for every dt */
    const double v = body->pose.v[c] + dt * (force[c] / def->mass + def->gravity[c]);
    body->pose.v[c] = v / (1.0 + dt * def->damping[0]);
    body->pose.x[c] += dt * body->pose.v[c];
  }
  body->pose.spin = (body->pose.spin + dt * (moment / def->inertia)) / (1.0 + dt * def->damping[1]);
  set_angle(body, body->angle + dt * body->pose.spin);
}

mps_status mps_body_advance(mps_body *body, double dt) {
  if (!body) return MPS_ERROR_ARGUMENT;
  if (!isfinite(dt) || dt <= 0.0)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "dt is %g s, must be finite and > 0", dt);
  if (body->user)
    return mpsi_fail(body->context, __func__, MPS_ERROR_STATE,
                     "a solver moves this body: destroy the solver first");
  mpsi_body_advance(body, dt);
  return MPS_OK;
}

mps_status mps_body_drive(mps_body *body, int32_t component, mps_signal *signal, double factor) {
  if (!body) return MPS_ERROR_ARGUMENT;
  if (component < 0 || component > 2)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "component is %d, allowed are 0 (x), 1 (y) and 2 (rotation)", component);
  if (!isfinite(factor))
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "factor is %g, must be finite",
                     factor);
  if (body->def.motion != MPS_MOTION_PRESCRIBED)
    return mpsi_fail(body->context, __func__, MPS_ERROR_STATE,
                     "a free body follows no signal: use mps_body_load");
  mps_signal *old = body->signal[component];
  body->signal[component] = signal ? mpsi_signal_retain(signal) : NULL;
  body->factor[component] = factor;
  mps_signal_destroy(&old);
  follow(body);
  return MPS_OK;
}

mps_status mps_body_load(mps_body *body, const double *force, double moment) {
  if (!body) return MPS_ERROR_ARGUMENT;
  if (!force) return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "force is NULL");
  if (!isfinite(force[0]) || !isfinite(force[1]) || !isfinite(moment))
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "force is (%g, %g) N and moment %g N m, must be finite", force[0], force[1],
                     moment);
  if (body->def.motion != MPS_MOTION_FREE)
    return mpsi_fail(body->context, __func__, MPS_ERROR_STATE,
                     "a prescribed body takes no load: its motion is given");
  body->load[0] = force[0], body->load[1] = force[1], body->load[2] = moment;
  return MPS_OK;
}

mps_status mps_body_get_state(mps_body *body, mps_body_state *out) {
  if (!body) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  const mpsi_pose *p = &body->pose;
  *out = (mps_body_state){.time = body->time,
                          .position = {p->x[0], p->x[1]},
                          .angle = body->angle,
                          .velocity = {p->v[0], p->v[1]},
                          .spin = p->spin};
  return MPS_OK;
}

/* ---- reactions ------------------------------------------------------------------------------- */

void mpsi_body_react(mps_body *body, double dt, const mpsi_load *load, const int64_t *contacts) {
  for (int32_t part = 0; part < body->parts; part++) {
    mps_reaction *r = &body->reaction[part];
    for (int c = 0; c < 2; c++) {
      r->force[c] = load[part].force[c];
      r->impulse[c] += dt * load[part].force[c];
    }
    r->moment = load[part].moment;
    r->moment_impulse += dt * load[part].moment;
    r->contacts = contacts[part];
  }
}

mps_status mps_body_get_reaction(mps_body *body, int32_t part, mps_reaction *out) {
  if (!body) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  if (part < -1 || part >= body->parts)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "part is %d, allowed are 0 to %d, and -1 for all", part, body->parts - 1);
  mps_reaction sum = {0};
  for (int32_t p = part < 0 ? 0 : part; p < (part < 0 ? body->parts : part + 1); p++) {
    const mps_reaction *r = &body->reaction[p];
    for (int c = 0; c < 2; c++) {
      sum.force[c] += r->force[c];
      sum.impulse[c] += r->impulse[c];
    }
    sum.moment += r->moment;
    sum.moment_impulse += r->moment_impulse;
    sum.contacts += r->contacts;
  }
  *out = sum;
  return MPS_OK;
}

/* ---- parts ----------------------------------------------------------------------------------- */

static bool good_name(const char *name) {
  const size_t length = strlen(name);
  if (length < 1 || length >= MPSI_PART_NAME) return false;
  for (size_t k = 0; k < length; k++) {
    const char c = name[k];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    if (!letter && !(k > 0 && c >= '0' && c <= '9')) return false;
  }
  return true;
}

mps_status mps_body_name_part(mps_body *body, const char *name, int64_t first, int64_t count,
                              int32_t *part) {
  if (!body) return MPS_ERROR_ARGUMENT;
  if (!name || !good_name(name))
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "name is \"%.60s\", must be [A-Za-z_][A-Za-z0-9_]* of at most 47 characters",
                     name ? name : "(NULL)");
  if (first < 0 || first >= body->edges || count < 1 || count > body->edges)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "first is %lld and count %lld, allowed are 0 to %lld and 1 to %lld",
                     (long long)first, (long long)count, (long long)body->edges - 1,
                     (long long)body->edges);
  int32_t number = mps_body_part(body, name);
  if (number < 0) {
    if (body->parts == MPS_BODY_MAX_PARTS)
      return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                       "the body has %d named parts, the most there can be",
                       MPS_BODY_MAX_PARTS - 1);
    number = body->parts++;
    strcpy(body->names[number], name);
  }
  for (int64_t k = 0; k < count; k++) body->part_of[(first + k) % body->edges] = number;
  if (part) *part = number;
  return MPS_OK;
}

int32_t mps_body_part_count(const mps_body *body) { return body ? body->parts : 0; }

int32_t mps_body_part(const mps_body *body, const char *name) {
  for (int32_t k = 0; body && name && k < body->parts; k++)
    if (strcmp(body->names[k], name) == 0) return k;
  return -1;
}
