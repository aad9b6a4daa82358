/* test_strata.c - the exact consolidation of layered columns against numbers of textbooks and
 * finite differences. SPDX-License-Identifier: BSD-3-Clause */
#include "test_common.h"

#include "consolidation/strata.h"

enum { NODES = 801, STEPS = 4000 };

static strata column_of(int count, const stratum *layer, bool top, bool bottom) {
  strata s = {.count = count, .drained = {top, bottom}};
  for (int i = 0; i < count; i++) s.layer[i] = layer[i];
  strata_scale(&s, NULL, NULL, NULL);
  strata_solve(&s);
  return s;
}

static const stratum *at_depth(const strata *s, double z) {
  for (int i = 0; i + 1 < s->count; i++) {
    if (z < s->layer[i].thickness) return &s->layer[i];
    z -= s->layer[i].thickness;
  }
  return &s->layer[s->count - 1];
}

/* u at all nodes after T, by finite volumes around nodes and Euler's implicit method. */
static void march(const strata *s, double T, double ramp, double *u) {
  const double h = 1.0 / (NODES - 1), dt = T / STEPS;
  static double g[NODES], store[NODES], c[NODES];
  for (int i = 0; i < NODES; i++) {
    const double above = i > 0 ? 0.5 * h / at_depth(s, (i - 0.5) * h)->modulus : 0.0;
    const double under = i + 1 < NODES ? 0.5 * h / at_depth(s, (i + 0.5) * h)->modulus : 0.0;
    store[i] = above + under;
    g[i] = i + 1 < NODES ? at_depth(s, (i + 0.5) * h)->k / h : 0.0;
    u[i] = ramp > 0.0 ? 0.0 : 1.0;
  }
  for (int n = 0; n < STEPS; n++) {
    const double now = fmin((n + 1) * dt, ramp), before = fmin(n * dt, ramp);
    const double growth = ramp > 0.0 ? (now - before) / ramp : 0.0;
    for (int i = 0; i < NODES; i++) { /* down the rows of three, then up */
      const bool held = (i == 0 && s->drained[0]) || (i + 1 == NODES && s->drained[1]);
      const double a = i > 0 && !held ? -dt * g[i - 1] : 0.0;
      const double e = !held ? -dt * g[i] : 0.0, b = held ? 1.0 : store[i] - a - e;
      const double load = held ? 0.0 : store[i] * (u[i] + growth);
      const double pivot = b - (i > 0 ? a * c[i - 1] : 0.0);
      c[i] = e / pivot;
      u[i] = (load - (i > 0 ? a * u[i - 1] : 0.0)) / pivot;
    }
    for (int i = NODES - 2; i >= 0; i--) u[i] -= c[i] * u[i + 1];
  }
}

/* Pressures within `most`, and the degree: what is applied less the mean of u/M'. */
static void agree(const strata *s, double T, double ramp, double most) {
  static double u[NODES];
  const double h = 1.0 / (NODES - 1), applied = ramp > 0.0 ? fmin(1.0, T / ramp) : 1.0;
  double left = 0.0;
  march(s, T, ramp, u);
  for (int i = 0; i < NODES; i++) NEAR(strata_pressure(s, i * h, T, ramp), u[i], most);
  for (int i = 0; i + 1 < NODES; i++)
    left += 0.5 * h * (u[i] + u[i + 1]) / at_depth(s, (i + 0.5) * h)->modulus;
  NEAR(strata_degree(s, T, ramp), applied - left, most);
}

TEST(one_layer_is_that_of_textbooks) {
  const stratum layer = {5.0, 1e-9, 2e6};
  const strata one = column_of(1, &layer, true, false), two = column_of(1, &layer, true, true);
  NEAR(strata_degree(&one, 0.197, 0.0), 0.500, 5e-4); /* Taylor's table */
  NEAR(strata_degree(&one, 0.848, 0.0), 0.900, 5e-4);
  NEAR(strata_degree(&two, 0.848 / 4.0, 0.0), 0.900, 5e-4);
  NEAR(strata_pressure(&one, 1.0, 0.2, 0.0), 0.7723, 1e-4);
  NEAR(strata_pressure(&two, 0.5, 0.05, 0.0), 0.7723, 1e-4);
}

/* Olson (1977) at the end of the load: U = 1 - 1/T sum 2/M^4 (1 - exp(-M^2 T)). */
TEST(a_load_that_grows_is_olsons) {
  const stratum layer = {1.0, 1.0, 1.0};
  const strata s = column_of(1, &layer, true, false);
  const double T = 0.2;
  double sum = 0.0;
  for (int i = 0; i < 200; i++) {
    const double M = (i + 0.5) * 3.14159265358979323846;
    sum += 2.0 / pow(M, 4.0) * (1.0 - exp(-M * M * T));
  }
  NEAR(strata_degree(&s, T, T), 1.0 - sum / T, 1e-7);
  NEAR(strata_degree(&s, 0.0, T), 0.0, 1e-9);
  agree(&s, 0.1, 0.2, 2e-3);
  agree(&s, 0.5, 0.2, 2e-3);
}

TEST(layers_agree_with_finite_differences) {
  const stratum two[] = {{2.0, 1e-9, 2e6}, {3.0, 1e-8, 8e6}};
  const stratum thin[] = {{4.0, 1e-8, 4e6}, {0.5, 1e-10, 1e6}, {5.5, 5e-9, 1e7}};
  const stratum turned[] = {{3.0, 1e-8, 8e6}, {2.0, 1e-9, 2e6}};
  const strata a = column_of(2, two, true, false), b = column_of(2, two, true, true);
  const strata c = column_of(3, thin, true, true), d = column_of(3, thin, false, true);
  const strata e = column_of(2, turned, false, true);
  agree(&a, 0.1, 0.0, 2e-3);
  agree(&b, 0.1, 0.0, 2e-3);
  agree(&c, 0.05, 0.0, 4e-3);
  agree(&d, 0.3, 0.1, 2e-3);
  agree(&e, 0.1, 0.0, 2e-3);
  for (double z = 0.0; z <= 1.0; z += 0.1) /* upside down */
    NEAR(strata_pressure(&a, z, 0.1, 0.0), strata_pressure(&e, 1.0 - z, 0.1, 0.0), 1e-9);
}

/* A layer cut in two is one layer. */
TEST(equal_layers_are_one) {
  const stratum whole = {7.0, 2e-9, 3e6}, cut[] = {{3.0, 2e-9, 3e6}, {4.0, 2e-9, 3e6}};
  const strata one = column_of(1, &whole, true, false), two = column_of(2, cut, true, false);
  for (int n = 0; n < STRATA_TERMS; n++) NEAR(one.lambda[n], two.lambda[n], 1e-9 * one.lambda[n]);
  NEAR(strata_degree(&one, 0.01, 0.0), strata_degree(&two, 0.01, 0.0), 1e-9);
}
