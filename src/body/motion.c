/* motion.c - motion of a rigid body: by signals, set by the caller, or by forces; its energies.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body_internal.h"

#include "contact_internal.h"
#include "core/context/retain.h"
#include "rotation.h"
#include "signal/signal_internal.h"

#include <string.h>

#define MOST_OF_RATES 2.0 /* way in a step over the larger of its first and last velocities */
#define ROUNDING 1e-9
#define JUMP 1e-3 /* of the displacement: by which a signal may differ from the one it replaces */

/* ---- motion ---------------------------------------------------------------------------------- */

/* 2D: the plane turned by `angle`. */
static void set_angle(mps_body *body, double angle) {
  const double cosine = cos(angle), sine = sin(angle);
  const double R[9] = {cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0};
  body->rotation[2] = angle;
  memcpy(body->pose.R, R, sizeof R);
}

/* A component of the motion that a signal (NULL: none) and its factor prescribe at time t. */
static mps_status find_course(const mps_body *body, mpsi_signal_use use, mps_signal *signal,
                              double factor, double t, mpsi_course *out) {
  const int c = use.component;
  mpsi_signal_motion m;
  MPSI_TRY(mpsi_signal_evaluate(signal, use, t, &m));
  const double first = c < 3 ? body->def.position[c] : body->def.rotation[c - 3];
  out->at[c] = signal ? first + factor * m.u : first;
  out->rate[c] = signal ? factor * m.v : 0.0;
  if (fabs(out->at[c]) <= MPSI_BODY_FAR && fabs(out->rate[c]) <= MPSI_BODY_FAR) return MPS_OK;
  return mpsi_fail(body->context, use.function, MPS_ERROR_ARGUMENT,
                   "factor is %g: the signal of component %d moves the body to %g at a rate of %g, "
                   "both must be at most %g (m, rad; per s) at t = %g s",
                   factor, c, out->at[c], out->rate[c], MPSI_BODY_FAR, t);
}

/* All components but `besides` (-1: all). */
static mps_status find_courses(const mps_body *body, mpsi_signal_use use, int besides, double t,
                               mpsi_course *out) {
  mps_status status = MPS_OK;
  for (int c = 0; c < MPSI_MOTIONS && status == MPS_OK; c++) {
    use.component = c;
    if (c != besides) status = find_course(body, use, body->signal[c], body->factor[c], t, out);
  }
  return status;
}

static mpsi_signal_use used_by(const mps_body *body, const char *function) {
  return (mpsi_signal_use){body->context, function, "body", -1, 0};
}

/* Logs, once a body, that a component of the motion is elsewhere after dt (s; 0: at once) than its
 * velocities lead. */
static void warn_of_jump(mps_body *body, const mpsi_course *course, double dt) {
  for (int c = 0; c < MPSI_MOTIONS && !body->jumped; c++) {
    if (body->dim == 2 && c != 0 && c != 1 && c != 5) continue;
    const double now = c < 3 ? body->pose.x[c] : body->rotation[c - 3], next = course->at[c];
    const double rate = c < 3 ? body->pose.v[c] : body->pose.spin[c - 3];
    const double first = c < 3 ? body->def.position[c] : body->def.rotation[c - 3];
    const double way = MOST_OF_RATES * dt * (fabs(rate) + fabs(course->rate[c]));
    if (fabs(next - now) <= way + ROUNDING * (fabs(now) + fabs(next)) +
                                JUMP * fmax(fabs(now - first), fabs(next - first)))
      continue;
    body->jumped = true;
    mpsi_log(body->context, MPS_CONTEXT_LOG_WARNING,
             "body: component %d jumps from %g to %g (m, rad) at t = %g s: the displacement of a "
             "signal counts from time 0, and from the place of the body's definition, where one "
             "without a signal is",
             c, now, next, body->time);
  }
}

