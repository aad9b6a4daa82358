/* cam_clay.c - modified Cam-Clay (Roscoe & Burland 1968) in one step: yield surface
 * f = q^2/M^2 + p (p - pc), associated flow, K = v p/kappa, hardening by the plastic change of the
 * specific volume v. With compression positive in p and v, whatever the step,
 *   ln(pc1/pc0) = (v0 - v1 - kappa ln(p1/p0))/(lambda - kappa),                                (1)
 * so that two unknowns are left, x = ln p and the flow multiplier g, of the equations
 *   r1 = v0 - v1 - kappa (x - ln p0) - (v0 + v1)/2 g (2 p - pc)
 *   r2 = q*^2/(M D)^2 + p (p - pc), D = 1 + 6 G g/M^2,
 * the deviator being the trial's over D. Newton's method solves nearly all; the rest by bisection
 * in g, as r1 falls in x for each g. Stresses in these equations are divided by pc0.
 *
 * Where M follows the Lode angle, f = q^2 k(theta)/M^2 + p (p - pc) with M of compression and
 *   k^2 = (1 + a^4 + (1 - a^4) sin 3 theta)/(2 a^4),
 * and the flow has a part along theta. With A = 6 G g/M^2 the trial's deviator s* = s + 2 G g df/ds
 * has the components q (1 + A k) along s and q A k'/2 across it in the deviatoric plane, hence
 *   theta* - theta = atan((A k'/2)/(1 + A k)),                                                (2)
 * solved for theta within each evaluation of r2. The surface is convex up to M = 1.91.
 *
 * Below `least_pressure` grains part, as in the sand of laws.c: the volume strain of the gap is
 * kept and compression closes it first. SPDX-License-Identifier: BSD-3-Clause */
#include "material/material_private.h"

#define LONGEST 1e-2  /* strain of a substep: G is that of its beginning */
#define FARTHEST 10.0 /* strain of a step; a solver never comes near it */

/* What one substep solves, in units of pc0. */
typedef struct clay_return {
  double x0, dv, vm;         /* ln p0, v0 - v1, mean v */
  double kappa, per_plastic; /* 1/(lambda - kappa) */
  double q, slope2, shear6;  /* q*, M^2, 6 G */
  double start;              /* x of the trial */
  bool lode;                 /* M follows the Lode angle; then */
  double a4, angle;          /* a^4; theta of the trial, -pi/6 in compression to pi/6 */
} clay_return;

/* k of the direction theta, and its derivatives. */
typedef struct clay_direction {
  double k, first, second;
} clay_direction;

static clay_direction direction(double a4, double theta) {
  const double per = 0.5 / a4, turn = (1.0 - a4) * per, sine = sin(3.0 * theta);
  const double slope = 3.0 * turn * cos(3.0 * theta);
  const double k = sqrt((1.0 + a4) * per + turn * sine), per_k = 1.0 / k;
  return (clay_direction){k, 0.5 * slope * per_k,
                          -4.5 * turn * sine * per_k -
                              0.25 * slope * slope * per_k * per_k * per_k};
}

/* The deviator that is left of the trial's for a multiplier. */
typedef struct clay_deviator {
  double left;  /* q/q* */
  double angle; /* theta */
  double k;     /* of it */
  double fall;  /* -d(q^2 k/q*^2)/dA, over 2 */
  double flow;  /* |df/ds| over that of k = 1 */
} clay_deviator;

/* Equation (2): its left side less the right falls with theta, and they are equal in [-pi/6,
 * theta*]. */
static clay_deviator find_deviator(const clay_return *c, double A) {
  double low = -0.52359877559829887, high = c->angle, theta = c->angle;
  clay_direction d = direction(c->a4, theta);
  for (int i = 0; i < 60 && high > low; i++) {
    const double along = 1.0 + A * d.k, across = 0.5 * A * d.first;
    const double over = theta + atan2(across, along) - c->angle;
    const double slope = 1.0 + (0.5 * A * d.second * along - across * A * d.first) /
                                   (along * along + across * across);
    if (over > 0.0)
      high = theta;
    else
      low = theta;
    double next = theta - over / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double moved = fabs(next - theta);
    theta = next;
    d = direction(c->a4, theta);
    if (moved <= 1e-16) break;
  }
  const double rr = 1.0 + A * d.k, rt = 0.5 * A * d.first, tt = rr + 0.5 * A * d.second;
  const double square = rr * rr + rt * rt, half = 0.5 * d.first;
  const double det = rr * tt - rt * rt;
  const double form = (tt * d.k * d.k - 2.0 * rt * d.k * half + rr * half * half) / det;
  return (clay_deviator){1.0 / sqrt(square), theta, d.k, form / square,
                         sqrt(d.k * d.k + half * half)};
}

