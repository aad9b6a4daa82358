/* linear.c - linear potential flow for the waves of a piston before a fixed wall, or one that
 * oscillates on a spring: in an infinite flume, where the wall's own waves radiate its energy, and
 * in the closed tank of the run, from the start. Displacements of both walls are into the water.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "tank.h"

#include <math.h>

/* ---- an infinite flume ----------------------------------------------------------------------- */

/* A wall that oscillates as a whole with V e^{iwt} sends out phi = sum A cosh(k y) e^{-i k s} + sum
 * A_n cos(k_n y) e^{-k_n s},  w^2 = g k tanh(k d) = -g k_n tan(k_n d), which press upon it with
 * -(m_a dV/dt + B V): m_a = rho sum I_n^2/(k_n N_n), B = rho w I^2/(k N), where I is the integral
 * of the shape over the depth and N that of its square. */
void tank_flume(const tank_settings *s, tank_response *r) {
  const double w = 2.0 * WAVES_PI / s->period, d = s->depth, k = waves_number(s->period, d);
  const double I = sinh(k * d) / k, N = 0.5 * (d + sinh(2.0 * k * d) / (2.0 * k));
  r->added_mass = tank_added_mass(w, INFINITY, d);
  r->damping = WAVES_DENSITY * w * I * I / (k * N);
  const double incident = s->amplitude * waves_havelock(k, d);
  const double force = 2.0 * WAVES_DENSITY * WAVES_G * incident * tanh(k * d) / k;
  const double spring = s->stiffness - (s->mass + r->added_mass) * w * w;
  r->amplitude = force / hypot(spring, r->damping * w);
  r->lag = atan2(r->damping * w, spring);
  r->ratio = w / sqrt(s->stiffness / (s->mass + r->added_mass));
}

double tank_resonant_stiffness(const tank_settings *s, double ratio) {
  const double w = 2.0 * WAVES_PI / s->period;
  return (s->mass + tank_added_mass(w, INFINITY, s->depth)) * w * w / (ratio * ratio);
}

/* ---- the closed tank ------------------------------------------------------------------------- */

/* With the piston at X and the wall at Y the surface is (X + Y) d/L + sum b_j cos(k_j x), k_j = j
 * pi/L, and b_j'' + g k_j T_j b_j = 2 T_j (X'' + (-1)^j Y'')/(k_j L),  T_j = tanh(k_j d). The force
 * of the water on the wall is rho g (X + Y) d^2/L + rho g sum (-1)^j b_j T_j/k_j + m_x X'' + m_y
 * Y'' above the rest. */
enum { MODES = 120, TAIL = 20000 };

typedef struct closed {
  const tank_settings *s;
  bool held; /* the wall stands */
  waves_piston piston;
  double swing[MODES], push[MODES], share[MODES]; /* g k T; 2 T/(k L); T/k */
  double m_x, m_y;
} closed;

typedef struct closed_state {
  double b[MODES + 1]; /* the last one is Y */
} closed_state;

static void prepare(closed *c, const tank_settings *s) {
  const double L = s->length, d = s->depth;
  *c = (closed){
      .s = s, .held = s->kind != TANK_RESONANCE, .piston = {s->amplitude, s->period, s->ramp}};
  c->m_x = -(L * L / 3.0 - d * d) * d / (2.0 * L) - d * d * d / (6.0 * L);
  c->m_y = -(L * L / 3.0 - d * d) * d / (2.0 * L) + (L * L * d - d * d * d / 3.0) / (2.0 * L);
  for (int j = 1; j <= TAIL; j++) {
    const double k = j * WAVES_PI / L, T = tanh(k * d), sign = j % 2 ? -1.0 : 1.0;
    c->m_x -= 2.0 * sign * T / (L * k * k * k);
    c->m_y -= 2.0 * T / (L * k * k * k);
    if (j > MODES) continue;
    c->swing[j - 1] = WAVES_G * k * T, c->push[j - 1] = 2.0 * T / (k * L), c->share[j - 1] = T / k;
  }
  c->m_x *= WAVES_DENSITY, c->m_y *= WAVES_DENSITY;
}

