/* rigid.c - see rigid.h. SPDX-License-Identifier: BSD-3-Clause */
#include "rigid.h"

#include <math.h>
#include <stdint.h>

#define MOST_MISFIT 0.05 /* of the vertices' extent */

typedef struct rigid {
  app *a;
  mps_mpm *mpm;
  mps_body *body;
  const rigid_def *def;
  double centre[2];              /* m, of the vertices at the start */
  double inertia;                /* m2: sum of the squares of their distances from it */
  double reference[2], rotation; /* position and angle of the body at the start */
  mps_snapshot *checkpoint;
} rigid;

/* Position of the body's reference point and angle from the displacements: the rotation by which
 * the sum of squared distances of turned and displaced vertices is least. */
static bool fit(const rigid *r, double near, const double *moved, double *position, double *angle) {
  const double *x = r->def->x, pi = 3.14159265358979323846;
  double mean[2] = {0.0, 0.0}, cosine = 0.0, sine = 0.0, misfit = 0.0;
  const double n = (double)r->def->count;
  for (int64_t k = 0; k < r->def->count; k++)
    for (int c = 0; c < 2; c++) mean[c] += (x[2 * k + c] + moved[2 * k + c]) / n;
  for (int64_t k = 0; k < r->def->count; k++) {
    const double p = x[2 * k] - r->centre[0], q = x[2 * k + 1] - r->centre[1];
    const double s = x[2 * k] + moved[2 * k] - mean[0],
                 t = x[2 * k + 1] + moved[2 * k + 1] - mean[1];
    cosine += p * s + q * t, sine += p * t - q * s;
  }
  double turn = r->def->count > 1 ? atan2(sine, cosine) : 0.0;
  turn += 2.0 * pi * round((near - r->rotation - turn) / (2.0 * pi));
  const double co = cos(turn), si = sin(turn);
  for (int64_t k = 0; k < r->def->count; k++) {
    const double p = x[2 * k] - r->centre[0], q = x[2 * k + 1] - r->centre[1];
    misfit = fmax(misfit, hypot(mean[0] + co * p - si * q - x[2 * k] - moved[2 * k],
                                mean[1] + si * p + co * q - x[2 * k + 1] - moved[2 * k + 1]));
  }
  if (misfit > MOST_MISFIT * sqrt(r->inertia / n))
    return app_error(
        r->a,
        "%s of the coupling is not the motion of a rigid body: a vertex is %.3g m off, "
        "at most %.3g m are allowed",
        r->def->displacement, misfit, MOST_MISFIT * sqrt(r->inertia / n));
  const double p = r->reference[0] - r->centre[0], q = r->reference[1] - r->centre[1];
  position[0] = mean[0] + co * p - si * q, position[1] = mean[1] + si * p + co * q;
  *angle = r->rotation + turn;
  return true;
}

/* The motion that ends at the given position after dt. */
static bool drive(rigid *r, const double *moved, double dt) {
  mps_body_motion motion = mps_body_motion_defaults();
  mps_body_state now;
  double end[2] = {0.0, 0.0}, angle = 0.0;
  if (!app_check(r->a, mps_body_get_state(r->body, &now)) ||
      !fit(r, now.rotation[2], moved, end, &angle))
    return false;
  for (int c = 0; c < 2; c++) motion.velocity[c] = (end[c] - now.position[c]) / dt;
  motion.spin[2] = (angle - now.rotation[2]) / dt;
  return app_check(r->a, mps_body_set_motion(r->body, &motion));
}

