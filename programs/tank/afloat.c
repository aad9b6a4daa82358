/* afloat.c - a box that floats in the middle of the tank: the box itself, and the period of its
 * heave by linear potential flow.
 *
 * The box goes up and down as V e^{iwt}. By symmetry half of the tank does: a gap 0 < x < a of
 * depth d beside the box, and a slit a < x < c of depth s below it. There
 *
 *   phi = sum A_n X_n(x) Z_n(y),  Z_0 = cosh(k_0 y), Z_n = cos(k_n y), w^2 = g k_0 tanh(k_0 d)
 *                                 = -g k_n tan(k_n d), X_n' = 0 at the tank's wall,
 *   phi = V [(y^2 - (x - c)^2)/(2 s) + sum B_m cosh(m pi (x - c)/s) cos(m pi y/s)].
 *
 * At x = a both agree below the box, and beside it the normal velocity is 0. The pressure of the
 * slit upon the box gives the added mass, w^2 (M + M_a(w)) = rho g (half its width) the frequency.
 * d and s are those of the mean position of the heave.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "tank.h"

#include <math.h>

/* ---- the box --------------------------------------------------------------------------------- */

mps_status tank_make_box(mps_context *context, tank_model *m) {
  const tank_settings *s = &m->s;
  const double height = 2.0 * s->draft;
  mps_body_def def = mps_body_defaults();
  def.motion = MPS_BODY_MOTION_FREE;
  def.position[0] = 0.5 * s->length, def.position[1] = s->depth;
  def.mass = WAVES_DENSITY * s->width * s->draft;
  def.inertia[2] = def.mass * (s->width * s->width + height * height) / 12.0;
  def.gravity[1] = -WAVES_G;
  return mps_body_create_box(context, &def, s->width, height, &m->box);
}

/* A weight on the box from the start, which lets it heave by the amplitude about its new rest. */
mps_status tank_launch(tank_model *m) {
  const double load[3] = {0.0, -m->s.amplitude * tank_float_stiffness(&m->s), 0.0};
  mps_fluid_contact_def def = mps_fluid_contact_defaults();
  def.kind = MPS_BOUNDARY_ROLLER;
  const mps_status status = mps_fluid_add_contact(m->fluid, m->box, &def, NULL);
  return status == MPS_OK ? mps_body_set_load(m->box, load, NULL) : status;
}

bool tank_in_box(const tank_settings *s, double x, double y) {
  return s->kind == TANK_FLOAT && fabs(x - 0.5 * s->length) < 0.5 * s->width &&
         y > s->depth - s->draft;
}

/* ---- theory ---------------------------------------------------------------------------------- */

enum { TERMS = 40 };

/* Where the box moves down the water beside it rises. */
double tank_float_stiffness(const tank_settings *s) {
  return WAVES_DENSITY * WAVES_G * s->width / (1.0 - s->width / s->length);
}

/* Root n of w^2 = g k tanh(k d) (n 0), of w^2 = -g k tan(k d) (n > 0). */
static double root(double w, double d, int n) {
  double low = n ? (n - 0.5) * WAVES_PI / d * (1.0 + 1e-12) : 0.0;
  double high = n ? n * WAVES_PI / d : w * w / WAVES_G + w / sqrt(WAVES_G * d);
  for (int k = 0; k < 80; k++) {
    const double at = 0.5 * (low + high);
    const double side =
        n ? at * tan(at * d) + w * w / WAVES_G : at * tanh(at * d) - w * w / WAVES_G;
    if (side < 0.0)
      low = at;
    else
      high = at;
  }
  return 0.5 * (low + high);
}

/* Integral over 0 < y < s of Z_n cos(m pi y/s); Z_0 = cosh(k y)/cosh(k d). */
static double overlap(double k, double d, double s, int n, int m) {
  const double b = m * WAVES_PI / s, sign = m % 2 ? -1.0 : 1.0;
  if (n == 0) return sign * k * sinh(k * s) / (cosh(k * d) * (k * k + b * b));
  if (fabs(k - b) < 1e-9 * k) return 0.5 * s + sin(2.0 * k * s) / (4.0 * k);
  return sign * k * sin(k * s) / (k * k - b * b);
}

