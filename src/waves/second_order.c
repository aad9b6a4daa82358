/* second_order.c - waves of second order in a flume with a piston.
 *
 * Bound waves of two components a and b, in complex numbers of exp(i (omega t - k x)); for the
 * difference b is replaced by its conjugate, omega_b by -omega_b and k_b by -k_b*. With W = omega_a
 * + omega_b and K = k_a + k_b
 *
 *   eta  = G A_a A_b,  G = (W H/D - L)/g,  D = g K tanh(K d) - W^2,
 *   phi  = i H/D A_a A_b cosh K(z + d)/cosh K d,
 *   H = W (omega_a omega_b - g^2 k_a k_b/(omega_a omega_b)) + (omega_a^3 + omega_b^3)/2
 *       - g^2 (k_a^2/omega_a + k_b^2/omega_b)/2,
 *   L = (g^2 k_a k_b/(omega_a omega_b) - omega_a omega_b - omega_a^2 - omega_b^2)/2,
 *
 * half of it for a component with itself: Schaeffer (1996), Ocean Engineering 23, 47-88. They
 * follow from the conditions at the free surface; k may be that of an evanescent mode, -i q.
 *
 * The piston: of phi_x(X) = dX/dt the second order is phi2_x + X1 phi1_xx = dX2/dt at x = 0. No
 * free progressive wave leaves where the projection on its cosh K0(z + d), W^2 = g K0 tanh K0 d, is
 * that of the bound waves of all pairs of modes:
 *
 *   dX2/dt int Z0 = int (phi_x + X1 phi1_xx) Z0 dz,   Z0 = cosh K0(z + d)/cosh K0 d,
 *   int Z0 = W^2/(g K0^2),   int Z_K Z0 = (K tanh K d - K0 tanh K0 d)/(K^2 - K0^2),
 *
 * so that D cancels. A narrow band has the limits G = -(2n - 1/2) g/(g d - cg^2), n = cg/c, of the
 * differences and dX2/dt = cg/d eta.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dispersion.h"
#include "waves_private.h"

#define ROW 40   /* evanescent modes of one component with the progressive one of the other */
#define SQUARE 8 /* evanescent modes of both with one another */

/* A component of a pair: conjugated for the difference. */
typedef struct side {
  double omega;                             /* rad/s, negative where conjugated */
  double complex a;                         /* m, progressive */
  double complex piston;                    /* m */
  double complex k[ROW + 1], mode[ROW + 1]; /* rad/m and m: the progressive mode, then the others */
} side;

static void make_side(const mps_waves *w, const mpsi_wave *wave, side *s) {
  const double y = wave->omega * wave->omega * w->def.depth / w->def.gravity;
  s->omega = wave->omega;
  s->a = wave->a;
  s->piston = wave->a / (I * wave->far);
  s->k[0] = wave->k, s->mode[0] = wave->a;
  for (int j = 1; j <= ROW; j++) {
    double amplitude;
    s->k[j] = -I * mpsi_waves_evanescent(y, j, &amplitude) / w->def.depth;
    s->mode[j] = s->piston * amplitude;
  }
}

static void conjugate(const side *from, side *to) {
  to->omega = -from->omega;
  to->a = conj(from->a), to->piston = conj(from->piston);
  for (int j = 0; j <= ROW; j++) to->k[j] = -conj(from->k[j]), to->mode[j] = conj(from->mode[j]);
}

static double complex forcing(double g, double wa, double wb, double complex ka,
                              double complex kb) {
  return (wa + wb) * (wa * wb - g * g * ka * kb / (wa * wb)) + 0.5 * (wa * wa * wa + wb * wb * wb) -
         0.5 * g * g * (ka * ka / wa + kb * kb / wb);
}

/* int Z_k Z0 dz = (omega^2 - W^2)/(g (k^2 - K0^2)) of a mode of omega; in the limit k = K0 that of
 * Z0^2.
 */
static double complex overlap(const mps_waves *w, double omega, double W, double complex k,
                              double K0) {
  const double complex less = k * k - K0 * K0;
  const double t = tanh(K0 * w->def.depth);
  if (cabs(less) < 1e-9 * K0 * K0) return 0.5 * (t + K0 * w->def.depth * (1.0 - t * t)) / K0;
  return (omega * omega - W * W) / (w->def.gravity * less);
}

/* X1 phi1_xx of the modes of b, projected. */
static double complex moved_face(const mps_waves *w, const side *a, const side *b, double W,
                                 double K0) {
  double complex sum = 0.0;
  for (int l = 0; l <= ROW; l++)
    sum += b->mode[l] * b->k[l] * b->k[l] * overlap(w, b->omega, W, b->k[l], K0);
  return -0.5 * I * w->def.gravity / b->omega * a->piston * sum;
}

/* Amplitude of the piston's displacement for the pair, without the half of a component with itself.
 */