typedef struct clay_point {
  double x, g, p, pc, r1, r2, gg; /* gg: dr2/dg */
  clay_deviator deviator;
} clay_point;

static clay_point evaluate(const clay_return *c, double x, double g) {
  const double elastic = c->kappa * (x - c->x0);
  const double p = exp(x), pc = exp((c->dv - elastic) * c->per_plastic);
  const double A = c->shear6 * g / c->slope2, D = 1.0 + A;
  clay_point out = {.x = x,
                    .g = g,
                    .p = p,
                    .pc = pc,
                    .r1 = c->dv - elastic - c->vm * g * (2.0 * p - pc),
                    .r2 = c->q * c->q / (c->slope2 * D * D) + p * (p - pc),
                    .gg = -2.0 * c->q * c->q * c->shear6 / (c->slope2 * c->slope2 * D * D * D),
                    .deviator = {.left = 1.0 / D, .flow = 1.0}};
  if (!c->lode) return out;
  const clay_deviator d = out.deviator = find_deviator(c, A);
  out.r2 = c->q * c->q * d.left * d.left * d.k / c->slope2 + p * (p - pc);
  out.gg = -2.0 * c->q * c->q * c->shear6 * d.fall / (c->slope2 * c->slope2);
  return out;
}

/* Newton's method from the trial; false where it has not converged. */
static bool solve_newton(const clay_return *c, clay_point *out) {
  const double fall = c->kappa * c->per_plastic; /* -d ln pc/dx */
  double x = c->start, g = 0.0;
  for (int i = 0; i < 25; i++) {
    const clay_point a = evaluate(c, x, g);
    if (fabs(a.r1) <= 1e-14 * c->vm && fabs(a.r2) <= 1e-13 * (1.0 + a.p * a.p)) {
      *out = a;
      return a.p > 0.0;
    }
    const double xx = -c->kappa - c->vm * g * (2.0 * a.p + fall * a.pc);
    const double xg = -c->vm * (2.0 * a.p - a.pc);
    const double gx = a.p * (2.0 * a.p - a.pc) + fall * a.p * a.pc;
    const double gg = a.gg, det = xx * gg - xg * gx;
    if (!(fabs(det) > 1e-300)) return false;
    const double per_det = 1.0 / det;
    x += fmax(-1.0, fmin(1.0, (xg * a.r2 - gg * a.r1) * per_det));
    g = fmax(0.0, g + (gx * a.r1 - xx * a.r2) * per_det);
  }
  return false;
}

/* x of r1 = 0 for a multiplier: between the trial and the critical state, 2 p = pc. */
static clay_point solve_volume(const clay_return *c, double g) {
  const double fall = c->kappa * c->per_plastic;
  const double critical = (fall * c->start - 0.69314718055994531) / (1.0 + fall);
  double low = fmin(c->start, critical), high = fmax(c->start, critical), x = c->start;
  clay_point a = evaluate(c, x, g);
  for (int i = 0; i < 200 && a.r1 != 0.0 && high - low > 1e-15 * (1.0 + fabs(x)); i++) {
    if (a.r1 > 0.0)
      low = x;
    else
      high = x;
    x += a.r1 / (c->kappa + c->vm * g * (2.0 * a.p + fall * a.pc));
    if (!(x > low && x < high)) x = 0.5 * (low + high);
    a = evaluate(c, x, g);
  }
  return a;
}

static clay_point solve_bracket(const clay_return *c) {
  double low = 0.0, high = 1e-3 * c->slope2 / c->shear6;
  clay_point a = solve_volume(c, high);
  for (int i = 0; i < 200 && a.r2 > 0.0; i++) {
    low = high;
    high *= 4.0;
    a = solve_volume(c, high);
  }
  for (int i = 0; i < 200 && high - low > 1e-15 * high; i++) {
    const double middle = 0.5 * (low + high);
    a = solve_volume(c, middle);
    if (a.r2 > 0.0)
      low = middle;
    else
      high = middle;
  }
  return a;
}

/* ---- one substep ----------------------------------------------------------------------------- */

