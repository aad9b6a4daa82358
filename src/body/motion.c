/* motion.c - how a rigid body moves, and the reactions it is told of.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body.h"

#include "core/retain.h"
#include "rotation.h"

#include <string.h>

/* ---- motion ---------------------------------------------------------------------------------- */

/* 2D: the plane turned by `angle`. */
static void set_angle(mps_body *body, double angle) {
  const double cosine = cos(angle), sine = sin(angle);
  const double R[9] = {cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0};
  body->rotation[2] = angle;
  memcpy(body->pose.R, R, sizeof R);
}

/* Where the signals are at the body's time. */
static void follow(mps_body *body) {
  double at[MPSI_MOTIONS], rate[MPSI_MOTIONS] = {0};
  for (int c = 0; c < 3; c++) at[c] = body->def.position[c], at[3 + c] = body->def.rotation[c];
  for (int c = 0; c < MPSI_MOTIONS; c++) {
    if (!body->signal[c]) continue;
    at[c] += body->factor[c] * mps_signal_displacement(body->signal[c], body->time);
    rate[c] = body->factor[c] * mps_signal_velocity(body->signal[c], body->time);
  }
  mpsi_pose *pose = &body->pose;
  for (int c = 0; c < 3; c++) pose->x[c] = at[c], pose->v[c] = rate[c];
  if (body->dim == 2) {
    pose->spin[2] = rate[5];
    set_angle(body, at[5]);
    return;
  }
  memcpy(body->rotation, at + 3, sizeof body->rotation);
  mpsi_rotation_exp(at + 3, pose->R);
  mpsi_rotation_spin(at + 3, rate + 3, pose->spin);
}

void mpsi_body_begin(mps_body *body) {
  const mps_body_def *def = &body->def;
  if (def->motion == MPS_MOTION_PRESCRIBED) {
    follow(body);
    return;
  }
  mpsi_pose *pose = &body->pose;
  for (int c = 0; c < 3; c++)
    pose->x[c] = def->position[c], pose->v[c] = def->velocity[c], pose->spin[c] = def->spin[c];
  if (body->dim == 2) {
    set_angle(body, def->rotation[2]);
    return;
  }
  mpsi_rotation_exp(def->rotation, pose->R);
  double own[3]; /* the body's axes */
  mpsi_rotate_back(pose->R, def->spin, own);
  for (int c = 0; c < 3; c++) own[c] *= def->inertia[c];
  mpsi_rotate(pose->R, own, body->angular);
}

/* Turns a free body in 3D for dt under its angular momentum L, which stays: the energy of rotation,
 * sum (L . e_i)^2/(2 I_i) over the body's axes e_i, is split into L^2/(2 I_m), whose motion is a
 * rotation about L, and two rests (L . e_i)^2 (1/I_i - 1/I_m)/2, whose motions are rotations about
 * e_i, in a symmetric order. Each is exact, so that the step is symplectic, explicit and of second
 * order; with I_m the middle one, a body with two equal inertias moves exactly. */
static void turn(mps_body *body, double dt) {
  const double *I = body->def.inertia, *L = body->angular;
  double *R = body->pose.R;
  int m = 0;
  for (int k = 1; k < 3; k++)
    if ((I[k] - I[m]) * (I[k] - I[(3 - m - k)]) <= 0.0) m = k;
  const double by = dt / I[m], about[3] = {by * L[0], by * L[1], by * L[2]};
  mpsi_rotation_turn(about, R);
  const int axis[3] = {(m + 1) % 3, (m + 2) % 3, (m + 1) % 3};
  for (int k = 0; k < 3; k++) {
    const int i = axis[k];
    const double along = R[i] * L[0] + R[3 + i] * L[1] + R[6 + i] * L[2];
    const double rate = along * (1.0 / I[i] - 1.0 / I[m]);
    mpsi_rotation_turn_own(i, (k == 1 ? 1.0 : 0.5) * dt * rate, R);
  }
  mpsi_rotation_clean(R);
  double own[3];
  mpsi_rotate_back(R, L, own);
  for (int c = 0; c < 3; c++) own[c] /= I[c];
  mpsi_rotate(R, own, body->pose.spin);
}