/* Force (N, above the rest) of the water on a wall that does not accelerate; X is the piston's. */
static double press(const closed *c, const double *X, const closed_state *at) {
  const tank_settings *s = c->s;
  double force = WAVES_G * (X[0] + at->b[MODES]) * s->depth * s->depth / s->length;
  for (int j = 0; j < MODES; j++) force += (j % 2 ? 1.0 : -1.0) * WAVES_G * at->b[j] * c->share[j];
  return WAVES_DENSITY * force + c->m_x * X[2];
}

static double wall_acceleration(const closed *c, const double *X, const closed_state *at) {
  const double force = c->s->stiffness * at->b[MODES] + press(c, X, at);
  return c->held ? 0.0 : -force / (c->s->mass + c->m_y);
}

static mps_status accelerate(closed *c, double t, const closed_state *at, closed_state *a) {
  double X[3];
  const mps_status status = waves_move_piston(&c->piston, t, X);
  const double wall = wall_acceleration(c, X, at);
  for (int j = 0; j < MODES; j++)
    a->b[j] = c->push[j] * (X[2] + (j % 2 ? wall : -wall)) - c->swing[j] * at->b[j];
  a->b[MODES] = wall;
  return status;
}

/* b + h v + h^2/2 ... for a Runge-Kutta step of x'' = a(t, x). */
static void add(closed_state *out, const closed_state *x, double h, const closed_state *v,
                double square, const closed_state *a) {
  for (int j = 0; j <= MODES; j++) out->b[j] = x->b[j] + h * v->b[j] + square * a->b[j];
}

static mps_status step(closed *c, double t, double h, closed_state *x, closed_state *v) {
  closed_state a[4], at;
  mps_status status = accelerate(c, t, x, &a[0]);
  add(&at, x, 0.5 * h, v, 0.0, &a[0]);
  if (status == MPS_OK) status = accelerate(c, t + 0.5 * h, &at, &a[1]);
  add(&at, x, 0.5 * h, v, 0.25 * h * h, &a[0]);
  if (status == MPS_OK) status = accelerate(c, t + 0.5 * h, &at, &a[2]);
  add(&at, x, h, v, 0.5 * h * h, &a[1]);
  if (status == MPS_OK) status = accelerate(c, t + h, &at, &a[3]);
  for (int j = 0; status == MPS_OK && j <= MODES; j++) {
    const double early = a[0].b[j] + a[1].b[j] + a[2].b[j];
    x->b[j] += h * v->b[j] + h * h / 6.0 * early;
    v->b[j] += h / 6.0 * (early + a[1].b[j] + a[2].b[j] + a[3].b[j]);
  }
  return status;
}

static mps_status look(closed *c, const closed_state *x, tank_sample *out) {
  const tank_settings *s = c->s;
  double X[3];
  const mps_status status = waves_move_piston(&c->piston, out->t, X);
  out->deflection = x->b[MODES];
  out->right = press(c, X, x) + c->m_y * wall_acceleration(c, X, x);
  for (int g = 0; g <= TANK_GAUGES; g++) {
    const double at = g == TANK_GAUGES ? s->length : s->gauge[g];
    out->level[g] = (X[0] + x->b[MODES]) * s->depth / s->length;
    for (int j = 0; j < MODES; j++)
      out->level[g] += x->b[j] * cos((j + 1) * WAVES_PI * at / s->length);
  }
  return status;
}

mps_status tank_linear(const tank_settings *s, int64_t count, const tank_sample *sample,
                       tank_sample *out) {
  closed c;
  prepare(&c, s);
  const double own = sqrt((s->mass + fmax(c.m_y, 0.0)) / s->stiffness);
  const double fine = fmin(s->period, 40.0 / sqrt(c.swing[MODES - 1])) / 300.0;
  const double most = fmax(c.held ? fine : fmin(fine, 0.3 * own), 1e-5 * s->period);
  closed_state x = {{0.0}}, v = {{0.0}};
  mps_status status = MPS_OK;
  double t = 0.0;
  for (int64_t k = 0; k < count && status == MPS_OK; k++) {
    const int64_t steps = (int64_t)ceil((sample[k].t - t) / most);
    for (int64_t n = 0; n < steps && status == MPS_OK; n++)
      status = step(&c, t + (sample[k].t - t) * (double)n / (double)steps,
                    (sample[k].t - t) / (double)steps, &x, &v);
    t = sample[k].t;
    out[k] = (tank_sample){.t = t};
    if (status == MPS_OK) status = look(&c, &x, &out[k]);
  }
  return status;
}
