/* afloat.c - floating bodies. In each step the accelerations a (two of the reference point and one
 * of the rotation, times a length) solve the balance of pressure, loads and inertia:
 *
 *   F(a) + loads - M a = 0,  M the body's masses.
 *
 * F is linear in a but for suction that is cut off: F = F0 - M_a a, M_a the added masses. So
 * Newton's method with E = M + M_a is stable however light the body is. E is updated by the
 * solutions (Broyden 1965) and kept from step to step, so that two or three solutions are enough.
 *
 * The pressure acts through the step: velocity first, then place, as the particles move
 * (mpsi_body_advance). SPDX-License-Identifier: BSD-3-Clause */
#include "afloat.h"
#include "fluid/base/flow_solver.h"
#include "fluid/base/access.h"
#include "fluid/boundary/pose.h"
#include "fluid/reading/probe.h"

#include "body/body_internal.h"
#include "domain/domain_internal.h"

#include <stdio.h>
#include <string.h>

#define REPEATS 40      /* most solutions a step */
#define WHOLE 10        /* of them with whole steps: where suction is cut off they may cycle */
#define AGREED 2e-4     /* of the acceleration */
#define FLOOR 2e-5      /* of gravity */
#define FIRST_ADDED 1.0 /* of the displaced mass: initial added mass */

bool mpsi_fluid_any_afloat(const mps_fluid *f) {
  for (int b = 0; b < f->bodies; b++)
    if (f->body[b].floats) return true;
  return false;
}

/* ---- one body -------------------------------------------------------------------------------- */

/* Masses by component, kg. */
static void masses(const mpsi_fluid_body *body, double length, double *mass) {
  mass[0] = mass[1] = body->body->def.mass;
  mass[2] = body->body->def.inertia[2] / (length * length);
}

/* What the drag of a surface of no slip opposes to accelerations within a step, kg by component:
 * half a spacing of water between surface and particles. The drag itself is that of the velocity
 * before, and turned a light disc to and fro ever faster. */
static void drag_masses(const mps_fluid *f, const mpsi_fluid_body *own, double length,
                        double *mass) {
  const double share = 2.0 * f->def.viscosity / f->def.density * f->dt / (f->l0 * f->l0);
  double along = 0.0, square = 0.0;
  for (int k = 0; k < own->faces; k++) {
    const double *x = own->body->xy + 2 * k;
    if (f->wall[own->first + k].sticky) along += f->wall[own->first + k].length;
    square = fmax(x[0] * x[0] + x[1] * x[1], square);
  }
  mass[0] = mass[1] = share * f->def.density * f->l0 * f->def.measure * along;
  mass[2] = mass[0] * square / (length * length);
}

/* Residual of the forces in a step of dt with these accelerations. Forces of other solvers are
 * their impulses on the body since its last step; collisions with the water are those of the
 * previous step. */
static void imbalance(const mpsi_fluid_body *own, const double *mass, double length, double dt,
                      double *g) {
  const mps_body *body = own->body;
  for (int c = 0; c < 2; c++)
    g[c] =
        body->load.force[c] + body->def.mass * body->def.gravity[c] + body->pending.force[c] / dt;
  g[2] = (body->load.moment[2] + body->pending.moment[2] / dt) / length;
  for (int32_t part = 0; part < body->parts; part++) {
    const mpsi_part_load *by = &own->source->part[part];
    for (int c = 0; c < 2; c++) g[c] += by->force.force[c] + by->impulse.force[c] / dt;
    g[2] += (by->force.moment[2] + by->impulse.moment[2] / dt) / length;
  }
  for (int c = 0; c < 3; c++) g[c] -= mass[c] * own->rate[c];
}

/* Masses with initial added ones. */
static void first_guess(const mps_fluid *f, mpsi_fluid_body *own, const double *mass,
                        double length) {
  const double displaced =
      FIRST_ADDED * f->def.density * f->def.measure * 3.141592653589793 * length * length;
  memset(own->mass, 0, sizeof own->mass);
  for (int c = 0; c < 3; c++) own->mass[4 * c] = mass[c] + displaced * (c < 2 ? 1.0 : 0.25);
}

/* x of E x = g, by Cramer's rule; false where E is not positive definite. */
static bool solve3(const double *E, const double *g, double *x) {
  const double minor[3] = {E[4] * E[8] - E[5] * E[7], E[5] * E[6] - E[3] * E[8],
                           E[3] * E[7] - E[4] * E[6]};
  const double det = E[0] * minor[0] + E[1] * minor[1] + E[2] * minor[2];
  if (!(det > 1e-6 * fabs(E[0] * E[4] * E[8]))) return false;
  for (int c = 0; c < 3; c++) {
    double A[9];
    memcpy(A, E, sizeof A);
    for (int r = 0; r < 3; r++) A[3 * r + c] = g[r];
    x[c] = (A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
            A[2] * (A[3] * A[7] - A[4] * A[6])) /
           det;
  }
  return true;
}