/* Direction of a deviator in the deviatoric plane. */
typedef struct clay_plane {
  double across[6]; /* tensor of unit norm along growing theta; 0 in triaxial states */
  double angle;     /* theta */
} clay_plane;

/* The gradient of det s, s^2 - s:s/3, less its part along s, has the norm (s:s) cos 3 theta/6^1/2.
 */
static clay_plane plane_of(const double *s, double q) {
  clay_plane plane = {.angle = 0.0};
  const double square = q * q / 1.5; /* s:s */
  const double t[6] = {s[0] * s[0] + s[3] * s[3] + s[4] * s[4] - square / 3.0,
                       s[3] * s[3] + s[1] * s[1] + s[5] * s[5] - square / 3.0,
                       s[4] * s[4] + s[5] * s[5] + s[2] * s[2] - square / 3.0,
                       s[0] * s[3] + s[3] * s[1] + s[4] * s[5],
                       s[0] * s[4] + s[3] * s[5] + s[4] * s[2],
                       s[3] * s[4] + s[1] * s[5] + s[5] * s[2]};
  double along = 0.0, norm = 0.0;
  if (!(square > 0.0)) return plane;
  for (int c = 0; c < 6; c++) along += (c < 3 ? 1.0 : 2.0) * t[c] * s[c];
  for (int c = 0; c < 6; c++) {
    plane.across[c] = t[c] - along / square * s[c];
    norm += (c < 3 ? 1.0 : 2.0) * plane.across[c] * plane.across[c];
  }
  norm = sqrt(norm); /* det s is a third of s^2:s */
  plane.angle = atan2(13.5 * along / 3.0 / (q * q * q), 2.4494897427831781 * norm / square) / 3.0;
  const double per_norm = norm > 1e-13 * square ? 1.0 / norm : 0.0;
  for (int c = 0; c < 6; c++) plane.across[c] *= per_norm;
  return plane;
}

double mpsi_cam_clay_slope2(const mpsi_law *law, const double *s, double q) {
  const double m2 = law->slope * law->slope;
  return law->lode == 1.0 || !(q > 0.0) ? m2 : m2 / direction(law->lode, plane_of(s, q).angle).k;
}

/* p = least_pressure, the deviator cut to the yield surface there. */
static int64_t part(const mpsi_law *law, double m2, double shear, double q, mpsi_clay *clay,
                    double *scale, double *p) {
  const double least = law->least_pressure;
  const double most = sqrt(m2 * least * (clay->pc - least));
  *p = least;
  if (q > most) {
    *scale = most / q;
    clay->strain += (q - most) / (3.0 * shear);
  }
  return MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX;
}

static int64_t return_plastic(const mpsi_law *law, const clay_return *c, mpsi_clay *clay,
                              double *scale, double *turn, double *p) {
  clay_point a;
  if (!solve_newton(c, &a)) a = solve_bracket(c);
  *p = a.p * clay->pc;
  *scale = a.deviator.left;
  if (c->lode) *turn = c->angle - a.deviator.angle;
  clay->strain += 2.0 * a.g * c->q * *scale * a.deviator.flow / c->slope2;
  clay->pc = fmax(a.pc * clay->pc, 2.0 * law->least_pressure);
  return MPS_MATERIAL_FLAG_PLASTIC;
}

/* Trial state of a substep. */
typedef struct clay_trial {
  double p0;     /* Pa, mean pressure before it */
  double growth; /* volume strain of it */
  double shear;  /* Pa, modulus */
  double m2;     /* M^2 in the direction of the deviator */
  double q;      /* Pa, of the trial deviator */
  double angle;  /* theta of it, where M follows it */
} clay_trial;

/* The mean pressure after the substep, the fraction of the trial deviator that is left, and the
 * angle by which it has turned back in the deviatoric plane. */