/* Sets the body to the pose of its signals. */
static void follow(mps_body *body, const mpsi_course *course) {
  const double *at = course->at, *rate = course->rate;
  mpsi_pose *pose = &body->pose;
  body->outside = false;
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

/* Angular momentum in space of a free body in 3D that has its orientation and spin. */
static void find_angular(mps_body *body) {
  double own[3]; /* the body's axes */
  mpsi_rotate_back(body->pose.R, body->pose.spin, own);
  for (int c = 0; c < 3; c++) own[c] *= body->def.inertia[c];
  mpsi_rotate(body->pose.R, own, body->angular);
}

/* And its spin, from the angular momentum. */
static void find_spin(const mps_body *body, double *spin) {
  double own[3];
  mpsi_rotate_back(body->pose.R, body->angular, own);
  for (int c = 0; c < 3; c++) own[c] /= body->def.inertia[c];
  mpsi_rotate(body->pose.R, own, spin);
}

void mpsi_body_begin(mps_body *body) {
  const mps_body_def *def = &body->def;
  if (def->motion == MPS_BODY_MOTION_DRIVEN) {
    mpsi_course rest = {{0}, {0}}; /* without signals */
    for (int c = 0; c < 3; c++) rest.at[c] = def->position[c], rest.at[3 + c] = def->rotation[c];
    follow(body, &rest);
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
  find_angular(body);
}

/* Rotates a free body in 3D for dt under its angular momentum L, which is constant: the energy of
 * rotation, sum (L . e_i)^2/(2 I_i) over the body's axes e_i, is split into L^2/(2 I_m), whose
 * motion is a rotation about L, and two rests (L . e_i)^2 (1/I_i - 1/I_m)/2, whose motions are
 * rotations about e_i, in a symmetric order. Each is exact, so that the step is symplectic,
 * explicit and of second order; with I_m the middle one, a body with two equal inertias moves
 * exactly. */
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
  find_spin(body, body->pose.spin);
}

/* A prescribed body whose motion was set continues with its velocity and spin. */
static void coast(mps_body *body, double dt) {
  mpsi_pose *pose = &body->pose;
  for (int c = 0; c < 3; c++) pose->x[c] += dt * pose->v[c];
  if (body->dim == 2) {
    set_angle(body, body->rotation[2] + dt * pose->spin[2]);
    return;
  }
  const double by[3] = {dt * pose->spin[0], dt * pose->spin[1], dt * pose->spin[2]};
  mpsi_rotation_turn(by, pose->R);
  mpsi_rotation_clean(pose->R);
  mpsi_rotation_log(pose->R, body->rotation);
}

/* Velocity of a free body after dt of force, and the work done: of a force F that takes v to v',
 * the work is dt F (v + v')/2. Damping at the end of the step: stable for every dt. */
static void advance_velocity(mps_body *body, const mpsi_load *contact, double dt) {
  const mps_body_def *def = &body->def;
  mpsi_pose *pose = &body->pose;
  for (int c = 0; c < 3; c++) {
    if (!mpsi_body_moves_along(body, c)) continue;
    const double load = body->load.force[c], before = pose->v[c];
    const double v = before + dt * ((load + contact->force[c]) / def->mass + def->gravity[c]);
    const double middle = body->middle_v[c] = 0.5 * (before + v);
    body->work_contacts += dt * contact->force[c] * middle;
    body->work_loads += dt * (load + def->mass * def->gravity[c]) * middle;
    pose->v[c] = v / (1.0 + dt * def->damping[0]);
    body->dissipated += 0.5 * def->mass * (v * v - pose->v[c] * pose->v[c]);
    pose->x[c] += dt * pose->v[c];
  }
}

static void spin_in_plane(mps_body *body, const mpsi_load *contact, double dt) {
  const double I = body->def.inertia[2], before = body->pose.spin[2], load = body->load.moment[2];
  const double w = before + dt * ((load + contact->moment[2]) / I);
  const double middle = body->middle_spin[2] = 0.5 * (before + w);
  body->work_contacts += dt * contact->moment[2] * middle;
  body->work_loads += dt * load * middle;
  body->pose.spin[2] = w / (1.0 + dt * body->def.damping[1]);
  body->dissipated += 0.5 * I * (w * w - body->pose.spin[2] * body->pose.spin[2]);
  set_angle(body, body->rotation[2] + dt * body->pose.spin[2]);
}

static void spin_in_space(mps_body *body, const mpsi_load *contact, double dt) {
  const double left = 1.0 + dt * body->def.damping[1];
  double before[3], after[3];
  memcpy(before, body->pose.spin, sizeof before);
  for (int c = 0; c < 3; c++) body->angular[c] += dt * (body->load.moment[c] + contact->moment[c]);
  find_spin(body, after);
  const double energy = 0.5 * mpsi_dot3(body->angular, after);
  for (int c = 0; c < 3; c++) {
    const double middle = body->middle_spin[c] = 0.5 * (before[c] + after[c]);
    body->work_contacts += dt * contact->moment[c] * middle;
    body->work_loads += dt * body->load.moment[c] * middle;
    body->angular[c] /= left;
  }
  turn(body, dt);
  body->dissipated += energy - 0.5 * mpsi_dot3(body->angular, body->pose.spin);
}

mps_status mpsi_body_look_ahead(mps_body *body, const char *function, int32_t number, double dt) {
  mpsi_signal_use use = used_by(body, function);
  use.number = number;
  if (body->def.motion != MPS_BODY_MOTION_DRIVEN || body->outside) return MPS_OK;
  MPSI_TRY(find_courses(body, use, -1, body->time + dt, &body->ahead));
  warn_of_jump(body, &body->ahead, dt);
  return MPS_OK;
}

void mpsi_body_advance(mps_body *body, double dt) {
  body->time += dt;
  memcpy(body->middle_v, body->pose.v, sizeof body->middle_v);
  memcpy(body->middle_spin, body->pose.spin, sizeof body->middle_spin);
  if (body->def.motion == MPS_BODY_MOTION_DRIVEN) {
    if (body->outside)
      coast(body, dt);
    else
      follow(body, &body->ahead);
    return;
  }
  mpsi_load contact = body->pending;
  for (int c = 0; c < 3; c++) contact.force[c] /= dt, contact.moment[c] /= dt;
  memset(&body->pending, 0, sizeof body->pending);
  advance_velocity(body, &contact, dt);
  if (body->axial) return;
  if (body->dim == 2)
    spin_in_plane(body, &contact, dt);
  else
    spin_in_space(body, &contact, dt);
}

/* Squares of more overflow in energies. */
static bool is_sane(const mpsi_pose *pose) {
  bool sane = true;
  for (int c = 0; c < 3; c++)
    sane = sane && fabs(pose->x[c]) <= 1e100 && fabs(pose->v[c]) <= 1e100 &&
           fabs(pose->spin[c]) <= 1e100;
  for (int k = 0; k < 9; k++) sane = sane && isfinite(pose->R[k]);
  return sane;
}

mps_status mpsi_body_check_mover(const mps_body *body, const char *function) {
  if (!mpsi_body_mover(body)) return MPS_OK;
  return mpsi_fail(body->context, function, MPS_ERROR_STATE,
                   "another solver moves the body: make this contact with the mover "
                   "MPS_CONTACT_MOVER_OTHER");
}

mps_status mps_body_advance(mps_body *body, double dt) {
  if (!body) return mpsi_null(__func__, "body");
  if (!isfinite(dt) || dt <= 0.0)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "dt is %g s, must be finite and > 0", dt);
  if (mpsi_body_mover(body))
    return mpsi_fail(body->context, __func__, MPS_ERROR_STATE,
                     "a solver moves this body: end that contact first, or make it with the mover "
                     "MPS_CONTACT_MOVER_OTHER");
  MPSI_TRY(mpsi_body_look_ahead(body, __func__, -1, dt));
  const mps_body before = *body;
  mpsi_body_advance(body, dt);
  if (is_sane(&body->pose)) return MPS_OK;
  const double speed = body->pose.v[0];
  *body = before;
  return mpsi_fail(body->context, __func__, MPS_ERROR_DIVERGED,
                   "after dt = %g s the body would be beyond 1e100 m, m/s or rad/s (velocity along "
                   "x %g m/s): it stays where it was",
                   dt, speed);
}

