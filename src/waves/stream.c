/* stream.c - regular waves of the stream function (Rienecker and Fenton 1981), whatever their
 * length, and the piston that makes them. In the frame of the wave, y from the bed,
 *
 *   psi = -U y + sum_j B_j sinh(j k y)/cosh(j k d) cos(j k x),
 *
 * psi = -Q and (psi_x^2 + psi_y^2)/2 + g y = R at the surface y = d + eta, at N + 1 points of half
 * a wave; eta has the mean 0 and the height H, and the waves carry no water: c = omega/k = Q/d.
 * Newton's method, in steps of the height from linear waves on; units of d and g.
 *
 * The piston has the depth-averaged velocity of the water at its face, dX/dt = c eta/(d + eta) at x
 * = X (Goring 1979): with xi = X - c t, d X + int_0^xi eta = 0. That holds for long waves: of low
 * ones its first and second harmonics are a/(k d) and (b - a^2/d)/(2 k d), a and b the harmonics of
 * the level, for the a/c0 of Biesel and the second order of second_order.c. X has its harmonics
 * times the ratio of the latter to the former. SPDX-License-Identifier: BSD-3-Clause */
#include "waves_private.h"

#include <lapacke.h>
#include <string.h>

#define STEPS 12 /* of the height */
#define MOST_ITERATIONS 30
#define SMALL 1e-10   /* largest residual */
#define RESOLVED 2e-3 /* last harmonics over the first */
#define INSTANTS 256  /* of a period, for the piston */

enum { N = MPSI_WAVES_HARMONICS };
/* Unknowns: k, U, Q, R, depths at N + 1 points, B_1 to B_N. */
enum { K = 0, U, Q, R, DEPTH, B = DEPTH + N + 1, UNKNOWNS = B + N };

typedef struct stream {
  double omega, height; /* of units of depth and gravity */
  double z[UNKNOWNS], residual[UNKNOWNS];
  double J[UNKNOWNS][UNKNOWNS];
} stream;

/* ---- the equations --------------------------------------------------------------------------- */

/* Both conditions at point m of the surface, rows 2 m and 2 m + 1. */
static void surface(stream *s, int m) {
  const double *z = s->z, k = z[K], h = z[DEPTH + m];
  double *kinematic = s->J[2 * m], *dynamic = s->J[2 * m + 1];
  double psi = -z[U] * h + z[Q], u = -z[U], v = 0.0, uh = 0.0, vh = 0.0, pk = 0.0, uk = 0.0,
         vk = 0.0;
  for (int j = 1; j <= N; j++) {
    const double jk = j * k, b = z[B + j - 1], C0 = cos(j * m * MPSI_WAVES_PI / N);
    const double S0 = sin(j * m * MPSI_WAVES_PI / N), t = tanh(jk);
    const double up = exp(jk * (h - 1.0)), down = exp(-jk * (h + 1.0)), all = 1.0 + exp(-2.0 * jk);
    const double sh = (up - down) / all, ch = (up + down) / all; /* over cosh(j k) */
    psi += b * sh * C0, u += jk * b * ch * C0, v += jk * b * sh * S0;
    uh += jk * jk * b * sh * C0, vh += jk * jk * b * ch * S0;
    const double shk = j * (h * ch - t * sh), chk = j * (h * sh - t * ch);
    pk += b * shk * C0;
    uk += j * b * ch * C0 + jk * b * chk * C0, vk += j * b * sh * S0 + jk * b * shk * S0;
    kinematic[B + j - 1] = sh * C0, dynamic[B + j - 1] = jk * ch * C0; /* of u; below */
    s->J[UNKNOWNS - 1][j - 1] = jk * sh * S0;                          /* of v */
  }
  for (int j = 0; j < N; j++) dynamic[B + j] = u * dynamic[B + j] + v * s->J[UNKNOWNS - 1][j];
  s->residual[2 * m] = psi, s->residual[2 * m + 1] = 0.5 * (u * u + v * v) + h - z[R];
  kinematic[K] = pk, kinematic[U] = -h, kinematic[Q] = 1.0, kinematic[DEPTH + m] = u;
  dynamic[K] = u * uk + v * vk, dynamic[U] = -u, dynamic[R] = -1.0;
  dynamic[DEPTH + m] = u * uh + v * vh + 1.0;
}

static void equations(stream *s) {
  const double *z = s->z;
  memset(s->J, 0, sizeof s->J);
  for (int m = 0; m <= N; m++) surface(s, m);
  memset(s->J[UNKNOWNS - 1], 0, sizeof s->J[UNKNOWNS - 1]);
  double *mean = s->J[UNKNOWNS - 3], *height = s->J[UNKNOWNS - 2], *speed = s->J[UNKNOWNS - 1];
  double sum = -1.0;
  for (int m = 0; m <= N; m++) {
    mean[DEPTH + m] = (m % N == 0 ? 0.5 : 1.0) / N;
    sum += mean[DEPTH + m] * z[DEPTH + m];
  }
  s->residual[UNKNOWNS - 3] = sum;
  height[DEPTH] = 1.0, height[DEPTH + N] = -1.0;
  s->residual[UNKNOWNS - 2] = z[DEPTH] - z[DEPTH + N] - s->height;
  speed[Q] = z[K], speed[K] = z[Q];
  s->residual[UNKNOWNS - 1] = z[Q] * z[K] - s->omega;
}

/* The change of Newton's method takes the place of the residual. The rows of J are LAPACK's
 * columns. */
