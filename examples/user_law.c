/* user_law.c - a user's constitutive law: elasticity with power-law creep (Norton), compared in one
 * particle with the closed form of relaxation in pure shear.
 *
 * The shear stress tau at a constant shear strain obeys dtau/dt = -G B tau^n, so that
 *   tau(t) = (tau0^(1 - n) + (n - 1) G B t)^(-1/(n - 1)).
 * SPDX-License-Identifier: BSD-3-Clause */
#define MPS_EXPERIMENTAL 1
#include <mps/material.h>
#include <mps/experimental/material_point.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct creep {
  double shear, bulk; /* Pa */
  double rate, power; /* B, 1/(s Pa^n); n > 1 */
} creep;

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

/* The radius q = sqrt(J2) at the end of the step: q + dt G B q^n = trial, by Newton. */
static mps_status relax(const creep *c, double dt, double trial, double *q) {
  const double a = dt * c->shear * c->rate;
  *q = trial;
  for (int k = 0; k < 100; k++) {
    const double change =
        (*q + a * pow(*q, c->power) - trial) / (1.0 + a * c->power * pow(*q, c->power - 1.0));
    *q -= change;
    if (fabs(change) <= 1e-14 * trial) return MPS_OK;
  }
  return MPS_ERROR_NUMERIC;
}

/* Called by several threads at once: writes to nothing but the block. */
static mps_status update(void *user, const mps_material_block *b) {
  const creep *c = user;
  const int stresses = b->dim == 3 ? 6 : 4;
  static const int row[6] = {0, 1, 2, 0, 2, 1}, column[6] = {0, 1, 2, 1, 0, 2};
  for (int64_t k = 0; k < b->count; k++) {
    double d[6], s[6], trace = 0.0, mean = 0.0, square = 0.0, q = 0.0;
    for (int i = 0; i < stresses; i++) { /* strain increment: dt sym(L) */
      const double *g = b->gradient[3 * row[i] + column[i]],
                   *h = b->gradient[3 * column[i] + row[i]];
      d[i] = g && h ? 0.5 * b->dt * (g[k] + h[k]) : 0.0; /* zz in plane strain: NULL */
      if (i < 3) trace += d[i], mean += b->stress[i][k] / 3.0;
    }
    for (int i = 0; i < stresses; i++) { /* elastic trial, its deviatoric part */
      s[i] = b->stress[i][k] - (i < 3 ? mean : 0.0) +
             2.0 * c->shear * (d[i] - (i < 3 ? trace / 3.0 : 0.0));
      square += (i < 3 ? 0.5 : 1.0) * s[i] * s[i];
    }
    const double trial = sqrt(square);
    const mps_status status = relax(c, b->dt, trial, &q);
    if (status != MPS_OK) { /* the message and the particle go to the error record */
      snprintf(b->message, (size_t)b->message_size, "Newton fails at sqrt(J2) = %g Pa", trial);
      *b->refused = k;
      return status;
    }
    for (int i = 0; i < stresses; i++)
      b->stress[i][k] =
          (trial > 0.0 ? q / trial : 1.0) * s[i] + (i < 3 ? mean + c->bulk * trace : 0.0);
    b->history[0][k] += (trial - q) / c->shear; /* creep shear strain */
  }
  return MPS_OK;
}

int main(void) {
  static const char *const history[] = {"creep_strain"};
  creep c = {.shear = 4e6, .bulk = 1e7, .rate = 1e-14, .power = 3.0};
  mps_context *context = NULL;
  mps_material *salt = NULL;
  mps_material_point point;
  ok(mps_context_create(NULL, &context, NULL, 0));
  mps_material_user_def def = mps_material_user_defaults();
  def.update = update, def.user = &c;
  def.name = "salt"; /* in a set, the history is the field "salt.creep_strain" */
  def.history = history, def.history_count = 1;
  def.wave_modulus = c.bulk + 4.0 / 3.0 * c.shear;
  ok(mps_material_create_user(context, &def, &salt));
  ok(mps_material_point_init(context, salt, &point));
  /* a quick shear to tau0, then rest */
  const double tau0 = 2e4, quick = 1e-9, rate = tau0 / (2.0 * c.shear * quick);
  const double shear[9] = {0.0, rate, 0.0, rate}, still[9] = {0.0};
  ok(mps_material_point_drive(context, salt, &point, shear, quick, 1));
  double worst = 0.0;
  printf("  t, s   tau, Pa  closed form  creep strain\n");
  for (int k = 1; k <= 10; k++) {
    ok(mps_material_point_drive(context, salt, &point, still, 0.01, 500));
    const double t = 0.01 * k, n = c.power;
    const double exact =
        pow(pow(tau0, 1.0 - n) + (n - 1.0) * c.shear * c.rate * t, -1.0 / (n - 1.0));
    worst = fmax(worst, fabs(point.stress[3] / exact - 1.0));
    printf("%6.3f  %8.2f  %11.2f  %12.6g\n", t, point.stress[3], exact, point.history[0]);
  }
  /* the relaxed stress has become creep strain */
  const double lost = fabs((tau0 - point.stress[3]) / c.shear - point.history[0]);
  mps_material_destroy(&salt);
  mps_context_destroy(&context);
  printf("largest error %.2g of the stress\n", worst);
  return worst < 2e-3 && worst > 0.0 && lost < 1e-9 ? 0 : 1;
}