mps_status mps_body_drive(mps_body *body, int32_t component, mps_signal *signal, double factor) {
  if (!body) return mpsi_null(__func__, "body");
  if (body->dim == 2 ? component != 0 && component != 1 && component != 5
                     : component < 0 || component >= MPSI_MOTIONS)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "component is %d, allowed are %s",
                     component,
                     body->dim == 2 ? "0 (x), 1 (y) and 5 (rotation)"
                                    : "0 to 2 (x, y, z) and 3 to 5 (rotation about x, y, z)");
  if (!isfinite(factor))
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "factor is %g, must be finite",
                     factor);
  if (body->def.motion != MPS_BODY_MOTION_DRIVEN)
    return mpsi_fail(body->context, __func__, MPS_ERROR_STATE,
                     "a free body follows no signal: use mps_body_set_load");
  mpsi_signal_use use = used_by(body, __func__);
  mpsi_course course;
  mps_status status = mpsi_signal_check(body->context, __func__, MPSI_SIGNAL_MOTION, 1, &signal);
  if (status == MPS_OK) status = find_courses(body, use, component, body->time, &course);
  use.component = component;
  if (status == MPS_OK) status = find_course(body, use, signal, factor, body->time, &course);
  if (status != MPS_OK) return status;
  mps_signal *old = body->signal[component];
  body->signal[component] = signal ? mpsi_signal_retain(signal) : NULL;
  body->factor[component] = factor;
  mps_signal_destroy(&old);
  if (body->time > 0.0) warn_of_jump(body, &course, 0.0);
  follow(body, &course);
  return MPS_OK;
}