/* Update of E by the change of g over that of a. */
static void learn(double *E, const double *da, const double *dg) {
  const double square = da[0] * da[0] + da[1] * da[1] + da[2] * da[2];
  if (!(square > 0.0)) return;
  for (int r = 0; r < 3; r++) {
    const double miss = -dg[r] - (E[3 * r] * da[0] + E[3 * r + 1] * da[1] + E[3 * r + 2] * da[2]);
    for (int c = 0; c < 3; c++) E[3 * r + c] += miss * da[c] / square;
  }
}

/* Checks the last solution: true where the body's accelerations are in balance with it; else sets
 * the next iterate. `tried` and `missed` of the body are the previous iterate, if any. The body
 * then moves with exactly these accelerations, with which the pressure was solved: the residual of
 * forces is assigned to the water. */
static bool judge(const mps_fluid *f, mpsi_fluid_body *own, int repeat) {
  const double length = mpsi_fluid_body_length(own, f);
  double mass[3], drag[3], g[3], step[3], largest = 0.0, change = 0.0;
  masses(own, length, mass);
  drag_masses(f, own, length, drag);
  for (int c = 0; c < 3; c++) mass[c] += drag[c];
  mpsi_fluid_load_body(f, own, own->pose.x);
  imbalance(own, mass, length, f->dt, g);
  if (!(own->mass[0] > 0.0)) first_guess(f, own, mass, length);
  if (repeat > 0) {
    double da[3], dg[3];
    for (int c = 0; c < 3; c++) da[c] = own->rate[c] - own->tried[c], dg[c] = g[c] - own->missed[c];
    learn(own->mass, da, dg);
  }
  if (!solve3(own->mass, g, step)) {
    first_guess(f, own, mass, length);
    (void)solve3(own->mass, g, step);
  }
  for (int c = 0; c < 3; c++) {
    largest = fmax(largest, fabs(own->rate[c]));
    change = fmax(change, fabs(step[c]));
  }
  const double g_size = hypot(own->body->def.gravity[0], own->body->def.gravity[1]);
  if (change <= AGREED * largest + FLOOR * fmax(g_size, f->g)) {
    for (int c = 0; c < 3; c++) g[c] += drag[c] * own->rate[c];
    for (int c = 0; c < 2; c++) own->source->part[0].force.force[c] -= g[c];
    own->source->part[0].force.moment[2] -= length * g[2];
    return true;
  }
  memcpy(own->tried, own->rate, sizeof own->tried);
  memcpy(own->missed, g, sizeof own->missed);
  for (int c = 0; c < 3; c++) own->rate[c] += (repeat < WHOLE ? 1.0 : 0.5) * step[c];
  return false;
}

/* ---- a step ---------------------------------------------------------------------------------- */

/* Water in a gap of less than a spacing is no longer particles: why they do not agree, or "". */
static void find_gap(const mps_fluid *f, size_t size, char *text) {
  double least = f->l0;
  text[0] = '\0';
  for (int n = 0; n < f->bodies; n++)
    for (int k = 0; f->body[n].floats && k < f->body[n].faces; k++)
      for (int b = 0; b < f->boundaries; b++) {
        double x[2];
        mpsi_fluid_corner(&f->body[n], false, k, x);
        if (!f->wall[b].used || f->wall[b].line) continue;
        const double gap = mpsi_fluid_distance(&f->wall[b], f->wall[b].now.s, x[0], x[1]);
        if (!(gap < least)) continue;
        least = gap;
        snprintf(
            text, size,
            ": body %d is %.3g m from boundary %d, less than the spacing, and no boundary holds "
            "a body",
            n, gap, b);
      }
}

mps_status mpsi_fluid_solve_afloat(mps_fluid *f, const char *function) {
  for (int repeat = 0; repeat < REPEATS; repeat++) {
    mpsi_fluid_drive_bodies(f, f->dt);
    f->stage = MPSI_FLUID_BEGUN;
    mps_status status = mpsi_fluid_solve_pressure(f, function);
    f->stage = MPSI_FLUID_SOLVED;
    if (status == MPS_OK) status = mpsi_fluid_load_walls(f, function);
    if (status != MPS_OK) return status;
    bool agreed = true;
    for (int b = 0; b < f->bodies; b++)
      if (f->body[b].floats) agreed &= judge(f, &f->body[b], repeat);
    if (agreed) return MPS_OK;
  }
  char gap[160];
  find_gap(f, sizeof gap, gap);
  return mpsi_fail(f->context, function, MPS_ERROR_NUMERIC,
                   "step %lld, t = %g s: the bodies afloat and the water have not agreed in %d "
                   "solutions%s; the step is not made",
                   (long long)f->steps, f->time, REPEATS, gap);
}
