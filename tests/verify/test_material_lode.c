/* test_material_lode.c - Cam-Clay whose M follows the Lode angle is associated: against a
 * fourth-order integration of its rate equations in small increments, whose flow is the numerical
 * gradient of the yield function, in plane strain and general paths, undrained and compressing, at
 * overconsolidation of 1 to 4; triaxial paths keep their strength.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "clay_points.h"

static const clay soft = {1.1, 0.13, 0.03, 0.28, 0.9, 120e3, 1.3};

/* xx, yy, zz, xy; stresses in Pa, tension positive. */
typedef struct point {
  double s[4], pc, e;
} point;

static double a4_of(const clay *c) {
  const double sine = 3.0 * c->M / (6.0 + c->M), a = (3.0 - sine) / (3.0 + sine);
  return a * a * a * a;
}

static double yield(const clay *c, const double *s, double pc) {
  const double p = -(s[0] + s[1] + s[2]) / 3.0, a4 = a4_of(c);
  const double d[4] = {s[0] + p, s[1] + p, s[2] + p, s[3]};
  const double q2 = 1.5 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + 3.0 * d[3] * d[3];
  const double j3 = d[2] * (d[0] * d[1] - d[3] * d[3]);
  const double sine = q2 > 0.0 ? fmax(-1.0, fmin(1.0, 13.5 * j3 / pow(q2, 1.5))) : -1.0;
  return q2 * sqrt((1.0 + a4 + (1.0 - a4) * sine) / (2.0 * a4)) / (c->M * c->M) + p * (p - pc);
}

/* Changes of the state with the strain de (xx, yy, zz, engineering shear xy). */
static point rate(const clay *c, const point *x, const double *de) {
  const double p = -(x->s[0] + x->s[1] + x->s[2]) / 3.0, v = 1.0 + x->e, K = v * p / c->kappa;
  const double G = 1.5 * (1.0 - 2.0 * c->nu) / (1.0 + c->nu) * K, L = K - 2.0 / 3.0 * G;
  const double growth = de[0] + de[1] + de[2];
  point r = {.e = v * growth};
  for (int i = 0; i < 4; i++) r.s[i] = i < 3 ? L * growth + 2.0 * G * de[i] : G * de[3];
  if (yield(c, x->s, x->pc) < -1e-7 * x->pc * x->pc) return r;
  double g[4], Dg[4], along = 0.0, resists = 0.0;
  for (int i = 0; i < 4; i++) {
    double up[4], down[4];
    memcpy(up, x->s, sizeof up), memcpy(down, x->s, sizeof down);
    up[i] += 1e-5 * x->pc, down[i] -= 1e-5 * x->pc;
    g[i] = (yield(c, up, x->pc) - yield(c, down, x->pc)) / (2e-5 * x->pc);
    along += g[i] * r.s[i];
  }
  if (along <= 0.0) return r;
  const double opens = g[0] + g[1] + g[2], hardening = v * x->pc / (c->lambda - c->kappa);
  for (int i = 0; i < 4; i++) {
    Dg[i] = i < 3 ? L * opens + 2.0 * G * g[i] : G * g[3];
    resists += g[i] * Dg[i];
  }
  const double flow = along / (resists - p * hardening * opens);
  for (int i = 0; i < 4; i++) r.s[i] -= flow * Dg[i];
  r.pc = -hardening * flow * opens;
  return r;
}

static point plus(const point *x, const point *r, double h) {
  point y = {.pc = x->pc + h * r->pc, .e = x->e + h * r->e};
  for (int i = 0; i < 4; i++) y.s[i] = x->s[i] + h * r->s[i];
  return y;
}

static void integrate(const clay *c, point *x, const double *strain, int steps) {
  double de[4];
  for (int i = 0; i < 4; i++) de[i] = strain[i] / steps;
  for (int k = 0; k < steps; k++) {
    const point a = rate(c, x, de), half = plus(x, &a, 0.5), b = rate(c, &half, de);
    const point again = plus(x, &b, 0.5), d = rate(c, &again, de);
    const point whole = plus(x, &d, 1.0), f = rate(c, &whole, de);
    *x = plus(x, &a, 1.0 / 6.0), *x = plus(x, &b, 1.0 / 3.0);
    *x = plus(x, &d, 1.0 / 3.0), *x = plus(x, &f, 1.0 / 6.0);
  }
}