/* ---- motion from outside --------------------------------------------------------------------- */

mps_status mpsi_body_check_axial(mps_context *context, const char *function, const double *velocity,
                                 const double *spin, const double *gravity) {
  if (velocity[0] == 0.0 && spin[2] == 0.0 && gravity[0] == 0.0) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "velocity[0] is %g m/s, spin[2] %g rad/s and gravity[0] %g m/s2: a free body in "
                   "axisymmetry moves along its axis alone, they must be 0",
                   velocity[0], spin[2], gravity[0]);
}

mps_status mps_body_set_motion(mps_body *body, const mps_body_motion *user_motion) {
  if (!body) return mpsi_null(__func__, "body");
  const bool free_body = body->def.motion == MPS_BODY_MOTION_FREE;
  mps_body_motion motion = mps_body_motion_defaults();
  if (!user_motion && free_body)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "motion is NULL, and a free body follows no signals");
  if (!user_motion) {
    mpsi_course course;
    const mps_status status = find_courses(body, used_by(body, __func__), -1, body->time, &course);
    if (status == MPS_OK) follow(body, &course);
    return status;
  }
  MPSI_TRY(MPSI_DEF_READ_IN(body->context, __func__, mps_body_motion, user_motion,
                            mpsi_scene_of(body->dim), &motion));
  if (free_body && body->axial)
    MPSI_TRY(mpsi_body_check_axial(body->context, __func__, motion.velocity, motion.spin,
                                   body->def.gravity));
  mpsi_pose *pose = &body->pose;
  body->outside = !free_body;
  memset(&body->pending, 0, sizeof body->pending);
  for (int c = 0; c < 3; c++) {
    if (!isnan(motion.position[c])) pose->x[c] = motion.position[c];
    pose->v[c] = motion.velocity[c], pose->spin[c] = motion.spin[c];
  }
  if (body->dim == 2 && !isnan(motion.rotation[2])) set_angle(body, motion.rotation[2]);
  if (body->dim == 3 && !isnan(motion.rotation[0])) {
    mpsi_rotation_exp(motion.rotation, pose->R);
    memcpy(body->rotation, motion.rotation, sizeof body->rotation);
  }
  if (body->dim == 3 && free_body) find_angular(body);
  return MPS_OK;
}