static bool eliminate(stream *s) {
  lapack_int pivot[UNKNOWNS];
  return LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, UNKNOWNS, UNKNOWNS, s->J[0], UNKNOWNS, pivot) == 0 &&
         LAPACKE_dgetrs_work(LAPACK_COL_MAJOR, 'T', UNKNOWNS, 1, s->J[0], UNKNOWNS, pivot,
                             s->residual, UNKNOWNS) == 0;
}

static bool solve(stream *s) {
  for (int k = 0; k < MOST_ITERATIONS; k++) {
    double worst = 0.0;
    equations(s);
    for (int r = 0; r < UNKNOWNS; r++) worst = fmax(worst, fabs(s->residual[r]));
    if (worst < SMALL) return true;
    if (!(worst < 1e6) || !eliminate(s)) return false;
    for (int r = 0; r < UNKNOWNS; r++) s->z[r] -= s->residual[r];
    if (!(s->z[K] > 0.0)) return false;
  }
  return false;
}

/* From linear waves of a small height on; later ones are extrapolated from the last two. */
static bool climb(stream *s, double kd, double height) {
  double before[UNKNOWNS], last[UNKNOWNS];
  memset(s->z, 0, sizeof s->z);
  s->z[K] = kd, s->z[U] = s->z[Q] = s->omega / kd, s->z[R] = 1.0 + 0.5 * s->z[U] * s->z[U];
  s->height = height / STEPS;
  s->z[B] = 0.5 * s->height * s->z[U] / tanh(kd);
  for (int m = 0; m <= N; m++) s->z[DEPTH + m] = 1.0 + 0.5 * s->height * cos(m * MPSI_WAVES_PI / N);
  memcpy(before, s->z, sizeof before);
  for (int step = 1; step <= STEPS; step++) {
    s->height = height * step / STEPS;
    memcpy(last, s->z, sizeof last);
    for (int r = 0; step > 2 && r < UNKNOWNS; r++) s->z[r] += s->z[r] - before[r];
    if (!solve(s)) return false;
    memcpy(before, last, sizeof before);
  }
  return true;
}

/* ---- harmonics ------------------------------------------------------------------------------- */

/* Of the level, a_1 to a_N. */
static void find_shape(const stream *s, double *a) {
  for (int n = 1; n <= N; n++) {
    a[n] = 0.0;
    for (int m = 0; m <= N; m++)
      a[n] += (m % N == 0 ? 1.0 : 2.0) / N * (s->z[DEPTH + m] - 1.0) *
              cos(n * m * MPSI_WAVES_PI / N) * (n == N ? 0.5 : 1.0);
  }
}

/* Of the piston's sin(n omega t), in depths. */
static void find_motion(const stream *s, const double *a, double *X) {
  const double k = s->z[K];
  for (int n = 1; n <= N; n++) X[n] = 0.0;
  for (int i = 0; i < INSTANTS; i++) {
    const double turn = 2.0 * MPSI_WAVES_PI * i / INSTANTS, there = -turn / k;
    double xi = there;
    for (int step = 0; step < 60; step++) {
      double whole = 0.0, eta = 0.0;
      for (int n = 1; n <= N; n++)
        whole += a[n] / (n * k) * sin(n * k * xi), eta += a[n] * cos(n * k * xi);
      const double change = (xi - there + whole) / (1.0 + eta);
      xi -= change;
      if (fabs(change) < 1e-14) break;
    }
    for (int n = 1; n <= N; n++) X[n] += 2.0 / INSTANTS * (xi - there) * sin(n * turn);
  }
}

/* ---- the sea --------------------------------------------------------------------------------- */

static mps_status refuse(const mps_waves *w, const char *why) {
  return mpsi_fail(w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                   "height %g m of waves of %g s in a depth of %g m: %s", w->def.height,
                   w->def.period, w->def.depth, why);
}

/* Ratio of the exact second harmonic of the piston to that by the flux, of low waves. */
static double second_ratio(const mps_waves *w, double complex push) {
  const double d = w->def.depth, kd = w->wave[0].k * d, a = cabs(w->wave[0].a), t = tanh(kd);
  const double b = 0.25 * a * a * kd / d * (3.0 - t * t) / (t * t * t);
  return -cimag(push) / ((b - a * a / d) / (2.0 * kd));
}

mps_status mpsi_waves_make_stream(mps_waves *w) {
  mpsi_wave *first = &w->wave[0];
  const double d = w->def.depth, kd = first->k * d, low = second_ratio(w, w->push[2]);
  if (kd > 1.0) return refuse(w, "MPS_WAVES_THEORY_STREAM is for k depth <= 1: take SECOND");
  stream *s = mpsi_alloc(w->context, 1, sizeof *s);
  if (!s) return mpsi_fail_memory(w->context, "mps_waves_create", sizeof *s);
  s->omega = first->omega * sqrt(d / w->def.gravity);
  double a[N + 1] = {0.0}, X[N + 1] = {0.0};
  const bool good = climb(s, kd, w->def.height / d);
  if (good) find_shape(s, a), find_motion(s, a, X), first->k = s->z[K] / d;
  mpsi_free(w->context, s);
  if (!good) return refuse(w, "the stream function has no such waves, they break");
  if (!(fabs(a[N - 1]) + fabs(a[N]) < RESOLVED * a[1]))
    return refuse(w, "they are too long for the stream function");
  first->far *= a[1] / (X[1] * kd);
  first->a = a[1] * d;
  for (int n = 2; n <= N; n++)
    w->shape[n] = a[n] * d, w->push[n] = -I * X[n] * d * (n == 2 ? low : 1.0);
  return MPS_OK;
}