static int64_t find_invariants(const mpsi_law *law, const clay_trial *trial, mpsi_clay *clay,
                               double *scale, double *turn, double *p) {
  const double shear = trial->shear, m2 = trial->m2, q = trial->q;
  const double v0 = 1.0 + clay->void_ratio, half = 0.5 * trial->growth;
  const double v1 = v0 * ((1.0 + half) / (1.0 - half)), x0 = log(trial->p0);
  const double x = x0 + (v0 - v1) / law->swelling, least = law->log_least;
  if (x < least) {
    const double v = v0 - law->swelling * (least - x0);
    clay->gap += log(v1 / v);
    clay->void_ratio = v - 1.0;
    clay->volume *= v / v0;
    return part(law, m2, shear, q, clay, scale, p);
  }
  clay->void_ratio = v1 - 1.0;
  clay->volume *= v1 / v0;
  *p = exp(x);
  if (!(q * q / m2 + *p * (*p - clay->pc) > 0.0)) return 0;
  const double log_pc = log(clay->pc), per_pc = 1.0 / clay->pc;
  const clay_return c = {.x0 = x0 - log_pc,
                         .dv = v0 - v1,
                         .vm = 0.5 * (v0 + v1),
                         .kappa = law->swelling,
                         .per_plastic = 1.0 / (law->compression - law->swelling),
                         .q = q * per_pc,
                         .slope2 = law->slope * law->slope,
                         .shear6 = 6.0 * shear * per_pc,
                         .start = x - log_pc,
                         .lode = law->lode != 1.0,
                         .a4 = law->lode,
                         .angle = trial->angle};
  return return_plastic(law, &c, clay, scale, turn, p);
}

static int64_t substep(const mpsi_law *law, const double *d, double *s, mpsi_clay *clay) {
  const double p0 = fmax(-(s[0] + s[1] + s[2]) / 3.0, law->least_pressure);
  const double growth = d[0] + d[1] + d[2], mean = growth / 3.0, old = (s[0] + s[1] + s[2]) / 3.0;
  const double bulk = (1.0 + clay->void_ratio) * p0 / law->swelling;
  const double shear = law->shear_ratio > 0.0 ? law->shear_ratio * bulk : law->shear;
  double dev[6], scale = 1.0, turn = 0.0, p;
  for (int c = 0; c < 6; c++)
    dev[c] = s[c] - (c < 3 ? old : 0.0) + 2.0 * shear * (d[c] - (c < 3 ? mean : 0.0));
  const double q = sqrt(1.5 * (dev[0] * dev[0] + dev[1] * dev[1] + dev[2] * dev[2]) +
                        3.0 * (dev[3] * dev[3] + dev[4] * dev[4] + dev[5] * dev[5]));
  const bool lode = law->lode != 1.0;
  const clay_plane plane = lode ? plane_of(dev, q) : (clay_plane){.angle = 0.0};
  const double whole = law->slope * law->slope, closed = clay->gap + growth;
  const double m2 = lode && q > 0.0 ? whole / direction(law->lode, plane.angle).k : whole;
  const bool apart = clay->gap > 0.0;
  int64_t flags;
  if (apart && closed > 0.0) {
    clay->gap = closed;
    flags = part(law, m2, shear, q, clay, &scale, &p);
  } else {
    clay->gap = 0.0;
    const clay_trial trial = {p0, apart ? closed : growth, shear, m2, q, plane.angle};
    flags = find_invariants(law, &trial, clay, &scale, &turn, &p);
    if (apart) flags |= MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX;
  }
  const double along = turn == 0.0 ? scale : scale * cos(turn);
  const double across = turn == 0.0 ? 0.0 : scale * sin(turn) * q * 0.81649658092772603;
  for (int c = 0; c < 6; c++) s[c] = along * dev[c] - across * plane.across[c] - (c < 3 ? p : 0.0);
  return flags;
}

int64_t mpsi_cam_clay_step(const mpsi_law *law, int32_t dim, const double *strain, double *stress,
                           mpsi_clay *clay) {
  double d[6] = {0.0}, s[6] = {0.0}, square = 0.0;
  int64_t flags = 0;
  for (int c = 0; c < 2 * dim; c++) {
    d[c] = strain[c];
    s[c] = stress[c];
    square += (c < 3 ? 1.0 : 2.0) * d[c] * d[c];
  }
  const double size = sqrt(square);
  if (!(size <= FARTHEST)) {
    for (int c = 0; c < 2 * dim; c++) stress[c] = NAN;
    return 0;
  }
  const int parts = size > LONGEST ? (int)ceil(size / LONGEST) : 1;
  if (!(clay->pc >= 2.0 * law->least_pressure)) clay->pc = 2.0 * law->least_pressure;
  for (int c = 0; c < 2 * dim && parts > 1; c++) d[c] /= parts;
  for (int i = 0; i < parts; i++) flags = substep(law, d, s, clay) | (flags & 1);
  for (int c = 0; c < 2 * dim; c++) stress[c] = s[c];
  return flags;
}