void mpsi_body_advance(mps_body *body, double dt) {
  const mps_body_def *def = &body->def;
  mpsi_pose *pose = &body->pose;
  body->time += dt;
  if (def->motion == MPS_MOTION_PRESCRIBED) {
    follow(body);
    return;
  }
  mpsi_load sum = body->load;
  for (int32_t part = 0; part < body->parts; part++)
    for (int c = 0; c < 3; c++) {
      sum.force[c] += body->reaction[part].force[c];
      sum.moment[c] += body->reaction[part].moment[c];
    }
  for (int c = 0; c < 3; c++) { /* damping at the end of the step: stable for every dt */
    const double v = pose->v[c] + dt * (sum.force[c] / def->mass + def->gravity[c]);
    pose->v[c] = v / (1.0 + dt * def->damping[0]);
    pose->x[c] += dt * pose->v[c];
  }
  const double left = 1.0 + dt * def->damping[1];
  if (body->dim == 2) {
    pose->spin[2] = (pose->spin[2] + dt * (sum.moment[2] / def->inertia[2])) / left;
    set_angle(body, body->rotation[2] + dt * pose->spin[2]);
    return;
  }
  for (int c = 0; c < 3; c++) body->angular[c] = (body->angular[c] + dt * sum.moment[c]) / left;
  turn(body, dt);
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
  if (body->dim == 2 ? component != 0 && component != 1 && component != 5
                     : component < 0 || component >= MPSI_MOTIONS)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "component is %d, allowed are %s",
                     component,
                     body->dim == 2 ? "0 (x), 1 (y) and 5 (rotation)"
                                    : "0 to 2 (x, y, z) and 3 to 5 (rotation about x, y, z)");
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

mps_status mps_body_load(mps_body *body, const double *force, const double *moment) {
  if (!body) return MPS_ERROR_ARGUMENT;
  mpsi_load load = {{0}, {0}};
  if (force) memcpy(load.force, force, sizeof load.force);
  if (moment) memcpy(load.moment, moment, sizeof load.moment);
  for (int c = 0; c < 3; c++)
    if (!isfinite(load.force[c]) || !isfinite(load.moment[c]))
      return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                       "force[%d] is %g N and moment[%d] %g N m, must be finite", c, load.force[c],
                       c, load.moment[c]);
  if (body->def.motion != MPS_MOTION_FREE)
    return mpsi_fail(body->context, __func__, MPS_ERROR_STATE,
                     "a prescribed body takes no load: its motion is given");
  if (body->dim == 2 && (load.force[2] != 0.0 || load.moment[0] != 0.0 || load.moment[1] != 0.0))
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "force[2] is %g, moment[0] %g and moment[1] %g, must be 0 in 2D",
                     load.force[2], load.moment[0], load.moment[1]);
  body->load = load;
  return MPS_OK;
}

mps_status mps_body_get_state(mps_body *body, mps_body_state *out) {
  if (!body) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  const mpsi_pose *p = &body->pose;
  mps_body_state state = {.time = body->time};
  memcpy(state.position, p->x, sizeof p->x);
  memcpy(state.orientation, p->R, sizeof p->R);
  memcpy(state.velocity, p->v, sizeof p->v);
  memcpy(state.spin, p->spin, sizeof p->spin);
  memcpy(state.rotation, body->rotation, sizeof body->rotation);
  if (body->dim == 3 && body->def.motion == MPS_MOTION_FREE)
    mpsi_rotation_log(p->R, state.rotation);
  *out = state;
  return MPS_OK;
}

/* ---- reactions ------------------------------------------------------------------------------- */