/* Solves A b = right in place by elimination with the largest pivots; b in right. */
static void eliminate(double A[TERMS][TERMS], double *right) {
  for (int p = 0; p < TERMS; p++) {
    int best = p;
    for (int i = p + 1; i < TERMS; i++)
      if (fabs(A[i][p]) > fabs(A[best][p])) best = i;
    for (int j = 0; j < TERMS; j++) {
      const double other = A[p][j];
      A[p][j] = A[best][j], A[best][j] = other;
    }
    const double other = right[p];
    right[p] = right[best], right[best] = other;
    for (int i = p + 1; i < TERMS; i++) {
      const double factor = A[i][p] / A[p][p];
      for (int j = p; j < TERMS; j++) A[i][j] -= factor * A[p][j];
      right[i] -= factor * right[p];
    }
  }
  for (int p = TERMS - 1; p >= 0; p--) {
    for (int j = p + 1; j < TERMS; j++) right[p] -= A[p][j] * right[j];
    right[p] /= A[p][p];
  }
}

/* Added mass (kg) of half the box that heaves with w; B_m is scaled to 1 at x = a. */
static double half_added_mass(const tank_settings *t, double w) {
  const double d = t->depth, s = d - t->draft, a = 0.5 * (t->length - t->width);
  const double half = 0.5 * t->width;
  double A[TERMS][TERMS] = {{0}}, B[TERMS], beta[TERMS];
  for (int m = 0; m < TERMS; m++) {
    const double b = m * WAVES_PI / s;
    beta[m] = -b * tanh(b * half);
    B[m] = m ? -s * s * (m % 2 ? -1.0 : 1.0) / (b * b * s * s)
             : -(s * s * s / 3.0 - half * half * s) / (2.0 * s);
    A[m][m] = m ? 0.5 * s : s;
  }
  for (int n = 0; n < TERMS; n++) {
    const double k = root(w, d, n);
    const double norm = n ? 0.5 * d + sin(2.0 * k * d) / (4.0 * k)
                          : (0.5 * d + sinh(2.0 * k * d) / (4.0 * k)) / pow(cosh(k * d), 2.0);
    const double side = n ? 1.0 / (k * tanh(k * a)) : -1.0 / (k * tan(k * a));
    double I[TERMS];
    for (int m = 0; m < TERMS; m++) I[m] = overlap(k, d, s, n, m);
    for (int m = 0; m < TERMS; m++) {
      const double factor = side / norm * I[m];
      B[m] += factor * half / s * I[0];
      for (int e = 0; e < TERMS; e++) A[m][e] -= factor * beta[e] * I[e];
    }
  }
  eliminate(A, B);
  double sum = 0.5 * s * half - half * half * half / (6.0 * s) + B[0] * half;
  for (int m = 1; m < TERMS; m++) {
    const double b = m * WAVES_PI / s;
    sum += B[m] * (m % 2 ? -1.0 : 1.0) * tanh(b * half) / b;
  }
  return WAVES_DENSITY * sum;
}

/* Force of inertia less that of buoyancy on half the box of mass 2 `mass`, over its displacement,
 * N/m. */
static double imbalance(const tank_settings *t, double mass, double w) {
  return w * w * (mass + half_added_mass(t, w)) - WAVES_DENSITY * WAVES_G * 0.5 * t->width;
}

/* The lowest frequency: below it buoyancy is the larger force. The box heaves about its rest under
 * the weight, where it lies lower and the water beside it higher than at the start: more water
 * moves. */
double tank_float_period(const tank_settings *t) {
  const double mass = WAVES_DENSITY * 0.5 * t->width * t->draft;
  const double fall = sqrt(WAVES_G / t->draft), rise = t->width / (t->length - t->width);
  tank_settings rest = *t;
  rest.depth += t->amplitude * rise, rest.draft += t->amplitude * (1.0 + rise);
  double low = 0.02 * fall, high = low;
  while (imbalance(&rest, mass, high) < 0.0 && high < 10.0 * fall) low = high, high *= 1.02;
  for (int k = 0; k < 40; k++) {
    const double w = 0.5 * (low + high);
    if (imbalance(&rest, mass, w) < 0.0)
      low = w;
    else
      high = w;
  }
  return 2.0 * WAVES_PI / (0.5 * (low + high));
}