/* Relative differences of q, p, the stress across the plane and pc from the own integration. */
static double differ(const clay *c, const double *strain, int steps) {
  mps_material_cam_clay_def def = clay_def(c);
  def.lode = 1;
  MAKE(material, m, create_cam_clay, context, &def);
  mps_material_point x = point_under(m, -c->p0);
  const double half = 0.5 * strain[3];
  const double gradient[9] = {strain[0], half, 0, half, strain[1], 0, 0, 0, strain[2]};
  OK(mps_material_point_drive(context, m, &x, gradient, 1.0, steps));
  point own = {{-c->p0, -c->p0, -c->p0, 0.0}, c->R * c->p0, c->e0};
  integrate(c, &own, strain, 20000);
  const double q = clay_q(&x), p = clay_p(&x);
  const double own_p = -(own.s[0] + own.s[1] + own.s[2]) / 3.0;
  const double d[3] = {own.s[0] + own_p, own.s[1] + own_p, own.s[2] + own_p};
  const double own_q =
      sqrt(1.5 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + 3.0 * own.s[3] * own.s[3]);
  double worst = fmax(fabs(q / own_q - 1.0), fabs(p / own_p - 1.0));
  worst = fmax(worst, fabs(x.stress[2] / own.s[2] - 1.0));
  return fmax(worst, fabs(x.history[CLAY_PC] / own.pc - 1.0));
}

TEST(the_flow_is_associated) {
  static const double paths[4][4] = {{0.05, -0.05, 0, 0},        /* plane strain, undrained */
                                     {0, 0, 0, 0.12},            /* simple shear, undrained */
                                     {0.02, -0.08, 0, 0.03},     /* plane strain, compressing */
                                     {0.06, 0.01, -0.08, 0.05}}; /* in all directions */
  static const double ratios[3] = {1.0, 1.3, 4.0};
  for (int k = 0; k < 4; k++)
    for (int r = 0; r < 3; r++) {
      clay c = soft;
      c.R = ratios[r];
      const double apart = differ(&c, paths[k], 2000);
      print_message("path %d, overconsolidation %g: %.2g\n", k, c.R, apart);
      assert_true(apart < 1e-3);
    }
}

/* k^1/2 = M/M(theta), of which yield() takes the square, and half its derivative. */
static double root_k(double a4, double theta, double *half_slope) {
  const double k = sqrt((1.0 + a4 + (1.0 - a4) * sin(3.0 * theta)) / (2.0 * a4));
  *half_slope = 0.5 * 3.0 * (1.0 - a4) * cos(3.0 * theta) / (4.0 * a4 * k);
  return sqrt(k);
}

/* At the critical state of an undrained test in plane strain all strain is plastic, and its
 * direction theta = 0 that of the flow, theta + atan(k'/(2 k)): the strength in closed form. A
 * radial flow would have theta = 0 for the stress, and a strength lower by 16 %. */
TEST(plane_strain_is_stronger_than_by_radial_flow) {
  mps_material_cam_clay_def def = clay_def(&soft);
  def.lode = 1;
  MAKE(material, m, create_cam_clay, context, &def);
  mps_material_point x = point_under(m, -soft.p0);
  const double gradient[9] = {0.5, 0, 0, 0, -0.5, 0, 0, 0, 0};
  OK(mps_material_point_drive(context, m, &x, gradient, 1.0, 4000));
  double low = -PI / 6.0, high = 0.0, slope, root = 1.0;
  for (int i = 0; i < 60; i++) {
    const double theta = 0.5 * (low + high);
    root = root_k(a4_of(&soft), theta, &slope);
    if (theta + atan(slope / (root * root)) > 0.0)
      high = theta;
    else
      low = theta;
  }
  const double Lambda = 1.0 - soft.kappa / soft.lambda;
  const double p = soft.p0 * pow(0.5 * soft.R, Lambda), q = soft.M * p / root;
  print_message("q = %.3f kPa, in closed form %.3f\n", 1e-3 * clay_q(&x), 1e-3 * q);
  NEAR(clay_p(&x) / p, 1.0, 1e-3);
  NEAR(clay_q(&x) / q, 1.0, 1e-3);
  const double radial = soft.M * p / root_k(a4_of(&soft), 0.0, &slope);
  assert_true(radial < 0.86 * q);
}

/* The error of a step is of first order also where the direction turns. */
TEST(halved_steps_halve_the_error) {
  static const double path[4] = {0.02, -0.08, 0, 0.03};
  const double coarse = differ(&soft, path, 200), fine = differ(&soft, path, 400);
  print_message("%.3g with 200 steps, %.3g with 400\n", coarse, fine);
  assert_true(fine < 0.65 * coarse);
}

/* A clay so steep that its surface would not be convex is refused. */
TEST(too_steep_a_slope_is_refused) {
  mps_material_cam_clay_def def = clay_def(&soft);
  scoped_material *m = NULL;
  def.lode = 1, def.critical_slope = 1.95;
  REFUSES(mps_material_create_cam_clay(context, &def, &m),
          "critical_slope is 1.95, must be in 0.05 to 1.9 where lode is 1");
  def.critical_slope = 1.9;
  OK(mps_material_create_cam_clay(context, &def, &m));
  mps_material_destroy(&m);
  def.lode = 0, def.critical_slope = 2.9;
  OK(mps_material_create_cam_clay(context, &def, &m));
}