void mpsi_body_react(mps_body *body, double dt, const mpsi_load *load, const int64_t *contacts) {
  for (int32_t part = 0; part < body->parts; part++) {
    mps_reaction *r = &body->reaction[part];
    for (int c = 0; c < 3; c++) {
      r->force[c] = load[part].force[c];
      r->moment[c] = load[part].moment[c];
      r->impulse[c] += dt * load[part].force[c];
      r->moment_impulse[c] += dt * load[part].moment[c];
    }
    r->count = contacts[part];
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
    for (int c = 0; c < 3; c++) {
      sum.force[c] += r->force[c];
      sum.moment[c] += r->moment[c];
      sum.impulse[c] += r->impulse[c];
      sum.moment_impulse[c] += r->moment_impulse[c];
    }
    sum.count += r->count;
  }
  *out = sum;
  return MPS_OK;
}

/* ---- records --------------------------------------------------------------------------------- */

enum { REACTION = 12 * sizeof(double) };
_Static_assert(offsetof(mps_reaction, count) == REACTION, "12 numbers, then the contacts");
_Static_assert(sizeof(mpsi_load) == 6 * sizeof(double), "force, then moment");

void mpsi_body_get_record(const mps_body *body, mpsi_body_record *out) {
  const mpsi_pose *p = &body->pose;
  *out = (mpsi_body_record){.shape = body->shape,
                            .faces = body->faces,
                            .motion = body->def.motion,
                            .parts = body->parts,
                            .time = body->time};
  memcpy(out->rotation, body->rotation, sizeof out->rotation);
  memcpy(out->angular, body->angular, sizeof out->angular);
  memcpy(out->load, &body->load, sizeof out->load);
  memcpy(out->position, p->x, sizeof out->position);
  memcpy(out->orientation, p->R, sizeof out->orientation);
  memcpy(out->velocity, p->v, sizeof out->velocity);
  memcpy(out->spin, p->spin, sizeof out->spin);
  for (int32_t part = 0; part < body->parts; part++) {
    memcpy(&out->reaction[12 * part], &body->reaction[part], REACTION);
    out->contacts[part] = body->reaction[part].count;
  }
}

void mpsi_body_set_record(mps_body *body, const mpsi_body_record *record) {
  mpsi_pose *p = &body->pose;
  body->time = record->time;
  memcpy(body->rotation, record->rotation, sizeof body->rotation);
  memcpy(body->angular, record->angular, sizeof body->angular);
  memcpy(&body->load, record->load, sizeof body->load);
  memcpy(p->x, record->position, sizeof p->x);
  memcpy(p->R, record->orientation, sizeof p->R);
  memcpy(p->v, record->velocity, sizeof p->v);
  memcpy(p->spin, record->spin, sizeof p->spin);
  for (int32_t part = 0; part < body->parts; part++) {
    memcpy(&body->reaction[part], &record->reaction[12 * part], REACTION);
    body->reaction[part].count = record->contacts[part];
  }
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
  if (first < 0 || first >= body->faces || count < 1 || count > body->faces)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "first is %lld and count %lld, allowed are 0 to %lld and 1 to %lld",
                     (long long)first, (long long)count, (long long)body->faces - 1,
                     (long long)body->faces);
  int32_t number = mps_body_part(body, name);
  if (number < 0) {
    if (body->parts == MPS_BODY_MAX_PARTS)
      return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                       "the body has %d named parts, the most there can be",
                       MPS_BODY_MAX_PARTS - 1);
    number = body->parts++;
    strcpy(body->names[number], name);
  }
  for (int64_t k = 0; k < count; k++) body->part_of[(first + k) % body->faces] = number;
  if (part) *part = number;
  return MPS_OK;
}

int32_t mps_body_part_count(const mps_body *body) { return body ? body->parts : 0; }

int32_t mps_body_part(const mps_body *body, const char *name) {
  for (int32_t k = 0; body && name && k < body->parts; k++)
    if (strcmp(body->names[k], name) == 0) return k;
  return -1;
}