static double complex push_of(const mps_waves *w, const side *a, const side *b, double K0) {
  const double g = w->def.gravity;
  const double W = a->omega + b->omega;
  double complex sum = moved_face(w, a, b, W, K0) + moved_face(w, b, a, W, K0);
  for (int j = 0; j <= ROW; j++) {
    const int most = j == 0 ? ROW : j <= SQUARE ? SQUARE : 0;
    for (int l = 0; l <= most; l++) {
      const double complex K = a->k[j] + b->k[l];
      sum += a->mode[j] * b->mode[l] * K * forcing(g, a->omega, b->omega, a->k[j], b->k[l]) /
             (g * (K * K - K0 * K0));
    }
  }
  return sum * g * K0 * K0 / (I * W * W * W);
}

/* G of progressive components. */
static double transfer(double g, double d, double wa, double wb, double ka, double kb) {
  const double W = wa + wb, K = ka + kb;
  const double H = creal(forcing(g, wa, wb, ka, kb)), D = g * K * tanh(K * d) - W * W;
  const double L = 0.5 * (g * g * ka * kb / (wa * wb) - wa * wb - wa * wa - wb * wb);
  return (W * H / D - L) / g;
}

/* ---- narrow bands ---------------------------------------------------------------------------- */

/* G and the group velocity at the period of the sea. */
static double narrow(const mps_waves *w, double *group) {
  const double g = w->def.gravity, d = w->def.depth, omega = 2.0 * MPSI_WAVES_PI / w->period;
  const double kd = mpsi_waves_depths(omega * omega * d / g);
  const double n = 0.5 * (1.0 + (kd < 300.0 ? 2.0 * kd / sinh(2.0 * kd) : 0.0));
  *group = n * omega * d / kd;
  return -(2.0 * n - 0.5) * g / (g * d - *group * *group);
}

/* ---- all pairs ------------------------------------------------------------------------------- */

static double bin_omega(const mps_waves *w, int64_t bin) {
  return 2.0 * MPSI_WAVES_PI * (double)bin / w->repeat;
}

static void push_narrow(mps_waves *w) {
  double group;
  const double G = narrow(w, &group);
  for (int64_t p = 0; p < w->count; p++)
    for (int64_t q = 0; q < p; q++) {
      const int64_t bin = w->wave[p].bin - w->wave[q].bin;
      w->push[bin] +=
          G * group / w->def.depth * w->wave[p].a * conj(w->wave[q].a) / (I * bin_omega(w, bin));
    }
}

/* Free wave number of a bin; 0: beyond the range of the dispersion relation: no progressive wave.
 */
static double free_number(const mps_waves *w, int64_t bin) {
  const double omega = bin_omega(w, bin), y = omega * omega * w->def.depth / w->def.gravity;
  if (y > MPSI_WAVES_DEEPEST) return 0.0;
  return (y < MPSI_WAVES_SHALLOWEST ? sqrt(y) : mpsi_waves_depths(y)) / w->def.depth;
}

static mps_status push_all(mps_waves *w) {
  side *s = mpsi_alloc(w->context, w->count, sizeof *s), other;
  if (!s) return mpsi_fail_memory(w->context, "mps_waves_create", (size_t)w->count * sizeof *s);
  for (int64_t p = 0; p < w->count; p++) {
    make_side(w, &w->wave[p], &s[p]);
    for (int64_t q = 0; q <= p; q++) {
      const int64_t sum = w->wave[p].bin + w->wave[q].bin, less = w->wave[p].bin - w->wave[q].bin;
      double K0 = free_number(w, sum);
      if (K0 > 0.0) w->push[sum] += (p == q ? 0.5 : 1.0) * push_of(w, &s[p], &s[q], K0);
      if (less == 0) continue;
      conjugate(&s[q], &other);
      K0 = free_number(w, less);
      w->push[less] += push_of(w, &s[p], &other, K0);
    }
  }
  mpsi_free(w->context, s);
  return MPS_OK;
}

mps_status mpsi_waves_find_push(mps_waves *w) {
  if (w->def.theory != MPS_WAVES_THEORY_NARROW) return push_all(w);
  push_narrow(w);
  return MPS_OK;
}

void mpsi_waves_add_bound(const mps_waves *w, double x, double complex *eta) {
  const double g = w->def.gravity, d = w->def.depth;
  const bool all = w->def.theory == MPS_WAVES_THEORY_SECOND;
  double group;
  for (int64_t n = 2; w->shape && n <= w->bins; n++)
    eta[n] += w->shape[n] * cexp(-I * (double)n * w->wave[0].k * x);
  if (w->shape) return;
  const double G = narrow(w, &group);
  for (int64_t p = 0; w->bins > 0 && p < w->count; p++) {
    const mpsi_wave *a = &w->wave[p];
    const double complex at = a->a * cexp(-I * a->k * x);
    for (int64_t q = 0; q <= p; q++) {
      const mpsi_wave *b = &w->wave[q];
      const double complex bt = b->a * cexp(-I * b->k * x);
      if (all)
        eta[a->bin + b->bin] +=
            (p == q ? 0.5 : 1.0) * transfer(g, d, a->omega, b->omega, a->k, b->k) * at * bt;
      if (p > q)
        eta[a->bin - b->bin] +=
            (all ? transfer(g, d, a->omega, -b->omega, a->k, -b->k) : G) * at * conj(bt);
    }
  }
}