/* Forces with the given sum and moment about the body's reference point on the present vertices. */
static bool spread(const rigid *r, const double *moved, const double *sum, double moment,
                   double *out) {
  const int64_t n = r->def->count;
  double mean[2] = {0.0, 0.0};
  mps_body_state now;
  if (!app_check(r->a, mps_body_get_state(r->body, &now))) return false;
  for (int64_t k = 0; k < n; k++)
    for (int c = 0; c < 2; c++) mean[c] += (r->def->x[2 * k + c] + moved[2 * k + c]) / (double)n;
  const double arm[2] = {now.position[0] - mean[0], now.position[1] - mean[1]};
  moment += arm[0] * sum[1] - arm[1] * sum[0];
  for (int64_t k = 0; k < n; k++) {
    const double p = r->def->x[2 * k] + moved[2 * k] - mean[0],
                 q = r->def->x[2 * k + 1] + moved[2 * k + 1] - mean[1];
    const double turn = n > 1 ? moment / r->inertia : 0.0;
    out[2 * k] = sum[0] / (double)n - turn * q;
    out[2 * k + 1] = sum[1] / (double)n + turn * p;
  }
  return true;
}

static bool step(void *self, double dt, double *const *read, double *const *written) {
  rigid *r = self;
  mps_reaction before, after;
  if (!drive(r, read[0], dt) || !app_check(r->a, mps_body_get_reaction(r->body, -1, &before)) ||
      !app_check(r->a, mps_mpm_run(r->mpm, mps_mpm_time(r->mpm) + dt, INT64_MAX, NULL, NULL)) ||
      !app_check(r->a, mps_body_get_reaction(r->body, -1, &after)))
    return false;
  const double sum[2] = {(after.impulse[0] - before.impulse[0]) / dt,
                         (after.impulse[1] - before.impulse[1]) / dt};
  const double moment = (after.moment_impulse[2] - before.moment_impulse[2]) / dt;
  return spread(r, read[0], sum, moment, written[0]);
}

/* Before the first step: the force of the soil's last step. */
static bool begin(void *self, double *const *written) {
  rigid *r = self;
  mps_reaction now;
  return app_check(r->a, mps_body_get_reaction(r->body, -1, &now)) &&
         spread(r, written[0], now.force, now.moment[2], written[0]);
}

static bool save(void *self) {
  rigid *r = self;
  return app_check(r->a, mps_mpm_snapshot(r->mpm, &r->checkpoint));
}

static bool undo(void *self) {
  rigid *r = self;
  return app_check(r->a, mps_mpm_rollback(r->mpm, r->checkpoint));
}

static bool each(void *self) {
  rigid *r = self;
  return !r->def->each || r->def->each(r->def->user, r->mpm);
}

static bool measure(rigid *r) {
  const double *x = r->def->x, n = (double)r->def->count;
  mps_body_state now;
  if (mps_body_dim(r->body) != 2)
    return app_error(r->a, "a body of %d dimensions in the coupling, must have 2",
                     mps_body_dim(r->body));
  if (!app_check(r->a, mps_body_get_state(r->body, &now))) return false;
  for (int64_t k = 0; k < r->def->count; k++)
    for (int c = 0; c < 2; c++) r->centre[c] += x[2 * k + c] / n;
  for (int64_t k = 0; k < r->def->count; k++)
    for (int c = 0; c < 2; c++)
      r->inertia += (x[2 * k + c] - r->centre[c]) * (x[2 * k + c] - r->centre[c]);
  for (int c = 0; c < 2; c++) r->reference[c] = now.position[c];
  r->rotation = now.rotation[2];
  return r->def->count == 1 || r->inertia > 0.0 ||
         app_error(r->a, "the %lld vertices of the body lie in one point, must be apart",
                   (long long)r->def->count);
}

bool rigid_run(app *a, mps_mpm *mpm, mps_body *body, const rigid_def *def,
               participant_result *result) {
  rigid r = {.a = a, .mpm = mpm, .body = body, .def = def};
  const loop_side side = {.self = &r,
                          .dim = 2,
                          .count = def->count,
                          .x = def->x,
                          .dt = def->dt,
                          .reads = {def->displacement},
                          .writes = {def->force},
                          .step = step,
                          .begin = begin,
                          .save = save,
                          .undo = undo,
                          .each = each};
  const bool good = measure(&r) && loop_run(a, &side, def->config, def->name, def->mesh, result);
  mps_snapshot_destroy(&r.checkpoint);
  return good;
}