/* ---- loads ----------------------------------------------------------------------------------- */

mps_status mps_body_set_load(mps_body *body, const double *force, const double *moment) {
  if (!body) return mpsi_null(__func__, "body");
  mpsi_load load = {{0}, {0}};
  if (force) memcpy(load.force, force, sizeof load.force);
  if (moment) memcpy(load.moment, moment, sizeof load.moment);
  for (int c = 0; c < 6; c++) {
    const double value = c < 3 ? load.force[c] : load.moment[c - 3];
    if (!isfinite(value))
      return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "%s[%d] is %g, must be finite",
                       c < 3 ? "force" : "moment", c % 3, value);
  }
  if (body->def.motion != MPS_BODY_MOTION_FREE)
    return mpsi_fail(body->context, __func__, MPS_ERROR_STATE,
                     "a driven body takes no load: make it free (MPS_BODY_MOTION_FREE)");
  if (body->dim == 2 && (load.force[2] != 0.0 || load.moment[0] != 0.0 || load.moment[1] != 0.0))
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "force[2], moment[0] and moment[1] are %g, %g and %g, must be 0 in 2D",
                     load.force[2], load.moment[0], load.moment[1]);
  if (body->axial && (load.force[0] != 0.0 || load.moment[2] != 0.0))
    return mpsi_fail(
        body->context, __func__, MPS_ERROR_ARGUMENT,
        "force[0] is %g N and moment[2] %g N m: a free body in axisymmetry moves along "
        "its axis alone, they must be 0",
        load.force[0], load.moment[2]);
  body->load = load;
  return MPS_OK;
}

mps_status mps_body_get_state_sized(const mps_body *body, mps_body_state *out, size_t size) {
  if (!body) return mpsi_null(__func__, "body");
  const mpsi_pose *p = &body->pose;
  mps_body_state state = {.time = body->time};
  memcpy(state.position, p->x, sizeof p->x);
  memcpy(state.orientation, p->R, sizeof p->R);
  memcpy(state.velocity, p->v, sizeof p->v);
  memcpy(state.spin, p->spin, sizeof p->spin);
  memcpy(state.rotation, body->rotation, sizeof body->rotation);
  if (body->dim == 3 && body->def.motion == MPS_BODY_MOTION_FREE)
    mpsi_rotation_log(p->R, state.rotation);
  return mpsi_out_write(body->context, "mps_body_get_state", out, size, &state, sizeof state);
}

mps_status mps_body_get_totals_sized(const mps_body *body, mps_body_totals *out, size_t size) {
  if (!body) return mpsi_null(__func__, "body");
  const mpsi_pose *p = &body->pose;
  mps_body_totals t = {.mass = body->def.mass,
                       .work_contacts = body->work_contacts,
                       .work_loads = body->work_loads,
                       .dissipated = body->dissipated};
  double own[3] = {0.0, 0.0, body->def.inertia[2] * p->spin[2]};
  if (body->dim == 3) memcpy(own, body->angular, sizeof own);
  for (int c = 0; c < 3; c++) t.linear[c] = t.mass * p->v[c];
  mpsi_cross3(p->x, t.linear, t.angular);
  for (int c = 0; c < 3; c++) t.angular[c] += own[c];
  t.kinetic = 0.5 * (mpsi_dot3(t.linear, p->v) + mpsi_dot3(own, p->spin));
  return mpsi_out_write(body->context, "mps_body_get_totals", out, size, &t, sizeof t);
}
