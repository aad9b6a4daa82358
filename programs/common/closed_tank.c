/* closed_tank.c - with the piston at X and the wall at Y, both into the water, the surface is
 *   (X + Y) d/L + sum b_j cos(k_j x),  k_j = j pi/L,
 *   b_j'' + g k_j T_j b_j = 2 T_j (X'' + (-1)^j Y'')/(k_j L),  T_j = tanh(k_j d),
 * and the force of the water on the wall, above that at rest,
 *   rho g (X + Y) d^2/L + rho g sum (-1)^j b_j T_j/k_j + m_x X'' + m_y Y''.
 * By Runge-Kutta steps. A piston without a ramp has its velocity at once, and gives b_j' and Y' by
 * the impulse. SPDX-License-Identifier: BSD-3-Clause */
#include "closed_tank.h"

#include <math.h>
#include <string.h>

enum { MODES = CLOSED_TANK_MODES, TAIL = 20000 };

typedef struct state {
  double b[MODES + 1]; /* the last one is Y */
} state;

static bool stands(const closed_tank *c) { return isnan(c->mass); }

static double sign_of(int j) { return j % 2 ? 1.0 : -1.0; } /* (-1)^(j + 1) of mode j + 1 */

static void find_constants(closed_tank *c) {
  const double L = c->length, d = c->depth;
  c->m_x = -(L * L / 3.0 - d * d) * d / (2.0 * L) - d * d * d / (6.0 * L);
  c->m_y = -(L * L / 3.0 - d * d) * d / (2.0 * L) + (L * L * d - d * d * d / 3.0) / (2.0 * L);
  for (int j = 1; j <= TAIL; j++) {
    const double k = j * WAVES_PI / L, T = tanh(k * d);
    c->m_x -= 2.0 * sign_of(j - 1) * T / (L * k * k * k);
    c->m_y -= 2.0 * T / (L * k * k * k);
    if (j > MODES) continue;
    c->swing[j - 1] = WAVES_G * k * T, c->push[j - 1] = 2.0 * T / (k * L), c->share[j - 1] = T / k;
  }
  c->m_x *= WAVES_DENSITY, c->m_y *= WAVES_DENSITY;
}

/* Force (N, above the rest) of the water on a wall that does not accelerate; X is the piston's. */
static double press(const closed_tank *c, const double *X, const double *b) {
  double force = WAVES_G * (X[0] + b[MODES]) * c->depth * c->depth / c->length;
  for (int j = 0; j < MODES; j++) force += sign_of(j) * WAVES_G * b[j] * c->share[j];
  return WAVES_DENSITY * force + c->m_x * X[2];
}

static double wall_acceleration(const closed_tank *c, const double *X, const double *b) {
  return stands(c) ? 0.0 : -(c->stiffness * b[MODES] + press(c, X, b)) / (c->mass + c->m_y);
}

void closed_tank_begin(closed_tank *c) {
  const double jump =
      c->piston.ramp > 0.0 ? 0.0 : c->piston.amplitude * 2.0 * WAVES_PI / c->piston.period;
  find_constants(c);
  c->t = c->wall = 0.0;
  memset(c->b, 0, sizeof c->b);
  const double wall = stands(c) ? 0.0 : -c->m_x * jump / (c->mass + c->m_y);
  for (int j = 0; j < MODES; j++) c->rate[j] = c->push[j] * (jump + sign_of(j) * wall);
  c->rate[MODES] = wall;
  c->longest = fmin(c->piston.period, 40.0 / sqrt(c->swing[MODES - 1])) / 300.0;
  if (!stands(c))
    c->longest = fmin(c->longest, 0.3 * sqrt((c->mass + fmax(c->m_y, 0.0)) / c->stiffness));
  c->longest = fmax(c->longest, 1e-5 * c->piston.period);
}

static mps_status accelerate(closed_tank *c, double t, const state *at, state *a) {
  double X[3];
  const mps_status status = waves_move_piston(&c->piston, t, X);
  const double wall = wall_acceleration(c, X, at->b);
  for (int j = 0; j < MODES; j++)
    a->b[j] = c->push[j] * (X[2] + sign_of(j) * wall) - c->swing[j] * at->b[j];
  a->b[MODES] = wall;
  return status;
}

/* b + h v + square a. */
static void add(state *out, const closed_tank *c, double h, double square, const state *a) {
  for (int j = 0; j <= MODES; j++) out->b[j] = c->b[j] + h * c->rate[j] + square * a->b[j];
}

static mps_status step(closed_tank *c, double t, double h) {
  state a[4], at;
  memcpy(at.b, c->b, sizeof at.b);
  mps_status status = accelerate(c, t, &at, &a[0]);
  add(&at, c, 0.5 * h, 0.0, &a[0]);
  if (status == MPS_OK) status = accelerate(c, t + 0.5 * h, &at, &a[1]);
  add(&at, c, 0.5 * h, 0.25 * h * h, &a[0]);
  if (status == MPS_OK) status = accelerate(c, t + 0.5 * h, &at, &a[2]);
  add(&at, c, h, 0.5 * h * h, &a[1]);
  if (status == MPS_OK) status = accelerate(c, t + h, &at, &a[3]);
  for (int j = 0; status == MPS_OK && j <= MODES; j++) {
    const double early = a[0].b[j] + a[1].b[j] + a[2].b[j];
    c->b[j] += h * c->rate[j] + h * h / 6.0 * early;
    c->rate[j] += h / 6.0 * (early + a[1].b[j] + a[2].b[j] + a[3].b[j]);
  }
  return status;
}

mps_status closed_tank_advance(closed_tank *c, double t) {
  const double from = c->t, whole = t - from;
  const int64_t steps = (int64_t)ceil(whole / c->longest);
  mps_status status = MPS_OK;
  for (int64_t n = 0; n < steps && status == MPS_OK; n++)
    status = step(c, from + whole * (double)n / (double)steps, whole / (double)steps);
  c->t = t, c->wall = c->b[MODES];
  return status;
}

double closed_tank_force(const closed_tank *c) {
  waves_piston piston = c->piston;
  double X[3];
  if (waves_move_piston(&piston, c->t, X) != MPS_OK) return NAN;
  return press(c, X, c->b) + c->m_y * wall_acceleration(c, X, c->b);
}

double closed_tank_level(const closed_tank *c, double x) {
  waves_piston piston = c->piston;
  double X[3];
  if (waves_move_piston(&piston, c->t, X) != MPS_OK) return NAN;
  double level = (X[0] + c->wall) * c->depth / c->length;
  for (int j = 0; j < MODES; j++) level += c->b[j] * cos((j + 1) * WAVES_PI * x / c->length);
  return level;
}
